"""Blocks from drawings: what is read is what was drawn, whatever the program and its noise."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lacore as la
from lacore.model.bodies.blocks.drawings.drawn import GRAVITY
from lacore.reporting.errors import InputError
from tests.lacore.model.bodies.drawings import (
    FORMS,
    LAYERS,
    MM,
    STONE,
    compas,
    drawn,
    dxf,
    dxf_of_lines,
    facade,
    geojson,
    new_dxf,
    pushed,
)

SMALL = facade(wide=6, courses=9)
TINY = [("ground", la.masonry.rectangle(0, 2, -1, 0))]
TINY += [("stone", la.masonry.rectangle(x, x + 1, 0, 1)) for x in (0, 1)]
TINY += [
    ("stone", la.masonry.rectangle(x, x + w, 1, 2)) for x, w in ((0, 0.5), (0.5, 1), (1.5, 0.5))
]
TINY += [("stone", la.masonry.rectangle(x, x + 1, 2, 3)) for x in (0, 1)]
EPS = np.finfo(float).eps


def load_factor(read, friction=la.Coulomb(0.65, associated=True)):  # noqa: B008
    """Of an associated wall under a sideways share of its weight: Coulomb's is not unique."""
    body = replace(read.blocks, friction=friction, joint_friction=None)
    push, weight = read.weight("wall", (1, 0)), read.weight("wall")
    state = la.solve(pushed(body, weight, push, read.named("ground")), backend="highs")
    return state.load_factor


def exact(blocks):
    body = la.BlockAssembly(dict(blocks.polygons), la.Coulomb(0.65, associated=True))
    loads = [[la.BodyForce("wall", direction)] for direction in ((0, -1), (1, 0))]
    return la.solve(pushed(body, *loads, "base"), backend="highs").load_factor


def outlines(read):
    """Vertices by name, sorted."""
    return {
        name: ring[np.lexsort(np.round(ring, 9).T)] for name, ring in read.blocks.polygons.items()
    }


def test_a_facade_of_a_cad_program_in_fifteen_lines(tmp_path):
    blocks, _ = facade()
    # 1e-6 of a metre, which is 1e-3 of the unit of the drawing.
    path = dxf(tmp_path / "facade.dxf", drawn(blocks, noise=1e-6, seed=1))

    stone = la.masonry.Layer(friction=0.65, density=2400)
    brick = la.masonry.Layer(friction=0.65, density=1800)
    wall = la.masonry.read(path, {"stone": stone, "brick": brick, "ground": stone})
    problem = la.Problem(
        bodies={"wall": wall.blocks},
        supports=[la.Fix("wall", wall.named("ground"))],
        dead_loads=wall.weight("wall"),
        reference_loads=wall.weight("wall", direction=(1, 0)),
    )
    state = la.solve(problem)

    assert len(wall.blocks.names) > 150
    assert wall.blocks.joints.count == blocks.joints.count
    assert state.status is la.Status.SOLVED
    assert state.certificate.worst[1] < 1e-6
    assert wall.unit == "mm"
    # Each vertex lies within sqrt(2) times the noise of where it was meant to be.
    assert 0 < wall.moved < 10e-6
    for told in ("in mm", "in 'stone'", "snap", "TEXT", "trees"):
        assert told in str(wall)
    assert wall.weight("wall")[1].vector == pytest.approx((0, -1800 * GRAVITY))


@settings(max_examples=2, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), noise=st.sampled_from([0.0, 1e-9, 1e-6, 5e-6]))
def test_noise_order_and_format_change_nothing(tmp_path_factory, seed, noise):
    folder = tmp_path_factory.mktemp("drawings")
    blocks, windows = SMALL
    polygons = drawn(blocks, noise, seed)
    reads = [
        la.masonry.read(dxf(folder / "a.dxf", polygons), LAYERS),
        la.masonry.read(geojson(folder / "a.geojson", polygons), LAYERS, unit="m"),
        la.masonry.read(
            dxf_of_lines(folder / "b.dxf", drawn(blocks, 0, seed), windows, noise, seed),
            LAYERS,
            openings=["windows"],
        ),
    ]
    alpha = exact(blocks)
    for read in reads:
        assert read.blocks.joints.count == blocks.joints.count
        # Arms are off by twice the noise where heights of 9 courses turn about widths of 0.2 m; the
        # load factor, a ratio of arms, by that, times a few for the hinges of the mechanism.
        allowed = 1e-6 + 10 * 2 * noise / 0.2 * 9
        assert load_factor(read) == pytest.approx(alpha, rel=allowed)


