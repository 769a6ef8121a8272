"""Drawings of walls, written as programs write them: with noise, in any order and direction."""

import json

import ezdxf
import numpy as np

import lacore as la

MM = 1000.0
STONE = la.masonry.Layer(friction=0.65, density=2400)
LAYERS = dict.fromkeys(("stone", "brick", "ground"), STONE)


def facade(wide=10, courses=16):
    """151 blocks around two windows on a base, 0.4 m x 0.175 m, and the windows in m."""
    openings = [la.masonry.Opening(wide // 4 + 0.5, 1.0, 3, 5)]
    openings += [la.masonry.Opening(wide - wide // 4 - 1.5, 1.0, 3, 5)]
    rows = la.masonry.regular_bond(wide, courses, openings)
    windows = [
        la.masonry.rectangle(
            0.4 * own.left,
            0.4 * (own.left + own.width),
            0.175 * own.sill,
            0.175 * (own.sill + own.height),
        )
        for own in openings
    ]
    return la.masonry.running_bond(rows, STONE.friction), windows


def layer_of(name):
    return "ground" if name == "base" else "brick" if name.startswith("c1b") else "stone"


def drawn(blocks, noise=0.0, seed=None):
    """Layers and vertices of polygons, m; with a seed in any order, direction and start."""
    draw = np.random.default_rng(seed)
    polygons = [
        (layer_of(name), ring + draw.uniform(-noise, noise, ring.shape))
        for name, ring in blocks.polygons.items()
    ]
    if seed is None:
        return polygons
    draw.shuffle(polygons)
    turned = [(layer, np.roll(ring, draw.integers(9), axis=0)) for layer, ring in polygons]
    return [(layer, ring[:: draw.choice([-1, 1])]) for layer, ring in turned]


def new_dxf(units=4):
    document = ezdxf.new(units=units)
    return document, document.modelspace()


def dxf(path, polygons, scale=MM, units=4, windows=()):
    """Closed polylines; and what stands in every drawing."""
    document, space = new_dxf(units)
    for number, (layer, ring) in enumerate(polygons):
        add = space.add_lwpolyline if number % 3 else space.add_polyline2d
        add(ring * scale, close=True, dxfattribs={"layer": layer})
    for ring in windows:
        space.add_lwpolyline(ring * scale, close=True, dxfattribs={"layer": "windows"})
    space.add_text("facade, south", dxfattribs={"layer": "stone"})
    space.add_circle((0, 0), scale, dxfattribs={"layer": "trees"})
    document.saveas(path)
    return path


def dxf_of_lines(path, polygons, windows=(), noise=0.0, seed=0):
    """Four lines a block, whose ends meet up to the noise (m), and outlines of the windows."""
    draw = np.random.default_rng(seed)
    document, space = new_dxf()
    for layer, ring in polygons:
        for ends in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            start, end = (MM * (end + draw.uniform(-noise, noise, 2)) for end in ends)
            space.add_line(start, end, dxfattribs={"layer": layer})
    for ring in windows:
        space.add_lwpolyline(ring * MM, close=True, dxfattribs={"layer": "windows"})
    document.saveas(path)
    return path


def geojson(path, polygons):
    features = [
        {
            "type": "Feature",
            "id": f"f{number}",
            "properties": {"layer": layer},
            "geometry": {"type": "Polygon", "coordinates": [[*ring.tolist(), ring[0].tolist()]]},
        }
        for number, (layer, ring) in enumerate(polygons)
    ]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    return path


def compas(path, polygons, wide=0.3, form="data"):
    """Prisms in the plane of x and z, as compas_assembly 0.7 writes them, or by one of FORMS."""
    path.write_text(json.dumps(FORMS[form](_prisms(polygons, wide))))
    return path


def _prisms(polygons, wide):
    """Meshes of blocks as all versions of compas state them, and whether they are supports."""
    for layer, ring in polygons:
        k = len(ring)
        ends = [(x, y, z) for y in (0.0, wide) for x, z in ring.tolist()]
        sides = [[n, (n + 1) % k, (n + 1) % k + k, n + k] for n in range(k)]
        faces = [[*range(k)][::-1], [*range(k, 2 * k)], *sides]
        mesh = {
            "vertex": {str(n): dict(zip("xyz", at, strict=True)) for n, at in enumerate(ends)},
            "face": {str(n): face for n, face in enumerate(faces)},
        }
        yield mesh, layer == "ground"


def _graph(prisms, wrap):
    """Of compas_assembly 0.2 to 0.7: blocks in the nodes of a graph."""
    nodes = {
        str(key): {
            "block": wrap("compas_assembly.datastructures/Block", mesh),
            "is_support": support,
        }
        for key, (mesh, support) in enumerate(prisms)
    }
    return {"node": nodes, "edge": {}, "adjacency": {}}


def _as_data(prisms):
    def wrap(kind, data):
        return {"dtype": kind, "data": data, "guid": "0"}

    graph = wrap("compas.datastructures/Graph", _graph(prisms, wrap))
    data = {"attributes": {"name": "Assembly"}, "graph": graph}
    return wrap("compas_assembly.datastructures/Assembly", data)


def _as_value(prisms):
    def wrap(kind, data):
        return {"dtype": kind, "value": {"data": data, "compas": "0.18.1"}}

    return wrap("compas_assembly.datastructures/Assembly", _graph(prisms, wrap))


def _as_network(prisms):
    blocks, vertices = {}, {}
    for key, (mesh, support) in enumerate(prisms):
        faces = {name: [str(n) for n in face] for name, face in mesh["face"].items()}
        blocks[str(key)] = {"attributes": {"name": "Block"}, **mesh, "face": faces}
        vertices[str(key)] = {"x": 0.0, "y": 0.0, "z": 0.0, "is_support": support}
    return {"assembly": {"attributes": {}, "vertex": vertices, "edge": {}}, "blocks": blocks}


def _as_model(prisms):
    elements = {
        f"guid-{key}": {
            "dtype": "compas_dem.elements/Block",
            "data": {
                "transformation": None,
                "geometry": {"dtype": "compas.datastructures/Mesh", "data": mesh},
                "is_support": support,
            },
        }
        for key, (mesh, support) in enumerate(prisms)
    }
    nodes = {str(key): {"element": guid} for key, guid in enumerate(elements)}
    graph = {"default_node_attributes": {"element": None}, "node": nodes, "edge": {}}
    data = {"transformation": None, "elements": elements, "graph": graph}
    return {"dtype": "compas_dem.models/BlockModel", "data": data}


FORMS = {"data": _as_data, "value": _as_value, "network": _as_network, "model": _as_model}
"""How versions of compas_assembly, compas_model and compas_dem write blocks."""


def pushed(body, weight, push, ground):
    return la.Problem(
        bodies={"wall": body},
        supports=[la.Fix("wall", ground)],
        reference_loads=push,
        dead_loads=weight,
    )
