"""Tables of runs: results, times, reasons, certificates, commands; and the columns they share."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from math import isfinite, nan
from typing import Any

import pandas as pd

import lacore as la
from lacore_verification.case import RANGE, Case, Variant
from lacore_verification.harness.analysis.effort import couplings
from lacore_verification.report.blocks import Block, Table, Text
from lacore_verification.report.columns import Anchor, Column
from lacore_verification.runs.commands import INSTANCES
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.row import Row

VERDICTS: Mapping[str, str] = {"pass": "good", "FAIL": "bad"}
"""Colours of verdicts; all others are mild."""
RUN = Anchor("run", "run")
"""Row of a run."""
CERTIFICATE = Anchor("certificate", "certificate")
"""Certificate of a run."""
_RESIDUAL = "residual_"
WHO = (Column("variant"), Column("backend"))
"""First columns; few, so that a telephone shows the load factor next to them."""
HOW = (Column("mesh", order="n_elements"), Column("coupling"))
_NAMES = (*WHO, *HOW)


def reasons_table(results: pd.DataFrame) -> Table:
    """Return the reason for each verdict, and the log of each run that printed something."""
    columns = (Column("verdict", moods=VERDICTS), *_NAMES, Column("why", "reason", long=True))
    logged = "log" in results and results["log"].fillna("").ne("").any()
    return Table((*columns, Column("log", file=True)) if logged else columns, results)


def commands(results: pd.DataFrame) -> list[Block]:
    """Return the commands that repeat each run, and those that export its optimisation program."""
    repeated = results[results["repeat_command"].fillna("") != ""]
    exported = results[results["export_command"].fillna("") != ""]
    repeats = (Column("repeat_command", "run", link=RUN), *_program(results))
    exports = (
        Column("export_command", "program"),
        Column("instance_file", "file in reports/instances"),
        *_program(results),
    )
    note = (
        "Exported programs have associated friction and flow; index.csv, in the same folder, states"
        " their optimal values. Cases of your own also need --cases FOLDER."
    )
    blocks: list[Block] = []
    if len(repeated):
        blocks.append(Table(repeats, repeated, sortable=False))
    if len(exported):
        programs = exported.drop_duplicates("instance_file")
        blocks += [Table(exports, programs, sortable=False), Text(note, soft=True)]
    return blocks


def with_programs(results: pd.DataFrame, files: Collection[str]) -> pd.DataFrame:
    """Add a column ``program``: the file of the program next to the report; empty without one.

    Args:
        results: With a column ``instance_file``.
        files: Names of the programs that exist.
    """
    names = results["instance_file"]
    return results.assign(program=(f"{INSTANCES}/" + names).where(names.isin(files), ""))


def _program(results: pd.DataFrame) -> tuple[Column, ...]:
    """Return the column that links programs, if any is there."""
    linked = "program" in results and results["program"].ne("").any()
    return (Column("program", "file of the program", file=True),) if linked else ()


def certificates_table(results: pd.DataFrame) -> Table:
    """Return the residuals of runs that have any; load factors link back to their runs."""
    proven = with_certificates(results)
    proven = proven[proven[CERTIFICATE.column].notna()]
    columns = (
        *WHO,
        Column("load_factor", "load factor", ".7f", link=RUN),
        *HOW,
        *varied(results),
        *(
            Column(name, name.removeprefix(_RESIDUAL).replace("_", " "), ".1e")
            for name in _residuals(results)
        ),
        *_program(results),
    )
    return Table(columns, proven, anchor=CERTIFICATE)


def varied(results: pd.DataFrame) -> list[Column]:
    """Return columns of what was set in addition to the case: mesh sizes, settings, options."""
    found = []
    for name in map(str, results.columns):
        kind, _, rest = name.partition("_")
        if kind in ("size", "setting", "option") and results[name].notna().any():
            form = "g" if pd.api.types.is_numeric_dtype(results[name]) else ""
            found.append(Column(name, rest.replace("_", " "), form))
    return found


def _residuals(results: pd.DataFrame) -> list[str]:
    return [str(name) for name in results.columns if str(name).startswith(_RESIDUAL)]


def with_certificates(results: pd.DataFrame) -> pd.DataFrame:
    """Add a column ``certificate``: the run if it has residuals, otherwise nothing."""
    has = results[_residuals(results)].notna().any(axis=1)
    return results.assign(certificate=results["run"].where(has))


def results_table(results: pd.DataFrame) -> Table:
    """Return all runs; load factors link to their certificates."""
    solved = results["status"] == la.Status.SOLVED.label
    outcome = results["rigor"].where(solved, results["status"])
    columns = (
        Column("verdict", moods=VERDICTS, hover="why"),
        *WHO,
        Column("load_factor", "load factor", ".7f", link=CERTIFICATE),
        Column("error", "error %", "+.4f", scale=100),
        Column("expected", "reference", "g", order="reference"),
        *HOW,
        *_answers(results),
        *_models(results),
        Column("n_elements", "elements", ".0f"),
        *varied(results),
        Column("energy", "energy C", ".2g"),
        Column("outcome", "rigour, status"),
        *_standing(results),
        Column("outer_iterations", "inner solves", ".0f"),
        Column("solve_time", "solve time, s", ".2f"),
    )
    return Table(columns, with_certificates(results).assign(outcome=outcome), anchor=RUN)


def times_table(results: pd.DataFrame) -> Table:
    """Return the times to build and to solve, next to those that solvers report."""
    build = Column("build_time", "build time, s", ".2f")
    solve = Column("solve_time", "solve time, s", ".3g")
    return Table((*WHO, *HOW, build, solve, *_solver_times(results)), results)


def _solver_times(results: pd.DataFrame) -> tuple[Column, ...]:
    """Return the columns of times of the backend alone; older results have none."""
    columns = (
        Column("solver_time", "in the solver, s", ".3g"),
        Column("reported_time", "as the solver reports, s", ".3g"),
        Column("compile_time", "compilation, s", ".2g"),
    )
    return tuple(own for own in columns if own.name in results and results[own.name].notna().any())


def _answers(results: pd.DataFrame) -> tuple[Column, ...]:
    """Return the column of who answered, where results state it."""
    stated = "answered_by" in results and results["answered_by"].fillna("").ne("").any()
    return (Column("answered_by", "answered by"),) if stated else ()


def _models(results: pd.DataFrame) -> tuple[Column, ...]:
    """Return the column of models other than that of the case, where there are any."""
    named = "model" in results and results["model"].fillna("").ne("").any()
    return (Column("model", "model compared"),) if named else ()


def _standing(results: pd.DataFrame) -> tuple[Column, ...]:
    """Return the columns of stability under dead loads, if it was requested."""
    if "standing" not in results or not results["standing"].fillna("").ne("").any():
        return ()
    return Column("standing", "dead loads"), Column("side", "loads carried")


def couplings_table(results: pd.DataFrame) -> Table:
    """Return how often the couplings of each backend succeed."""
    columns = (
        Column("coupling"),
        Column("backend"),
        Column("solved", "certified", ".0f"),
        Column("cases", "cases", ".0f"),
        Column("median", "inner solves, median", "g"),
        Column("most", "inner solves, maximum", "g"),
        Column("failed", "FAIL", ".0f"),
    )
    return Table(columns, couplings(results))


def ranges_table(results: pd.DataFrame) -> Table:
    """Return the lowest and the highest certified load factors, and the bound of all of them."""
    columns = (
        Column("verdict", moods=VERDICTS, hover="why"),
        Column("variant"),
        Column("backend"),
        Column("lowest", "lowest found", ".6f", link=CERTIFICATE),
        Column("highest", "highest found", ".6f"),
        Column("upper", "proven upper bound", ".6f"),
        Column("gap", "largest gap", ".1e"),
        HOW[0],
        Column("n_elements", "elements", ".0f"),
        Column("outer_iterations", "inner solves", ".0f"),
        Column("solve_time", "solve time, s", ".2f"),
    )
    caption = "Found by searches from several starting points; lower or higher ones may exist"
    return Table(columns, with_certificates(results), anchor=RUN, caption=caption)


def beside_table(case: Case, outcomes: Sequence[Outcome]) -> list[Block]:
    """Compare other values of each variant with those certified on one mesh; empty without any.

    Coarse meshes overestimate all load factors, so that shares of the associated one are compared.
    """
    ranges = {o.run.variant.name: o.row for o in outcomes if o.row.coupling == RANGE}
    ran = {outcome.run.variant.name for outcome in outcomes}
    rows = [
        {"variant": variant.name, **row}
        for variant in case.variants
        if variant.name in ran
        for row in (*_of_mesh(ranges.get(variant.name)), *_of_others(case, variant))
    ]
    if not rows:
        return []
    columns = (
        Column("variant"),
        Column("what", "result or source"),
        Column("value", "load factor", ".5g"),
        Column("share", "share of associated, %", ".1f", scale=100),
        Column("source", long=True),
    )
    return [
        Table(
            columns,
            pd.DataFrame(rows),
            caption="Comparison with other methods and published values",
            sortable=False,
        )
    ]


def _of_mesh(row: Row | None) -> Iterator[dict[str, Any]]:
    """Yield the results of a range, on its mesh."""
    if row is None or not (isfinite(row.lowest) and isfinite(row.highest)):
        return
    found = (
        ("lowest state found", row.lowest, "certified"),
        ("highest state found", row.highest, "certified"),
        (
            "associated flow on the same mesh",
            row.upper,
            "upper bound of all states on this mesh (T54)",
        ),
        ("Davis's reduced strength on the same mesh", row.davis, "not a bound (T55)"),
    )
    for what, value, worth in found:
        if isfinite(value):
            source = f"{worth}; {row.mesh} mesh, {row.n_elements:g} elements"
            yield {"what": what, "value": value, "share": value / row.upper, "source": source}


def _of_others(case: Case, variant: Variant) -> Iterator[dict[str, Any]]:
    whole = case.reference_of(variant).associated
    for one in case.beside_of(variant):
        share = nan if whole is None else one.value / whole
        yield {"what": one.name, "value": one.value, "share": share, "source": one.source}
