"""Very strong bodies solved as rigid ones, with a proof that they do not yield.

The load of a steel block on a floor is limited by its weight, 1e-4 of its strength: a solver that
sees the strength stops before friction has a single correct digit. The program of the motions
without strain in strong groups is small and contains only weights and friction. Its load factor,
velocity and reactions are those of the whole program if stresses in equilibrium with them lie
within the strength. The stresses of an elastic body usually do, and are checked like any others.
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

_STRONG = 1e3  # strength, by the other limits of the load, below which solvers have enough digits
_GOOD = 1e-7  # residual of an answer that needs no second solve
_REFINED = 3
_PATIENCE = 2  # number of failures after which bodies that yield are not tried again


class StrongBodySolver:
    """Prepared solver that tries strong bodies as rigid ones first."""

    def __init__(self, program: KinematicProgram, prepare: Prepare) -> None:
        self._program, self._prepare = program, prepare
        self._whole: PreparedSolver | None = None
        self._stiff: dict[tuple[bool, ...], _Stiff] = {}
        self._failures = 0

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve with strong bodies as rigid ones if possible, else with the backend alone."""
        weak = _weak(self._program, contact)
        strong = np.array(
            [_strength(group) >= _STRONG * weak > 0 for group in self._program.groups]
        )
        if not strong.any() or self._program.hardens or self._failures >= _PATIENCE:
            return self._plain(contact)
        self.close()  # A process holds one program.
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
        """Return the answer with strong groups as rigid ones, and with elastic stresses."""
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
    """Return the strength of a body; 0 if it depends on pressure, so that it is not rigid."""
    if group.surfaces is not None or not group.weights.size:
        return 0.0
    return float(group.bound.min(initial=np.inf))


def _weak(program: KinematicProgram, contact: FrozenContact) -> float:
    """Return the stress of dead loads and friction that limits the load, in the program's units."""
    finite = contact.bound[np.isfinite(contact.bound)]
    return max(float(np.abs(program.dead_load).sum()), float(finite.max(initial=0.0)))


@dataclass(frozen=True)
class _Stiff:
    """Program whose strong groups do not strain, and conversion of its states.

    Attributes:
        whole: the program.
        strong: which of its groups are rigid.
        basis: motions without strain in them, shape (n, free).
        program: program of these motions, without the strong groups.
    """

    whole: KinematicProgram
    strong: Bools
    basis: Sparse
    program: KinematicProgram

    @classmethod
    def of(cls, whole: KinematicProgram, strong: Bools) -> "_Stiff":
        """Return the program with rigid motions found from the rows of the groups."""
        groups = [group for group, own in zip(whole.groups, strong, strict=True) if own]
        basis = motions_without_strain(groups)
        weak = tuple(group for group, own in zip(whole.groups, strong, strict=True) if not own)
        return cls(whole, strong, basis, reduced(replace(whole, groups=weak), basis))

    @cached_property
    def _elastic(self) -> tuple[Sparse, csc_matrix]:
        """Stiffness of the strong groups, and the same with a border for its free motions."""
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
        """Return a state of the whole program, with elastic stresses in strong groups."""
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
        """Return the displacement of an elastic body under balanced forces, shape (n,)."""
        stiffness, bordered = self._elastic
        factor = splu(bordered)
        bent, none = np.zeros(force.size), np.zeros(self.basis.shape[1])
        for _ in range(_REFINED):
            rest = force - stiffness @ bent
            bent = bent + factor.solve(np.concatenate([rest, none]))[: force.size]
        return np.asarray(bent)
