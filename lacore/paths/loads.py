"""Loads and supports that a path cannot follow."""

from functools import singledispatch
from typing import Any

from lacore.conditions.body_forces import BodyForce
from lacore.conditions.loads import Load
from lacore.conditions.water import PorePressure, StandingWater
from lacore.errors import InputError
from lacore.reporting import terms
from lacore.reporting.text import Term, text


@singledispatch
def check_load(load: Load, field: str) -> None:
    """Refuse loads that do not go along with bodies as these deform."""


@check_load.register(PorePressure)
@check_load.register(StandingWater)
def _no_water(load: PorePressure | StandingWater, field: str) -> None:
    raise InputError(
        field,
        load.told,
        "water at rest has its surface where it is, and the vertices of a body that flows far leave"
        " it",
        text(
            "leave it out, or give {} along the boundary; `solve` takes it in the shape that is"
            " given",
            terms.PRESSURE,
        ),
    )


@check_load.register(BodyForce)
def _uniform(load: BodyForce, field: str) -> None:
    if not load.uniform:
        raise InputError(
            field,
            load.told,
            "varies by place or by element, and the body moves and gets other meshes",
            text(
                "give a number for each region{}",
                Term(": BodyForce(body, (x, y), where=region)", " (where = region)"),
            ),
        )


def of_block(part: Any, kind: str) -> Any:
    """A load or support of a whole rigid block: a function of coordinates would lose it."""
    if callable(part.where):
        raise InputError(
            f"{kind}.where",
            None,
            f"a function of coordinates, and the rigid block {part.body!r} moves away from them",
            text(
                "give the name of the block, 'block' of a {}, or a {}",
                terms.RIGID_BLOCK,
                Term("PointForce", "point force"),
            ),
        )
    return part
