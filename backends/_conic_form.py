"""The kinematic program as cones (T34), exact or regularised (T17-T20). Not a backend.

``minimise x.P x/2 + q.x  subject to  A x + z = b, z in cones`` with x = (U, t, tau, y): one t a
plasticity cone, one tau a friction cone. Rows are multiplied by their integration weight, so that
costs are stress bounds and duals are stresses.

Regularised, every row v of a law becomes ``v - e`` with an elastic share e and its energy
``K e^2/2``, K the stiffness: ``min bound ||v - e|| + K ||e||^2/2`` is the Huber law of T17 and T18,
and with a constraint in place of the norm it is a penalty. The duals are the stresses still, and
e = stress/K. The y are e sqrt(K): of the size of the square root of an energy for every r.
"""

from dataclasses import dataclass
from typing import Any

import clarabel
import numpy as np
from scipy.sparse import csr_matrix, diags_array, vstack

from lacore.arrays import Bools, Floats, Sparse
from lacore.program import FrozenContact, KinematicProgram, interleaved
from lacore.regularization import Penalties
from lacore.state import ProgramState


@dataclass(frozen=True)
class Pattern:
    """Which contact points need which rows; a form is rebuilt only when it changes."""

    friction: Bools  # cost g ||u_t||
    stick: Bools  # u_t = 0
    dilatancy: tuple[float, ...]

    @classmethod
    def of(cls, contact: FrozenContact, softened: bool) -> "Pattern":
        """That of a frozen contact; softened dilatant points have no friction besides (T18)."""
        bound = contact.bound
        if softened:
            bound = np.where(contact.dilatancy > 0, 0.0, bound)
        return cls(
            friction=np.isfinite(bound) & (bound > 0),
            stick=np.isinf(bound),
            dilatancy=tuple(contact.dilatancy),
        )

    def same(self, other: "Pattern") -> bool:
        """Whether the other one needs the same rows."""
        return (
            np.array_equal(self.friction, other.friction)
            and np.array_equal(self.stick, other.stick)
            and self.dilatancy == other.dilatancy
        )


@dataclass(frozen=True)
class _Law:
    """Rows of a law, `dim` a point, with the weights of the points; soft where stiffness < inf."""

    rows: Sparse
    dim: int
    weights: Floats
    stiffness: float

    @property
    def softened(self) -> int:
        """Number of its y."""
        return self.rows.shape[0] if np.isfinite(self.stiffness) else 0

    def over(self, columns: int, first: int) -> Sparse:
        """``weights (rows U - y/sqrt(K))`` over all columns, the y from column `first` on."""
        weights = np.repeat(self.weights, self.dim)
        rows = csr_matrix(diags_array(weights) @ self.rows)
        wide = _wide(rows, columns)
        if not self.softened:
            return wide
        own = np.arange(weights.size)
        share = weights / np.sqrt(self.stiffness)
        return csr_matrix(wide - csr_matrix((share, (own, first + own)), wide.shape))


