"""Critical values with certificates at both ends, limit thicknesses, what stands."""

import numpy as np
import pytest

import lacore as la
from tests.lacore.analyses.arches import arch, room
from tests.lacore.models import cantilever, deformable_block
from tests.lacore.shown import unsafe, wall

SIX_DIGITS = 5e-7


@pytest.mark.parametrize("mu", [0.5, 0.35])
def test_limit_thickness_of_an_arch_is_that_of_statics(mu):
    """At mu = .5 it hinges, at .35 it slides, too; both solvers agree to six digits."""
    found = {
        backend: la.limit_thickness(lambda t: arch(t, mu), (0.05, 0.5), backend=backend)
        for backend in ("highs", "clarabel")
    }
    for one in found.values():
        assert one.status is la.Search.FOUND
        assert one.rises is True
        assert one.high - one.low <= SIX_DIGITS * one.value
        # An own linear program of the thrust: no forces fit below, some do above.
        assert room(one.low, mu) < 0 < room(one.high, mu)
    assert found["highs"].value == pytest.approx(found["clarabel"].value, rel=SIX_DIGITS)


def test_of_many_stones_it_is_that_of_milankovitch():
    """0.1075 of the radius for a continuum of stones; 1 in 27 joints away it is 1 % less."""
    assert la.limit_thickness(arch, (0.05, 0.5)).value == pytest.approx(0.1075, rel=0.01)


def test_a_thickness_stands_or_falls_by_proof():
    thin, thick = la.stable(arch(0.1)), la.stable(arch(0.12))
    assert thin.stands is False
    assert not thin
    assert thick.stands is True
    assert thick
    # The mechanism: driven by the dead load, at Fd.u = 1, and nothing dissipates.
    moved = thin.state.point.velocity
    assert thin.state.discretisation.full.dead_load @ moved == pytest.approx(1, rel=1e-9)
    assert thin.stability.residual <= 1e-6
    assert thick.stability.residual <= 1e-6
    assert np.isnan(thin.stability.low)


def test_what_its_weight_lifts_falls_and_a_wall_stands():
    assert la.stable(unsafe()).stands is False
    assert la.stable(wall()).stands is True


@pytest.mark.parametrize(
    "material", [la.VonMises(shear_strength=1.0), la.MohrCoulomb(1.0, 5, dilation_angle=0.0)]
)
@pytest.mark.parametrize(("weight", "cells", "stands"), [(2, 1, True), (5, 1, None), (5, 4, False)])
def test_equilibrium_on_one_mesh_does_not_make_a_cut_stand(material, weight, cells, stands):
    """A vertical cut of height 1 with k = 1 falls above 3.8, or 4.2 with 5 degrees of friction.

    Velocities of few elements do not see how at 5, and stresses of each element prove it at 2.
    """
    mesh = la.meshes.rectangle((0, 3), (0, 1), 3 * cells, cells)
    problem = la.Problem(
        {"soil": la.Body(mesh, material)},
        [la.Traction("soil", "top", (1, 0))],
        [la.Fix("soil", "left"), la.Fix("soil", "bottom")],
        dead_loads=[la.BodyForce("soil", (0, -weight))],
    )
    found = la.stable(problem)
    assert found.stands is stands
    assert la.solve(problem).stability().standing.label == (
        "falls" if stands is False else "stands"
    )
    assert ("not proven" in str(found)) == (stands is None)


def test_stable_asks_for_dead_loads():
    with pytest.raises(la.InputError, match=r"Problem.dead_loads: there is none"):
        la.stable(cantilever())
    with pytest.raises(la.InputError, match=r"problem_at\(1\): Problem.dead_loads"):
        la.limit_thickness(lambda t: cantilever(), (1, 2))


def test_without_joints_the_factor_of_dead_loads_is_one():
    """A cantilever beam of M_p = 10 under q per length: q L^2/2 = M_p."""

    def beam(length):
        frame = la.Frame({"A": (0, 0), "B": (length, 0)}, [("A", "B")], plastic_moment=10.0)
        return la.Problem(
            {"beam": frame},
            [la.PointForce("beam", "B", (0, -1))],
            [la.Fix("beam", "A", "clamped")],
            dead_loads=[la.Traction("beam", "A-B", (0, -5.0))],
        )

    found = la.limit_thickness(beam, (1.0, 4.0))
    assert found.value == pytest.approx(2.0, rel=2e-7)
    assert found.rises is False