@settings(max_examples=3, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_reading_depends_on_no_order_and_no_direction(tmp_path_factory, seed):
    """Of the same noise: only sums are added up in another order."""
    folder, draw = tmp_path_factory.mktemp("drawings"), np.random.default_rng(seed)
    noisy = [(layer, ring + draw.uniform(-2e-6, 2e-6, ring.shape)) for layer, ring in TINY]
    again = [(layer, np.roll(ring, draw.integers(9), axis=0)) for layer, ring in noisy]
    again = [(layer, ring[:: draw.choice([-1, 1])]) for layer, ring in again]
    draw.shuffle(again)
    for write in (dxf, dxf_of_lines):
        one, other = (
            la.masonry.read(write(folder / "a.dxf", own), {"stone": STONE, "ground": STONE})
            for own in (noisy, again)
        )
        first, second = outlines(one), outlines(other)
        assert list(first) == list(second)
        for name, ring in first.items():
            # A least-squares step of 1e-6 m, solved to 1e-9 of it.
            assert second[name] == pytest.approx(ring, abs=1e-13)
        assert one.layer == other.layer


def test_corners_lie_on_the_edges_that_they_rest_on(tmp_path):
    """To round-off, over whole courses, where noise put each of them beside."""
    blocks, _ = facade()
    read = la.masonry.read(dxf(tmp_path / "a.dxf", drawn(blocks, 5e-6, 3)), LAYERS)
    joints, edges = read.blocks.joints, read.blocks.edges
    own, other = edges.normal[:, joints.slave_edge], edges.normal[:, joints.master_edge]
    assert np.abs(own + other).max() < 1e3 * EPS  # an edge is a thousandth of a coordinate at least
    gap = np.sum((edges.start[:, joints.master_edge] - joints.start) * own, axis=0)
    assert np.abs(gap).max() < 1e3 * EPS


@pytest.mark.parametrize("form", FORMS)
def test_assemblies_of_compas_are_read_as_data(form, tmp_path):
    blocks, _ = SMALL
    path = compas(tmp_path / "wall.json", drawn(blocks), form=form)
    read = la.masonry.read(path, {"block": STONE, "support": STONE}, unit="m")
    assert read.blocks.joints.count == blocks.joints.count
    assert read.named("support") == ("support 1",)
    assert read.blocks.area.sum() == pytest.approx(blocks.area.sum(), rel=1e-12)
    assert read.handles["support 1"] == ("guid-0" if form == "model" else "0")


def test_elements_that_a_model_moves_are_refused(tmp_path):
    path = compas(tmp_path / "wall.json", drawn(SMALL[0]), form="model")
    content = json.loads(path.read_text())
    unit = [[float(row == column) for column in range(4)] for row in range(4)]
    moved = [[*row[:3], 1.0] for row in unit]
    for matrix, said in ((unit, None), (moved, "handle guid-0: its element is moved")):
        content["data"]["transformation"] = {"data": {"matrix": matrix}}
        path.write_text(json.dumps(content))
        if said is None:
            la.masonry.read(path, {"block": STONE, "support": STONE}, unit="m")
            continue
        with pytest.raises(InputError, match=said):
            la.masonry.read(path, {"block": STONE, "support": STONE}, unit="m")


def test_units_are_those_of_the_drawing_or_of_the_user(tmp_path):
    polygons = drawn(SMALL[0])
    area = SMALL[0].area.sum()
    for units, scale in ((4, MM), (5, 100), (6, 1), (1, 1 / 0.0254), (2, 1 / 0.3048)):
        read = la.masonry.read(dxf(tmp_path / "a.dxf", polygons, scale, units), LAYERS)
        assert read.blocks.area.sum() == pytest.approx(area, rel=1e-9)
    path = dxf(tmp_path / "b.dxf", polygons, MM, units=6)  # a template in m, drawn in mm
    assert la.masonry.read(path, LAYERS, unit="mm").blocks.area.sum() == pytest.approx(area)
    path = dxf(tmp_path / "c.dxf", polygons, MM, units=0)
    with pytest.raises(InputError, match=r"unit: .*says no unit of length; give one of m"):
        la.masonry.read(path, LAYERS)


def square(x, y, side=1.0):
    return la.masonry.rectangle(x, x + side, y, y + side)


def stacked(space, layer="stone", **attributes):
    """A square on a square, mm."""
    for y in (0, 1):
        space.add_lwpolyline(
            square(0, y) * MM, close=True, dxfattribs={"layer": layer, **attributes}
        )


def read_squares(path, **given):
    return la.masonry.read(path, {"stone": STONE}, **given)


def test_hatches_symbols_and_lines_drawn_twice(tmp_path):
    document, space = new_dxf()
    stacked(space)
    hatch = space.add_hatch(dxfattribs={"layer": "stone"})
    hatch.paths.add_polyline_path(square(0, 0) * MM, is_closed=True)
    symbol = document.blocks.new("stone of the catalogue")
    symbol.add_lwpolyline(square(0, 0) * MM, close=True)  # its layer is that of the insertion
    inserted = space.add_blockref(symbol.name, (0, 2 * MM), dxfattribs={"layer": "stone"})
    document.saveas(tmp_path / "a.dxf")
    read = read_squares(tmp_path / "a.dxf")
    assert read.blocks.names == ("stone 1", "stone 2", "stone 3")
    assert hatch.dxf.handle in read.handles["stone 1"]
    assert read.handles["stone 3"] == inserted.dxf.handle
    assert read.blocks.joints.count == 2
    assert read.at((0.5, 2.5)) == "stone 3"


def test_joints_drawn_once_enclose_blocks(tmp_path):
    """Four lines around, long bed joints, head joints that end on them or cross them."""
    document, space = new_dxf()
    lines = [((0, 0), (4, 0)), ((4, 0), (4, 3)), ((4, 3), (0, 3)), ((0, 3), (0, 0))]
    lines += [((0, 1), (4, 1)), ((4, 2), (0, 2)), ((1, 0), (1, 1)), ((2, 1), (2, 2))]
    lines += [((3, -1e-6), (3, 3))]  # across both bed joints, and a little too long
    for start, end in lines:
        attributes = {"layer": "stone"}
        space.add_line(np.multiply(start, MM), np.multiply(end, MM), dxfattribs=attributes)
    document.saveas(tmp_path / "a.dxf")
    read = read_squares(tmp_path / "a.dxf")
    assert sorted(np.round(read.blocks.area, 5)) == [1, 1, 1, 1, 1, 2, 2, 3]
    assert read.blocks.joints.count == 2 + 2 + 1 + 4 + 3


def test_curves_become_chords_if_one_says_how_close(tmp_path):
    document, space = new_dxf()
    half = [(0, 0), (MM, 0, 0, 0, 1.0)]  # a bulge of 1: half a circle back to the start
    space.add_lwpolyline(half, format="xyseb", close=True, dxfattribs={"layer": "stone"})
    document.saveas(tmp_path / "a.dxf")
    with pytest.raises(InputError, match=r"handle .*LWPOLYLINE.*a curve.*sagitta"):
        read_squares(tmp_path / "a.dxf")
    area = read_squares(tmp_path / "a.dxf", sagitta=1e-4).blocks.area[0]
    full = np.pi / 8
    # Chords of a circle of radius 0.5 m lose at most the sagitta times the length of the arc.
    assert full - 1e-4 * np.pi / 2 < area < full


def test_friction_of_two_layers_is_that_of_the_weaker_one(tmp_path):
    document, space = new_dxf()
    stacked(space, "stone")
    space.add_lwpolyline(square(0, 2) * MM, close=True, dxfattribs={"layer": "brick"})
    document.saveas(tmp_path / "a.dxf")
    layers = {"stone": STONE, "brick": la.masonry.Layer(0.4, 1800)}
    blocks = la.masonry.read(tmp_path / "a.dxf", layers).blocks
    assert sorted(blocks.joints.coefficient) == [0.4, 0.65]
    between = {("brick", "stone"): 0.5}
    blocks = la.masonry.read(tmp_path / "a.dxf", layers, joint_friction=between).blocks
    assert sorted(blocks.joints.coefficient) == [0.5, 0.65]
    glued = {"stone": STONE, "brick": la.masonry.Layer(la.Tresca(1e4), 1800)}
    with pytest.raises(InputError, match="neither of their laws is the weaker"):
        la.masonry.read(tmp_path / "a.dxf", glued)


def two_squares(*more, gap=0.0):
    def draw(space):
        stacked(space)
        for ring in more:
            space.add_lwpolyline(np.multiply(ring, MM), close=True, dxfattribs={"layer": "stone"})

    return draw


def lines(*ends):
    def draw(space):
        for start, end in ends:
            attributes = {"layer": "stone"}
            space.add_line(np.multiply(start, MM), np.multiply(end, MM), dxfattribs=attributes)

    return draw


TRIANGLE = [((0, 0), (1, 0)), ((1, 0), (1, 1)), ((1, 1), (0, 0.02))]
WRONG = {
    "overlap": (two_squares(square(0.5, 1.5)), r"blocks overlap at \(.*over 0.25 m\^2.*openings"),
    "sliver": (two_squares([(0, 2), (1, 2), (1, 2 + 1e-5), (0, 2 + 1e-5)]), "sliver|smaller than"),
    "bow tie": (two_squares([(0, 2), (1, 3), (1, 2), (0, 3)]), "crosses or touches itself"),
    "open": (
        lines(*TRIANGLE),
        r"closes no outline.*ends at \(0, 0(\.02)?\) m, 0.02 m from the next",
    ),
    "bridge": (
        lines(
            *zip(square(0, 0), np.roll(square(0, 0), -1, axis=0), strict=True),
            ((1, 1), (3, 3)),
            *zip(square(3, 3), np.roll(square(3, 3), -1, axis=0), strict=True),
        ),
        "closes no outline",
    ),
    "frame": (
        lines(
            *zip(square(0, 0, 3), np.roll(square(0, 0, 3), -1, axis=0), strict=True),
            *zip(square(1, 1), np.roll(square(1, 1), -1, axis=0), strict=True),
        ),
        "enclose an area with a hole",
    ),
    "out of the plane": (
        lambda space: space.add_line((0, 0, 0), (1, 0, 1), dxfattribs={"layer": "stone"}),
        "is not plane: z goes from 0 to 1",
    ),
}


@pytest.mark.parametrize(("draw", "told"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_said_by_layer_handle_and_place(tmp_path, draw, told):
    document, space = new_dxf()
    draw(space)
    document.saveas(tmp_path / "a.dxf")
    with pytest.raises(InputError, match=told) as caught:
        read_squares(tmp_path / "a.dxf")
    assert "layer 'stone', handle " in str(caught.value)


def test_a_snap_that_swallows_what_was_drawn_is_refused(tmp_path):
    document, space = new_dxf()
    ring = [(0, 0), (1, 0), (1, 1), (0.6, 1), (0.5, 1.05), (0.4, 1), (0.3, 1.05), (0.2, 1), (0, 1)]
    space.add_lwpolyline(np.multiply(ring, MM), close=True, dxfattribs={"layer": "stone"})
    document.saveas(tmp_path / "a.dxf")
    assert read_squares(tmp_path / "a.dxf").blocks.area[0] > 1
    with pytest.raises(InputError, match="m from the first to the last; give a smaller snap"):
        read_squares(tmp_path / "a.dxf", snap=0.12)


HOLE = {"type": "Polygon", "coordinates": [square(0, 0, 3).tolist(), square(1, 1).tolist()]}
FILES = {
    "no file": ("none.dxf", None, "no such file"),
    "no DXF": ("a.dxf", "a drawing\nof a wall\n", "cannot be read as DXF"),
    "DWG": ("a.dwg", "AC1032", "a format that is not known.*its DXF"),
    "no JSON": ("a.json", "{", "no JSON"),
    "other JSON": ("a.json", "[1, 2]", "neither GeoJSON .* nor an assembly of compas"),
    "no blocks": ("a.json", '{"node": {}, "edge": {}}', "an assembly without blocks"),
    "no mesh": ("a.json", '{"node": {"7": {}}, "edge": {}}', "handle 7: .*without the mesh"),
    "no geometry": ("a.geojson", '{"type": "Polygonn"}', "no geometry of GeoJSON"),
    "a hole": ("a.geojson", json.dumps(HOLE), "a polygon with a hole"),
}


@pytest.mark.parametrize(("name", "text", "told"), FILES.values(), ids=FILES)
def test_files_that_are_no_drawings(tmp_path, name, text, told):
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=told):
        la.masonry.read(tmp_path / name, {"0": STONE}, unit="m")


GIVEN = {
    "no such layer": ({"layers": {"stonee": STONE}}, "no such layer.*did you mean 'stone'"),
    "no layers": ({"layers": {}}, r"give .*Layer\("),
    "no layer": ({"layers": {"stone": 0.6}}, "not what a layer is made of"),
    "unit": ({"unit": "metre"}, "no unit of drawings; give one of m, dm"),
    "snap": ({"snap": -1.0}, "snap = -1.0"),
    "openings": ({"openings": ["stone"]}, "a layer of blocks, too"),
    "an empty layer": ({"layers": {"note": STONE}}, "a layer without lines"),
    "joints": ({"joint_friction": {("stone", "brick"): 0.5}}, "joint_friction"),
}


@pytest.mark.parametrize(("given", "told"), GIVEN.values(), ids=GIVEN)
def test_bad_arguments(tmp_path, given, told):
    document, space = new_dxf()
    stacked(space)
    space.add_text("south", dxfattribs={"layer": "note"})
    document.saveas(tmp_path / "a.dxf")
    with pytest.raises(InputError, match=told):
        la.masonry.read(tmp_path / "a.dxf", **{"layers": {"stone": STONE}, **given})


def test_a_layer_says_what_it_is_made_of():
    for wrong, told in (((0.6, -1.0), "density"), ((-0.6, 1.0), "Layer.friction")):
        with pytest.raises(InputError, match=told):
            la.masonry.Layer(*wrong)
