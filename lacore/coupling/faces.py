"""The reactions that one mechanism leaves free, as a kinematic program (T14b a).

A velocity u fixes the branch of the law at every point and in every cone:

    open, u_n > d ||u_t||:   t_n = 0
    slip, u_t != 0:          t_t = -(m t_n + limit) tau,  tau = u_t/||u_t||,  m = coefficient + d
    rest:                    ||t_t|| <= m t_n + limit
    plastic flow, D u != 0:  s is known, the mean stress is free
    no flow:                 ||s|| <= bound

What obeys these and equilibrium is convex: the face. The program of its largest load factor is the
dual of a kinematic program: open points are dropped, a slipping one is smooth with the normal
``N - m tau.T``, a resting one is dilatant with m, known stresses are dead load. The smallest load
factor is that of the reference load -F0.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix, diags_array, vstack
from scipy.sparse.linalg import lsmr

from lacore.numerics.arrays import Bools, Floats, Sparse
from lacore.program.kinematic import FrozenContact, KinematicProgram, associated_contact
from lacore.program.reduction import kept_points
from lacore.program.state import ProgramState
from lacore.reporting.showing import Compact
from lacore.solvers.inner.own_unknown import with_own_unknown

# Between rest and motion, of the fastest. Velocities of interior-point methods carry noise of 1e-9
# and more. A point that moves and is called at rest makes the face too large, which the certificate
# of its ends refutes; one at rest that is called moving makes it too small, which nothing shows.
# So the widest gap among the velocities comes first, then large thresholds before small ones.
_NOISE, _SLOW = 1e-10, 1e-2
_GAP = 10.0  # ratio of neighbouring velocities; narrower gaps say nothing
_THRESHOLDS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
# Of the stress bound, for cones that flow: the stress of the state is known to some 1e-10 only, and
# without slack no other stress would be in equilibrium with it. It widens the face by as little.
_SLACK = 1e-8
_NOISY = 1e-6  # of the fastest: a larger change of a velocity makes another mechanism of it
_ROUND_OFF = 1e-9  # what is left of the noise
_SWEEPS = 500  # of the least-squares iteration


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
    """Kinematic program of the largest load factor of a mechanism, and the way back.

    Attributes:
        original: the program of the state.
        point: the state.
        program, contact: what to solve; all friction is in its dilatancy.
        slip: points that slip, shape (m,) as in `original`.
        kept: points that may carry a reaction that is not known beforehand, shape (m,).
        ratio: m of the law, shape (m,).
        direction: tau, 0 where nothing slips, shape (m, tangent_dim).
        known: stress of the flowing cones, 0 elsewhere, by group.
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
        """The mechanism with the stresses and reactions of a solution of the program."""
        return self._completed(dual, load_factor, share=1.0)

    def ray(self, dual: ProgramState, sign: float) -> ProgramState:
        """What a solution of `ray_program` adds to states of the face per load factor."""
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
    """Faces of a mechanism for thresholds between rest and motion, the likeliest first.

    None where strength depends on pressure: flow does not fix the stress of a cone.
    """
    if program.pressure_dependent:
        return
    speeds = _speeds(program, point.velocity)
    known: list[_Branches] = []
    for threshold in [*_gaps(speeds), *_THRESHOLDS]:
        branches = _branches(program, speeds, threshold)
        if not any(branches.same(other) for other in known):
            velocity = _cleaned(program, point.velocity, branches)
            yield _face(program, replace(point, velocity=velocity), branches)
        known.append(branches)


@dataclass(frozen=True)
class _Speeds:
    """How fast points open and slip and cones strain, of the fastest; opening beyond dilatancy."""

    opening: Floats
    slip: Floats
    strain: tuple[Floats, ...]


def _speeds(program: KinematicProgram, velocity: Floats) -> _Speeds:
    contact = program.contact
    fastest = float(np.abs(velocity).max()) or 1.0  # of a body at rest all speeds are zero
    slip = np.linalg.norm(contact.slip(velocity), axis=1)
    rates = [np.linalg.norm(g.cone_vectors(velocity), axis=1) for g in program.groups]
    # Of a rigid mechanism all strain rates are noise, against velocity per body length.
    area = sum(float(group.weights.sum()) for group in program.groups)
    overall = fastest / np.sqrt(area) if area > 0 else 0.0
    strain = max([overall, *(float(rate.max(initial=0.0)) for rate in rates)])
    return _Speeds(
        opening=np.asarray((contact.opening(velocity) - contact.dilatancy * slip) / fastest),
        slip=np.asarray(slip / fastest),
        strain=tuple(np.asarray(rate / strain) for rate in rates),
    )


def _gaps(speeds: _Speeds) -> list[float]:
    """Thresholds in the middle of the gaps between noise and slow motion, the widest first."""
    everything = np.concatenate([np.abs(speeds.opening), speeds.slip, *speeds.strain])
    levels = np.sort(np.clip(everything, _NOISE, _SLOW))
    ratios, middles = levels[1:] / levels[:-1], np.sqrt(levels[1:] * levels[:-1])
    wide = np.flatnonzero(ratios >= _GAP)
    ordered: list[float] = middles[wide[np.argsort(-ratios[wide], kind="stable")]].tolist()
    return ordered


def _branches(program: KinematicProgram, speeds: _Speeds, threshold: float) -> _Branches:
    return _Branches(
        open=np.asarray(speeds.opening > threshold),
        slip=np.asarray((speeds.slip > threshold) & np.isfinite(program.contact.limit)),
        flow=tuple(np.asarray(strain > threshold) for strain in speeds.strain),
    )


def _cleaned(program: KinematicProgram, velocity: Floats, branches: _Branches) -> Floats:
    """The nearest velocity that keeps to its branches to round-off; the same if that is not near.

    Noise in a velocity counts against the certificate by the reactions that it meets, and those of
    an end can be far larger than those of the state.
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
    change = lsmr(matrix, missing, atol=0.0, btol=_ROUND_OFF, conlim=0.0, maxiter=_SWEEPS)[0]
    near = np.abs(change).max() <= _NOISY * np.abs(velocity).max()
    return np.asarray(velocity + change) if near else velocity


def _directions(program: KinematicProgram, velocity: Floats, branches: _Branches) -> Floats:
    """Tau of the points that slip, 0 of the others, shape (m, tangent_dim)."""
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
        groups.append(replace(group, bound=np.where(flow, _SLACK, 1.0) * group.bound))
        known.append(fixed)

    # A lifted point may keep a tangential bound that is not of Coulomb; nothing presses it.
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
    shift = np.where(lifted[kept], 1.0, 0.0)  # a row of zeros that is strictly held: t_n = 0
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
    """Rows ``tau . T`` of each point, shape (m, n)."""
    count, dim = direction.shape
    starts = np.arange(count + 1) * dim
    shape = (count, count * dim)
    pick = csr_matrix((direction.ravel(), np.arange(count * dim), starts), shape)
    return csr_matrix(pick @ tangential)


def ray_program(face: Face, sign: float) -> tuple[KinematicProgram, FrozenContact]:
    """Program whose duals are reactions of the face's recession cone that carry ``sign F0`` alone.

    F0 is its dead load. The load factor belongs to an unknown of its own, which touches nothing
    and ends it at 1.
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
