"""Whether a load is locked: reactions that carry it alone, with no strength called on (T13).

``F0 . u <= 0`` for every admissible velocity u if and only if F0 is balanced by normal forces,
forces of points that stick, mean stresses of incompressible bodies, and stresses of soil that may
grow without end, pressed all around (Farkas). Such reactions may
be multiplied by any number: the load factor is +inf. They are looked for by a linear program and
recomputed here; near misses, an incline of 1e-9, are none: what is left must be round-off.
"""

from dataclasses import dataclass
from itertools import product
from math import pi

import numpy as np
from scipy.sparse import csr_matrix, eye_array, hstack, vstack
from scipy.sparse.linalg import lsmr

from lacore.arrays import Floats, Sparse
from lacore.numerics.linear_program import least
from lacore.program import DissipationGroup, FrozenContact, KinematicProgram

_ROUND_OFF = 1e-12  # of all forces on a part: sums of a thousand terms in double precision
_SWEEPS = 2000
_CARRIES = 1e-9  # of the largest multiplier: smaller ones are the linear program's tolerance


@dataclass(frozen=True)
class LockingRay:
    """Reactions that carry the reference load alone, per load factor.

    Attributes:
        residual: largest force that is left, per sum of the sizes of the forces on its part.
        release: power that shifts of contact points allow, as a load factor: it is +inf only where
            this is below 1 per unit of ``F0.u``.
    """

    residual: float
    release: float

    @property
    def proves(self) -> bool:
        """Whether no admissible velocity feels the load; false for NaN."""
        return self.residual <= _ROUND_OFF and self.release < 1 - _CARRIES


def locking_ray(program: KinematicProgram, contact: FrozenContact) -> LockingRay:
    """The reactions that come closest to carrying ``F0`` alone.

    In space of friction that dilates some directions of all: what they prove is proven.
    """
    rows = program.contact
    ways = _ways(contact, rows.tangent_dim)
    sloped = [rows.normal - _along(rows.tangential, contact.dilatancy, way) for way in ways]
    endless = [_endless(group) for group in program.groups if group.surfaces is not None]
    pressing = csr_matrix(vstack([*sloped, *endless]))
    free = csr_matrix(
        vstack(
            [
                rows.tangential[np.repeat(np.isinf(contact.bound), rows.tangent_dim)],
                *(group.volumetric for group in program.groups if group.surfaces is None),
            ]
        )
    )
    load = np.abs(program.reference_load).max()
    multipliers = _carried(pressing, free, -program.reference_load / load)
    if multipliers is None:
        return LockingRay(np.nan, np.nan)
    pressed, _ = np.split(multipliers, [pressing.shape[0]])
    carried = csr_matrix(vstack([pressing, free])).T
    left = np.abs(carried @ multipliers + program.reference_load / load)
    sizes = abs(carried) @ np.abs(multipliers) + np.abs(program.reference_load) / load
    on_part = np.bincount(program.part, weights=sizes)[program.part]
    acting = on_part > 0
    return LockingRay(
        residual=float(np.max(left[acting] / on_part[acting], initial=0.0)),
        release=load * float(pressed[: len(ways) * rows.count] @ np.tile(contact.shift, len(ways))),
    )


def _ways(contact: FrozenContact, dim: int) -> Floats:
    """Directions of slip, shape (k, dim): both in the plane; one in space where none dilates."""
    if dim == 1:
        return np.array([[1.0], [-1.0]])
    return _directions(dim) if np.any(contact.dilatancy) else np.zeros((1, dim))


def _along(tangential: Sparse, dilatancy: Floats, way: Floats) -> Sparse:
    """Dilatancy times slip along a direction, a row a contact point."""
    return csr_matrix(_of_points(dilatancy[:, None] * way, dilatancy.size, way.size) @ tangential)


def _endless(group: DissipationGroup) -> Sparse:
    """Rows that no possible flow makes negative: less the power of stresses that may grow (T48).

    Of shear some directions of all: what they prove is proven.
    """
    assert group.surfaces is not None
    edges, dim, volumes = group.surfaces.edges, group.dim, group.volumes
    count = group.weights.size
    parts = []
    for number in range(edges.shape[1]):
        shear, mean = edges[:, number, 0], edges[:, number, 1:]
        pressed = _of_points(mean, count, volumes) @ group.volumetric
        if not np.any(shear):
            parts.append(-pressed)
            continue
        for direction in _directions(dim):
            along = _of_points(shear[:, None] * direction, count, dim) @ group.rows
            parts.append(-(along + pressed))
    rows = csr_matrix(vstack([csr_matrix((0, group.rows.shape[1])), *parts]))
    return csr_matrix(rows[np.diff(rows.indptr) > 0])


def _of_points(share: Floats, count: int, dim: int) -> Sparse:
    """Sums of the `dim` rows of each point by shares of shape (count, dim): (count, count dim)."""
    starts = dim * np.arange(count + 1)
    return csr_matrix((share.ravel(), np.arange(count * dim), starts), (count, count * dim))


def _directions(dim: int) -> Floats:
    """Unit vectors all around, shape (k, dim): of a plane every 22.5 degrees."""
    if dim == 2:
        angle = np.arange(16) * pi / 8
        return np.stack([np.cos(angle), np.sin(angle)], axis=1)
    corners = np.array(list(product((-1.0, 0.0, 1.0), repeat=dim)))
    length = np.linalg.norm(corners, axis=1)
    return np.asarray(corners[length > 0] / length[length > 0, None])


def _carried(pressing: Sparse, free: Sparse, wanted: Floats) -> Floats | None:
    """Multipliers, of `pressing` >= 0, that leave the least of a load; None where none is found."""
    count, n = pressing.shape
    forces = csr_matrix(vstack([pressing, free])).T
    free_ones = forces.shape[1] - count
    found = least(
        np.concatenate([np.zeros(forces.shape[1]), np.ones(2 * n)]),
        at_most=(csr_matrix((0, forces.shape[1] + 2 * n)), np.zeros(0)),
        equal=(csr_matrix(hstack([forces, eye_array(n), -eye_array(n)])), wanted),
        lower=np.concatenate([np.zeros(count), np.full(free_ones, -np.inf), np.zeros(2 * n)]),
        upper=np.full(forces.shape[1] + 2 * n, np.inf),
    )
    if found is None:
        return None
    multipliers = found[: forces.shape[1]]
    carries = np.abs(multipliers) > _CARRIES * np.abs(multipliers).max(initial=0.0)
    multipliers[~carries] = 0.0
    own = csr_matrix(forces[:, carries])
    rest = wanted - own @ multipliers[carries]
    change = lsmr(own, rest, atol=0.0, btol=0.0, conlim=0.0, maxiter=_SWEEPS)[0]
    multipliers[carries] += change
    multipliers[:count] = np.maximum(multipliers[:count], 0.0)
    return np.asarray(multipliers)
