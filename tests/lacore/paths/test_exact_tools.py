"""Tools of an exact shape that move: what they press, feel, and cannot be."""

import numpy as np
import pytest

import lacore as la
from lacore.paths.ending import Ending
from verification.cases.shared.exact_paths import strip_force

LAW = la.hardening.Linear(1.0, 1.0)
SAME = 1e-6  # relative: certificates hold to 1e-6
UPPER = la.shapes.plane((0, 0.5), (0, -1))
LOWER = la.shapes.outline([(-0.5, -0.8), (3, -0.8), (3, -0.5), (-0.5, -0.5)])


def block(**more):
    """Half of a block of hardening material, 1 m wide and high."""
    mesh = la.meshes.quadrilaterals((0, 1), (-0.5, 0.5), 2, 2)
    body = la.Body(mesh, la.VonMises(hardening=LAW), space="q2")
    return la.Problem({"block": body}, supports=[la.Fix("block", "left", "x")], **more)


def closing(friction=0.0, up=(0, -1), low=(0, 1)):
    return {
        "up": la.Tool(UPPER, ("block", "top"), up, friction=friction),
        "low": la.Tool(LOWER, ("block", "bottom"), low, friction=friction),
    }


def pressed(tools, travel=0.1, scheme="implicit-midpoint", problem=None, **more):
    return la.sequential(problem or block(), travel, 1, scheme, tools=tools, **more)


def test_two_smooth_tools_press_like_platens():
    path = pressed(closing())
    assert path.status is Ending.REACHED, path.message
    assert path.unit == "m"
    force = strip_force(LAW, 0.8)
    assert path.history.force.iloc[0] == pytest.approx(2 * force, rel=1e-8)
    assert path.history.load_factor.iloc[0] == pytest.approx(2 * force, rel=1e-8)
    forces = path.tool_forces().set_index("body")
    assert forces.f_y.to_dict() == pytest.approx({"up": force, "low": -force}, rel=SAME)


def test_a_tool_with_friction_presses_like_a_rigid_block():
    corners = [(-0.5, 0.5), (3, 0.5), (3, 0.8), (-0.5, 0.8)]
    known = la.Problem(
        {**block().bodies, "up": la.RigidBlock(corners)},
        [la.PointForce("up", "block", (0, -1))],
        [la.Fix("block", "left", "x"), la.Fix("block", "bottom", "y")],
        [la.Interface(("block", "top"), ("up", "block"), 0.1)],
    )
    by_block = la.sequential(known, 0.1, 1, "explicit", control=la.ToolTravel({"up": (0, -1)}))
    held = block()
    held = la.Problem(held.bodies, supports=[*held.supports, la.Fix("block", "bottom", "y")])
    path = pressed({"up": closing(0.1)["up"]}, scheme="explicit", problem=held)
    assert path.history.force.iloc[0] == pytest.approx(by_block.history.force.iloc[0], rel=SAME)
    assert path.history.friction.iloc[0] > 0.01


def test_only_the_relative_motion_of_tools_counts():
    one, other = (
        pressed(closing(0.1, *own), scheme="explicit")
        for own in (((0, -1), (0, 1)), ((0, -2), (0, 0)))
    )
    assert other.history.force.iloc[0] == pytest.approx(one.history.force.iloc[0], rel=SAME)
    low = [own.configuration.nodes["low"] for own in other.snapshots]
    assert low[1] == pytest.approx(low[0], abs=1e-12)


def test_a_tool_goes_where_its_motion_leads():
    """It turns about its reference point, which moves by the velocity."""
    disc = la.shapes.disc((0.5, 1.0), 0.5)
    tool = la.Tool(disc, ("block", "top"), (0, -0.2), turn=np.pi, about=(0.5, 0.5))
    path = pressed({"roll": tool}, travel=0.05, scheme="explicit", problem=_clamped())
    x, y, turn = path.snapshots[-1].configuration.nodes["roll"][:, 0]
    assert (x, y, turn) == pytest.approx((0.5, 0.49, 0.05 * np.pi), abs=1e-9)
    (face,) = path.stage.obstacles_at(path.snapshots[-1].configuration)
    c, s = np.cos(turn), np.sin(turn)
    centre = np.array([[0.5 - 0.5 * s], [0.49 + 0.5 * c]])
    assert face.shape.distance(centre) == pytest.approx(-0.5, abs=1e-9)


def _clamped():
    held = block()
    return la.Problem(held.bodies, supports=[la.Fix("block", "bottom")])


@pytest.mark.slow
def test_pictures_show_tools(tmp_path):
    path = pressed(closing())
    drawn = path.plot()
    texts = {text.get_text() for axes in drawn.axes for text in _legend(axes)}
    assert "tool" in texts
    assert "rigid block" not in texts
    path.last.plot().savefig(tmp_path / "state.png")


def _legend(axes):
    legend = axes.get_legend()
    return legend.get_texts() if legend else []
