"""Assemblies and drawings of other programs: structure, gaps, repetitions, warped faces."""

import json

import ezdxf
import numpy as np
import pytest
from scipy.optimize import linprog

import lacore as la
from lacore.model.meshes.files.notes import notes_of

CUBE = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
FACES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
FRICTION = 0.5


def mesh(points, faces=FACES):
    return {
        "vertex": {
            str(k): dict(zip("xyz", map(float, p), strict=True)) for k, p in enumerate(points)
        },
        "face": {str(k): list(map(str, face)) for k, face in enumerate(faces)},
    }


def shifted(z, x=0.0, points=CUBE):
    return [(a + x, b, c + z) for a, b, c in points]


def network(blocks, supports, **more):
    nodes = {name: {"is_support": name in supports, "x": 0.0} for name in blocks}
    return {"assembly": {"node": nodes, "edge": {}}, "blocks": blocks, **more}


def graph(blocks, supports, **more):
    nodes = {name: {"block": own, "is_support": name in supports} for name, own in blocks.items()}
    return {"type": "face_face", "graph": {"node": nodes, "edge": {}}, **more}


def saved(folder, content):
    path = folder / "assembly.json"
    path.write_text(json.dumps(content))
    return path


def pushed(assembly):
    """The load factor of a horizontal weight of the free blocks."""
    held = tuple(name for name in assembly.names if name.startswith("support"))
    free = tuple(name for name in assembly.names if name not in held)
    problem = la.Problem(
        {"wall": assembly},
        [la.BodyForce("wall", (1, 0, 0), free)],
        [la.Fix("wall", held)],
        dead_loads=[la.BodyForce("wall", (0, 0, -1), free)],
    )
    return la.solve(problem).load_factor


def by_linear_program(towers):
    """Return the largest horizontal weight of stacks of cubes, by forces at corners of joints.

    Coulomb's cone is cut along x, which is exact here: nothing acts along y, and the structure is
    symmetric. Each tower is a stack of unit cubes on fixed ground.
    """
    best = np.inf
    for height in towers:
        forces = 4 * 2 * height  # normal and tangential at four corners of each joint
        rows, right = [], []
        for block in range(height):
            balance = np.zeros((3, forces + 1))
            for sign, joint in ((1, block), (-1, block + 1)):
                if joint == height:
                    continue
                for corner, x in enumerate((0, 0, 1, 1)):
                    n, t = 8 * joint + 2 * corner, 8 * joint + 2 * corner + 1
                    arm, up = x - 0.5, (-0.5 if sign == 1 else 0.5)
                    balance[0, t], balance[1, n] = sign, sign
                    balance[2, n], balance[2, t] = sign * arm, -sign * up
            balance[0, -1] = 1.0
            rows.append(balance)
            right += [0.0, 1.0, 0.0]
        cone = np.zeros((forces, forces + 1))
        for k in range(forces // 2):
            cone[2 * k : 2 * k + 2, 2 * k] = -FRICTION
            cone[2 * k, 2 * k + 1], cone[2 * k + 1, 2 * k + 1] = 1, -1
        bounds = [(0, None) if k % 2 == 0 else (None, None) for k in range(forces)] + [(0, None)]
        found = linprog(
            np.append(np.zeros(forces), -1.0),
            cone,
            np.zeros(forces),
            np.concatenate(rows),
            right,
            bounds,
        )
        best = min(best, -found.fun)
    return best


@pytest.mark.parametrize("write", [network, graph])
def test_both_structures_of_compas_are_read(tmp_path, write):
    """The supports are named, and the load factor is that of a linear program."""
    blocks = {str(k): mesh(shifted(k)) for k in range(4)}
    found = la.masonry3d.read(saved(tmp_path, write(blocks, {"0"})), friction=FRICTION)
    assert found.names == ("support 0", "1", "2", "3")
    assert found.joints.count == 3
    # Certified to 1e-6.
    assert pushed(found) == pytest.approx(by_linear_program([3]), rel=1e-5)


def test_a_type_that_is_not_geojson_is_an_assembly(tmp_path):
    layers = {name: la.masonry.Layer(FRICTION, 2000.0) for name in ("block", "support")}
    blocks = {str(k): mesh(shifted(k)) for k in range(2)}
    path = saved(tmp_path, graph(blocks, {"0"}))
    assert la.masonry.read(path, layers, unit="m").blocks.names == ("support 1", "block 1")


def test_an_open_ground_face_is_fixed_ground(tmp_path):
    ground = [(-1, -1, 0), (3, -1, 0), (3, 2, 0), (-1, 2, 0)]
    blocks = {"g": mesh(ground, [(0, 1, 2, 3)]), "a": mesh(CUBE), "b": mesh(shifted(1))}
    found = la.masonry3d.read(saved(tmp_path, network(blocks, set())), friction=FRICTION)
    assert found.names == ("support g", "a", "b")
    assert any("fixed ground: g" in note for note in notes_of(found))
    low, high = found.polyhedra["support g"].box
    assert high[2] == 0 > low[2]
    assert pushed(found) == pytest.approx(by_linear_program([2]), rel=1e-5)


def test_warped_faces_are_cut_into_triangles(tmp_path):
    """One corner of the top is 0.1 m low: the volume is that of two prisms over the base."""
    warped = [*CUBE[:-1], (1, 1, 0.9)]
    blocks = {"0": mesh(shifted(-1)), "1": mesh(warped)}
    found = la.masonry3d.read(saved(tmp_path, network(blocks, {"0"})), friction=FRICTION)
    assert any("warped face" in note for note in notes_of(found))
    assert "warped" in found.facts().told["file"]
    # Heights 1, 1, 1, 0.9 at the corners: by either diagonal, 1 - 0.1/6 or 1 - 0.1/3.
    assert found.polyhedra["1"].volume in (
        pytest.approx(1 - 0.1 / 6, rel=1e-12),
        pytest.approx(1 - 0.1 / 3, rel=1e-12),
    )


def test_blocks_that_are_there_twice_are_read_once(tmp_path):
    blocks = {
        "0": mesh(CUBE),
        "1": mesh(shifted(1)),
        "2": mesh(shifted(1)[::-1], [[7 - n for n in f] for f in FACES]),
    }
    found = la.masonry3d.read(saved(tmp_path, network(blocks, {"0"})), friction=FRICTION)
    assert found.names == ("support 0", "1")
    assert any("twice: 2" in note for note in notes_of(found))


def test_slight_overlaps_name_the_tolerance(tmp_path):
    blocks = {"0": mesh(CUBE), "1": mesh(shifted(1 - 3e-4))}
    path = saved(tmp_path, network(blocks, {"0"}))
    with pytest.raises(la.InputError, match=r"0\.0003 m deep.*tolerance above 0\.0003"):
        la.masonry3d.read(path, friction=FRICTION)
    assert la.masonry3d.read(path, friction=FRICTION, tolerance=1e-3).joints.count == 1


GAP = 0.01


def bricks(path, courses, gap=GAP, twice=()):
    """Columns of bricks with mortar gaps on a ground, in metres, drawn as closed lines."""
    drawing = ezdxf.new(units=6)
    space = drawing.modelspace()

    def draw(layer, left, right, bottom, top):
        corners = [(left, bottom), (right, bottom), (right, top), (left, top)]
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})

    draw("ground", -1, 2, -1 - gap, -gap)
    for course in range(courses):
        for _ in range(2 if course in twice else 1):
            draw("brick", 0, 0.2, course * (0.07 + gap), course * (0.07 + gap) + 0.07)
    drawing.saveas(path)
    return path


