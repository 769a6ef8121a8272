"""Members of frames: read, checked, and cut into straight pieces between nodes."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from lacore.model.bodies.frames.section import Section
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting.errors import (
    InputError,
    is_number,
    is_plane_vector,
    require_known,
    require_place,
    require_range,
    suggest,
)
from lacore.reporting.showing import Compact
from lacore.reporting.text import Quantity, text

Members = Mapping[str, tuple[str, str]] | Sequence[tuple[str, str]]
"""Pairs of nodes, by the name of the member, or called after them, ``A-B``."""


@dataclass(frozen=True, eq=False, repr=False)
class Pieces(Compact):
    """Parts of members from node to node: rigid, and as straight as the member.

    Attributes:
        member: numbers of members, (P,).
        start, end: node numbers, (P,).
        along: unit direction of the member, (2, P).
        length: lengths, (P,), m.
        plastic_moment: plastic moments, (P,), N; 0 for bars, infinite for rigid pieces.
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
    """Return names (N,) and places (2, N) of nodes; raises `InputError` if one is invalid."""
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
    """Return the node names by member; raises `InputError` if a member is invalid."""
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


def read_sections(
    moment: float | Mapping[str, float] | None,
    sections: Section | Mapping[str, Section] | None,
    members: tuple[str, ...],
) -> tuple[Section, ...]:
    """Return the sections of the members; raises `InputError` if one is invalid.

    A missing section, or one given twice, is invalid as well.
    """
    found = _given_sections(sections, members)
    if isinstance(moment, Mapping):
        for name, value in moment.items():
            require_known("Frame.plastic_moment", name, members)
            _require_moment(f"Frame.plastic_moment[{name!r}]", value)
            if name in found:
                why = "this member has a section"
                raise InputError("Frame.plastic_moment", name, why, "give one of the two")
            found[name] = _of_moment(value)
    elif moment is not None:
        _require_moment("Frame.plastic_moment", moment)
        if len(found) == len(members):
            raise InputError(
                "Frame.plastic_moment", moment, "all members have sections", "leave it out"
            )
        found = {name: found.get(name, _of_moment(moment)) for name in members}
    missing = [name for name in members if name not in found]
    if missing:
        raise InputError(
            "Frame.plastic_moment", missing, "members without one", "give one for each member"
        )
    return tuple(found[name] for name in members)


def _given_sections(
    sections: Section | Mapping[str, Section] | None, members: tuple[str, ...]
) -> dict[str, Section]:
    """Return the given sections by member; raises `InputError` if one is invalid."""
    if sections is None:
        return {}
    if isinstance(sections, Section):
        return dict.fromkeys(members, sections)
    if not isinstance(sections, Mapping):
        fix = "give a section of lacore.sections, or {'member': section}"
        raise InputError("Frame.sections", sections, "not a section", fix)
    for name, own in sections.items():
        require_known("Frame.sections", name, members)
        if not isinstance(own, Section):
            fix = "give one of lacore.sections: standard('IPE 300', 235e6), bar(1e5), ..."
            raise InputError(f"Frame.sections[{name!r}]", own, "not a section", fix)
    return dict(sections)


def _of_moment(moment: float) -> Section:
    """Return a section without limit to axial force."""
    return Section(((-inf, float(moment)), (inf, float(moment))), "M_p")


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
    """Return which places (2, k) lie inside which lines (2, m), and how far along: (m, k)."""
    along = end - start
    length = np.linalg.norm(along, axis=0)
    away = places[:, None, :] - start[:, :, None]
    unit = (along / length)[:, :, None]
    s, h = np.sum(away * unit, axis=0), unit[0] * away[1] - unit[1] * away[0]
    within = (s > tolerance) & (s < length[:, None] - tolerance)
    return np.asarray(within & (np.abs(h) <= tolerance)), np.asarray(s)


def split_members(
    position: Floats, ends: Ints, sections: Sequence[Section], tolerance: float
) -> Pieces:
    """Return members, given by end nodes (M, 2), cut at the nodes that lie on them."""
    moments = np.array([section.plastic_moment for section in sections])
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
        stiff=np.repeat(moments[of, None] > 0, 2, axis=1),
    )


def read_releases(
    releases: Sequence[tuple[str, str]],
    members: tuple[str, ...],
    nodes: tuple[str, ...],
    pieces: Pieces,
) -> Bools:
    """Return which ends of pieces carry moment, (P, 2); raises `InputError` if one is unknown."""
    stiff = pieces.stiff.copy()
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
            "give each member once; a member continues through the nodes that lie on it",
        )


def require_whole_bars(
    nodes: tuple[str, ...],
    members: tuple[str, ...],
    sections: Sequence[Section],
    pieces: Pieces,
) -> None:
    """Raise `InputError` if a bar has a node inside, about which it would turn freely."""
    cut = np.bincount(pieces.member, minlength=len(members)) > 1
    for piece, member in enumerate(pieces.member.tolist()):
        if cut[member] and not sections[member].bends:
            raise InputError(
                "Frame.members",
                members[member],
                f"a bar with the node {nodes[pieces.end[piece]]!r} inside, where nothing holds it",
                "make it two bars, or give it a section that carries moment",
            )


def require_joined(
    nodes: tuple[str, ...],
    members: tuple[str, ...],
    position: Floats,
    ends: Ints,
    pieces: Pieces,
) -> None:
    """Raise `InputError` for a node without member, and for unconnected parts."""
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
            text(
                "no member reaches this node; {} passes it in {}",
                repr(members[nearest]),
                Quantity(gap[nearest], "m", ".3g"),
            ),
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
