"""Pictures of rigid blocks: displaced blocks, what joints do, forces between them."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_hex

import lacore as la
from lacore.model.bodies.blocks import masonry
from lacore.pictures.blocks import FIXED
from lacore.pictures.contact import COLOURS, GROUND
from lacore.pictures.forces import THRUST, contact_forces
from lacore.pictures.mechanism import plot_mechanism
from tests.lacore.pictures.readings import column, drawn, lines, polygons, words


@pytest.fixture(scope="module")
def pushed():
    return la.solve(column((2.0, 1.0), 0.4))


@pytest.fixture(scope="module")
def toppled():
    return la.solve(column((1.0, 2.0), 0.8))


def test_a_sliding_block_is_displaced_whole_and_its_joint_slips(pushed):
    axes, _ = drawn(plot_mechanism(pushed)).axes
    (block,) = polygons(axes, "#ece7dc")
    before = np.array([(-1, 0), (1, 0), (1, 1), (-1, 1)])
    moved = 0.08 * np.hypot(2, 2)  # of block and base
    # Solver's accuracy, times the stretch.
    assert block - before == pytest.approx(np.tile([moved, 0], (4, 1)), abs=1e-6)
    ((joint, _),) = lines(axes, COLOURS["slip"])
    assert joint[[0, -1], 1] == pytest.approx([0, 0], abs=1e-6)
    assert np.ptp(joint[:, 0]) == pytest.approx(2)
    assert lines(axes, COLOURS["stick"]) == []
    (base,) = polygons(axes, FIXED)
    assert base == pytest.approx(np.array([(-1, -1), (1, -1), (1, 0), (-1, 0)]))


def test_a_toppling_block_opens_a_wedge_about_its_corner(toppled):
    axes, _ = drawn(plot_mechanism(toppled)).axes
    (block,) = polygons(axes, "#ece7dc")
    corner = block[np.argmin(np.linalg.norm(block - [0.5, 0], axis=1))]
    assert corner == pytest.approx([0.5, 0], abs=1e-6)
    fastest = np.hypot(1, 2)  # the far corner, per angle
    angle = 0.08 * np.hypot(1, 4) / fastest
    assert block[:, 1].max() == pytest.approx(2 + angle)
    assert block[:, 0].max() == pytest.approx(0.5 + 2 * angle)
    colour = to_hex(COLOURS["open"])
    (gap,) = polygons(axes, colour)
    assert np.ptp(gap, axis=0) == pytest.approx([1, angle], abs=1e-6)
    assert "contact: open" in words(axes.figure)


def test_rotations_stay_small_in_large_structures():
    """A light block that topples off a long wall turns by no more than 0.3."""
    blocks = {"base": masonry.rectangle(0, 50, -1, 0), "small": masonry.rectangle(0, 0.1, 0, 0.2)}
    problem = la.Problem(
        {"wall": la.BlockAssembly(blocks, 0.8)},
        [la.BodyForce("wall", (1, 0))],
        [la.Fix("wall", "base")],
        dead_loads=[la.BodyForce("wall", (0, -1))],
    )
    (block,) = polygons(plot_mechanism(la.solve(problem)).axes[0], "#ece7dc")
    assert np.sort(block[:, 1])[-2:] == pytest.approx([0.2, 0.2 + 0.3 * 0.1])


def test_contact_forces_balance_the_loads(pushed, toppled):
    forces = contact_forces(pushed)
    assert forces.force == pytest.approx(np.array([[-0.8], [2.0]]), abs=1e-6)
    # The push acts at half height, and moves the pressure to the side.
    assert forces.centre == pytest.approx(np.array([[0.2], [0.0]]), abs=1e-6)
    forces = contact_forces(toppled)
    assert forces.force == pytest.approx(np.array([[-1.0], [2.0]]), abs=1e-6)
    assert forces.centre == pytest.approx(np.array([[0.5], [0.0]]), abs=1e-6)


def test_lines_of_thrust_are_as_thick_as_their_force(pushed):
    problem = replace(
        column((2.0, 1.0), 0.4), bodies={"column": masonry.stack([(2, 1), (2, 1), (2, 1)], 0.4)}
    )
    state = la.solve(problem)
    _, axes = drawn(plot_mechanism(state)).axes
    drawn_lines = lines(axes, THRUST)
    assert len(drawn_lines) == 2 * 3  # into both blocks; the base gets one of no length
    widths = np.array([width for _, width in drawn_lines])
    assert widths[:3] / widths.max() == pytest.approx([1, 2 / 3, 1 / 3], abs=1e-6)
    into_base = drawn_lines[3][0]
    assert into_base[0] == pytest.approx(into_base[1])
    # From the centre of pressure along the force: towards the centroid.
    start, end = lines(plot_mechanism(pushed).axes[1], THRUST)[0][0]
    assert start == pytest.approx([0.2, 0.0], abs=1e-6)
    assert end == pytest.approx([0.0, 0.5], abs=1e-6)


def test_of_many_forces_those_are_drawn_that_bear_the_load():
    rows = masonry.regular_bond(8, 12)
    wall = la.Problem(
        {"wall": masonry.running_bond(rows, la.Coulomb(0.65, associated=True))},
        [la.BodyForce("wall", (1, 0))],
        [la.Fix("wall", "base")],
        dead_loads=[la.BodyForce("wall", (0, -1))],
    )
    state = la.solve(wall)
    figure = drawn(plot_mechanism(state))
    (item,) = (c for c in figure.axes[1].collections if c.get_zorder() == 3)
    size = np.sort(np.linalg.norm(contact_forces(state).force, axis=0))[::-1]
    shown = len(item.get_segments()) // 2  # into either block
    assert shown < size.size
    assert size[:shown].sum() >= 0.9 * size.sum() > size[: shown - 1].sum()
    assert f"shown above {size[shown - 1]:.2g}" in words(figure)
    shades = item.get_colors()[:shown, :3].sum(axis=1)
    assert np.all(np.diff(shades) <= 1e-12)  # the darkest is the largest, and on top
    assert to_hex(item.get_colors()[shown - 1]) == THRUST


def test_live_loads_are_arrows_that_end_where_they_act(pushed):
    _, axes = plot_mechanism(pushed).axes
    (arrows,) = (item for item in axes.collections if hasattr(item, "U"))
    assert arrows.get_offsets() == pytest.approx(np.array([[0, 0.5]]))
    assert (arrows.U[0] > 0, arrows.V[0]) == (True, pytest.approx(0))
    assert "reference load" in words(axes.figure)


def test_forces_of_round_off_are_not_drawn():
    """A lifted block: its weight is the load, the base carries nothing."""
    figure = drawn(plot_mechanism(la.solve(column((2.0, 1.0), 0.4, live=(0, 1)))))
    assert lines(figure.axes[1], THRUST) == []
    assert "contact force" not in words(figure)


def test_obstacles_under_blocks_are_hatched():
    block = la.RigidBlock(masonry.rectangle(0, 1, 0, 2))
    state = la.solve(
        la.Problem(
            {"block": block},
            [la.PointForce("block", (0, 2), (1, 0))],
            interfaces=[la.Interface(("block", on_ground), la.RigidObstacle(), 0.3)],
            dead_loads=[la.BodyForce("block", (0, -1))],
        )
    )
    figure = drawn(plot_mechanism(state))
    for axes in figure.axes:
        grounds = [
            c for c in axes.collections if c.get_hatch() and to_hex(c.get_edgecolor()[0]) == GROUND
        ]
        assert len(grounds) == 1
    assert len(figure.axes) == 2  # no panel: a block has no edge means
    assert "obstacle" in words(figure)
    assert contact_forces(state).force == pytest.approx(np.array([[-0.5], [2.0]]), abs=1e-6)


def on_ground(x):
    return x[1] == 0


def test_blocks_that_share_a_corner_on_one_obstacle_keep_their_reactions():
    heavy, light = masonry.rectangle(0, 1, 0, 4), masonry.rectangle(1, 2, 0, 1)
    state = la.solve(
        la.Problem(
            {"pair": la.BlockAssembly({"heavy": heavy, "light": light}, 0.0)},
            [la.PointForce("pair", "light", (1, 0))],
            interfaces=[la.Interface(("pair", on_ground), la.RigidObstacle(), 0.5)],
            dead_loads=[la.BodyForce("pair", (0, -1))],
        )
    )
    forces = contact_forces(state).force
    assert sorted(forces[1]) == pytest.approx([0, 1, 4], abs=1e-6)  # joint, light, heavy
    axes = drawn(plot_mechanism(state)).axes[0]
    assert len(lines(axes, COLOURS["slip"])) == 1
    assert len(polygons(axes, COLOURS["open"])) == 1  # the joint
    assert len(lines(axes, COLOURS["stick"])) == 1


def test_a_rigid_punch_on_a_continuum_shows_mechanism_forces_and_panel():
    soil = la.meshes.rectangle((0, 4), (-1, 0), 8, 2)
    punch = la.RigidBlock(masonry.rectangle(1, 2, 0, 0.5))
    top = la.Interface(("punch", on_ground), ("soil", "top"), 0.3)
    state = la.solve(
        la.Problem(
            {"soil": la.Body(soil, la.VonMises(shear_strength=1.0)), "punch": punch},
            [la.PointForce("punch", "block", (0, -1))],
            [la.Fix("soil", "bottom")],
            [top],
        )
    )
    figure = drawn(plot_mechanism(state))
    text = words(figure)
    for part in ("64 elements, 1 rigid block", "dissipation density", "contact force", "traction"):
        assert part in text, part
    (force,) = contact_forces(state).force.T
    assert force == pytest.approx([0, state.load_factor], abs=1e-5 * state.load_factor)


def test_assemblies_in_contact_are_drawn_like_joints():
    blocks = {
        "lower": la.BlockAssembly({"base": masonry.rectangle(0, 2, -1, 0)}, 0.0),
        "upper": la.RigidBlock(masonry.rectangle(0, 2, 0, 1)),
    }
    state = la.solve(
        la.Problem(
            blocks,
            [la.BodyForce("upper", (1, 0))],
            [la.Fix("lower", "base")],
            [la.Interface(("upper", on_ground), ("lower", on_ground), 0.4)],
            [la.BodyForce("upper", (0, -1))],
        )
    )
    figure = drawn(plot_mechanism(state))
    assert len(figure.axes) == 2
    assert len(lines(figure.axes[0], COLOURS["slip"])) == 1
    assert contact_forces(state).force == pytest.approx(np.array([[-0.8], [2.0]]), abs=1e-6)


@pytest.mark.slow
def test_large_walls_take_few_artists():
    half, whole = [0.5, *[1] * 24, 0.5], [1] * 25
    wall = masonry.running_bond([half, whole] * 20, 0.65)
    state = la.solve(
        la.Problem(
            {"wall": wall},
            [la.BodyForce("wall", (1, 0))],
            [la.Fix("wall", "base")],
            dead_loads=[la.BodyForce("wall", (0, -1))],
        ),
        coupling="associated",
    )
    figure = drawn(plot_mechanism(state))
    for axes in figure.axes:
        assert len(axes.collections) + len(axes.lines) + len(axes.patches) < 12
    shown = len(polygons(figure.axes[0], "#ece7dc"))
    assert shown == len(wall.names) - 1
    assert "reference load $F_0$, resultant" in words(figure)


def test_unsolved_blocks_say_so(toppled):
    state = replace(toppled, status=la.Status.NOT_CERTIFIED, load_factor=float("nan"))
    assert "NOT CERTIFIED" in words(drawn(plot_mechanism(state)))
