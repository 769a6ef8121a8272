"""Proximal Tresca steps: reactions that are a continuum are drawn to those that were frozen (T76).

    T(x) = argmax  alpha - (e/2) sum (w (t_n - x))^2   over SA with ||t_t|| <= mu x

has the Coulomb states as its fixed points, exactly, and one image of each x, where the reactions of
a K-step are any of many. So Anderson's acceleration works on it, and not on plain K-steps. As a
kinematic program each Coulomb point gets a speed v of its own, by which it yields at a cost:

    minimise  ... + sum (w x v + v^2/(2 e)),   u_n + v >= 0,   w (t_n - x) = v/e

A domed or vaulted assembly in space has no finite set of branches (T73, T74): where the alternation
stalls, this often ends.
"""

from contextlib import closing
from dataclasses import replace

import numpy as np
from scipy.sparse import csr_matrix, hstack

from lacore.arrays import Floats, Sparse
from lacore.backend import InnerSolution, PreparedSolver
from lacore.coupling.run import Iterate, Run, worst
from lacore.coupling.steps import carries
from lacore.numerics.anderson import Anderson
from lacore.program import DissipationGroup, FrozenContact, KinematicProgram, reaction_contact
from lacore.state import ProgramState
from lacore.status import Status

_COMPLIANCE = 0.1  # of the largest velocity per largest force of the associated state
_DEPTH = 8  # of Anderson's acceleration
_MOST = 60  # steps
_PATIENCE = 25  # steps without progress that are borne in a row
_FALLS = 0.8  # of the least residual so far: anything above is no progress


def proximal(run: Run, static: ProgramState) -> Iterate | None:
    """Proximal steps with Anderson's acceleration from a state; the iterate that ends the loop."""
    rows = run.program.contact
    first = run.iterates[0].inner.point or static
    force = float((rows.weights * np.abs(first.normal_reaction)).max())
    fastest = float(np.abs(first.velocity).max())
    if run.prepare is None or not (force > 0 and fastest > 0):
        return None
    compliance = _COMPLIANCE * fastest / force
    mixing, forces = Anderson(_DEPTH, 1.0), rows.weights * np.maximum(static.normal_reaction, 0.0)
    least, failed, last = np.inf, 0, len(run.iterates) + _MOST
    while not run.exhausted and failed <= _PATIENCE and len(run.iterates) < last:
        step = _step(run, forces, compliance)
        if step.inner.status is Status.UNSAFE:
            forces = np.maximum(forces, rows.weights * static.normal_reaction)
            step = _step(run, forces, compliance)
        point = step.inner.point
        if point is None or run.free(step) or run.proven(step):
            return step if carries(run, step) else None
        failed = 0 if worst(step) <= _FALLS * least else failed + 1
        least = min(least, worst(step))
        image = rows.weights * np.maximum(point.normal_reaction, 0.0)
        forces = np.maximum(mixing.step(forces, image), 0.0)
    return None


def _step(run: Run, forces: Floats, compliance: float) -> Iterate:
    """The image of normal forces at the contact points."""
    rows = run.program.contact
    contact = reaction_contact(rows, forces / rows.weights)
    assert run.prepare is not None
    with closing(run.prepare(proximal_program(run.program, forces, compliance))) as solver:
        return run.solve("P", contact, solver=_Without(solver, run.program.n))


def proximal_program(
    program: KinematicProgram, forces: Floats, compliance: float
) -> KinematicProgram:
    """The program whose Coulomb points yield, with their speeds as its last unknowns.

    Args:
        program: in any units.
        forces: w x, shape (m,).
        compliance: e, speed per force.
    """
    rows = program.contact
    points = np.flatnonzero(rows.coulomb)
    k = points.size

    def wide(matrix: Sparse) -> Sparse:
        return csr_matrix(
            (matrix.data, matrix.indices, matrix.indptr), (matrix.shape[0], program.n + k)
        )

    own = csr_matrix((np.ones(k), (points, np.arange(k))), shape=(rows.count, k))
    speeds = csr_matrix((np.ones(k), (np.arange(k), program.n + np.arange(k))), (k, program.n + k))
    none = csr_matrix((k, program.n + k))
    yielding = DissipationGroup(
        "proximal", speeds, 1, np.ones(k), np.zeros(k), none, 0.0, np.full(k, 1 / compliance)
    )
    return replace(
        program,
        groups=(
            *(replace(g, rows=wide(g.rows), volumetric=wide(g.volumetric)) for g in program.groups),
            yielding,
        ),
        contact=replace(
            rows,
            normal=csr_matrix(hstack([rows.normal, own], format="csr")),
            tangential=wide(rows.tangential),
        ),
        reference_load=np.append(program.reference_load, np.zeros(k)),
        dead_load=np.append(program.dead_load, -forces[points]),
        parts=np.append(program.part, np.full(k, program.part.max(initial=-1) + 1)),
    )


class _Without(PreparedSolver):
    """A solver whose answers leave out the last group, and unknowns from a number on."""

    def __init__(self, solver: PreparedSolver, count: int) -> None:
        self._solver, self._count = solver, count

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """As the solver does."""
        answer = self._solver.solve(contact)
        point = answer.point
        if point is None:
            return answer
        kept = replace(
            point,
            velocity=point.velocity[: self._count],
            stress=point.stress[:-1],
            mean_stress=point.mean_stress[:-1],
        )
        return replace(answer, point=kept)

    def close(self) -> None:
        """Nothing of its own."""
