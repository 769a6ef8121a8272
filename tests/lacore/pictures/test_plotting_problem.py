"""Sketches of problems: all that is stated is drawn, with its size, and labels can be read."""

import io
from functools import cache
from itertools import combinations

import numpy as np
import pytest
from matplotlib.collections import PolyCollection, TriMesh
from matplotlib.colors import to_rgba
from matplotlib.patches import FancyArrowPatch

import lacore as la
from lacore.pictures.mesh import shaded
from lacore.pictures.sketch.problem import plot_problem
from lacore_verification.catalogue.catalogue import catalogue
from lacore_verification.report.stored_figures import sketch_of, sketched
from tests.shares import one_in

CASES = [  # of the plane, each sixth in the fast tests
    pytest.param(case, id=case.id, marks=[pytest.mark.slow] if number % 6 else [])
    for number, case in enumerate(own for own in catalogue().values() if "space" not in own.tags)
]
SOIL = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2)
PIER = la.meshes.rectangle(x=(0.5, 1.5), y=(1, 1.5), nx=2, ny=1)


def names(figure):
    return {artist.get_gid() for artist in figure.findobj() if artist.get_gid()}


def labels(figure):
    return [text.get_text() for text in figure.axes[0].texts]


def legend(figure):
    return [text.get_text() for text in figure.axes[0].get_legend().get_texts()]


def arrows(figure, gid):
    """Tails and tips, m."""
    found = [a for a in figure.findobj(FancyArrowPatch) if a.get_gid() == gid]
    return [np.array(arrow._posA_posB) for arrow in found]


def holds_blocks(support, problem):
    blocks = isinstance(problem.bodies[support.body], la.BlockAssembly)
    return blocks and isinstance(support.where, str | tuple) and support.components == "xy"


def stated(problem):
    """What has to be drawn; blocks that are held whole are drawn as such."""
    for index, support in enumerate(problem.supports):
        if not holds_blocks(support, problem):
            yield f"support-{index}"
    for kind in ("interface", "reference_load", "dead_load"):
        for index, _ in enumerate(getattr(problem, f"{kind}s")):
            yield f"{kind.replace('_', '-')}-{index}"
    assemblies = [b for b in problem.bodies.values() if isinstance(b, la.BlockAssembly)]
    yield from (f"joints-{k}" for k, body in enumerate(assemblies) if body.joints.count)


@cache
def sketch(name):
    """Of the first variant of a case: nothing below changes it."""
    case = catalogue()[name]
    return sketch_of(case, *sketched(case, case.variants[0]))


@pytest.mark.parametrize("case", CASES)
def test_sketch_of_a_case_shows_all_that_is_stated(case):
    figure = sketch(case.id)
    problem, tools = sketched(case, case.variants[0])
    assert set(stated(problem)) | {f"tool-{name}" for name in tools} <= names(figure)
    assert any(r"\alpha" in text for text in labels(figure)) != bool(tools)
    held = any(holds_blocks(support, problem) for support in problem.supports)
    assert ("fixed block" in legend(figure)) == held
    figure.savefig(io.BytesIO(), format="svg")


@pytest.mark.parametrize("case", CASES)
def test_labels_do_not_cover_each_other_and_stay_on_the_page(case):
    figure = sketch(case.id)
    figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in figure.axes[0].texts]
    for one, other in combinations(boxes, 2):
        assert not one.overlaps(other)
    for box in boxes:
        assert 0 <= box.x0 <= box.x1 <= figure.bbox.width
        assert 0 <= box.y0 <= box.y1 <= figure.bbox.height


def continuum(**parts):
    given = {
        "bodies": {"soil": la.Body(SOIL, la.VonMises(1.0))},
        "supports": [la.Fix("soil", "bottom")],
        "reference_loads": [la.Traction("soil", "top", (0, -2.0))],
    }
    return la.Problem(**(given | parts))


def test_axes_show_metres_at_one_scale():
    axes = continuum().plot().axes[0]
    assert axes.get_aspect() == 1.0
    assert axes.get_xlabel() == "x [m]"


