"""Restrictions on axisymmetric bodies (T27): x is the radius r >= 0, y the axis z."""

from collections.abc import Mapping, Sequence
from functools import singledispatch

import numpy as np

from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body, on_axis
from lacore.model.bodies.continuum.boundaries import boundary_facets
from lacore.model.conditions.footings import RigidFooting
from lacore.model.conditions.loads import Fix, Load, PointForce, SurfaceLoad
from lacore.model.conditions.water import StandingWater
from lacore.model.conditions.where import Where
from lacore.model.contact.interfaces import Interface
from lacore.reporting import terms
from lacore.reporting.errors import InputError
from lacore.reporting.text import Term, text

_ROUND_OFF = 1e-12  # by a direction of length 1


def check_axisymmetry(
    bodies: Mapping[str, object],
    loads: Mapping[str, Load],
    supports: Sequence[Fix],
    interfaces: Sequence[Interface],
) -> None:
    """Reject anything without a meaning for an axisymmetric body; do nothing without one.

    Args:
        bodies: bodies of a problem.
        loads: loads by field.
        supports, interfaces: supports and interfaces of the problem.

    Raises:
        InputError: bodies of other kinematics next to it, a footing or a force on the axis that
            moves across it, loads, supports of u_z or interfaces along the axis.
    """
    continua = of_kind(bodies, Body)
    round_ones = {name: body for name, body in continua.items() if body.axisymmetric}
    if not round_ones:
        return
    for name, body in bodies.items():
        if name not in round_ones:
            raise InputError(
                f"Problem.bodies[{name!r}]",
                continua[name].kinematics if name in continua else type(body).__name__,
                "plane, in a problem with an axisymmetric body",
                text(
                    "make it {} too, or a {}",
                    Term("a Body(kinematics='axisymmetric')", 'kinematics = "axisymmetric"'),
                    terms.OBSTACLE,
                ),
            )
    for field, load in loads.items():
        _check_load(load, field, round_ones[load.body])
    for index, support in enumerate(supports):
        if support.components not in ("x", "normal"):
            field = f"Problem.supports[{index}].where"
            _check_off_axis(round_ones[support.body], support.where, field)
    for index, interface in enumerate(interfaces):
        for side, part in zip(("slave", "master"), interface.sides, strict=False):
            field = f"Problem.interfaces[{index}].{side}"
            _check_off_axis(round_ones[part[0]], part[1], field)


@singledispatch
def _check_load(load: Load, field: str, body: Body) -> None:
    """Reject a load without a meaning on an axisymmetric body; all body forces have one."""


@_check_load.register(SurfaceLoad)
@_check_load.register(StandingWater)
def _check_boundary(load: SurfaceLoad | StandingWater, field: str, body: Body) -> None:
    _check_off_axis(body, load.where, f"{field}.where")


@_check_load.register(RigidFooting)
def _check_footing(load: RigidFooting, field: str, body: Body) -> None:
    if abs(load.direction[0]) > _ROUND_OFF:
        raise InputError(
            f"{field}.direction",
            load.direction,
            "a rigid ring cannot move along r",
            text(
                "give (0, 1) or (0, -1), along the axis z; along r {} or {}",
                Term("a Pressure", 'load = "pressure"'),
                Term("a Traction", 'load = "traction"'),
            ),
        )
    _check_off_axis(body, load.where, f"{field}.where")


@_check_load.register(PointForce)
def _check_point(load: PointForce, field: str, body: Body) -> None:
    at = load.point
    if load.vector[0] and at is not None and on_axis(body, np.reshape(at, (2, 1)))[0]:
        raise InputError(
            f"{field}.vector",
            load.vector,
            "a force across the axis, on the axis, where nothing moves along r",
            "give a vector along z, or another point",
        )


def _check_off_axis(body: Body, where: Where, field: str) -> None:
    facets = boundary_facets(body.mesh, where, field)
    ends = body.mesh.p[:, body.mesh.facets[:, facets]]
    if np.any(on_axis(body, ends).all(axis=0)):
        raise InputError(
            field,
            None if callable(where) else where,
            "has edges on the axis r = 0, which is no boundary of the body",
            "leave it out: u_r = 0 there by itself",
        )
