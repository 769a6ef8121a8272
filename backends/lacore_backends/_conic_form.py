"""Kinematic program as cones (T34), exact or regularised (T17-T20). Not a backend.

``minimise x.P x/2 + q.x  subject to  A x + z = b, z in cones`` with x = (U, t, tau, y): there is
one t per plasticity cone and one tau per friction cone. Rows are multiplied by their integration
weights, so that costs are stress bounds and duals are stresses. Hardening (T29) is a quadratic cost
of t. Where strength depends on pressure, the t of a cone is a sum of multipliers, one of each
surface (T39), and a modulus in addition to surfaces is a quadratic cost of the velocity. Rows of
small points are scaled (`lacore_backends._surface_rows`). So are rows of contact points that
represent much less length than others, where a program hardens: along a path, sides overlap by
short parts of their edges.

A dilatant point of one row is two half-spaces, ``u_n - d u_t >= 0`` and ``u_n + d u_t >= 0``. On
walls of rigid blocks this is 20 % faster than its cone. For ``|v| <= t`` the cone is preferred:
half-spaces are 5 to 10 % faster, but their final gap is 10 to 70 times that of the cone.

In a regularised program every row v of a law becomes ``v - e`` with an elastic share e and its
energy ``K e^2/2``, where K is the stiffness: ``min bound ||v - e|| + K ||e||^2/2`` is the Huber law
of T17 and T18, and with a constraint in place of the norm it is a penalty. The duals are still the
stresses, and e = stress/K. The y are e sqrt(K), whose size is that of the square root of an energy
for every r.
"""

from dataclasses import dataclass
from typing import Any

import clarabel
import numpy as np
from scipy.sparse import csc_matrix, csr_matrix, diags_array, identity, triu, vstack

from lacore.numerics.arrays import Bools, Floats, Ints, Sparse
from lacore.program import POWER, FrozenContact, KinematicProgram
from lacore.program.regularization import Penalties
from lacore.program.state import ProgramState
from lacore_backends._conic_rows import Law, Norm, placed, strain_law, wide
from lacore_backends._surface_rows import Leads, Volumes, point_units, stress_besides

_GENTLE = 0.08  # slope of a surface with friction of 5 degrees
_TIED = 2.0  # unknowns per point: programs of stresses have more, and stall in other units
_SHORT = 0.25  # weight of contact points, by the median, up to which rows are scaled
_SPEED = 10.0  # velocities of soil per unit of the program, so that rows of points are near 1


@dataclass(frozen=True)
class Pattern:
    """Kinds of rows of the contact points; a form is rebuilt only when they change."""

    friction: Bools  # The cost is g ||u_t||; with g = 0 the dual cone would have no interior.
    stick: Bools  # u_t = 0
    dilatancy: Floats

    @classmethod
    def of(cls, contact: FrozenContact) -> "Pattern":
        """Return the pattern of a frozen contact."""
        return cls(
            friction=np.isfinite(contact.bound) & (contact.bound > 0),
            stick=np.isinf(contact.bound),
            dilatancy=contact.dilatancy.copy(),
        )

    def same(self, other: "Pattern") -> bool:
        """Return whether the other pattern needs the same rows."""
        return (
            np.array_equal(self.friction, other.friction)
            and np.array_equal(self.stick, other.stick)
            and np.array_equal(self.dilatancy, other.dilatancy)
        )


@dataclass(frozen=True)
class Traits:
    """Properties of a form that its solver depends on.

    Attributes:
        hardens: whether lengths of strain rates have a quadratic cost.
        pressure_dependent: whether strength depends on pressure.
        gentle: whether this dependence is very small somewhere.
        cornered: whether several surfaces bound the strength somewhere.
        even: whether every surface has some strength without pressure, and the velocities are those
            of a body. The units are then chosen such that rows of points are as large as stresses.
    """

    hardens: bool
    pressure_dependent: bool
    gentle: bool
    cornered: bool
    even: bool

    @classmethod
    def of(cls, program: KinematicProgram, exact: bool) -> "Traits":
        """Return the properties of a program; no regularised form is even."""
        surfaces = [group.surfaces for group in program.groups if group.surfaces is not None]
        gentle = any(np.any((one.slope > 0) & (one.slope < _GENTLE)) for one in surfaces)
        cornered = any(one.count > 1 for one in surfaces)
        strong = all(bool(np.all(one.strength > 0)) for one in surfaces)
        simple = not (program.hardens or gentle or cornered)
        tied = program.n <= _TIED * sum(group.weights.size for group in program.groups)
        even = bool(surfaces) and strong and simple and tied and exact
        return cls(program.hardens, program.pressure_dependent, gentle, cornered, even)


