"""A problem file as a whole."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, ClassVar, Literal

from pydantic import Field, StrictBool, model_validator

from lacore.files.problem.calls import Call, Key, MisfitError, Own, Program, Spread, owned
from lacore.files.problem.places import Path
from lacore.files.problem.schema.bodies import Body
from lacore.files.problem.schema.conditions import Interface, Load, Support
from lacore.files.problem.schema.entry import Entry
from lacore.files.problem.schema.path import PathOf
from lacore.files.problem.schema.places import DRAWING
from lacore.files.problem.schema.tools import Tool
from lacore.files.problem.schema.values import Number, refused
from lacore.reporting.errors import InputError, suggest

_OF_BLOCKS = ("block", "blocks", "wall", "stack", "arch")


class Told(Entry):
    """Units of results; by default the most frequent ones of the file."""

    force: Literal["N", "kN", "MN", "lbf", "kip"] | None = None
    length: Literal["m", "cm", "mm", "ft", "in"] | None = None
    stress: Literal["Pa", "kPa", "MPa", "psf", "ksf", "psi", "ksi"] | None = None

    @property
    def given(self) -> dict[str, str]:
        """Units that are given."""
        return {name: own for name, own in self.model_dump().items() if own is not None}


class Asked(Entry):
    """Requested results and solver; the command line takes precedence."""

    backend: str = "auto"
    coupling: str | None = None
    units: Told = Told()
    bracket: Number | None = None
    """Width of a proven bracket, per its mean."""
    range: StrictBool = False
    """Whether all load factors are searched, not one."""
    safety: StrictBool = False
    """Whether the factor of safety on strength is requested."""
    interfaces: StrictBool = False
    """Whether that divides the friction of interfaces as well."""
    stable: StrictBool = False
    """Whether the dead loads alone are carried, with the proof in a picture."""
    sensitivity: StrictBool = False
    """Whether sensitivities of the load factor are requested."""
    cases: StrictBool = False
    """Whether each case of the reference loads is solved alone."""
    envelope: StrictBool = False
    """Whether all combinations of the cases, two or three, are searched."""
    vary: str | None = None
    """A number of the file and its range: arch.thickness=5 cm:20 cm."""
    critical: Number | None = None
    """Load factor to search for along it."""
    limit: StrictBool = False
    """Whether to find the value at which the dead loads are just carried."""
    worst: StrictBool = False
    """Whether to find the value with the smallest load factor."""


class ProblemFile(Entry):
    """A problem of limit analysis."""

    maker: ClassVar[str] = "la.Problem"
    title: str = ""
    """Title of the page of results."""
    bodies: dict[str, Body]
    reference_loads: tuple[Load, ...] = ()
    """Loads that the load factor multiplies; required unless tools move."""
    dead_loads: tuple[Load, ...] = ()
    """Constant loads."""
    supports: tuple[Support, ...] = ()
    interfaces: tuple[Interface, ...] = ()
    tools: dict[str, Tool] = Field(default_factory=dict)
    """Rigid tools of an exact shape, which move along a path."""
    path: PathOf | None = None
    """Along which the bodies deform; without it the load of the initial shape is computed."""
    solve: Asked = Asked()

    @model_validator(mode="after")
    def _driven(self) -> "ProblemFile":
        if self.tools and self.path is None:
            raise refused("tools move along a path only", "add a table [path]", "tools")
        if not (self.reference_loads or self.tools):
            raise refused("missing", "add reference_loads", "reference_loads")
        return self

    def program(self) -> Program:
        """Return the calls that make the problem.

        Raises:
            MisfitError: a layer, a density or a fill of a body without one.
        """
        call: Call = self.call(())
        bodies: dict[str, Any] = call.arguments["bodies"]
        filled = {load.body for load in (*self.reference_loads, *self.dead_loads) if load.several}
        things: dict[Key, Any] = {}
        for name, body in self.bodies.items():
            if body.kind == DRAWING:
                things[name, DRAWING] = bodies[name]
                bodies[name] = Own((name, DRAWING), "blocks")
            if body.kind == DRAWING or (name in filled and body.kind in _OF_BLOCKS):
                things[name,] = bodies[name]
                bodies[name] = Own((name,))
        for kind in ("reference_loads", "dead_loads"):
            nodes = call.arguments.get(kind, [])
            for place, load in enumerate(getattr(self, kind)):
                if load.several:
                    number = sum(key[:2] == (load.body, load.several) for key in things)
                    key = (load.body, load.several, *([str(number + 1)] if number else []))
                    things[key], nodes[place] = nodes[place], Spread(Own(key))
        path = None if self.path is None else self.path.call(("path",))
        if path is not None and self.tools:
            tools = {name: tool.call(("tools", name)) for name, tool in self.tools.items()}
            path = replace(path, arguments={**path.arguments, "tools": tools})
        own = {} if path is None else {**path.arguments, "problem": None}
        self._require(things, [*things.values(), call, own])
        return Program(things, call, path)

    def _require(self, things: Mapping[Key, Any], nodes: Iterable[Any]) -> None:
        """Raise `MisfitError` if bodies do not have the features that the file uses."""
        wrong: list[tuple[InputError, Path]] = []
        for own in owned(nodes):
            if own.thing in things:
                continue
            body = own.thing[0]
            if body in self.bodies:
                wrong.append((InputError("body", None, *own.unless), own.at))
            else:
                error = InputError("body", body, "no such body", suggest(body, self.bodies))
                wrong.append((error, (*own.entry, "body")))
        if wrong:
            raise MisfitError(*wrong)

    def arguments(self, at: Path) -> dict[str, Any]:
        """Return its arguments, see `Entry.arguments`."""
        given = super().arguments(at)
        for name in ("title", "tools", "path", "solve"):
            given.pop(name, None)
        return {name: list(own) if isinstance(own, tuple) else own for name, own in given.items()}
