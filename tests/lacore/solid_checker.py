"""Bounds of bodies of tetrahedra judged from mesh and nodal velocities, or stresses, alone.

Nothing of lacore is imported. Materials are cones ``sqrt(J2) <= k - a tr(sigma)/3``, a = 0 is von
Mises. Strain rates are linear in an element and jumps at most quadratic on a face, so that what is
asked at the vertices, and of Bernstein control values, holds everywhere; so do stresses.
"""

from dataclasses import dataclass

import numpy as np

LEVEL = 4  # halvings of edges on which the convex dissipation of von Mises is enclosed from above


@dataclass(frozen=True)
class Judged:
    """What a velocity proves.

    Attributes:
        residuals: by name, per unit of velocity (and per length, of strain rates): how far the
            velocity is from one that is admissible, <= round-off.
        dissipation: no less than that of the continuum.
    """

    residuals: dict[str, float]
    dissipation: float


def judged(p, t, velocity, k, a, walls, level=LEVEL):
    """Judge a velocity.

    Args:
        p, t: mesh, (3, n) and (4, elements).
        velocity: at the vertices of elements, and of quadratic ones at the middles of their edges
            01 12 02 03 13 23, (elements, 4 or 10, 3).
        k, a: of the cone.
        walls: ``(where, held, motion)``: masks of the middles of boundary faces, (3, n); what is
            held there, ``normal``, ``all`` or, of von Mises, what is ``along`` the face; velocities
            of what holds at places (3, n).
        level: halvings of edges.
    """
    strain = _strains(p, t, velocity)  # (elements, vertices, 3, 3)
    theta = np.trace(strain, axis1=2, axis2=3)
    corner = p.T[t.T]
    volume = np.abs(np.linalg.det(corner[:, 1:] - corner[:, :1])) / 6
    out = {}
    if a:
        out["flow"] = (a * _size(strain) - theta).max()
        total = k / a * (volume @ theta.mean(axis=1))
    else:
        out["divergence"] = np.abs(theta).max()
        places, share = _vertices_of_parts(4, level)
        total = k * (volume @ (_size(np.einsum("pv,evij->epij", places, strain)) @ share))
    corners, sides = faces_of(t)
    area, normal = normals_of(p, t, corners, sides)
    inner = np.flatnonzero(sides[:, 1] >= 0)
    jump = _controls(t, velocity, corners, inner, sides[inner, 1])
    jump -= _controls(t, velocity, corners, inner, sides[inner, 0])
    out["jumps"], power = _layer(jump, normal[inner], area[inner], k, a, level)
    total += power
    outer = np.flatnonzero(sides[:, 1] < 0)
    middle = p.T[corners[outer]].mean(axis=1).T
    for number, (where, held, motion) in enumerate(walls):
        faces = outer[where(middle)]
        own = _controls(t, velocity, corners, faces, sides[faces, 0])
        ends = p.T[corners[faces]]
        moving = np.stack([motion(ends[:, i].T).T for i in range(3)], axis=1)  # linear in space
        if own.shape[1] == 6:
            pairs = [(moving[:, i] + moving[:, j]) / 2 for i, j in ((0, 1), (1, 2), (0, 2))]
            moving = np.concatenate([moving, np.stack(pairs, axis=1)], axis=1)
        past = moving - own
        if held == "along":
            past -= np.einsum("fcj,fj,fi->fci", past, normal[faces], normal[faces])
        if held != "normal":
            out[f"wall {number}"], power = _layer(past, normal[faces], area[faces], k, a, level)
            total += power
        else:
            out[f"wall {number}"] = np.abs(np.einsum("fcj,fj->fc", past, normal[faces])).max()
    return Judged({name: float(left) for name, left in out.items()}, float(total))


@dataclass(frozen=True)
class Carried:
    """What stresses prove.

    Attributes:
        residuals: by name, Pa, or Pa/m inside: how far they are from equilibrium, and beyond
            strength, <= round-off.
        forces: on what touches the body at each of the boundaries, (3,) each, N.
        torques: the same about the origin, N m.
    """

    residuals: dict[str, float]
    forces: list[np.ndarray]
    torques: list[np.ndarray]


