"""Whether a load is locked: reactions that carry it alone, with no strength called on (T13).

``F0 . u <= 0`` for every admissible velocity u if and only if F0 is balanced by normal forces,
forces of points that stick, mean stresses of incompressible bodies, and stresses of soil that may
grow without end, pressed all around (Farkas). Such reactions may
be multiplied by any number: the load factor is +inf. They are looked for by a linear program and
recomputed here; near misses, an incline of 1e-9, are none: what is left must be round-off.
"""

from dataclasses import dataclass, replace
from itertools import product
from math import pi

import numpy as np
from scipy.sparse import csr_matrix, eye_array, hstack, vstack
from scipy.sparse.linalg import lsmr

from lacore.numerics.arrays import Floats, Sparse
from lacore.numerics.linear_program import least
from lacore.program.certificate import Certificate
from lacore.program.kinematic import DissipationGroup, FrozenContact, KinematicProgram
from lacore.program.state import ProgramState, out_of_balance
from lacore.reporting.showing import Compact

_ROUND_OFF = 1e-12  # of all forces on a part: sums of a thousand terms in double precision
_SWEEPS = 2000
_CARRIES = 1e-9  # of the largest multiplier: smaller ones are the linear program's tolerance


@dataclass(frozen=True, repr=False)
class LockingRay(Compact):
    """Why a load is locked: stresses and reactions that carry it alone, times any number (T13).

    Attributes:
        residual: largest nodal force that they leave of the reference load, without dead loads, per
            sum of the sizes of the forces on its part.
        beyond: largest share by which they exceed what may grow without end: cones of friction and
            of dilation without any strength, as `Certificate.yield_violation` and `.cone`.
        release: power that shifts of contact points allow, as a load factor: it is +inf only where
            this is below 1 per unit of ``F0.u``.
        point: the stresses and reactions at the load factor 1, Pa, where none moves. With
            ``dataclasses.replace(state, point=state.ray.point)`` `effective_stress` and `reactions`
            show them as those of any state; of a lower bound, too.
    """

    residual: float
    beyond: float
    release: float
    point: ProgramState

    @property
    def proves(self) -> bool:
        """Whether no admissible velocity feels the load; false for NaN."""
        inside = self.residual <= _ROUND_OFF and self.beyond <= _ROUND_OFF
        return inside and self.release < 1 - _CARRIES

    def __str__(self) -> str:
        return (
            f"out of balance {self.residual:.1e}, beyond strength {self.beyond:.1e}: stresses and"
            " reactions that grow without bound carry the load"
        )


def locking_ray(program: KinematicProgram, contact: FrozenContact) -> LockingRay | None:
    """The reactions that come closest to carrying ``F0`` alone; None where none are found.

    In space of friction that dilates some directions of all: what they prove is proven.
    """
    rows = program.contact
    ways = _ways(contact, rows.tangent_dim)
    leaning = [_of_points(contact.dilatancy[:, None] * way, rows.count, way.size) for way in ways]
    sloped = [rows.normal - along @ rows.tangential for along in leaning]
    endless = [_endless(group) for group in program.groups]
    pressing = csr_matrix(vstack([*sloped, *(own.rows for own in endless)]))
    sticks = np.repeat(np.isinf(contact.bound), rows.tangent_dim)
    keeping = [group.volumetric for group in program.groups if group.surfaces is None]
    free = csr_matrix(vstack([rows.tangential[sticks], *keeping]))
    load = np.abs(program.reference_load).max()
    multipliers = _carried(pressing, free, -program.reference_load / load)
    if multipliers is None:
        return None
    sizes = abs(csr_matrix(vstack([pressing, free])).T) @ np.abs(multipliers)
    sizes = load * sizes + np.abs(program.reference_load)
    multipliers *= load
    counts = [len(ways) * rows.count, *(own.rows.shape[0] for own in endless), int(sticks.sum())]
    counts += [own.shape[0] for own in keeping]
    pressed, *others = np.split(multipliers, np.cumsum(counts)[:-1])
    grown, stuck, kept = others[: len(endless)], others[len(endless)], others[len(endless) + 1 :]
    normal = pressed.reshape(len(ways), rows.count)
    tangential = np.zeros(sticks.size)
    tangential[sticks] = stuck
    for along, own in zip(leaning, normal, strict=True):
        tangential -= along.T @ own
    means = iter(kept)
    stresses = [
        (
            (own.shear.T @ by).reshape(-1, group.dim) / group.weights[:, None],
            (-next(means) if group.surfaces is None else own.mean.T @ by) / group.volume_weights,
        )
        for group, own, by in zip(program.groups, endless, grown, strict=True)
    ]
    return _judged(
        program,
        contact,
        ProgramState(
            velocity=np.zeros(program.n),
            load_factor=1.0,
            stress=tuple(stress for stress, _ in stresses),
            mean_stress=tuple(mean for _, mean in stresses),
            normal_reaction=normal.sum(axis=0) / rows.weights,
            tangential_reaction=tangential.reshape(-1, rows.tangent_dim) / rows.weights[:, None],
        ),
        sizes,
    )


