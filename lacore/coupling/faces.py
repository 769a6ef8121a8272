"""The reactions that are compatible with one mechanism, as a kinematic program (T14b a).

A velocity u fixes the branch of the law at every point and in every cone:

    open, u_n > d ||u_t||:   t_n = 0
    slip, u_t != 0:          t_t = -(m t_n + limit) tau,  tau = u_t/||u_t||,  m = coefficient + d
    rest:                    ||t_t|| <= m t_n + limit
    plastic flow, D u != 0:  s is known, the mean stress is free
    no flow:                 ||s|| <= bound

The stresses and reactions that satisfy these conditions and equilibrium form a convex set, the
face. Its largest load factor is the dual of a kinematic program: open points are dropped, a
slipping point is frictionless with the normal ``N - m tau.T``, a resting point is dilatant with m,
and known stresses are dead loads. The smallest load factor follows from the reference load -F0.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix, diags_array, vstack
from scipy.sparse.linalg import lsmr

from lacore.coupling.constants import (
    FACE_SLACK,
    FASTEST_AT_REST,
    FITTED,
    NEW_MECHANISM,
    SLOWEST,
    SPEED_GAP,
    SPEEDS_AT_REST,
)
from lacore.numerics.arrays import Bools, Floats, Sparse
from lacore.program.kinematic import FrozenContact, KinematicProgram, associated_contact
from lacore.program.reduction import kept_points
from lacore.program.state import ProgramState
from lacore.reporting.showing import Compact
from lacore.solvers.inner.own_unknown import with_own_unknown

_SWEEPS = 500  # most iterations of the least-squares correction of a velocity


@dataclass(frozen=True)
class _Branches:
    """Branch of every contact point and cone."""

    open: Bools
    slip: Bools
    flow: tuple[Bools, ...]

    def same(self, other: "_Branches") -> bool:
        """Whether all branches are the same."""
        mine, its = (self.open, self.slip, *self.flow), (other.open, other.slip, *other.flow)
        return all(np.array_equal(a, b) for a, b in zip(mine, its, strict=True))


@dataclass(frozen=True, repr=False)
class Face(Compact):
    """Kinematic program of the largest load factor of a mechanism.

    Attributes:
        original: Program of the state.
        point: The state.
        program, contact: Program and contact to solve; dilatancy represents all friction.
        slip: Points that slip, shape (m,) as in `original`.
        kept: Points whose reaction is unknown, shape (m,).
        ratio: Ratio m of the law, shape (m,).
        direction: Direction tau of slip, 0 without slip, shape (m, tangent_dim).
        known: Stress of the flowing cones, 0 elsewhere, by group.
    """

    original: KinematicProgram
    point: ProgramState
    program: KinematicProgram
    contact: FrozenContact
    slip: Bools
    kept: Bools
    ratio: Floats
    direction: Floats
    known: tuple[Floats, ...]

    def state(self, dual: ProgramState, load_factor: float) -> ProgramState:
        """Return the mechanism with the stresses and reactions of a solution of the program."""
        return self._completed(dual, load_factor, share=1.0)

    def ray(self, dual: ProgramState, sign: float) -> ProgramState:
        """Return the change of states per load factor, from a solution of `ray_program`."""
        own = replace(dual, stress=dual.stress[:-1], mean_stress=dual.mean_stress[:-1])
        return self._completed(own, sign, share=0.0)

    def _completed(self, dual: ProgramState, load_factor: float, share: float) -> ProgramState:
        rows, slip = self.original.contact, self.slip
        normal, tangential = np.zeros(rows.count), np.zeros((rows.count, rows.tangent_dim))
        normal[self.kept] = np.maximum(dual.normal_reaction, 0.0)
        tangential[self.kept] = dual.tangential_reaction
        bound = self.ratio[slip] * normal[slip] + share * rows.limit[slip]
        tangential[slip] = -bound[:, None] * self.direction[slip]
        stress = zip(dual.stress, self.known, strict=True)
        return ProgramState(
            velocity=self.point.velocity,
            load_factor=load_factor,
            stress=tuple(free + share * known for free, known in stress),
            mean_stress=dual.mean_stress,
            normal_reaction=normal,
            tangential_reaction=tangential,
        )


def faces(program: KinematicProgram, point: ProgramState) -> Iterator[Face]:
    """Yield the faces of a mechanism for thresholds between rest and motion, the likeliest first.

    There are none if strength depends on pressure, because flow does not determine the stress.
    """
    if program.pressure_dependent:
        return
    speeds = _speeds(program, point.velocity)
    known: list[_Branches] = []
    for threshold in [*_gaps(speeds), *SPEEDS_AT_REST]:
        branches = _branches(program, speeds, threshold)
        if not any(branches.same(other) for other in known):
            velocity = _cleaned(program, point.velocity, branches)
            yield _face(program, replace(point, velocity=velocity), branches)
        known.append(branches)


@dataclass(frozen=True)
class _Speeds:
    """Opening beyond dilatancy, slip and strain rates, relative to the largest velocity."""

    opening: Floats
    slip: Floats
    strain: tuple[Floats, ...]


def _speeds(program: KinematicProgram, velocity: Floats) -> _Speeds:
    contact = program.contact
    fastest = float(np.abs(velocity).max()) or 1.0  # of a body at rest all speeds are zero
    slip = np.linalg.norm(contact.slip(velocity), axis=1)
    rates = [np.linalg.norm(g.cone_vectors(velocity), axis=1) for g in program.groups]
    # Strain rates of a rigid mechanism are noise, compared with velocity over body length.
    area = sum(float(group.weights.sum()) for group in program.groups)
    overall = fastest / np.sqrt(area) if area > 0 else 0.0
    strain = max([overall, *(float(rate.max(initial=0.0)) for rate in rates)])
    return _Speeds(
        opening=np.asarray((contact.opening(velocity) - contact.dilatancy * slip) / fastest),
        slip=np.asarray(slip / fastest),
        strain=tuple(np.asarray(rate / strain) for rate in rates),
    )


def _gaps(speeds: _Speeds) -> list[float]:
    """Return thresholds in the middle of the gaps between noise and motion, the widest first."""
    everything = np.concatenate([np.abs(speeds.opening), speeds.slip, *speeds.strain])
    levels = np.sort(np.clip(everything, SLOWEST, FASTEST_AT_REST))
    ratios, middles = levels[1:] / levels[:-1], np.sqrt(levels[1:] * levels[:-1])
    wide = np.flatnonzero(ratios >= SPEED_GAP)
    ordered: list[float] = middles[wide[np.argsort(-ratios[wide], kind="stable")]].tolist()
    return ordered


def _branches(program: KinematicProgram, speeds: _Speeds, threshold: float) -> _Branches:
    return _Branches(
        open=np.asarray(speeds.opening > threshold),
        slip=np.asarray((speeds.slip > threshold) & np.isfinite(program.contact.limit)),
        flow=tuple(np.asarray(strain > threshold) for strain in speeds.strain),
    )


def _cleaned(program: KinematicProgram, velocity: Floats, branches: _Branches) -> Floats:
    """Return the nearest velocity that satisfies its branches up to round-off, if it is close.

    Noise in a velocity enters the certificate times the reactions, and the reactions of an end can
    be much larger than those of the state.
    """
    rows = program.contact
    shut, still = ~branches.open, ~branches.open & ~branches.slip
    along = _along(rows.tangential, _directions(program, velocity, branches))
    vanishing = [
        (rows.normal - diags_array(rows.dilatancy) @ along)[shut],
        rows.tangential[np.repeat(still | np.isinf(rows.limit), rows.tangent_dim)],
        *(group.volumetric for group in program.groups),
        *(
            group.rows[np.repeat(~flow, group.dim)]
            for group, flow in zip(program.groups, branches.flow, strict=True)
        ),
        csr_matrix(program.reference_load[None, :]),
    ]
    matrix = csr_matrix(vstack(vanishing, format="csr"))
    missing = -(matrix @ velocity)
    missing[-1] += 1.0
    change = lsmr(matrix, missing, atol=0.0, btol=FITTED, conlim=0.0, maxiter=_SWEEPS)[0]
    near = np.abs(change).max() <= NEW_MECHANISM * np.abs(velocity).max()
    return np.asarray(velocity + change) if near else velocity


def _directions(program: KinematicProgram, velocity: Floats, branches: _Branches) -> Floats:
    """Return tau of the points that slip, 0 for the others, shape (m, tangent_dim)."""
    slip = branches.slip
    direction = np.where(slip[:, None], program.contact.slip(velocity), 0.0)
    direction /= np.where(slip, np.linalg.norm(direction, axis=1), 1.0)[:, None]
    return direction


def _face(program: KinematicProgram, point: ProgramState, branches: _Branches) -> Face:
    rows, slip, lifted = program.contact, branches.slip, branches.open
    ratio = rows.coefficient + rows.dilatancy
    direction = _directions(program, point.velocity, branches)
    along = _along(rows.tangential, direction)
    dead = program.dead_load - along.T @ (rows.weights * np.where(slip, rows.limit, 0.0))

    groups, known = [], []
    for group, stress, flow in zip(program.groups, point.stress, branches.flow, strict=True):
        fixed = np.where(flow[:, None], stress, 0.0)
        dead -= group.rows.T @ (group.weights[:, None] * fixed).ravel()
        groups.append(replace(group, bound=np.where(flow, FACE_SLACK, 1.0) * group.bound))
        known.append(fixed)

    # An open point may keep a limit of friction; its normal reaction is zero.
    kept = ~lifted | ~(slip | (rows.limit <= 0))
    pressing = diags_array(np.where(lifted, 0.0, 1.0))
    normal = csr_matrix(pressing @ (rows.normal - diags_array(ratio) @ along))
    normal.eliminate_zeros()
    laws = replace(
        rows,
        normal=normal,
        coefficient=np.zeros(rows.count),
        limit=np.where(slip, 0.0, rows.limit),
        dilatancy=np.where(slip | lifted, 0.0, ratio),
    )
    contact = kept_points(laws, kept)
    shift = np.where(lifted[kept], 1.0, 0.0)  # a zero row with an open gap: t_n = 0
    return Face(
        original=program,
        point=point,
        program=replace(program, groups=tuple(groups), contact=contact, dead_load=dead),
        contact=replace(associated_contact(contact), shift=shift),
        slip=slip,
        kept=kept,
        ratio=ratio,
        direction=direction,
        known=tuple(known),
    )


def _along(tangential: Sparse, direction: Floats) -> Sparse:
    """Return the rows ``tau . T`` of the points, shape (m, n)."""
    count, dim = direction.shape
    starts = np.arange(count + 1) * dim
    shape = (count, count * dim)
    pick = csr_matrix((direction.ravel(), np.arange(count * dim), starts), shape)
    return csr_matrix(pick @ tangential)


def ray_program(face: Face, sign: float) -> tuple[KinematicProgram, FrozenContact]:
    """Return the program whose multipliers carry ``sign F0`` alone, in the face's recession cone.

    F0 is its dead load. Its load factor belongs to an additional unknown and is at most 1.
    """
    program, rows = face.program, face.program.contact
    contact = replace(rows, limit=np.where(np.isinf(rows.limit), rows.limit, 0.0))
    groups = (replace(group, bound=np.zeros(group.bound.size)) for group in program.groups)
    unloaded = replace(
        program,
        groups=tuple(groups),
        contact=contact,
        reference_load=np.zeros(program.n),
        dead_load=sign * program.reference_load,
    )
    ray = with_own_unknown(unloaded, "end of a ray", reference=1.0)
    return ray, replace(associated_contact(ray.contact), shift=face.contact.shift)
