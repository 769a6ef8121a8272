"""Write tables of the benchmarks from their records, for ``make bench`` and ``make bench-page``.

docs/benchmarks.md shows the records of docs/benchmarks.json, with a picture of the width of
brackets against time. The page of the site shows charts before the same tables.
"""

import argparse
import re
import sys
from collections.abc import Iterator, Sequence
from math import floor, log10
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, StrMethodFormatter
from scipy.stats import linregress

from held import held
from kept import ROOT, found, keep
from sections import SECTIONS, SOLVES, Columns, Section

MARKS = r"(<!-- benchmarks -->\n).*?(<!-- end -->)"
PAGE = ROOT / "docs" / "benchmarks.md"
WIDTHS = ROOT / "docs" / "widths.svg"
_PROBLEMS = {
    "cut": "vertical cut",
    "punch": "punch",
    "punch, fan": "punch, fan at its edge",
    "notched-strip": "notched strip",
}


def records(kept: dict[str, Any]) -> pd.DataFrame:
    """Return one row per benchmark, sorted by kind, name and size."""
    frame = pd.DataFrame(kept["records"])
    needed = ["options", "triangles", "runs", "bar", "aim"]
    frame = frame.reindex(columns=frame.columns.union(needed, sort=False))
    r = [options.get("r") if isinstance(options, dict) else None for options in frame["options"]]
    frame["label"] = [
        what if value is None else f"{what}, r = {value:g}"
        for what, value in zip(frame["what"], r, strict=True)
    ]
    frame["problem"] = [what.rpartition(", ")[0] for what in frame["what"]]
    return frame.sort_values(["kind", "label", "triangles"], kind="stable", ignore_index=True)


def rows_of(frame: pd.DataFrame, section: Section) -> pd.DataFrame:
    """Return the rows of a section."""
    if section.kinds == ("held",):
        return pd.DataFrame(held(frame, growth(frame, ("true gap",))))
    rows = pd.concat([frame[frame["kind"] == kind] for kind in section.kinds])
    each = [run for own in rows.to_dict("records") for run in _runs(own)]
    rows = pd.DataFrame(each) if each else rows
    for name in reversed(section.order if len(rows) else ()):
        rows = rows.sort_values(name.lstrip("-"), ascending=name[0] != "-", kind="stable")
    return rows


