"""Factors of safety by strength reduction, against load factors and rotational mechanisms."""

from dataclasses import replace
from math import atan, cos, isnan, nan, pi, radians, sin, tan

import pytest
from scipy.optimize import brentq

import lacore as la
from lacore.analyses.ranges import safety
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind


def cut(weight, criterion, cells=4):
    """A vertical cut of height 1 above a layer of the same soil, under its weight."""
    mesh = la.meshes.rectangle(x=(0, 3), y=(0, 1), nx=3 * cells, ny=cells)
    return la.Problem(
        {"soil": la.Body(mesh, criterion)},
        [la.BodyForce("soil", (0, -weight))],
        supports=[la.Fix("soil", "left"), la.Fix("soil", "bottom")],
    )


@pytest.mark.parametrize("criterion", [la.VonMises(2.0), la.MohrCoulomb(2.0, 0)], ids=["k", "c"])
def test_without_friction_it_is_the_load_factor(criterion):
    """Strengths and loads then are in proportion: F is alpha, end by end."""
    problem = cut(1.0, criterion, cells=2)
    found = la.safety_factor(problem, tolerance=1e-3)
    lower, upper = la.lower_bound(problem).load_factor, la.upper_bound(problem).load_factor
    assert lower * (1 - 1e-3) <= found.lower <= lower
    assert upper <= found.upper <= upper * (1 + 1e-3)
    assert found.stands is True
    assert found.proven


def test_with_friction_loads_at_the_ends_are_those_of_collapse():
    """At each end the bound of the weakened soil is 1, from the side that proves it."""
    soil = la.MohrCoulomb(1.0, 20)
    problem = cut(4.0, soil)
    found = la.safety_factor(problem, tolerance=1e-3)
    for end, bound in ((found.lower, la.lower_bound), (found.upper, la.upper_bound)):
        weaker = cut(4.0, soil.weakened(end))
        # A load factor falls no faster than F^-2 here, over a step of 1e-3.
        assert bound(weaker).load_factor == pytest.approx(1.0, abs=3e-3)
    assert la.lower_bound(cut(4.0, soil.weakened(found.lower))).load_factor >= 1
    assert la.upper_bound(cut(4.0, soil.weakened(found.upper))).load_factor < 1
    # The log-spiral through the toe is a mechanism (Chen): at gamma H/c = 5.5049 F is at most 1.
    steep = la.safety_factor(cut(5.5049, soil), tolerance=1e-2)
    assert steep.lower <= 1
    assert found.lower > steep.lower


def test_dead_loads_count_like_others():
    problem = cut(2.0, la.MohrCoulomb(1.0, 20))
    half = [la.BodyForce("soil", (0, -1.0))]
    split = replace(problem, reference_loads=half, dead_loads=half)
    one, other = la.safety_factor(problem), la.safety_factor(split)
    assert (one.lower, one.upper) == pytest.approx((other.lower, other.upper), rel=1e-6)


@pytest.mark.parametrize("wrong", [1, 4])
@pytest.mark.parametrize("end", ["lower", "upper"])
def test_bounds_that_fail_prove_nothing(monkeypatch, end, wrong):
    """Neither that the structure falls nor that it stands: the end is found beside them.

    F is 2 here. The first bounds of one side fail, wherever they are.
    """
    problem = cut(1.0, la.VonMises(2.0), cells=2)
    sound = la.safety_factor(problem, tolerance=0.01)
    bound, asked = getattr(safety, f"{end}_bound"), []

    def failing(*arguments):
        asked.append(bound(*arguments))
        lost = {"rigor": la.Rigor.NOT_CERTIFIED, "load_factor": nan}
        return replace(asked[-1], **lost) if len(asked) <= wrong else asked[-1]

    monkeypatch.setattr(safety, f"{end}_bound", failing)
    found = la.safety_factor(problem, tolerance=0.01)
    assert (found.lower, found.upper) == pytest.approx((sound.lower, sound.upper), rel=0.01)
    row = found.history[found.history.end == end]
    assert row.load_factor.isna().sum() == wrong
    assert not row.proves[row.load_factor.isna()].any()
    assert f"{wrong} failed and prove" in repr(found)


