"""Write the table, the times and the pictures of README and guide afresh: ``make readme``.

Numbers there are computed, never typed. Times are of a quiet machine or of none: run nothing else.
"""

import contextlib
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from math import isnan
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

import lacore as la
from verification.campaigns.comparison import plan
from verification.campaigns.run_all import run_all
from verification.catalogue.catalogue import find
from verification.runs.outcome import Outcome
from verification.verdicts.words import PASS

ROOT = Path(__file__).parent.parent
SHOWN = ["prandtl-punch:smooth", "deformable-block:crushing"]
EXACT = [
    "platens-coulomb:mu-0.1",
    "wedge-extraction:rough",
    "portal-sway:one-foot-slides",
    "wall-1",
]
PICTURES = {"mechanism": "deformable-block:crushing", "wall": "wall-3:mu-0.65"}


def table(outcomes: list[Outcome]) -> str:
    """Markdown: one line a run."""
    lines = [
        "| case | backend | coupling | load factor | reference | error | rigor | solve |",
        "|---|---|---|--:|--:|--:|---|--:|",
    ]
    for outcome in outcomes:
        row = outcome.row
        if row.verdict != PASS:
            raise SystemExit(f"{outcome.run.label}: {row.verdict}: {row.why}")
        lines.append(
            f"| {row.case}:{row.variant} | {row.backend} | {row.coupling} | {row.load_factor:.6f} |"
            f" {row.expected} | {_percent(row.error)} | {row.rigor} | {row.solve_time:.2f} s |"
        )
    return "\n".join(lines)


def _percent(error: float) -> str:
    return "" if isnan(error) else f"{round(100 * error, 4) + 0.0:+.4f} %"  # no minus before 0


def times(folder: Path) -> str:
    """Markdown: what the first commands take here, from nothing, by the clock and the processor."""
    lines = []
    for command in ("compare", "verify"):
        begin, before = time.perf_counter(), _processor()
        subprocess.run(
            [sys.executable, "-m", "verification", command, "--out", str(folder / command)],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        wall, spent = time.perf_counter() - begin, _processor() - before
        lines.append(f"`lacore {command}` {wall:.0f} s ({spent:.0f} s of processor time)")
    return f"On {os.cpu_count()} cores: {', '.join(lines)}."


def _processor() -> float:
    """s, of all processes that this one has waited for, and of theirs."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def between(text: str, first: str, last: str, new: str) -> str:
    """A text with all that stands between two marks replaced."""
    before, mark, rest = text.partition(f"{first}\n")
    _, end, after = rest.partition(last)
    if not (mark and end):
        raise SystemExit(f"README.md: {first} ... {last} is not there: nothing is written")
    return f"{before}{mark}{new}\n{end}{after}"


def picture_of_guide(page: str, picture: str, drawn: str) -> None:
    """That which a page of the guide draws of something, by its code up to there.

    Args:
        page: of the guide.
        picture: name of the file.
        drawn: name of a figure in the code, or of what is plotted.
    """
    text = (ROOT / "docs" / "guide" / f"{page}.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    (last,) = [number for number, code in enumerate(blocks) if f'"{picture}"' in code]
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        names: dict[str, Any] = {}
        for code in blocks[: last + 1]:
            exec(code, names)
    thing = names[drawn]
    figure = thing if isinstance(thing, Figure) else thing.plot()
    figure.savefig(ROOT / "docs" / picture, dpi=80)


def main() -> None:
    """Solve, draw, and replace what stands between the marks."""
    with tempfile.TemporaryDirectory() as folder:
        runs = plan(SHOWN, ["clarabel", "newton", "ipopt"], ["medium"])
        runs += plan(EXACT, ["clarabel"], ["medium"])
        outcomes = run_all(runs, Path(folder) / "results.sqlite")
        measured = times(Path(folder))
    readme = ROOT / "README.md"
    text = readme.read_text(encoding="utf-8")
    text = between(text, "<!-- comparison -->", "<!-- end -->", table(outcomes))
    text = between(text, "<!-- times -->", "<!-- end times -->", measured)
    readme.write_text(text, encoding="utf-8")
    for name, shown in PICTURES.items():
        case, (variant,) = find(shown)
        mesh = "medium" if case.meshed else next(iter(case.meshes))
        state = la.solve(case.problem(variant, mesh), throw=True)
        state.plot().savefig(ROOT / "docs" / f"{name}.png", dpi=80)
    picture_of_guide("large-deformation", "billet.png", "path")
    picture_of_guide("footing", "ground.png", "problem")
    picture_of_guide("footing", "footing.png", "state")
    picture_of_guide("footing", "inclined.png", "failure_envelope")
    picture_of_guide("structures", "portal.png", "state")
    picture_of_guide("structures", "plate.png", "state")
    picture_of_guide("bridge", "bridge.png", "governing")
    picture_of_guide("forming", "upset.png", "rough")
    picture_of_guide("solids", "square-section.png", "cut")
    picture_of_guide("domes", "dome.png", "state")


if __name__ == "__main__":
    main()