@pytest.mark.parametrize(("mu", "exact"), [(0.9, 1.0), (0.2, 1.2)])
def test_a_portal_whose_feet_rest_on_the_ground(mu, exact):
    """Under q along its beam: it breaks, q L^2/16, or spreads its feet, q L^2/8 - mu q L h/2.

    A push so large that the portal carries next to none of it plays no part.
    """

    def portal(moment):
        frame = la.Frame(
            {"A": (0, 0), "B": (0, 2), "C": (4, 2), "D": (4, 0)},
            [("A", "B"), ("B", "C"), ("C", "D")],
            plastic_moment=moment,
        )
        floor = la.RigidObstacle((0, 0), (0, 1))
        return la.Problem(
            {"portal": frame},
            [la.PointForce("portal", "B", (1e3, 0))],
            interfaces=[la.Interface(("portal", foot), floor, mu) for foot in ("A", "D")],
            dead_loads=[la.Traction("portal", "B-C", (0, -1))],
        )

    found = la.limit_thickness(portal, (0.5, 3.0))
    assert found.value == pytest.approx(exact, rel=2e-6)  # hinges within members: the bar


def test_friction_at_which_a_block_just_carries_its_push():
    """CLOSED_FORMS C14, b/h = 4, p = 1: alpha = min(4 mu, 3) is 2 at mu = 1/2."""
    found = la.critical(deformable_block, (0.1, 0.9), target=2.0)
    assert found.value == pytest.approx(0.5, rel=2e-7)
    assert found.low < found.value < found.high
    assert found.at_low.load_factor < 2 < found.at_high.load_factor
    assert found.at_low.status is found.at_high.status is la.Status.SOLVED
    assert "of: load factor of the discrete problem" in str(found)


def test_sides_that_are_the_same_are_said():
    found = la.critical(deformable_block, (0.1, 0.9), target=5.0)
    assert found.status is la.Search.SAME_SIDE
    assert len(found.table) == 11
    assert np.isnan(found.value)
    seen = found.table["load_factor"]
    assert f"{seen.min():.6g} to {seen.max():.6g}; 5 is looked for" in str(found)
    assert "is not proven" in found.message


def test_a_load_factor_that_comes_back_is_seen():
    """A stone of width b on a floor, pushed at height 1: it topples first where it is narrow."""

    def stone(height):
        block = la.RigidBlock([(0, 0), (1, 0), (1, 4), (0, 4)])
        return la.Problem(
            {"stone": block},
            [la.PointForce("stone", (0.0, height), (1, 0))],
            interfaces=[la.Interface(("stone", lambda x: x[1] == 0), la.RigidObstacle(), 0.25)],
            dead_loads=[la.BodyForce("stone", (0, -1))],
        )

    # alpha = min(mu W, W b/(2 y)), W = 4: 1 up to y = 2, then 2/y.
    found = la.critical(lambda x: stone(2.0 + 2.0 * abs(x)), (-0.5, 0.9), target=0.8, scan=6)
    assert [own.value for own in found.crossings] == pytest.approx([-0.25, 0.25], rel=1e-6)
    assert [own.rises for own in found.crossings] == [True, False]
    for own in found.crossings:
        assert own.status is la.Search.FOUND
        assert own.high - own.low <= 1e-7
        above = own.at_low.load_factor - 0.8, own.at_high.load_factor - 0.8
        assert min(above) < 0 < max(above)
    assert found.value == found.crossings[0].value
    assert found.rises is True
    assert "the first of 2 that were seen: also 0.25" in found.message


