"""The problem of the user: bodies, supports, interfaces, loads.

Immutable, and checked when built.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from lacore.model.bodies.any_body import KINDS, AnyBody
from lacore.model.conditions.footings import footings
from lacore.model.conditions.loads import Fix, Load, acts
from lacore.model.contact.interfaces import Interface
from lacore.model.contact.segments import Segments
from lacore.model.contact.touching import Touching, in_plane, where_touching
from lacore.model.problem.axisymmetry import check_axisymmetry
from lacore.model.problem.contacts import check_contacts
from lacore.model.problem.dimensions import (
    check_interface_dimension,
    check_load_dimension,
    check_support_dimension,
    dimension_of,
)
from lacore.model.problem.wet import check_wet
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting import terms, views
from lacore.reporting.errors import InputError, suggest
from lacore.reporting.showing import Facts, Picture, Shown, counted, listed, short
from lacore.reporting.text import Term, sizes, text

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class Problem(Shown):
    """Limit analysis problem: find the load factor alpha of ``alpha F0 + Fd`` at collapse (T5).

    Attributes:
        bodies: named bodies; frames with a node wherever a `PointForce` acts on a member.
        reference_loads: the loads that the load factor multiplies (F0); empty for
            `lacore.sequential` with tools, which drive the problem.
        supports: fixed boundaries.
        interfaces: contact with friction.
        dead_loads: permanent loads (Fd).

    Raises:
        InputError: any invalid input: see the messages.

    Example:
        >>> mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2)
        >>> problem = la.Problem(
        ...     bodies={"block": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        ...     supports=[la.Fix("block", "bottom")],
        ...     reference_loads=[la.Pressure("block", "top", value=1.0)],
        ...     dead_loads=[la.BodyForce("block", (0, -0.1))],
        ... )
        >>> print(problem)
        Problem: 1 body, 1 support, 1 reference load, 1 dead load
          bodies      block: 32 triangles, plane_strain, p2-vertex, k = 1 Pa
          supports    xy of block.bottom
          interfaces  none
          reference   pressure 1 Pa on block.top
          dead        (0, -0.1) N/m^3 in block
    """

    bodies: Mapping[str, AnyBody]
    reference_loads: Sequence[Load] = ()
    supports: Sequence[Fix] = ()
    interfaces: Sequence[Interface] = ()
    dead_loads: Sequence[Load] = field(default=())

    def __reduce__(self) -> tuple[type, tuple[Any, ...]]:
        """Pickle by the arguments; predicates on coordinates must be named functions for it."""
        given = {entry.name: getattr(self, entry.name) for entry in fields(self)}
        return type(self), tuple((given | {"bodies": dict(self.bodies)}).values())

    def with_loads(
        self,
        reference_loads: Sequence[Load] | None = None,
        dead_loads: Sequence[Load] | None = None,
    ) -> Problem:
        """Return the same structure under other loads; loads that are not given are kept.

        Raises:
            InputError: invalid loads.
        """
        live = self.reference_loads if reference_loads is None else reference_loads
        dead = self.dead_loads if dead_loads is None else dead_loads
        return replace(self, reference_loads=live, dead_loads=dead)

    def plot(self) -> Figure:
        """Plot a sketch of the problem: see `lacore.pictures.sketch.problem.plot_problem`."""
        return views.picture(self)

    @property
    def sizes(self) -> list[float]:
        """Return its loads and strengths, in SI, by which units for it are chosen."""
        loads = [load.told for load in self.loads.values()]
        return sizes([*loads, *(body.contents for body in self.bodies.values())])

    def facts(self) -> Facts:
        """Return the contents, for printing."""
        parts = {
            "bodies": [f"{name}: {own.contents}" for name, own in self.bodies.items()],
            "supports": [own.told for own in self.supports],
            "interfaces": [f"{own.name}: {short(own.law)}" for own in self.interfaces],
            "reference": [own.told for own in self.reference_loads],
            "dead": [own.told for own in self.dead_loads],
        }
        kinds = ("support", "interface", "reference load", "dead load")
        counts = ["1 body" if len(self.bodies) == 1 else f"{len(self.bodies)} bodies"]
        for kind, own in zip(kinds, list(parts.values())[1:], strict=True):
            counts += [counted(len(own), kind)] if own else []
        told = {kind: listed(own) or "none" for kind, own in parts.items()}
        return Facts(", ".join(counts), told, "Problem")

    def picture(self) -> Picture:
        """Return the figure of `plot`."""
        return Picture(self.plot())

    def __post_init__(self) -> None:
        _check_bodies(self.bodies)
        object.__setattr__(self, "bodies", MappingProxyType(dict(self.bodies)))
        for attribute in ("reference_loads", "supports", "interfaces", "dead_loads"):
            given = getattr(self, attribute)
            if not isinstance(given, Sequence):
                raise InputError(f"Problem.{attribute}", given, "not a list", "put it in [ ]")
            object.__setattr__(self, attribute, tuple(given))
        dimension = self._checked_loads()
        self._check_supports(dimension)
        self._check_interfaces(dimension)
        footed = {footing.body for footing in footings(self.loads.values())}
        check_contacts(self.bodies, self.interfaces, self.touching, self.supports, self.met, footed)
        check_wet(self.loads, self.interfaces)
        check_axisymmetry(
            {name: body for name, body in self.bodies.items() if name not in self.driven},
            {where: load for where, load in self.loads.items() if load.body not in self.driven},
            self.supports,
            self.interfaces,
        )

    def _checked_loads(self) -> int:
        """Check the loads, split the frames where they act, and return the dimension."""
        for where, load in self.loads.items():
            if not isinstance(load, Load):
                raise InputError(where, load, "not a load", "give lacore.Traction, Pressure, ...")
        if self.reference_loads and not any(map(acts, self.reference_loads)):
            raise InputError(
                "Problem.reference_loads",
                self.reference_loads[0].told,
                "is zero, so there is nothing that the load factor could multiply",
                "give at least one load that is not",
            )
        dimension = dimension_of(self.bodies)
        for where, load in self.loads.items():
            self._body(load.body, where)
            check_load_dimension(load, where, dimension)
        self._split_frames()
        for where, load in self.loads.items():
            with _located(where):
                self.bodies[load.body].check_load(load, where)
        return dimension

    def _check_supports(self, dimension: int) -> None:
        """Check the supports, in the components that the dimension has."""
        for index, support in enumerate(self.supports):
            if not isinstance(support, Fix):
                where = f"Problem.supports[{index}]"
                raise InputError(where, support, "not a support", "give lacore.Fix")
        supports = tuple(support.of(dimension) for support in self.supports)
        object.__setattr__(self, "supports", supports)
        for index, support in enumerate(self.supports):
            where = f"Problem.supports[{index}]"
            body = self._body(support.body, where)
            check_support_dimension(support, where, dimension)
            with _located(where):
                body.check_support(support, where)

    def _check_interfaces(self, dimension: int) -> None:
        """Check the kinds, bodies and obstacles of the interfaces, each by itself."""
        for index, interface in enumerate(self.interfaces):
            where = f"Problem.interfaces[{index}]"
            if not isinstance(interface, Interface):
                raise InputError(where, interface, "not an interface", "give lacore.Interface")
            for side, (name, _) in zip(("slave", "master"), interface.sides, strict=False):
                self._body(name, f"{where}.{side}")
            if interface.self_contact:
                raise InputError(
                    f"{where}.master",
                    interface.slave[0],
                    "a body in contact with itself",
                    text(
                        "make its parts bodies of their own (blocks of one assembly find their"
                        " joints), or follow it along a path and give the interface in {}",
                        terms.APPROACHING,
                    ),
                )
            check_interface_dimension(interface, where, dimension)

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return dimension_of(self.bodies)

    @cached_property
    def touching(self) -> tuple[Touching, ...]:
        """Contact of the two sides of each interface."""
        return tuple(
            where_touching(interface, self.bodies, f"Problem.interfaces[{index}]")
            for index, interface in enumerate(self.interfaces)
        )

    @property
    def met(self) -> Mapping[str, Ints]:
        """Edges by body that other bodies may meet, in contact defined elsewhere: none."""
        return {}

    @property
    def driven(self) -> Mapping[str, Floats]:
        """Common motions of driven rigid blocks by body, (u_x, u_y, rotation): none."""
        return {}

    @property
    def segments(self) -> tuple[Segments, ...]:
        """As `touching`, for a plane problem."""
        return tuple(map(in_plane, self.touching))

    @property
    def bonds(self) -> tuple[tuple[int, Interface, Segments], ...]:
        """Bonded interfaces, their numbers, and their segments; none in three dimensions."""
        return tuple(
            (index, interface, in_plane(self.touching[index]))
            for index, interface in enumerate(self.interfaces)
            if interface.bonded
        )

    @property
    def loads(self) -> dict[str, Load]:
        """All loads by the field that they were given in."""
        return {
            f"Problem.{attribute}[{index}]": load
            for attribute in ("reference_loads", "dead_loads")
            for index, load in enumerate(getattr(self, attribute))
        }

    def _split_frames(self) -> None:
        """Add a node wherever a point force acts on a member: it may hinge there."""
        bodies = dict(self.bodies)
        for load in (*self.reference_loads, *self.dead_loads):
            if load.point is not None and load.body in bodies:
                bodies[load.body] = bodies[load.body].with_points([load.point])
        object.__setattr__(self, "bodies", MappingProxyType(bodies))

    def _body(self, name: str, where: str) -> AnyBody:
        if not isinstance(name, str) or name not in self.bodies:
            raise InputError(f"{where}.body", name, "no such body", suggest(str(name), self.bodies))
        return self.bodies[name]


def _check_bodies(bodies: Any) -> None:
    """Require bodies with names."""
    if not isinstance(bodies, Mapping) or not bodies:
        raise InputError(
            "Problem.bodies",
            None,
            "there is none with a name",
            text(
                "give {}",
                Term("bodies={'name': Body(...)}", "one as a table, such as [bodies.NAME]"),
            ),
        )
    for name, body in bodies.items():
        if not isinstance(name, str):
            raise InputError("Problem.bodies", name, "not a name", "give a text, 'soil'")
        if not isinstance(body, KINDS):
            raise InputError(
                f"Problem.bodies[{name!r}]",
                body,
                "not a Body",
                "give a lacore.Body, BlockAssembly, Frame or BlockAssembly3D",
            )


@contextmanager
def _located(where: str) -> Iterator[None]:
    """Add the entry of the problem to an error of ``BodyForce.where``."""
    try:
        yield
    except InputError as error:
        if error.field.startswith("Problem."):
            raise
        field = f"{where}.{error.field.partition('.')[2]}".rstrip(".")
        raise InputError(field, error.value, error.reason, error.fix) from error
