"""Pore water of bodies at obstacles: it also presses in the contact (T64)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import singledispatch

from scipy.spatial import KDTree

from lacore.model.bodies.any_body import AnyBody, of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.water import in_pores
from lacore.model.conditions.loads import Load
from lacore.model.conditions.water import PorePressure, StandingWater
from lacore.model.contact.interfaces import Interface
from lacore.model.meshes.curved import vertices
from lacore.numerics.arrays import Floats
from lacore.reporting import terms
from lacore.reporting.errors import InputError
from lacore.reporting.text import Term, text


def acting(
    loads: Sequence[Load], bodies: Mapping[str, AnyBody], interfaces: Sequence[Interface]
) -> list[Load]:
    """Return loads, and the water between wet bodies and the obstacles that they touch.

    The water presses the bodies back, so that an interface carries the pressure of the skeleton.
    """
    return [*loads, *(more for load in loads for more in _between(load, bodies, interfaces))]


@singledispatch
def _between(
    load: Load, bodies: Mapping[str, AnyBody], interfaces: Sequence[Interface]
) -> list[StandingWater]:
    """Return the water of a load in contacts; none for other loads."""
    return []


@_between.register(PorePressure)
def _of_pores(
    load: PorePressure, bodies: Mapping[str, AnyBody], interfaces: Sequence[Interface]
) -> list[StandingWater]:
    body = of_kind(bodies, Body)[load.body]
    pressure = _AtVertices(vertices(body.mesh), in_pores(load, body.mesh, "PorePressure"))
    tools = (one for one in interfaces if one.obstacle is not None)
    sides = (side for interface in tools for side in interface.sides)
    return [StandingWater(name, where, pressure) for name, where in sides if name == load.body]


@dataclass(frozen=True)
class _AtVertices:
    """Values at vertices of shape (2, n), as a function of their places."""

    places: Floats
    values: Floats

    def __call__(self, x: Floats) -> Floats:
        return self.values[KDTree(self.places.T).query(x.T)[1]]


def check_wet(loads: Mapping[str, Load], interfaces: Sequence[Interface]) -> None:
    """Reject pore pressure in bodies that touch other bodies with pressure-dependent friction.

    The friction would depend on the pressure of the skeleton. Other laws carry the total stress.

    Args:
        loads: loads by field.
        interfaces: interfaces of the problem.

    Raises:
        InputError: such a load; it names its field and the interface.
    """
    for field, load in loads.items():
        for interface in interfaces:
            law, both = interface.law.terms(), [name for name, _ in interface.sides]
            if law.coefficient == law.dilatancy == 0:
                continue
            if len(both) == 2 and load.body in both:
                _refuse(load, field, interface)


@singledispatch
def _refuse(load: Load, field: str, interface: Interface) -> None:
    """Raise `InputError` if a load on a body is incompatible with an interface of two bodies."""


@_refuse.register(PorePressure)
def _refuse_pores(load: PorePressure, field: str, interface: Interface) -> None:
    raise InputError(
        f"{field}.body",
        load.body,
        f"touches another body, {interface.name}, with a friction that pressure adds to: how the"
        " water of the one presses the other across edges that need not match is not stated yet",
        text(
            "give the interface {}, {} or {}, which carry the total stress; or put a {} or a {} in"
            " its place",
            terms.STICK,
            terms.SMOOTH,
            Term("a Tresca friction", "{ limit = ... }"),
            terms.OBSTACLE,
            Term("RigidFooting", "rigid footing"),
        ),
    )
