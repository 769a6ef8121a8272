"""Why a path ends where it ends."""

from enum import Enum

from lacore.reporting.errors import LacoreError
from lacore.reporting.findings import Finding, Message, Severity
from lacore.reporting.kinds import Kind


class Ending(Enum):
    """Each text says what to do."""

    REACHED = "the requested travel is reached"
    DRIFTED = (
        "the travel is reached, but the shape may have drifted, because the velocity became one of"
        " many before this was detected, or no regular one was found: see the events, and select"
        " the velocity from the first step on"
    )
    STEADY = "load and flow have become stationary"
    INVERSION = (
        "the next step would turn an element inside out: start from elements that are drawn out"
        " across the flow, mesh anew from the last configuration, or take smaller steps"
    )
    OVERLAP = "the next configuration is not a valid mesh: remesh, or take smaller steps"
    PENETRATION = (
        "contact acts along edges that face each other, and a corner has none: give the corner a"
        " short edge of its own that faces the other body, or take smaller steps"
    )
    FOLDED = (
        "no interface is stated between the two parts of the boundary that meet: name both parts"
        " and add an interface between them to 'approaching', or end the path before"
    )
    STANDSTILL = (
        "the control does not move in its direction: turn its direction around, or follow another"
        " point or a footing"
    )
    LOCKED = (
        "no flow that the materials allow makes the next step, or one under a load without bound:"
        " obstacles or supports enclose the bodies, or they harden without end within it"
    )
    NO_CONTACT = (
        "no tool presses on a body, so none does any work: begin with a tool that touches the body,"
        " turn its velocity around, or end the path before it leaves the body"
    )
    NOT_SOLVED = "a limit problem on the way has no certified answer"
    NOT_ITERATED = (
        "the configuration of an implicit step did not settle: take smaller steps, or 'leapfrog'"
    )
    NOT_REMESHED = "the new meshes cannot be taken"
    STOPPED = "the finished steps are kept"
    RUNNING = "the path has not ended yet: this is what hooks see of it"
    STEP_TOO_SMALL = "the requested accuracy needs steps below the smallest allowed"

    @property
    def label(self) -> str:
        """The name as shown in tables: ``not solved``."""
        return self.name.lower().replace("_", " ")

    def report(self, findings: tuple[Finding, ...]) -> Message:
        """Return the text of this ending with findings, to be rendered for a reader."""
        return Message(self.label, self.value, findings)


class PathEndError(Exception):
    """The path cannot continue.

    Attributes:
        ending: Kind of the end.
        findings: Further findings, such as the element that would be inverted.
    """

    def __init__(self, ending: Ending, *findings: Finding) -> None:
        self.ending, self.findings = ending, findings
        super().__init__(str(ending.report(findings)))


def refused(error: LacoreError, severity: Severity = Severity.DETAIL) -> Finding:
    """Return a finding that quotes an error."""
    return Finding(Kind.REFUSED, (), {"error": error.text}, severity)
