"""Bodies of tetrahedra for cases: ground under footings, discs, hollow spheres."""

from math import cos, pi, sin

import numpy as np
from skfem import MeshTet, MeshTri

import lacore as la
from lacore.model.materials.criterion import Criterion
from lacore.model.meshes.polygonal import labelled
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.case import Reference

CLAY = la.VonMises(shear_strength=1.0)
WIDTH, DEPTH = 2.6, 1.3  # of the ground around a footing of half-side 1


def on_diagonal(x: Floats) -> Bools:
    """Return the plane of symmetry x = y of a square."""
    return np.asarray(np.abs(x[0] - x[1]) < 1e-9)


def eighth(mesh: MeshTet) -> MeshTet:
    """Return the tetrahedra of a box in which y < x, see `lacore.model.meshes.box`."""
    x, y, _ = mesh.p[:, mesh.t].mean(axis=1)
    kept: MeshTet = mesh.restrict(np.flatnonzero(y < x))
    return kept


def under_footing(x: Floats) -> Bools:
    """Return whether places are under a footing of half-side 1."""
    return np.asarray((x[2] == 0) & (x[0] <= 1))


def slab(
    ground: Criterion, size: tuple[float, float], n: int, rough: bool, space: str
) -> "la.Problem":
    """Return half of a strip footing on ground one cell thick between smooth walls.

    Its length, depth.
    """
    length, depth = size
    mesh = la.meshes.box((0, length), (0, 0.5), (-depth, 0), n + 1, 1, n, False, (1.0, 2.0))
    return la.Problem(
        bodies={"soil": la.Body(mesh, ground, kinematics="3d", space=space)},
        supports=[
            *(la.Fix("soil", side, "normal") for side in ("left", "front", "back")),
            *(la.Fix("soil", side, "xyz") for side in ("right", "bottom")),
        ],
        reference_loads=[la.RigidFooting("soil", under_footing, (0, 0, -1), rough=rough)],
    )


def bounded(low: float, high: float, unit: str, source: str) -> Reference:
    """Return the interval of strict bounds if no closed form is known."""
    return Reference(low, f"{low} {unit} <= alpha <= {high} {unit}", source, "bracket", up_to=high)


def disc(sides: int, rings: int) -> MeshTri:
    """Return a regular polygon, its corners at distance 1, in rings.

    Cut along the rays to its corners and to the middles of its sides.
    """
    count = 2 * sides
    turn = 2 * pi * np.arange(count) / count
    reach = np.where(np.arange(count) % 2 == 0, 1.0, cos(pi / sides))
    rays = reach * np.array([(cos(angle), sin(angle)) for angle in turn]).T
    radius = np.arange(1, rings + 1) / rings
    places = np.concatenate([np.zeros((2, 1)), *(own * rays for own in radius)], axis=1)
    this = np.arange(count)
    following = (this + 1) % count
    parts = [np.stack([np.zeros(count, dtype=np.int64), 1 + this, 1 + following])]
    for ring in range(rings - 1):
        inner, outer = 1 + ring * count, 1 + (ring + 1) * count
        parts += [
            np.stack([inner + this, outer + this, outer + following]),
            np.stack([inner + this, outer + following, inner + following]),
        ]
    return MeshTri(*map(np.ascontiguousarray, (places, np.concatenate(parts, axis=1))))


def hollow_octant(inner: float, outer: float, across: int, through: int) -> MeshTet:
    """Return an eighth of a hollow sphere, ``start`` its bore, ``end`` its skin, others its planes.

    Its triangles stand on rays, those of the face x + y + z = 1 cut evenly. Names of the planes are
    `x`, `y`, `z`, of the axes across them.
    """
    number: dict[tuple[int, int], int] = {}
    for i in range(across + 1):
        for j in range(across + 1 - i):
            number[i, j] = len(number)
    share = np.array([(i, j, across - i - j) for i, j in number]).T / across
    up = [
        (number[i, j], number[i + 1, j], number[i, j + 1])
        for i in range(across)
        for j in range(across - i)
    ]
    down = [
        (number[i + 1, j], number[i + 1, j + 1], number[i, j + 1])
        for i in range(across)
        for j in range(across - 1 - i)
    ]
    plan = MeshTri(*map(np.ascontiguousarray, (share[:2], np.array(up + down).T)))
    flat = la.meshes.extruded(plan, (inner, outer), through, (inner, outer / inner))
    first, second, radius = flat.p
    ray = np.stack([first, second, 1 - first - second])
    ray[np.abs(ray) < 1e-12] = 0.0
    bent = MeshTet(radius * ray / np.linalg.norm(ray, axis=0), flat.t)
    skin = bent.boundary_facets()
    names = dict(flat.boundaries)
    for axis, name in enumerate("xyz"):
        names[name] = skin[np.all(bent.p[axis][bent.facets[:, skin]] == 0.0, axis=0)]
    sphere: MeshTet = labelled(bent.with_boundaries(names), "approximated")
    return sphere