@pytest.mark.parametrize(
    ("load", "tail", "tip"),
    [
        (la.Traction("soil", "top", (0, -2.0)), "above", "below"),
        (la.Traction("soil", "top", (0, 2.0)), "below", "above"),
        (la.Pressure("soil", "top", 2.0), "above", "below"),
        (la.Pressure("soil", "top", -2.0), "below", "above"),
    ],
)
def test_arrows_of_a_boundary_stand_outside_and_point_as_the_load_does(load, tail, tip):
    figure = continuum(reference_loads=[load]).plot()
    found = arrows(figure, "reference-load-0")
    assert len(found) > 3
    for line in found:
        assert line[:, 1].min() >= 1.0
        assert (line[0, 1] > line[1, 1]) == (tail == "above")
    assert r"$\alpha \cdot 2$ Pa" in labels(figure)


def test_tools_have_their_names_and_arrows_along_their_motions():
    tools = {
        "roll": la.Tool(la.shapes.disc((1, 1.5), 0.5), ("soil", "top"), (0, -1), turn=2.0),
        "stop": la.Tool(la.shapes.plane((2, 0), (-1, 0)), ("soil", "right"), (-0.5, 0)),
        "die": la.Tool(la.shapes.wedge((0, 0), 30, (-1, 0)), ("soil", "left")),
    }
    figure = plot_problem(continuum(reference_loads=()), tools=tools)
    assert {f"tool-{name}" for name in tools} <= names(figure)
    assert set(tools) <= set(labels(figure))
    (down,), (left,) = (arrows(figure, f"tool-{name}-motion") for name in ("roll", "stop"))
    assert down[1] - down[0] == pytest.approx([0, -2 * np.linalg.norm(left[1] - left[0])])
    assert left[1, 0] < left[0, 0]
    ((right, other),) = arrows(figure, "tool-roll-turn")  # anticlockwise over the centre
    assert right[0] > 1.0 > other[0]
    assert not arrows(figure, "tool-die-motion")
    assert "motion of a tool" in legend(figure)


def test_shear_runs_along_the_boundary():
    figure = continuum(reference_loads=[la.Traction("soil", "top", (-3.0, 0))]).plot()
    for (x, y), (to_x, to_y) in arrows(figure, "reference-load-0"):
        assert to_x < x
        assert to_y == pytest.approx(y)
        assert y > 1.0


def test_weight_starts_at_the_centroid_and_is_worth_the_resultant():
    figure = continuum(dead_loads=[la.BodyForce("soil", (0, -3.0))]).plot()
    ((tail, tip),) = arrows(figure, "dead-load-0")
    assert tail == pytest.approx([1.0, 0.5])  # of 2 m x 1 m
    assert tip[1] < tail[1]
    assert "$6$ N/m" in labels(figure)


def test_weight_of_some_blocks():
    wall = la.masonry.running_bond(([1, 1], [1, 1]), friction=0.5, block=(1.0, 0.5))
    own = tuple(name for name in wall.names if name != "base")
    problem = la.Problem(
        bodies={"wall": wall},
        supports=[la.Fix("wall", "base")],
        reference_loads=[la.BodyForce("wall", (1, 0), own)],
    )
    assert r"$\alpha \cdot 2$ N/m" in labels(problem.plot())  # four of half a square metre


@pytest.mark.parametrize(
    ("where", "components", "text"),
    [
        ("left", "x", "$u_x = 0$"),
        ("left", "normal", "$u_n = 0$"),
        ("left", "tangential", "$u_t = 0$"),
        ("left", "y", "$u_y = 0$"),
        ("left", "xy", "$u = 0$"),
    ],
)
def test_supports_of_each_kind(where, components, text):
    supports = [la.Fix("soil", "bottom"), la.Fix("soil", where, components)]
    figure = continuum(supports=supports).plot()
    assert "support-1" in names(figure)
    assert text in legend(figure)


@pytest.mark.parametrize(
    ("law", "text"),
    [
        (0.25, r"$\mu = 0.25$"),
        (la.Coulomb(0.25, associated=True), r"$\mu = 0.25$, associated"),
        (la.SMOOTH, "smooth"),
        (la.STICK, "stick"),
        (la.Tresca(0.5), r"$|t_t| \leq 0.5$ Pa"),
    ],
)
def test_friction_of_each_kind(law, text):
    obstacle = la.Interface(("soil", "bottom"), la.RigidObstacle(), law)
    figure = continuum(supports=[], interfaces=[obstacle]).plot()
    assert "interface-0" in names(figure)
    assert text in labels(figure)
    assert "rigid obstacle" in legend(figure)


