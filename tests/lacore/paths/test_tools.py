"""Rigid tools that move along a path: what they feel, and what they cannot be."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.paths.contact.poses import placed, pose
from lacore.paths.ending import Ending
from lacore.pictures.thumbnails import thumbnail_of_path
from lacore_verification.cases.shared.exact_paths import strip_force

LAW = la.hardening.Linear(1.0, 1.0)
SAME = 1e-6  # relative: certificates hold to 1e-6
CLOSING = la.ToolTravel({"low": (0, 1), "up": (0, -1)})
UPPER = [(-0.5, 0.5), (3, 0.5), (3, 0.8), (-0.5, 0.8)]
LOWER = [(-0.5, -0.8), (3, -0.8), (3, -0.5), (-0.5, -0.5)]


def metal(x, y, nx, ny):
    mesh = la.meshes.quadrilaterals(x, y, nx, ny)
    return la.Body(mesh, la.VonMises(hardening=LAW), space="q2")


def upset(friction=0.0):
    """Half of a block between two platens, which are rigid blocks."""
    return la.Problem(
        {
            "block": metal((0, 1), (-0.5, 0.5), 2, 2),
            "up": la.RigidBlock(UPPER),
            "low": la.RigidBlock(LOWER),
        },
        [la.PointForce("up", "block", (0, -1))],
        [la.Fix("block", "left", "x")],
        [
            la.Interface(("block", "top"), ("up", "block"), friction),
            la.Interface(("low", "block"), ("block", "bottom"), friction),
        ],
    )


def quarter(friction):
    """The same as a quarter that is pushed up against an obstacle at rest."""
    return la.Problem(
        {"block": metal((0, 1), (0, 0.5), 2, 1)},
        [la.RigidFooting("block", "bottom", (0, 1), rough=False)],
        [la.Fix("block", "left", "x")],
        [la.Interface(("block", "top"), la.RigidObstacle((0, 0.5), (0, -1)), friction)],
    )


def pressed(problem, control, travel=0.1, scheme="implicit-midpoint"):
    return la.sequential(problem, travel, 1, scheme, control=control)


@pytest.mark.parametrize(
    ("friction", "scheme"),
    [
        (0.0, "implicit-midpoint"),
        (0.1, "explicit"),
        pytest.param(0.1, "implicit-midpoint", marks=pytest.mark.slow),
    ],
)
def test_two_platens_that_close_press_like_an_obstacle_at_rest(friction, scheme):
    path = pressed(upset(friction), CLOSING, scheme=scheme)
    known = pressed(quarter(friction), None, scheme=scheme)
    assert path.status is Ending.REACHED, path.message
    force = float(known.history.force.iloc[0])
    if not friction:
        assert force == pytest.approx(strip_force(LAW, 0.8), rel=1e-8)
    assert path.history.force.iloc[0] == pytest.approx(2 * force, rel=SAME)  # of both platens
    forces = path.tool_forces().set_index("body")
    assert forces.f_y["up"] == pytest.approx(force, rel=SAME)
    assert forces.f_y["low"] == pytest.approx(-force, rel=SAME)
    assert forces.f_x.to_numpy() == pytest.approx(forces.f_x["up"], rel=SAME, abs=SAME)
    assert (forces.f_x > 0.01).all() == bool(friction)  # platens hold the block back


def test_only_the_relative_motion_of_tools_counts():
    moving = la.ToolTravel({"up": (0, -2), "low": (0, 0)})
    one, other = (pressed(upset(0.1), control, scheme="explicit") for control in (CLOSING, moving))
    assert other.history.force.iloc[0] == pytest.approx(one.history.force.iloc[0], rel=SAME)
    low = other.snapshots[-1].configuration.nodes["low"]
    assert low == pytest.approx(other.snapshots[0].configuration.nodes["low"], abs=1e-12)


def test_a_tool_feels_the_same_by_a_force_and_by_its_travel():
    """One smooth platen: a unit force pushes it along its support, or its travel is given."""
    held = upset()
    held = replace(
        held, supports=[*held.supports, la.Fix("low", "block"), la.Fix("up", "block", "x")]
    )
    by_force = pressed(held, la.Time(), 0.1)
    by_travel = pressed(held, la.ToolTravel({"up": (0, -1)}), 0.1)
    loads = [path.history.force.iloc[0] for path in (by_force, by_travel)]
    assert loads == pytest.approx([strip_force(LAW, 0.9)] * 2, rel=1e-6)


def test_a_block_that_turns_keeps_its_shape():
    block = la.RigidBlock([(0, 0), (2, 0), (2, 1), (0, 1)])
    turned = placed(block, pose(block) + np.array([[0.5], [0.0], [np.pi / 2]]))
    assert turned.area == pytest.approx(block.area, rel=1e-14)
    assert turned.centroid == pytest.approx(block.centroid + np.array([[0.5], [0.0]]), abs=1e-14)
    assert np.ptp(turned.edges.start, axis=1) == pytest.approx([1, 2])
    assert placed(block, pose(block)) is block


def two_blocks():
    cut = la.BlockAssembly({"a": UPPER, "b": [(3, 0.5), (4, 0.5), (4, 0.8), (3, 0.8)]}, 0.3)
    problem = upset()
    load = [la.PointForce("up", "a", (0, -1))]
    return problem, cut, load


WRONG = {
    "unknown": ({"left": (0, 1)}, r"no rigid block has this name.*'low', 'up'"),
    "deformable": ({"block": (0, 1)}, "no rigid block has this name"),
    "none": ({}, "names no tool"),
    "still": ({"up": (0, 0)}, "moves no tool"),
    "text": ({"up": "down"}, r"not a velocity.*give \(x, y\)"),
}


@pytest.mark.parametrize(("velocity", "message"), WRONG.values(), ids=WRONG)
def test_what_a_tool_travel_cannot_be(velocity, message):
    with pytest.raises(la.InputError, match=message):
        pressed(upset(), la.ToolTravel(velocity))


def test_a_support_does_not_hold_a_tool_that_is_driven():
    problem = upset()
    held = replace(problem, supports=[*problem.supports, la.Fix("up", "block", "y")])
    with pytest.raises(la.InputError, match=r"holds the block against this motion.*leave the supp"):
        pressed(held, CLOSING)


def test_the_joints_of_one_assembly_are_not_followed():
    problem, cut, load = two_blocks()
    bodies = {**problem.bodies, "up": cut}
    contact = [
        la.Interface(("block", "top"), ("up", "a"), 0.0),
        la.Interface(("low", "block"), ("block", "bottom"), 0.0),
    ]
    jointed = replace(problem, bodies=bodies, interfaces=contact, reference_loads=load)
    with pytest.raises(la.InputError, match=r"joints between the blocks.*a body of its own"):
        pressed(jointed, la.Time())


def test_a_load_on_a_tool_goes_by_name():
    def above(x):
        return x[1] > 0.8 - 1e-9

    problem = replace(upset(), reference_loads=[la.Traction("up", above, (0, -1))])
    with pytest.raises(la.InputError, match=r"moves away from them.*name of the block"):
        pressed(problem, CLOSING)


@pytest.mark.slow
def test_pictures_show_tools(tmp_path):
    path = pressed(upset(), CLOSING)
    drawn = path.plot()
    assert "rigid block" in {own.get_text() for axes in drawn.axes for own in _legend(axes)}
    path.last.plot().savefig(tmp_path / "state.png")
    path.animate(tmp_path / "path.gif")
    thumbnail_of_path(path).savefig(tmp_path / "thumbnail.png")


def _legend(axes):
    legend = axes.get_legend()
    return legend.get_texts() if legend else []
