"""Derivatives of load factors: equal to differences of solves, one-sided where there is a kink."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import lacore as la
from lacore.analyses.differences import by_differences
from lacore.analyses.envelope_theorem import Nearby, by_multipliers
from lacore.analyses.parameters import Parameter, parameters_of, without_parameter
from lacore.reporting.kinds import Kind
from tests.lacore.analyses.arches import arch
from tests.lacore.models import cantilever, deformable_block, punch
from tests.lacore.shown import portal, ring, wall

FORCE = 1e-4
"""Of derivatives, per their largest elasticity: what the issue asks for. Central differences of two
steps, extrapolated, leave about 1e-7 of curvature and 1e-6/2e-3 of the bar of a certificate."""
DILATANT = partial(la.Coulomb, associated=True)
WEIGHT = [la.BodyForce("soil", (0, -0.5))]


def soil(criterion, dead=WEIGHT, space="p2-vertex"):
    problem = punch(4, 3, dead=dead)
    mesh = problem.bodies["soil"].mesh
    return replace(problem, bodies={"soil": la.Body(mesh, criterion, space=space)})


def beam():
    """Two spans, a load along one of them, which hinges where its moment peaks."""
    moments = {"A-B": 10.0, "B-C": 12.0}
    frame = la.Frame({"A": (0, 0), "B": (4, 0), "C": (7, 0)}, [("A", "B"), ("B", "C")], moments)
    return la.Problem(
        {"beam": frame},
        [la.Traction("beam", "B-C", (0, -3.0))],
        [la.Fix("beam", "A", "clamped"), la.Fix("beam", ("B", "C"))],
        dead_loads=[la.PointForce("beam", (1.5, 0), (0, -1))],
    )


def stone(mu, height):
    """Pushed at a height: slides or topples about its corner, W = 4, b = 1."""
    block = la.RigidBlock([(0, 0), (1, 0), (1, 4), (0, 4)])
    return la.Problem(
        {"stone": block},
        [la.PointForce("stone", (0.5, height), (1, 0))],
        interfaces=[la.Interface(("stone", lambda x: x[1] == 0), la.RigidObstacle(), mu)],
        dead_loads=[la.BodyForce("stone", (0, -1))],
    )


def plate(criterion):
    mesh = cantilever().bodies["block"].mesh
    return replace(
        cantilever(), bodies={"block": la.Body(mesh, criterion, kinematics="plane_stress")}
    )


def braced():
    """A portal whose sections carry axial force and moment together."""
    section = la.sections.rectangle(0.2, 0.3, 100.0)
    nodes = {"A": (0, 0), "B": (0, 3), "C": (4, 3), "D": (4, 0)}
    frame = la.Frame(nodes, [("A", "B"), ("B", "C"), ("C", "D")], sections=section)
    return la.Problem(
        {"frame": frame},
        [la.PointForce("frame", "B", (1, 0))],
        [la.Fix("frame", "A", "clamped"), la.Fix("frame", "D", "clamped")],
        dead_loads=[la.PointForce("frame", node, (0, -1)) for node in ("B", "C")],
    )


def layered():
    """Two regions of one mesh."""
    problem = soil(la.VonMises(1.0))
    mesh = problem.bodies["soil"].mesh.with_subdomains(
        {"upper": lambda x: x[1] > -1, "lower": lambda x: x[1] < -1}
    )
    criteria = {"upper": la.MohrCoulomb(1.0, 20.0), "lower": la.VonMises(0.3)}
    return replace(problem, bodies={"soil": la.Body(mesh, criteria)})


PROBLEMS = {
    "sections": braced,
    "regions": layered,
    "frame with clamped feet": portal,
    "beam with a line load": beam,
    "dilatant arch": lambda: arch(0.15, DILATANT(0.5)),
    "toppling stone": lambda: stone(DILATANT(0.5), 2.0),
    "von Mises": lambda: soil(la.VonMises(1.0)),
    "Mohr-Coulomb with jumps": lambda: soil(la.MohrCoulomb(1.0, 20.0), space="p2-disc"),
    "Mohr-Coulomb with cut-offs": lambda: soil(
        la.MohrCoulomb(1.0, 20.0, tension_cutoff=0.5, crushing=30.0)
    ),
    "Drucker-Prager": lambda: soil(la.DruckerPrager(1.0, 20.0)),
    "Rankine plate": lambda: plate(la.Rankine(1.0, 5.0)),
    "tube": ring,
    "adhesion and tension": lambda: deformable_block(DILATANT(0.4, adhesion=0.1, tension=0.05)),
    "Tresca friction": lambda: deformable_block(la.Tresca(0.3)),
    "Coulomb block": lambda: deformable_block(0.4),
    "Coulomb arch": lambda: arch(0.15, 0.5),
    "soil that dilates less": lambda: soil(la.MohrCoulomb(1.0, 20.0, dilation_angle=15.0), ()),
}


def central(parameter, problem, at=la.solve):
    """By two steps, extrapolated: errors of the fourth order."""
    slopes = []
    for share in (2e-3, 1e-3):
        step = share * parameter.size
        ends = (at(parameter.at(problem, parameter.value + s * step)).load_factor for s in (1, -1))
        slopes.append((next(ends) - next(ends)) / (2 * step))
    return slopes[1] + (slopes[1] - slopes[0]) / 3


@pytest.mark.parametrize("name", PROBLEMS)
def test_derivatives_are_those_of_solves(name):
    state = la.solve(PROBLEMS[name]())
    found = la.sensitivity(state)
    table = found.table.set_index("parameter")
    assert table["unique"].all()
    assert (table["why"] == "").all()
    problem = state.discretisation.problem
    largest = table["elasticity"].abs().max()
    for parameter in parameters_of(problem):
        wanted = central(parameter, problem) * parameter.size / state.load_factor
        row = table.loc[parameter.name]
        assert row["elasticity"] == pytest.approx(wanted, rel=FORCE, abs=FORCE * largest)
        assert row["derivative"] * parameter.size / state.load_factor == row["elasticity"]


@pytest.mark.parametrize("problem", [portal(), arch(0.15, DILATANT(0.5)), soil(la.VonMises(1.0))])
def test_elasticities_add_up(problem):
    """All loads and strengths twice as large: the same load factor; reference loads alone: half."""
    table = la.sensitivity(la.solve(problem)).table
    live = table["parameter"].str.startswith("reference_loads") & (table["kind"] == "load")
    assert table["elasticity"][live].sum() == pytest.approx(-1, rel=1e-6)
    # Strengths in Pa, N: neither angles nor coefficients, which have no unit.
    force = (table["kind"] == "strength") & ~table["parameter"].str.contains("friction.mu")
    dead = (table["kind"] == "load") & ~live
    assert table["elasticity"][force | dead].sum() == pytest.approx(1, rel=1e-6)
    assert list(table["elasticity"].abs()) == sorted(table["elasticity"].abs(), reverse=True)


def one_sided(found):
    """The parameters whose derivatives are said to be one-sided."""
    (finding,) = (own for own in found.findings if own.kind is Kind.ONE_SIDED)
    return finding.values["parameters"]


def test_where_two_mechanisms_meet_derivatives_are_one_sided():
    """alpha = min(mu W, W b/(2 y)), both equal at mu = 1/2, y = 1: 4, 0 by mu and 0, -2 by y."""
    found = la.sensitivity(la.solve(stone(DILATANT(0.5), 1.0)))
    table = found.table.set_index("parameter")
    mu, height = table.loc["stone.part: friction.mu"], table[table["kind"] == "place"].iloc[0]
    # 1e-4 beside the kink, extrapolated to it: of the order 1e-8 of curvature, and the solver's.
    assert (mu["left"], mu["right"]) == pytest.approx((4, 0), abs=1e-3)
    assert (height["left"], height["right"]) == pytest.approx((0, -2), abs=1e-3)
    assert np.isnan(mu["derivative"])
    assert np.isnan(height["derivative"])
    assert table["unique"].drop([mu.name, height.name]).all()
    assert mu.name in one_sided(found)


def bays(middle=4.0):
    """Two bays of columns and stronger beams, pushed at the first corner: 2 at the middle."""
    nodes = {"A": (0, 0), "B": (0, 3), "C": (middle, 0), "D": (4, 3), "E": (8, 0), "F": (8, 3)}
    moments = {"A-B": 1.0, "C-D": 1.0, "E-F": 1.0, "B-D": 3.0, "D-F": 3.0}
    frame = la.Frame(nodes, [tuple(name.split("-")) for name in moments], moments)
    push = la.PointForce("frame", "B", (1, 0))
    return la.Problem(
        {"frame": frame}, [push], [la.Fix("frame", node, "clamped") for node in "ACE"]
    )


def test_positions_are_one_sided_where_the_stresses_are_not_unique():
    """A symmetric frame: its mechanism is unique, the moments of its beams are not."""
    state = la.solve(bays())
    by_name = {own.name: own for own in parameters_of(bays())}
    own = Parameter("middle", "own", 4.0, 4.0, lambda _, value: bays(value))
    chosen = [by_name["frame: support at C, x"], by_name["frame: plastic_moment['C-D']"], own]
    nearby = Nearby(state, {"backend": state.backend, "coupling": state.coupling})
    place, strength, middle = by_multipliers(state, chosen, nearby)
    # Certified load factors 1 mm to either side of the middle, the same on both.
    wanted = (la.solve(bays(4.001)).load_factor - 2.0) / 1e-3
    assert wanted == pytest.approx(5 / 12, abs=1e-4)
    for row in (place, middle):
        assert not row["unique"]
        assert (row["left"], row["right"]) == pytest.approx((-wanted, wanted), abs=1e-4)
    assert strength == {
        "left": strength["left"],
        "right": strength["left"],
        "unique": True,
        "why": "",
    }
    assert strength["left"] == pytest.approx(2 / 3, abs=1e-6)


@pytest.mark.parametrize(
    ("criterion", "wanted"),
    [
        (la.NoTension(5.0), {"compressive_strength": 1.0}),
        (la.Rankine(1.0, 5.0), {"compressive_strength": 1.0, "tensile_strength": 0.0}),
    ],
)
def test_a_block_that_crushes_has_the_derivative_of_its_crushing_strength(criterion, wanted):
    """Pressed between smooth ends it carries that strength, whatever it carries in tension."""
    block = la.Body(la.meshes.rectangle((0, 1), (0, 1), 2, 2), criterion)
    problem = la.Problem(
        {"block": block}, [la.Pressure("block", "top")], [la.Fix("block", "bottom", "normal")]
    )
    table = la.sensitivity(la.solve(problem)).table.set_index("parameter")
    found = {name: table["derivative"][f"block: criterion.{name}"] for name in wanted}
    assert found == pytest.approx(wanted, abs=1e-6)


def test_nodes_move_along_the_members_that_they_divide():
    """D divides the beam and stands on a column: it moves along the beam, and the rest is said."""
    nodes = {"A": (0, 3), "B": (8, 3), "C": (4, 0), "D": (4, 3)}
    frame = la.Frame(nodes, [("A", "B"), ("C", "D")], 1.0)
    problem = la.Problem(
        {"f": frame},
        [la.PointForce("f", "D", (1, 0)), la.Traction("f", "A-B", (0, -1))],
        [la.Fix("f", ("A", "B"), "y"), la.Fix("f", "C", "clamped")],
    )
    places = {own.name for own in parameters_of(problem) if own.kind == "place"}
    assert "f: force at D, x" in places
    assert "f: force at D, y" not in places
    reason = "f: force at D, across its members (its members must remain straight)"
    assert reason in without_parameter(problem)


def by_rule(rule):
    """Differences of a load factor that is a function of one number at 1."""
    number = Parameter("x", "own", 1.0, 1.0, lambda _, value: value)
    return by_differences(number, None, rule(1.0), rule)


def test_a_state_of_another_branch_is_no_kink():
    """One whole step away another branch is found: the derivative is that of smaller steps."""
    found = by_rule(lambda x: 5.67 * x + (1e-3 if x > 1.002 else 0.0))
    assert (found["left"], found["right"]) == pytest.approx((5.67, 5.67), abs=1e-6)
    assert found["unique"]


def test_a_jump_beside_a_state_has_no_derivative():
    found = by_rule(lambda x: 5.67 * x + (1e-3 if x > 1.0 else 0.0))
    assert np.isnan(found["right"])
    assert "other states" in found["why"]


def test_coulomb_derivatives_say_that_they_are_differences():
    found = la.sensitivity(la.solve(wall()))
    assert set(found.table["method"]) == {"differences"}
    assert found.findings[0].kind is Kind.BY_DIFFERENCES
    assert found.plot().get_suptitle().endswith("by differences")
    by_theorem = la.sensitivity(la.solve(portal()))
    assert set(by_theorem.table["method"]) == {"multipliers"}
    assert by_theorem.findings[0].kind is Kind.BY_MULTIPLIERS


def test_a_coulomb_kink_has_two_differences():
    """Where a stone slides and topples at one push, each way has a derivative of its own."""
    height = 2.0  # alpha = min(mu W, W b/(2 y)): 1/4 against 1/4, W = 4

    def stone(mu):
        block = la.RigidBlock([(0, 0), (1, 0), (1, 4), (0, 4)])
        return la.Problem(
            {"stone": block},
            [la.PointForce("stone", (0.0, height), (1, 0))],
            interfaces=[la.Interface(("stone", lambda x: x[1] == 0), la.RigidObstacle(), mu)],
            dead_loads=[la.BodyForce("stone", (0, -1))],
        )

    found = la.sensitivity(la.solve(stone(0.25)))
    (friction,) = (row for row in found.table.to_dict("records") if ".mu" in row["parameter"])
    assert friction["method"] == "differences"
    assert not friction["unique"]
    assert np.isnan(friction["derivative"])
    # W below, where it slides; 0 above, where it topples: differences of states certified to 1e-6.
    assert (friction["left"], friction["right"]) == pytest.approx((4.0, 0.0), abs=1e-2)
    assert friction["parameter"] in one_sided(found)


def test_associated_states_of_coulomb_problems_have_multipliers():
    state = la.solve(arch(0.15, 0.5), coupling="associated")
    table = la.sensitivity(state).table.set_index("parameter")
    assert set(table["method"]) == {"multipliers"}
    row = table.loc["arch: friction.mu"]
    at = partial(la.solve, coupling="associated")
    (mu,) = (own for own in parameters_of(arch(0.15, 0.5)) if own.name == row.name)
    assert row["derivative"] == pytest.approx(central(mu, arch(0.15, 0.5), at), abs=1e-6)


def test_own_parameters_are_differentiated_through_the_geometry():
    """A thickness moves all stones: by multipliers it is what solves beside it say."""
    state = la.solve(arch(0.15, DILATANT(0.5)))
    thicker = partial(arch, mu=DILATANT(0.5))
    table = la.sensitivity(state, own={"thickness": (thicker, 0.15)}).table.set_index("parameter")
    step = 1e-3
    alpha = {k: la.solve(thicker(0.15 + k * step)).load_factor for k in (-2, -1, 1, 2)}
    wanted = (8 * (alpha[1] - alpha[-1]) - (alpha[2] - alpha[-2])) / (12 * step)
    assert table.loc["thickness"]["derivative"] == pytest.approx(wanted, rel=1e-4)
    with pytest.raises(la.InputError, match="not the same problem"):
        la.sensitivity(state, own={"thickness": (thicker, 0.16)})
    with pytest.raises(la.InputError, match=r"own\['thickness'\]"):
        la.sensitivity(state, own={"thickness": thicker})


def test_a_force_at_the_edge_of_a_block_says_why_it_has_none():
    problem = stone(DILATANT(0.3), 2.0)
    at_edge = problem.with_loads([la.PointForce("stone", (0.0, 2.0), (1, 0))])
    table = la.sensitivity(la.solve(at_edge)).table.set_index("parameter")
    row = table.loc["reference_loads[0]: x of the force on stone"]
    assert np.isnan(row["derivative"])
    assert "lies on no block" in row["why"]


def test_what_has_no_derivative_is_refused():
    with pytest.raises(la.InputError, match="no certified load factor"):
        la.sensitivity(la.solve(portal(), options={"max_iterations": 1}))
    with pytest.raises(la.InputError, match="is regularised"):
        la.sensitivity(la.solve(punch(2, 2), "clarabel-regularised"))
    with pytest.raises(la.InputError, match="without the friction"):
        la.sensitivity(la.solve(wall(), coupling="stick"))
    with pytest.raises(la.InputError, match="no LimitState"):
        la.sensitivity(portal())


def test_a_range_of_coulomb_loads_is_no_function():
    """A prismatic plug between blocks (CLOSED_FORMS C7, beta = 0): any load of an interval."""
    blocks = {
        "floor": la.masonry.rectangle(-4, 4, -1, 0),
        "left": la.masonry.rectangle(-2.5, -0.5, 0, 1),
        "right": la.masonry.rectangle(0.5, 2.5, 0, 1),
    }
    blocks["plug"] = la.masonry.rectangle(-0.5, 0.5, 0.2, 1.2)  # above the floor
    friction = {("left", "plug"): 0.5, ("plug", "right"): 0.5}
    problem = la.Problem(
        {"wedge": la.BlockAssembly(blocks, 0.4, friction)},
        [la.PointForce("wedge", "plug", (0, -1))],
        [la.Fix("wedge", "floor")],
        dead_loads=[la.BodyForce("wedge", (0, -1))],
    )
    state = la.solve(problem)
    assert state.status is la.Status.SOLVED
    with pytest.raises(la.InputError, match="carries every load factor"):
        la.sensitivity(state)


def test_a_range_that_is_not_known_is_none(monkeypatch):
    """Of a mechanism that is not certified again nobody knows which load factors it carries."""
    state = la.solve(deformable_block(0.5))
    interval = state.interval()
    end = replace(interval.lower, load_factor=np.nan)
    unknown = replace(interval, lower=end, upper=end)
    monkeypatch.setattr(la.LimitState, "interval", lambda _: unknown)
    with pytest.raises(la.InputError, match="carries every load factor"):
        la.sensitivity(state)


def test_a_field_counts_by_its_factor():
    """Strength alone: its elasticity is 1; how steep it is at most is no strength."""
    varies = la.VonMises(la.Field(lambda x: 1 + 0.1 * x[0], steepest=0.2))
    table = la.sensitivity(la.solve(soil(varies, dead=()), throw=True)).table
    (row,) = table[table["kind"] == "strength"].to_dict("records")
    assert row["parameter"].endswith("(factor)")
    assert row["elasticity"] == pytest.approx(1, rel=1e-6)
