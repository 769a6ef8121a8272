"""The kinematic program (T6), the arrays and sparse matrices that a backend receives.

minimise   sum_g w_g (c_g ||D_g U|| + h_g ||D_g U||^2/2) + sum_j w_j g_j ||T_j U|| - Fd.U
subject to F0.U = 1,  theta_g U = 0,  N_j U + s_j >= d_j ||T_j U||

with g_j, d_j, s_j frozen for one inner solve (`FrozenContact`), and h_g = 0 outside a path (T29).
If strength depends on pressure, the surfaces of a group (T39) replace c_g and ``theta_g U = 0``;
see `lacore.program.surfaces`. Loops freeze non-associated flow, so backends get associated flow.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from warnings import warn

import numpy as np
from scipy.sparse import csr_matrix

from lacore.numerics.arrays import Bools, Floats, Ints, Sparse
from lacore.numerics.interleaving import interleaved as interleaved
from lacore.numerics.read_only import make_read_only
from lacore.program.dissipation import DissipationGroup as DissipationGroup
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact


@dataclass(frozen=True, repr=False)
class Scales(Compact):
    """Units in which a program is written: SI value = scale * program value.

    Attributes:
        length: m.
        stress: Pa.
        velocity: m/s.
        thickness: m; 1 where everything is per unit thickness.
    """

    length: float = 1.0
    stress: float = 1.0
    velocity: float = 1.0
    thickness: float = 1.0

    @property
    def force(self) -> float:
        """Force, N; per unit thickness N/m."""
        return self.stress * self.length * self.thickness

    @property
    def load_factor(self) -> float:
        """Load factor: that of a power at ``F0.U = 1``."""
        return self.force * self.velocity


SI = Scales()  # nothing is scaled
POWER = 1.0  # F0.U of every program, so that its least value is the load factor (T6)


@dataclass(frozen=True, repr=False)
class ContactRows(Compact):
    """Contact points of all interfaces (rows of T28).

    Attributes:
        normal: rows of u_n, shape (m, n).
        tangential: rows of u_t, shape (m tangent_dim, n).
        tangent_dim: rows in a tangential velocity.
        weights: areas, shape (m,), m^2; lengths, m, of plane bodies of unit thickness.
        coefficient, limit, dilatancy: the law ``||t_t|| <= coefficient t_n + limit``,
            ``u_n >= dilatancy ||u_t||``, each of shape (m,); limit in Pa, inf is stick.
        interface: number of the interface of each point, shape (m,).
        tension: strength T, Pa, (m,); None: none. All `t_n` are the real ones plus T (T66).
        closing: speed at which the distance that is left closes within a step of a path,
            ``u_n + closing >= 0``, shape (m,), m/s; None: all points touch.
    """

    normal: Sparse
    tangential: Sparse
    tangent_dim: int
    weights: Floats
    coefficient: Floats
    limit: Floats
    dilatancy: Floats
    interface: Ints
    tension: Floats | None = None
    closing: Floats | None = None

    @property
    def lead(self) -> Floats:
        """`closing`, zero where all points touch, shape (m,), m/s."""
        return np.zeros(self.count) if self.closing is None else self.closing

    @property
    def pull(self) -> Floats:
        """`tension`, zero where there is none, shape (m,), Pa."""
        return np.zeros(self.count) if self.tension is None else self.tension

    @cached_property
    def count(self) -> int:
        """Number of contact points m."""
        return int(self.weights.size)

    @property
    def coulomb(self) -> Bools:
        """Points whose friction bound follows the normal reaction, shape (m,)."""
        return self.coefficient > 0

    @cached_property
    def sizes(self) -> tuple[Sparse, Sparse]:
        """Sizes of the normal and the tangential rows, transposed: (n, m), (n, m tangent_dim)."""
        return csr_matrix(abs(self.normal).T), csr_matrix(abs(self.tangential).T)

    @cached_property
    def meeting(self) -> tuple[Ints, Ints]:
        """Which unknowns move at which contact point: points and unknowns, each pair once."""
        every = np.repeat(np.arange(self.count), self.tangent_dim)
        pick = csr_matrix(
            (np.ones(every.size), (every, np.arange(every.size))), (self.count, every.size)
        )
        pairs = csr_matrix(abs(self.normal) + pick @ abs(self.tangential)).tocoo()
        return pairs.row.astype(np.int64), pairs.col.astype(np.int64)

    def slip(self, velocity: Floats) -> Floats:
        """Tangential velocities, shape (m, tangent_dim)."""
        return np.asarray(self.tangential @ velocity).reshape(-1, self.tangent_dim)

    def opening(self, velocity: Floats) -> Floats:
        """Normal velocities, shape (m,)."""
        return np.asarray(self.normal @ velocity)


@dataclass(frozen=True, repr=False)
class FrozenContact(Compact):
    """Contact terms that the coupling loop freezes for one inner solve (T9-T11), shapes (m,).

    Attributes:
        bound: Friction bound g, Pa; inf for stick.
        dilatancy: Dilatancy d.
        shift: Shift s, m/s.

    Raises:
        InputError: A value is NaN, negative where it must not be, or infinite (other than bounds).
    """

    bound: Floats
    dilatancy: Floats
    shift: Floats

    def __post_init__(self) -> None:
        for name, good in {
            "bound": self.bound >= 0,
            "dilatancy": np.isfinite(self.dilatancy) & (self.dilatancy >= 0),
            "shift": np.isfinite(self.shift),
        }.items():
            if not np.all(good):
                value = float(getattr(self, name)[~good][0])
                fix = "look at the friction laws and at the reactions that it was made of"
                why = "no solver must see such a number"
                raise InputError(f"contact {name}", value, why, fix)


def reaction_contact(contact: ContactRows, normal_reaction: Floats) -> FrozenContact:
    """Freeze friction bounds at normal reactions, Pa, shape (m,) (T9)."""
    return family_contact(contact, 0.0, normal_reaction, np.zeros(contact.count))


def shift_contact(contact: ContactRows, slip_rate: Floats) -> FrozenContact:
    """Make every Coulomb point associated and shift it by its slip rate, m/s, shape (m,) (T10).

    Its multipliers maximise ``alpha - sum w mu slip_rate t_n`` over all admissible states.
    """
    return family_contact(contact, 1.0, np.zeros(contact.count), slip_rate)


def family_contact(
    contact: ContactRows, kappa: float, normal_reaction: Floats, slip_rate: Floats
) -> FrozenContact:
    """Freeze contact between `reaction_contact` and `shift_contact` (T11).

    Args:
        contact: Contact points.
        kappa: Share of the friction that dilates: 0 is `reaction_contact`, 1 is `shift_contact`.
        normal_reaction: Pa, shape (m,).
        slip_rate: ``||u_t||``, m/s, shape (m,).
    """
    dilating = kappa * contact.coefficient
    return FrozenContact(
        bound=contact.limit + (1 - kappa) * contact.coefficient * np.maximum(normal_reaction, 0.0),
        dilatancy=contact.dilatancy + dilating,
        shift=contact.lead + dilating * np.maximum(slip_rate, 0.0),
    )


def associated_contact(contact: ContactRows) -> FrozenContact:
    """Make every Coulomb point associated (T4); a single solve gives an upper bound (T14)."""
    return shift_contact(contact, np.zeros(contact.count))


def frictionless_contact(contact: ContactRows) -> FrozenContact:
    """Remove the friction of every Coulomb point; a single solve gives a lower bound (T14)."""
    return reaction_contact(contact, np.zeros(contact.count))


def stick_contact(contact: ContactRows) -> FrozenContact:
    """Prevent slip at every Coulomb point; a single solve gives an upper bound (T14)."""
    return replace(
        frictionless_contact(contact), bound=np.where(contact.coulomb, np.inf, contact.limit)
    )


@dataclass(frozen=True, repr=False)
class KinematicProgram(Compact):
    """The program (T6) for n velocity unknowns; immutable and independent of a mesh.

    Attributes:
        groups: Groups of dissipation.
        contact: Contact points.
        reference_load, dead_load: F0 and Fd, shape (n,), N/m.
        scales: Units.
        parts: Number of the body, rigid block or frame of each unknown, shape (n,); None for one.
    """

    groups: tuple[DissipationGroup, ...]
    contact: ContactRows
    reference_load: Floats
    dead_load: Floats
    scales: Scales = SI
    parts: Ints | None = None

    def __post_init__(self) -> None:
        make_read_only(self)

    @property
    def part(self) -> Ints:
        """`parts`, or zeros without them, shape (n,)."""
        return np.zeros(self.n, dtype=np.int64) if self.parts is None else self.parts

    @property
    def held_shut(self) -> Floats:
        """Part of `dead_load` that represents the tensile strength of contact, shape (n,)."""
        return np.asarray(-(self.contact.normal.T @ (self.contact.weights * self.contact.pull)))

    @cached_property
    def n(self) -> int:
        """Number of velocity unknowns."""
        return int(self.reference_load.size)

    @property
    def largest_cone(self) -> int:
        """Largest number of rows in a norm; 1 for a linear program."""
        dims = [group.dim for group in self.groups if group.weights.size]
        return max([*dims, self.contact.tangent_dim if self.contact.count else 0])

    @cached_property
    def hardens(self) -> bool:
        """Whether a group has a modulus."""
        return any(group.modulus is not None for group in self.groups)

    @cached_property
    def pressure_dependent(self) -> bool:
        """Whether the strength of a group depends on pressure."""
        return any(group.surfaces is not None for group in self.groups)

    @property
    def presses(self) -> bool:
        """The name of `pressure_dependent` until 0.4."""
        warn("presses is now pressure_dependent", DeprecationWarning, stacklevel=2)
        return self.pressure_dependent

    @cached_property
    def frictional(self) -> bool:
        """Whether a group has non-associated flow (T49)."""
        return any(group.frictional for group in self.groups)

    @property
    def associated_flow(self) -> bool:
        """Whether neither contact points nor groups have friction without dilation (T4)."""
        return not (self.contact.coulomb.any() or self.frictional)

    def friction(self, means: tuple[Floats, ...]) -> Floats:
        """Return the friction of the cones of groups with non-associated flow, Pa (T50)."""
        return np.concatenate([np.zeros(0), *map(DissipationGroup.friction, self.groups, means)])

    def _shares(self, friction: Floats | float) -> "zip[tuple[DissipationGroup, Floats]]":
        ends = np.cumsum([0, *(group.frictions for group in self.groups)])
        parts = np.split(np.broadcast_to(friction, ends[-1]), ends[1:])[:-1]
        return zip(self.groups, parts, strict=True)

    def at_friction(self, friction: Floats | float) -> "KinematicProgram":
        """Return the program with frozen friction of groups, see `friction` (T52)."""
        groups = tuple(own.at_friction(part) for own, part in self._shares(friction))
        return replace(self, groups=groups) if self.frictional else self

    def at_flow(self, velocity: Floats, friction: Floats) -> "KinematicProgram":
        """Return the program with the flow of groups frozen at a velocity and friction (T52)."""
        groups = tuple(own.at_flow(velocity, part) for own, part in self._shares(friction))
        return replace(self, groups=groups) if self.frictional else self

    def associated(self) -> "KinematicProgram":
        """Return the program with flow of all groups normal to their surfaces."""
        groups = tuple(group.associated() for group in self.groups)
        return replace(self, groups=groups) if self.frictional else self

    def hardened(self, velocity: Floats) -> "KinematicProgram":
        """Return the program at the bounds of a velocity, see `DissipationGroup.hardened`."""
        groups = tuple(group.hardened(velocity) for group in self.groups)
        return replace(self, groups=groups) if self.hardens else self

    def at_state(self, velocity: Floats, means: tuple[Floats, ...]) -> "KinematicProgram":
        """Return the program at the stress bounds and friction of a state, where it is exact."""
        return self.hardened(velocity).at_friction(self.friction(means))

    @cached_property
    def homogeneous(self) -> bool:
        """Whether costs grow linearly with the velocity, as in a limit problem (T5)."""
        return not self.hardens and self.contact.closing is None

    def plastic_dissipation(self, velocity: Floats) -> float:
        """Return the dissipation of all groups at a velocity."""
        return float(sum(group.dissipation(velocity).sum() for group in self.groups))

    def friction_dissipation(self, velocity: Floats, bound: Floats) -> float:
        """Return the dissipation of contact points at friction bounds; stick points have none."""
        slip, finite = np.linalg.norm(self.contact.slip(velocity), axis=1), np.isfinite(bound)
        return float(np.sum((self.contact.weights * slip)[finite] * bound[finite]))


def require_finite(program: KinematicProgram) -> None:
    """Raise `InputError` if a program holds NaN or infinity (a limit of inf is stick)."""
    contact = program.contact
    arrays = {
        "reference_load": program.reference_load,
        "dead_load": program.dead_load,
        "contact.normal": contact.normal.data,
        "contact.tangential": contact.tangential.data,
        "contact.limit": np.where(np.isposinf(contact.limit), 0.0, contact.limit),
        **{
            f"contact.{name}": getattr(contact, name)
            for name in ("weights", "coefficient", "dilatancy", "lead", "pull")
        },
    }
    for group in program.groups:
        arrays |= {
            f"group {group.name!r} {name}": values
            for name, values in {
                "rows": group.rows.data,
                "weights": group.weights,
                "bound": group.bound,
                "volumetric": group.volumetric.data,
                "modulus": np.zeros(0) if group.modulus is None else group.modulus,
                **({} if group.surfaces is None else group.surfaces.numbers),
            }.items()
        }
    for name, values in arrays.items():
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            raise InputError(
                f"program {name}",
                float(values[bad[0]]),
                f"{bad.size} of {values.size} numbers are not finite",
                "look at the mesh, the strengths and the loads that it was assembled from",
            )


def require_homogeneous(program: KinematicProgram, field: str, fix: str) -> None:
    """Raise `InputError` for a program of a step of a path, which has a given speed."""
    if not program.homogeneous:
        why = "a state within a step of a path hardens, or closes a distance, at a given speed"
        raise InputError(field, None, why, fix)


def dimensionless(program: KinematicProgram, scales: Scales) -> KinematicProgram:
    """Write an SI program in other units, in which the tolerances of backends have one meaning."""
    contact = program.contact
    return replace(
        program,
        groups=tuple(
            replace(
                group,
                rows=group.rows * scales.length,
                volumetric=group.volumetric * scales.length,
                weights=group.weights / (scales.length**2 * scales.thickness),
                bound=group.bound / scales.stress,
                surfaces=None
                if group.surfaces is None
                else group.surfaces.times(1 / scales.stress, scales.length / scales.velocity),
                modulus=None
                if group.modulus is None
                else group.modulus * (scales.velocity / (scales.length * scales.stress)),
            )
            for group in program.groups
        ),
        contact=replace(
            contact,
            weights=contact.weights / (scales.length * scales.thickness),
            limit=contact.limit / scales.stress,
            tension=None if contact.tension is None else contact.tension / scales.stress,
            closing=None if contact.closing is None else contact.closing / scales.velocity,
        ),
        reference_load=program.reference_load * scales.velocity,
        dead_load=program.dead_load / scales.force,
        scales=scales,
    )
