"""Members of frames: read, checked, and cut into straight pieces from node to node."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
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
    require_place,
    require_range,
    suggest,
)
from lacore.showing import Compact

Members = Mapping[str, tuple[str, str]] | Sequence[tuple[str, str]]


@dataclass(frozen=True, eq=False, repr=False)
class Pieces(Compact):
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


def read_nodes(nodes: Mapping[str, tuple[float, float]]) -> tuple[tuple[str, ...], Floats]:
    """Names (N,) and places (2, N) of nodes; raises `InputError` where one is none."""
    if not isinstance(nodes, Mapping) or not nodes:
        raise InputError("Frame.nodes", None, "there is none with a name", "give {'A': (x, y)}")
    for name, place in nodes.items():
        if not isinstance(name, str) or not name:
            raise InputError("Frame.nodes", name, "not the name of a node", "give a text")
        if not is_plane_vector(place):
            raise InputError(f"Frame.nodes[{name!r}]", place, "not a place", "give (x, y) in m")
        require_place(f"Frame.nodes[{name!r}]", place)
    return tuple(nodes), np.array([list(place) for place in nodes.values()], dtype=np.float64).T


def read_members(members: Members, nodes: tuple[str, ...]) -> dict[str, tuple[str, str]]:
    """Node names by member; raises `InputError` for a member that is none."""
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


def read_moments(given: float | Mapping[str, float], members: tuple[str, ...]) -> Floats:
    """Plastic moments of the members, (M,); raises `InputError` where one is none or missing."""
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
    require_range(field, value)


def require_apart(names: tuple[str, ...], position: Floats, tolerance: float) -> None:
    """Raise `InputError` where two nodes are within `tolerance` (m)."""
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


def on_lines(places: Floats, start: Floats, end: Floats, tolerance: float) -> tuple[Bools, Floats]:
    """Which places (2, k) lie inside which lines (2, m), and how far along: (m, k)."""
    along = end - start
    length = np.linalg.norm(along, axis=0)
    away = places[:, None, :] - start[:, :, None]
    unit = (along / length)[:, :, None]
    s, h = np.sum(away * unit, axis=0), unit[0] * away[1] - unit[1] * away[0]
    within = (s > tolerance) & (s < length[:, None] - tolerance)
    return np.asarray(within & (np.abs(h) <= tolerance)), np.asarray(s)


def split_members(position: Floats, ends: Ints, moments: Floats, tolerance: float) -> Pieces:
    """Members, given by end nodes (M, 2), cut at the nodes that lie on them."""
    start, end = position[:, ends[:, 0]], position[:, ends[:, 1]]
    length = np.linalg.norm(end - start, axis=0)
    inside, place = on_lines(position, start, end, tolerance)
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


def read_releases(
    releases: Sequence[tuple[str, str]],
    members: tuple[str, ...],
    nodes: tuple[str, ...],
    pieces: Pieces,
) -> Bools:
    """Which ends of pieces carry moment, (P, 2); raises `InputError` for an unknown release."""
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


def require_single(nodes: tuple[str, ...], members: tuple[str, ...], pieces: Pieces) -> None:
    """Raise `InputError` where pieces of two members join the same nodes."""
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


def require_joined(
    nodes: tuple[str, ...],
    members: tuple[str, ...],
    position: Floats,
    ends: Ints,
    pieces: Pieces,
) -> None:
    """Raise `InputError` for a node without member, and for parts that nothing joins."""
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