@pytest.mark.parametrize("end", ["lower", "upper"])
def test_no_bound_no_end(monkeypatch, end):
    """Where all bounds of a side fail that end is nan, and the other one is as it was."""
    problem = cut(1.0, la.VonMises(2.0), cells=2)
    bound = getattr(safety, f"{end}_bound")
    lost = {"rigor": la.Rigor.NOT_CERTIFIED, "load_factor": nan}
    monkeypatch.setattr(safety, f"{end}_bound", lambda *given: replace(bound(*given), **lost))
    found = la.safety_factor(problem, tolerance=0.2)
    assert isnan(getattr(found, end))
    assert not isnan(found.lower if end == "upper" else found.upper)


def test_what_no_angle_is_left_for_is_not_proven():
    """A load next to none would take tan(phi)/F below the least angle, 0.1 degrees."""
    soil = la.Body(la.meshes.rectangle((0, 1), (0, 1), 1, 1), la.MohrCoulomb(1.0, 30))
    stands = [la.Fix("soil", "bottom", "y")]
    found = la.safety_factor(la.Problem({"soil": soil}, [la.Pressure("soil", "top", 1e-4)], stands))
    least = tan(radians(30)) / tan(radians(0.1))
    assert least / 1.01 <= found.lower <= least
    assert isnan(found.upper)


def test_weakened_criteria():
    soil = la.MohrCoulomb(3.0, 30, tension_cutoff=0.6, crushing=9.0).weakened(3)
    assert soil.cohesion == pytest.approx(1.0)
    assert tan(radians(soil.friction_angle)) == pytest.approx(tan(radians(30)) / 3)
    assert (soil.tension_cutoff, soil.crushing) == pytest.approx((0.2, 3.0))
    assert soil.apex == pytest.approx(la.MohrCoulomb(3.0, 30).apex)
    assert la.Rankine(3.0, 9.0).weakened(3) == la.Rankine(1.0, 3.0)
    assert la.NoTension(9.0).weakened(3) == la.NoTension(3.0)
    assert la.MaximumShear(3.0).weakened(3) == la.MaximumShear(1.0)
    assert la.VonMises(3.0).weakened(3).k == pytest.approx(1.0)
    cone = la.DruckerPrager(3.0, 30, "compression").weakened(3)
    assert (cone.cohesion, cone.match) == (1.0, "compression")


def test_interfaces_are_weakened_where_asked():
    """A block that is held by the shear of its joint: 2 Pa over 2 m, against 1 Pa over 1 m."""
    mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2)
    floor = la.RigidObstacle((0, 0), (0, 1))
    problem = la.Problem(
        {"block": la.Body(mesh, la.VonMises(100.0))},
        [la.Traction("block", "left", (1, 0))],
        interfaces=[la.Interface(("block", "bottom"), floor, la.Tresca(2.0))],
        dead_loads=[la.Pressure("block", "top", 3.0)],  # it does not topple
    )
    assert la.safety_factor(problem, interfaces=True).lower == pytest.approx(4.0, rel=2e-3)
    assert not la.safety_factor(problem).lower < 25  # its own strength alone


