"""Outlines of blocks in assemblies of compas, read from its JSON as data.

In all versions the mesh of a block is ``{"vertex": {key: {x, y, z}}, "face": {key: [vertices]}}`` .
It is found in

- the nodes of a graph (compas_assembly 0.2 to 0.7), which compas wrapped as "value", later "data";
- the elements of a model (compas_model, compas_dem), to which nodes of its graph refer;
- "blocks", next to a network whose vertices or nodes mark supports (compas_assembly 0.1).

Meshes are plane, or prisms across the plane of the wall.
"""

from collections.abc import Iterator, Set
from typing import Any

import numpy as np
import shapely

from lacore.model.bodies.blocks.drawings.strokes import Drawing, Stroke, refused
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError, is_number

BLOCK, SUPPORT = "block", "support"
# axis across the plane, and the axes to the right and up in it
_PLANES = ((2, (0, 1)), (1, (0, 2)), (0, (1, 2)))
_MOVES = "transformation"
_FLAT = 1e-6  # by the size: compas writes unrounded coordinates


def read_compas(path: str, content: Any, layers: Set[str]) -> Drawing:
    """Return the outlines of the blocks of an assembly, seen along y (x, z), x (y, z), or z.

    The first of these planes is used across which all blocks have one thickness; plane blocks have
    their own plane. The layer of a block is its attribute "layer", else "support" for a support,
    else "block"; its handle is the key of its node.

    Args:
        path: path of the file, for messages.
        content: result of `json`.
        layers: layers of the blocks.

    Raises:
        InputError: no assembly, or blocks that are not plane.
    """
    meshes = meshes_of(path, content)
    across, up = _plane(path, [points for _, _, (points, _) in meshes])
    strokes = []
    for key, layer, (points, faces) in meshes:
        if layer not in layers:
            continue
        near = points[:, across] <= points[:, across].mean()  # all points for a plane mesh
        caps = [shapely.Polygon(points[face][:, up]) for face in faces if near[face].all()]
        outline = shapely.union_all([cap for cap in caps if cap.is_valid])
        if outline.geom_type != "Polygon" or shapely.get_num_interior_rings(outline):
            what = f"layer {layer!r}, handle {key}"
            raise refused(path, what, "its mesh is no prism across the plane", "close its faces")
        ring = shapely.get_coordinates(shapely.get_exterior_ring(outline))[:-1]
        strokes.append(Stroke(layer, key, ring, closed=True))
    return Drawing(tuple(strokes), tuple({layer for _, layer, _ in meshes}), None, {})


def meshes_of(path: str, content: Any) -> list[tuple[str, str, tuple[Floats, list[list[int]]]]]:
    """Return key, layer, and mesh of each block: vertices (k, 3), and faces as their numbers."""
    nodes = _nodes(content)
    if nodes is None:
        raise InputError(
            "path",
            path,
            "neither GeoJSON (by its `type`) nor an assembly of compas (no graph with nodes)",
            "write it by compas.json_dump(assembly, path)",
        )
    meshes = [(key, _layer(node), _mesh(node, path, key)) for key, node in nodes.items()]
    if not meshes:
        raise InputError("path", path, "an assembly without blocks", "add blocks, and write it")
    return meshes


def _nodes(content: Any) -> dict[str, Any] | None:
    """Return the data of each block; models are preferred to graphs, which may repeat them."""
    # The graph of a network has nodes without meshes, which are next to it.
    for kind in (_of_model, _of_network, _of_graph):
        for own in _dictionaries(content):
            found = kind(own)
            if found is not None:
                return found
    return None


def _of_model(own: dict[str, Any]) -> dict[str, Any] | None:
    elements = own.get("elements")
    if not (isinstance(elements, dict | list) and elements and "graph" in own):
        return None
    moved = {_MOVES: own.get(_MOVES)}  # in the model
    named = elements.items() if isinstance(elements, dict) else enumerate(elements)
    return {str(key): [moved, element] for key, element in named}


def _of_graph(own: dict[str, Any]) -> dict[str, Any] | None:
    if isinstance(own.get("node"), dict) and "edge" in own:
        return {str(key): node for key, node in own["node"].items()}
    return None


def _of_network(own: dict[str, Any]) -> dict[str, Any] | None:
    blocks, network = own.get("blocks"), own.get("assembly")
    if not (isinstance(blocks, dict) and isinstance(network, dict)):
        return None
    said = next((network[key] for key in ("vertex", "node") if key in network), None)
    said = said if isinstance(said, dict) else {}
    return {str(key): [mesh, said.get(key)] for key, mesh in blocks.items()}


def _dictionaries(content: Any) -> Iterator[dict[str, Any]]:
    """Yield a dictionary and those in it, outer ones first."""
    waiting = [content]
    while waiting:
        own = waiting.pop(0)
        if isinstance(own, dict):
            yield own
            waiting += own.values()
        elif isinstance(own, list):
            waiting += own


def _layer(node: Any) -> str:
    for own in _dictionaries(node):
        if isinstance(own.get("layer"), str):
            return str(own["layer"])
    support = any(own.get("is_support") is True for own in _dictionaries(node))
    return SUPPORT if support else BLOCK


def _mesh(node: Any, path: str, key: str) -> tuple[Floats, list[list[int]]]:
    """Return the vertices (k, 3), and faces as their numbers."""
    for own in _dictionaries(node):
        if own.get(_MOVES) is not None and not _rests(own[_MOVES]):
            raise refused(
                path,
                f"handle {key}",
                "its element is moved by a transformation, of which only compas knows all",
                "write the blocks where they are: Block.from_mesh(element.modelgeometry)",
            )
        if (mesh := _vertices_and_faces(own.get("vertex"), own.get("face"))) is not None:
            return mesh
    raise refused(path, f"handle {key}", "a node without the mesh of a block", "add its block")


def _vertices_and_faces(vertex: Any, face: Any) -> tuple[Floats, list[list[int]]] | None:
    """Return a mesh from its entries by key; None if they are not a mesh."""
    if not (isinstance(vertex, dict) and isinstance(face, dict) and face):
        return None
    places = [[point.get(axis, 0.0) for axis in "xyz"] for point in vertex.values()]
    number = {name: n for n, name in enumerate(vertex)}
    known = all(str(name) in number for corners in face.values() for name in corners)
    if not (known and all(is_number(value) for place in places for value in place)):
        return None
    faces = [[number[str(name)] for name in corners] for corners in face.values()]
    return np.array(places, dtype=np.float64), faces


def _rests(transformation: Any) -> bool:
    """Return whether a transformation is the identity."""
    for own in _dictionaries(transformation):
        if "matrix" in own:
            return bool(own["matrix"] == np.eye(4).tolist())
    return False


def _plane(path: str, vertices: list[Floats]) -> tuple[int, list[int]]:
    """Return the axis across the plane, and the two axes to the right and up."""
    every = np.concatenate(vertices)
    allowed = _FLAT * float(np.linalg.norm(np.ptp(every, axis=0)))
    for across, axes in _PLANES:
        low, high = every[:, across].min(), every[:, across].max()
        # A wall of constant height is not drawn from above: only blocks without thickness are.
        if across == 2 and high - low > allowed:
            continue
        ends = [np.minimum(own[:, across] - low, high - own[:, across]) for own in vertices]
        through = [np.ptp(own[:, across]) >= high - low - allowed for own in vertices]
        if np.concatenate(ends).max() <= allowed and all(through):
            return across, list(axes)
    raise InputError(
        "path",
        path,
        "its blocks are no prisms between two planes across y, nor across x",
        "turn the wall into the plane of x and z",
    )
