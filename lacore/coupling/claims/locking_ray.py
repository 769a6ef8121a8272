"""Prove that a load is locked, by reactions that carry it without using any strength (T13).

``F0 . u <= 0`` holds for every admissible velocity u if and only if F0 is balanced by normal
forces, forces of points that stick, mean stresses of incompressible bodies, and stresses of soil
that may grow without bound under pressure (Farkas). Such reactions may be multiplied by any number,
so the load factor is +inf. A conic program, or a linear one, finds them, and their residuals are
recomputed here. They must be round-off, because reactions on an incline of 1e-9 prove nothing.
"""

from dataclasses import dataclass, replace
from itertools import product
from math import pi

import numpy as np
from scipy.sparse import csr_matrix, eye_array, hstack, vstack
from scipy.sparse.linalg import lsmr

from lacore.coupling.claims.dead_loads import prove_dead_loads
from lacore.coupling.constants import CARRYING, RAY_ROUND_OFF, RAY_TOLERANCE
from lacore.numerics.arrays import Floats, Sparse
from lacore.numerics.linear_program import least
from lacore.program.certificate import Certificate
from lacore.program.kinematic import DissipationGroup, FrozenContact, KinematicProgram
from lacore.program.projection import alike, onto_equilibrium
from lacore.program.state import ProgramState, out_of_balance
from lacore.reporting.showing import Compact
from lacore.solvers.inner.preparing import preparer_named
from lacore.solvers.registry import PROVING_BACKEND

_SWEEPS = 2000


@dataclass(frozen=True, repr=False)
class LockingRay(Compact):
    """Proof that a load is locked: stresses and reactions that carry any multiple of it (T13).

    Attributes:
        residual: Largest unbalanced nodal force of the reference load, without dead loads, relative
            to the sum of the sizes of the forces on its part.
        beyond: Largest violation of the cones of friction and dilation without any strength, as in
            `Certificate.yield_violation` and `Certificate.cone`.
        release: Power that shifts of contact points allow, as a load factor. The load factor is
            +inf only if this is below 1 per unit of ``F0.u``.
        point: Stresses and reactions at the load factor 1, Pa, with zero velocity.
            ``dataclasses.replace(state, point=state.ray.point)`` shows them in `effective_stress`
            and `reactions`, for a lower bound as well.
    """

    residual: float
    beyond: float
    release: float
    point: ProgramState

    @property
    def proves(self) -> bool:
        """Whether the load has no power at any admissible velocity; false for NaN."""
        inside = self.residual <= RAY_ROUND_OFF and self.beyond <= RAY_ROUND_OFF
        return inside and self.release < 1 - CARRYING

    def __str__(self) -> str:
        return (
            f"out of balance {self.residual:.1e}, beyond strength {self.beyond:.1e}: stresses and"
            " reactions that grow without bound carry the load"
        )


def locking_ray(program: KinematicProgram, contact: FrozenContact) -> LockingRay | None:
    """Return the reactions that come closest to carrying ``F0`` alone; None if none are found.

    A conic program whose solutions are inside the cones comes first. Its reactions are moved onto
    exact equilibrium, the less the closer they are to the tip of a cone. Reactions on the surface
    of a cone would leave it; a linear program finds these along edges of the cones.
    """
    ray = _from_cones(program, contact)
    if ray is None or not ray.proves:
        ray = _from_edges(program, contact) or ray
    return ray


def _from_cones(program: KinematicProgram, contact: FrozenContact) -> LockingRay | None:
    """Return reactions inside their cones, moved onto exact equilibrium."""
    load = float(np.abs(program.reference_load).max())
    bare = _bare(program, contact, load)
    cones = replace(contact, bound=bare.contact.limit, shift=np.zeros_like(contact.shift))
    prepare = preparer_named(PROVING_BACKEND, {})
    resting = replace(bare, dead_load=bare.reference_load)
    proof = prove_dead_loads(resting, cones, prepare, RAY_TOLERANCE)
    found = proof.equilibrium or proof.mechanism
    if found is None:
        return None
    point = replace(found, velocity=np.zeros(program.n), load_factor=1.0)
    if proof.equilibrium is not None:
        with onto_equilibrium(bare, point, alike) as balance:
            point = balance(point)
    point = point.scaled(load / point.load_factor)
    return _judged(program, contact, replace(point, load_factor=1.0), _sizes(program, point))


