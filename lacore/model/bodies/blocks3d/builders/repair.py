"""Repair of surfaces from files: warped faces, repeated blocks, and open ground faces."""

from collections import Counter
from collections.abc import Mapping

import numpy as np
import shapely

from lacore.model.bodies.blocks3d.surface import axes_of
from lacore.numerics.arrays import Floats
from lacore.reporting.showing import counted, listed

Mesh = tuple[Floats, list[list[int]]]
"""Vertices, (n, 3), m, and the numbers of the vertices of each polygon."""
_TOUCHED = 1e-3  # by the area of a face: overlap with another one at which it touches it
_SLAB = 0.1  # by the width of a ground face: thickness of the slab in its place


def repaired(meshes: Mapping[str, Mesh], tolerance: float) -> tuple[dict[str, Mesh], list[str]]:
    """Return the blocks of a file as closed surfaces of plane faces, and notes on the changes.

    Args:
        meshes: surfaces by name.
        tolerance: m: distance up to which places are one.
    """
    once, twice = _once(meshes, tolerance)
    found, warped, ground = {}, 0, []
    for name, (points, faces) in once.items():
        others = [own for other, (own, _) in once.items() if other != name]
        if (slab := _slab(points, faces, others, tolerance)) is not None:
            ground.append(name)
            found[name if name.startswith("support ") else f"support {name}"] = slab
            continue
        rings = [ring for other, own in once.items() if other != name for ring in _rings(own)]
        plane = [_plane(points, face, rings, tolerance) for face in faces]
        warped += sum(len(parts) > 1 for parts in plane)
        found[name] = points, [part for parts in plane for part in parts]
    notes = []
    if twice:
        notes.append(f"read once, though there twice: {listed(twice)}")
    if warped:
        notes.append(f"{counted(warped, 'warped face')} cut into triangles")
    if ground:
        notes.append(f"open faces taken as fixed ground: {listed(ground)}")
    return found, notes


def _once(meshes: Mapping[str, Mesh], tolerance: float) -> tuple[dict[str, Mesh], list[str]]:
    """Return the surfaces without later ones at the same vertices, and the names of these."""
    kept: dict[str, Mesh] = {}
    seen: dict[bytes, str] = {}
    twice = []
    for name, (points, faces) in meshes.items():
        rounded = np.unique(np.round(points / (2 * tolerance)), axis=0) + 0.0
        if seen.setdefault(rounded.tobytes(), name) == name:
            kept[name] = points, faces
        else:
            twice.append(name)
    return kept, twice


def _normal(points: Floats) -> Floats:
    """Return the unit normal of a polygon by its area vector, or 0 without area."""
    vector = np.cross(points - points[0], np.roll(points, -1, axis=0) - points[0]).sum(axis=0)
    length = np.linalg.norm(vector)
    return np.asarray(vector / length if length > 0 else vector)


def _rings(mesh: Mesh) -> list[Floats]:
    points, faces = mesh
    return [points[face] for face in faces]


def _plane(
    points: Floats, face: list[int], others: list[Floats], tolerance: float
) -> list[list[int]]:
    """Return the polygon, or triangles if it is warped more than `tolerance` and touches nothing.

    Polyhedra reject other warped polygons with their place.
    """
    own = points[face]
    normal, middle = _normal(own), own.mean(axis=0)
    off = np.abs((own - middle) @ normal).max()
    if len(face) < 4 or off <= tolerance or not normal.any():
        return [face]
    axes = np.concatenate(axes_of(normal[:, None]), axis=1)
    flat = own @ axes
    polygon = shapely.Polygon(flat)
    near = [ring for ring in others if np.abs((ring - middle) @ normal).max() <= 3 * off]
    touched = any(
        shapely.Polygon(ring @ axes).convex_hull.intersection(polygon.convex_hull).area
        > _TOUCHED * polygon.area
        for ring in near
    )
    if touched or not polygon.is_valid:
        return [face]
    number = {tuple(place): face[n] for n, place in enumerate(flat.tolist())}
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(polygon))
    rings = (shapely.get_coordinates(own)[:3].tolist() for own in triangles)
    return [[number[tuple(corner)] for corner in ring] for ring in rings]


def _slab(
    points: Floats, faces: list[list[int]], others: list[Floats], tolerance: float
) -> Mesh | None:
    """Return the slab below an open plane surface; None for any other, or with blocks below it."""
    sides = [pair for face in faces for pair in zip(face, face[1:] + face[:1], strict=True)]
    count = Counter(frozenset(side) for side in sides)
    rim = [side for side in sides if count[frozenset(side)] == 1]
    normal = _normal(points[faces[0]])
    height = (points - points[faces[0][0]]) @ normal
    if not rim or not others or np.abs(height).max() > tolerance:
        return None
    above = (np.concatenate(others) - points[faces[0][0]]) @ normal
    if above.min() < -tolerance < tolerance < above.max():
        return None
    thickness = _SLAB * float(np.linalg.norm(np.ptp(points, axis=0)))
    down = -np.sign(above[np.argmax(np.abs(above))]) * thickness * normal
    shift = len(points)
    lower = [[n + shift for n in reversed(face)] for face in faces]
    walls = [[a, b, b + shift, a + shift] for a, b in rim]
    return np.concatenate([points, points + down]), [*faces, *lower, *walls]
