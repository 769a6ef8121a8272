"""Pictures show what the state says, for any state with a point."""

from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from matplotlib.collections import LineCollection, PathCollection, PolyCollection
from matplotlib.colors import to_hex

import lacore as la
from lacore import masonry
from lacore.plotting import plot_mechanism
from lacore.plotting_blocks import FIXED
from lacore.plotting_contact import COLOURS, GROUND
from lacore.plotting_forces import THRUST, contact_forces
from lacore.plotting_frames import HINGE, MOMENT
from tests.frame_problems import portal, pressed
from tests.frame_problems import pushed as pushed_portal


def block(friction, top=(0, -1)):
    mesh = la.meshes.rectangle(x=(0, 4), y=(0, 1), nx=4, ny=2)
    return la.Problem(
        bodies={"block": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle((0, 0), (0, 1)), friction)],
        reference_loads=[la.Traction("block", "left", (1, 0))],
        dead_loads=[la.Traction("block", "top", top)],
    )


@pytest.fixture(scope="module")
def sliding():
    return la.solve(block(0.5))


def drawn(figure):
    """Render, so that everything lazy is done; warnings are errors."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png")
    assert buffer.getvalue().startswith(b"\x89PNG")
    return figure


def words(figure):
    texts = [figure.get_suptitle()]
    for axes in figure.axes:
        texts += [axes.get_title(loc="right"), axes.get_xlabel(), axes.get_ylabel()]
        if axes.get_legend():
            texts += [text.get_text() for text in axes.get_legend().get_texts()]
    return "\n".join(texts)


def test_title_names_value_rigor_backend_and_status(sliding):
    text = words(drawn(plot_mechanism(sliding)))
    for part in ("load factor 2 ", "not a bound", "clarabel", "status: solved"):
        assert part in text


def test_rigid_sliding_shows_slip_and_no_dissipation(sliding):
    text = words(drawn(sliding.plot()))
    assert "contact: slip" in text
    assert "contact: stick" not in text
    assert "no plastic dissipation" in text
    assert "dissipation density" not in text


def test_crushing_shows_stick_and_dissipation():
    text = words(drawn(plot_mechanism(la.solve(block(0.9)))))
    assert "contact: stick" in text
    assert "dissipation density" in text


def test_each_element_is_one_face(sliding):
    figure = plot_mechanism(sliding)
    faces = [item for item in figure.axes[0].collections if isinstance(item, PolyCollection)]
    elements = sliding.discretisation.bodies["block"].body.mesh.nelements
    assert len(faces[0].get_paths()) == elements


def test_panel_shows_edge_means_that_carry_the_load(sliding):
    figure = plot_mechanism(sliding)
    traction = next(axes for axes in figure.axes if axes.get_ylabel() == "traction [Pa]")
    pressure, friction = (patch.get_data() for patch in traction.patches)
    assert (pressure.values * (pressure.edges[1:] - pressure.edges[:-1])).sum() == pytest.approx(4)
    # The block is pushed to the right, so friction acts on it to the left.
    assert (friction.values * (friction.edges[1:] - friction.edges[:-1])).sum() == pytest.approx(-2)


def test_without_interfaces():
    mesh = la.meshes.quarter_ring(1.0, 2.0, 2, 4)
    tube = la.Body(mesh, la.VonMises(yield_stress=1.0), geometry="approximated")
    state = la.solve(
        la.Problem(
            {"tube": tube},
            [la.Pressure("tube", "bore")],
            [la.Fix("tube", "x_axis", "y"), la.Fix("tube", "y_axis", "x")],
        )
    )
    figure = drawn(plot_mechanism(state))
    assert "contact" not in words(figure)


def column(size, friction, dead=(0, -1), live=(1, 0)):
    """One block on a fixed base, pushed in proportion to its weight."""
    return la.Problem(
        bodies={"column": masonry.stack([size], friction)},
        reference_loads=[la.BodyForce("column", live)],
        supports=[la.Fix("column", "base")],
        dead_loads=[la.BodyForce("column", dead)],
    )


@pytest.fixture(scope="module")
def pushed():
    return la.solve(column((2.0, 1.0), 0.4))


@pytest.fixture(scope="module")
def toppled():
    return la.solve(column((1.0, 2.0), 0.8))


def polygons(axes, colour):
    """Vertices (k, 2) of all faces of a colour."""
    return [
        path.vertices[:-1]
        for item in axes.collections
        if isinstance(item, PolyCollection)
        and colour in [to_hex(own) for own in item.get_facecolor()[:1]]
        for path in item.get_paths()
    ]


def lines(axes, colour):
    """Points (k, 2) and widths of all lines of a colour."""
    return [
        (segment, width)
        for item in axes.collections
        if isinstance(item, LineCollection) and to_hex(item.get_colors()[0]) == colour
        for segment, width in zip(
            item.get_segments(),
            np.resize(item.get_linewidths(), len(item.get_segments())),
            strict=True,
        )
    ]


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


def test_live_loads_are_arrows_that_end_where_they_act(pushed):
    _, axes = plot_mechanism(pushed).axes
    (arrows,) = (item for item in axes.collections if hasattr(item, "U"))
    assert arrows.get_offsets() == pytest.approx(np.array([[0, 0.5]]))
    assert (arrows.U[0] > 0, arrows.V[0]) == (True, pytest.approx(0))
    assert "live load" in words(axes.figure)


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


def pair_of_continua(swap=False, friction=0.3):
    criterion = la.VonMises(shear_strength=1.0)
    low = la.meshes.rectangle((0, 4), (0, 1), 8, 2)
    high = la.meshes.rectangle((0.5, 3), (1, 2), 5, 2)
    sides = [("high", "bottom"), ("low", "top")]
    slave, master = sides[::-1] if swap else sides
    return la.Problem(
        {"low": la.Body(low, criterion), "high": la.Body(high, criterion)},
        [la.Traction("high", "left", (1, 0))],
        [la.Fix("low", "bottom")],
        [la.Interface(slave, master, friction)],
        [la.Traction("high", "top", (0, -1))],
    )


@pytest.mark.parametrize("swap", [False, True])
def test_two_continua_show_their_contact_once_with_one_panel(swap):
    figure = drawn(plot_mechanism(la.solve(pair_of_continua(swap))))
    assert len(figure.axes) == 3  # mechanism, tractions, velocities: it slides rigidly
    slip = lines(figure.axes[0], COLOURS["slip"])
    length = sum(np.ptp(segment[:, 0]) for segment, _ in slip)
    assert length == pytest.approx(2.5, abs=1e-6)
    assert "contact: stick" not in words(figure)
    pressure, friction = (patch.get_data() for patch in figure.axes[1].patches)
    assert pressure.edges[[0, -1]] == pytest.approx([0.5, 3.0])
    width = np.diff(pressure.edges)
    assert (pressure.values * width).sum() == pytest.approx(2.5, abs=1e-5)
    # Tractions on the slave: the friction on the upper body points to the left.
    assert (friction.values * width).sum() == pytest.approx(0.75 if swap else -0.75, abs=1e-5)


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


@pytest.fixture(scope="module")
def broken_beam():
    """C12, where the beam breaks: hinges at its ends and under the load."""
    return la.solve(pressed(0.8, 1.0))


def hinge_marks(axes):
    """Places (k, 2) of the dots, and of the anticlockwise and clockwise arrows around them."""
    return [
        np.asarray(item.get_offsets())
        for item in axes.collections
        if isinstance(item, PathCollection)
        and to_hex(HINGE) in [to_hex(own) for own in item.get_facecolor()[:1]]
    ]


def test_hinges_are_dots_with_a_sense_of_rotation(broken_beam):
    axes, _ = drawn(plot_mechanism(broken_beam)).axes
    dots, anticlockwise, clockwise = hinge_marks(axes)
    left, middle, right = sorted(dots.tolist())
    size = np.hypot(4, 2)
    aside = 0.03 * size  # into the member that turns
    assert left == pytest.approx([aside, 2], abs=1e-6)
    assert right == pytest.approx([4 - aside, 2], abs=1e-6)
    assert middle[1] == pytest.approx(2 - 0.08 * size, abs=1e-6)
    assert abs(middle[0] - 2) == pytest.approx(aside, abs=1e-6)
    # The beam sags: its left half turns clockwise against what it meets, its right half not.
    assert np.all(clockwise[:, 0] < 2)
    assert np.all(anticlockwise[:, 0] > 2)
    assert len(clockwise) + len(anticlockwise) == 3
    text = words(axes.figure)
    for part in ("3 members", "hinge, anticlockwise", "hinge, clockwise", "contact: stick"):
        assert part in text, part


def test_moments_stand_on_the_tension_side(broken_beam):
    _, axes = drawn(plot_mechanism(broken_beam)).axes
    faces = [
        path.vertices
        for item in axes.collections
        if isinstance(item, PolyCollection)
        and to_hex(MOMENT) in [to_hex(own) for own in item.get_edgecolor()[:1]]
        for path in item.get_paths()
    ]
    assert len(faces) == 4  # two columns, two halves of the beam
    corners = np.concatenate(faces)
    ordinate = 0.12 * np.hypot(4, 2)  # of M_p
    assert corners[:, 1].max() == pytest.approx(2 + ordinate, abs=1e-6)  # hogging over corners
    sagging = corners[np.abs(corners[:, 0] - 2) < 1e-9, 1].min()
    assert sagging == pytest.approx(2 - ordinate, abs=1e-6)
    assert np.ptp(corners[:, 0]) == pytest.approx(4 + 2 * ordinate, abs=1e-6)  # columns: outside
    assert "moment (max 1 N)" in words(axes.figure)
    assert "reaction (max 2.06 N/m)" in words(axes.figure)  # M_p/h and 2


def test_feet_that_slide_are_blue_and_no_hinge_is_round_off():
    figure = drawn(plot_mechanism(la.solve(pushed_portal(0.1, 1.0))))
    assert "contact: slip" in words(figure)
    assert "hinge" not in words(figure)
    assert "obstacle" in words(figure)


def test_a_frame_on_blocks_shows_hinges_thrust_and_moments():
    blocks = {
        "base": masonry.rectangle(-1, 5, -2, -1),
        "left": masonry.rectangle(-0.5, 0.5, -1, 0),
        "right": masonry.rectangle(3.5, 4.5, -1, 0),
    }
    problem = la.Problem(
        {"frame": portal(), "blocks": la.BlockAssembly(blocks, 0.6)},
        [la.PointForce("frame", "B", (1, 0))],
        [la.Fix("blocks", "base")],
        [
            la.Interface(("frame", "A"), ("blocks", "left"), 0.6),
            la.Interface(("blocks", "right"), ("frame", "D"), 0.6),
        ],
        [la.PointForce("frame", node, (0, -1)) for node in "BC"]
        + [la.BodyForce("blocks", (0, -1))],
    )
    figure = drawn(plot_mechanism(la.solve(problem)))
    text = words(figure)
    for part in ("3 rigid blocks, 3 members", "fixed", "moment", "reaction", "contact force"):
        assert part in text, part
    assert len(figure.axes) == 2
    (feet,) = (
        item
        for item in figure.axes[1].collections
        if hasattr(item, "U") and to_hex(item.get_facecolor()[0]) == THRUST
    )
    assert len(feet.U) == 2
    assert np.all(feet.V > 0)  # on the frame, whichever side it is


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
    assert "live load (resultant)" in words(figure)


def test_unsolved_state_says_so(sliding):
    state = replace(sliding, status=la.Status.NOT_CONVERGED, load_factor=float("nan"))
    text = words(drawn(plot_mechanism(state)))
    assert "NOT CONVERGED" in text
    assert "inspection only" in text
    assert "load factor" not in text


def test_unsolved_blocks_say_so(toppled):
    state = replace(toppled, status=la.Status.NOT_CERTIFIED, load_factor=float("nan"))
    assert "NOT CERTIFIED" in words(drawn(plot_mechanism(state)))


def test_state_without_a_point_cannot_be_drawn(sliding):
    with pytest.raises(ValueError, match="no state to look at"):
        plot_mechanism(replace(sliding, point=None))
