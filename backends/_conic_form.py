"""The kinematic program as cones (T34), exact or regularised (T17-T20). Not a backend.

``minimise x.P x/2 + q.x  subject to  A x + z = b, z in cones`` with x = (U, t, tau, y): one t a
plasticity cone, one tau a friction cone. Rows are multiplied by their integration weight, so that
costs are stress bounds and duals are stresses. Hardening (T29) is a quadratic cost of the t. Where
strength depends on pressure the t of a cone is a sum of multipliers, one of each surface (T39), a
modulus beside surfaces a quadratic cost of the velocity, and rows of small points are in units of
their own (`backends._surface_rows`). So are rows of contact points that stand for much less length
than others, where a program hardens: along a path sides overlap by short parts of their edges.

A dilatant point of one row is two half-spaces, ``u_n - d u_t >= 0`` and ``u_n + d u_t >= 0``: on
walls of rigid blocks a fifth faster than its cone. With ``|v| <= t`` it is the other way round: as
half-spaces 5 to 10 % faster, and the gap that is left is 10 to 70 times that of the cone.

Regularised, every row v of a law becomes ``v - e`` with an elastic share e and its energy
``K e^2/2``, K the stiffness: ``min bound ||v - e|| + K ||e||^2/2`` is the Huber law of T17 and T18,
and with a constraint in place of the norm it is a penalty. The duals are the stresses still, and
e = stress/K. The y are e sqrt(K): of the size of the square root of an energy for every r.
"""

from dataclasses import dataclass
from typing import Any

import clarabel
import numpy as np
from scipy.sparse import csc_matrix, csr_matrix, diags_array, identity, triu, vstack

from backends._surface_rows import Leads, Volumes, point_units, stress_besides
from lacore.arrays import Bools, Floats, Ints, Sparse
from lacore.program import POWER, FrozenContact, KinematicProgram, interleaved
from lacore.regularization import Penalties
from lacore.state import ProgramState

_GENTLE = 0.08  # slope of a surface: friction of 5 degrees
_TIED = 2.0  # unknowns per point: programs of stresses have more, and stall at other units
_SHORT = 0.25  # of the median weight of contact points: rows of shorter ones are scaled up to it
_SPEED = 10.0  # velocities of soil for 1 of the program: with it rows of points are near 1