def test_what_was_found_is_kept(tmp_path):
    calls = []

    def problem(mu):
        calls.append(mu)
        return deformable_block(mu)

    given = {"target": 2.0, "folder": tmp_path, "tolerance": 0.1}
    first = la.critical(problem, (0.1, 0.9), **given)
    again = la.critical(problem, (0.1, 0.9), **given)
    assert not first.table["kept"].any()
    assert again.table["kept"].all()
    assert (again.low, again.high) == (first.low, first.high)
    assert again.at_low.certificate.holds(1e-6)  # states are not kept: solved anew
    for file in tmp_path.iterdir():
        file.write_text("{", encoding="utf-8")  # what cannot be read was never found
    third = la.critical(problem, (0.1, 0.9), **given)
    assert not third.table["kept"].any()


def test_a_problem_that_cannot_be_is_named_with_its_value():
    with pytest.raises(la.InputError, match=r"problem_at\(-1\): .*thickness"):
        la.critical(arch, (-1, 1))
    with pytest.raises(la.InputError, match=r"problem_at = .*: .* give a function of a value"):
        la.critical(la.examples.column(friction=0.9), (0.1, 1))
    with pytest.raises(la.InputError, match="within"):
        la.critical(arch, (1, 0.5))
    with pytest.raises(la.InputError, match="target"):
        la.critical(arch, (0.1, 0.5), target=np.nan)


def test_a_value_without_a_certificate_is_said():
    found = la.critical(deformable_block, (0.1, 0.9), target=2.0, options={"max_iterations": 1})
    assert found.status is la.Search.NOT_CERTIFIED
    assert np.isnan(found.value)


def beam(place):
    """Spans of 4 and 3 m, clamped at the left end, M_p = 10, a load of 1 at a place."""
    frame = la.Frame(
        {"A": (0, 0), "B": (4, 0), "C": (7, 0)}, [("A", "B"), ("B", "C")], plastic_moment=10.0
    )
    return la.Problem(
        {"beam": frame},
        [la.PointForce("beam", (place, 0), (0, -1))],
        [la.Fix("beam", "A", "clamped"), la.Fix("beam", "B"), la.Fix("beam", "C")],
    )


def test_worst_position_of_a_wheel_on_a_beam():
    """Span 3 m between a support that hinges and a pin: M_p (3 + 2 sqrt 2)/L at (sqrt 2 - 1) L."""
    found = la.worst_position(beam, (0.5, 6.9), scan=12)
    assert found.load_factor == pytest.approx(10 * (3 + 8**0.5) / 3, rel=1e-5)
    # A minimum is found to the root of what its load factor is: 1e-3 of the way was asked.
    assert found.position == pytest.approx(7 - 3 * (2**0.5 - 1), abs=2e-3 * 6.4)
    assert found.state.load_factor == found.load_factor
    assert found.table["load_factor"].min() == found.load_factor
    assert "not proven" in found.message


def test_above_a_support_a_wheel_is_carried_whatever_its_weight():
    found = la.worst_position(beam, (3.0, 5.0), scan=3, tolerance=0.1)
    row = found.table.set_index("parameter").loc[4.0]
    assert (row["status"], row["load_factor"]) == ("locked", np.inf)
    assert found.load_factor < np.inf


@pytest.mark.parametrize(("load", "carried"), [(9.0, np.inf), (11.0, -np.inf)])
def test_above_a_support_the_dead_loads_decide(load, carried):
    """Clamped at one end and continuous at the other a span carries q = 16 M_p/L^2 = 10."""

    def loaded(place):
        dead = [la.Traction("beam", "A-B", (0, -load))]
        return beam(place).with_loads(dead_loads=dead)

    found = la.worst_position(loaded, (3.0, 5.0), scan=3, tolerance=0.5)
    assert found.table.set_index("parameter").loc[4.0, "load_factor"] == carried


def test_a_position_at_which_all_falls_is_the_worst():
    stone, calls = wall(), []

    def problem(place):
        calls.append(place)
        weight = -1 if place < 0.5 else 1
        return stone.with_loads(dead_loads=[la.BodyForce("wall", (0, weight))])

    found = la.worst_position(problem, (0.0, 1.0), scan=3)
    assert found.load_factor == -np.inf
    assert found.position >= 0.5
    assert len(calls) == 3