@pytest.mark.parametrize(
    "law",
    [
        la.Tresca(2e3),
        *one_in(4, [0.25, la.Coulomb(0.25, associated=True), la.SMOOTH, la.STICK]),
    ],
)
def test_joints_have_the_text_of_their_law(law):
    blocks = la.BlockAssembly({"a": la.masonry.rectangle(0, 1, 0, 1), "b": _ABOVE}, law)
    problem = la.Problem(
        bodies={"blocks": blocks},
        supports=[la.Fix("blocks", "a")],
        reference_loads=[la.PointForce("blocks", "b", (1, 0))],
    )
    obstacle = la.Interface(("soil", "bottom"), la.RigidObstacle(), law)
    (text,) = set(labels(continuum(interfaces=[obstacle], supports=[]).plot())) & set(
        labels(problem.plot())
    )
    assert text


_ABOVE = la.masonry.rectangle(0, 1, 1, 2)


def test_two_bodies_are_named_as_they_are():
    """Dollars are no mathematics in names that users give."""
    problem = continuum(
        bodies={
            "soil": la.Body(SOIL, la.VonMises(1.0)),
            "pier $x$_1": la.Body(PIER, la.VonMises(2.0)),
        },
        interfaces=[la.Interface(("pier $x$_1", "bottom"), ("soil", "top"), 0.3)],
        reference_loads=[la.RigidFooting("pier $x$_1", "top", (0, -1), rough=True)],
    )
    figure = problem.plot()
    assert {"soil", "pier $x$_1", r"$\mu = 0.3$"} <= set(labels(figure))
    assert "rigid footing, rough" in legend(figure)
    assert {"soil, $k$ = 1 Pa", r"pier \$x\$_1, $k$ = 2 Pa"} <= set(legend(figure))


def test_regions_have_their_own_entries_and_the_page_stays_as_wide_as_the_structure():
    mesh = la.meshes.layered((0, 8), {"fill": (-1, 0), "clay": (-4, -1)}, nx=4, ny=4)
    sand = la.MohrCoulomb(2e3, 32)
    criterion = {"fill": sand, "clay": la.VonMises(la.Linear(1e4, (0, -2e3), (0, 0)))}
    one, two = (
        la.Problem(
            bodies={"soil": la.Body(mesh, own)},
            supports=[la.Fix("soil", "bottom"), la.Fix("soil", "left", "x")],
            reference_loads=[la.Traction("soil", "top", (0, -5e4))],
            dead_loads=[la.BodyForce("soil", (0, -18e3))],
        ).plot()
        for own in (sand, criterion)
    )
    assert {r"fill, $c$ = 2 kPa, $φ$ = 32°", "clay, $k$ = 12 to 18 kPa"} <= set(legend(two))
    assert {r"$\alpha \cdot 50$ kPa", "$576$ kN/m"} <= set(labels(two))
    page = two.axes[0].get_legend().get_window_extent()
    assert page.x1 <= two.bbox.x1
    assert two.get_size_inches()[0] == one.get_size_inches()[0]


def test_a_strength_that_hardens_is_the_first():
    law = la.hardening.Linear(3**0.5, 2.0)
    figure = continuum(bodies={"soil": la.Body(SOIL, la.VonMises(hardening=law))}).plot()
    assert "rigid-plastic, hardening, at first $k$ = 1 Pa" in legend(figure)


def test_frames_with_all_that_they_can_have():
    frame = la.Frame(
        {"A": (0, 0), "B": (0, 3), "C": (4, 3), "D": (4, 0), "E": (7, 0)},
        [("A", "B"), ("B", "C"), ("C", "D"), ("C", "E")],
        {"A-B": 1.0, "B-C": 2.0, "C-D": 1.0, "C-E": 1.0},
        releases=[("B-C", "C")],
    )
    supports = [("A", "clamped"), ("D", "xy"), ("E", "y")]
    problem = la.Problem(
        bodies={"frame": frame},
        supports=[la.Fix("frame", *support) for support in supports],
        reference_loads=[la.PointForce("frame", (2, 3), (0, -1))],
        dead_loads=[la.Traction("frame", "A-B", (1, 0))],
    )
    figure = problem.plot()
    assert set(stated(problem)) <= names(figure)
    assert "pinned end" in legend(figure)
    assert r"member, $M_p = 1 \ldots 2$ N" in legend(figure)
    for line in arrows(figure, "dead-load-0"):
        assert line[:, 0].max() <= 0  # on the side that the wind comes from


