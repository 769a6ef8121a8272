"""Plane frames: straight members between nodes, with plastic hinges where members end."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import singledispatch
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np

from lacore.model.bodies.frames.members import (
    Members,
    Pieces,
    on_lines,
    read_members,
    read_nodes,
    read_releases,
    read_sections,
    require_apart,
    require_joined,
    require_single,
    require_whole_bars,
    split_members,
)
from lacore.model.bodies.frames.section import Section
from lacore.model.bodies.pickled import by_arguments
from lacore.model.bodies.touching import Edges, Touched
from lacore.model.conditions.loads import Fix, Load, PointForce, Traction
from lacore.model.conditions.where import Where
from lacore.model.meshes.curved import EdgeCurves
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting import terms
from lacore.reporting.errors import InputError, require_known, require_positive, suggest
from lacore.reporting.showing import Facts, Shown, counted, listed
from lacore.reporting.text import Term, text

_TOLERANCE = 1e-6  # by the size: coordinates written with seven digits agree to this
HELD_COMPONENTS = {
    "x": (True, False, False),
    "y": (False, True, False),
    "xy": (True, True, False),
    "rotation": (False, False, True),
    "clamped": (True, True, True),
}
"""Which of u_x, u_y and the rotation of nodes a support holds, by its components."""


@dataclass(frozen=True, eq=False, repr=False)
class Frame(Shown):
    """Rigid-plastic members, inextensible, with potential plastic hinges at nodes.

    A node that lies on a member, within `tolerance`, splits it: the member may hinge there, on
    either side, and is joined to what else meets there. Members that cross elsewhere pass each
    other. Where a `PointForce` acts at coordinates on a member, `Problem` adds the node. Nodes are
    the only places of hinges; under loads along a member `solve` adds nodes where its moments peak.

    Moments are per unit thickness, N m/m = N, like forces, N/m.

    Attributes:
        nodes: places (x, y) by name, m.
        members: ``(node, node)`` by name; those of a sequence are called "A-B".
        plastic_moment: M_p of all members without a section, or by member, N.
        releases: ``(member, node)``: ends without moment. A node that one member reaches needs
            none: it turns with its member unless a support fixes its rotation.
        tolerance: m; 1e-6 of the size if None.
        sections: sections of all members, or by member: see `lacore.sections`. Their axial force
            and moment
            interact, bars carry axial force alone; a plain M_p has no limit to axial force.
        names: names of nodes, (N,).
        member_names: names of members, (M,).
        position: places of the nodes, (2, N), m.
        size: diagonal of the bounding box, m.
        section_of: section of each member, (M,).
        pieces: see `Pieces`.

    Raises:
        InputError: unknown or unused nodes, nodes at one place, members without length or on top
            of each other, M_p that is missing, given twice or not positive, bars with nodes inside,
            or unconnected parts.

    Example:
        >>> nodes = {"A": (0, 0), "B": (0, 3), "C": (4, 3)}
        >>> members = {"column": ("A", "B"), "beam": ("B", "C")}
        >>> frame = la.Frame(nodes, members, plastic_moment={"column": 60e3, "beam": 100e3})
        >>> list(frame.members)
        ['column', 'beam']
    """

    nodes: Mapping[str, tuple[float, float]]
    members: Members
    plastic_moment: float | Mapping[str, float] | None = None
    releases: Sequence[tuple[str, str]] = ()
    tolerance: float | None = None
    sections: Section | Mapping[str, Section] | None = None
    dimension: ClassVar[int] = 2
    pointwise: ClassVar[bool] = True  # It touches others in single nodes.
    deforms: ClassVar[bool] = False
    axisymmetric: ClassVar[bool] = False
    names: tuple[str, ...] = field(init=False, repr=False)
    member_names: tuple[str, ...] = field(init=False, repr=False)
    position: Floats = field(init=False, repr=False)
    size: float = field(init=False, repr=False)
    section_of: tuple[Section, ...] = field(init=False, repr=False)
    pieces: Pieces = field(init=False, repr=False)

    def __reduce__(self) -> tuple[type, tuple[Any, ...]]:
        """Pickle by the arguments."""
        return by_arguments(self)

    def __post_init__(self) -> None:
        names, position = read_nodes(self.nodes)
        members = read_members(self.members, names)
        size = float(np.linalg.norm(np.ptp(position, axis=1)))
        if self.tolerance is not None:
            require_positive("Frame.tolerance", self.tolerance)
        tolerance = _TOLERANCE * size if self.tolerance is None else float(self.tolerance)
        require_apart(names, position, tolerance)
        sections = read_sections(self.plastic_moment, self.sections, tuple(members))
        number = {name: index for index, name in enumerate(names)}
        ends = np.array([[number[node] for node in pair] for pair in members.values()])
        pieces = split_members(position, ends, sections, tolerance)
        stiff = read_releases(self.releases, tuple(members), names, pieces)
        pieces = replace(pieces, stiff=stiff)
        require_single(names, tuple(members), pieces)
        require_joined(names, tuple(members), position, ends, pieces)
        require_whole_bars(names, tuple(members), sections, pieces)
        places = dict(zip(names, map(tuple, position.T.tolist()), strict=True))
        computed = {
            "nodes": MappingProxyType(places),
            "members": MappingProxyType(members),
            "plastic_moment": _kept(self.plastic_moment),
            "sections": _kept(self.sections),
            "releases": tuple((member, node) for member, node in self.releases),
            "tolerance": tolerance,
            "names": names,
            "member_names": tuple(members),
            "position": position,
            "size": size,
            "section_of": sections,
            "pieces": pieces,
        }
        for name, value in computed.items():
            object.__setattr__(self, name, value)

    @property
    def polygons(self) -> frozenset[str]:
        """Sides, ``inner`` or ``outer``, on which polygons approximate yield curves of sections."""
        return frozenset(own.side for own in self.section_of if own.side)

    @property
    def contents(self) -> str:
        """``3 members, 4 nodes``."""
        members = counted(len(self.member_names), "member")
        return f"{members}, {counted(len(self.names), 'node')}"

    def facts(self) -> Facts:
        """Return the members, nodes and strengths, for printing."""
        finite = [own.plastic_moment for own in self.section_of if own.bends and not own.rigid]
        low, high = min(finite, default=0.0), max(finite, default=0.0)
        named = dict.fromkeys(own.name for own in self.section_of if own.extends or own.rigid)
        moment = f"M_p = {low:.4g} N" if low == high else f"M_p = {low:.4g} to {high:.4g} N"
        told = {
            "members": listed(self.member_names, 10),
            "nodes": listed(self.names, 10),
            "moment": "; ".join([moment, listed(list(named), 4)] if named else [moment]),
            "releases": counted(len(self.releases), "release"),
            "size": f"{self.pieces.length.sum():.4g} m of members, {self.size:.4g} m across",
        }
        return Facts(f"Frame: {self.contents}", told)

    @property
    def box(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner of the bounding box, m, shape (2,) each."""
        return self.position.min(axis=1), self.position.max(axis=1)

    def find(self, where: Where, field: str) -> Ints:
        """Return the numbers of nodes: by a name, names, or a predicate on coordinates (2, n).

        Raises:
            InputError: an unknown name, or nothing selected; it names `field`.
        """
        if callable(where):
            inside = np.asarray(where(self.position))
            if inside.shape != (len(self.names),) or inside.dtype != bool:
                raise InputError(
                    field,
                    inside.dtype.name,
                    "the predicate does not return one bool a node",
                    "return an array of bool of shape (n,) for coordinates (2, n)",
                )
            chosen = np.flatnonzero(inside)
        elif isinstance(where, str | tuple):
            wanted = (where,) if isinstance(where, str) else where
            for name in wanted:
                require_known(field, name, self.names)
            chosen = np.flatnonzero(np.isin(self.names, wanted))
        else:
            of_place = Term("a function of coordinates (2, n)", "places in numbers")
            raise InputError(field, where, "no nodes", text("give a name, names, or {}", of_place))
        if chosen.size == 0:
            raise InputError(field, None, "selects no node", "select at least one node")
        return chosen

    def boundary(self, where: Where, field: str) -> tuple[Ints, Edges]:
        """Return nodes, and edges of length 0 there without a normal; errors name the `field`."""
        nodes = self.find(where, field)
        place = self.position[:, nodes]
        return nodes, Edges(place, place, np.zeros_like(place))

    def curves(self, nodes: Ints) -> EdgeCurves:
        """Return the nodes as curves of length 0."""
        place = self.position[:, nodes]
        return EdgeCurves(place, place, place)

    def check_load(self, load: Load, field: str) -> None:
        """Raise `InputError` where it does not carry a load."""
        nodal(load, self)

    def with_points(self, points: Iterable[Sequence[float]]) -> Frame:
        """Return the frame with a node wherever a point lies on a member: it may hinge there."""
        return self.split_at(points)

    def check_contact(
        self, field: str, supports: Sequence[Fix], touched: Sequence[Touched]
    ) -> None:
        """Do nothing, because a contact or support at any node holds all of it."""

    def check_support(self, support: Fix, field: str) -> None:
        """Raise `InputError` where a support cannot hold it; it names the `field`."""
        self.find(support.where, f"{field}.where")
        require_known(f"{field}.components", support.components, HELD_COMPONENTS)

    def node_at(self, at: Sequence[float]) -> int | None:
        """Return the number of the node at a place, None where there is none."""
        away = np.linalg.norm(self.position - np.reshape(at, (2, 1)), axis=0)
        nearest = int(np.argmin(away))
        return nearest if away[nearest] <= self.allowed else None

    def split_at(self, points: Iterable[Sequence[float]]) -> Frame:
        """Return the frame with further nodes at those of the points that lie inside a member.

        They are called "member(x, y)".

        Raises:
            InputError: a point where members cross that no node joins.
        """
        frame = self
        for point in points:
            if frame.node_at(point) is not None:
                continue
            crossed = frame._members_at(point)
            if len(crossed) > 1:
                raise InputError(
                    "PointForce.at",
                    tuple(point),
                    f"the members {', '.join(crossed)} cross there, and no node joins them",
                    "make it a node, or load one of the adjacent members",
                )
            if crossed:
                x, y = (float(own) for own in point)
                frame = replace(frame, nodes={**frame.nodes, f"{crossed[0]}({x:g}, {y:g})": (x, y)})
        return frame

    def crossed_at(self, point: Sequence[float]) -> bool:
        """Return whether members cross at a point that no node joins."""
        return self.node_at(point) is None and len(self._members_at(point)) > 1

    def _members_at(self, point: Sequence[float]) -> list[str]:
        """Return the members with a piece that a point lies inside of."""
        ends = self.position[:, self.pieces.nodes]
        place = np.reshape(np.asarray(point, dtype=np.float64), (2, 1))
        inside = on_lines(place, ends[:, :, 0], ends[:, :, 1], self.allowed)[0][:, 0]
        return [self.member_names[m] for m in self.pieces.member[inside]]

    @property
    def allowed(self) -> float:
        """Distance up to which coordinates count as one, m."""
        assert self.tolerance is not None  # set in the constructor
        return self.tolerance