def _bare(program: KinematicProgram, contact: FrozenContact, load: float) -> KinematicProgram:
    """Return the program without strengths and dead loads, in units of its load.

    The contact keeps friction and sticking as in `contact`.
    """
    rows = program.contact
    return replace(
        program,
        groups=tuple(group.times(0.0) for group in program.groups),
        contact=replace(
            rows,
            coefficient=np.where(contact.dilatancy > 0, rows.coefficient, 0.0),
            limit=np.where(np.isinf(contact.bound), np.inf, 0.0),
            dilatancy=contact.dilatancy,
            tension=None,
        ),
        reference_load=program.reference_load / load,
        dead_load=np.zeros(program.n),
    )


def _sizes(program: KinematicProgram, point: ProgramState) -> Floats:
    """Return the sum of the sizes of the forces on each unknown, shape (n,)."""
    rows = program.contact
    normal, tangential = rows.sizes
    sizes = np.abs(program.reference_load) + normal @ np.abs(rows.weights * point.normal_reaction)
    sizes += tangential @ np.abs(rows.weights[:, None] * point.tangential_reaction).ravel()
    for group, stress, mean in zip(program.groups, point.stress, point.mean_stress, strict=True):
        sizes += abs(group.rows).T @ np.abs(group.weights[:, None] * stress).ravel()
        sizes += abs(group.volumetric).T @ np.abs(group.volume_weights * mean)
    return np.asarray(sizes)


def _from_edges(program: KinematicProgram, contact: FrozenContact) -> LockingRay | None:
    """Return the reactions of a linear program along the edges of all cones.

    For dilatant friction in three dimensions and for the shear of soil some directions represent
    all, which is safe: the reactions found are admissible.
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
    """Return a ray with recomputed residuals; `sizes` of the forces on each unknown, shape (n,)."""
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
    """Return directions of slip, shape (k, dim): both in two dimensions; one if none dilates."""
    if dim == 1:
        return np.array([[1.0], [-1.0]])
    return _directions(dim) if np.any(contact.dilatancy) else np.zeros((1, dim))


@dataclass(frozen=True)
class _Endless:
    """Stresses of a group that may grow without bound, one per row.

    Attributes:
        rows: Negative power of the stresses, shape (k, n), which is >= 0 for all possible flow.
        shear, mean: Stresses times weights, shapes (k, m dim) and (k, m L).
    """

    rows: Sparse
    shear: Sparse
    mean: Sparse


def _endless(group: DissipationGroup) -> _Endless:
    """Return the stresses along the edges of yield surfaces (T48); none for incompressible groups.

    Some directions of shear represent all, which is safe: the stresses are admissible.
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
    """Return the matrix that sums `dim` rows of each point by shares, shape (count, count dim)."""
    starts = dim * np.arange(count + 1)
    return csr_matrix((share.ravel(), np.arange(count * dim), starts), (count, count * dim))


def _directions(dim: int) -> Floats:
    """Return unit vectors in all directions, shape (k, dim); in a plane every 22.5 degrees."""
    if dim == 2:
        angle = np.arange(16) * pi / 8
        return np.stack([np.cos(angle), np.sin(angle)], axis=1)
    corners = np.array(list(product((-1.0, 0.0, 1.0), repeat=dim)))
    length = np.linalg.norm(corners, axis=1)
    return np.asarray(corners[length > 0] / length[length > 0, None])


def _carried(pressing: Sparse, free: Sparse, wanted: Floats) -> Floats | None:
    """Return multipliers, >= 0 for `pressing`, with the least residual; None if none are found."""
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
    carries = np.abs(multipliers) > CARRYING * np.abs(multipliers).max(initial=0.0)
    multipliers[~carries] = 0.0
    own = csr_matrix(forces[:, carries])
    rest = wanted - own @ multipliers[carries]
    change = lsmr(own, rest, atol=0.0, btol=0.0, conlim=0.0, maxiter=_SWEEPS)[0]
    multipliers[carries] += change
    multipliers[:count] = np.maximum(multipliers[:count], 0.0)
    return np.asarray(multipliers)
