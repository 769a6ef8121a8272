"""What the user says: bodies, supports, interfaces, loads. Immutable, and checked when built."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from lacore import views
from lacore.arrays import Floats, Ints
from lacore.bodies.any_body import AnyBody
from lacore.bodies.blocks.block_assembly import BlockAssembly
from lacore.bodies.blocks.corners import resting_corners
from lacore.bodies.blocks.held import free_motions
from lacore.bodies.continuum.body import Body
from lacore.bodies.frames.frame import Frame
from lacore.conditions.loads import (
    BodyForce,
    Fix,
    Load,
    PointForce,
    Pressure,
    RigidFooting,
    Traction,
)
from lacore.contact.interfaces import Interface
from lacore.contact.segments import Segments, interface_segments
from lacore.errors import InputError, suggest
from lacore.problem.axisymmetry import check_axisymmetry
from lacore.showing import Facts, Picture, Shown, counted, listed, short

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SAME_NORMAL = 9  # digits to which the normals of two faces count as one
_Place = tuple[str, int, tuple[float, float]]  # body, edge, and for a node the normal of its face


@dataclass(frozen=True, repr=False)
class Problem(Shown):
    """A limit analysis problem: find the load factor alpha of ``alpha F0 + Fd`` at collapse (T5).

    Attributes:
        bodies: named bodies; frames with a node wherever a `PointForce` acts on a member.
        reference_loads: the loads that the load factor multiplies (F0).
        supports: fixed boundaries.
        interfaces: contact with friction.
        dead_loads: permanent loads (Fd).

    Raises:
        InputError: anything that cannot be right: see the messages.
    """

    bodies: Mapping[str, AnyBody]
    reference_loads: Sequence[Load]
    supports: Sequence[Fix] = ()
    interfaces: Sequence[Interface] = ()
    dead_loads: Sequence[Load] = field(default=())

    def __reduce__(self) -> tuple[type, tuple[Any, ...]]:
        """Pickle by the arguments; predicates on coordinates must be named functions for it."""
        given = {entry.name: getattr(self, entry.name) for entry in fields(self)}
        return type(self), tuple((given | {"bodies": dict(self.bodies)}).values())

    def plot(self) -> "Figure":
        """Sketch of the problem: see `lacore.pictures.sketch.problem.plot_problem`."""
        return views.picture(self)

    def facts(self) -> Facts:
        """What it consists of."""
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
        return Facts(f"Problem: {', '.join(counts)}", told)

    def picture(self) -> Picture:
        """As `plot` draws it."""
        return Picture(self.plot())

    def __post_init__(self) -> None:
        if not isinstance(self.bodies, Mapping) or not self.bodies:
            raise InputError(
                "Problem.bodies",
                None,
                "there is none with a name",
                "give bodies={'name': Body(...)}",
            )
        for name, body in self.bodies.items():
            if not isinstance(body, Body | BlockAssembly | Frame):
                raise InputError(
                    f"Problem.bodies[{name!r}]",
                    body,
                    "not a Body",
                    "give a lacore.Body, BlockAssembly or Frame",
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
        self._split_frames()
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
            body = self._body(support.body, where)
            body.check_support(support, where)
        for name, body in self.bodies.items():
            if isinstance(body, BlockAssembly):
                _check_corners(name, body, [s for s in self.supports if s.body == name])
        self._check_interfaces()
        loads = {
            f"Problem.{attribute}[{index}]": load
            for attribute in ("reference_loads", "dead_loads")
            for index, load in enumerate(getattr(self, attribute))
        }
        check_axisymmetry(self.bodies, loads, self.supports, self.interfaces)

    def _split_frames(self) -> None:
        """Put a node wherever a point force acts on a member: it may hinge there."""
        bodies = dict(self.bodies)
        for load in (*self.reference_loads, *self.dead_loads):
            if isinstance(load, PointForce) and not isinstance(load.at, str):
                body = bodies.get(load.body)
                if isinstance(body, Frame):
                    bodies[load.body] = body.split_at([load.at])
        object.__setattr__(self, "bodies", MappingProxyType(bodies))

    def _body(self, name: str, where: str) -> AnyBody:
        if not isinstance(name, str) or name not in self.bodies:
            raise InputError(f"{where}.body", name, "no such body", suggest(str(name), self.bodies))
        return self.bodies[name]

    def _check_load(self, where: str, load: Load) -> None:
        if not isinstance(load, Traction | Pressure | BodyForce | PointForce | RigidFooting):
            raise InputError(where, load, "not a load", "give lacore.Traction, Pressure, ...")
        self._body(load.body, where).check_load(load, where)

    def _check_interfaces(self) -> None:
        contacts: list[tuple[int, Segments]] = []
        for index, interface in enumerate(self.interfaces):
            where = f"Problem.interfaces[{index}]"
            if not isinstance(interface, Interface):
                raise InputError(where, interface, "not an interface", "give lacore.Interface")
            for side, (name, _) in zip(("slave", "master"), interface.sides, strict=False):
                self._body(name, f"{where}.{side}")
            contacts.append((index, interface_segments(interface, self.bodies, where)))
            if interface.obstacle is not None:
                self._check_free(interface, contacts[-1][1].slave, where)
        self._check_sharing(contacts)
        self._check_joined()
        self._check_isolated(contacts)

    def _check_free(self, interface: Interface, edges: Ints, where: str) -> None:
        """No obstacle along an edge of a block that has a joint: the joint's block is there."""
        body = self.bodies[interface.slave[0]]
        if not isinstance(body, BlockAssembly):
            return
        taken = np.intersect1d(edges, body.jointed_edges)
        if taken.size:
            name = body.names[body.edges.block[taken[0]]]
            start, end = body.edges.start[:, taken[0]], body.edges.end[:, taken[0]]
            raise InputError(
                where,
                interface.name,
                f"the edge of block {name!r} from {start} to {end} has a joint with another block",
                "select the edges that touch the obstacle by a function of coordinates",
            )

    def _check_sharing(self, contacts: list[tuple[int, Segments]]) -> None:
        """No two interfaces on one place: an edge may meet several bodies, each of them once."""
        taken: dict[_Place, dict[_Place, int]] = {}
        for index, segments in contacts:
            interface = self.interfaces[index]
            sides = zip(interface.sides, segments.edges, strict=False)
            ends = [self._places(name, edges, segments.normal) for (name, _), edges in sides]
            for one, other in zip(ends[0], ends[-1], strict=True):
                for edge, facing in {one: other, other: one}.items():
                    known = taken.setdefault(edge, {})
                    whole = edge == facing  # against an obstacle, that is
                    clash = [k for f, k in known.items() if whole or f in (edge, facing)]
                    if clash and clash[0] != index:
                        raise InputError(
                            f"Problem.interfaces[{index}]",
                            interface.name,
                            f"shares boundary edges with Problem.interfaces[{clash[0]}]",
                            "give each part of a boundary one interface",
                        )
                    known[facing] = index

    def _places(self, name: str, edges: Ints, normal: Floats) -> list["_Place"]:
        """Keys of edges; a node of a frame may stand in a corner, against two faces."""
        if not isinstance(self.bodies[name], Frame):
            return [(name, int(edge), (0.0, 0.0)) for edge in edges]
        turned = (np.round(normal.T, _SAME_NORMAL) + 0.0).tolist()
        return [(name, int(node), (x, y)) for node, (x, y) in zip(edges, turned, strict=True)]

    def _check_joined(self) -> None:
        """Each of several bodies has an interface or a support."""
        held = {support.body for support in self.supports}
        held |= {name for interface in self.interfaces for name, _ in interface.sides}
        held |= {
            load.body
            for load in (*self.reference_loads, *self.dead_loads)
            if isinstance(load, RigidFooting)
        }
        loose = [name for name in self.bodies if name not in held]
        if loose and len(self.bodies) > 1:
            raise InputError(
                "Problem.bodies",
                loose[0],
                "this body touches nothing: no interface, no support",
                "give it an Interface with what it touches, or a support, or leave it out",
            )

    def _check_isolated(self, contacts: list[tuple[int, Segments]]) -> None:
        """Each block touches something, or a support holds it."""
        for name, body in self.bodies.items():
            if not isinstance(body, BlockAssembly) or not body.isolated:
                continue
            edges = [np.zeros(0, dtype=np.int64)]
            for index, segments in contacts:
                sides = zip(self.interfaces[index].sides, segments.edges, strict=False)
                edges += [facets for (own, _), facets in sides if own == name]
            edges += [body.outline(s.where, "Fix.where") for s in self.supports if s.body == name]
            touched = {body.names[b] for b in body.edges.block[np.concatenate(edges)]}
            loose = [block for block in body.isolated if block not in touched]
            if loose:
                raise InputError(
                    f"Problem.bodies[{name!r}]",
                    loose[0],
                    "a block that touches nothing: no joint, no interface, no support",
                    "move it against its neighbours, or give it an interface or a support",
                )


