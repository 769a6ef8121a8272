"""ECOS as a backend of lacore: all that a backend needs, in one module.

ECOS solves ``minimise c.x  subject to  A x = b,  G x + s = h,  s in K`` with K a product of
half-lines and second-order cones ``s_0 >= ||(s_1, s_2, ...)||``. The unknowns here are x = (U, t):
the velocities of the program and one bound t on each norm in its objective.

Every row is multiplied by its integration weight. Costs are then plain strengths, and multipliers
are stresses instead of nodal forces; on graded meshes it also saves digits.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import ecos
import numpy as np
import scipy.sparse as sp

from lacore.numerics.arrays import Bools, Floats, Sparse
from lacore.program import FrozenContact, KinematicProgram, interleaved
from lacore.program.state import ProgramState
from lacore.reporting.errors import require_count, require_positive
from lacore.reporting.status import Status
from lacore.solvers.backend import Capabilities, InnerSolution

_LATE = "late"  # ours: ECOS does not look at the clock

# Every exit flag of ecos.h, and what it means here. Where the status has a point, lacore recomputes
# its residuals: an honest "almost" costs nothing, a certificate of infeasibility must be certain.
STATUS_MAP = {
    0: Status.SOLVED,
    10: Status.ALMOST_SOLVED,
    1: Status.LOCKED,  # no velocity at all with F0.U = 1
    11: Status.FAILED,
    2: Status.UNSAFE,  # the dead loads alone do unbounded work
    12: Status.FAILED,
    -1: Status.ITERATION_LIMIT,
    -2: Status.STALLED,  # search direction unreliable
    -3: Status.FAILED,  # outside the cones
    -4: Status.FAILED,  # interrupted
    -7: Status.FAILED,  # fatal
    _LATE: Status.TIME_LIMIT,
}


@dataclass(frozen=True)
class EcosOptions:
    """Options of the `ecos` backend; whoever gives none gets a result worth comparing.

    Attributes:
        tolerance: on feasibility and on the gap, absolute and relative.
        max_iterations: of the interior-point method.
        time_limit: s, one inner solve; kept by lacore, which stops the process.
    """

    tolerance: float = 1e-10
    max_iterations: int = 200
    time_limit: float = 3600.0

    def __post_init__(self) -> None:
        require_positive("ecos.tolerance", self.tolerance)
        require_count("ecos.max_iterations", self.max_iterations)
        require_positive("ecos.time_limit", self.time_limit)


class Ecos:
    """What lacore asks about the solver before it gives it any work."""

    name: ClassVar[str] = "ecos"
    title: ClassVar[str] = "ECOS, exact second-order cone program"
    source: ClassVar[str] = "Domahidi, Chu & Boyd, ECOS: an SOCP solver, ECC 2013"
    # ECOS knows no time limit: isolated asks for a process that can be stopped.
    capabilities: ClassVar[Capabilities] = Capabilities(regularised=False, isolated=True)
    statuses: ClassVar[Mapping[Any, Status]] = STATUS_MAP
    Options: ClassVar[type] = EcosOptions

    def unavailable(self) -> str:
        """Always there once imported."""
        return ""

    def version(self) -> str:
        """The solver and its version."""
        return f"ECOS {ecos.__solver_version__}"

    def prepare(self, program: KinematicProgram, options: EcosOptions) -> "EcosSolver":
        """Called once a coupled problem."""
        return EcosSolver(program, options)


class EcosSolver:
    """ECOS at work on one program; `solve` is called once an iteration of the coupling loop."""

    def __init__(self, program: KinematicProgram, options: EcosOptions) -> None:
        self._program, self._options = program, options
        rows = program.contact
        # What no frozen contact changes is built here, once.
        self._normal = _weighted(rows.normal, rows.weights, 1)
        self._tangential = _weighted(rows.tangential, rows.weights, rows.tangent_dim)
        self._strain = [_weighted(g.rows, g.weights, g.dim) for g in program.groups]
        self._theta = [_weighted(g.volumetric, g.weights, 1) for g in program.groups]

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve for a frozen contact; whatever comes of it is a status, not an exception."""
        begin = time.perf_counter()
        program, dim = self._program, self._program.contact.tangent_dim
        stick = np.isinf(contact.bound)
        slides = ~stick & (contact.bound > 0)  # with a bound of 0 nothing would hold its t
        dilates = contact.dilatancy > 0

        # A: F0.U = 1; theta = 0; no slip where friction sticks.
        equalities = [sp.csr_matrix(program.reference_load[None, :]), *self._theta]
        equalities.append(_taken(self._tangential, stick, dim))
        equal = sp.vstack(equalities)

        # G, without its sign: opening, with dilatancy as a cone; then (t, rows U) for each norm.
        factor = sp.diags_array(np.repeat(contact.dilatancy, dim))
        dilated = _taken(sp.csr_matrix(factor @ self._tangential), dilates, dim)
        opening = [self._normal[~dilates], interleaved(self._normal[dilates], 1, dilated, dim)]
        norms = [*self._strain, _taken(self._tangential, slides, dim)]
        dims = [*(group.dim for group in program.groups), dim]
        counts = [rows.shape[0] // d for rows, d in zip(norms, dims, strict=True)]
        cones = [
            interleaved(sp.csr_matrix((count, program.n)), 1, rows, d)
            for rows, count, d in zip(norms, counts, dims, strict=True)
        ]
        ts = [sp.kron(sp.eye_array(m), np.eye(1 + d, 1)) for m, d in zip(counts, dims, strict=True)]

        # b, h, c: the load normalised; shifts of the contact; dead load, strengths, friction.
        shift = program.contact.weights * contact.shift
        offsets = [shift[~dilates], np.kron(shift[dilates], np.eye(1, 1 + dim)[0])]
        offsets += [np.zeros(rows.shape[0]) for rows in cones]
        strengths = [*(group.bound for group in program.groups), contact.bound[slides]]

        answer = ecos.solve(
            c=np.concatenate([-program.dead_load, *strengths]),
            G=sp.csc_matrix(
                -sp.block_array([[sp.vstack(opening), None], [sp.vstack(cones), sp.block_diag(ts)]])
            ),
            h=np.concatenate(offsets),
            dims={
                "l": opening[0].shape[0],
                "q": [1 + dim] * int(dilates.sum())
                + [1 + d for m, d in zip(counts, dims, strict=True) for _ in range(m)],
            },
            A=sp.csc_matrix(sp.hstack([equal, sp.csr_matrix((equal.shape[0], sum(counts)))])),
            b=np.eye(1, equal.shape[0])[0],
            feastol=self._options.tolerance,
            abstol=self._options.tolerance,
            reltol=self._options.tolerance,
            max_iters=self._options.max_iterations,
            verbose=False,
        )

        # Read the multipliers of the rows back, block by block, in the signs of `ProgramState`.
        y, z = _split(answer["y"], equalities), _split(answer["z"], [*opening, *cones])
        t_n = np.zeros(program.contact.count)
        t_t = np.zeros((program.contact.count, dim))
        t_n[~dilates] = z[0]
        t_n[dilates] = z[1].reshape(-1, 1 + dim)[:, 0]
        t_t[dilates] = contact.dilatancy[dilates, None] * z[1].reshape(-1, 1 + dim)[:, 1:]
        t_t[slides] += z[-1].reshape(-1, 1 + dim)[:, 1:]
        t_t[stick] -= y[-1].reshape(-1, dim)
        point = ProgramState(
            velocity=answer["x"][: program.n],
            load_factor=-float(y[0][0]),
            stress=tuple(
                -part.reshape(-1, 1 + group.dim)[:, 1:]
                for part, group in zip(z[2:-1], program.groups, strict=True)
            ),
            mean_stress=tuple(y[1:-1]),
            normal_reaction=t_n,
            tangential_reaction=t_t,
        )
        spent = time.perf_counter() - begin
        late = spent > self._options.time_limit
        status = STATUS_MAP[_LATE if late else answer["info"]["exitFlag"]]
        return InnerSolution(
            status=status,
            native_status=answer["info"]["infostring"],
            iterations=answer["info"]["iter"],
            solve_time=spent,
            point=point if status.has_point else None,
        )

    def close(self) -> None:
        """Nothing is held."""


def _weighted(rows: Sparse, weights: Floats, dim: int) -> Sparse:
    """Each row times the weight of its cone."""
    return sp.csr_matrix(sp.diags_array(np.repeat(weights, dim)) @ rows)


def _taken(rows: Sparse, mask: Bools, dim: int) -> Sparse:
    """The rows of the cones of a mask."""
    return sp.csr_matrix(rows[np.repeat(mask, dim)])


def _split(values: Floats, blocks: list[Sparse]) -> list[Floats]:
    """Values by the blocks of rows that they belong to."""
    return np.split(values, np.cumsum([block.shape[0] for block in blocks])[:-1])
