"""A problem file as a whole."""

from typing import Any, ClassVar

from pydantic import StrictBool

from lacore.files.problem.places import Path
from lacore.files.problem.schema.bodies import Body
from lacore.files.problem.schema.conditions import Interface, Load, Support
from lacore.files.problem.schema.entry import Entry
from lacore.files.problem.schema.values import Number


class Asked(Entry):
    """What is asked for, and how it is solved; the command line has the last word."""

    backend: str = "clarabel"
    coupling: str | None = None
    bracket: Number | None = None
    """Width of a proven bracket, per its mean."""
    range: StrictBool = False
    """Whether all load factors are searched, not one."""
    safety: StrictBool = False
    """Whether the factor of safety on strength is asked for."""


class ProblemFile(Entry):
    """A problem of limit analysis."""

    maker: ClassVar[str] = "la.Problem"
    title: str = ""
    """Of the page that shows the answer."""
    bodies: dict[str, Body]
    reference_loads: tuple[Load, ...]
    """What the load factor multiplies."""
    dead_loads: tuple[Load, ...] = ()
    """What stays as it is."""
    supports: tuple[Support, ...] = ()
    interfaces: tuple[Interface, ...] = ()
    solve: Asked = Asked()

    def arguments(self, at: Path) -> dict[str, Any]:
        """See `Entry.arguments`."""
        given = super().arguments(at)
        for name in ("title", "solve"):
            given.pop(name, None)
        return {name: list(own) if isinstance(own, tuple) else own for name, own in given.items()}
