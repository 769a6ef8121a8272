"""Numbers of a problem, and the problem with one of them changed."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import singledispatch
from math import isfinite
from types import MappingProxyType
from typing import Any

from lacore.analyses.places import fixed_places, places
from lacore.model.bodies.any_body import AnyBody, of_kind
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.frames.frame import Frame
from lacore.model.bodies.frames.section import Section
from lacore.model.conditions.body_forces import BodyForce
from lacore.model.conditions.footings import Twist
from lacore.model.conditions.loads import Load, PointForce, Traction
from lacore.model.conditions.water import PorePressure, StandingWater
from lacore.model.materials.fields import Field
from lacore.model.problem.problem import Problem
from lacore.reporting.errors import is_number
from lacore.reporting.text import text

Changed = Callable[[Problem, float], Problem]
_UNITS = {  # units of the numbers of materials and friction; all others are stresses
    **dict.fromkeys(("mu", "rate", "offset", "exponent"), ""),
    **dict.fromkeys(("friction_angle", "dilation_angle"), "deg"),
}
STRENGTH, LOAD, PLACE, OWN = "strength", "load", "place", "own"


@dataclass(frozen=True)
class Parameter:
    """Number of a problem.

    Attributes:
        name: its name in the problem.
        kind: ``strength``, ``load``, ``place``, or ``own`` for user-defined ones.
        value: value in the problem; for a load its size.
        size: scale of its changes: the value, or for a place the size of its body.
        at: function that returns the problem with another value.
        unit: unit of the value, SI and per unit thickness; ``deg`` for angles, empty for ratios.
        body: its body; empty for none, or for several.
    """

    name: str
    kind: str
    value: float
    size: float
    at: Changed
    unit: str = ""
    body: str = ""


def parameters_of(problem: Problem) -> list[Parameter]:
    """Return all numbers of a problem by which a load factor can be differentiated."""
    found = []
    for name, body in problem.bodies.items():
        for field, thing, plain in _strong(body):
            for path, value, unit, changed in _numbers(thing, plain):
                title, at = f"{name}: {field}{path}", _of_body(name, field, changed)
                found.append(Parameter(title, STRENGTH, value, value, at, unit, name))
    for index, pair in enumerate(problem.interfaces):
        for path, value, unit, changed in _numbers(pair.law):
            title = text("{}: friction{}", pair.name, path)
            at = _of_interface(index, changed)
            found.append(Parameter(title, STRENGTH, value, value, at, unit))
    for attribute in ("reference_loads", "dead_loads"):
        for index, load in enumerate(getattr(problem, attribute)):
            size = size_of(load)
            if size is not None:
                name = text("{}[{}]: {}", attribute, index, load.told)
                at, unit = _of_load(attribute, index, size), unit_of(load, problem.bodies)
                found.append(Parameter(name, LOAD, size, size, at, unit, load.body))
    for place in places(problem):
        own = Parameter(place.name, PLACE, place.value, place.size, place.at, "m", place.body)
        found.append(own)
    return found


def without_parameter(problem: Problem) -> tuple[str, ...]:
    """Return what the table leaves out, and why, for the message."""
    loads = [load.told for load in problem.loads.values() if size_of(load) is None]
    return (
        *(text("{} (no single size)", told) for told in loads),
        *(f"{name} (its members must remain straight)" for name in fixed_places(problem)),
    )


@singledispatch
def _strong(body: AnyBody) -> Iterator[tuple[str, Any, str]]:
    """Yield the strengths of a body: the name of the field, and the unit of its numbers."""
    raise TypeError(type(body).__name__)


@_strong.register(Body)
def _criterion(body: Body) -> Iterator[tuple[str, Any, str]]:
    yield "criterion", body.criterion, "Pa"


@_strong.register(BlockAssembly)
@_strong.register(BlockAssembly3D)
def _joints(body: BlockAssembly | BlockAssembly3D) -> Iterator[tuple[str, Any, str]]:
    yield "friction", body.friction, ""
    if body.joint_friction:
        yield "joint_friction", body.joint_friction, ""


@_strong.register(Frame)
def _members(body: Frame) -> Iterator[tuple[str, Any, str]]:
    yield "plastic_moment", body.plastic_moment, "N"
    yield "sections", body.sections, "N"


_Number = tuple[str, float, str, Callable[[float], Any]]
"""Number: its name, value, unit, and a function that returns the thing with another value."""


def _numbers(thing: Any, unit: str = "") -> Iterator[_Number]:
    """Yield the positive numbers in a thing."""
    if is_number(thing) and thing > 0:
        yield "", float(thing), unit, lambda value: value
    elif isinstance(thing, Section):
        yield from _in_section(thing)
    elif isinstance(thing, Field):  # The steepest slope is not a strength.
        yield " (factor)", float(thing.factor), "", lambda value: thing * (value / thing.factor)
    elif isinstance(thing, Mapping):
        for key, own in thing.items():
            for path, value, own_unit, changed in _numbers(own, unit):
                yield f"[{key!r}]{path}", value, own_unit, _in_mapping(thing, key, changed)
    elif is_dataclass(thing) and not isinstance(thing, type):
        yield from _in_fields(thing)


def _in_section(section: Section) -> Iterator[_Number]:
    """Yield the strength of a section, its plastic moment or its squash load."""
    size = section.plastic_moment or section.squash_load
    if isfinite(size) and size > 0:
        unit = "N" if section.plastic_moment else "N/m"
        yield " (strength)", size, unit, _stronger(section, size)


def _in_fields(thing: Any) -> Iterator[_Number]:
    """Yield the numbers in the fields of a dataclass that its constructor takes."""
    for entry in fields(thing):
        own = getattr(thing, entry.name)
        if not entry.init or isinstance(own, bool):
            continue
        if is_number(own) or is_dataclass(own) or isinstance(own, Mapping):
            for path, value, unit, changed in _numbers(own, _UNITS.get(entry.name, "Pa")):
                yield f".{entry.name}{path}", value, unit, _in_field(thing, entry.name, changed)


def _stronger(section: Section, size: float) -> Callable[[float], Section]:
    """Return a section whose moments and forces are scaled together."""

    def changed(value: float) -> Section:
        factor = value / size
        upper, lower, other = (
            side if side is None else tuple((factor * axial, factor * own) for axial, own in side)
            for side in (section.corners, section.lower, section.other)
        )
        assert upper is not None
        return replace(section, corners=upper, lower=lower, other=other)

    return changed


def _in_mapping(
    thing: Mapping[Any, Any], key: Any, changed: Callable[[float], Any]
) -> Callable[[float], Any]:
    return lambda value: MappingProxyType({**thing, key: changed(value)})


def _in_field(thing: Any, name: str, changed: Callable[[float], Any]) -> Callable[[float], Any]:
    return lambda value: replace(thing, **{name: changed(value)})


def _of_body(name: str, field: str, changed: Callable[[float], Any]) -> Changed:
    def at(problem: Problem, value: float) -> Problem:
        body: Any = replace(problem.bodies[name], **{field: changed(value)})
        return replace(problem, bodies={**problem.bodies, name: body})

    return at


def _of_interface(index: int, changed: Callable[[float], Any]) -> Changed:
    def at(problem: Problem, value: float) -> Problem:
        pairs = list(problem.interfaces)
        pairs[index] = replace(pairs[index], friction=changed(value))
        return replace(problem, interfaces=pairs)

    return at


def _of_load(attribute: str, index: int, size: float) -> Changed:
    def at(problem: Problem, value: float) -> Problem:
        loads = list(getattr(problem, attribute))
        loads[index] = times(loads[index], value / size)
        return problem.with_loads(**{attribute: loads})

    return at


def size_of(load: Load) -> float | None:
    """Return the size of a load; None for water, which has no single one."""
    return None if isinstance(load, PorePressure | StandingWater) else load.size


@singledispatch
def unit_of(load: Load, bodies: Mapping[str, AnyBody]) -> str:
    """Return the unit of the size of a load: a pressure, unless it is of another kind."""
    return "Pa"


@unit_of.register(Traction)
def _along_members(load: Traction, bodies: Mapping[str, AnyBody]) -> str:
    return "N/m per m" if load.body in of_kind(bodies, Frame) else "Pa"


@unit_of.register(PointForce)
def _of_force(load: PointForce, bodies: Mapping[str, AnyBody]) -> str:
    own = bodies[load.body]
    return "N" if own.axisymmetric or own.dimension == 3 else "N/m"


@unit_of.register(Twist)
def _of_torque(load: Twist, bodies: Mapping[str, AnyBody]) -> str:
    return "N m"


@unit_of.register(BodyForce)
def _of_weight(load: BodyForce, bodies: Mapping[str, AnyBody]) -> str:
    return "N/m^3" if load.uniform else ""


def times(load: Load, factor: float) -> Load:
    """Return a load with another size."""
    assert not isinstance(load, PorePressure | StandingWater)
    return load.times(factor)
