"""Plane frames: straight members between nodes, with plastic hinges where members end."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from types import MappingProxyType
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from lacore.arrays import Bools, Floats, Ints
from lacore.errors import (
    InputError,
    is_number,
    is_plane_vector,
    require_known,
    require_positive,
    suggest,
)

Nodes = str | tuple[str, ...] | Callable[[Floats], Bools]
Members = Mapping[str, tuple[str, str]] | Sequence[tuple[str, str]]
_TOLERANCE = 1e-6  # of the size: coordinates written with seven digits agree to this


@dataclass(frozen=True, eq=False)
class Pieces:
    """Parts of members from node to node: rigid, and as straight as the member.

    Attributes:
        member: numbers, (P,).
        start, end: node numbers, (P,).
        along: unit direction of the member, (2, P).
        length: (P,), m.
        plastic_moment: (P,), N.
        stiff: whether the start and the end carry moment, (P, 2).
    """

    member: Ints
    start: Ints
    end: Ints
    along: Floats
    length: Floats
    plastic_moment: Floats
    stiff: Bools

    @property
    def nodes(self) -> Ints:
        """Node numbers at the start and the end, (P, 2)."""
        return np.stack([self.start, self.end], axis=1)


@dataclass(frozen=True, eq=False)
class Frame:
    """Rigid-plastic members, inextensible, with potential plastic hinges at nodes.

    A node that lies on a member, within `tolerance`, splits it: the member may hinge there, on
    either side, and is joined to what else meets there. Members that cross elsewhere pass each
    other. Where a `PointForce` acts at coordinates on a member, `Problem` adds the node. Nodes are
    the only places of hinges: under loads along a member the load factor is exact once nodes stand
    where it hinges, and an upper bound before.

    Moments are per unit thickness, N m/m = N, like forces, N/m.

    Attributes:
        nodes: places (x, y) by name, m.
        members: ``(node, node)`` by name; those of a sequence are called "A-B".
        plastic_moment: M_p of all members, or by member, N.
        releases: ``(member, node)``: ends without moment. A node that one member reaches needs
            none: it turns with its member unless a support clamps it.
        tolerance: m; 1e-6 of the size if None.
        names, member_names: of nodes (N,) and members (M,).
        position: of the nodes, (2, N), m.
        size: diagonal of the bounding box, m.
        pieces: see `Pieces`.

    Raises:
        InputError: unknown or unused nodes, nodes at one place, members without length or on top
            of each other, M_p that is missing or not positive, parts that no member joins.
    """

    nodes: Mapping[str, tuple[float, float]]
    members: Members
    plastic_moment: float | Mapping[str, float]
    releases: Sequence[tuple[str, str]] = ()
    tolerance: float | None = None
    names: tuple[str, ...] = field(init=False, repr=False)
    member_names: tuple[str, ...] = field(init=False, repr=False)
    position: Floats = field(init=False, repr=False)
    size: float = field(init=False, repr=False)
    pieces: Pieces = field(init=False, repr=False)

    def __reduce__(self) -> tuple[type, tuple[Any, ...]]:
        """Pickle by the arguments."""
        given = {entry.name: getattr(self, entry.name) for entry in fields(self) if entry.init}
        plain = {
            name: dict(value) if isinstance(value, Mapping) else value
            for name, value in given.items()
        }
        return type(self), tuple(plain.values())

    def __post_init__(self) -> None:
        names, position = _read_nodes(self.nodes)
        members = _read_members(self.members, names)
        size = float(np.linalg.norm(np.ptp(position, axis=1)))
        if self.tolerance is not None:
            require_positive("Frame.tolerance", self.tolerance)
        tolerance = _TOLERANCE * size if self.tolerance is None else float(self.tolerance)
        _require_apart(names, position, tolerance)
        moments = _read_moments(self.plastic_moment, tuple(members))
        number = {name: index for index, name in enumerate(names)}
        ends = np.array([[number[node] for node in pair] for pair in members.values()])
        pieces = _split(position, ends, moments, tolerance)
        stiff = _read_releases(self.releases, tuple(members), names, pieces)
        pieces = replace(pieces, stiff=stiff)
        _require_single(names, tuple(members), pieces)
        _require_joined(names, tuple(members), position, ends, pieces)
        places = dict(zip(names, map(tuple, position.T.tolist()), strict=True))
        computed = {
            "nodes": MappingProxyType(places),
            "members": MappingProxyType(members),
            "plastic_moment": (
                MappingProxyType(dict(self.plastic_moment))
                if isinstance(self.plastic_moment, Mapping)
                else float(self.plastic_moment)
            ),
            "releases": tuple((member, node) for member, node in self.releases),
            "tolerance": tolerance,
            "names": names,
            "member_names": tuple(members),
            "position": position,
            "size": size,
            "pieces": pieces,
        }
        for name, value in computed.items():
            object.__setattr__(self, name, value)

    def find(self, where: Nodes, field: str) -> Ints:
        """Numbers of nodes: of a name, of names, or of a predicate on coordinates (2, n) -> (n,).

        Raises:
            InputError: an unknown name, nothing selected; it names `field`.
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
            raise InputError(
                field, where, "no nodes", "give a name, names, or a function of coordinates (2, n)"
            )
        if chosen.size == 0:
            raise InputError(field, None, "selects no node", "select at least one node")
        return chosen

    def node_at(self, at: Sequence[float]) -> int | None:
        """Number of the node at a place, None where there is none."""
        away = np.linalg.norm(self.position - np.reshape(at, (2, 1)), axis=0)
        nearest = int(np.argmin(away))
        return nearest if away[nearest] <= self._allowed else None

    def split_at(self, points: Iterable[Sequence[float]]) -> "Frame":
        """The frame with further nodes at those of the points that lie inside a member.

        They are called "member(x, y)".

        Raises:
            InputError: a point where members cross that no node joins.
        """
        frame = self
        for point in points:
            if frame.node_at(point) is not None:
                continue
            ends = frame.position[:, frame.pieces.nodes]
            place = np.reshape(np.asarray(point, dtype=np.float64), (2, 1))
            inside = _on_lines(place, ends[:, :, 0], ends[:, :, 1], frame._allowed)[0][:, 0]
            crossed = [frame.member_names[m] for m in frame.pieces.member[inside]]
            if len(crossed) > 1:
                raise InputError(
                    "PointForce.at",
                    tuple(point),
                    f"the members {', '.join(crossed)} cross there, and no node joins them",
                    "make it a node, or load one of the members beside it",
                )
            if crossed:
                x, y = place.ravel().tolist()
                frame = replace(frame, nodes={**frame.nodes, f"{crossed[0]}({x:g}, {y:g})": (x, y)})
        return frame

    @property
    def _allowed(self) -> float:
        assert self.tolerance is not None  # since it was built
        return self.tolerance


