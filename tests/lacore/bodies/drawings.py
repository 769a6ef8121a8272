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


def compas(path, polygons, wide=0.3):
    """Prisms in the plane of x and z, as compas_assembly writes them."""
    nodes = {}
    for key, (layer, ring) in enumerate(polygons):
        k = len(ring)
        ends = [(x, y, z) for y in (0.0, wide) for x, z in ring.tolist()]
        sides = [[n, (n + 1) % k, (n + 1) % k + k, n + k] for n in range(k)]
        faces = [[*range(k)][::-1], [*range(k, 2 * k)], *sides]
        mesh = {
            "vertex": {str(n): dict(zip("xyz", at, strict=True)) for n, at in enumerate(ends)},
            "face": {str(n): face for n, face in enumerate(faces)},
        }
        block = {"dtype": "compas_assembly.datastructures/Block", "data": mesh}
        nodes[str(key)] = {"block": block, "is_support": layer == "ground"}
    graph = {"dtype": "compas.datastructures/Graph", "data": {"node": nodes, "edge": {}}}
    data = {"attributes": {"name": "Assembly"}, "graph": graph}
    path.write_text(json.dumps({"dtype": "compas_assembly.datastructures/Assembly", "data": data}))
    return path


def pushed(body, weight, push, ground):
    return la.Problem(
        bodies={"wall": body},
        supports=[la.Fix("wall", ground)],
        reference_loads=push,
        dead_loads=weight,
    )
