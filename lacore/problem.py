"""What the user says: bodies, supports, interfaces, loads. Immutable, and checked when built."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from types import MappingProxyType
from typing import Any

import numpy as np

from lacore.arrays import Ints
from lacore.bodies import Body
from lacore.boundaries import boundary_facets, facet_geometry
from lacore.errors import InputError, suggest
from lacore.interfaces import Interface
from lacore.loads import BodyForce, Fix, Load, PointForce, Pressure, RigidFooting, Traction

_TOUCH = 1e-9  # of the body size: coordinates written in double precision agree to this


@dataclass(frozen=True)
class Problem:
    """A limit analysis problem: find the load factor alpha of ``alpha F0 + Fd`` at collapse (T5).

    Attributes:
        bodies: named bodies.
        reference_loads: the loads that the load factor multiplies (F0).
        supports: fixed boundaries.
        interfaces: contact with friction.
        dead_loads: permanent loads (Fd).

    Raises:
        InputError: anything that cannot be right: see the messages.
    """

    bodies: Mapping[str, Body]
    reference_loads: Sequence[Load]
    supports: Sequence[Fix] = ()
    interfaces: Sequence[Interface] = ()
    dead_loads: Sequence[Load] = field(default=())

    def __reduce__(self) -> tuple[type, tuple[Any, ...]]:
        """Pickle by the arguments; predicates on coordinates must be named functions for it."""
        given = {entry.name: getattr(self, entry.name) for entry in fields(self)}
        return type(self), tuple((given | {"bodies": dict(self.bodies)}).values())

    def __post_init__(self) -> None:
        if not isinstance(self.bodies, Mapping) or not self.bodies:
            raise InputError(
                "Problem.bodies",
                None,
                "there is none with a name",
                "give bodies={'name': Body(...)}",
            )
        for name, body in self.bodies.items():
            if not isinstance(body, Body):
                raise InputError(
                    f"Problem.bodies[{name!r}]", body, "not a Body", "give a lacore.Body"
                )
        object.__setattr__(self, "bodies", MappingProxyType(dict(self.bodies)))
        for attribute in ("reference_loads", "supports", "interfaces", "dead_loads"):
            given = getattr(self, attribute)
            if not isinstance(given, Sequence):
                raise InputError(f"Problem.{attribute}", given, "not a list", "put it in [ ]")
            object.__setattr__(self, attribute, tuple(given))
        if not self.reference_loads:
            raise InputError(
                "Problem.reference_loads",
                None,
                "there is none, so nothing that the load factor could multiply",
                "give at least one load",
            )
        for attribute, items in (
            ("reference_loads", self.reference_loads),
            ("dead_loads", self.dead_loads),
        ):
            for index, load in enumerate(items):
                self._check_load(f"Problem.{attribute}[{index}]", load)
        for index, support in enumerate(self.supports):
            where = f"Problem.supports[{index}]"
            if not isinstance(support, Fix):
                raise InputError(where, support, "not a support", "give lacore.Fix")
            boundary_facets(self._body(support.body, where), support.where, f"{where}.where")
        self._check_interfaces()

    def _body(self, name: str, where: str) -> Body:
        if not isinstance(name, str) or name not in self.bodies:
            raise InputError(f"{where}.body", name, "no such body", suggest(str(name), self.bodies))
        return self.bodies[name]

    def _check_load(self, where: str, load: Load) -> None:
        if not isinstance(load, Traction | Pressure | BodyForce | PointForce | RigidFooting):
            raise InputError(where, load, "not a load", "give lacore.Traction, Pressure, ...")
        body = self._body(load.body, where)
        if isinstance(load, PointForce):
            vertex_at(body, load.at, f"{where}.at")
        elif not isinstance(load, BodyForce):
            boundary_facets(body, load.where, f"{where}.where")

    def _check_interfaces(self) -> None:
        taken: dict[str, list[tuple[int, Ints]]] = {}
        for index, interface in enumerate(self.interfaces):
            where = f"Problem.interfaces[{index}]"
            if not isinstance(interface, Interface):
                raise InputError(where, interface, "not an interface", "give lacore.Interface")
            name, part = interface.slave
            body = self._body(name, f"{where}.slave")
            facets = boundary_facets(body, part, f"{where}.slave")
            _check_touch(body, facets, interface, where)
            for other, others in taken.setdefault(name, []):
                if np.intersect1d(facets, others).size:
                    raise InputError(
                        where,
                        interface.name,
                        f"shares boundary edges with Problem.interfaces[{other}]",
                        "give each part of a boundary one interface",
                    )
            taken[name].append((index, facets))


def vertex_at(body: Body, at: tuple[float, float], where: str) -> int:
    """Index of the mesh vertex at a point; raises `InputError` where there is none."""
    distance = np.linalg.norm(body.mesh.p - np.reshape(at, (2, 1)), axis=0)
    nearest = int(np.argmin(distance))
    if distance[nearest] > _TOUCH * body.size:
        raise InputError(
            where,
            at,
            "no vertex of the mesh is there",
            f"move it to the nearest one, {tuple(body.mesh.p[:, nearest].tolist())}, or the mesh",
        )
    return nearest


def _check_touch(body: Body, facets: Ints, interface: Interface, where: str) -> None:
    master = interface.master
    if master.point is None or master.normal is None:
        return
    start, end, outward = facet_geometry(body, facets)
    normal = np.array(master.normal) / np.linalg.norm(master.normal)
    gap = np.concatenate([normal @ (x - np.reshape(master.point, (2, 1))) for x in (start, end)])
    worst = gap[np.argmax(np.abs(gap))]
    if abs(worst) > _TOUCH * body.size:
        raise InputError(
            where,
            interface.name,
            f"does not touch its obstacle: a vertex lies {abs(worst):.3g} m "
            f"{'above' if worst > 0 else 'inside'} it",
            "move the body or RigidObstacle.point so that the two coincide",
        )
    if np.any(normal @ outward > 0):
        raise InputError(
            where,
            master.normal,
            "the obstacle's normal points out of the body",
            "give the normal from the obstacle into the body",
        )