def _read_nodes(nodes: Mapping[str, tuple[float, float]]) -> tuple[tuple[str, ...], Floats]:
    if not isinstance(nodes, Mapping) or not nodes:
        raise InputError("Frame.nodes", None, "there is none with a name", "give {'A': (x, y)}")
    for name, place in nodes.items():
        if not isinstance(name, str) or not name:
            raise InputError("Frame.nodes", name, "not the name of a node", "give a text")
        if not is_plane_vector(place):
            raise InputError(f"Frame.nodes[{name!r}]", place, "not a place", "give (x, y) in m")
    return tuple(nodes), np.array([list(place) for place in nodes.values()], dtype=np.float64).T


def _read_members(members: Members, nodes: tuple[str, ...]) -> dict[str, tuple[str, str]]:
    """Node names by member."""
    if isinstance(members, Mapping):
        given: Iterable[tuple[object, Any]] = members.items()
    elif isinstance(members, Sequence) and not isinstance(members, str):
        given = (("-".join(map(str, pair)) if _is_pair(pair) else pair, pair) for pair in members)
    else:
        raise InputError("Frame.members", members, "no members", "give {'beam': ('A', 'B')}")
    read: dict[str, tuple[str, str]] = {}
    for name, pair in given:
        if not isinstance(name, str) or not name:
            raise InputError("Frame.members", name, "not the name of a member", "give a text")
        field = f"Frame.members[{name!r}]"
        if not _is_pair(pair):
            raise InputError(field, pair, "not two nodes", "give the names of two nodes")
        if name in read:
            raise InputError(field, pair, "a member given twice", "give it once")
        for node in pair:
            require_known(field, node, nodes)
        if pair[0] == pair[1]:
            raise InputError(field, pair, "a member without length", "give two different nodes")
        read[name] = (pair[0], pair[1])
    if not read:
        raise InputError("Frame.members", None, "there is no member", "give at least one")
    return read


def _is_pair(pair: object) -> bool:
    return isinstance(pair, tuple | list) and len(pair) == 2


def _read_moments(given: float | Mapping[str, float], members: tuple[str, ...]) -> Floats:
    """Plastic moments of the members, (M,)."""
    if not isinstance(given, Mapping):
        _require_moment("Frame.plastic_moment", given)
        return np.full(len(members), float(given))
    for name, value in given.items():
        require_known("Frame.plastic_moment", name, members)
        _require_moment(f"Frame.plastic_moment[{name!r}]", value)
    missing = [name for name in members if name not in given]
    if missing:
        raise InputError(
            "Frame.plastic_moment", missing, "members without one", "give one for each member"
        )
    return np.array([float(given[name]) for name in members])


def _require_moment(field: str, value: object) -> None:
    if not (is_number(value) and value > 0):  # type: ignore[operator]
        raise InputError(
            field, value, "not a plastic moment", "give a finite M_p > 0 in N m per m, or releases"
        )


def _require_apart(names: tuple[str, ...], position: Floats, tolerance: float) -> None:
    gap = np.linalg.norm(position[:, :, None] - position[:, None, :], axis=0)
    first, second = np.nonzero(np.triu(gap <= tolerance, 1))
    if first.size:
        raise InputError(
            "Frame.nodes",
            (names[first[0]], names[second[0]]),
            f"nodes at one place, {tuple(position[:, first[0]].tolist())}: a member between them"
            " would have no length",
            "make them one node; Frame.releases takes moments off the members that meet there",
        )