@dataclass(frozen=True)
class _Laws:
    """Laws of a form in the order of their rows: equations, signs of openings, norms."""

    equal: list[Law]
    unilateral: list[Law]
    normed: list[Law]

    @property
    def all(self) -> list[Law]:
        return [*self.equal, *self.unilateral, *self.normed]


class ConicForm:
    """Form for one pattern of contact rows; exact without penalties.

    Attributes:
        quadratic, matrix, cones: P, A and the cones.
        traits: properties that its solver depends on.
        linear: whether it can be written as a linear program.
        speed: velocities of the form per unit of the program. The optimal value is multiplied by
            it; divide `offset` by it to write the program in its own units.
        order: order of the columns for a solver. Multipliers of several surfaces come before
            velocities, because minimum-degree orderings then break ties well.
    """

    def __init__(
        self,
        program: KinematicProgram,
        contact: FrozenContact,
        pattern: Pattern,
        penalty: Penalties | None,
    ) -> None:
        exact = penalty is None
        self._program, self._pattern = program, pattern
        self.traits = Traits.of(program, exact)
        self.speed = _SPEED if self.traits.even else 1.0
        self._dilatant = contact.dilatancy > 0
        weights = program.contact.weights
        self._gain = _gains(weights) if program.hardens and exact else np.ones(weights.size)
        self._units = [
            point_units(group) if exact else np.ones(group.weights.size) for group in program.groups
        ]
        groups = zip(program.groups, self._units, strict=True)
        self._volumes = [Volumes.of(group, unit, soft=not exact) for group, unit in groups]
        leads = [
            *(Leads.of(group) for group in program.groups),
            Leads.plain(int(pattern.friction.sum())),
        ]
        laws = self._laws(penalty)
        norms = program.n + np.cumsum([0, *(lead.shares.shape[1] for lead in leads)])
        starts = norms[-1] + np.cumsum([0, *(law.softened for law in laws.all)])
        columns = int(starts[-1])
        self.order: Ints | slice = slice(None)
        if self.traits.cornered:
            self.order = np.roll(np.arange(columns), -program.n)
        over = [
            law.over(columns, int(start)) for law, start in zip(laws.all, starts[:-1], strict=True)
        ]
        self._assemble(contact, laws, leads, over, norms)
        self.quadratic = self._quadratic(laws, leads, columns)
        flat = exact and not program.hardens
        self.linear = flat and all(norm.dim == 1 for norm in self._norms if norm.count)

    def _laws(self, penalty: Penalties | None) -> _Laws:
        """Return the laws of the program, softened by `penalty`."""
        points, dim = self._program.contact, self._program.contact.tangent_dim
        stiff = penalty or Penalties(np.inf, np.inf, np.inf, np.inf)
        lengths = points.weights * self._gain

        def slip(mask: Bools) -> Law:
            rows = points.tangential[np.repeat(mask, dim)]
            return Law(rows, dim, lengths[mask], stiff.tangential)

        def opening(mask: Bools) -> Law:
            return Law(points.normal[mask], 1, lengths[mask], stiff.normal)

        dilatant, pattern = self._dilatant, self._pattern
        groups = zip(self._program.groups, self._units, self._volumes, strict=True)
        volumes = [Law(own.rows, 1, own.weights, stiff.bulk) for own in self._volumes]
        strains = [
            strain_law(group, unit, stiff.eta, whole=penalty is not None and own.weights.size > 0)
            for group, unit, own in groups
        ]
        return _Laws(
            [*volumes, slip(pattern.stick)],
            [opening(~dilatant), opening(dilatant), slip(dilatant)],
            [*strains, slip(pattern.friction)],
        )

    def _assemble(
        self,
        contact: FrozenContact,
        laws: _Laws,
        leads: list[Leads],
        over: list[Sparse],
        norms: Ints,
    ) -> None:
        """Put the rows of the laws, over all columns, into the matrix and its cones.

        Args:
            contact: frozen contact with the dilatancy.
            laws: laws of the rows.
            leads: leads of the norms; the columns of each begin at its entry of `norms`.
            over: rows of each law.
            norms: first columns of the leads.
        """
        equations, columns = len(laws.equal), over[0].shape[1]
        equal, (free, lifting, sliding), normed = (
            over[:equations],
            over[equations : equations + 3],
            over[equations + 3 :],
        )
        dim = self._program.contact.tangent_dim
        dilated = diags_array(np.repeat(contact.dilatancy[self._dilatant], dim)) @ sliding
        self._norms = [Norm(lifting.shape[0], dim, linear=dim == 1)]
        rows_of_norms = [self._norms[0].rows(lifting, csr_matrix(dilated))]
        positive: list[Sparse] = []
        for number, (law, rows) in enumerate(zip(laws.normed, normed, strict=True)):
            lead, first = leads[number], int(norms[number])
            norm = Norm(law.weights.size, law.dim)
            self._norms.append(norm)
            rows_of_norms.append(norm.rows(placed(lead.shares, columns, first), rows))
            if lead.slopes is None:
                continue
            slopes = csr_matrix(diags_array(self._volumes[number].gain) @ lead.slopes)
            equal[number] = csr_matrix(equal[number] - placed(slopes, columns, first))
            if not (lead.single and self.traits.even):
                each = csr_matrix(identity(lead.shares.shape[1]))
                positive.append(placed(each, columns, first))
        free = csr_matrix(vstack([free, *positive])) if positive else free
        load = wide(csr_matrix(self._program.reference_load[None, :]), columns, np.ones(1))
        blocks = [load, *equal, -free, *(-rows for rows in rows_of_norms)]
        self._ends = np.cumsum([block.shape[0] for block in blocks])
        self.matrix = csc_matrix(vstack(blocks, format="csc"))
        flat = free.shape[0] + sum(2 * norm.count for norm in self._norms if norm.linear)
        self.cones: list[Any] = [clarabel.ZeroConeT(int(self._ends[equations]))]
        self.cones += [clarabel.NonnegativeConeT(flat)] if flat else []
        for norm in self._norms:
            self.cones += norm.cones

    def _quadratic(self, laws: _Laws, leads: list[Leads], columns: int) -> Any:
        """Return P, the quadratic cost of hardening and softening."""
        program, every = self._program, laws.all
        gains = [own.gain for own in self._volumes]
        gains += [np.ones(law.weights.size) for law in every[len(gains) :]]
        soft = [
            np.repeat(law.weights / gain, law.dim)
            for law, gain in zip(every, gains, strict=True)
            if law.softened
        ]
        # The t are lengths times weights in these units, so the cost is w h (t unit/w)^2/2.
        rising = [
            np.zeros(lead.shares.shape[1])
            if lead.slopes is not None
            else group.rise * unit**2 / group.weights
            for group, unit, lead in zip(program.groups, self._units, leads[:-1], strict=True)
        ]
        diagonal = np.zeros(columns)
        known = np.concatenate([np.zeros(program.n), *rising])
        diagonal[: known.size] = known
        diagonal[columns - sum(part.size for part in soft) :] = np.concatenate([*soft, np.zeros(0)])
        own = np.flatnonzero(diagonal)
        found = csc_matrix((diagonal[own], (own, own)), (columns, columns))
        for group in program.groups:
            # With several surfaces the t are not lengths: in a corner they are larger.
            if group.surfaces is not None and group.modulus is not None:
                root = np.repeat(np.sqrt(group.weights * group.modulus), group.dim)
                spring = wide(group.rows, columns, root)
                found = csc_matrix(found + triu(spring.T @ spring))
        return found

    def ordered(self) -> tuple[Any, Any]:
        """Return P and A with their columns in `order`."""
        quadratic: Any = self.quadratic
        matrix: Any = self.matrix
        return quadratic[self.order][:, self.order], matrix[:, self.order]

    def cost(self, contact: FrozenContact) -> Floats:
        """Return q: dead load, stress bounds and friction bounds."""
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
        """Return b: ``F0.U = 1``, dilations, and the shifts of the contact rows."""
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
        """Return velocity and duals with the signs of `ProgramState` (T35)."""
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
        normal[~dilatant] = plain[: int((~dilatant).sum())]  # groups with surfaces
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
            # In a softened law theta is a row of the norm, too.
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
        """Return ``sum stress^2/(2 K) + (stress - bound)^2/(2 modulus)`` of the duals.

        At a solution this is the energy C of the velocity plus the contribution of hardening.
        """
        curvature = self.quadratic.diagonal()
        own = np.flatnonzero(curvature)
        rest = (self.matrix.T @ z + self.cost(contact))[own]
        return float(np.sum(rest**2 / curvature[own])) / 2


def _gains(weights: Floats) -> Floats:
    """Return factors of the rows of contact points, 1 unless they are short, shape (m,).

    A row that is small compared with the regularisation of a solver keeps its residual: points of a
    fiftieth of the length of others would penetrate by 1e-6 of the largest velocity.
    """
    return np.maximum(1.0, _SHORT * np.median(weights) / weights) if weights.size else weights
