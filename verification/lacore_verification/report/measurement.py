"""How a comparison was measured: settings of the backends, and noise of the machine."""

from collections.abc import Iterable
from math import isfinite

import pandas as pd

from lacore_verification.harness.analysis.noise import LEAST, Noise, noise, rankings
from lacore_verification.harness.analysis.settings import settings
from lacore_verification.harness.verdicts.limit_state import FINDS_NONE
from lacore_verification.harness.verdicts.words import SKIPPED
from lacore_verification.report.blocks import Block, Details, Section, Table, Text
from lacore_verification.report.columns import Column, columns
from lacore_verification.runs.run import Run


def settings_section(runs: Iterable[Run]) -> Section:
    """Return the options of all backends, changed ones first."""
    found = settings(runs).sort_values("changed", ascending=False, kind="stable")
    shown = found.assign(changed=found["changed"].map({True: "changed", False: "default"}))
    names = ("backend", "setting", "option", "value", "default")
    shown_columns = columns(*names, Column("changed", "source"))
    lead = (
        "The time limit of a run replaces a longer time_limit. Brackets choose tolerances"
        " themselves."
    )
    title = "Options of all backends"
    return Section("settings", "Settings", [Details(title, [Table(shown_columns, shown)])], lead)


def noise_section(results: pd.DataFrame) -> Section:
    """State the noise of the machine, and the rankings that it leaves undecided."""
    found = noise(results)
    ran = results[(results["verdict"] != SKIPPED) & ~results["coupling"].isin(FINDS_NONE)]
    timed = ran[ran["solve_time"] > 0]
    pairs = rankings(timed, found)
    blocks: list[Block] = []
    if isfinite(found.factor) and len(pairs):
        undecided = pairs[pairs["undecided"].astype(bool)]
        if len(undecided):
            blocks.append(_table(undecided, "Rankings that the noise leaves undecided"))
        count = f"It leaves {len(undecided)} of {len(pairs)} rankings undecided."
        blocks.insert(0, Text(f"{_statement(found)} {count}"))
        blocks.append(Details("All pairs of solvers", [_table(pairs)]))
    else:
        blocks.append(Text(_statement(found)))
    lead = (
        "Each process of a comparison repeats a short solve that is always the same. The scatter"
        " of its times is the noise of the machine."
    )
    return Section("noise", "Noise of the machine", blocks, lead)


def _statement(found: Noise) -> str:
    if not isfinite(found.factor):
        return (
            f"The noise is unknown: the solve was repeated {found.count} times, and {LEAST} are"
            " needed. No ranking by time is decided."
        )
    return (
        f"The short solve was repeated {found.count} times and took {found.median:.2g} s (median)"
        f" with a relative standard deviation of {100 * found.scatter:.2g} %. Two times whose ratio"
        f" is at most {found.factor:.3g} may differ by noise alone."
    )


def _table(pairs: pd.DataFrame, caption: str = "") -> Table:
    shown = pairs.assign(decided=pairs["undecided"].map({True: "no", False: "yes"}))
    own = columns(
        Column("one", "faster"),
        Column("other", "slower"),
        Column("problems", "problems solved by both", ".0f"),
        Column("ratio", "ratio of times, geometric mean", ".3g"),
        "decided",
    )
    return Table(own, shown, caption)
