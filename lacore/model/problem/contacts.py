"""Checks of the interfaces of a problem: each place once, and each body connected."""

from collections.abc import Mapping, Sequence, Set

import numpy as np

from lacore.model.bodies.any_body import AnyBody
from lacore.model.bodies.touching import Touched
from lacore.model.conditions.loads import Fix
from lacore.model.contact.interfaces import Interface
from lacore.model.contact.touching import Touching
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting import terms
from lacore.reporting.errors import InputError
from lacore.reporting.text import text

_SAME_NORMAL = 9  # digits to which the normals of two faces are compared
_Place = tuple[str, int, tuple[float, float]]  # body, edge, and for a node the normal of its face


def check_contacts(
    bodies: Mapping[str, AnyBody],
    interfaces: Sequence[Interface],
    touching: Sequence[Touching],
    supports: Sequence[Fix],
    met: Mapping[str, Ints],
    footed: Set[str],
) -> None:
    """Reject invalid contact.

    Args:
        bodies, interfaces, touching, supports, met: see `lacore.model.problem.problem.Problem`.
        footed: names of the bodies under footings.

    Raises:
        InputError: interfaces that do not touch or share a place, bodies without contact, or blocks
            with none, or with corners only.
    """
    touched: dict[str, list[Touched]] = {name: [] for name in bodies}
    for index, interface in enumerate(interfaces):
        alone = interface.obstacle is not None
        sides = zip(interface.sides, touching[index].edges, strict=False)
        for (name, _), edges in sides:
            field = f"Problem.interfaces[{index}]"
            touched[name].append(Touched(field, interface.name, edges, alone))
    for name, edges in met.items():
        touched[name].append(Touched("Problem.interfaces", name, edges, False))
    _check_bonds(bodies, interfaces)
    _check_sharing(bodies, interfaces, touching)
    held = {support.body for support in supports} | set(met) | footed
    _check_joined(bodies, held | {name for own in interfaces for name, _ in own.sides})
    for name, body in bodies.items():
        own = [support for support in supports if support.body == name]
        body.check_contact(f"Problem.bodies[{name!r}]", own, touched[name])


def _check_bonds(bodies: Mapping[str, AnyBody], interfaces: Sequence[Interface]) -> None:
    """Reject bonds that are not along edges."""
    for index, interface in enumerate(interfaces):
        if not interface.bonded:
            continue
        if any(bodies[name].pointwise for name, _ in interface.sides):
            raise InputError(
                f"Problem.interfaces[{index}].friction",
                "BOND",
                f"{interface.name}: a node of a frame has no edge along which it could be bonded",
                text("give it a friction, or hold the node by a {}", terms.SUPPORT),
            )


def _check_sharing(
    bodies: Mapping[str, AnyBody], interfaces: Sequence[Interface], touching: Sequence[Touching]
) -> None:
    """Reject two interfaces at one place: an edge may meet several bodies, each of them once."""
    taken: dict[_Place, dict[_Place, int]] = {}
    for index, (interface, segments) in enumerate(zip(interfaces, touching, strict=True)):
        sides = zip(interface.sides, segments.edges, strict=False)
        ends = [_places(bodies[name], name, edges, segments.normal) for (name, _), edges in sides]
        for one, other in zip(ends[0], ends[-1], strict=True):
            for edge, facing in {one: other, other: one}.items():
                known = taken.setdefault(edge, {})
                whole = edge == facing  # that is, against an obstacle
                clash = [k for f, k in known.items() if whole or f in (edge, facing)]
                if clash and clash[0] != index:
                    raise InputError(
                        f"Problem.interfaces[{index}]",
                        interface.name,
                        f"shares boundary edges with Problem.interfaces[{clash[0]}]",
                        "give each part of a boundary one interface",
                    )
                known[facing] = index


def _places(body: AnyBody, name: str, edges: Ints, normal: Floats) -> list[_Place]:
    """Return the keys of edges; a node of a frame may be in a corner, against two faces."""
    if not body.pointwise:
        return [(name, int(edge), (0.0, 0.0)) for edge in edges]
    turned = (np.round(normal.T, _SAME_NORMAL) + 0.0).tolist()
    return [(name, int(node), (x, y)) for node, (x, y) in zip(edges, turned, strict=True)]


def _check_joined(bodies: Mapping[str, AnyBody], held: Set[str]) -> None:
    """Reject one of several bodies without an interface or a support."""
    loose = [name for name in bodies if name not in held]
    if loose and len(bodies) > 1:
        raise InputError(
            "Problem.bodies",
            loose[0],
            "this body touches nothing: no interface, no support",
            "give it an Interface with what it touches, or a support, or leave it out",
        )
