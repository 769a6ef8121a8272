"""Coulomb states at the end of a smooth path (T79).

With forces ``x = w (c t_n, t_t)`` and velocities ``y = (u_n/c + ||u_t||, u_t)`` Coulomb's law says
that both lie in the second-order cone and are complementary (de Saxce). That is smoothed, by m:

    x = P_m(x - y),   equilibrium of x and alpha,   F0.u = 1.

For a large m there is one solution, in the middle of all cones, and a curve leads from it to m = 0:
to a Coulomb state. It turns back where friction makes states jump, and is followed around its folds
(`lacore.numerics.curve`).
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import bsr_matrix, csc_matrix, csr_matrix, diags, hstack, vstack
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from lacore.arrays import Floats, Ints, Sparse
from lacore.backend import InnerSolution, PreparedSolver
from lacore.certificate import certify
from lacore.coupling.run import Iterate, Run
from lacore.coupling.steps import carries
from lacore.numerics.curve import begun, followed
from lacore.numerics.linear_algebra import SingularError
from lacore.numerics.smooth_cone import Smoothed, smoothed
from lacore.program import FrozenContact, KinematicProgram, reaction_contact
from lacore.showing import Compact
from lacore.state import ProgramState
from lacore.status import Status

_BEGINS = (0.0, 1.5, 3.0)  # logarithms of the smoothing, per largest force and velocity
_CURVES = 6
# Logarithmic spread of the smoothing of the first curve, and of others. Where structures are
# symmetric curves branch; where points are all but alike they do not.
_UNLIKE, _SHAKEN = 0.01, 0.3
_PLACES = 500  # of one curve
_CLOSE = 1e-4  # smoothing from which on states are judged
_OUT, _END = 1e2, 1e-10  # smoothing beyond which no curve is followed
_SHARE = 0.5  # of the bar, for what units and round-off add


def tracked(run: Run, static: ProgramState) -> Iterate | None:
    """Along curves from the middle of all cones; the iterate that ends the loop, or None."""
    if not takes(run.program):
        return None
    start, rows = run.iterates[0].inner.point or static, run.program.contact
    rng = np.random.default_rng(0)  # the same each time
    contact = reaction_contact(rows, np.maximum(static.normal_reaction, 0.0))
    for curve in range(_CURVES):
        if run.exhausted:
            break
        share = np.exp((_SHAKEN if curve else _UNLIKE) * rng.standard_normal(rows.count))
        follower = _Follower(run.program, start, share, _SHARE * run.options.tolerance)
        step = run.solve("path", contact, solver=follower)
        if carries(run, step):
            return step
    return None


@dataclass(frozen=True, repr=False)
class _Follower(PreparedSolver):
    """What follows one curve, and answers with the state of least residuals."""

    program: KinematicProgram
    start: ProgramState
    share: Floats
    bar: float

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Of the true friction, whatever is frozen."""
        begin, best, least, places = time.perf_counter(), None, np.inf, 0
        for state, smoothing in states_along(self.program, self.start, self.share):
            places += 1
            if smoothing <= _CLOSE:
                worst = certify(self.program, state).worst[1]
                if worst < least:
                    best, least = state, worst
            if least <= self.bar or places >= _PLACES or not _END < smoothing < _OUT:
                break
        status = Status.SOLVED if least <= self.bar else Status.NOT_CONVERGED
        spent = time.perf_counter() - begin
        return InnerSolution(
            status, f"smoothing {smoothing:.1e}" if places else "no curve", places, spent, best
        )

    def close(self) -> None:
        """Nothing."""


def takes(program: KinematicProgram) -> bool:
    """Whether a program is one of rigid blocks in space whose friction is a cone."""
    rows = program.contact
    bonded = np.any(rows.limit) or np.any(rows.dilatancy) or np.any(rows.pull)
    moving = np.any(rows.lead)
    return rows.tangent_dim == 2 and not (program.groups or bonded or moving)


def states_along(
    program: KinematicProgram, start: ProgramState, share: Floats
) -> Iterator[tuple[ProgramState, float]]:
    """States on the way along a curve, from wherever Newton's method finds it, and their smoothing.

    Args:
        program: that is taken.
        start: the largest force and velocity of it are the scales.
        share: of the smoothing that points have, (m,) > 0: each leads along a curve of its own.
    """
    rows = program.contact
    scale = np.where(rows.coulomb, rows.coefficient, 1.0)
    pressed = np.column_stack([scale * start.normal_reaction, start.tangential_reaction])
    x = rows.weights[:, None] * pressed
    force = float(np.linalg.norm(x, axis=1).max(initial=0.0))
    speed = float(np.abs(start.velocity).max(initial=0.0))
    if not (force > 0 and speed > 0):
        return
    system = _System(program, scale, program.dead_load / force, 1 / speed, share)
    place = np.concatenate([start.velocity / speed, x.ravel() / force, [start.load_factor / force]])
    for s in _BEGINS:
        on_curve = begun(system, place, s)
        if on_curve is None:
            continue
        for place, at in followed(system, on_curve, s):
            yield _state(program, place, force, scale, start), float(np.exp(at))
        return


def _state(
    program: KinematicProgram, place: Floats, force: float, scale: Floats, like: ProgramState
) -> ProgramState:
    """A place as a state, whose reactions lie in their cones."""
    rows = program.contact
    u, x, alpha = np.split(place, [program.n, place.size - 1])
    pressed = x.reshape(-1, 3) * (force / rows.weights)[:, None]
    normal = np.maximum(pressed[:, 0] / scale, 0.0)
    length = np.linalg.norm(pressed[:, 1:], axis=1)
    within = np.minimum(1.0, rows.coefficient * normal / np.where(length > 0, length, 1.0))
    return replace(
        like,
        velocity=u / float(program.reference_load @ u),
        load_factor=float(alpha[0]) * force,
        normal_reaction=normal,
        tangential_reaction=pressed[:, 1:] * within[:, None],
    )


