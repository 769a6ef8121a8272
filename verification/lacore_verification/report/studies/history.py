"""The page of stored results of several versions."""

from collections.abc import Sequence

import pandas as pd

from lacore_verification.harness.analysis.history import SHIFT, History
from lacore_verification.harness.store.versions import Version
from lacore_verification.report.blocks import (
    Block,
    Drawing,
    Filters,
    Gallery,
    Page,
    Report,
    Section,
    Table,
    Text,
)
from lacore_verification.report.charts.axes import Axis
from lacore_verification.report.charts.versions import by_version
from lacore_verification.report.columns import VERDICTS, Column, column, columns
from lacore_verification.report.files import INDEX

TITLE = "Results of several versions"
_MEAN_TIME = Axis("mean_time", "geometric mean of solve times [s]", log=False)
_CORRECT = Axis("correctness_rate", "correct runs", log=False)
_COMMON = (
    "For each backend, rates, times and errors refer to the runs that all versions with this"
    " backend have in common. Only what a backend answered itself counts as certified or correct."
    " A run that only other versions solved counts with the longest time of all."
)
_NO_CHANGE = "No verdict changed, and no load factor changed by more than the tolerance."


def history_report(versions: Sequence[Version], found: History) -> Report:
    """Return the report of several versions, which is a single page."""
    names = list(found.versions)
    lead = (
        f"{len(names)} versions, {found.backends['backend'].nunique()} backends,"
        f" {len(found.changes)} changed runs, {found.worse} of which passed and now fail."
    )
    sections = [
        Section("versions", "Versions", [versions_table(versions, found)]),
        Section("backends", "Backends by version", _backends(found, names), _COMMON),
        Section("changes", "Changed runs", [_changes(found)]),
        *_packages(versions),
    ]
    return Report({INDEX: Page(TITLE, lead, sections)})


def versions_table(versions: Sequence[Version], found: History) -> Table:
    """Return a table of where the results are from."""
    rows = [
        {
            "name": own.name,
            "lacore": own.lacore or "unknown",
            "date": own.date or "unknown",
            "runs": len(own.results),
            "only": found.only[own.name],
            "machine": own.provenance.get("machine", "unknown"),
            "code": own.provenance.get("code", "unknown"),
        }
        for own in versions
    ]
    shown = columns(
        Column("name", "results"),
        *("lacore", "date", "runs"),
        Column("only", "not in all versions", ".0f"),
        Column("machine", long=True),
        Column("code", long=True),
    )
    return Table(shown, pd.DataFrame(rows), "Where the results are from")


def _backends(found: History, names: Sequence[str]) -> list[Block]:
    solvers = sorted(map(str, dict.fromkeys(found.backends["backend"])))
    shown = columns(
        *("backend", Column("version", "results"), Column("all_runs", "all runs", ".0f")),
        column("runs", title="common runs"),
        *("success_rate", "certified_rate", "correctness_rate", "wrong_claims", "mean_time"),
        Column("ratio", "relative to the first", ".2f"),
        "worst_error",
    )
    caption = f"Rates, geometric mean of solve times shifted by {SHIFT:g} s, and largest error"
    charts = [
        Drawing(
            "times",
            "Solve time by version",
            by_version(found.backends, _MEAN_TIME, names, share=False),
        ),
        Drawing(
            "correct",
            "Correct runs by version",
            by_version(found.backends, _CORRECT, names, share=True),
        ),
    ]
    choice = [Filters([], [], "", solvers)] if len(solvers) > 1 else []
    return [*choice, Table(shown, found.backends, caption), Gallery(charts)]


def _changes(found: History) -> Block:
    if not len(found.changes):
        return Text(_NO_CHANGE)
    settings = found.changes["settings"].ne("").any()
    known = any(found.changes[name].ne("").any() for name in ("lacore_before", "lacore_after"))
    shown = columns(
        Column("verdict_after", "verdict", moods=VERDICTS),
        Column("verdict_before", "before"),
        *("case", "variant", "backend", "coupling", "mesh"),
        *([Column("settings", long=True)] if settings else []),
        Column("load_factor_before", "load factor before", ".7g"),
        Column("load_factor_after", "load factor", ".7g"),
        Column("change", "change %", "+.2g", scale=100),
        Column("before", "changed from"),
        Column("after", "to"),
        *(
            [Column("lacore_before", "lacore before"), Column("lacore_after", "lacore")]
            if known
            else []
        ),
    )
    return Table(shown, found.changes)


def _packages(versions: Sequence[Version]) -> list[Section]:
    """Return the packages whose version differs, one column for each of the results.

    A package may also differ between the sessions of the same results.
    """
    names = dict.fromkeys(name for own in versions for name in own.packages)
    rows = [
        {"package": name} | {own.name: own.packages.get(name, "unknown") for own in versions}
        for name in names
        if len({own.packages.get(name, "unknown") for own in versions}) > 1
        or any(", " in own.packages.get(name, "") for own in versions)
    ]
    if not rows:
        return []
    shown = [Column("package"), *(Column(own.name, own.name) for own in versions)]
    return [Section("packages", "Packages that changed", [Table(shown, pd.DataFrame(rows))])]
