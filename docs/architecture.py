"""Draw the rooms of lacore and verification, and who imports whom: ``make architecture``.

The order of rooms is the list in tests/test_layers.py, what each is for its own docstring, and the
imports are those of the code, so that the pictures are those of the code as it is.
"""

import ast
import sys
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))  # run as a script from anywhere

from tests.test_layers import (  # noqa: E402
    HOUSES,
    LACORE,
    MECHANICS_WING,
    SOLVER_WING,
    module_of,
    rooms_seen,
)

FLOORS = {
    "the ground: what a backend is given, and what it gives back": LACORE[
        : LACORE.index(SOLVER_WING[0])
    ],
    "programs: loops and proofs, no mesh": SOLVER_WING,
    "bodies: from what is said to the program, no loop": MECHANICS_WING,
    "where both meet: limit problems, and what goes on from them": LACORE[
        LACORE.index("limit") : LACORE.index("files")
    ],
    "what is shown and written": LACORE[LACORE.index("files") :],
}
"""Of lacore, from the ground up; the second and the third stand side by side."""
COLOURS = dict(zip(FLOORS, ("#e8e6df", "#d9e6f2", "#f6e3c9", "#dcebd6", "#efdcea"), strict=True))
_OTHER = "#eeeeee"
_FONT = "font-family='Helvetica, Arial, sans-serif'"
_ROW, _COLUMN, _NAME, _TEXT = 17, 13, 106, 532  # px: of the matrix, names, what rooms are for


def imported(house: str) -> dict[str, set[str]]:
    """Rooms that each room of a house imports, wherever in its files, in the order of the house."""
    found: dict[str, set[str]] = {name: set() for name in HOUSES[house]}
    for path in (ROOT / house).rglob("*.py"):
        own = module_of(path).split(".")[1]
        if own in found:  # not the face
            found[own] |= rooms_seen(path, house) - {own}
    return found


def purpose(house: str, name: str) -> str:
    """The first sentence of the docstring of a room."""
    place = ROOT / house / name
    file = place / "__init__.py" if place.is_dir() else place.with_suffix(".py")
    text = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    first = text.partition("\n")[0]
    return first.partition(". ")[0].rstrip(".").replace("`", "")


def colour(name: str, house: str) -> str:
    """Of the floor that a room is on."""
    if house != "lacore":
        return _OTHER
    return next(COLOURS[floor] for floor, rooms in FLOORS.items() if name in rooms)


def matrix(house: str) -> str:
    """An SVG: a row a room, the ground below; dots in the columns of the rooms that it imports."""
    needs = imported(house)
    rooms, count = list(needs), len(needs)
    wide, high = _NAME + count * _COLUMN + 12 + _TEXT, (count + 1) * _ROW + _NAME
    drawn = []
    for row, name in enumerate(reversed(rooms)):
        y, own = (row + 0.5) * _ROW + 8, rooms.index(name)
        drawn.append(_box(0, y - _ROW / 2, wide, _ROW, colour(name, house)))
        drawn.append(_text(_NAME - 6, y, name, anchor="end", weight="bold"))
        drawn.append(_box(_NAME + own * _COLUMN, y - _ROW / 2, _COLUMN, _ROW, "#7a7a72"))
        drawn += [
            f"<circle cx='{_NAME + (rooms.index(other) + 0.5) * _COLUMN:g}' cy='{y:g}' r='3.6'/>"
            for other in rooms
            if other in needs[name]
        ]
        drawn.append(_text(_NAME + count * _COLUMN + 8, y, purpose(house, name)))
    for column, name in enumerate(rooms):
        x, y = _NAME + (column + 0.5) * _COLUMN, count * _ROW + 16
        turned = f"<g transform='translate({x:g} {y:g}) rotate(-90)'>"
        drawn.append(f"{turned}{_text(0, 0, name, anchor='end')}</g>")
    return _svg(wide, high, drawn)


def house_of_lacore() -> str:
    """An SVG: rooms of lacore on their floors; each imports from its left and from below."""
    ground, left, right, upper, top = FLOORS
    wide, gap, high = 1040.0, 10.0, 92.0
    half = (wide - gap) * len(SOLVER_WING) / (len(SOLVER_WING) + len(MECHANICS_WING))
    drawn = [
        *_floor(top, 0.0, 0.0, wide, high),
        *_floor(upper, 0.0, high + gap, wide, high),
        *_floor(left, 0.0, 2 * (high + gap), half, high),
        *_floor(right, half + gap, 2 * (high + gap), wide - half - gap, high),
        *_floor(ground, 0.0, 3 * (high + gap), wide, high),
    ]
    return _svg(wide, 4 * high + 3 * gap, drawn)


def _floor(title: str, x: float, y: float, wide: float, high: float) -> Iterator[str]:
    yield _box(x, y, wide, high, COLOURS[title], rounded=6)
    yield _text(x + 10, y + 18, title)
    rooms = FLOORS[title]
    longest = [max(map(len, name.split("_"))) + 3 for name in rooms]
    for name, letters in zip(rooms, longest, strict=True):
        each = (wide - 10) * letters / sum(longest)
        yield _box(x + 8, y + 36, each - 6, 40, "#ffffff", rounded=4)
        words = name.split("_")
        for line, word in enumerate(words):
            down = 14 * (line - (len(words) - 1) / 2)
            yield _text(x + 5 + each / 2, y + 56 + down, word, anchor="middle", weight="bold")
        x += each


def _box(x: float, y: float, wide: float, high: float, fill: str, rounded: float = 0) -> str:
    place = f"x='{x:g}' y='{y:g}' width='{wide:g}' height='{high:g}' rx='{rounded:g}'"
    return f"<rect {place} fill='{fill}' stroke='#fff'/>"


def _text(x: float, y: float, text: str, anchor: str = "start", weight: str = "normal") -> str:
    place = f"x='{x:g}' y='{y + 4:g}' text-anchor='{anchor}' font-weight='{weight}'"
    return f"<text {place}>{escape(text)}</text>"


def _svg(wide: float, high: float, drawn: Sequence[str]) -> str:
    size = f"width='{wide:g}' height='{high:g}' viewBox='-6 -6 {wide + 12:g} {high + 12:g}'"
    paper = f"<rect x='-6' y='-6' width='{wide + 12:g}' height='{high + 12:g}' fill='#fff'/>"
    head = f"<svg xmlns='http://www.w3.org/2000/svg' {size} {_FONT} font-size='11.5'>"
    return "\n".join([head, paper, *drawn, "</svg>", ""])


def pictures() -> dict[str, str]:
    """All of them, by the names of their files."""
    return {
        "rooms.svg": house_of_lacore(),
        **{f"imports-{house}.svg": matrix(house) for house in HOUSES},
    }


def main() -> None:
    """Write them beside the page that shows them."""
    for name, text in pictures().items():
        (ROOT / "docs" / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
