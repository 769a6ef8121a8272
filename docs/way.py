"""Which files and rooms `lacore.solve` passes through: ``python docs/way.py``.

One continuum problem with friction is solved once to load what is loaded late, then again under
`sys.setprofile`. A visit begins where a call leads into another room than the one before.
"""

import sys
from collections import Counter
from itertools import pairwise
from pathlib import Path
from types import FrameType
from typing import Any

import lacore as la

HOME = Path(la.__file__).parent


def block() -> la.Problem:
    """A deformable block that is pushed over a rough floor."""
    body = la.Body(la.meshes.rectangle((0, 4), (0, 1), 8, 2), la.VonMises(shear_strength=1.0))
    return la.Problem(
        {"block": body},
        [la.Traction("block", "left", (1.0, 0.0))],
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle((0, 0), (0, 1)), 0.3)],
        dead_loads=[la.Traction("block", "top", (0.0, -1.0))],
    )


def visited(problem: la.Problem) -> list[Path]:
    """Files of lacore in the order in which calls lead into them."""
    found: list[Path] = []

    def note(frame: FrameType, event: str, _: Any) -> None:
        if event != "call" or not frame.f_code.co_filename.startswith(str(HOME)):
            return
        file = Path(frame.f_code.co_filename).relative_to(HOME)
        if not found or found[-1] != file:
            found.append(file)

    sys.setprofile(note)
    try:
        la.solve(problem)
    finally:
        sys.setprofile(None)
    return found


def room(file: Path) -> str:
    """The folder below lacore, or the file itself where it lies flat."""
    return file.parts[0]


def main() -> None:
    """Print how many files and rooms are entered, and how often one is come back to."""
    problem = block()
    la.solve(problem)
    files = visited(problem)
    rooms = [room(files[0]), *(room(b) for a, b in pairwise(files) if room(a) != room(b))]
    lines = [f"{len(set(files))} files of {len(set(rooms))} rooms are entered"]
    for name, count in Counter(rooms).most_common():
        lines.append(f"{name:20} entered {count} times, first as number {rooms.index(name) + 1}")
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
