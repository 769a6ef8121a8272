"""Regularised dissipation and contact laws (T17-T20), corrected from the original publication.

Every rate-independent term ``bound ||v||`` becomes the least of a viscous energy
``stiffness ||v - v_p||^2 / 2`` and the dissipation ``bound ||v_p||`` (a Huber function), and one
that hardens (T29) keeps its ``modulus ||v_p||^2 / 2`` in addition to the dissipation.
Incompressibility and contact become penalties. If strength depends on pressure, one law replaces
both, with an elastic share of all rates (T65). All quantities are in the units of the program.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.program.dissipation import DissipationGroup
from lacore.program.kinematic import FrozenContact, KinematicProgram, Scales
from lacore.program.state import ProgramState
from lacore.program.surfaces import Surfaces
from lacore.reporting.errors import InputError, is_number, require_positive
from lacore.reporting.showing import Compact
from lacore.reporting.status import Status

_ESCAPED = 1e8  # dimensionless velocity at F0.U = 1: that of a mechanism is 1 to 1000
_SMALLEST_R = 1e-8
_LOCKED_SHARE = 0.8  # of the power; about 0.04 for a mechanism at r = 0.1, 1 for a locked body
_LOCKED_POWER = 1.0  # dimensionless: below it the load is small, whatever carries it


@dataclass(frozen=True, repr=False)
class Penalties(Compact):
    """Viscosity and penalties in the units of the program (T17, T18).

    Attributes:
        eta: fictitious viscosity; ``eta ||e||^2`` below the yield threshold.
        bulk: K_c; ``bulk theta^2 / 2``.
        normal, tangential: K_n and K_t; ``K u^2 / 2``.
    """

    eta: float
    bulk: float
    normal: float
    tangential: float

    def of_rates(self, volumes: int) -> Floats:
        """Stiffness of ``||d||`` and of volumetric rates (T65), shape (1 + volumes,)."""
        return np.append(self.eta, np.full(volumes, self.bulk))

    def softened(self, factor: float) -> "Penalties":
        """All four multiplied by a factor."""
        return Penalties(
            self.eta * factor, self.bulk * factor, self.normal * factor, self.tangential * factor
        )

    def continuation(self, reduction: float) -> list["Penalties"]:
        """Penalties from r = 1, where the energy is close to quadratic, to these in equal ratios.

        Args:
            reduction: ratio of r between two steps, 0 < reduction < 1.

        Raises:
            InputError: reduction outside (0, 1).
        """
        if not (is_number(reduction) and 0 < reduction < 1):
            raise InputError("reduction", reduction, "outside (0, 1)", "give e.g. 0.1")
        steps = max(math.ceil(math.log(self.eta) / -math.log(reduction) - 1e-9), 0)
        return [self.softened(reduction**step) for step in range(steps, -1, -1)]


def check_penalties(
    r: float,
    eta: float | None,
    bulk: float | None,
    normal: float | None,
    tangential: float | None,
) -> None:
    """Raise `InputError` unless these can be arguments of `penalties`."""
    for name, value in {
        "r": r,
        "eta": eta,
        "bulk": bulk,
        "normal": normal,
        "tangential": tangential,
    }.items():
        if value is not None:
            require_positive(name, value)
    if not _SMALLEST_R <= r <= 1:
        raise InputError(
            "r",
            r,
            f"outside [{_SMALLEST_R:g}, 1]",
            "above 1 nothing of the plasticity is left, below, nothing of the precision",
        )


def penalties(
    scales: Scales,
    r: float,
    eta: float | None = None,
    bulk: float | None = None,
    normal: float | None = None,
    tangential: float | None = None,
) -> Penalties:
    """Penalties from the dimensionless regularisation r (T20), or from SI values given instead.

    With sigma the yield stress, L the body length and V = 1/|F0|:
    ``eta = sigma L / (V r)``, ``bulk = 10 eta``, ``normal = tangential = 10 sigma / (V r)``.

    Args:
        scales: of the program.
        r: dimensionless regularisation, > 0; smaller is closer to the rigid-plastic limit.
        eta, bulk: Pa s.
        normal, tangential: Pa/(m/s).

    Raises:
        InputError: a value that is not positive.
    """
    check_penalties(r, eta, bulk, normal, tangential)
    viscosity = scales.stress * scales.length / scales.velocity
    spring = scales.stress / scales.velocity
    eta_program = 1 / r if eta is None else eta / viscosity
    return Penalties(
        eta=eta_program,
        bulk=10 * eta_program if bulk is None else bulk / viscosity,
        normal=10 / r if normal is None else normal / spring,
        tangential=10 / r if tangential is None else tangential / spring,
    )


@dataclass(frozen=True, repr=False)
class RegularisedValues(Compact):
    """The values of one regularised solve (T19): ``P <= alpha_reg <= load_factor <= alpha*``.

    With hardening they are those of the program whose stress bounds are ``bound + modulus ||v_p||``
    and stay so: it has the same velocity, stresses and multiplier, and alpha* is its exact value,
    not that of the program which hardens.

    Attributes:
        plastic: P, dissipation less the power of the dead load.
        alpha_reg: ``P + C`` with C the viscous and penalty energy; without hardening what is
            minimised (`RegularisedPoint.objective`).
        load_factor: lambda = ``P + 2 C`` (and the power of `by_shifts`), the multiplier of
            ``F0.U = 1``.
        multiplier: the same as the solver reports it; NaN where it reports none.
    """

    plastic: float
    alpha_reg: float
    load_factor: float
    multiplier: float

    @property
    def energy(self) -> float:
        """C, the viscous and penalty energy: the size of the regularisation error."""
        return self.alpha_reg - self.plastic


@dataclass(frozen=True)
class _Huber:
    """Elastic energy, dissipation, what hardening adds to it, secant stiffness at given lengths.

    The dissipation is that at the hardened bound, twice `hardening` of it by the hardening; the law
    is the derivative of ``energy + dissipation - hardening``.
    """

    energy: Floats
    dissipation: Floats
    hardening: Floats
    secant: Floats


def _huber(length: Floats, stiffness: float, bound: Floats, modulus: Floats) -> _Huber:
    plastic = np.maximum(stiffness * length - bound, 0.0) / (stiffness + modulus)
    stress = bound + modulus * plastic
    elastic = np.minimum(length, stress / stiffness)
    with np.errstate(divide="ignore", invalid="ignore"):
        secant = np.where(plastic > 0, stress / length, stiffness)
        dissipation = np.where(plastic > 0, stress * plastic, 0.0)
    return _Huber(stiffness * elastic**2 / 2, dissipation, modulus * plastic**2 / 2, secant)


@dataclass(frozen=True)
class Beside:
    """A hardening law as the sum of two laws without hardening (T17), arrays of shape (m,).

    Attributes:
        spring: Stiffness of a linear law.
        stiffness, bound: Stiffness and bound of a Huber function with the threshold of the law.
    """

    spring: Floats
    stiffness: Floats
    bound: Floats


def beside(stiffness: float, bound: Floats, modulus: Floats) -> Beside:
    """Write a hardening law as the sum of a linear law and a Huber function (T17)."""
    share = stiffness / (stiffness + modulus)
    return Beside(share * modulus, share * stiffness, share * bound)


@dataclass(frozen=True)
class _Plastic:
    """Law of a group: energy, dissipation and what hardening adds to it, (m,), and stresses."""

    energy: Floats
    dissipation: Floats
    hardening: Floats
    stress: Floats
    mean: Floats


def _plastic(group: DissipationGroup, penalty: Penalties, velocity: Floats) -> _Plastic:
    """The Huber law of cones, and the penalty on theta (T17)."""
    cone, theta = group.cone_vectors(velocity), np.asarray(group.volumetric @ velocity)
    share = group.volumetric_factor
    length = np.sqrt(np.sum(cone**2, axis=1) + (share * theta) ** 2)
    law = _huber(length, penalty.eta, group.bound, group.rise)
    return _Plastic(
        energy=law.energy + penalty.bulk * theta**2 / 2,
        dissipation=law.dissipation,
        hardening=law.hardening,
        stress=law.secant[:, None] * cone,
        mean=(law.secant * share**2 + penalty.bulk) * theta,
    )


def _plastic_pressed(
    group: DissipationGroup, surfaces: Surfaces, penalty: Penalties, velocity: Floats
) -> _Plastic:
    """The law of surfaces (T65)."""
    cone, volume = group.cone_vectors(velocity), np.asarray(group.volumetric @ velocity)
    volume = (volume - surfaces.besides).reshape(-1, surfaces.volumes)
    length = np.linalg.norm(cone, axis=1)
    stiffness = penalty.of_rates(surfaces.volumes)
    rates = np.column_stack([length, volume])
    found = surfaces.closest_point(rates, stiffness).stress
    elastic = found / stiffness
    direction = cone / np.where(length > 0, length, 1.0)[:, None]
    return _Plastic(
        energy=np.sum(found * elastic, axis=1) / 2,
        dissipation=np.sum(found * (rates - elastic), axis=1),
        hardening=np.zeros(length.size),
        stress=found[:, :1] * direction,
        mean=found[:, 1:].ravel(),
    )


def by_shifts(program: KinematicProgram, contact: FrozenContact, state: ProgramState) -> float:
    """Power of reactions on shifts of contact rows, and of stresses on dilations of surfaces."""
    power = float(program.contact.weights @ (state.normal_reaction * contact.shift))
    for group, mean in zip(program.groups, state.mean_stress, strict=True):
        if group.surfaces is not None:
            power += float((group.volume_weights * group.surfaces.besides) @ mean)
    return power


@dataclass(frozen=True, repr=False)
class RegularisedPoint(Compact):
    """The regularised energy at a velocity, and its derivative as stresses and reactions.

    Attributes:
        values: of T19.
        objective: what is minimised: `values.alpha_reg`, with hardening less
            ``sum w modulus ||v_p||^2/2``.
        gradient: of the objective, shape (n,).
        state: with the stresses and reactions of the law.
    """

    values: RegularisedValues
    objective: float
    gradient: Floats
    state: ProgramState


def evaluate(
    program: KinematicProgram,
    contact: FrozenContact,
    penalty: Penalties,
    velocity: Floats,
    multiplier: float = float("nan"),
) -> RegularisedPoint:
    """Energy, its gradient (shape (n,)) and the stresses at any velocity of shape (n,).

    At a minimiser with ``F0.U = 1`` the gradient is ``load_factor * F0``.
    """
    energy = dissipation = hardening = 0.0
    gradient = -program.dead_load
    stresses, means = [], []
    for group in program.groups:
        if group.surfaces is None:
            law = _plastic(group, penalty, velocity)
        else:
            law = _plastic_pressed(group, group.surfaces, penalty, velocity)
        stresses.append(law.stress)
        means.append(law.mean)
        energy += float(group.weights @ law.energy)
        dissipation += float(group.weights @ law.dissipation)
        hardening += float(group.weights @ law.hardening)
        gradient = gradient + group.rows.T @ (group.weights[:, None] * law.stress).ravel()
        gradient = gradient + group.volumetric.T @ (group.volume_weights * law.mean)
    reaction = _contact_law(program, contact, penalty, velocity)
    weights = program.contact.weights
    energy += float(weights @ reaction.energy)
    dissipation += float(weights @ reaction.dissipation)
    gradient = gradient - program.contact.normal.T @ (weights * reaction.normal)
    gradient = (
        gradient - program.contact.tangential.T @ (weights[:, None] * reaction.tangential).ravel()
    )
    plastic = dissipation - float(program.dead_load @ velocity)
    state = ProgramState(
        velocity=velocity,
        load_factor=float("nan"),
        stress=tuple(stresses),
        mean_stress=tuple(means),
        normal_reaction=reaction.normal,
        tangential_reaction=reaction.tangential,
    )
    # gradient.velocity, at any velocity
    load_factor = plastic + 2 * energy + by_shifts(program, contact, state)
    values = RegularisedValues(plastic, plastic + energy, load_factor, multiplier)
    state = replace(state, load_factor=load_factor)
    return RegularisedPoint(values, values.alpha_reg - hardening, gradient, state)


def escaped(velocity: Floats) -> bool:
    """Whether a dimensionless velocity has run away (or is not a number)."""
    return not np.abs(velocity).max(initial=0.0) < _ESCAPED


def judged_status(status: Status, program: KinematicProgram, point: RegularisedPoint) -> Status:
    """What the answer of a regularised solver means (T13): evidence, not a proof.

    Penalties make every program feasible: where they carry nearly all the power, no admissible
    mechanism feels the load (LOCKED). A velocity without bound is a collapse under dead load
    (UNSAFE).
    """
    values, velocity = point.values, point.state.velocity
    if escaped(velocity):
        return Status.UNSAFE if np.any(program.dead_load) else Status.FAILED
    dead_power = float(program.dead_load @ velocity)
    power = values.plastic + dead_power + 2 * values.energy + abs(dead_power)
    if status is Status.SOLVED and 2 * values.energy > _LOCKED_SHARE * max(power, _LOCKED_POWER):
        return Status.LOCKED
    return status


@dataclass(frozen=True)
class _Reaction:
    energy: Floats
    dissipation: Floats
    normal: Floats
    tangential: Floats


def _contact_law(
    program: KinematicProgram, contact: FrozenContact, penalty: Penalties, velocity: Floats
) -> _Reaction:
    """Contact law (T18), and its counterpart with dilatancy.

    With dilatancy d the penalty energy is that of the distance to the cone ``u_n >= d ||u_t||``
    in the metric (K_n, K_t): its derivative is the trial reaction projected onto
    ``||t_t|| <= d t_n``. A bound on friction is an additional law.
    """
    opening = program.contact.opening(velocity) + contact.shift
    slip = program.contact.slip(velocity)
    slip_rate = np.linalg.norm(slip, axis=1)
    law = _huber(slip_rate, penalty.tangential, contact.bound, np.zeros(slip_rate.size))
    normal = penalty.normal * np.maximum(-opening, 0.0)
    d = contact.dilatancy
    dilatant = d > 0
    energy = normal**2 / (2 * penalty.normal) + law.energy
    tangential = -law.secant[:, None] * slip

    sliding = dilatant & (penalty.tangential * slip_rate > d * normal)
    sticking = dilatant & ~sliding
    compliance = 1 / penalty.normal + d**2 / penalty.tangential
    pushed = np.maximum(d * slip_rate - opening, 0.0)[sliding]
    normal[sliding] = pushed / compliance[sliding]
    energy[sliding] = pushed**2 / (2 * compliance[sliding]) + law.energy[sliding]
    with np.errstate(divide="ignore", invalid="ignore"):
        direction = np.where(slip_rate[:, None] > 0, slip / slip_rate[:, None], 0.0)
    tangential[sliding] -= (d * normal)[sliding, None] * direction[sliding]
    tangential[sticking] -= penalty.tangential * slip[sticking]
    energy[sticking] += penalty.tangential * slip_rate[sticking] ** 2 / 2
    return _Reaction(energy, law.dissipation, normal, tangential)
