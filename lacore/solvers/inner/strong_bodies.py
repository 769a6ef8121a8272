"""Bodies far too strong to yield, solved as rigid ones, with the proof that they do not yield.

What limits the load of a steel block on a floor is its weight, 1e-4 of its strength: a solver that
sees the strength ends long before friction has a digit. The program of the motions that strain no
strong group is small and sees weights and friction alone. Its load factor, its velocity and its
reactions are those of the whole program if stresses in equilibrium with them lie within the
strength; those of an elastic body are, and are recomputed like any others.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse import csc_matrix, csr_matrix, hstack, vstack
from scipy.sparse.linalg import splu

from lacore.numerics.arrays import Bools, Floats, Sparse
from lacore.program.kinematic import (
    DissipationGroup,
    FrozenContact,
    KinematicProgram,
    Scales,
    dimensionless,
)
from lacore.program.reduction import reduced
from lacore.program.state import ProgramState, out_of_balance
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution, Prepare, PreparedSolver, checked_answer
from lacore.solvers.inner.rescaling import largest_residual, of_both, proven
from lacore.solvers.inner.rigid_motions import motions_without_strain, weighted_rows

_STRONG = 1e3  # strength per what else limits the load; below it solvers have digits enough
_GOOD = 1e-7  # residual of an answer that needs no second solve
_REFINED = 3
_PATIENCE = 2  # failures: bodies that do yield are not tried for ever


class StrongBodySolver:
    """A prepared solver that tries strong bodies as rigid ones first."""

    def __init__(self, program: KinematicProgram, prepare: Prepare) -> None:
        self._program, self._prepare = program, prepare
        self._whole: PreparedSolver | None = None
        self._stiff: dict[tuple[bool, ...], _Stiff] = {}
        self._failures = 0

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """As the backend does."""
        weak = _weak(self._program, contact)
        strong = np.array(
            [_strength(group) >= _STRONG * weak > 0 for group in self._program.groups]
        )
        if not strong.any() or self._program.hardens or self._failures >= _PATIENCE:
            return self._plain(contact)
        self.close()  # a process holds one program
        rigid = self._rigid(strong, weak, contact)
        if (
            rigid.status is Status.UNSAFE
            or largest_residual(self._program, rigid, contact) <= _GOOD
        ):
            return rigid
        self._failures += 1
        answer = self._plain(contact)
        best = min((rigid, answer), key=lambda one: largest_residual(self._program, one, contact))
        closer = answer if best.point is None else proven(self._program, best, contact, _GOOD)
        return of_both(closer, rigid, answer)

    def _plain(self, contact: FrozenContact) -> InnerSolution:
        if self._whole is None:
            self._whole = self._prepare(self._program)
        return self._whole.solve(contact)

    def _rigid(self, strong: Bools, weak: float, contact: FrozenContact) -> InnerSolution:
        """The answer with strong groups rigid, its stresses made elastic."""
        key = tuple(strong.tolist())
        if key not in self._stiff:
            self._stiff[key] = _Stiff.of(self._program, strong)
        stiff, units = self._stiff[key], Scales(stress=weak)
        if not stiff.program.n:
            return InnerSolution(Status.LOCKED, "nothing moves without strain", 0, 0.0, None)
        program = dimensionless(stiff.program, units)
        solver = self._prepare(program)
        try:
            answer = solver.solve(replace(contact, bound=contact.bound / weak))
        finally:
            solver.close()
        answer = checked_answer(program, False, answer)
        if answer.point is None:
            return answer
        return replace(answer, point=stiff.lifted(answer.point.scaled(weak, load_factor=weak)))

    def close(self) -> None:
        """Close the solver of the whole program."""
        if self._whole is not None:
            self._whole.close()
            self._whole = None


def _strength(group: DissipationGroup) -> float:
    """That of a body; what tension opens is never as good as rigid."""
    if group.surfaces is not None or not group.weights.size:
        return 0.0
    return float(group.bound.min(initial=np.inf))


def _weak(program: KinematicProgram, contact: FrozenContact) -> float:
    """Stress by which dead loads and friction limit the load, in the units of the program."""
    finite = contact.bound[np.isfinite(contact.bound)]
    return max(float(np.abs(program.dead_load).sum()), float(finite.max(initial=0.0)))


@dataclass(frozen=True)
class _Stiff:
    """A program whose strong groups do not strain, and the way back.

    Attributes:
        whole: the program.
        strong: its groups that are rigid.
        basis: of the motions without strain in them, shape (n, free).
        program: for these motions, without the strong groups.
    """

    whole: KinematicProgram
    strong: Bools
    basis: Sparse
    program: KinematicProgram

    @classmethod
    def of(cls, whole: KinematicProgram, strong: Bools) -> "_Stiff":
        """Rigid motions are found from the rows of the groups."""
        groups = [group for group, own in zip(whole.groups, strong, strict=True) if own]
        basis = motions_without_strain(groups)
        weak = tuple(group for group, own in zip(whole.groups, strong, strict=True) if not own)
        return cls(whole, strong, basis, reduced(replace(whole, groups=weak), basis))

    @cached_property
    def _elastic(self) -> tuple[Sparse, csc_matrix]:
        """Stiffness of the strong groups, and the same bordered by what it does not resist."""
        rows = [
            weighted_rows(group)
            for group, own in zip(self.whole.groups, self.strong, strict=True)
            if own
        ]
        every = csr_matrix(vstack(rows))
        stiffness = csr_matrix(every.T @ every)
        basis = self.basis * float(stiffness.diagonal().max())
        none = csr_matrix((basis.shape[1], basis.shape[1]))
        upper, lower = hstack([stiffness, basis]), hstack([basis.T, none])
        return stiffness, csc_matrix(vstack([upper, lower]))

    def lifted(self, point: ProgramState) -> ProgramState:
        """A state of the whole program: the stresses of strong groups are those of elastic ones."""
        stresses, means = iter(point.stress), iter(point.mean_stress)
        stress, mean = [], []
        for group, own in zip(self.whole.groups, self.strong, strict=True):
            count = group.weights.size
            stress.append(np.zeros((count, group.dim)) if own else next(stresses))
            mean.append(np.zeros(count) if own else next(means))
        state = replace(
            point,
            velocity=np.asarray(self.basis @ point.velocity),
            stress=tuple(stress),
            mean_stress=tuple(mean),
        )
        bent = self._bent(-out_of_balance(self.whole, state))
        for number, group in enumerate(self.whole.groups):
            if self.strong[number]:
                stress[number] = group.cone_vectors(bent)
                mean[number] = np.asarray(group.volumetric @ bent)
        return replace(state, stress=tuple(stress), mean_stress=tuple(mean))

    def _bent(self, force: Floats) -> Floats:
        """Displacement of an elastic body under forces that are in equilibrium, shape (n,)."""
        stiffness, bordered = self._elastic
        factor = splu(bordered)
        bent, none = np.zeros(force.size), np.zeros(self.basis.shape[1])
        for _ in range(_REFINED):
            rest = force - stiffness @ bent
            bent = bent + factor.solve(np.concatenate([rest, none]))[: force.size]
        return np.asarray(bent)
