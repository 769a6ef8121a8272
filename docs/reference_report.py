"""Write the reference report afresh: ``make reference``.

It is small, committed under reports/reference, and a test solves and draws it again.
"""

import shutil
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from functools import partial
from pathlib import Path

from lacore_verification.case.band import BRACKET
from lacore_verification.catalogue.catalogue import catalogue
from lacore_verification.harness.campaigns.comparison import plan
from lacore_verification.harness.campaigns.overview import overview
from lacore_verification.harness.campaigns.run_all import run_all
from lacore_verification.harness.campaigns.sweep import plan as plan_sweep
from lacore_verification.harness.store.results import load_outcomes
from lacore_verification.harness.store.store import NAME, sessions
from lacore_verification.report.blocks import Report
from lacore_verification.report.drawing import Drawn, Subject, drawing
from lacore_verification.report.files import write
from lacore_verification.report.page import comparison_report, subjects
from lacore_verification.runs.run import Run

FOLDER = Path(__file__).parent.parent / "reports" / "reference"
TITLE = "Reference report of lacore"
PICTURES = 1  # of each case: the report is small
_WIDE = {"target_width": 0.05}  # of the bracket: its picture is small


def runs() -> list[Run]:
    """Return the runs: a bracket, a sweep of r, a refinement, and friction that is not unique."""
    swept = ["deformable-block:crushing"]
    return [
        *(replace(run, settings=_WIDE) for run in overview() if _is_bracket(run)),
        *plan_sweep(swept, ["r=1e-1:1e-3:5:log"], ["clarabel", "newton"], ["coarse"]),
        *plan_sweep(["platens-square:mu-0.5"], ["n=3,5,8"], ["clarabel", "newton"]),
        *plan(["deformable-block:sliding", "shear-patch"], ["clarabel", "newton"], ["coarse"]),
        *plan(["wall-1", "wedge-extraction:rough"], ["clarabel", "highs"]),
    ]


def _is_bracket(run: Run) -> bool:
    return run.case.id == "prandtl-punch" and run.coupling == BRACKET


def report(
    store: Path, paint: Callable[[Sequence[Subject]], AbstractContextManager[Drawn]]
) -> Report:
    """The report of a store, with what `paint` makes of its subjects."""
    outcomes, _ = load_outcomes(store, catalogue())
    (provenance,) = sessions(store).values()
    with paint(subjects(outcomes, PICTURES)) as drawn:
        return comparison_report(outcomes, provenance, drawn, TITLE)


def main() -> None:
    """Solve, draw, and replace what is there."""
    shutil.rmtree(FOLDER, ignore_errors=True)
    run_all(runs(), FOLDER / NAME)
    write(report(FOLDER / NAME, partial(drawing, jobs=1)), FOLDER)
    (FOLDER / f"{NAME}.lock").unlink(missing_ok=True)


if __name__ == "__main__":
    main()
