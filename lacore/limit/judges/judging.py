"""The judges of an outcome, in the order in which results report what they find.

A judge is a pure function. Those that refuse give the reason why a proven status is not accepted;
the others see the status that remains.
"""

from collections.abc import Callable, Iterable, Iterator

from lacore.assembly.sticking import opening
from lacore.limit import cells
from lacore.limit.carried import loads_between
from lacore.limit.judges.dimensions import changed_meshes, implausible_dimensions, snapped_tables
from lacore.limit.judges.driven_corners import driven_corners
from lacore.limit.judges.reached import reached_supports
from lacore.limit.outcome import Outcome
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.regions.lending import next_to_none, strengthless
from lacore.model.bodies.frames.frame import Frame
from lacore.model.conditions.water import PorePressure, StandingWater
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Rigor, Role, Scope, Status
from lacore.reporting.text import Quantity

Judge = Callable[[Outcome, Status], Iterable[Finding]]
_MOVING = (Status.SOLVED, Status.FREE)  # claims that a mechanism makes
_UNDECIDED = (Status.NOT_CERTIFIED, Status.STALLED, Status.ITERATION_LIMIT)

_NO_CAPACITY = {
    Role.MINIMUM: Kind.MINIMUM_HOLDING_LOAD,
    Role.BOTH_SIDES: Kind.EQUILIBRIUM_ON_BOTH_SIDES,
}


def judged(outcome: Outcome) -> tuple[Status, tuple[Finding, ...]]:
    """Return the status of an outcome and all findings."""
    refusals = [own for judge in REFUSING for own in judge(outcome, outcome.status)]
    status = Status.NOT_CERTIFIED if refusals else outcome.status
    return status, (*refusals, *(own for judge in DESCRIBING for own in judge(outcome, status)))


def driving_corners(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """A mechanism drives corners of blocks into each other."""
    falls = status is Status.UNSAFE and outcome.program.homogeneous
    if status in _MOVING or falls:
        velocity = None if outcome.point is None else outcome.point.velocity
        yield from _any(driven_corners(outcome.discretisation, velocity, outcome.coupled.tolerance))


def moments_inside(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """Moments inside members exceed the plastic moment, however many nodes there are."""
    if status is Status.SOLVED and not (excess := outcome.excess) <= outcome.allowed_excess:
        yield Finding(Kind.MOMENTS_INSIDE, (), {"excess": excess}, Severity.REASON)


def other_native_status(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """The residuals prove a state that its solver does not call solved."""
    inner = outcome.coupled.final.inner
    if status is Status.SOLVED and inner.status is not Status.SOLVED:
        yield Finding(Kind.NATIVE_STATUS, values={"native": inner.native_status})


def bracket(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """Load factors enclose every Coulomb one, where none is certified."""
    if (ends := outcome.bracket) is not None:
        discrete = outcome.discretisation.scope is Scope.DISCRETE
        kind = Kind.BRACKET_OF_MESH if discrete else Kind.BRACKET
        yield Finding(kind, values={"lower": ends[0], "upper": ends[1]})


def polygon(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """A load factor is that of the polygon that approximates a curved outline."""
    bodies = (dofs.body for dofs in outcome.discretisation.continua.values())
    curved = any(body.geometry != "exact" for body in bodies)
    if curved and outcome.rigor(status) is Rigor.DISCRETE:
        yield Finding(Kind.POLYGON, severity=Severity.WARNING)


def polygons_of_sections(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """A load factor is a bound of a frame whose yield curves are replaced by polygons."""
    problem = outcome.discretisation.problem
    if status is Status.SOLVED and of_kind(problem.bodies, Frame):
        inside, around = cells.from_below(problem), cells.from_above(problem)
        if inside != around and outcome.discretisation.scope is Scope.ITSELF:
            yield Finding(Kind.POLYGONS_INSIDE if inside else Kind.POLYGONS_AROUND)


def other_load_factors(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """Other load factors may exist, because flow is not associated."""
    if outcome.program.frictional and status is Status.SOLVED:
        yield Finding(Kind.OTHER_LOAD_FACTORS, severity=Severity.WARNING)


def locked_on_mesh(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """A mesh may lack the motion of a deformable body."""
    continua = outcome.discretisation.continua.values()
    if status is Status.LOCKED and continua:
        jumps = all(dofs.space.jumps for dofs in continua)
        advice = "" if jumps else ", take the space 'p2-disc', whose velocities jump"
        yield Finding(Kind.LOCKED_ON_MESH, values={"space": advice})


def shared_corners(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """Contact points with friction meet at a corner."""
    if status is Status.SOLVED and outcome.discretisation.shared_corners.any():
        yield Finding(Kind.SHARED_CORNERS, severity=Severity.WARNING)


def reached(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """A mechanism reaches a side of the soil that holds it."""
    if outcome.status in _MOVING:
        velocity = None if outcome.point is None else outcome.point.velocity
        yield from _any(reached_supports(outcome.discretisation, velocity))


def opens(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """A structure separates at an interface that sticks."""
    yield from _any(opening(outcome.discretisation.problem, status))


def other_loads(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """A load factor alone does not show which loads are carried."""
    if status is not Status.SOLVED:
        return
    own = outcome.carried
    if own is not None and own.role in _NO_CAPACITY:
        kind = Kind.LOCKS_IN_FORCES if own.locks_in_forces else _NO_CAPACITY[own.role]
        values = {"loads": loads_between(own.low, own.high)}
        yield Finding(kind, values=values, severity=Severity.WARNING)
    if outcome.load_factor(status) < 0:
        yield Finding(Kind.NEGATIVE, severity=Severity.WARNING)


def fall_of_cells(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """A collapse is proven of cells that carry less than their joints."""
    yield from _any(cells.fall_of_cells(outcome.discretisation.problem, status))


def reasons(outcome: Outcome, status: Status) -> Iterable[Finding]:
    """Return what the loop, or the proof of its claim, reports."""
    return outcome.findings


def backend_message(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """The backend reports more."""
    if text := outcome.coupled.final.inner.message:
        yield Finding(Kind.BACKEND, (), {"text": text})


def strengthless_bodies(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """Bodies without strength leave solvers no room where no load factor is found."""
    if status not in _UNDECIDED:
        return
    for name, dofs in outcome.discretisation.continua.items():
        if any(strengthless(dofs.body)):
            lent = next_to_none(dofs.body, outcome.discretisation.full.dead_load)
            yield Finding(Kind.HARDLY_STRONG, (name,), {"lent": Quantity(lent, "Pa", ".1e")})


def missing_water(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """A wet body collapses, and no free water is given that would act on it."""
    dead = outcome.discretisation.problem.dead_loads
    wet = any(isinstance(load, PorePressure) for load in dead)
    standing = any(isinstance(load, StandingWater) for load in dead)
    if status is Status.UNSAFE and wet and not standing:
        yield Finding(Kind.NO_STANDING_WATER)


def _any(finding: Finding | None) -> Iterator[Finding]:
    if finding is not None:
        yield finding


REFUSING: tuple[Judge, ...] = (driving_corners, moments_inside)
DESCRIBING: tuple[Judge, ...] = (
    other_native_status,
    bracket,
    polygon,
    polygons_of_sections,
    other_load_factors,
    locked_on_mesh,
    shared_corners,
    reached,
    opens,
    other_loads,
    fall_of_cells,
    reasons,
    backend_message,
    strengthless_bodies,
    missing_water,
    implausible_dimensions,
    changed_meshes,
    snapped_tables,
)
