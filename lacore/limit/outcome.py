"""The outcome of a solve: the result of a loop and its proof, before it is judged."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from lacore.assembly.discretisation import Discretisation
from lacore.coupling.claims.proving import Ray
from lacore.coupling.kinds import COUPLINGS
from lacore.coupling.run import Coupled
from lacore.limit import cells
from lacore.limit.carried import CarriedLoads
from lacore.limit.conversion import point_in_si
from lacore.limit.judges.driven_corners import driven_corners
from lacore.limit.span_moments import span_excess
from lacore.model.bodies.continuum.body_forces import linear
from lacore.model.bodies.continuum.spaces import SPACES
from lacore.program.certificate import Certificate
from lacore.program.kinematic import KinematicProgram
from lacore.program.power import kinematic_load_factor
from lacore.program.state import ProgramState
from lacore.reporting.findings import Finding
from lacore.reporting.showing import Compact
from lacore.reporting.status import Rigor, Scope, Status


@dataclass(frozen=True)
class Times:
    """Durations of a solve, s: assembly, the rest without compilation, compilation."""

    build: float = 0.0
    solve: float = 0.0
    compile: float = 0.0

    def plus(self, other: Times) -> Times:
        """Return the sums."""
        return Times(
            self.build + other.build, self.solve + other.solve, self.compile + other.compile
        )


@dataclass(frozen=True)
class Proof:
    """Proof of a status that a loop claims, or of the one in its place.

    Attributes:
        status: The claim, what is proven instead, or NOT_CERTIFIED.
        findings: Why it differs from the claim; empty where it does not.
        ray: Proof of LOCKED or UNSAFE, dimensionless.
        falling: Mechanism of the dead loads, SI units, of UNSAFE; None where there is none.
    """

    status: Status
    findings: tuple[Finding, ...]
    ray: Ray | None
    falling: ProgramState | None = None


@dataclass(frozen=True, repr=False)
class Outcome(Compact):
    """Result of a solve and its proof, before it is judged.

    Attributes:
        discretisation: The problem that was solved.
        program: Its program, dimensionless, as the coupling solves it.
        coupled: End of the loop.
        coupling: Name.
        regularised: Whether the backend is regularised.
        status: What is proven; judges may still refuse it.
        point: State in SI units, with the load factor to report; None where there is none.
        certificate: Its residuals.
        findings: Reasons of the loop, or of the proof of its claim.
        ray: Proof of LOCKED or UNSAFE, dimensionless.
        carried: Load factors with equilibrium; None where that is not computed.
        times: Durations.
        allowed_excess: Share by which moments inside members may exceed the plastic moment.
    """

    discretisation: Discretisation
    program: KinematicProgram
    coupled: Coupled
    coupling: str
    regularised: bool
    status: Status
    point: ProgramState | None
    certificate: Certificate | None
    findings: tuple[Finding, ...]
    ray: Ray | None
    times: Times
    carried: CarriedLoads | None = None
    allowed_excess: float = np.inf

    @cached_property
    def excess(self) -> float:
        """Share by which moments inside members exceed the plastic moment; at least 0."""
        return 0.0 if self.point is None else span_excess(self.discretisation, self.point)

    @property
    def bracket(self) -> tuple[float, float] | None:
        """Load factors that enclose every Coulomb one, where the loop found them."""
        if self.coupled.bracket is None:
            return None
        lower, upper = (end * self.program.scales.load_factor for end in self.coupled.bracket)
        # Contact at corners, which no program has, may carry more.
        beyond = driven_corners(self.discretisation, None, self.coupled.tolerance)
        return float(lower), np.inf if beyond else float(upper)

    def load_factor(self, status: Status) -> float:
        """Return the load factor that a status allows to report."""
        if status is Status.SOLVED and self.point is not None:
            return self.point.load_factor
        return np.inf if status is Status.LOCKED else np.nan

    def rigor(self, status: Status) -> Rigor:
        """Return what the load factor proves."""
        if status is not Status.SOLVED:
            return Rigor.NOT_CERTIFIED
        if self.regularised:
            return Rigor.REGULARISED
        full = self.discretisation.full
        normal = COUPLINGS[self.coupling].bounds == "upper" or full.associated_flow
        if normal and strict_bound(self.discretisation):
            return Rigor.UPPER
        problem = self.discretisation.problem
        exact = self.discretisation.scope is Scope.ITSELF and full.associated_flow
        below = exact and cells.from_below(problem) and not cells.from_above(problem)
        return Rigor.LOWER if below else Rigor.DISCRETE


def outcome_of(
    discretisation: Discretisation,
    program: KinematicProgram,
    coupled: Coupled,
    coupling: str,
    times: Times,
    *,
    regularised: bool = False,
    proof: Proof | None = None,
    allowed_excess: float = np.inf,
    carried: CarriedLoads | None = None,
) -> Outcome:
    """Return the outcome of a loop, with what is proven of its claim if that needs a proof."""
    point, certificate = coupled.final.state, coupled.final.certificate
    bound = coupled.laws is not None or program.associated_flow
    if bound and point is not None and certificate is not None and not regularised:
        # Of a Coulomb state the static value is reported, with which equilibrium holds.
        point = replace(point, load_factor=kinematic_load_factor(program, point, coupled.laws))
        # The gap stays that between the two values; everything else must hold for the reported one.
        certificate = replace(Certificate.of(program, point, coupled.laws), gap=certificate.gap)
    proof = proof or Proof(coupled.status, coupled.findings, None)
    own = None if point is None else point_in_si(discretisation, point)
    falls = proof.ray is not None and proof.status is Status.UNSAFE and program.homogeneous
    return Outcome(
        discretisation=discretisation,
        program=program,
        coupled=coupled,
        coupling=coupling,
        regularised=regularised,
        status=proof.status,
        point=proof.falling if falls else own,
        certificate=certificate,
        findings=proof.findings,
        ray=proof.ray,
        times=times,
        allowed_excess=allowed_excess,
        carried=carried,
    )


def strict_bound(discretisation: Discretisation) -> bool:
    """Whether dissipation is nowhere below that of the continuum, and the power of loads exact."""
    bodies = {name: dofs.body for name, dofs in discretisation.continua.items()}
    loads = [load for load in discretisation.problem.loads.values() if load.body in bodies]
    return (
        not cells.from_below(discretisation.problem)
        and all(
            SPACES[own.space].strict and own.geometry == "exact" and own.bounded
            for own in bodies.values()
        )
        and all(linear(load, bodies[load.body].mesh) for load in loads)
    )