LAYERS = {"brick": la.masonry.Layer(FRICTION, 2000.0), "ground": la.masonry.Layer(FRICTION, 0.0)}


def test_mortar_gaps_are_reported_and_closed(tmp_path):
    """Closed, the column overturns as a rigid one: half its width by half its height."""
    path = bricks(tmp_path / "column.dxf", 5, twice=(2,))
    apart = la.masonry.read(path, LAYERS)
    assert apart.blocks.joints.count == 0
    assert f"gap={GAP}" in apart.facts().told["gaps"]
    drawn = la.masonry.read(path, LAYERS, gap=GAP)
    assert drawn.blocks.joints.count == 5
    assert len(drawn.repeated) == 1
    assert {"gap", "repeated"} <= set(drawn.facts().told)
    assert "gaps" not in drawn.facts().told
    problem = la.Problem(
        {"column": drawn.blocks},
        drawn.weight("column", (1.0, 0.0)),
        [la.Fix("column", drawn.named("ground"))],
        dead_loads=drawn.weight("column"),
    )
    width, height = 0.2 + GAP, 5 * (0.07 + GAP)
    assert la.solve(problem).load_factor == pytest.approx(min(FRICTION, width / height), rel=1e-5)


def test_a_sliver_is_rejected_before_vertices_are_moved(tmp_path, monkeypatch):
    """Moving them onto edges took a minute and a half on a large drawing with one sliver."""
    path = bricks(tmp_path / "m.dxf", 3)
    drawing = ezdxf.readfile(path)
    sliver = [(1, 1), (1.1, 1), (1.1, 1.00005), (1.05, 1.00003), (1, 1.00002)]
    drawing.modelspace().add_lwpolyline(sliver, close=True, dxfattribs={"layer": "brick"})
    drawing.saveas(path)

    def moved(*_):
        raise AssertionError

    monkeypatch.setattr("lacore.model.bodies.blocks.drawings.outlines.straightened", moved)
    with pytest.raises(la.InputError, match=r"handle \w+.*sliver"):
        la.masonry.read(path, LAYERS, snap=1e-4)
