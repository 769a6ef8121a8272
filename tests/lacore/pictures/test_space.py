"""Pictures, VTU files and scenes of blocks in space."""

import meshio
import numpy as np
import pytest

import lacore as la
from lacore.pictures.space.mechanism import thrust_lines
from lacore.pictures.space.structure import motion_of, touches_of
from tests.lacore.model.bodies.blocks3d.solids import box, triangulated
from tests.lacore.shown import weak_pier

FLOOR = la.RigidObstacle((0, 0, 0), (0, 0, 1))


def solved(mu, cut=False):
    """A tower of two blocks on a floor and a block, pushed: it slides, or topples, on its joint."""
    low, top = box((0, 0, 0), (1, 1, 1)), box((0, 0, 1), (1, 1, 2))
    blocks = {"low": triangulated(low) if cut else low, "top": triangulated(top) if cut else top}
    problem = la.Problem(
        {"tower": la.BlockAssembly3D(blocks, mu)},
        [la.BodyForce("tower", (1, 0, 0))],
        interfaces=[la.Interface(("tower", lambda x: x[2] < 0.1), FLOOR, 3.0)],
        dead_loads=[la.BodyForce("tower", (0, 0, -1))],
    )
    return la.solve(problem)


@pytest.fixture(scope="module")
def sliding():
    return solved(0.2)


@pytest.fixture(scope="module")
def toppling():
    return solved(2.0)


def touching(state):
    motion = motion_of(state)
    return motion, touches_of(state, motion, 1e-6)


def test_a_joint_slips_and_the_floor_holds(sliding):
    motion, touches = touching(sliding)
    of = dict(zip(zip(touches.slave, touches.master, strict=True), touches.kind, strict=True))
    assert of == {(1, 0): "slip", (0, -1): "stick"}
    # The upper block moves as a whole; F0.u = 1 of a body force of 1 N/m^3 on its 1 m^3.
    assert motion.rate[:, 1] == pytest.approx([1, 0, 0, 0, 0, 0], abs=1e-6)
    joint = int(np.flatnonzero(touches.slave == 1)[0])
    assert touches.force[:, joint] == pytest.approx([-0.2, 0, 1], abs=1e-6)  # its weight, its push
    assert [own.shape for own in touches.corners] == [(3, 4), (3, 4)]


def test_who_is_held_is_told_of_blocks_whatever_their_joints_crush_by():
    """How far points of joints crush are unknowns of the pier, too."""
    state = la.solve(weak_pier())
    (pier,) = state.discretisation.solids.values()
    assert pier.crushing.size % 6
    base = [name == "base" for name in pier.body.names]
    assert any(base)
    assert motion_of(state).held.tolist() == base


def test_a_tower_topples_over_the_edge_of_its_foot(toppling):
    motion, touches = touching(toppling)
    kinds = dict(zip(touches.master, touches.kind, strict=True))
    assert kinds == {0: "stick", -1: "open"}
    foot = int(np.flatnonzero(touches.master == -1)[0])
    assert touches.centre[0, foot] == pytest.approx(1, abs=1e-6)
    assert touches.force[2, foot] == pytest.approx(2, abs=1e-6)
    lines = thrust_lines(motion, touches)
    along = lines[:, 0] - lines[:, 1]
    assert np.all(np.sum(along * touches.force, axis=0) > 0)  # slave first, which they push
    # Velocities of vertices are those of a rigid body about that edge.
    edge = np.array([[1.0], [0.5], [0.0]])
    assert motion.at(edge, np.array([0])) == pytest.approx(np.zeros((3, 1)), abs=1e-6)


def test_corners_of_joints_are_in_order_around_them(sliding):
    _, touches = touching(sliding)
    for place in touches.corners:
        sides = np.linalg.norm(np.diff(place, axis=1), axis=0)
        assert sides == pytest.approx([1, 1, 1])  # a diagonal would be longer


def test_the_mechanism_says_what_joints_do(sliding):
    figure = sliding.plot()
    texts = [text.get_text() for axes in figure.axes for text in axes.get_legend().get_texts()]
    assert "joints that slip" in texts
    assert "joints that open" not in texts
    assert any(text.startswith("contact force (max 2") for text in texts)
    assert "2 rigid blocks" in figure.get_suptitle()
    assert len(figure.axes) == 3


def test_triangles_of_one_face_are_drawn_as_it(sliding):
    plain, cut = motion_of(sliding).blocks, motion_of(solved(0.2, cut=True)).blocks
    assert len(plain.faces) == len(cut.faces) == 12
    assert plain.edges.shape == cut.edges.shape == (2, 24)


def test_a_problem_is_sketched_before_it_is_solved(sliding):
    figure = sliding.discretisation.problem.plot()
    texts = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert len(texts) == 3
    assert any("(1, 0, 0)" in text for text in texts)


def test_vtu_files_hold_blocks_and_contact(sliding, tmp_path):
    sliding.to_vtu(tmp_path / "tower.vtu")
    blocks = meshio.read(tmp_path / "tower.vtu")
    assert [cell.type for cell in blocks.cells] == ["polyhedron8"]
    assert len(blocks.cells[0].data) == 2
    moves = blocks.point_data["velocity"]
    assert moves[8:] == pytest.approx(np.tile([1.0, 0, 0], (8, 1)), abs=1e-6)
    assert moves[:8] == pytest.approx(np.zeros((8, 3)), abs=1e-6)
    contact = meshio.read(tmp_path / "tower-contact.vtu")
    assert len(contact.points) == 8
    force = contact.point_data["area"] @ contact.point_data["traction"]
    # The floor carries both, the joint the upper one.
    assert force == pytest.approx([-0.6, 0, 3], abs=1e-6)
    assert np.bincount(contact.point_data["state"].astype(int)).tolist() == [4, 4]


def test_files_are_named_and_placed_as_they_have_to_be(sliding, tmp_path):
    with pytest.raises(la.InputError, match=r"let it end in \.vtu"):
        sliding.to_vtu(tmp_path / "tower.vtk")
    with pytest.raises(la.InputError, match="cannot be written"):
        sliding.to_vtu(tmp_path / "nowhere" / "tower.vtu")
    with pytest.raises(la.InputError, match=r"let it end in \.html"):
        sliding.to_html(tmp_path / "tower.htm")


def test_a_scene_is_a_page_or_says_what_is_missing(sliding, tmp_path):
    page = tmp_path / "tower.html"
    try:
        import trame_pyvista  # noqa: F401  an extra
    except ImportError:
        with pytest.raises(la.InputError, match=r"lacore-limit-analysis\[scene\]"):
            sliding.to_html(page)
        return
    sliding.to_html(page)
    assert "<script" in page.read_text(encoding="utf-8")


def test_states_of_the_plane_have_no_scene(tmp_path):
    problem = la.Problem(
        {"block": la.RigidBlock([(0, 0), (1, 0), (1, 1), (0, 1)])},
        [la.BodyForce("block", (1, 0))],
        interfaces=[
            la.Interface(("block", lambda x: x[1] < 1e-9), la.RigidObstacle((0, 0), (0, 1)), 0.3)
        ],
        dead_loads=[la.BodyForce("block", (0, -1))],
    )
    with pytest.raises(la.InputError, match="of the plane"):
        la.solve(problem).to_html(tmp_path / "block.html")
