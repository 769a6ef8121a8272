"""Blocks from files of compas, OBJ, PLY, STL."""

import json

import meshio
import numpy as np
import pytest

import lacore as la
from tests.lacore.model.bodies.blocks3d.solids import (
    BOX,
    L_SHAPE,
    box,
    corners,
    prism,
    triangulated,
)


def stack():
    """A box below an L, and one in the corner of the L, which touch in faces, edges and corners."""
    low = box((0, 0, -1), (2, 2, 0))
    return {"low": low, "l": prism(L_SHAPE, 1), "in": box((1, 1, 0), (2, 2, 1))}


def compas(blocks, supports=()):
    nodes = {}
    for name, block in blocks.items():
        vertex = {
            str(n): dict(zip("xyz", own, strict=True))
            for n, own in enumerate(block.vertices.tolist())
        }
        face = {str(n): list(own) for n, own in enumerate(block.faces)}
        mesh = {
            "dtype": "compas_assembly.datastructures/Block",
            "data": {"vertex": vertex, "face": face},
        }
        nodes[name] = {"block": mesh, "is_support": name in supports}
    return {"data": {"graph": {"data": {"node": nodes, "edge": {}}}}}


def triangles(blocks):
    """All in one surface with common vertices, as CAD writes it."""
    points, faces = [], []
    for block in blocks.values():
        cut = triangulated(block) if block.convex else fanned()
        shift = sum(map(len, points))
        points.append(cut.vertices)
        faces += [[n + shift for n in face] for face in cut.faces]
    return np.concatenate(points), np.array(faces)


def fanned():
    """The L, cut into triangles: its caps from the reentrant corner."""
    block = prism(L_SHAPE, 1)
    caps = [(3, a, b) for a, b in ((4, 5), (5, 0), (0, 1), (1, 2))]
    cut = [cap[::-1] for cap in caps] + [tuple(6 + n for n in cap) for cap in caps]
    for a, b, c, d in (face for face in block.faces if len(face) == 4):
        cut += [(a, b, c), (a, c, d)]
    return la.Polyhedron(block.vertices, cut)


def same(read, blocks):
    expected = la.BlockAssembly3D(blocks, 0.5)
    assert read.joints.count == expected.joints.count == 4
    # STL holds 7 digits.
    assert np.sort(read.volume) == pytest.approx(np.sort(expected.volume), rel=1e-6)
    assert np.sort(read.joints.area) == pytest.approx(np.sort(expected.joints.area), rel=1e-6)


@pytest.mark.parametrize("unit", ["m", "mm"])
def test_assemblies_of_compas_keep_their_names(tmp_path, unit):
    path = tmp_path / "stack.json"
    path.write_text(json.dumps(compas(stack(), supports=("low",))))
    read = la.masonry3d.read(path, 0.5, unit=unit)
    assert read.names == ("support low", "l", "in")
    if unit == "m":
        same(read, stack())
    else:
        assert read.volume.sum() == pytest.approx(8e-9, rel=1e-12)


@pytest.mark.parametrize("ending", ["stl", "ply", "obj"])
def test_surfaces_are_taken_apart_into_blocks(tmp_path, ending):
    points, faces = triangles(stack())
    path = tmp_path / f"stack.{ending}"
    meshio.Mesh(points, [("triangle", faces)]).write(path)
    same(la.masonry3d.read(path, 0.5), stack())


def test_polygons_of_any_number_of_corners_are_read(tmp_path):
    lines, shift = [], 1
    for block in stack().values():
        lines += [f"v {x} {y} {z}" for x, y, z in block.vertices]
        lines += ["f " + " ".join(str(n + shift) for n in face) for face in block.faces]
        shift += len(block.vertices)
    path = tmp_path / "stack.obj"
    path.write_text("\n".join(lines) + "\n")
    same(la.masonry3d.read(path, 0.5), stack())


def test_coordinates_with_few_digits_need_a_tolerance(tmp_path):
    """Written to four digits, faces of a bonded dome are warped by half of the last."""
    dome = la.masonry3d.dome(6, 2, 1.0, 0.2, 0.5, 0.5, bond=True)
    rounded = compas(dome.polyhedra)
    text = json.dumps(json.loads(json.dumps(rounded), parse_float=lambda own: round(float(own), 4)))
    path = tmp_path / "dome.json"
    path.write_text(text)
    with pytest.raises(la.InputError, match=r"block 'r1m1', .*warped face"):
        la.masonry3d.read(path, 0.5, tolerance=1e-6)
    read = la.masonry3d.read(path, 0.5, tolerance=4e-4)
    assert read.joints.count == dome.joints.count
    assert read.joints.area.sum() == pytest.approx(dome.joints.area.sum(), rel=1e-2)


def test_an_open_surface_is_refused_with_its_block(tmp_path):
    cut = compas({"a": box((0, 0, 0), (1, 1, 1))})
    del cut["data"]["graph"]["data"]["node"]["a"]["block"]["data"]["face"]["3"]
    path = tmp_path / "open.json"
    path.write_text(json.dumps(cut))
    with pytest.raises(la.InputError, match=r"block 'a', .*is open"):
        la.masonry3d.read(path, 0.5)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("none.obj", None, "no such file"),
        ("blocks.dwg", "x", "not known"),
        ("blocks.json", "{", "no JSON"),
        ("blocks.json", "{}", "no graph"),
        ("blocks.obj", "v 0 0 0\n", "no polygons|cannot be read"),
        ("blocks.stl", "solid\nendsolid\n", "no polygons|cannot be read"),
        ("blocks.ply", "plyx", "cannot be read"),
    ],
)
def test_files_without_blocks_are_refused(tmp_path, name, text, words):
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(la.InputError, match=words):
        la.masonry3d.read(tmp_path / name, 0.5)


def test_wrong_units_and_tolerances_are_refused(tmp_path):
    path = tmp_path / "box.obj"
    meshio.Mesh(corners((0, 0, 0), (1, 1, 1)), [("quad", np.array(BOX))]).write(path)
    assert la.masonry3d.read(path, 0.5, unit="cm").volume.sum() == pytest.approx(1e-6)
    with pytest.raises(la.InputError, match="unit"):
        la.masonry3d.read(path, 0.5, unit="mile")
    with pytest.raises(la.InputError, match="tolerance"):
        la.masonry3d.read(path, 0.5, tolerance=0.0)