def _judged(
    program: KinematicProgram, contact: FrozenContact, point: ProgramState, sizes: Floats
) -> LockingRay:
    """The ray with its residuals, recomputed; sizes of the forces on each unknown, shape (n,)."""
    bare = replace(
        program,
        groups=tuple(group.times(0.0) for group in program.groups),
        dead_load=np.zeros(program.n),
    )
    cones = replace(contact, bound=np.where(np.isinf(contact.bound), np.inf, 0.0))
    seen = Certificate.of(bare, point, cones)
    on_part = np.bincount(program.part, weights=sizes)[program.part]
    left = np.abs(out_of_balance(bare, point)) / np.where(on_part > 0, on_part, 1.0)
    pressed = program.contact.weights * point.normal_reaction
    return LockingRay(
        residual=float(left.max()),
        beyond=float(np.max([seen.yield_violation, seen.cone])),
        release=float(pressed @ contact.shift),
        point=point,
    )


def _ways(contact: FrozenContact, dim: int) -> Floats:
    """Directions of slip, shape (k, dim): both in the plane; one in space where none dilates."""
    if dim == 1:
        return np.array([[1.0], [-1.0]])
    return _directions(dim) if np.any(contact.dilatancy) else np.zeros((1, dim))


@dataclass(frozen=True)
class _Endless:
    """Stresses of a group that may grow without end, a row each.

    Attributes:
        rows: less their power, shape (k, n): no possible flow makes it negative.
        shear, mean: the stresses times weights, shapes (k, m dim) and (k, m L).
    """

    rows: Sparse
    shear: Sparse
    mean: Sparse


def _endless(group: DissipationGroup) -> _Endless:
    """Along the edges of surfaces (T48); none of what keeps its volume.

    Of shear some directions of all: what they prove is proven.
    """
    dim, volumes, count = group.dim, group.volumes, group.weights.size
    shears = [csr_matrix((0, count * dim))]
    means = [csr_matrix((0, count * volumes))]
    edges = () if group.surfaces is None else tuple(np.moveaxis(group.surfaces.edges, 1, 0))
    for edge in edges:
        shear, mean = edge[:, 0], edge[:, 1:]
        for direction in _directions(dim) if np.any(shear) else np.zeros((1, dim)):
            shears.append(_of_points(shear[:, None] * direction, count, dim))
            means.append(_of_points(mean, count, volumes))
    along, pressed = csr_matrix(vstack(shears)), csr_matrix(vstack(means))
    rows = csr_matrix(-(along @ group.rows + pressed @ group.volumetric))
    moved = np.diff(rows.indptr) > 0
    return _Endless(rows[moved], along[moved], pressed[moved])


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
