"""One structure under several loads: the least governs, and what fails is named."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from tests.lacore.analyses.arches import arch
from tests.lacore.models import punch, under_footing
from tests.lacore.shown import portal, wall
from tests.rigid_problems import wedge_extraction

WIND = [la.PointForce("portal", "B", (1, 0))]
SNOW = [la.Traction("portal", "B-C", (0, -1))]


def test_the_least_load_factor_governs():
    """Portal of CLOSED_FORMS with clamped feet: sway 4 Mp/h, beam 16 Mp/L^2; both at once less."""
    found = la.load_cases(portal(), {"wind": WIND, "snow": SNOW, "both": [*WIND, *SNOW]})
    alpha = found.table.set_index("case")["load_factor"]
    # 1e-6: the bar of the certificate; of a line load, that of moments inside its member.
    assert alpha["wind"] == pytest.approx(4 * 10 / 3, rel=1e-6)
    assert alpha["snow"] == pytest.approx(16 * 10 / 4**2, rel=2e-6)
    assert found.governing == "both"
    assert found.sure
    assert list(found.table["governs"]) == [False, False, True]
    assert found.results["both"].load_factor == alpha["both"] < min(alpha["wind"], alpha["snow"])


def test_processes_give_the_same_table():
    cases = {"wind": WIND, "snow": SNOW, "both": [*WIND, *SNOW]}
    seen = []
    one = la.load_cases(portal(), cases)
    two = la.load_cases(portal(), cases, workers=2, on_case=seen.append)
    assert seen == list(cases)
    # Same program, same solver: equal but for what it leaves, far below the bar.
    assert np.allclose(one.table["load_factor"], two.table["load_factor"], rtol=1e-6)


def test_what_falls_by_itself_governs_and_what_is_locked_never_does():
    stone = wall()
    cases = {
        "push": stone.reference_loads,
        "down": [la.BodyForce("wall", (0, -1))],
        "floats": stone.with_loads(dead_loads=[la.BodyForce("wall", (0, 1))]),
    }
    found = la.load_cases(stone, cases)
    assert list(found.table["status"]) == ["solved", "locked", "unsafe"]
    assert found.table["load_factor"].iloc[1:].tolist() == [np.inf, -np.inf]
    assert found.governing == "floats"
    without = la.load_cases(stone, {name: cases[name] for name in ("push", "down")})
    assert without.governing == "push"


def test_brackets_that_overlap_do_not_decide():
    problem = punch(6, 4)
    smooth = [la.RigidFooting("soil", under_footing, (0, -1), rough=False)]
    cases = {"rough": problem.reference_loads, "smooth": smooth}
    found = la.load_cases(problem, cases, target_width=0.2)
    assert not found.sure
    assert "brackets overlap" in found.message
    table = found.table.set_index("case")
    assert (table["lower"] < 2 + np.pi).all()
    assert (table["upper"] > 2 + np.pi).all()


def test_load_factors_of_one_mesh_do_not_decide():
    """Strict upper bounds of both say nothing of how low the other case may lie."""
    problem = punch(6, 4)
    twice = [la.RigidFooting("soil", under_footing, (0, -1), pressure=2.0)]
    found = la.load_cases(problem, {"once": problem.reference_loads, "twice": twice})
    assert found.governing == "twice"
    assert not found.sure
    assert "not proven against 'once'" in found.message
    assert (found.table["lower"] == -np.inf).all()
    # Enclosed, they decide: 2 + pi and half of it.
    enclosed = la.load_cases(
        problem, {"once": problem.reference_loads, "twice": twice}, target_width=0.4
    )
    assert enclosed.sure


@pytest.mark.parametrize(("friction", "sure"), [(0.65, False), (la.Tresca(2.0), True)])
def test_a_coulomb_load_factor_of_several_does_not_decide(friction, sure):
    """Stones that slide by Coulomb's law may have another state, with a lower load factor."""
    stone = wall(friction)
    push = stone.reference_loads
    cases = {"push": push, "half": stone.with_loads(reference_loads=[*push, *push])}
    found = la.load_cases(stone, cases)
    assert found.governing == "half"
    assert found.sure == sure
    assert ("coulomb_range" in found.message) == (not sure)


def held_wedge():
    """CLOSED_FORMS C8b: pulled out of fixed walls it carries its weight, dilatant friction any."""
    free = wedge_extraction()
    return la.Problem(
        free.bodies,
        free.reference_loads,
        [la.Fix("blocks", ("base", "left", "right"))],
        dead_loads=free.dead_loads,
    )