def test_many_laws_are_counted():
    blocks = {str(k): la.masonry.rectangle(0, 1, k, k + 1) for k in range(9)}
    laws = {(str(k), str(k + 1)): 0.1 * (k + 1) for k in range(8)}
    problem = la.Problem(
        bodies={"stack": la.BlockAssembly(blocks, 0.5, laws)},
        supports=[la.Fix("stack", "0")],
        reference_loads=[la.BodyForce("stack", (1, 0))],
    )
    assert "joints: 8 friction laws" in legend(problem.plot())


def test_bodies_of_one_material_have_colours_of_their_own():
    """Each with its name in the legend, also under water."""
    soil = la.MohrCoulomb(1.0, 20)
    lower, upper = (la.meshes.rectangle((0, 1), y, 1, 1) for y in ((-1, 0), (0, 1)))
    problem = la.Problem(
        bodies={"sand": la.Body(lower, soil), "fill": la.Body(upper, soil)},
        supports=[la.Fix("sand", "bottom")],
        interfaces=[la.Interface(("fill", "bottom"), ("sand", "top"), friction=la.BOND)],
        reference_loads=[la.Pressure("fill", "top")],
        dead_loads=[la.PorePressure(name, la.WaterTable(1.0, 1.0)) for name in ("sand", "fill")],
    )
    axes = (figure := problem.plot()).axes[0]
    first, second = [own for own in axes.collections if isinstance(own, PolyCollection)][:2]
    colours = [tuple(own.get_facecolor()[0]) for own in (first, second)]
    assert colours[0] != colours[1]
    assert [text.partition(",")[0] for text in legend(figure)[:2]] == ["sand", "fill"]
    water = [own.get_cmap()(0.0) for own in axes.collections if isinstance(own, TriMesh)]
    assert water == colours


def test_water_hides_no_region():
    """Without pressure each has its colour, and the same pressure everywhere is as blue."""
    mesh = la.meshes.layered((0, 2), {"clay": (-2, -1), "sand": (-1, 0)}, 2, 2)
    body = la.Body(mesh, {"clay": la.MohrCoulomb(1.0, 20), "sand": la.MohrCoulomb(1.0, 30)})
    problem = la.Problem(
        bodies={"soil": body},
        supports=[la.Fix("soil", "bottom")],
        reference_loads=[la.Pressure("soil", "top")],
        dead_loads=[la.PorePressure("soil", la.WaterTable(0.0, 1.0))],
    )
    axes = problem.plot().axes[0]
    water = [own for own in axes.collections if isinstance(own, TriMesh)]
    dry = [to_rgba(colour) for _, colour in shaded(body)]
    assert [own.get_cmap()(0.0) for own in water] == dry
    assert {own.get_clim() for own in water} == {(0.0, 2.0)}


def test_water_is_drawn_where_it_is():
    """Deep blue where pores are pressed most; arrows on the ground as long as the water is deep."""
    table = la.WaterTable(1.0, 1.0)
    problem = la.Problem(
        bodies={"soil": la.Body(SOIL, la.MohrCoulomb(1.0, 30))},
        supports=[la.Fix("soil", "bottom")],
        reference_loads=[la.Pressure("soil", "top")],
        dead_loads=[la.PorePressure("soil", table), la.StandingWater("soil", "left", table)],
    )
    figure = problem.plot()
    assert {"dead-load-0", "dead-load-1"} <= names(figure)
    assert "pore water" in legend(figure)
    assert any("$u \\leq$ $1$ Pa" in text for text in labels(figure))
    tails, tips = np.array(arrows(figure, "dead-load-1")).swapaxes(0, 1)
    lengths = np.linalg.norm(tips - tails, axis=1)
    assert (tips[:, 0] > tails[:, 0]).all()
    depth = 1.0 - tips[:, 1]
    assert np.allclose(lengths / lengths.max(), depth / depth.max(), atol=1e-9)
