"""Which files and rooms `lacore.solve` passes through: ``python docs/way.py``.

One continuum problem with friction is solved once to load what is loaded late, then again under
`sys.setprofile`. A visit begins where a call leads into another room than the one before.

The flat files of the contract are the ground that all rooms stand on: they are called like a
library, a cone here and a residual there, and count as one room. So there are two figures: the way
with every call into the ground, and the way between rooms, on which such calls end no visit.
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
INSIDE = f"{HOME}{os.sep}"  # lacore_start is beside it
GROUND = "ground"


def block() -> la.Problem:
    """A deformable block that is pushed over a rough floor."""
    body = la.Body(la.meshes.rectangle((0, 4), (0, 1), 8, 2), la.VonMises(shear_strength=1.0))
    return la.Problem(
        {"block": body},
        [la.Traction("block", "left", (1.0, 0.0))],
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle((0, 0), (0, 1)), 0.3)],
        dead_loads=[la.Traction("block", "top", (0.0, -1.0))],
    )


def called(problem: la.Problem) -> list[Path]:
    """Files of lacore in the order in which calls lead into them."""
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
    """The folder below lacore, or the ground where the file lies flat."""
    return GROUND if len(file.parts) == 1 else file.parts[0]


def visits(rooms: list[str]) -> list[str]:
    """The rooms one after the other, each as long as nothing leads out of it once."""
    return [name for name, _ in groupby(rooms)]


def main() -> None:
    """Print how many files and rooms are entered, and how often one is come back to."""
    problem = block()
    la.solve(problem)
    files = called(problem)
    rooms = [room(file) for file in files]
    between = visits([name for name in rooms if name != GROUND])
    every, apart = Counter(visits(rooms)), Counter(between)
    lines = [
        f"{len(set(files))} files of {len(every)} rooms, the ground as one of them",
        f"{'':16}{'with the ground':>18}{'between rooms':>16}",
    ]
    for name in dict.fromkeys(rooms):
        lines.append(f"{name:16}{every[name]:18}{apart[name] or '':>16}")
    lines.append(f"{'visits':16}{every.total():18}{apart.total():16}")
    lines += ["", "between rooms: " + " > ".join(between)]
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
