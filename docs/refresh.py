"""Write the generated parts of the README and of the guide: ``make readme``.

``python docs/refresh.py`` writes everything; ``table``, ``times`` and ``pictures`` select parts of
it. All figures are computed. Run nothing else at the same time: they include times.
"""

import argparse
import contextlib
import inspect
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from math import ceil, floor, isnan
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

import lacore as la
from lacore.reporting.errors import require_known
from lacore_verification.case.band import BRACKET
from lacore_verification.catalogue.catalogue import find
from lacore_verification.harness.campaigns.comparison import plan
from lacore_verification.harness.campaigns.run_all import run_all
from lacore_verification.harness.verdicts.allowed import distance
from lacore_verification.harness.verdicts.words import PASS
from lacore_verification.report.problems.starters import text as starter
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.run import Run

ROOT = Path(__file__).parent.parent
BRACKETED = (
    "prandtl-punch:smooth",
    "layered-clay:stiff-below",
    "vertical-cut",
    "notched-strip",
)
"""Cases that the table shows between two proven bounds."""
SOLVED = (
    "deformable-block:crushing",
    "platens-coulomb:mu-0.1",
    "portal-sway:one-foot-slides",
    "wall-1",
)
"""Cases with Coulomb friction, of which a state is certified."""
_DIGIT = 1e-4  # of bounds in the table: lower ones are rounded down, upper ones up
TIMED = {
    "lacore compare": [sys.executable, "-m", "lacore_verification", "compare", "--out"],
    "make test": ["make", "test"],
}
"""The first two commands; one that ends with ``--out`` gets a new folder."""


def table() -> str:
    """Return the table of results in Markdown, one line per run."""
    runs = [*bracketed()]
    runs += plan(SOLVED, ["clarabel"], ["medium"], ["certified"])
    lines = [
        "| case | lower bound <= load factor <= upper bound | reference | error | rigor | time |",
        "|---|---|---|--:|---|--:|",
    ]
    with tempfile.TemporaryDirectory() as folder:
        outcomes = run_all(runs, Path(folder) / "results.sqlite")
    for outcome in outcomes:
        row = outcome.row
        if row.verdict != PASS:
            raise SystemExit(f"{outcome.run.label}: {row.verdict}: {row.why}")
        cells = (_linked(outcome.run), *_result(outcome), row.rigor)
        lines.append(f"| {' | '.join(cells)} | {row.solve_time:.2f}\N{NO-BREAK SPACE}s |")
    return "\n".join(lines)


def bracketed() -> Iterator[Run]:
    """Yield the brackets of the table, each from the mesh that its case states."""
    for name in BRACKETED:
        case, (variant, *_) = find(name)
        level = case.bracketed_from
        yield from plan([f"{case.id}:{variant.name}"], ["clarabel"], [level], [BRACKET])


def _linked(run: Run) -> str:
    """Return the title of the case of a run as a link to its file, and the variant."""
    file = Path(inspect.getfile(run.case.build)).relative_to(ROOT).as_posix()
    return f"[{run.case.title}]({file}), {run.variant.name}"


def _result(outcome: Outcome) -> tuple[str, str, str]:
    """Return the load factor, between its bounds where there are both, the reference, the error."""
    row, case, variant = outcome.row, outcome.run.case, outcome.run.variant
    if row.coupling != BRACKET:
        return f"{row.load_factor:.6f}", row.expected, _percent(row.error)
    mean = (row.lower + row.upper) / 2
    error = distance(mean, case.reference_of(variant), case.band_of(variant, int(row.n_elements)))
    low, high = floor(row.lower / _DIGIT) * _DIGIT, ceil(row.upper / _DIGIT) * _DIGIT
    return f"{low:.4f} <= {mean:.4f} <= {high:.4f}", row.expected, _percent(error)


def _percent(error: float) -> str:
    percent = round(100 * error, 3) + 0.0  # without a minus sign before zero
    return "" if isnan(error) else f"{percent:+.3f}\N{NO-BREAK SPACE}%"


def times(commands: Mapping[str, Sequence[str]] = TIMED) -> str:
    """Measure the first commands, by the clock and the processor, and return a sentence.

    Raises:
        CalledProcessError: a command failed, so that its time is not that of its work.
    """
    measured = []
    for name, command in commands.items():
        with tempfile.TemporaryDirectory() as folder:
            begin, before = time.perf_counter(), _processor()
            out = [folder] if command[-1] == "--out" else []
            subprocess.run([*command, *out], check=True, cwd=ROOT, stdout=subprocess.DEVNULL)
            wall, spent = time.perf_counter() - begin, _processor() - before
        measured.append(f"`{name}` {wall:.0f} s ({spent:.0f} s of processor time)")
    return f"On {os.cpu_count()} cores: {', '.join(measured)}."