class ConicForm:
    """The form for one pattern of contact rows; no penalties: exact.

    Attributes:
        quadratic, matrix, cones: P, A and the cones.
    """

    def __init__(
        self,
        program: KinematicProgram,
        contact: FrozenContact,
        pattern: Pattern,
        penalty: Penalties | None,
    ) -> None:
        self._program, self._pattern, self._penalty = program, pattern, penalty
        points, dim = program.contact, program.contact.tangent_dim
        stiff = penalty or Penalties(np.inf, np.inf, np.inf, np.inf)
        self._dilatant = contact.dilatancy > 0

        def slip(mask: Bools) -> _Law:
            rows = points.tangential[np.repeat(mask, dim)]
            return _Law(rows, dim, points.weights[mask], stiff.tangential)

        def opening(mask: Bools) -> _Law:
            return _Law(points.normal[mask], 1, points.weights[mask], stiff.normal)

        volumes = [_Law(g.volumetric, 1, g.weights, stiff.bulk) for g in program.groups]
        strains = [
            _Law(g.rows, g.dim, g.weights, np.inf)
            if penalty is None
            else _Law(
                interleaved(g.rows, g.dim, g.volumetric * g.volumetric_factor, 1),
                g.dim + 1,
                g.weights,
                stiff.eta,
            )
            for g in program.groups
        ]
        equal = [*volumes, slip(pattern.stick)]
        unilateral = [opening(~self._dilatant), opening(self._dilatant), slip(self._dilatant)]
        normed = [*strains, slip(pattern.friction)]
        laws = [*equal, *unilateral, *normed]

        norms = program.n + np.cumsum([0, *(law.weights.size for law in normed)])
        first = int(norms[-1])
        starts = first + np.cumsum([0, *(law.softened for law in laws)])
        columns = int(starts[-1])
        over = [law.over(columns, int(start)) for law, start in zip(laws, starts[:-1], strict=True)]

        load = _wide(csr_matrix(program.reference_load[None, :]), columns)
        blocks = [load, *over[: len(equal)]]
        self.cones: list[Any] = [clarabel.ZeroConeT(sum(block.shape[0] for block in blocks))]
        free, lifting, sliding = over[len(equal) : len(equal) + 3]
        blocks.append(-free)
        if free.shape[0]:
            self.cones.append(clarabel.NonnegativeConeT(free.shape[0]))
        dilated = diags_array(np.repeat(contact.dilatancy[self._dilatant], dim)) @ sliding
        blocks.append(-interleaved(lifting, 1, csr_matrix(dilated), dim))
        self.cones += [clarabel.SecondOrderConeT(1 + dim)] * lifting.shape[0]
        for law, rows, norm in zip(normed, over[len(equal) + 3 :], norms[:-1], strict=True):
            own = np.arange(law.weights.size)
            bound = csr_matrix((np.ones(own.size), (own, norm + own)), (own.size, columns))
            blocks.append(-interleaved(bound, 1, rows, law.dim))
            self.cones += [clarabel.SecondOrderConeT(1 + law.dim)] * own.size
        self._sizes = [block.shape[0] for block in blocks]
        self.matrix = csr_matrix(vstack(blocks, format="csr"))
        soft = [np.repeat(law.weights, law.dim) for law in laws if law.softened]
        own = np.arange(first, columns)
        self._soft = np.concatenate([*soft, np.zeros(0)])
        self.quadratic = csr_matrix((self._soft, (own, own)), (columns, columns))

    def cost(self, contact: FrozenContact) -> Floats:
        """q: dead load, stress bounds, friction bounds."""
        bounds = [group.bound for group in self._program.groups]
        given = [-self._program.dead_load, *bounds, contact.bound[self._pattern.friction]]
        q = np.zeros(self.matrix.shape[1])
        np.concatenate(given, out=q[: sum(part.size for part in given)])
        return q

    def offset(self, contact: FrozenContact) -> Floats:
        """b: ``F0.U = 1`` and the shifts of the contact rows."""
        points = self._program.contact
        shift = points.weights * contact.shift
        cones = np.zeros((int(self._dilatant.sum()), 1 + points.tangent_dim))
        cones[:, 0] = shift[self._dilatant]
        b = np.zeros(self.matrix.shape[0])
        b[0] = 1.0
        first = self.cones[0].dim
        given = [shift[~self._dilatant], cones.ravel()]
        np.concatenate(given, out=b[first : first + sum(part.size for part in given)])
        return b

    def point(self, x: Floats, z: Floats, contact: FrozenContact) -> ProgramState:
        """Velocity and duals in the signs of `ProgramState` (T35)."""
        program, pattern, dilatant = self._program, self._pattern, self._dilatant
        load, *duals = np.split(z, np.cumsum(self._sizes)[:-1])
        count, width = len(program.groups), 1 + program.contact.tangent_dim
        extra = 0 if self._penalty is None else 1  # softened, theta is a row of the norm too
        stick, plain, pressed = duals[count : count + 3]
        cones = pressed.reshape(-1, width)
        normal = np.zeros(program.contact.count)
        tangential = np.zeros((normal.size, width - 1))
        normal[~dilatant] = plain
        normal[dilatant] = cones[:, 0]
        tangential[dilatant] = contact.dilatancy[dilatant, None] * cones[:, 1:]
        tangential[pattern.stick] -= stick.reshape(-1, width - 1)
        tangential[pattern.friction] += duals[-1].reshape(-1, width)[:, 1:]
        stresses, means = [], []
        for group, mean, strain in zip(program.groups, duals, duals[count + 3 : -1], strict=False):
            shear = -strain.reshape(-1, 1 + group.dim + extra)[:, 1:]
            stresses.append(shear[:, : group.dim])
            means.append(mean + group.volumetric_factor * shear[:, group.dim :].sum(axis=1))
        return ProgramState(
            velocity=x[: program.n],
            load_factor=-float(load[0]),
            stress=tuple(stresses),
            mean_stress=tuple(means),
            normal_reaction=normal,
            tangential_reaction=tangential,
        )

    def complementary_energy(self, z: Floats) -> float:
        """``sum stress^2/(2 K)`` of the duals; at a solution C, the energy of the velocity."""
        stress = (self.matrix.T @ z)[self.matrix.shape[1] - self._soft.size :]
        return float(np.sum(stress**2 / self._soft)) / 2


def _wide(rows: Sparse, columns: int) -> Sparse:
    """The same rows with empty columns appended."""
    return csr_matrix((rows.data, rows.indices, rows.indptr), (rows.shape[0], columns))