def _on_lines(places: Floats, start: Floats, end: Floats, tolerance: float) -> tuple[Bools, Floats]:
    """Which places (2, k) lie inside which lines (2, m), and how far along: (m, k)."""
    along = end - start
    length = np.linalg.norm(along, axis=0)
    away = places[:, None, :] - start[:, :, None]
    unit = (along / length)[:, :, None]
    s, h = np.sum(away * unit, axis=0), unit[0] * away[1] - unit[1] * away[0]
    within = (s > tolerance) & (s < length[:, None] - tolerance)
    return np.asarray(within & (np.abs(h) <= tolerance)), np.asarray(s)


def _split(position: Floats, ends: Ints, moments: Floats, tolerance: float) -> Pieces:
    """Members, given by end nodes (M, 2), cut at the nodes that lie on them."""
    start, end = position[:, ends[:, 0]], position[:, ends[:, 1]]
    length = np.linalg.norm(end - start, axis=0)
    inside, place = _on_lines(position, start, end, tolerance)
    member, node = np.nonzero(inside)
    every = np.arange(length.size)
    stop = np.concatenate([np.zeros(length.size), place[inside], length])
    owner = np.concatenate([every, member, every])
    order = np.lexsort((stop, owner))
    owner, stop = owner[order], stop[order]
    node = np.concatenate([ends[:, 0], node, ends[:, 1]])[order]
    same = owner[1:] == owner[:-1]
    of = owner[1:][same]
    return Pieces(
        member=of,
        start=node[:-1][same],
        end=node[1:][same],
        along=((end - start) / length)[:, of],
        length=np.diff(stop)[same],
        plastic_moment=moments[of],
        stiff=np.ones((of.size, 2), dtype=bool),
    )


def _read_releases(
    releases: Sequence[tuple[str, str]],
    members: tuple[str, ...],
    nodes: tuple[str, ...],
    pieces: Pieces,
) -> Bools:
    """Which ends of pieces carry moment, (P, 2)."""
    stiff = np.ones(pieces.nodes.shape, dtype=bool)
    if not isinstance(releases, Sequence) or isinstance(releases, str):
        raise InputError("Frame.releases", releases, "not a list", "give [(member, node), ...]")
    for release in releases:
        if not _is_pair(release):
            raise InputError("Frame.releases", release, "not a pair", "give (member, node)")
        for name, known in zip(release, (members, nodes), strict=True):
            if name not in known:
                raise InputError(
                    "Frame.releases",
                    tuple(release),
                    f"{name!r} is unknown",
                    suggest(str(name), known),
                )
        member, node = members.index(release[0]), nodes.index(release[1])
        ends = (pieces.member == member)[:, None] & (pieces.nodes == node)
        if not ends.any():
            raise InputError(
                "Frame.releases",
                tuple(release),
                "the member does not reach the node",
                "give one of the nodes on it",
            )
        stiff &= ~ends
    return stiff


def _require_single(nodes: tuple[str, ...], members: tuple[str, ...], pieces: Pieces) -> None:
    pairs = np.sort(pieces.nodes, axis=1)
    _, index, count = np.unique(pairs, axis=0, return_inverse=True, return_counts=True)
    double = np.flatnonzero(count[index.ravel()] > 1)
    if double.size:
        both = np.flatnonzero(index.ravel() == index.ravel()[double[0]])
        raise InputError(
            "Frame.members",
            tuple(members[m] for m in pieces.member[both]),
            f"members on top of each other between {nodes[pairs[both[0], 0]]!r} and"
            f" {nodes[pairs[both[0], 1]]!r}",
            "give each member once; a member goes on through the nodes that lie on it",
        )


def _require_joined(
    nodes: tuple[str, ...],
    members: tuple[str, ...],
    position: Floats,
    ends: Ints,
    pieces: Pieces,
) -> None:
    unused = np.setdiff1d(np.arange(len(nodes)), pieces.nodes)
    if unused.size:
        start, along = position[:, ends[:, 0]], position[:, ends[:, 1]] - position[:, ends[:, 0]]
        away = position[:, unused[:1]] - start
        share = np.clip(np.sum(away * along, axis=0) / np.sum(along**2, axis=0), 0.0, 1.0)
        gap = np.linalg.norm(away - share * along, axis=0)
        nearest = int(np.argmin(gap))
        raise InputError(
            "Frame.nodes",
            nodes[unused[0]],
            f"no member reaches this node; {members[nearest]!r} passes it in {gap[nearest]:.3g} m",
            "remove it, or move it onto a member",
        )
    links = coo_matrix(
        (np.ones(pieces.start.size), (pieces.start, pieces.end)), shape=(len(nodes),) * 2
    )
    count, part = connected_components(links, directed=False)
    if count > 1:
        apart = nodes[int(np.argmax(part != part[0]))]
        raise InputError(
            "Frame.members",
            None,
            f"no member joins the node {apart!r} to {nodes[0]!r} (parts: {count})",
            "make each part a Frame of its own, or put a node where members meet",
        )