def carried(p, t, stress, k, a, boundaries, force=(0.0, 0.0, 0.0)):
    """Judge stresses at the vertices of elements, (elements, 4, 6), under a uniform body force.

    Args:
        p, t: mesh.
        stress: xx, yy, zz, xy, yz, zx, Pa, tension positive.
        k, a: of the cone.
        boundaries: ``(where, held)``: masks of the middles of boundary faces; what may act there,
            as of `judged`. No other faces carry tractions.
        force: N/m^3.
    """
    sigma = _tensors(stress)
    corner = p.T[t.T]
    whole = np.concatenate([np.ones((*corner.shape[:2], 1)), corner], axis=2)
    gradient = np.linalg.inv(whole)[:, 1:].transpose(0, 2, 1)
    mean = np.trace(sigma, axis1=2, axis2=3) / 3
    shear = np.linalg.norm(sigma - mean[..., None, None] * np.eye(3), axis=(2, 3)) / np.sqrt(2)
    corners, sides = faces_of(t)
    area, normal = normals_of(p, t, corners, sides)

    def traction(faces, side):
        element = sides[faces, side]
        at = np.argmax(t.T[element][:, None] == corners[faces][:, :, None], axis=2)
        return np.einsum("faij,fj->fai", sigma[element[:, None], at], normal[faces])

    inner, outer = (np.flatnonzero(mask) for mask in (sides[:, 1] >= 0, sides[:, 1] < 0))
    out = {
        "inside": np.abs(np.einsum("eaij,eaj->ei", sigma, gradient) + force).max(),
        "jumps": np.abs(traction(inner, 0) - traction(inner, 1)).max(),
        "strength": (shear + a * mean).max() - k,
    }
    middle, pulled = p.T[corners[outer]].mean(axis=1).T, traction(outer, 0)
    across = np.einsum("fai,fi,fj->faj", pulled, normal[outer], normal[outer])
    free = np.ones(outer.size, dtype=bool)
    # A linear traction times a place that is linear, over a triangle.
    products = (np.ones((3, 3)) + np.eye(3)) / 12
    forces, torques = [], []
    for number, (where, held) in enumerate(boundaries):
        mine = where(middle)
        free &= ~mine
        left = {"normal": pulled - across, "all": np.zeros((1, 1)), "along": across}[held]
        out[f"boundary {number}"] = np.abs(left[mine] if held != "all" else left).max(initial=0.0)
        own, size = pulled[mine], area[outer][mine]
        forces.append(np.einsum("f,fai->i", size / 3, own))
        places = p.T[corners[outer[mine]]]
        arms = np.cross(places[:, :, None], own[:, None])
        torques.append(np.einsum("f,fabi,ab->i", size, arms, products))
    out["free"] = np.abs(pulled[free]).max(initial=0.0)
    return Carried({name: float(left) for name, left in out.items()}, forces, torques)


def _tensors(stress):
    xx, yy, zz, xy, yz, zx = np.moveaxis(stress, -1, 0)
    rows = ((xx, xy, zx), (xy, yy, yz), (zx, yz, zz))
    return np.stack([np.stack(row, -1) for row in rows], -2)