def test_associated_friction_that_is_overcome_collapses():
    """F = mu W/H: below it the block is locked, above it slides up its cone without dissipation."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=1, ny=1)
    floor = la.Interface(("block", "bottom"), la.RigidObstacle(), la.Coulomb(0.5, associated=True))
    problem = la.Problem(
        {"block": la.Body(mesh, la.VonMises(100.0))},
        [la.BodyForce("block", (0.5, 0))],
        interfaces=[floor],
        dead_loads=[la.BodyForce("block", (0, -2))],
    )
    found = la.safety_factor(problem, interfaces=True, tolerance=0.05)
    assert found.lower <= 2.0 <= found.upper
    assert found.width < 0.11  # both ends to the tolerance, in logarithms
    assert found.proven


@pytest.mark.parametrize("dilation", [0.0, 10.0])
def test_a_uniform_state_has_one_factor_whatever_the_dilation(dilation):
    """Pressed by p, ``2 c/F tan(45 + phi_F/2) = p`` with ``tan(phi_F) = tan(phi)/F``."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2)
    problem = la.Problem(
        {"sample": la.Body(mesh, la.MohrCoulomb(1.0, 30, dilation_angle=dilation))},
        [la.Pressure("sample", "top", 2.0)],
        supports=[la.Fix("sample", "bottom", "y")],
    )
    found = la.safety_factor(problem, tolerance=1e-3)

    def carried(factor):
        angle = atan(tan(radians(30)) / factor)
        return 2 / factor * tan(pi / 4 + angle / 2)

    exact = brentq(lambda factor: carried(factor) - 2, 1, 3)
    assert found.lower <= exact * (1 + 1e-6)  # certified at 1e-6 of the load
    assert found.upper >= exact * (1 - 1e-6)
    assert found.width <= 1.1e-3  # tolerance, in logarithms
    assert [state.certify().holds(1e-6) for state in found.states] == [True, True]
    assert found.stands is None  # other states may carry less
    assert not found.proven
    assert "of certified states, not proven" in repr(found).splitlines()[0]
    with pytest.raises(la.CapabilityError, match="regularised"):
        la.safety_factor(problem, backend="newton")


@pytest.mark.parametrize(("pressure", "exact"), [(0.75, 0.9), (3.0, 3.6)])
def test_a_block_slides_where_friction_is_that_of_the_load(pressure, exact):
    """Over 2 m, mu p against 1 Pa over 1 m: ``F = 2 mu p``, load factors ``2 mu p`` per factor."""
    mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=2, ny=1)
    problem = la.Problem(
        {"block": la.Body(mesh, la.VonMises(100.0))},
        [la.Traction("block", "left", (1, 0))],
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle((0, 0), (0, 1)), 0.6)],
        dead_loads=[la.Pressure("block", "top", pressure)],
    )
    found = la.safety_factor(problem, interfaces=True, tolerance=0.02)
    assert found.lower <= exact * (1 + 1e-6)
    assert found.upper >= exact * (1 - 1e-6)
    assert found.width <= 0.022
    times = found.history["load_factor"] * found.history["factor"]  # beside the same pressure
    assert times.to_numpy() == pytest.approx(exact, rel=1e-5)
    assert "friction of interfaces as well" in repr(found)
    if exact < 1:
        with pytest.raises(la.InputError, match=r" [1-9]\d* times.*decides.*interfaces=True"):
            la.safety_factor(problem)


def test_a_load_that_holds_what_falls_is_taken_as_it_is():
    """A block on a slope that is too steep, and a push that does not hold it: it slides down.

    Seven times the push would move it uphill, whose load factor says nothing of the push itself.
    Held by P it slides where ``mu/F cos(b) = sin(b) - P``.
    """
    slope, mu, push = 0.5, 0.3, 0.1
    mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=2, ny=1)
    problem = la.Problem(
        {"block": la.Body(mesh, la.VonMises(100.0))},
        [la.BodyForce("block", (push, 0))],
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle((0, 0), (0, 1)), mu)],
        dead_loads=[la.BodyForce("block", (-sin(slope), -cos(slope)))],
    )
    assert la.solve(problem).load_factor > 7
    found = la.safety_factor(problem, interfaces=True, tolerance=0.05)
    exact = mu * cos(slope) / (sin(slope) - push)
    assert exact < 1
    assert found.lower < exact < found.upper  # the load factor jumps there, from 0 to hundreds