def _check_corners(name: str, body: BlockAssembly, supports: Sequence[Fix]) -> None:
    """Refuse contacts at single points, which no joint carries: blocks would fall through."""
    places, blocks, others = resting_corners(body.edges, body.joints, body.allowed)
    if blocks.size:
        block, other = body.names[blocks[0]], body.names[others[0]]
        raise InputError(
            f"Problem.bodies[{name!r}]",
            (block, other),
            f"a corner of {block!r} rests on an edge of {other!r} at {places[:, 0]} without a joint"
            f" (such corners: {blocks.size})",
            "cut the corner off, so that an edge rests there, or move the blocks apart",
        )
    met = body.meetings
    alone = np.flatnonzero(~met.linked)
    if not alone.size:
        return
    free = np.diff(free_motions(body, supports).indptr).reshape(-1, 3)
    moves = np.asarray(free.any(axis=1))
    alone = alone[moves[met.first[alone]] | moves[met.second[alone]]]
    if alone.size:
        block, other = body.names[met.first[alone[0]]], body.names[met.second[alone[0]]]
        raise InputError(
            f"Problem.bodies[{name!r}]",
            (block, other),
            f"{block!r} and {other!r} touch at {met.place[:, alone[0]]} with nothing but corners"
            f" (such places: {alone.size}), where contact has no normal",
            "cut a corner off, so that edges touch there, or move the blocks apart",
        )
