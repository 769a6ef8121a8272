"""Checks of the interfaces of a problem: each place once, and each body connected."""

from typing import TYPE_CHECKING

import numpy as np

from lacore.model.bodies.touching import Touched
from lacore.model.conditions.footings import footings
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting import terms
from lacore.reporting.errors import InputError
from lacore.reporting.text import text

if TYPE_CHECKING:
    from lacore.model.problem.problem import Problem

_SAME_NORMAL = 9  # digits to which the normals of two faces are compared
_Place = tuple[str, int, tuple[float, float]]  # body, edge, and for a node the normal of its face


def check_contacts(problem: "Problem") -> None:
    """Reject invalid contact.

    Raises:
        InputError: interfaces that do not touch or share a place, bodies without contact, or blocks
            with none, or with corners only.
    """
    touched: dict[str, list[Touched]] = {name: [] for name in problem.bodies}
    for index, interface in enumerate(problem.interfaces):
        alone = interface.obstacle is not None
        sides = zip(interface.sides, problem.touching[index].edges, strict=False)
        for (name, _), edges in sides:
            field = f"Problem.interfaces[{index}]"
            touched[name].append(Touched(field, interface.name, edges, alone))
    for name, edges in problem.met.items():
        touched[name].append(Touched("Problem.interfaces", name, edges, False))
    _check_bonds(problem)
    _check_sharing(problem)
    _check_joined(problem)
    for name, body in problem.bodies.items():
        supports = [support for support in problem.supports if support.body == name]
        body.check_contact(f"Problem.bodies[{name!r}]", supports, touched[name])


def _check_bonds(problem: "Problem") -> None:
    """Reject bonds that are not along edges."""
    for index, interface in enumerate(problem.interfaces):
        if not interface.bonded:
            continue
        bodies = [problem.bodies[name] for name, _ in interface.sides]
        if any(body.pointwise for body in bodies):
            raise InputError(
                f"Problem.interfaces[{index}].friction",
                "BOND",
                f"{interface.name}: a node of a frame has no edge along which it could be bonded",
                text("give it a friction, or hold the node by a {}", terms.SUPPORT),
            )


def _check_sharing(problem: "Problem") -> None:
    """Reject two interfaces at one place: an edge may meet several bodies, each of them once."""
    taken: dict[_Place, dict[_Place, int]] = {}
    for index, (interface, segments) in enumerate(
        zip(problem.interfaces, problem.touching, strict=True)
    ):
        sides = zip(interface.sides, segments.edges, strict=False)
        ends = [_places(problem, name, edges, segments.normal) for (name, _), edges in sides]
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


def _places(problem: "Problem", name: str, edges: Ints, normal: Floats) -> list[_Place]:
    """Return the keys of edges; a node of a frame may be in a corner, against two faces."""
    if not problem.bodies[name].pointwise:
        return [(name, int(edge), (0.0, 0.0)) for edge in edges]
    turned = (np.round(normal.T, _SAME_NORMAL) + 0.0).tolist()
    return [(name, int(node), (x, y)) for node, (x, y) in zip(edges, turned, strict=True)]


def _check_joined(problem: "Problem") -> None:
    """Reject one of several bodies without an interface or a support."""
    held = {support.body for support in problem.supports} | set(problem.met)
    held |= {name for interface in problem.interfaces for name, _ in interface.sides}
    held |= {footing.body for footing in footings(problem.loads.values())}
    loose = [name for name in problem.bodies if name not in held]
    if loose and len(problem.bodies) > 1:
        raise InputError(
            "Problem.bodies",
            loose[0],
            "this body touches nothing: no interface, no support",
            "give it an Interface with what it touches, or a support, or leave it out",
        )
