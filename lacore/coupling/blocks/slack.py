"""Reactions that go with a mechanism in space, up to a slack in the slip law (T14b a, T77).

In the plane a mechanism has finitely many branches, and so a face of reactions that is exact
(`lacore.coupling.faces`). In space directions of slip turn continuously, and of a velocity that is
known to some digits no reactions obey the law exactly and are in equilibrium. All within

    D(u) + sum w (limit + c t_n) ||u_t|| - Fd.u - alpha <= slack,   t in K, in equilibrium

do up to the slack, which is the gap of the pair (T15). They are convex, and the largest load factor
is the dual of a kinematic program with one more unknown, theta >= 0, the multiplier of that gap:

    minimise  D(v) + sum w limit ||v_t|| - Fd.v + theta (slack - D(u) - sum w limit ||u_t|| + Fd.u)
    subject to  F0.v - theta = 1,   v_n + theta c ||u_t|| >= (c + d) ||v_t||

So theta says what the slack is worth: without it the end would be nearer by some theta times slack.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.numerics.arrays import Floats
from lacore.program.kinematic import (
    ContactRows,
    FrozenContact,
    KinematicProgram,
    associated_contact,
)
from lacore.program.power import kinematic_power
from lacore.program.state import ProgramState
from lacore.reporting.showing import Compact
from lacore.solvers.inner.own_unknown import with_own_unknown

_SHARE = 0.9  # of the bar: what is left is for round-off and equilibrium


@dataclass(frozen=True, repr=False)
class Slack(Compact):
    """The program of the largest or the smallest load factor of a mechanism, up to a slack.

    Attributes:
        original, point: the program of the state, and the state.
        program, contact: what to solve.
        gap: the slack, a power.
    """

    original: KinematicProgram
    point: ProgramState
    program: KinematicProgram
    contact: FrozenContact
    gap: float

    @classmethod
    def of(
        cls, program: KinematicProgram, point: ProgramState, sign: float, tolerance: float
    ) -> "Slack":
        """Of a mechanism, with a gap that a certificate with a bar lets pass.

        Args:
            program: of rigid blocks, in any units.
            point: a certified state of it.
            sign: +1 for the largest load factor, -1 for the smallest.
            tolerance: the bar.
        """
        u, rows = point.velocity, program.contact
        gap = _SHARE * tolerance * kinematic_power(program, point)
        slip = np.asarray(np.linalg.norm(rows.slip(u), axis=1))
        dissipated = program.plastic_dissipation(u) + program.friction_dissipation(u, rows.limit)
        over = dissipated - float(program.dead_load @ u) - gap
        wide = with_own_unknown(program, "slack", reference=-1.0, dead=over)
        solved = replace(
            wide,
            groups=wide.groups[:-1],
            contact=_with_theta(wide.contact, rows.coefficient * slip),
            reference_load=sign * wide.reference_load,
        )
        return cls(program, point, solved, associated_contact(solved.contact), gap)

    def state(self, dual: ProgramState, load_factor: float) -> ProgramState:
        """The mechanism with the stresses and reactions of a solution of the program."""
        return replace(
            dual,
            velocity=self.point.velocity,
            load_factor=load_factor,
            normal_reaction=np.maximum(dual.normal_reaction[:-1], 0.0),
            tangential_reaction=dual.tangential_reaction[:-1],
        )

    def worth(self, dual: ProgramState) -> float:
        """By how much a solution would be nearer without the slack, to first order."""
        return float(max(dual.velocity[-1], 0.0)) * self.gap


def _with_theta(rows: ContactRows, slip: Floats) -> ContactRows:
    """Contact points that theta opens by a speed each, and one more, without friction, theta."""
    n, points = rows.normal.shape[1], np.arange(rows.count)
    theta = csr_matrix((slip, (points, np.full(rows.count, n - 1))), (rows.count, n))
    alone = csr_matrix(([1.0], ([0], [n - 1])), (1, n))

    def longer(values: Floats) -> Floats:
        return np.append(values, 0.0)

    return replace(
        rows,
        normal=csr_matrix(vstack([rows.normal + theta, alone], format="csr")),
        tangential=csr_matrix(
            vstack([rows.tangential, csr_matrix((rows.tangent_dim, n))], format="csr")
        ),
        weights=np.append(rows.weights, 1.0),
        coefficient=longer(rows.coefficient),
        limit=longer(rows.limit),
        dilatancy=longer(rows.dilatancy),
        interface=np.append(rows.interface, rows.interface.max(initial=-1) + 1),
        tension=None if rows.tension is None else longer(rows.tension),
    )