def _runs(record: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the runs of a record; of random programs, counts per backend."""
    runs = record["runs"] if isinstance(record["runs"], list) else []
    if record["kind"] == "programs":
        runs = _counted(runs)
    return [{"what": record["what"]} | run for run in runs]


def _counted(runs: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Count the results of each backend on all programs."""
    counted = []
    for backend, own in pd.DataFrame(runs).groupby("backend", sort=False):
        large = own[(own["unknowns"] >= 1500) & (own["verdict"] != "refused")]
        verdicts = own["verdict"].value_counts()
        words = {"right": "right", "wrong": "wrong", "nothing": "no answer", "refused": "refused"}
        counted.append(
            {
                "backend": backend,
                "programs": len(own),
                **{name: int(verdicts.get(word, 0)) for name, word in words.items()},
                "large": len(large),
                "large_right": int((large["verdict"] == "right").sum()),
                "seconds": own["seconds"].sum(),
            }
        )
    return counted


def widths(frame: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Return seconds and widths of problems with several brackets, the widest first."""
    rows = frame[frame["kind"] == "bracket"]
    return {
        told: own.sort_values("width", ascending=False)[["seconds", "width"]]
        for name, told in _PROBLEMS.items()
        if len(own := rows[rows["problem"] == name]) > 1
    }


def drawn(frame: pd.DataFrame) -> Figure:
    """Draw the width of brackets against time."""
    figure = Figure(figsize=(6.4, 4.0), layout="constrained")
    axes = figure.add_subplot()
    for marker, (name, rows) in zip("osD^", widths(frame).items(), strict=False):
        axes.loglog(rows["seconds"], 100 * rows["width"], f"{marker}-", label=name)
    axes.set(xlabel="processor time, s", ylabel="width of the bracket relative to its mean, %")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axis.set_minor_locator(LogLocator(subs=()))
    axes.grid(alpha=0.3)
    axes.legend()
    return figure


def markdown(frame: pd.DataFrame, columns: Columns) -> str:
    """Return a table in Markdown, without empty columns."""
    there = {
        name: own
        for name, own in columns.items()
        if own[0] in frame and not all(_empty(cell) for cell in frame[own[0]])
    }
    lines = [_line(there), "|---" + "|--:" * (len(there) - 1) + "|"]
    for row in frame.to_dict("records"):
        cells = ((row.get(name), pattern) for name, pattern in there.values())
        lines.append(_line("" if _empty(cell) else _text(cell, form) for cell, form in cells))
    return "\n".join(lines)


def growth(frame: pd.DataFrame, kinds: Sequence[str]) -> pd.DataFrame:
    """Exponents p of ``seconds ~ triangles^p`` and their standard errors, by log-log regression."""
    rows = []
    for label, runs in frame[frame["kind"].isin(kinds)].groupby("label"):
        if runs["triangles"].nunique() > 2:
            fit = linregress(np.log(runs["triangles"]), np.log(runs["seconds"]))
            ends = (int(runs["triangles"].min()), int(runs["triangles"].max()))
            rows.append((label, fit.slope, fit.stderr, *ends))
    return pd.DataFrame(rows, columns=["label", "exponent", "error", "from", "to"])


def shown(kept: dict[str, Any]) -> str:
    """Return the generated part of the page."""
    frame, parts = records(kept), []
    for section in SECTIONS:
        rows = rows_of(frame, section)
        if not len(rows):
            continue
        parts += [f"## {section.heading}"] if section.heading else []
        parts += [section.text, markdown(rows, section.columns), *_after(section, frame)]
    rest = [*_rest(frame)]
    parts += ["## Other times", *rest] if rest else []
    parts += ["## Machine and versions", _machine(kept["measured"], frame)]
    return "\n\n".join(parts) + "\n"


def _after(section: Section, frame: pd.DataFrame) -> Iterator[str]:
    """Yield what follows a table."""
    if section.kinds == ("bracket",):
        if widths(frame):
            told = "Width of proven brackets against their processor time"
            yield f"![{told}](widths.svg)"
        for order in frame[frame["kind"] == "bracket order"].to_dict("records"):
            yield (
                f"The width of the bracket of the {order['what']} is proportional to the number of"
                f" triangles to the power of {order['even']:.2f} on uniform meshes and"
                f" {order['adaptive']:.2f} on adaptive ones."
            )
    fits = growth(frame, section.kinds)
    if len(fits) and section.kinds in (("true gap",), SOLVES):
        exponents = ", ".join(
            f"{row.exponent:.2f} ± {row.error:.2f} ({row.label})" for row in fits.itertuples()
        )
        yield (
            f"Time grows with the number of triangles to the power of {exponents}. These exponents"
            f" and their standard errors are from log-log fits from {fits['from'].min()} to"
            f" {fits['to'].max()} triangles."
        )


def _rest(frame: pd.DataFrame) -> Iterator[str]:
    """Yield the overhead of loops and sweeps, and the times to start a process."""
    loops = frame[frame["kind"] == "loop"]
    if len(loops):
        yield (
            f"In a reaction loop on {loops['triangles'].min():.0f} triangles, the work of lacore"
            f" between the calls of clarabel takes at most {100 * loops['own_share'].max():.1f} %"
            " of the time."
        )
    for sweep in frame[frame["kind"] == "sweep"].to_dict("records"):
        yield (
            f"A sweep of {sweep['runs']:.0f} runs of {1000 * sweep['seconds_a_run']:.0f} ms"
            f" ({sweep['what']}), one at a time, takes {sweep['seconds']:.1f} s. Everything except"
            " building and solving, including the start of the process, takes"
            f" {sweep['own_share']:.1%} of this time."
        )
    starts = [
        f"{start['what']} {start['seconds']:.2f} s, {start['bare_starts']:.2g} times that of Python"
        for start in frame[frame["kind"] == "start"].to_dict("records")
    ]
    if starts:
        told = "Processor time in a new process, and relative to starting Python"
        yield f"{told}: {'; '.join(starts)}."


def _machine(measured: dict[str, Any], frame: pd.DataFrame) -> str:
    """Return the machine, versions and date of the measurements."""
    analysis, unit = "", frame[frame["what"] == "elastic solve, PARDISO"]  # SuperLU keeps none
    if len(unit):
        largest = unit.sort_values("triangles").iloc[-1]
        share = 1 - largest["again_seconds"] / largest["seconds"]
        analysis = (
            f" (analysis takes {share:.0%} of the time on {largest['triangles']:.0f} triangles)"
        )
    return (
        f"Elastic solves: {measured['direct_solver']}{analysis}; {measured['machine']}, one"
        f" thread per solve; Python {measured['python']}, {measured['packages']};"
        f" {measured['date']}."
    )


def main() -> None:
    """Print the tables, or store the records and write the page and its picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("records", type=Path, help="file that make bench has written")
    parser.add_argument("--page", action="store_true", help="write docs/benchmarks.md and .json")
    given = parser.parse_args()
    kept = found(given.records.read_text(encoding="utf-8"))
    sys.stdout.write(shown(kept))
    if given.page:
        kept = keep(kept)
        text = re.sub(
            MARKS,
            lambda marks: f"{marks[1]}{shown(kept)}{marks[2]}",
            PAGE.read_text(encoding="utf-8"),
            flags=re.DOTALL,
        )
        PAGE.write_text(text, encoding="utf-8")
        with mpl.rc_context({"svg.hashsalt": "widths", "svg.fonttype": "none"}):
            drawn(records(kept)).savefig(WIDTHS, metadata={"Date": None})


def _line(cells: Any) -> str:
    return "| " + " | ".join(cells) + " |"


def _empty(cell: Any) -> bool:
    return cell in (None, "") or (isinstance(cell, float) and np.isnan(cell))


def _text(value: Any, pattern: str) -> str:
    """Format a value; without a pattern with two digits, or all digits before the point."""
    if pattern:
        return pattern.format(value)
    return f"{value:.{max(1 - floor(log10(value)), 0)}f}" if value else "0"


if __name__ == "__main__":
    main()
