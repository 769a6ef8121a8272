"""Where water in the pores of a body cannot be stated (T64)."""

from collections.abc import Mapping, Sequence
from functools import singledispatch

from lacore.conditions.loads import Load
from lacore.conditions.water import PorePressure
from lacore.contact.interfaces import Interface
from lacore.errors import InputError


def check_wet(loads: Mapping[str, Load], interfaces: Sequence[Interface]) -> None:
    """Refuse pore pressure in bodies that touch others: it would press in the contact, too.

    Args:
        loads: by the field that they were given in.
        interfaces: of the problem.

    Raises:
        InputError: such a load; it names its field and the interface.
    """
    for field, load in loads.items():
        for interface in interfaces:
            if any(name == load.body for name, _ in interface.sides):
                _refuse(load, field, interface)


@singledispatch
def _refuse(load: Load, field: str, interface: Interface) -> None:
    """Raise `InputError` where a load on a body does not go with an interface of it."""


@_refuse.register(PorePressure)
def _refuse_pores(load: PorePressure, field: str, interface: Interface) -> None:
    raise InputError(
        f"{field}.body",
        load.body,
        f"touches what {interface.name} says: water presses in that contact, too, and friction"
        " there would have to follow what the skeleton presses",
        "hold the boundary by a Fix (components='normal' slides, 'xy' sticks), load it by a"
        " RigidFooting, or mesh both bodies as one",
    )
