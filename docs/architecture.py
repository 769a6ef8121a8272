"""Draw the packages of lacore and verification and their imports: ``make architecture``.

The order of the packages is the list in tests/test_layers.py, their purposes are their docstrings,
and the imports are read from the code, so that the pictures show the code as it is. The counts
in docs/architecture.md are written too.
"""

import ast
import re
import sys
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path
from runpy import run_path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))  # run as a script from anywhere

from tests.test_layers import (  # noqa: E402
    LACORE,
    MECHANICS_WING,
    ORDERS,
    PLACES,
    SOLVER_WING,
    layers,
    module_of,
    packages_seen,
)

LAYERS = {
    "interface with backends: what a backend receives, and what it returns": LACORE[
        : LACORE.index(SOLVER_WING[0])
    ],
    "programs: loops and proofs, without a mesh": SOLVER_WING,
    "mechanics: from bodies to the program": MECHANICS_WING,
    "limit problems, and analyses that use them": LACORE[
        LACORE.index("limit") : LACORE.index("files")
    ],
    "output: files and pictures": LACORE[LACORE.index("files") :],
}
"""Layers of lacore from the bottom up; the second and the third do not import each other."""
COLOURS = dict(zip(LAYERS, ("#e8e6df", "#d9e6f2", "#f6e3c9", "#dcebd6", "#efdcea"), strict=True))
_OTHER = "#eeeeee"
_FONT = "font-family='Helvetica, Arial, sans-serif'"
_ROW, _COLUMN, _NAME, _TEXT = 17, 13, 106, 532  # px: cells of the matrix, names, purposes


def imported(top: str) -> dict[str, set[str]]:
    """Return what each package imports, anywhere in its files, in the order of the packages."""
    found: dict[str, set[str]] = {name: set() for name in ORDERS[top]}
    for path in PLACES[top].rglob("*.py"):
        own = module_of(path).split(".")[1]
        if own in found:  # not __init__.py of the top-level package
            found[own] |= packages_seen(path, top) - {own}
    return found


def purpose(top: str, name: str) -> str:
    """Return the first sentence of the docstring of a package."""
    place = PLACES[top] / name
    file = place / "__init__.py" if place.is_dir() else place.with_suffix(".py")
    text = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    first = text.partition("\n")[0]
    return first.partition(". ")[0].rstrip(".").replace("`", "")


def colour(name: str, top: str) -> str:
    """Return the colour of the layer of a package."""
    if top != "lacore":
        return _OTHER
    return next(COLOURS[layer] for layer, names in LAYERS.items() if name in names)


def matrix(top: str) -> str:
    """Return an SVG with one row per package, and dots in the columns of what it imports."""
    needs = imported(top)
    packages, count = list(needs), len(needs)
    wide, high = _NAME + count * _COLUMN + 12 + _TEXT, (count + 1) * _ROW + _NAME
    drawn = []
    for row, name in enumerate(reversed(packages)):
        y, own = (row + 0.5) * _ROW + 8, packages.index(name)
        drawn.append(_box(0, y - _ROW / 2, wide, _ROW, colour(name, top)))
        drawn.append(_text(_NAME - 6, y, name, anchor="end", weight="bold"))
        drawn.append(_box(_NAME + own * _COLUMN, y - _ROW / 2, _COLUMN, _ROW, "#7a7a72"))
        drawn += [
            f"<circle cx='{_NAME + (packages.index(other) + 0.5) * _COLUMN:g}' cy='{y:g}' r='3.6'/>"
            for other in packages
            if other in needs[name]
        ]
        drawn.append(_text(_NAME + count * _COLUMN + 8, y, purpose(top, name)))
    for column, name in enumerate(packages):
        x, y = _NAME + (column + 0.5) * _COLUMN, count * _ROW + 16
        turned = f"<g transform='translate({x:g} {y:g}) rotate(-90)'>"
        drawn.append(f"{turned}{_text(0, 0, name, anchor='end')}</g>")
    return _svg(wide, high, drawn)


def layers_of_lacore() -> str:
    """Return an SVG of the layers of lacore; packages import from their left and from below."""
    ground, left, right, upper, top = LAYERS
    wide, gap, high = 1040.0, 10.0, 92.0
    half = (wide - gap) * len(SOLVER_WING) / (len(SOLVER_WING) + len(MECHANICS_WING))
    drawn = [
        *_layer(top, 0.0, 0.0, wide, high),
        *_layer(upper, 0.0, high + gap, wide, high),
        *_layer(left, 0.0, 2 * (high + gap), half, high),
        *_layer(right, half + gap, 2 * (high + gap), wide - half - gap, high),
        *_layer(ground, 0.0, 3 * (high + gap), wide, high),
    ]
    return _svg(wide, 4 * high + 3 * gap, drawn)


def _layer(title: str, x: float, y: float, wide: float, high: float) -> Iterator[str]:
    yield _box(x, y, wide, high, COLOURS[title], rounded=6)
    yield _text(x + 10, y + 18, title)
    names = LAYERS[title]
    longest = [max(map(len, name.split("_"))) + 3 for name in names]
    for name, letters in zip(names, longest, strict=True):
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


def passed() -> int:
    """Return how many packages of lacore one solve enters."""
    script = run_path(str(ROOT / "docs" / "entries.py"))
    return len(set(script["entries"](script["analyses"]()["block solve"])) - script["OTHERS"])


def counts() -> dict[str, int]:
    """Return the counts in docs/architecture.md by their patterns."""
    return {
        r"(passes through )\d+( packages)": passed(),
        **{rf"(`{top}` has )\d+( packages)": len(names) for top, names in ORDERS.items()},
        **{
            rf"(`{top}` has \d+ packages and top-level modules on )\d+( layers)": max(
                layers(top).values()
            )
            for top in ORDERS
        },
    }


def pictures() -> dict[str, str]:
    """Return all pictures by the names of their files."""
    return {
        "packages.svg": layers_of_lacore(),
        **{f"imports-{top.removeprefix('lacore_')}.svg": matrix(top) for top in ORDERS},
    }


def main() -> None:
    """Write the pictures, and the counts in the page that shows them."""
    for name, text in pictures().items():
        (ROOT / "docs" / name).write_text(text, encoding="utf-8")
    page = ROOT / "docs" / "architecture.md"
    text = page.read_text(encoding="utf-8")
    for pattern, count in counts().items():
        text = re.sub(pattern, rf"\g<1>{count}\g<2>", text)
    page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
