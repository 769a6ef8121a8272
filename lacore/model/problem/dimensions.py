"""Check that a problem is plane or three-dimensional throughout."""

from collections.abc import Mapping, Sequence
from functools import singledispatch
from typing import Protocol

from lacore.model.conditions.body_forces import BodyForce
from lacore.model.conditions.footings import RigidFooting, Twist
from lacore.model.conditions.loads import COMPONENTS, Fix, Load, PointForce, Traction
from lacore.model.contact.interfaces import Interface
from lacore.reporting import terms
from lacore.reporting.errors import InputError
from lacore.reporting.text import text

SPACES = {2: "the plane", 3: "space"}
_AXES = {2: "(x, y)", 3: "(x, y, z)"}


class Spatial(Protocol):
    """Object with a known dimension."""

    @property
    def dimension(self) -> int:
        """2, or 3."""
        ...

    @property
    def deforms(self) -> bool:
        """Whether it is a continuum."""
        ...


def dimension_of(bodies: Mapping[str, Spatial]) -> int:
    """Return the dimension of all bodies.

    Raises:
        InputError: plane bodies next to three-dimensional ones.
    """
    own = {name: body.dimension for name, body in bodies.items()}
    plane, solid = ([name for name, dim in own.items() if dim == wanted] for wanted in (2, 3))
    if plane and solid:
        raise InputError(
            f"Problem.bodies[{solid[0]!r}]",
            type(bodies[solid[0]]).__name__,
            f"a three-dimensional body together with {plane[0]!r}, a plane"
            f" {type(bodies[plane[0]]).__name__}",
            "make both of one kind, or two problems of them",
        )
    deforming = [name for name in solid if bodies[name].deforms]
    if 0 < len(deforming) < len(solid):
        raise InputError(
            f"Problem.bodies[{deforming[0]!r}]",
            type(bodies[deforming[0]]).__name__,
            "contact between a body of tetrahedra and rigid blocks is not supported",
            "make two problems of them",
        )
    return 3 if solid else 2


def check_load_dimension(load: Load, field: str, dimension: int) -> None:
    """Raise `InputError` where a vector or a place of a load is of another space than its body."""
    if isinstance(load, Twist) and dimension == 2:
        why = "a plate that twists turns about an axis in three dimensions, and the body is plane"
        fix = "give a three-dimensional body, or another load"
        raise InputError(field, "Twist", why, fix)
    for name, given in _vectors(load).items():
        _require(f"{field}.{name}", given, dimension)


def check_support_dimension(support: Fix, field: str, dimension: int) -> None:
    """Raise `InputError` if a support holds components that bodies of a dimension do not have."""
    if support.components in COMPONENTS[dimension]:
        return
    if dimension == 3 and support.components == "xy":
        why = "in three dimensions that would leave z free"
        fix = "give 'xyz' to hold all; if z is meant to be free, two supports, 'x' and 'y'"
    else:
        why = f"of {SPACES[dimension]} there is no such support"
        fix = f"give one of {', '.join(COMPONENTS[dimension])}"
    raise InputError(f"{field}.components", support.components, why, fix)


def check_interface_dimension(interface: Interface, field: str, dimension: int) -> None:
    """Raise `InputError` where an obstacle is of another space than the body that it touches."""
    if interface.bonded and dimension == 3:
        why = "three-dimensional bodies cannot have bonds that break yet"
        own = "make what never parts one body or polyhedron, hold it by a {}, or give a friction"
        raise InputError(f"{field}.friction", "BOND", why, text(own, terms.SUPPORT))
    obstacle = interface.obstacle
    if obstacle is None:
        return
    if obstacle.shape is not None and dimension == 3:
        why = "faces that are no planes are of two dimensions"
        fix = "give RigidObstacle(point=(x, y, z), normal=(nx, ny, nz))"
        raise InputError(f"{field}.master", obstacle.shape, why, fix)
    if obstacle.point is not None:
        _require(f"{field}.master.point", obstacle.point, dimension)


def _require(field: str, given: Sequence[object], dimension: int) -> None:
    if len(given) != dimension:
        why = f"{len(given)} numbers, where the body is one of {SPACES[dimension]}"
        raise InputError(field, given, why, f"give {_AXES[dimension]}")


@singledispatch
def _vectors(load: Load) -> Mapping[str, Sequence[object]]:
    """Return the vectors and places of a load, by field; empty for most loads."""
    return {}


@_vectors.register(Traction)
@_vectors.register(BodyForce)
def _vector(load: Traction | BodyForce) -> Mapping[str, Sequence[object]]:
    return {"vector": load.vector}


@_vectors.register(PointForce)
def _force(load: PointForce) -> Mapping[str, Sequence[object]]:
    place = {} if load.point is None else {"at": load.point}
    return {"vector": load.vector, **place}


@_vectors.register(RigidFooting)
def _footing(load: RigidFooting) -> Mapping[str, Sequence[object]]:
    return {"direction": load.direction}
