"""Tables of runs: results, times, reasons, certificates, commands; and the columns they share."""

from collections.abc import Collection, Iterator, Sequence
from math import isfinite, nan
from typing import Any

import pandas as pd

import lacore as la
from lacore_verification.case import RANGE, Case, Variant
from lacore_verification.harness.analysis.effort import couplings
from lacore_verification.report.blocks import Block, Table, Text
from lacore_verification.report.columns import CERTIFICATE, RUN, Column, column, columns
from lacore_verification.runs.commands import INSTANCES
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.row import Row

_RESIDUAL = "residual_"
WHO = columns("variant", "backend")
"""First columns; few, so that a telephone shows the load factor next to them."""
HOW = columns(Column("mesh", order="n_elements"), "coupling")
_NAMES = (*WHO, *HOW)


def reasons_table(results: pd.DataFrame) -> Table:
    """Return the reason for each verdict, and the log of each run that printed something."""
    logged = "log" in results and results["log"].fillna("").ne("").any()
    log = [Column("log", file=True)] if logged else []
    return Table(columns("verdict", *_NAMES, "why", *log), results)


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
    shown = (
        *WHO,
        column("load_factor", link=RUN),
        *HOW,
        *varied(results),
        *(
            Column(name, name.removeprefix(_RESIDUAL).replace("_", " "), ".1e")
            for name in _residuals(results)
        ),
        *_program(results),
    )
    return Table(shown, proven, anchor=CERTIFICATE)


def varied(results: pd.DataFrame) -> list[Column]:
    """Return columns of settings in addition to the case: mesh sizes, loop, options."""
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
    shown = columns(
        column("verdict", hover="why"),
        *WHO,
        column("load_factor", link=CERTIFICATE),
        *("error", "expected"),
        *HOW,
        *_answers(results),
        *_models(results),
        "n_elements",
        *varied(results),
        Column("energy", "energy C", ".2g"),
        Column("outcome", "rigour, status"),
        *_standing(results),
        *("outer_iterations", "solve_time"),
    )
    return Table(shown, with_certificates(results).assign(outcome=outcome), anchor=RUN)


def times_table(results: pd.DataFrame) -> Table:
    """Return the times to build and to solve, next to those that solvers report."""
    times = columns("build_time", column("solve_time", form=".3g"))
    return Table((*WHO, *HOW, *times, *_solver_times(results)), results)


def _solver_times(results: pd.DataFrame) -> tuple[Column, ...]:
    """Return the columns of times of the backend alone; older results have none."""
    times = (
        Column("solver_time", "in the solver, s", ".3g"),
        Column("reported_time", "as the solver reports, s", ".3g"),
        Column("compile_time", "compilation, s", ".2g"),
    )
    return tuple(own for own in times if own.name in results and results[own.name].notna().any())


def _answers(results: pd.DataFrame) -> tuple[Column, ...]:
    """Return the column of the origin of results, if results contain it."""
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
    names = ("coupling", "backend", "solved", Column("cases", form=".0f"))
    return Table(columns(*names, "median", "most", "failed"), couplings(results))


def ranges_table(results: pd.DataFrame) -> Table:
    """Return the lowest and the highest certified load factors, and the bound of all of them."""
    shown = columns(
        column("verdict", hover="why"),
        *WHO,
        Column("lowest", "lowest found", ".6f", link=CERTIFICATE),
        Column("highest", "highest found", ".6f"),
        Column("upper", "proven upper bound", ".6f"),
        column("gap", title="largest gap"),
        HOW[0],
        *("n_elements", "outer_iterations", "solve_time"),
    )
    caption = "Found by searches from several starting points; lower or higher ones may exist"
    return Table(shown, with_certificates(results), anchor=RUN, caption=caption)


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
    shown = columns(
        "variant",
        Column("what", "result or source"),
        Column("value", "load factor", ".5g"),
        Column("share", "share of associated, %", ".1f", scale=100),
        Column("source", long=True),
    )
    return [
        Table(
            shown,
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