def _kept(value: Any) -> Any:
    """Return a read-only mapping, or the value itself; a number as float."""
    if isinstance(value, Mapping):
        return MappingProxyType(dict(value))
    return value if value is None or isinstance(value, Section) else float(value)


@singledispatch
def nodal(load: Load, body: Frame) -> Floats:
    """Return the forces and moments of a load at the nodes, shape (N, 3), N/m and 0.

    Raises:
        InputError: a load that frames do not support, or at no node or member.
    """
    raise InputError(
        f"{type(load).__name__}.body",
        load.body,
        "a frame, whose members have neither width nor sides",
        text(
            "give {} along members (own weight: N/m per m of member), or {}",
            terms.TRACTION,
            terms.POINT_FORCE,
        ),
    )


@nodal.register(PointForce)
def _point(load: PointForce, body: Frame) -> Floats:
    total = np.zeros((len(body.names), 3))
    total[_loaded_node(load, body), :2] = load.vector
    return total


@nodal.register(Traction)
def _along(load: Traction, body: Frame) -> Floats:
    total = np.zeros((len(body.names), 3))
    half = (line_load(load, body) * body.pieces.length / 2).T
    for nodes in (body.pieces.start, body.pieces.end):
        np.add.at(total[:, :2], nodes, half)
    return total