@pytest.mark.parametrize("coupling", ["associated", "stick"])
def test_what_stronger_friction_locks_proves_nothing_of_the_friction_stated(coupling):
    problem = held_wedge()
    pull = problem.reference_loads
    aside = [la.PointForce("blocks", "wedge", (1, 0)), *pull]
    found = la.load_cases(problem, {"out": pull, "aside": aside}, coupling=coupling)
    table = found.table.set_index("case")
    weight = 1 + np.tan(0.2)  # height times mean width
    assert table.loc["out", "status"] == "locked"
    assert table.loc["out", "lower"] < weight < table.loc["out", "upper"]
    assert not found.sure
    assert la.load_cases(problem, {"out": pull}).table["load_factor"].item() == pytest.approx(
        weight
    )


def test_what_falls_without_friction_may_stand_with_it():
    """Every arch: its dead loads collapse it without friction, and with it they do not."""
    problem = arch(0.2)
    push = {"push": problem.reference_loads}
    without = la.load_cases(problem, push, coupling="frictionless").table.iloc[0]
    carried = la.load_cases(problem, push).table["load_factor"].item()
    assert without["status"] == "unsafe"
    assert without["lower"] < carried < without["upper"]


def test_brackets_of_what_is_locked_and_what_falls():
    """A body in an open box is pressed into it by any weight, and sheared at its top by k."""
    mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=2, ny=2)
    problem = la.Problem(
        {"soil": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        [la.BodyForce("soil", (0, -1))],
        [la.Fix("soil", side) for side in ("left", "right", "bottom")],
    )
    cases = {"down": problem.reference_loads, "aside": [la.Traction("soil", "top", (1, 0))]}
    found = la.load_cases(problem, cases, target_width=0.3)
    down = found.table.set_index("case").loc["down"]
    assert (down["status"], down["load_factor"], down["lower"]) == ("locked", np.inf, np.inf)
    assert found.failed == ()
    assert found.governing == "aside"
    assert found.sure
    # A cut of a thousand times its strength in weight falls, however its face is pressed.
    heavy = replace(problem, supports=[la.Fix("soil", side) for side in ("left", "bottom")])
    heavy = heavy.with_loads([la.Pressure("soil", "right")], [la.BodyForce("soil", (0, -1e3))])
    both = la.load_cases(problem, {"heavy": heavy, "aside": cases["aside"]}, target_width=0.3)
    row = both.table.set_index("case").loc["heavy"]
    assert (row["status"], row["load_factor"], row["upper"]) == ("unsafe", -np.inf, -np.inf)
    assert both.governing == "heavy"
    assert both.sure


def test_a_bracket_takes_no_coupling():
    with pytest.raises(la.InputError, match=r"coupling = 'stick'.*target_width"):
        la.load_cases(punch(), {"p": punch().reference_loads}, coupling="stick", target_width=0.2)


def test_cells_that_stand_for_crushing_joints_prove_nothing_of_them():
    """One cell a corner carries 0.2 here, and pressures (0.4 m - 0.08 m)/1 m of the weight."""
    stone = {"block": (0.4, 0.2, 1.0), "crushing": la.Crushing(1e5, divisions=1)}
    pier = la.Problem(
        {"pier": la.masonry3d.wall([[1]], friction=la.Tresca(1e4), **stone)},
        [la.BodyForce("pier", (20e3, 0, 0))],
        [la.Fix("pier", "base")],
        dead_loads=[la.BodyForce("pier", (0, 0, -20e3))],
    )
    table = la.load_cases(pier, {"push": pier.reference_loads}).table.iloc[0]
    exact = la.crushing_bracket(pier, target_width=1e-4).low
    assert table["load_factor"] < 0.99 * exact
    assert table["lower"] < exact < table["upper"]
    assert table["rigor"] == "discrete"  # from below, and no upper bound
    assert "exact" not in str(la.solve(pier))
    found = la.coulomb_range(pier, restarts=0)
    assert "crushing_bracket" in found.missing
    assert found.continuum == (-np.inf, np.inf)


def test_a_case_that_is_not_certified_is_named():
    cases = {"wind": WIND, "snow": SNOW}
    found = la.load_cases(portal(), cases, options={"max_iterations": 1})
    assert found.failed == ("wind", "snow")
    assert "wind" in found.message
    assert found.governing == ""


@pytest.mark.parametrize(
    ("case", "said"),
    [
        ([la.PointForce("portal", "X", (1, 0))], "cases['wind']: reference_loads[0].at = 'X'"),
        ([], "cases['wind']: reference_loads"),
        (
            [la.PointForce("portal", "A", (1, 0))],
            "cases['wind']: reference_loads: they do no power",
        ),
    ],
)
def test_loads_that_cannot_be_are_refused_with_their_case(case, said):
    with pytest.raises(la.InputError, match=r"cases\['wind'\]") as caught:
        la.load_cases(portal(), {"snow": SNOW, "wind": case})
    assert said in str(caught.value)


def test_no_case_is_refused():
    with pytest.raises(la.InputError, match="no load case"):
        la.load_cases(portal(), {})
