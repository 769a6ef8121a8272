"""Trace which files and packages `lacore.solve` passes through: ``python docs/way.py``.

A continuum problem with friction is solved once to load modules that are imported at first use,
then again under `sys.setprofile`. A visit begins where a call leads into another package.

All packages use the flat modules of the interface with backends as a library, for a cone or a
residual. These modules count as one package, and the second column leaves calls of them out.
"""

import os
import sys
from collections import Counter
from itertools import groupby
from pathlib import Path
from types import FrameType
from typing import Any

import lacore as la

HOME = Path(la.__file__).parent
INSIDE = f"{HOME}{os.sep}"  # with the separator, which excludes lacore_start
GROUND = "interface"


def block() -> la.Problem:
    """Return the problem of a deformable block that is pushed over a rough floor."""
    body = la.Body(la.meshes.rectangle((0, 4), (0, 1), 8, 2), la.VonMises(shear_strength=1.0))
    return la.Problem(
        {"block": body},
        [la.Traction("block", "left", (1.0, 0.0))],
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle((0, 0), (0, 1)), 0.3)],
        dead_loads=[la.Traction("block", "top", (0.0, -1.0))],
    )


def called(problem: la.Problem) -> list[Path]:
    """Return the files of lacore in the order in which calls lead into them."""
    found: list[Path] = []

    def note(frame: FrameType, event: str, _: Any) -> None:
        if event == "call" and frame.f_code.co_filename.startswith(INSIDE):
            found.append(Path(frame.f_code.co_filename).relative_to(HOME))

    sys.setprofile(note)
    try:
        la.solve(problem)
    finally:
        sys.setprofile(None)
    return found


def room(file: Path) -> str:
    """Return the package of a file; flat modules belong to the interface."""
    return GROUND if len(file.parts) == 1 else file.parts[0]


def visits(rooms: list[str]) -> list[str]:
    """Return the packages one after the other, without repetition."""
    return [name for name, _ in groupby(rooms)]


def main() -> None:
    """Print how many files and packages are visited, and how often."""
    problem = block()
    la.solve(problem)
    files = called(problem)
    rooms = [room(file) for file in files]
    between = visits([name for name in rooms if name != GROUND])
    every, apart = Counter(visits(rooms)), Counter(between)
    lines = [
        f"{len(set(files))} files of {len(every)} packages, counting the interface as one",
        f"{'':16}{'all visits':>18}{'without interface':>20}",
    ]
    for name in dict.fromkeys(rooms):
        lines.append(f"{name:16}{every[name]:18}{apart[name] or '':>20}")
    lines.append(f"{'visits':16}{every.total():18}{apart.total():20}")
    lines += ["", "without interface: " + " > ".join(between)]
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