def _loaded_node(load: PointForce, body: Frame) -> int:
    if load.where is not None:
        raise InputError(
            "PointForce.where", load.where, "a node of a frame needs none", "leave it out"
        )
    if isinstance(load.at, str):
        return int(body.find(load.at, "PointForce.at")[0])
    node = body.node_at(load.at)
    if node is None:
        away = body.position - np.reshape(load.at, (2, 1))
        nearest = body.names[int(np.argmin(np.linalg.norm(away, axis=0)))]
        raise InputError(
            "PointForce.at",
            load.at,
            "lies on no member of the frame",
            f"the nearest node is {nearest!r}",
        )
    return node


@singledispatch
def line_load(load: Load, body: Frame) -> Floats:
    """Return a load along members on all pieces, N/m per m, (2, P): 0 on other members."""
    return np.zeros(body.pieces.along.shape)


@line_load.register(Traction)
def _traction(load: Traction, body: Frame) -> Floats:
    wanted = (load.where,) if isinstance(load.where, str) else load.where
    if not isinstance(wanted, tuple):
        raise InputError("Traction.where", None, "not a member", "give the name of a member")
    for name in wanted:
        if name not in body.member_names:
            fix = suggest(str(name), body.member_names)
            raise InputError("Traction.where", name, "no such member", fix)
        if not body.section_of[body.member_names.index(name)].bends:
            why = "a bar, which carries axial force alone"
            raise InputError("Traction.where", name, why, "load its nodes")
    loaded = np.isin(body.member_names, wanted)[body.pieces.member]
    return np.outer(load.vector, loaded)
