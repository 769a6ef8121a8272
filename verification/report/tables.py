"""Columns that the tables of runs share, and the tables that all runs have."""

from collections.abc import Collection, Mapping

import pandas as pd

from verification.report.blocks import Block, Table, Text
from verification.report.columns import Anchor, Column
from verification.runs.commands import INSTANCES

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
