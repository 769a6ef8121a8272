"""One limit problem of a path: the flow of the bodies at one moment of a step (T29)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from lacore.assembly.discretisation import Discretisation
from lacore.assembly.discretise import discretise
from lacore.assembly.unknowns import Unknowns
from lacore.coupling.friction_start import FrictionStart
from lacore.limit.solve import solve
from lacore.limit.state import LimitState
from lacore.model.bodies.continuum.regions.gathering import by_body
from lacore.model.bodies.continuum.regions.region import Region
from lacore.model.bodies.continuum.strain_rates import (
    deviatoric,
    equivalent_rate,
    principal_rates,
    strain_per_length,
)
from lacore.model.contact.interfaces import Interface
from lacore.model.contact.rows import ContactPoints
from lacore.model.contact.touching import Touching
from lacore.numerics.arrays import Floats
from lacore.paths.configuration import Configuration
from lacore.paths.contact.pair_stations import pair_station
from lacore.paths.contact.stations import gathered
from lacore.paths.selection import Selected
from lacore.paths.stage import Stage
from lacore.paths.tools.contact import face_stations
from lacore.program.kinematic import ContactRows, DissipationGroup, KinematicProgram
from lacore.reporting.showing import Compact

# Hardening per yield stress, which selects the most uniform of all mechanisms with the same load.
# Its share of the load is subtracted afterwards. Soils get none: it would change the stress at the
# apex of a yield surface, where flow would then have no certificate.
_CHOICE = 1e-3


@dataclass(frozen=True, repr=False)
class Moment(Compact):
    """Data of one limit problem of a step.

    Attributes:
        begin: Configuration at the start of the step.
        at: Configuration at which the problem is solved.
        duration: Duration of the step, s, at the velocities of ``F0.u = 1``.
        share: Share theta of the duration after which the yield stress is evaluated.
        friction_start: Friction at which the loop starts.
    """

    begin: Configuration
    at: Configuration
    duration: float
    share: float
    friction_start: FrictionStart = field(default_factory=FrictionStart)


@dataclass(frozen=True, repr=False)
class Snapshot(Compact):
    """The bodies at the end of a step.

    Attributes:
        step: 0 is the beginning.
        travel: there.
        configuration: where they are, and their strains.
        velocity: that led there, by body, shape (2, nodes), m/s at ``F0.u = 1``; zero at the
            beginning.
        strain_rate: that went with it: equivalent, at the strain points by body, shape
            (elements, q), 1/s.
        moment: of the limit problem whose load the step has; None at the beginning.
        duration: of the step for which that load is, s.
    """

    step: int
    travel: float
    configuration: Configuration
    velocity: Mapping[str, Floats]
    strain_rate: Mapping[str, Floats]
    moment: Moment | None = None
    duration: float = 0.0


@dataclass(frozen=True, repr=False)
class Flow(Compact):
    """Solution of the limit problem of a moment.

    Attributes:
        state: Limit state of the program with the hardening that selects a mechanism.
        moment: Data of the problem.
        load_factor: Load factor without that hardening; NaN without a state.
        hardened: Part of the load factor due to hardening within the step.
        duration: Duration, s, of the step to which the load factor belongs.
        selected: Selected velocity, which moves the bodies; None for that of the state.
    """

    state: LimitState
    moment: Moment
    load_factor: float
    hardened: float
    duration: float
    selected: Selected | None = None

    def lasting(self, duration: float) -> "Flow":
        """Return the flow with the load of another duration of the step, s, to first order."""
        more = (duration - self.duration) / self.moment.duration * self.hardened
        return replace(self, load_factor=self.load_factor + more, duration=duration)

    @property
    def motion(self) -> Floats:
        """The velocity that moves the bodies, all unknowns, m/s at ``F0.u = 1``."""
        assert self.state.point is not None
        return self.state.point.velocity if self.selected is None else self.selected.velocity

    @property
    def velocity(self) -> dict[str, Floats]:
        """That velocity by body, shape (2, nodes), m/s; for rigid blocks (3, 1), with rad/s."""
        d, u = self.state.discretisation, self.motion
        moving = {name: u[dofs.dofs] for name, dofs in d.continua.items()}
        return moving | {name: dofs.motion(u) for name, dofs in d.assemblies.items()}

    @property
    def strain_rate(self) -> dict[str, Floats]:
        """Equivalent strain rate at the strain points by body, shape (elements, q), 1/s.

        See `lacore.model.bodies.continuum.strain_rates.equivalent_rate`.
        """
        d = self.state.discretisation
        rates = {}
        for name, dofs, groups in by_body(d.continua, d.full.groups):
            rates[name] = equivalent_rate(dofs, groups, self.motion)
        return rates | {name: np.zeros((1, 1)) for name in d.assemblies}

    def hencky_strain(self, duration: float) -> dict[str, Floats]:
        """Return the equivalent logarithmic strain of a step centred here, (elements, q) (T30).

        It is infinite where the step is too long for this strain measure.
        """
        d, velocity = self.state.discretisation, self.velocity
        strains = {}
        for name, dofs in d.continua.items():
            principal = duration * principal_rates(dofs, velocity[name])
            with np.errstate(divide="ignore", invalid="ignore"):
                strain = deviatoric(2 * np.arctanh(principal / 2))
            strains[name] = np.where(np.isfinite(strain), strain, np.inf)
        return strains | {name: np.zeros((1, 1)) for name in d.assemblies}


def discretised(stage: Stage, moment: Moment) -> Discretisation:
    """Discretise the bodies of a moment and their contact, without hardening.

    Raises:
        InputError: A mesh is inverted or overlaps, or contact contradicts supports.
    """
    now = stage.plane_bodies_at(moment.at)
    begin = now if moment.begin is moment.at else stage.plane_bodies_at(moment.begin)

    def contact(
        _: Sequence[Interface], __: Sequence[Touching], unknowns: Unknowns
    ) -> tuple[ContactRows, ContactPoints]:
        n, moments = unknowns.n, (moment.begin, moment.at)
        first, here = map(stage.obstacles_at, moments)
        faces, corners = face_stations((first, here), (begin, now), unknowns, moment.begin)
        pairs = [pair_station(own, unknowns.dofs, begin, now, n) for own in stage.pairs]
        return gathered([*faces, *pairs, *corners], here, n, moment.duration)

    return discretise(stage.with_bodies(now, moment.at), contact)


@dataclass(frozen=True, repr=False)
class WarmStart(Compact):
    """Data of earlier solves from which a solve of a step starts.

    Attributes:
        velocity: Velocity of the step before, by body. Its slip is a start for rough solves; the
            reactions of that step differ too much from those of this one. None at the beginning and
            on new meshes.
        reactions: Normal reactions of the last solve of the step; None before the first one.
        solves: Number of inner solves of the step so far.
    """

    velocity: Mapping[str, Floats] | None = None
    reactions: Floats | None = None
    solves: int = 0

    def after(self, state: LimitState) -> "WarmStart":
        """Return the warm start of the solve after a state."""
        assert state.point is not None
        reactions = np.maximum(state.point.normal_reaction, 0.0)
        return WarmStart(self.velocity, reactions, self.solves + state.outer_iterations)

    def friction_start(self, problem: Discretisation) -> FrictionStart:
        """Return the friction at which the loop of the next solve starts."""
        normal_reaction, slip = self.reactions, None
        if normal_reaction is not None and normal_reaction.size != problem.full.contact.count:
            normal_reaction = None  # bodies have slid to other edges
        if self.reactions is None and self.velocity is not None:
            slip = _slip(problem, self.velocity)
        return FrictionStart(normal_reaction, slip)


def flow(
    stage: Stage, moment: Moment, settings: Mapping[str, Any], warm: WarmStart | None = None
) -> Flow:
    """Solve the limit problem of a moment.

    Args:
        stage: Problem on the present meshes.
        moment: Data of the limit problem.
        settings: Arguments of `lacore.solve`.
        warm: Warm start; None starts at the friction of the moment.

    Raises:
        InputError: See `discretised`.
    """
    problem = limit_problem(stage, moment)
    if warm is not None:
        moment = replace(moment, friction_start=warm.friction_start(problem))
    start = moment.friction_start
    state = solve(problem, **settings, normal_reaction=start.normal_reaction, slip=start.slip)
    return flow_of(state, moment)


def _slip(problem: Discretisation, velocity: Mapping[str, Floats]) -> Floats:
    """Return the slip rates of a velocity of the bodies, shape (m,), m/s."""
    u = np.zeros(problem.full.n)
    for name, dofs in problem.continua.items():
        u[dofs.dofs] = velocity[name]
    for name, block in problem.assemblies.items():
        u[block.offset : block.offset + block.count] = block.unknowns(velocity[name])
    return np.asarray(np.linalg.norm(problem.full.contact.slip(u), axis=1))


def limit_problem(stage: Stage, moment: Moment) -> Discretisation:
    """Return the limit problem of a moment, with hardening within its step.

    Raises:
        InputError: See `discretised`.
    """
    d = discretised(stage, moment)
    laws = _laws(d, moment)
    return replace(d, full=_hardening(d.full, laws), program=_hardening(d.program, laws))


def flow_of(state: LimitState, moment: Moment) -> Flow:
    """Return the flow of a limit state of the `limit_problem` of a moment."""
    if state.point is None:
        return Flow(state, moment, np.nan, 0.0, moment.duration)
    chosen = hardened = 0.0
    d = state.discretisation
    for law, group in zip(_laws(d, moment), d.full.groups, strict=True):
        squares = group.weights * np.sum(group.cone_vectors(state.point.velocity) ** 2, axis=1)
        chosen += float(law.choosing @ squares)
        hardened += float(law.modulus @ squares)
    return Flow(state, moment, state.load_factor - chosen, hardened, moment.duration)


@dataclass(frozen=True)
class _Law:
    """Hardening at the strain points of a region, per length of a cone vector, shapes (m,).

    Attributes:
        bound: Yield stress at the start of the step, on the tangent at the strain expected now.
        modulus: Modulus of hardening within the step.
        choosing: Additional modulus, which selects one of several mechanisms.
    """

    bound: Floats
    modulus: Floats
    choosing: Floats


def _laws(d: Discretisation, moment: Moment) -> list[_Law]:
    return [
        _law(name, region, group, moment)
        for name, dofs, groups in by_body(d.continua, d.full.groups)
        for region, group in zip(dofs.body.regions, groups, strict=True)
    ]


def _law(name: str, region: Region, group: DissipationGroup, moment: Moment) -> _Law:
    law, factor = region.criterion.law, strain_per_length(region)
    rate = factor**2 * moment.share * moment.duration
    if law is None:
        none = np.zeros(group.bound.size)
        chosen = none if group.surfaces is not None else rate * _CHOICE * group.bound / factor
        return _Law(bound=group.bound, modulus=none, choosing=chosen)
    begin, now = (at.strain[name][region.elements].ravel() for at in (moment.begin, moment.at))
    slope, stress = law.modulus(now), law.stress(now)
    return _Law(
        bound=factor * (stress - slope * (now - begin)),
        modulus=rate * slope,
        choosing=rate * np.maximum(_CHOICE * stress - slope, 0.0),
    )


def _hardening(program: KinematicProgram, laws: Sequence[_Law]) -> KinematicProgram:
    """Return the program with the hardening of its groups, all of which belong to continua."""
    return replace(
        program,
        groups=tuple(_hardened(g, law) for g, law in zip(program.groups, laws, strict=True)),
    )


def _hardened(group: DissipationGroup, law: _Law) -> DissipationGroup:
    modulus = law.modulus + law.choosing
    return replace(group, bound=law.bound, modulus=modulus if np.any(modulus > 0) else None)


def stage_of(snapshot: Snapshot, first: Stage, later: Sequence[tuple[int, Stage]]) -> Stage:
    """Return the stage that has the meshes of a snapshot; see `Path.later`."""
    passed = [stage for step, stage in later if step <= snapshot.step]
    return passed[-1] if passed else first


def state_of(
    snapshot: Snapshot,
    first: Stage,
    later: Sequence[tuple[int, Stage]],
    settings: Mapping[str, Any],
) -> LimitState:
    """Solve for the limit state of a snapshot other than the first one."""
    assert snapshot.moment is not None
    return flow(stage_of(snapshot, first, later), snapshot.moment, settings).state
