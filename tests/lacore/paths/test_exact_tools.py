"""Tools of an exact shape that move: what they press, feel, and cannot be."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix

import lacore as la
from lacore.model.contact.laws import Laws
from lacore.model.contact.obstacles import Obstacle
from lacore.model.meshes.curved import EdgeCurves
from lacore.paths.contact.outlines import Outline
from lacore.paths.contact.stations import Station
from lacore.paths.ending import Ending
from lacore.paths.tools.contact import cornered
from lacore_verification.cases.shared.exact_paths import strip_force

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


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_punch_with_sharp_corners_presses_like_a_rigid_block(friction):
    """Its corner holds the edges of the body at a vertex, too, and on either side of one."""
    held = block()
    held = la.Problem(held.bodies, supports=[*held.supports, la.Fix("block", "bottom", "y")])

    def corners(x):
        return [(-0.5, 0.5), (x, 0.5), (x, 0.8), (-0.5, 0.8)]

    def force(x):
        tool = la.Tool(la.shapes.outline(corners(x)), ("block", "top"), (0, -1), friction=friction)
        return float(pressed({"up": tool}, scheme="explicit", problem=held).history.force.iloc[0])

    known = la.Problem(
        {**held.bodies, "up": la.RigidBlock(corners(0.5))},
        [la.PointForce("up", "block", (0, -1))],
        held.supports,
        [la.Interface(("block", "top"), ("up", "block"), friction)],
    )
    by_block = la.sequential(known, 0.1, 1, "explicit", control=la.ToolTravel({"up": (0, -1)}))
    wanted = float(by_block.history.force.iloc[0])
    assert force(0.5) == pytest.approx(wanted, rel=SAME)
    assert 0.98 * wanted < force(0.495) <= wanted * (1 + SAME)
    assert wanted * (1 - SAME) <= force(0.505) < 1.02 * wanted


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


ANGLE = la.shapes.outline([(0, -0.5), (3, -0.5), (3, -0.8), (-0.3, -0.8), (-0.3, 3), (0, 3)])
"""A floor and a wall that meet in an inner corner."""


@pytest.mark.parametrize("carried", [True, False])
def test_an_inner_corner_holds_on_both_sides(carried):
    """A vertex in the corner of a floor and a wall leaves neither: the exact force of platens."""
    sides = ("left", "bottom", "right")
    tools = {"up": closing(up=(0, -2))["up"]}
    faces = []
    if carried:
        tools["angle"] = la.Tool(ANGLE, [("block", side) for side in sides])
    else:
        shape = la.RigidObstacle(shape=ANGLE)
        faces = [la.Interface(("block", side), shape, 0.0) for side in sides]
    pressure = 0.5  # Pa, which keeps the block at the wall
    pushed = la.Problem(block().bodies, dead_loads=[la.Pressure("block", "right", pressure)])
    path = pressed(tools, problem=pushed, approaching=faces)
    assert path.status is Ending.REACHED, path.message
    force = strip_force(LAW, 0.8) + pressure / 0.8
    assert path.history.force.iloc[0] == pytest.approx(2 * force, rel=1e-6)
    nodes = path.snapshots[-1].configuration.nodes["block"]
    assert ANGLE.distance(nodes).min() > -1e-6


def _clamped():
    held = block()
    return la.Problem(held.bodies, supports=[la.Fix("block", "bottom")])


def soil(nx=6, ny=3):
    mesh = la.meshes.quadrilaterals((0, 3), (-1.5, 0), nx, ny)
    body = la.Body(mesh, la.VonMises(hardening=LAW), space="q2")
    return {"soil": body}, [la.Fix("soil", "left", "x"), la.Fix("soil", "bottom")]


def under(x):
    return (x[1] > -1e-9) & (x[0] < 1)


def test_a_rough_flat_punch_presses_like_a_footing():
    """A smooth one does at the beginning; then material slides past its corner."""
    bodies, held = soil()
    footing = la.RigidFooting("soil", under, (0, -1), rough=True)
    known = la.sequential(la.Problem(bodies, [footing], held), 0.06, 2)
    square = la.shapes.outline([(-1, 0), (1, 0), (1, 1), (-1, 1)])
    punch = {"punch": la.Tool(square, ("soil", "top"), (0, -1), friction=la.STICK)}
    path = la.sequential(la.Problem(bodies, supports=held), 0.06, 2, tools=punch)
    assert path.history.force.to_numpy() == pytest.approx(known.history.force.to_numpy(), rel=SAME)


@pytest.mark.parametrize("friction", [0.0, 0.3, la.Tresca(0.2), la.STICK])
def test_the_power_of_force_and_torque_is_dissipated(friction):
    """Of a disc that turns, per travel; sticking costs no less than friction."""
    disc = la.shapes.disc((0.5, 1.0), 0.5)
    tool = la.Tool(disc, ("block", "top"), (0.3, -0.5), turn=0.8, friction=friction)
    path = pressed({"roll": tool}, travel=0.05, scheme="explicit", problem=_clamped())
    row, felt = path.history.iloc[0], path.tool_forces().iloc[0]
    power = -(0.3 * felt.f_x - 0.5 * felt.f_y + 0.8 * felt.moment)
    assert power == pytest.approx(row.plastic + row.friction, rel=1e-5)
    assert power == pytest.approx(row.force, rel=1e-5)


def test_a_tool_that_turns_alone_is_driven_by_its_torque():
    disc = la.shapes.disc((0.5, 1.0), 0.5)
    tool = la.Tool(disc, ("block", "top"), turn=2.0, friction=la.STICK)
    path = pressed({"roll": tool}, travel=0.02, scheme="explicit", problem=_clamped())
    felt = path.tool_forces().iloc[0]
    assert -2.0 * felt.moment == pytest.approx(path.history.force.iloc[0], rel=1e-5)
    assert path.history.force.iloc[0] > 0


def test_moving_the_body_is_moving_the_tool():
    bodies, held = soil()
    wedge = la.shapes.wedge((0, 0), 60)
    tool = {"wedge": la.Tool(wedge, ("soil", "top"), (0, -1), friction=0.1)}
    roller = [held[0], la.Fix("soil", "bottom", "y")]
    by_tool = la.sequential(la.Problem(bodies, supports=roller), 0.1, 2, "explicit", tools=tool)
    push = la.RigidFooting("soil", "bottom", (0, 1), rough=False)
    fixed = la.Interface(("soil", "top"), la.RigidObstacle(shape=wedge), 0.1)
    by_body = la.sequential(
        la.Problem(bodies, [push], held[:1]), 0.1, 2, "explicit", approaching=[fixed]
    )
    forces = [path.history.force.to_numpy() for path in (by_tool, by_body)]
    assert forces[0] == pytest.approx(forces[1], rel=SAME)


def test_the_frame_makes_no_difference():
    """The same body and wedge, turned by 90 degrees."""
    mesh = la.meshes.quadrilaterals((0, 3), (-1.5, 0), 6, 3)
    turned = type(mesh)(np.stack([-mesh.p[1], mesh.p[0]]), mesh.t).with_boundaries(mesh.boundaries)
    forces = []
    for own, along, held in ((mesh, (0, -1), "x"), (turned, (1, 0), "y")):
        body = la.Body(own, la.VonMises(hardening=LAW), space="q2")
        problem = la.Problem(
            {"soil": body}, supports=[la.Fix("soil", "left", held), la.Fix("soil", "bottom")]
        )
        axis = (-along[0], -along[1])
        tool = la.Tool(la.shapes.wedge((0, 0), 60, axis), ("soil", "top"), along)
        path = la.sequential(problem, 0.1, 2, "explicit", tools={"wedge": tool})
        forces.append(path.history.force.to_numpy())
    assert forces[0] == pytest.approx(forces[1], rel=SAME)


def test_a_corner_between_vertices_is_kept_out():
    """A blunt wedge in the middle of an edge: no vertex of the body is below its tip."""
    bodies, held = soil()
    tool = la.Tool(la.shapes.wedge((1.25, 0), 75), ("soil", "top"), (0, -1))
    path = la.sequential(
        la.Problem(bodies, supports=held), 0.05, 1, "explicit", tools={"wedge": tool}
    )
    assert path.history.force.iloc[0] > 0.1
    (face,) = path.stage.obstacles_at(path.snapshots[-1].configuration)
    body = path.stage.bodies_at(path.snapshots[-1].configuration)["soil"]
    edge = int(np.argmin(np.abs(mesh_middles(body) - 1.25)))
    tip = face.shape.corners[1, 0]
    curves = body.curves(np.asarray(body.mesh.boundaries["top"]))
    assert curves.middle[1, edge] <= tip + 1e-9


def test_a_corner_pushes_from_the_moment_of_touch_on():
    """A tip 0.02 m above an edge moves by 0.05 m: the edge below it gives way by the difference."""
    held = block()
    held = la.Problem(held.bodies, supports=[*held.supports, la.Fix("block", "bottom", "y")])
    wedge = la.Tool(la.shapes.wedge((0.25, 0.52), 30), ("block", "top"), (0, -1))
    path = pressed({"wedge": wedge}, travel=0.05, scheme="explicit", problem=held)
    before, after = (own.configuration.nodes["block"] for own in path.snapshots)
    (below,) = np.flatnonzero((before[0] == 0.25) & (before[1] == 0.5))
    assert before[1, below] - after[1, below] == pytest.approx(0.03, abs=1e-7)


@pytest.mark.parametrize(
    ("vertex", "at_corner", "normal", "gap"),
    [
        ((0.0, 0.0), True, None, 0.0),
        ((0.0, -0.005), True, None, 0.005),  # before the corner, whose distance is the shortest
        ((-0.005, 0.005), False, (-1, -1), 0.0),  # beside it, on a face
        ((-0.005, 0.0), False, (-1, -1), None),  # beside it, before a face
    ],
)
def test_a_vertex_at_a_corner_has_the_normal_of_the_body_and_beside_it_that_of_the_face(
    vertex, at_corner, normal, gap
):
    """A wedge of 90 degrees points down at a body: one edge rises along a face, one is level."""
    wedge = la.shapes.wedge((0, 0), 45)
    x, y = vertex
    start, end = np.array([[x - 1, x], [y + 1, y]]), np.array([[x, x + 1], [y, y]])
    outward = np.array([[0.5**0.5, 0.0], [0.5**0.5, 1.0]])
    side = Outline(np.arange(2), EdgeCurves(start, (start + end) / 2, end), outward)
    places, none = np.array([vertex]), csr_matrix((1, 1))
    station = Station(
        name="wedge",
        bodies=("body",),
        places=places,
        normals=wedge.normal(places.T).T,
        weights=np.ones(1),
        gaps=wedge.distance(places.T),
        laws=Laws(*np.zeros((4, 1))),
        away=wedge.distance(places.T) > 1e-6,
        x=none,
        y=none,
        moving=np.array([[0, -1]]),
    )
    face = Obstacle("wedge", "body", "top", np.arange(2), wedge, la.Coulomb(0.0), 1.0)
    found, corners = cornered(station, face, wedge, (side, side))
    mean = -outward.sum(axis=1)  # of the body, between those of the two faces
    wanted = np.array(mean if normal is None else normal)
    wanted = wanted / np.linalg.norm(wanted)
    assert corners.tolist() == [at_corner]
    assert found.normals[0] == pytest.approx(wanted)
    if gap is not None:
        assert found.gaps[0] == pytest.approx(-gap * wanted[1])


def mesh_middles(body):
    return body.curves(np.asarray(body.mesh.boundaries["top"])).middle[0]


TOP = ("block", "top")
WRONG = {
    "shape": (lambda: la.Tool("wedge", TOP), r"Tool.shape = 'wedge': not a shape; give la.shapes"),
    "touches": (lambda: la.Tool(UPPER, "top"), r"Tool.touches = 'top': not a boundary"),
    "velocity": (lambda: la.Tool(UPPER, TOP, velocity=1), "Tool.velocity = 1: not a velocity"),
    "turn": (lambda: la.Tool(UPPER, TOP, turn="left"), "Tool.turn = 'left': not an angle"),
    "about": (lambda: la.Tool(UPPER, TOP, about=3), "Tool.about = 3: not a point"),
    "friction": (lambda: la.Tool(UPPER, TOP, friction=-1), "Tool.friction"),
    "angle": (lambda: la.shapes.wedge((0, 0), 90), "half_angle = 90: not an angle between 0 and"),
    "radius": (lambda: la.shapes.disc((0, 0), 0), "radius = 0: not a positive number"),
    "normal": (lambda: la.shapes.plane((0, 0), (0, 0)), "normal = .*: not a direction"),
    "corners": (lambda: la.shapes.outline([(0, 0), (1, 0)]), "fewer than 3 corners"),
    "crossing": (
        lambda: la.shapes.outline([(0, 0), (2, 1), (1, 0), (0, 1)]),
        "not a polygon: Self-intersection",
    ),
    "rounding": (
        lambda: la.shapes.outline([(0, 0), (1, 0), (0, 1)], rounding=0.5),
        "the roundings take .* more than the edge from",
    ),
}


@pytest.mark.parametrize(("made", "message"), WRONG.values(), ids=WRONG)
def test_what_a_tool_cannot_be(made, message):
    with pytest.raises(la.InputError, match=message):
        made()


def tool(shape=UPPER, touches=TOP, velocity=(0, -1), **more):
    return la.Tool(shape, touches, velocity, **more)


DISC = la.shapes.disc((0.5, 1), 0.5)
REFUSED = {
    "deep": (
        {"up": tool(la.shapes.plane((0, 0.45), (0, -1)))},
        r"tools\['up'\]: overlaps body 'block' by 0.05 m near .*move the tool away",
    ),
    "corner": (
        {"up": tool(la.shapes.wedge((0.3, 0.45), 5))},
        r"overlaps body 'block' by 0.05 m near \(0.3, 0.45\)",
    ),
    "tools": (
        {"up": tool(DISC), "two": tool(la.shapes.disc((0.6, 1.2), 0.5))},
        r"tools\['two'\]: overlaps tool 'up' by 0.22",
    ),
    "boundary": ({"up": tool(touches=("block", "tpo"))}, "no boundary .* did you mean 'top'"),
    "body": ({"up": tool(touches=("blok", "top"))}, "no deformable body .* did you mean 'block'"),
    "rest": ({"up": tool(velocity=(0, 0))}, "no tool moves, .* so nothing drives the path"),
    "name": ({"block": tool()}, "tools = 'block': a body has this name"),
    "kind": ({"up": UPPER}, r"tools\['up'\] = .*: not a tool; give lacore.Tool"),
}


@pytest.mark.parametrize(("tools", "message"), REFUSED.values(), ids=REFUSED)
def test_what_a_path_does_not_begin_with(tools, message):
    with pytest.raises(la.InputError, match=message):
        pressed(tools, problem=_clamped())


def test_tools_drive_in_place_of_loads_and_by_their_own_velocity():
    loaded = la.Problem(block().bodies, [la.Pressure("block", "top")])
    with pytest.raises(la.InputError, match=r"reference loads, too.*dead_loads"):
        pressed(closing(), problem=loaded)
    with pytest.raises(la.InputError, match=r"not the velocity of a tool.*leave out the"):
        pressed(closing(), control=la.ToolTravel({"up": (0, -3)}))
    with pytest.raises(la.InputError, match=r"or tools=\{'name': lacore.Tool"):
        pressed({}, problem=la.Problem(block().bodies, [la.Pressure("block", "top")]))


def test_a_path_ends_where_tools_lose_contact_or_lock():
    away = pressed({"up": tool(velocity=(0, 1))}, problem=_clamped())
    assert away.status is Ending.NO_CONTACT
    assert "'up'" in away.message
    walls = [la.Fix("block", side) for side in ("bottom", "left", "right")]
    locked = pressed({"up": tool()}, problem=la.Problem(block().bodies, supports=walls))
    assert locked.status is Ending.LOCKED
    assert "'up' on block.top" in locked.message


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