class _System:
    """The smoothed law with equilibrium and a load that turns over power; unknowns u, x, alpha."""

    def __init__(
        self, program: KinematicProgram, scale: Floats, dead: Floats, speed: float, share: Floats
    ) -> None:
        rows = program.contact
        m = rows.count
        sizes = np.column_stack([1 / scale, rows.coulomb, rows.coulomb])
        tangents = m + np.arange(2 * m).reshape(m, 2)
        order = np.column_stack([np.arange(m), tangents]).ravel()
        all_rows = csr_matrix(vstack([rows.normal, rows.tangential], format="csr"))[order]
        self.rows = csr_matrix(diags(sizes.ravel()) @ all_rows)
        self.columns = csr_matrix(self.rows.T)
        self.reference, self.dead, self.speed, self.share = (
            program.reference_load,
            dead,
            speed,
            share,
        )

    def at(self, place: Floats, s: float) -> "_Local":
        """See `lacore.numerics.curve.System`."""
        n = self.reference.size
        u, x, alpha = np.split(place, [n, place.size - 1])
        x, m = x.reshape(-1, 3), np.exp(s) * self.share
        y = (self.rows @ u).reshape(-1, 3)
        slip = np.hypot(np.linalg.norm(y[:, 1:], axis=1), m)
        ahead = y[:, 1:] / slip[:, None]
        y[:, 0] += slip
        cone = smoothed(x - y, m)
        balance = self.columns @ x.ravel() + alpha[0] * self.reference + self.dead
        rest = np.array([self.reference @ u - self.speed])
        growth = cone.blocks(cone.slope)[:, :, 0] * (m**2 / slip)[:, None] - cone.growth
        return _Local(
            self,
            cone,
            ahead,
            np.concatenate([(x - cone.value).ravel(), balance, rest]),
            np.concatenate([growth.ravel(), np.zeros(n + 1)]),
        )


@dataclass(frozen=True, repr=False)
class _Local(Compact):
    """See `lacore.numerics.curve.Local`; `ahead` are the directions of slip, (m, 2)."""

    system: _System
    cone: Smoothed
    ahead: Floats
    residual: Floats
    change: Floats

    def linear(self) -> "_Linear":
        """Of (I - M) dx + M Y du, of balance and of power: forces are eliminated by points."""
        own, cone = self.system, self.cone
        turned = np.tile(np.eye(3), (len(self.ahead), 1, 1))  # du to dy, of points
        turned[:, 0, 1:] = self.ahead
        tiny = np.finfo(float).tiny
        stiff = _diagonal(cone.blocks(cone.slope / np.maximum(cone.rest, tiny)) @ turned)
        matrix = own.columns @ (stiff @ own.rows)
        load = csr_matrix(own.reference[:, None])
        try:
            below = hstack([csr_matrix(load.T), csr_matrix((1, 1))], format="csr")
            factor = splu(csc_matrix(vstack([hstack([-matrix, load], format="csr"), below])))
        except RuntimeError as error:
            raise SingularError(str(error)) from error
        diagonal = factor.U.diagonal()
        sign = _parity(factor.perm_r) * _parity(factor.perm_c) * np.prod(np.sign(diagonal))
        away = cone.blocks(1 / np.maximum(cone.rest, tiny))
        return _Linear(
            own,
            factor.solve,
            stiff,
            away,
            cone.blocks(cone.rest),
            _diagonal(cone.blocks(cone.slope) @ turned),
            float(sign),
        )


@dataclass(frozen=True, repr=False)
class _Linear(Compact):
    """See `lacore.numerics.curve.Linear`."""

    system: _System
    condensed: Callable[[Floats], Floats]
    stiff: Sparse
    away: Floats
    rest: Floats
    moved: Sparse
    sign: float

    def solve(self, right: Floats) -> Floats:
        """Twice: what the condensed system loses where points stick or open comes back."""
        found = self._once(right)
        return found + self._once(right - self._times(found))

    def _once(self, right: Floats) -> Floats:
        own, n = self.system, self.system.reference.size
        force, balance, speed = np.split(right, [right.size - n - 1, right.size - 1])
        alone = _each(self.away, force)
        found = self.condensed(np.concatenate([balance - own.columns @ alone, speed]))
        forces = alone - self.stiff @ (own.rows @ found[:-1])
        return np.concatenate([found[:-1], forces, found[-1:]])

    def _times(self, z: Floats) -> Floats:
        own, n = self.system, self.system.reference.size
        u, x, alpha = np.split(z, [n, z.size - 1])
        law = _each(self.rest, x) + self.moved @ (own.rows @ u)
        balance = own.columns @ x + alpha[0] * own.reference
        return np.concatenate([law, balance, [own.reference @ u]])


def _diagonal(blocks: Floats) -> Sparse:
    """Blocks (m, 3, 3) along a diagonal."""
    m = len(blocks)
    return csr_matrix(bsr_matrix((blocks, np.arange(m), np.arange(m + 1))))


def _each(blocks: Floats, vectors: Floats) -> Floats:
    """Blocks (m, 3, 3) times vectors (3 m,), one each."""
    return np.asarray(np.einsum("mij,mj->mi", blocks, vectors.reshape(-1, 3)).ravel())


def _parity(permutation: Ints) -> int:
    """+1 of an even permutation, -1 of an odd one."""
    k = permutation.size
    steps = csr_matrix((np.ones(k), (np.arange(k), permutation)), (k, k))
    cycles, _ = connected_components(steps, directed=False)
    return 1 if (k - cycles) % 2 == 0 else -1