@dataclass(frozen=True)
class Pattern:
    """Which contact points need which rows; a form is rebuilt only when it changes."""

    friction: Bools  # cost g ||u_t||; where g = 0 the dual cone would have no interior
    stick: Bools  # u_t = 0
    dilatancy: Floats

    @classmethod
    def of(cls, contact: FrozenContact) -> "Pattern":
        """That of a frozen contact."""
        return cls(
            friction=np.isfinite(contact.bound) & (contact.bound > 0),
            stick=np.isinf(contact.bound),
            dilatancy=contact.dilatancy.copy(),
        )

    def same(self, other: "Pattern") -> bool:
        """Whether the other one needs the same rows."""
        return (
            np.array_equal(self.friction, other.friction)
            and np.array_equal(self.stick, other.stick)
            and np.array_equal(self.dilatancy, other.dilatancy)
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
        wide = _wide(self.rows, columns, weights)
        if not self.softened:
            return wide
        own = np.arange(weights.size)
        share = weights / np.sqrt(self.stiffness)
        return csr_matrix(wide - csr_matrix((share, (own, first + own)), wide.shape))


@dataclass(frozen=True)
class _Norm:
    """Cones ``||follow|| <= lead``, `count` of them, with `dim` rows of `follow` in each.

    Attributes:
        linear: they are pairs of half-spaces, of one row.
    """

    count: int
    dim: int
    linear: bool = False

    @property
    def cones(self) -> list[Any]:
        """Those of Clarabel."""
        return [] if self.linear else [clarabel.SecondOrderConeT(1 + self.dim)] * self.count

    def rows(self, lead: Sparse, follow: Sparse) -> Sparse:
        """The rows whose values are in the cones."""
        if self.linear:
            return csr_matrix(vstack([lead - follow, lead + follow]))
        return interleaved(lead, 1, follow, self.dim)

    def offset(self, lead: Floats) -> Floats:
        """What is added to the rows where `lead` is added to the lead."""
        if self.linear:
            return np.concatenate([lead, lead])
        return np.column_stack([lead, np.zeros((self.count, self.dim))]).ravel()

    def duals(self, z: Floats) -> Floats:
        """Multipliers of lead and follow, shape (count, 1 + dim)."""
        if self.linear:
            below, above = z.reshape(2, -1)
            return np.column_stack([below + above, above - below])
        return z.reshape(-1, 1 + self.dim)


class ConicForm:
    """The form for one pattern of contact rows; no penalties: exact.

    Attributes:
        quadratic, matrix, cones: P, A and the cones.
        linear: whether it could be written as a linear program.
        hardens: whether lengths of strain rates have a quadratic cost.
        presses: whether strength depends on pressure.
        gentle: whether somewhere so little that it hardly does.
        cornered: whether somewhere several surfaces bound it.
        even: whether every surface has some strength without pressure, and velocities are those of
            a body; they are in units then in which rows of points are as large as stresses.
        speed: velocities of the form for 1 of the program. The least value is as many times as
            large; `offset` is divided by it where a program is to be written as it is.
        order: of the columns as a solver is to see them. Multipliers of several surfaces come
            before velocities: an ordering by least degree breaks its ties well then.
    """

    def __init__(
        self,
        program: KinematicProgram,
        contact: FrozenContact,
        pattern: Pattern,
        penalty: Penalties | None,
    ) -> None:
        self._program, self._pattern = program, pattern
        self.hardens, self.presses = program.hardens, program.presses
        pressed = [group.surfaces for group in program.groups if group.surfaces is not None]
        self.gentle = any(np.any((one.slope > 0) & (one.slope < _GENTLE)) for one in pressed)
        self.cornered = any(one.count > 1 for one in pressed)
        strong = all(bool(np.all(one.strength > 0)) for one in pressed)
        simple = not (self.hardens or self.gentle or self.cornered)
        tied = program.n <= _TIED * sum(group.weights.size for group in program.groups)
        self.even = bool(pressed) and strong and simple and tied and penalty is None
        self.speed = _SPEED if self.even else 1.0
        points, dim = program.contact, program.contact.tangent_dim
        stiff = penalty or Penalties(np.inf, np.inf, np.inf, np.inf)
        self._dilatant = contact.dilatancy > 0
        self._gain = np.ones(points.count)
        if self.hardens and penalty is None:
            self._gain = _gains(points.weights)
        lengths = points.weights * self._gain

        def slip(mask: Bools) -> _Law:
            rows = points.tangential[np.repeat(mask, dim)]
            return _Law(rows, dim, lengths[mask], stiff.tangential)

        def opening(mask: Bools) -> _Law:
            return _Law(points.normal[mask], 1, lengths[mask], stiff.normal)

        self._units = [
            point_units(g) if penalty is None else np.ones(g.weights.size) for g in program.groups
        ]
        groups = list(zip(program.groups, self._units, strict=True))
        self._volumes = [Volumes.of(g, unit, soft=penalty is not None) for g, unit in groups]
        volumes = [_Law(own.rows, 1, own.weights, stiff.bulk) for own in self._volumes]
        strains = [
            _Law(g.rows, g.dim, g.weights / unit, stiff.eta)
            if penalty is None or g.surfaces is not None or not own.weights.size
            else _Law(
                interleaved(g.rows, g.dim, g.volumetric * g.volumetric_factor, 1),
                g.dim + 1,
                g.weights,
                stiff.eta,
            )
            for (g, unit), own in zip(groups, self._volumes, strict=True)
        ]
        equal = [*volumes, slip(pattern.stick)]
        unilateral = [opening(~self._dilatant), opening(self._dilatant), slip(self._dilatant)]
        normed = [*strains, slip(pattern.friction)]
        laws = [*equal, *unilateral, *normed]

        leads = [
            *(Leads.of(group) for group in program.groups),
            Leads.plain(int(pattern.friction.sum())),
        ]
        norms = program.n + np.cumsum([0, *(lead.shares.shape[1] for lead in leads)])
        first = int(norms[-1])
        starts = first + np.cumsum([0, *(law.softened for law in laws)])
        columns = int(starts[-1])
        every = np.arange(columns)
        self.order: Ints | slice = np.roll(every, -program.n) if self.cornered else slice(None)
        over = [law.over(columns, int(start)) for law, start in zip(laws, starts[:-1], strict=True)]
        load = _wide(csr_matrix(program.reference_load[None, :]), columns, np.ones(1))
        free, lifting, sliding = over[len(equal) : len(equal) + 3]
        dilated = diags_array(np.repeat(contact.dilatancy[self._dilatant], dim)) @ sliding
        self._norms = [_Norm(lifting.shape[0], dim, linear=dim == 1)]
        normed_rows = [self._norms[0].rows(lifting, csr_matrix(dilated))]
        positive: list[Sparse] = []
        for number, (law, rows) in enumerate(zip(normed, over[len(equal) + 3 :], strict=True)):
            lead, first_own = leads[number], int(norms[number])
            self._norms.append(_Norm(law.weights.size, law.dim))
            normed_rows.append(self._norms[-1].rows(_placed(lead.shares, columns, first_own), rows))
            if lead.slopes is not None:
                slopes = csr_matrix(diags_array(self._volumes[number].gain) @ lead.slopes)
                over[number] = csr_matrix(over[number] - _placed(slopes, columns, first_own))
            if lead.slopes is not None and not (lead.single and self.even):
                each = csr_matrix(identity(lead.shares.shape[1]))
                positive.append(_placed(each, columns, first_own))
        free = csr_matrix(vstack([free, *positive])) if positive else free
        blocks = [load, *over[: len(equal)], -free, *(-rows for rows in normed_rows)]
        self._ends = np.cumsum([block.shape[0] for block in blocks])
        self.matrix = csc_matrix(vstack(blocks, format="csc"))
        flat = free.shape[0] + sum(2 * norm.count for norm in self._norms if norm.linear)
        self.cones: list[Any] = [clarabel.ZeroConeT(int(self._ends[len(equal)]))]
        self.cones += [clarabel.NonnegativeConeT(flat)] if flat else []
        for norm in self._norms:
            self.cones += norm.cones
        gains = [own.gain for own in self._volumes]
        gains += [np.ones(law.weights.size) for law in laws[len(groups) :]]
        soft = [
            np.repeat(law.weights / gain, law.dim)
            for law, gain in zip(laws, gains, strict=True)
            if law.softened
        ]
        # The t are lengths times weights per unit: w h (t unit/w)^2/2.
        rising = [
            np.zeros(lead.shares.shape[1])
            if lead.slopes is not None
            else group.rise * unit**2 / group.weights
            for group, unit, lead in zip(program.groups, self._units, leads[:-1], strict=True)
        ]
        still = np.zeros(first - program.n - sum(part.size for part in rising))
        diagonal = np.concatenate([np.zeros(program.n), *rising, still, *soft])
        own = np.flatnonzero(diagonal)
        self.quadratic = csc_matrix((diagonal[own], (own, own)), (columns, columns))
        for group in program.groups:
            # Beside surfaces the t are no lengths: where flow is that of a corner they are more.
            if group.surfaces is not None and group.modulus is not None:
                root = np.repeat(np.sqrt(group.weights * group.modulus), group.dim)
                spring = _wide(group.rows, columns, root)
                self.quadratic = csc_matrix(self.quadratic + triu(spring.T @ spring))
        self.linear = (
            not self.hardens
            and penalty is None
            and all(norm.dim == 1 for norm in self._norms if norm.count)
        )

    def ordered(self) -> tuple[Any, Any]:
        """P and A with their columns in `order`."""
        quadratic: Any = self.quadratic
        matrix: Any = self.matrix
        return quadratic[self.order][:, self.order], matrix[:, self.order]

    def cost(self, contact: FrozenContact) -> Floats:
        """q: dead load, stress bounds, friction bounds."""
        bounds = [
            group.bound * unit
            if group.surfaces is None
            else (group.surfaces.strength * unit[:, None]).ravel()
            for group, unit in zip(self._program.groups, self._units, strict=True)
        ]
        rubbing = (contact.bound / self._gain)[self._pattern.friction]
        given = [-self._program.dead_load, *bounds, rubbing]
        q = np.zeros(self.matrix.shape[1])
        np.concatenate(given, out=q[: sum(part.size for part in given)])
        return q

    def offset(self, contact: FrozenContact) -> Floats:
        """b: ``F0.U = 1``, dilations, and the shifts of the contact rows."""
        shift = self._program.contact.weights * self._gain * contact.shift
        b = np.zeros(self.matrix.shape[0])
        b[0] = POWER
        volumes = np.split(b, self._ends)[1:]
        for group, own, part in zip(self._program.groups, self._volumes, volumes, strict=False):
            if group.surfaces is not None:
                part[:] = own.weights * group.surfaces.besides
        free, dilatant = np.split(b, self._ends)[len(self._program.groups) + 2 :][:2]
        free[: shift.size - int(self._dilatant.sum())] = shift[~self._dilatant]
        dilatant[:] = self._norms[0].offset(shift[self._dilatant])
        return b * self.speed

    def point(self, x: Floats, z: Floats, contact: FrozenContact) -> ProgramState:
        """Velocity and duals in the signs of `ProgramState` (T35)."""
        program, pattern, dilatant = self._program, self._pattern, self._dilatant
        velocity = x[: program.n] / self.speed
        load, *duals = np.split(z, self._ends[:-1])
        count, dim = len(program.groups), program.contact.tangent_dim
        means, (stick, plain), rest = duals[:count], duals[count : count + 2], duals[count + 2 :]
        pressed, *strains, rubbed = (
            norm.duals(part) for norm, part in zip(self._norms, rest, strict=True)
        )
        normal = np.zeros(program.contact.count)
        tangential = np.zeros((normal.size, dim))
        normal[~dilatant] = plain[: int((~dilatant).sum())]  # what follows is of surfaces
        normal[dilatant] = pressed[:, 0]
        tangential[dilatant] = contact.dilatancy[dilatant, None] * pressed[:, 1:]
        tangential[pattern.stick] -= stick.reshape(-1, dim)
        tangential[pattern.friction] += rubbed[:, 1:]
        normal, tangential = normal * self._gain, tangential * self._gain[:, None]
        stresses, mean_stresses = [], []
        of_groups = (self._volumes, self._units, means, strains)
        for group, own, unit, mean, strain in zip(program.groups, *of_groups, strict=True):
            shear = -strain[:, 1:] / unit[:, None]
            stresses.append(shear[:, : group.dim] + stress_besides(group, velocity))
            # Softened, theta is a row of the norm too.
            softened = group.volumetric_factor * shear[:, group.dim :].sum(axis=1)
            mean_stresses.append(np.repeat(softened, group.volumes) + own.means @ mean)
        return ProgramState(
            velocity=velocity,
            load_factor=-float(load[0]),
            stress=tuple(stresses),
            mean_stress=tuple(mean_stresses),
            normal_reaction=normal,
            tangential_reaction=tangential,
        )

    def complementary_energy(self, z: Floats, contact: FrozenContact) -> float:
        """``sum stress^2/(2 K) + (stress - bound)^2/(2 modulus)`` of the duals.

        At a solution the energy C of the velocity, and what hardening adds to it.
        """
        curvature = self.quadratic.diagonal()
        own = np.flatnonzero(curvature)
        rest = (self.matrix.T @ z + self.cost(contact))[own]
        return float(np.sum(rest**2 / curvature[own])) / 2


def _gains(weights: Floats) -> Floats:
    """Factors of the rows of contact points, 1 of those that are not short, shape (m,).

    A row that is small beside the regularisation of a solver keeps its residual: points of a
    fiftieth of the length of others penetrate by 1e-6 of the largest velocity.
    """
    return np.maximum(1.0, _SHORT * np.median(weights) / weights) if weights.size else weights


def _placed(rows: Sparse, columns: int, first: int) -> Sparse:
    """Rows over all columns, their own from column `first` on."""
    return csr_matrix((rows.data, rows.indices + first, rows.indptr), (rows.shape[0], columns))


def _wide(rows: Sparse, columns: int, weights: Floats) -> Sparse:
    """The rows times their weights, with empty columns appended, and without zeros."""
    # By its arrays: products of matrices would take half of the time of a small solve.
    data = rows.data * np.repeat(weights, np.diff(rows.indptr))
    wide = csr_matrix((data, rows.indices, rows.indptr), (rows.shape[0], columns))
    if not np.all(data):
        wide = wide.copy()  # zeros are cut out of arrays that are those of the program
        wide.eliminate_zeros()
    return wide
