"""Plane meshes and tetrahedra of Abaqus input files: nodes, elements, sets and surfaces.

The reader of meshio knows few plane elements, and assigns element sets to other elements where a
file has several blocks of elements.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from lacore.numerics.arrays import Ints
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact

# Solid, shell and membrane elements by the number in their name, and elements of lines.
_SURFACES = re.compile(
    r"(?:CPE|CPS|CPEG|CAX|CGAX|DC2D|DCAX|S|STRI|M3D|SFM3D|R3D)(3|4|6|8|9)[A-Z0-9]*"
)
_VOLUMES = re.compile(r"(?:C3D|DC3D)(4|10)[A-Z]*")
_LINES = re.compile(r"(?:T2D|T3D|R2D|B2|B3)(2|3)[A-Z0-9]*|(?:B21|B31)H?")
_KINDS = {
    "surface": {3: "triangle", 4: "quad", 6: "triangle6", 8: "quad8", 9: "quad9"},
    "volume": {4: "tetra", 10: "tetra10"},
    "line": {2: "line", 3: "line3"},
}
_CORNERS = {"triangle": 3, "triangle6": 3, "quad": 4, "quad8": 4, "quad9": 4}


@dataclass(frozen=True)
class _Card:
    """Keyword line with its parameters and data: ``*NSET, NSET=left``."""

    keyword: str
    given: Mapping[str, str]
    line: int
    data: list[tuple[int, list[str]]] = field(default_factory=list)


@dataclass(eq=False, repr=False)
class _Content(Compact):
    """What has been read of a file: places and elements by number, sets by name."""

    path: str
    nodes: dict[int, list[float]] = field(default_factory=dict)
    elements: dict[int, tuple[str, list[int]]] = field(default_factory=dict)
    node_sets: dict[str, list[int]] = field(default_factory=dict)
    element_sets: dict[str, list[int]] = field(default_factory=dict)
    sides: dict[str, list[list[int]]] = field(default_factory=dict)

    def refused(self, line: int, why: str, fix: str) -> InputError:
        """Return an error about a line of the file."""
        return InputError("path", self.path, f"line {line}: {why}", fix)


def read_abaqus(path: Path) -> Any:
    """Return the mesh of an input file as meshio has it; surfaces of elements as sets of lines.

    Raises:
        InputError: unknown elements, sets or nodes, several instances, or an included file; it
            names the line.
    """
    import meshio  # imported here because it imports the readers of forty formats

    content = _Content(str(path))
    for card in _cards(path.read_text(encoding="utf-8", errors="replace").splitlines()):
        _READERS.get(card.keyword, _skip)(content, card)
    number = {node: place for place, node in enumerate(content.nodes)}
    for element, (_, nodes) in content.elements.items():
        if not number.keys() >= set(nodes):
            why = f"element {element} has nodes that the file lacks"
            raise InputError("path", content.path, why, "write it anew")
    kinds = sorted({kind for kind, _ in content.elements.values()})
    blocks = {kind: [n for n, own in content.elements.items() if own[0] == kind] for kind in kinds}
    cells = [
        (kind, np.array([[number[node] for node in content.elements[n][1]] for n in own]))
        for kind, own in blocks.items()
    ]
    sides = [*chain.from_iterable(content.sides.values())]
    if sides:
        cells.append(("line", np.array([[number[node] for node in side] for side in sides])))
    return meshio.Mesh(
        np.array([*content.nodes.values()], dtype=np.float64).reshape(-1, 3),
        cells,
        point_sets={
            name: np.array([number[node] for node in nodes if node in number], dtype=np.int64)
            for name, nodes in content.node_sets.items()
        },
        cell_sets=_cell_sets(content, [*blocks.values()], len(cells)),
    )


def _cell_sets(content: _Content, blocks: list[list[int]], count: int) -> dict[str, list[Ints]]:
    """Return the rows of each set in `count` blocks of cells, the last one of sides, if any."""
    empty = [_NONE] * (count - len(blocks))
    sets = {
        name: [*(_rows(own, members) for own in blocks), *empty]
        for name, members in content.element_sets.items()
    }
    begin = 0
    for name, own in content.sides.items():
        sets.setdefault(name, [_NONE] * count)[-1] = np.arange(begin, begin + len(own))
        begin += len(own)
    return sets


_NONE: Ints = np.zeros(0, dtype=np.int64)


def _rows(own: Iterable[int], members: Iterable[int]) -> Ints:
    return np.flatnonzero(np.isin(np.array([*own]), np.array([*members], dtype=np.int64)))


def _cards(lines: Iterable[str]) -> Iterator[_Card]:
    """Yield the keyword lines with their data, without comments."""
    card, header = None, ""
    for number, line in enumerate(lines, start=1):
        told = line.strip()
        if not told or told.startswith("**"):
            continue
        if told.startswith("*") or header:
            header += told
            if header.endswith(","):  # It continues on the next line.
                continue
            if card is not None:
                yield card
            keyword, *given = header.lstrip("*").split(",")
            pairs = (part.partition("=") for part in given if part.strip())
            parameters = {key.strip().upper(): own.strip().strip('"') for key, _, own in pairs}
            card, header = _Card(" ".join(keyword.upper().split()), parameters, number), ""
        elif card is not None:
            values = [part.strip() for part in told.strip(",").split(",")]
            card.data.append((number, values))
    if card is not None:
        yield card


def _numbers(content: _Content, card: _Card) -> Iterator[int]:
    for line, values in card.data:
        for own in values:
            try:
                yield int(own)
            except ValueError:
                raise content.refused(line, f"{own!r} is not a number", "correct it") from None


def _nodes(content: _Content, card: _Card) -> None:
    for line, values in card.data:
        try:
            own = int(values[0])
            place = [float(part or 0.0) for part in values[1:4]]
        except ValueError:
            raise content.refused(line, "not a node: number, x, y, z", "correct it") from None
        if own in content.nodes:
            fix = "write one part, or give its nodes other numbers"
            raise content.refused(line, f"node {own} is given twice", fix)
        content.nodes[own] = [*place, *[0.0] * (3 - len(place))]
        if "NSET" in card.given:
            content.node_sets.setdefault(card.given["NSET"], []).append(own)


def _kind(content: _Content, card: _Card) -> tuple[str, int]:
    """Return the kind of meshio of the elements of a card, and the number of their nodes."""
    name = card.given.get("TYPE", "").upper()
    for group, pattern in (("surface", _SURFACES), ("volume", _VOLUMES), ("line", _LINES)):
        if found := pattern.fullmatch(name):
            count = int(found[1] or 2)
            return _KINDS[group][count], count
    why = f"elements of the type {name!r}, of which no bodies are made"
    raise content.refused(
        card.line, why, "leave them out; bodies have CPE3, CPE4, CPE6, CPE8, C3D4, or similar ones"
    )


def _elements(content: _Content, card: _Card) -> None:
    kind, count = _kind(content, card)
    numbers = [*_numbers(content, card)]
    if len(numbers) % (count + 1):
        why = f"elements of the type {card.given['TYPE']} have {count} nodes each"
        raise content.refused(card.line, why, "correct their lines")
    for own, *nodes in np.array(numbers, dtype=np.int64).reshape(-1, count + 1).tolist():
        if own in content.elements:
            fix = "write one part, or give its elements other numbers"
            raise content.refused(card.line, f"element {own} is given twice", fix)
        content.elements[own] = kind, nodes
        if "ELSET" in card.given:
            content.element_sets.setdefault(card.given["ELSET"], []).append(own)


def _set(content: _Content, card: _Card, key: str, known: dict[str, list[int]]) -> None:
    members = known.setdefault(card.given.get(key, ""), [])
    names = {name.casefold(): name for name in known}
    for line, values in card.data:
        if "GENERATE" in card.given:
            if not (len(values) in (2, 3) and all(own.isdigit() for own in values)):
                raise content.refused(line, "GENERATE needs first, last, step", "correct it")
            first, last, step = (*map(int, values), 1)[:3]
            members += range(first, last + 1, max(step, 1))
            continue
        for own in values:
            if own.isdigit():
                members.append(int(own))
            elif own.strip('"').casefold() in names:
                members += [*known[names[own.strip('"').casefold()]]]
            else:
                raise content.refused(line, f"there is no set {own!r}", "define it before")


def _node_set(content: _Content, card: _Card) -> None:
    _set(content, card, "NSET", content.node_sets)


def _element_set(content: _Content, card: _Card) -> None:
    _set(content, card, "ELSET", content.element_sets)


def _surface(content: _Content, card: _Card) -> None:
    """Read sides of elements, such as ``left, S2``; surfaces of nodes are sets of nodes."""
    if card.given.get("TYPE", "ELEMENT").upper() != "ELEMENT":
        return
    sets = {name.casefold(): own for name, own in content.element_sets.items()}
    sides = content.sides.setdefault(card.given.get("NAME", ""), [])
    for line, (named, *side) in card.data:
        own = [int(named)] if named.isdigit() else sets.get(named.strip('"').casefold())
        if own is None:
            raise content.refused(line, f"there is no set {named!r}", "define it before")
        for element in own:
            kind, nodes = content.elements.get(element, ("", []))
            count, face = _CORNERS.get(kind, 0), side[0].upper() if side else ""
            if face not in [f"S{k}" for k in range(1, count + 1)]:
                fix = "give S1, S2, S3, or S4 of plane elements"
                raise content.refused(line, f"element {element} has no side {face!r}", fix)
            first = int(face[1:]) - 1
            sides.append([nodes[first], nodes[(first + 1) % count]])


def _instance(content: _Content, card: _Card) -> None:
    if card.data:
        fix = "write the mesh where it is, as one part without assembly"
        raise content.refused(card.line, "an instance that is moved", fix)


def _include(content: _Content, card: _Card) -> None:
    raise content.refused(card.line, "the file includes another one", "insert its text")


def _skip(content: _Content, card: _Card) -> None:
    """Skip materials, steps and other keywords."""


_READERS = {
    "NODE": _nodes,
    "ELEMENT": _elements,
    "NSET": _node_set,
    "ELSET": _element_set,
    "SURFACE": _surface,
    "INSTANCE": _instance,
    "INCLUDE": _include,
}