def _processor() -> float:
    """Return the processor time in s of all processes that have ended, with their children."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def between(text: str, first: str, last: str, new: str) -> str:
    """Return a text in which everything between two marks is replaced."""
    before, mark, rest = text.partition(f"{first}\n")
    _, end, after = rest.partition(last)
    if not (mark and end):
        raise SystemExit(f"README.md has no marks {first} ... {last}: nothing is written")
    return f"{before}{mark}{new}\n{end}{after}"


def write(first: str, last: str, new: str) -> None:
    """Replace what stands between two marks of the README."""
    readme = ROOT / "README.md"
    text = between(readme.read_text(encoding="utf-8"), first, last, new)
    readme.write_text(text, encoding="utf-8")


def footing() -> Figure:
    """Draw the collapse mechanism of a rough strip footing on clay, with proven bounds."""
    mesh = la.meshes.rectangle(x=(-4, 4), y=(-2, 0), nx=32, ny=8)
    problem = la.Problem(
        bodies={"clay": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        supports=[la.Fix("clay", side) for side in ("left", "right", "bottom")],
        reference_loads=[
            la.RigidFooting("clay", lambda x: (x[1] == 0) & (abs(x[0]) <= 1), direction=(0, -1))
        ],
    )
    found = la.bracket(problem, 0.01, max_elements=8000)
    title = f"Proven: {found.lower:.3f} <= load factor <= {found.upper:.3f}"
    exact = "(exact: 2 + \N{GREEK SMALL LETTER PI} = 5.142)"
    return titled(found.upper_bound.state.plot(), f"{title}   {exact}")


def arch() -> Figure:
    """Draw what ``lacore new arch`` and ``lacore solve`` show."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "arch.toml"
        file.write_text(starter("arch"), encoding="utf-8")
        state = la.solve(la.read_problem(file), throw=True)
    return titled(state.plot(), f"Load factor {state.load_factor:.4g}: the arch opens at hinges")


def wall() -> Figure:
    """Draw the collapse mechanism of a masonry wall."""
    case, (variant,) = find("wall-3:mu-0.65")
    return la.solve(case.problem(variant, next(iter(case.meshes))), throw=True).plot()


def titled(figure: Figure, title: str) -> Figure:
    """Return a figure with one line of title, in place of the two that states have."""
    figure.suptitle(title, fontsize=11, x=0.01, y=0.9, ha="left")
    return figure


PICTURES: Mapping[str, Callable[[], Figure]] = {
    "footing-collapse": footing,
    "arch": arch,
    "wall": wall,
}
"""Pictures that no page of the guide draws by its code."""
OF_GUIDE = {
    "billet.png": ("large-deformation", "path"),
    "ground.png": ("footing", "problem"),
    "footing.png": ("footing", "state"),
    "inclined.png": ("footing", "failure_envelope"),
    "portal.png": ("structures", "state"),
    "plate.png": ("structures", "state"),
    "bridge.png": ("bridge", "governing"),
    "upset.png": ("forming", "rough"),
    "round-die.png": ("two-bodies", "bent"),
    "square-section.png": ("solids", "cut"),
    "dome.png": ("domes", "state"),
}
"""Pictures of the guide: the page, and the name of the figure, or of what is plotted."""
ANIMATIONS = {"wedge.gif": ("two-bodies", "path")}
"""Animations of the guide: the page, and the name of the path."""


def picture_of_guide(picture: str, page: str, drawn: str) -> Figure:
    """Run the code of a page of the guide up to where it draws a picture, and return that.

    Args:
        picture: name of the file.
        page: name of the page.
        drawn: name of a figure in the code, or of what is plotted.
    """
    thing = thing_of_guide(picture, page, drawn)
    return thing if isinstance(thing, Figure) else thing.plot()


def thing_of_guide(picture: str, page: str, drawn: str) -> Any:
    """Return what the code of a page of the guide has under a name where it draws a picture."""
    text = (ROOT / "docs" / "guide" / f"{page}.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    (last,) = [number for number, code in enumerate(blocks) if f'"{picture}"' in code]
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        names: dict[str, Any] = {}
        for code in blocks[: last + 1]:
            exec(code, names)
    return names[drawn]


def write_table() -> None:
    """Write the table of results."""
    write("<!-- comparison -->", "<!-- end -->", table())


def write_times() -> None:
    """Write the times of the first commands."""
    write("<!-- times -->", "<!-- end times -->", times())


def write_pictures() -> None:
    """Draw all pictures of the README and of the guide."""
    for name, draw in PICTURES.items():
        draw().savefig(ROOT / "docs" / f"{name}.png", dpi=110, bbox_inches="tight")
    for name, (page, drawn) in OF_GUIDE.items():
        picture_of_guide(name, page, drawn).savefig(ROOT / "docs" / name, dpi=80)
    for name, (page, drawn) in ANIMATIONS.items():
        thing_of_guide(name, page, drawn).animate(ROOT / "docs" / name, dpi=55)


PARTS = {"table": write_table, "times": write_times, "pictures": write_pictures}


def main() -> None:
    """Write the parts that are named, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"default: {', '.join(PARTS)}")
    parts = parser.parse_args().parts or list(PARTS)
    for part in parts:
        require_known("PART", part, PARTS)
        PARTS[part]()


if __name__ == "__main__":
    main()