def test_what_is_not_divided_is_named():
    """A portal keeps its plastic moment on weaker ground."""
    frame = la.Frame({"A": (1, 1), "B": (1, 2)}, [("A", "B")], plastic_moment=1.0)
    problem = cut(1.0, la.VonMises(2.0), cells=1)
    found = la.safety_factor(problem, tolerance=0.5)
    assert "strength of all bodies" in repr(found)
    assert "interfaces" not in repr(found)  # there are none
    held = [*problem.supports, la.Fix("mast", "A", "clamped")]
    beside = replace(problem, bodies={**problem.bodies, "mast": frame}, supports=held)
    assert "strength of soil; mast as stated" in repr(replace(found, problem=beside))


def test_a_width_is_relative_to_the_mean():
    """2 and 6: 4 apart, around 4."""
    found = la.safety_factor(cut(1.0, la.VonMises(1.0), cells=1), tolerance=0.5)
    assert replace(found, lower=2.0, upper=6.0).width == 1.0


def told_of(monkeypatch, name):
    """Make a solve report its load factor as a finding, and return the analysis of a block.

    It is held by a joint of shear strength 2 Pa or friction: F is 4 or 3.6.
    """
    solved = getattr(safety, name)

    def telling(*given, **more):
        own = solved(*given, **more)
        return replace(own, findings=(Finding(Kind.NO_BOUND, (f"{own.load_factor:.9g}",)),))

    monkeypatch.setattr(safety, name, telling)
    mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=2, ny=1)
    law = la.Tresca(2.0) if name == "upper_bound" else 0.6
    problem = la.Problem(
        {"block": la.Body(mesh, la.VonMises(100.0))},
        [la.Traction("block", "left", (1, 0))],
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle((0, 0), (0, 1)), law)],
        dead_loads=[la.Pressure("block", "top", 3.0)],
    )
    return la.safety_factor(problem, interfaces=True, tolerance=0.1)


@pytest.mark.parametrize("name", ["upper_bound", "solve"])
def test_what_is_found_of_the_mechanism_is_that_of_the_upper_end(monkeypatch, name):
    """The strengths of another end, and what was found with them, are not those of collapse."""
    found = told_of(monkeypatch, name)
    rows = found.history
    if name == "upper_bound":
        rows = rows[rows.end == "upper"]
    (factor,) = rows.load_factor[rows.factor == found.upper]
    assert [own.where for own in found.findings] == [(f"{factor:.9g}",)]


def test_an_end_that_is_not_proven_says_so():
    """No mesh, no solve: a factor whose lower end was not found."""
    found = la.safety_factor(cut(1.0, la.VonMises(1.0), cells=1), tolerance=0.5)
    assert "strict bounds" in repr(found)
    open_ended = replace(found, lower=float("nan"))
    assert "not proven: lower end" in repr(open_ended)
    assert open_ended.stands is None
    assert not open_ended.proven


WRONG = {
    "another thing": (lambda p: la.safety_factor(p, of="load"), "of", "'strength'"),
    "no tolerance": (lambda p: la.safety_factor(p, tolerance=0), "tolerance", "> 0"),
    "no cohesion": (
        lambda p: la.safety_factor(cut(1.0, la.MohrCoulomb(0.0, 30))),
        "criterion",
        "small cohesion",
    ),
    "no tension": (  # crushing sets the size of its loads
        lambda p: la.safety_factor(cut(1.0, la.NoTension(5.0))),
        "criterion",
        "negligible cohesion or tensile strength, 5.0e-05 Pa",
    ),
}


@pytest.mark.parametrize(("asked", "field", "fix"), WRONG.values(), ids=WRONG)
def test_what_is_refused(asked, field, fix):
    with pytest.raises(la.InputError) as error:
        asked(cut(1.0, la.VonMises(1.0)))
    assert field in str(error.value)
    assert fix in str(error.value)
