"""Count how often calls enter a package while lacore solves a problem: ``python docs/entries.py``.

A call of a function is an entry where the function that called it, or the nearest one of ours
above it, belongs to another package. Each analysis runs once before it is counted, so that modules
imported at first use are loaded. Resuming a generator counts as a call.

Packages are the top-level folders of lacore, and the other packages of the repository.
"""

import os
import re
import sys
from collections import Counter
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from types import FrameType
from typing import Any

import lacore as la

HOME = Path(la.__file__).parent
ROOT = HOME.parent
PAGE = ROOT / "docs" / "architecture.md"
OTHERS = {"backends", "verification"}
"""Folders outside lacore that are counted; each is one package."""
LACORE = f"{HOME}{os.sep}"
MOST = {"block solve": 400, "path step": 800, "bracket": 800, "Coulomb range": 5000}
"""Entries that each analysis should not exceed."""


def block() -> la.Problem:
    """Return the problem of a deformable block that is pushed over a rough floor."""
    body = la.Body(la.meshes.rectangle((0, 4), (0, 1), 8, 2), la.VonMises(shear_strength=1.0))
    return la.Problem(
        {"block": body},
        [la.Traction("block", "left", (1.0, 0.0))],
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle((0, 0), (0, 1)), 0.3)],
        dead_loads=[la.Traction("block", "top", (0.0, -1.0))],
    )


def analyses() -> dict[str, Callable[[], object]]:
    """Return the analyses that are counted, by name."""
    rough, footing, column = block(), la.examples.footing(), la.examples.column(friction=0.3)
    ring = la.meshes.quadrilaterals(x=(1, 2), y=(0, 0.25), nx=2, ny=1)
    tube = la.Problem(
        bodies={"tube": la.Body(ring, la.VonMises(1.0), kinematics="axisymmetric", space="q2")},
        supports=[la.Fix("tube", "bottom", "y"), la.Fix("tube", "top", "y")],
        reference_loads=[la.Pressure("tube", "left")],
    )
    wall = la.PointTravel("tube", at=(1, 0), direction=(1, 0))
    return {
        "block solve": lambda: la.solve(rough),
        "path step": lambda: la.sequential(tube, travel=0.1, steps=1, control=wall),
        "bracket": lambda: la.bracket(footing),
        "Coulomb range": lambda: la.coulomb_range(column, restarts=1),
    }


@cache
def package(file: str) -> str:
    """Return the package of a file; empty for files that are not ours."""
    if file.startswith(LACORE) and file != la.__file__:
        return file.removeprefix(LACORE).split(os.sep)[0]
    return next((name for name in OTHERS if file.startswith(f"{ROOT / name}{os.sep}")), "")


def entries(run: Callable[[], object]) -> Counter[str]:
    """Return how often a run enters each package; the run is repeated to load modules."""
    run()
    found: Counter[str] = Counter()

    def note(frame: FrameType, event: str, _: Any) -> None:
        own = package(frame.f_code.co_filename) if event == "call" else ""
        if own and own != _caller(frame):
            found[own] += 1

    sys.setprofile(note)
    try:
        run()
    finally:
        sys.setprofile(None)
    return found


def _caller(frame: FrameType) -> str:
    """Return the package of the nearest function of ours above a call."""
    above = frame.f_back
    while above is not None and not package(above.f_code.co_filename):
        above = above.f_back
    return "" if above is None else package(above.f_code.co_filename)


def table(found: Mapping[str, Counter[str]]) -> str:
    """Return the entries of all packages, a column per analysis."""
    names = sorted({name for count in found.values() for name in count})
    rows = [["", *found], ["most", *(str(MOST[analysis]) for analysis in found)]]
    rows.append(["entries", *(str(count.total()) for count in found.values())])
    rows.append(["packages", *(str(len(count)) for count in found.values())])
    rows += [[name, *(str(count[name] or "") for count in found.values())] for name in names]
    return "".join("".join(f"{cell:>16}" for cell in row) + "\n" for row in rows)


def main() -> None:
    """Print the entries, and write their numbers into the table of docs/architecture.md."""
    found = {name: entries(run) for name, run in analyses().items()}
    sys.stdout.write(table(found))
    text = PAGE.read_text(encoding="utf-8")
    for name, count in found.items():
        row = f"| {name} | {count.total()} | {MOST[name]} |"
        text = re.sub(rf"\| {name} \| \d+ \| \d+ \|", row, text)
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
