"""Reactions of a three-dimensional mechanism, up to a slack in the slip law (T14b a, T77).

A plane mechanism has finitely many branches and therefore an exact face of reactions
(`lacore.coupling.faces`). Directions of slip in three dimensions vary continuously: if a velocity
is known to finite accuracy, no reactions in equilibrium satisfy the law exactly. All reactions with

    D(u) + sum w (limit + c t_n) ||u_t|| - Fd.u - alpha <= slack,   t in K, in equilibrium

satisfy it up to the slack, which is the gap of the pair (T15). They form a convex set, and the
largest load factor is the dual of a kinematic program with an additional unknown theta >= 0, the
multiplier of that gap:

    minimise  D(v) + sum w limit ||v_t|| - Fd.v + theta (slack - D(u) - sum w limit ||u_t|| + Fd.u)
    subject to  F0.v - theta = 1,   v_n + theta c ||u_t|| >= (c + d) ||v_t||

To first order, the slack moves the end outwards by theta times the slack.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.coupling.constants import SLACK_SHARE
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


@dataclass(frozen=True, repr=False)
class Slack(Compact):
    """Program of the largest or the smallest load factor of a mechanism, up to a slack.

    Attributes:
        original, point: Program of the state, and the state.
        program, contact: Program and contact to solve.
        gap: Slack, a power.
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
        """Return the program of a mechanism, with a slack that passes the certificate.

        Args:
            program: Program of rigid blocks, in any units.
            point: A certified state of it.
            sign: +1 for the largest load factor, -1 for the smallest.
            tolerance: Tolerance of the certificate.
        """
        u, rows = point.velocity, program.contact
        gap = SLACK_SHARE * tolerance * kinematic_power(program, point)
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
        """Return the mechanism with the stresses and reactions of a solution of the program."""
        return replace(
            dual,
            velocity=self.point.velocity,
            load_factor=load_factor,
            normal_reaction=np.maximum(dual.normal_reaction[:-1], 0.0),
            tangential_reaction=dual.tangential_reaction[:-1],
        )

    def widening(self, dual: ProgramState) -> float:
        """Return how far the slack moves the end outwards, to first order."""
        return float(max(dual.velocity[-1], 0.0)) * self.gap


def _with_theta(rows: ContactRows, slip: Floats) -> ContactRows:
    """Return contact points that theta opens, and an additional frictionless point for theta."""
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