def faces_of(t):
    """Vertices (faces, 3) and the elements on both sides (faces, 2), -1 for none."""
    local = np.array([(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)])
    every = np.sort(t.T[:, local].reshape(-1, 3), axis=1)
    corners, first, face, count = np.unique(
        every, axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    owner = np.repeat(np.arange(t.shape[1]), 4)
    sides = np.full((len(corners), 2), -1)
    sides[:, 0] = owner[first]
    last = np.zeros(len(corners), dtype=int)
    last[face.ravel()] = owner
    sides[count == 2, 1] = last[count == 2]
    return corners, sides


def normals_of(p, t, corners, sides):
    """Areas and unit normals out of the first element."""
    a, b, c = p.T[corners].transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    middle = p.T[t.T[sides[:, 0]]].mean(axis=1)
    normal *= np.sign(np.sum(normal * (a - middle), axis=1))[:, None]
    return size / 2, normal / size[:, None]


def _size(strain):
    """``sqrt(2)`` times the norm of the deviator: what k costs."""
    mean = np.trace(strain, axis1=-2, axis2=-1)[..., None, None] / 3
    return np.sqrt(2) * np.linalg.norm(strain - mean * np.eye(3), axis=(-2, -1))


def _layer(jump, normal, area, k, a, level):
    """How far jumps at control values (f, c, 3) are from possible, and what they cost.

    A layer strains by ``sym(n u)``, for which ``tr >= a sqrt(2) ||e||`` is
    ``u_n >= a/sqrt(1 - 4 a^2/3) |u_t|``.
    """
    across = np.einsum("fcj,fj->fc", jump, normal)
    along = jump - across[..., None] * normal[:, None]
    if a:
        strain = (jump[..., :, None] * normal[:, None, None, :]) / 2
        strain = strain + strain.swapaxes(-1, -2)
        wrong = a * _size(strain) - across
        return wrong.max(initial=-np.inf), k / a * (area @ across.mean(axis=1))
    places, share = _controls_of_parts(jump.shape[1], level)
    slip = np.linalg.norm(np.einsum("pc,fcj->fpj", places, along), axis=2)
    return np.abs(across).max(initial=0.0), k * (area @ (slip @ share))


def _strains(p, t, velocity):
    """Strain rates at the vertices of elements."""
    corner = p.T[t.T]
    whole = np.concatenate([np.ones((*corner.shape[:2], 1)), corner], axis=2)
    gradient = np.linalg.inv(whole)[:, 1:].transpose(0, 2, 1)  # of barycentric coordinates
    at = np.zeros((len(corner), 4, 3, 3))
    for vertex in range(4):
        slopes = np.zeros((velocity.shape[1], 4))  # of shape functions per coordinate
        if velocity.shape[1] == 4:
            slopes = np.eye(4)
        else:
            for i in range(4):
                slopes[i, i] = 4 * (i == vertex) - 1
            for row, (i, j) in enumerate(((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)), start=4):
                slopes[row, i], slopes[row, j] = 4 * (j == vertex), 4 * (i == vertex)
        at[:, vertex] = np.einsum("eni,nb,ebj->eij", velocity, slopes, gradient)
    return (at + at.swapaxes(2, 3)) / 2


def _controls(t, velocity, corners, faces, elements):
    """Bernstein control values on faces from one side: corners, then sides 01, 12, 02."""
    at = np.argmax(t.T[elements][:, None] == corners[faces][:, :, None], axis=2)
    row = np.arange(len(faces))
    ends = [velocity[elements, at[:, i]] for i in range(3)]
    if velocity.shape[1] == 4:
        return np.stack(ends, axis=1)
    number = np.zeros((4, 4), dtype=int)
    for edge, (i, j) in enumerate(((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)), start=4):
        number[i, j] = number[j, i] = edge
    for i, j in ((0, 1), (1, 2), (0, 2)):
        middle = velocity[elements, number[at[row, i], at[row, j]]]
        ends.append(2 * middle - (ends[i] + ends[j]) / 2)
    return np.stack(ends, axis=1)


def _parts(corners, level):
    """Simplices of equal size by halving edges, (parts, corners, corners), barycentric."""
    parts = np.eye(corners)[None]
    children = {
        3: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
        4: (
            *((0, 4, 6, 7), (4, 1, 5, 8), (6, 5, 2, 9), (7, 8, 9, 3)),
            *((4, 9, 5, 6), (4, 9, 6, 7), (4, 9, 7, 8), (4, 9, 8, 5)),  # around a diagonal
        ),
    }[corners]
    for _ in range(level):
        middles = [(parts[:, i] + parts[:, j]) / 2 for i, j in _PAIRS[corners]]
        nodes = np.concatenate([parts, np.stack(middles, axis=1)], axis=1)
        parts = nodes[:, np.array(children)].reshape(-1, corners, corners)
    return parts


_PAIRS = {3: ((0, 1), (1, 2), (0, 2)), 4: ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))}


def _alike(rows):
    """Rows that differ, and the share of each."""
    same, count = np.unique(np.round(rows, 12), axis=0, return_counts=True)
    return same, count / count.sum()


def _vertices_of_parts(corners, level):
    """Of what is convex of something linear, the mean over these is above the integral."""
    return _alike(_parts(corners, level).reshape(-1, corners))


def _controls_of_parts(controls, level):
    """Control values of parts of a face from its own: the same of something quadratic."""
    if controls == 3:
        return _vertices_of_parts(3, level)
    parts = _parts(3, level)

    def value(place):
        mixed = [2 * place[:, i] * place[:, j] for i, j in _PAIRS[3]]
        return np.concatenate([place**2, np.stack(mixed, axis=1)], axis=1)

    rows = [value(parts[:, i]) for i in range(3)]
    for i, j in _PAIRS[3]:
        middle = value((parts[:, i] + parts[:, j]) / 2)
        rows.append(2 * middle - (value(parts[:, i]) + value(parts[:, j])) / 2)
    return _alike(np.concatenate(rows))
