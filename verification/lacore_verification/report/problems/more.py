"""All analyses in addition to the load factor, by name."""

from collections.abc import Iterator, Mapping, Sequence
from math import inf
from typing import Any

import lacore as la
from lacore.analyses.stable import require_dead_loads
from lacore.files.problem.reading import Stated
from lacore.files.problem.varied import Varied
from lacore.reporting import views
from lacore.reporting.errors import InputError
from lacore.reporting.findings import texts
from lacore.reporting.text import Reader
from lacore.reporting.units import Units
from lacore_verification.report.problems.asking import Analysis, Given, Question
from lacore_verification.report.problems.bounding import AFTER, BOUNDING
from lacore_verification.report.problems.tables import sensitivity_in
from lacore_verification.report.problems.varying import VARYING


def _stands(found: la.Stable, units: Units) -> str:
    return found.stability.standing.value


def _fallen(found: la.Stable) -> str:
    if found.stands is None:
        return "Neither equilibrium nor collapse is proven"
    if found.stands:
        return "Stresses and forces that carry the dead loads"
    return "Collapse mechanism under the dead loads alone"


def _differentiated(given: Given) -> la.Sensitivity:
    return la.sensitivity(given.state)


def _most(found: la.Sensitivity, units: Units) -> str:
    methods = " and ".join(dict.fromkeys(found.table["method"]))
    return f"{found.facts().told['most']}: change in % for a change of 1 %, by {methods}"


def _cases(given: Given) -> la.LoadCases:
    width = given.question.bracket
    return la.load_cases(given.problem, given.cases, given.question.backend, target_width=width)


def _named(found: la.LoadCases, units: Units) -> str:
    said = found.facts().title
    if found.sure and not found.failed:
        return f"{said}, proven"
    return f"{said}; {texts(found.findings, Reader(units, files=True))}"


def _by_case(found: la.LoadCases, units: Units) -> dict[str, Any]:
    rows = found.table[["case", "status", "load_factor", "lower", "upper"]].to_dict("records")
    return {"governing": found.governing, "sure": found.sure, "cases": rows}


def _combined(given: Given) -> la.Envelope:
    width = given.question.bracket
    return la.envelope(
        given.problem, given.cases, backend=given.question.backend, target_width=width
    )


def _hulls(found: la.Envelope, units: Units) -> dict[str, Any]:
    return {
        "names": list(found.names),
        "width": found.width,
        "inner": found.inner.tolist(),
        "outer": found.outer.tolist(),
        "planes": found.planes.tolist(),
        "rigor": found.rigor,
    }


ANALYSES: Mapping[str, Analysis] = {
    **BOUNDING,
    "stable": Analysis(
        title="Under the dead loads alone",
        doing="checking the dead loads",
        ask=lambda given: la.stable(given.problem, given.question.backend),
        good=lambda found: found.stands is not None,
        said=_stands,
        caption=_fallen,
        document=lambda found, units: {
            "stands": found.stands,
            "residual": found.stability.residual,
        },
        script=lambda question, _: f'la.stable(problem, "{question.backend}")',
        dead=True,
        drawn=lambda found, units: views.picture(found, units=units),
    ),
    "sensitivity": Analysis(
        title="Sensitivity of the load factor",
        doing="computing sensitivities",
        ask=_differentiated,
        good=lambda found: bool((found.table["why"] == "").any()),
        said=_most,
        caption=lambda found: "Elasticities: change of the load factor in % for a change of 1 %",
        document=lambda found, units: {"table": found.table.to_dict("records")},
        script=lambda question, _: "la.sensitivity(state)",
        table=lambda found: found.table,
        told=sensitivity_in,
    ),
    "cases": Analysis(
        title="Load cases",
        doing="solving the load cases",
        ask=_cases,
        good=lambda found: bool(found.governing) and not found.failed,
        said=_named,
        caption=lambda found: "Load factors by case",
        document=_by_case,
        script=lambda question, _: (
            f'la.load_cases(problem, loads, "{question.backend}"{question.width})'
        ),
        table=lambda found: found.table,
        cases=(1, inf),
        takes="one case or more",
    ),
    "envelope": Analysis(
        title="Combinations of load cases",
        doing="searching load combinations",
        ask=_combined,
        good=lambda found: bool(found.table["status"].isin(["solved", "reached"]).all()),
        said=lambda found, units: texts(found.findings, Reader(units, files=True)),
        caption=lambda found: (
            "Factors of the load cases that are carried, and that are not carried"
        ),
        document=_hulls,
        script=lambda question, _: (
            f'la.envelope(problem, loads, backend="{question.backend}"{question.width})'
        ),
        table=lambda found: found.table,
        cases=(2, 3),
        takes="two or three cases",
    ),
    **VARYING,
    **AFTER,
}
"""Analyses by the key in ``[solve]``, which is that of the option."""


def check(name: str, stated: Stated, varied: Varied | None) -> None:
    """Raise `InputError`, with its line, if a file lacks what an analysis needs."""
    least, most = ANALYSES[name].cases
    if not least <= len(stated.cases) <= most:
        why = f"{name} needs {ANALYSES[name].takes}, and the file has {len(stated.cases)}"
        fix = 'assign each reference load to a case: case = "wind"'
        raise stated.source.error(("reference_loads",), list(stated.cases), why, fix)
    if ANALYSES[name].varies and varied is None:
        why = "needs a number that varies"
        fix = "add --vary, or vary in [solve], such as 'arch.thickness=5 cm:20 cm'"
        if getattr(stated.asked, name) not in (None, False):
            raise stated.source.error(("solve", name), None, why, fix)
        raise InputError(f"--{name}", None, why, fix)
    if ANALYSES[name].dead:
        with stated.locating():
            require_dead_loads(stated.problem)


def calls(question: Question, problem: la.Problem, names: Sequence[str]) -> Iterator[str]:
    """Return the calls of a script; those of varied numbers use ``problem_at`` and ``within``."""
    if any(ANALYSES[name].cases[0] for name in names):
        yield "loads = {"
        for case, own in question.cases.items():
            listed = ", ".join(f"problem.reference_loads[{place}]" for place in own)
            yield f'    "{case}": [{listed}],'
        yield "}"
    for name in names:
        call = ANALYSES[name].script
        if call is not None:
            yield f"print({call(question, problem)})"
