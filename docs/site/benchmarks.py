"""Tables of the benchmarks from their JSON: ``make bench`` prints, ``make bench-page`` keeps.

What pytest-benchmark writes is long and about one machine. Kept in docs/benchmarks.json are its
records and what they were measured with, beside it its checksum; docs/benchmarks.md shows them, and
the page of the site their charts.
"""

import argparse
import hashlib
import json
import re
import sys
from math import floor, log10
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import linregress

ROOT = Path(__file__).parents[2]
KEPT = ROOT / "docs" / "benchmarks.json"
MARKS = r"(<!-- benchmarks -->\n).*?(<!-- end -->)"
PAGE = ROOT / "docs" / "benchmarks.md"
_PROBLEMS = {"cut": "vertical cut", "punch": "punch", "punch, fan": "punch, fan at its edge"}
_DIGITS = 8
_OTHER = (
    "loop",
    "wall",
    "path",
    "soil",
    "sweep",
    "bracket",
    "bracket order",
    "start",
    "programs",
)  # kinds that are told of apart
_WALLS = {  # of their table
    "benchmark": ("what", "{}"),
    "blocks": ("blocks", "{:.0f}"),
    "joints": ("joints", "{:.0f}"),
    "certified at": ("tolerance", "{:.0e}"),
    "inner solves": ("solves", "{:.0f}"),
    "seconds": ("seconds", ""),
    "associated solves": ("ratio", ""),
    "memory, MB": ("memory_mb", "{:.0f}"),
}
_PATHS = {  # of their table
    "benchmark": ("what", "{}"),
    "triangles": ("triangles", "{:.0f}"),
    "steps": ("steps", "{:.0f}"),
    "inner solves": ("solves", "{:.0f}"),
    "largest gap": ("gap", "{:.0e}"),
    "seconds": ("seconds", ""),
    "before, s": ("before", ""),
    "aim, s": ("aim", "{:g}"),
    "associated solves": ("ratio", "{:.0f}"),
}
_SOILS = {  # of their table
    "benchmark": ("what", "{}"),
    "triangles": ("triangles", "{:.0f}"),
    "unknowns": ("unknowns", "{:.0f}"),
    "seconds": ("seconds", ""),
    "iterations": ("iterations", "{:.0f}"),
    "of von Mises": ("beside", "{:.0f}"),
    "largest residual": ("largest", "{:.0e}"),
    "time per von Mises": ("ratio", ""),
}
_BRACKETS = {  # of their table
    "benchmark": ("what", "{}"),
    "lower": ("lower", "{:.5f}"),
    "upper": ("upper", "{:.5f}"),
    "width": ("width", "{:.2%}"),
    "triangles below": ("triangles_lower", "{:.0f}"),
    "above": ("triangles_upper", "{:.0f}"),
    "solves": ("solves", "{:.0f}"),
    "seconds": ("seconds", ""),
    "aim, s": ("aim", "{:g}"),
    "elastic solve, s": ("elastic_seconds", ""),
    "elastic solves": ("elastic_solves", "{:.0f}"),
}
_COLUMNS = {  # of the table: field of a record, and its format; none: two digits
    "backend": ("label", "{}"),
    "triangles": ("triangles", "{:.0f}"),
    "unknowns": ("unknowns", "{:.0f}"),
    "seconds": ("seconds", ""),
    "elastic solves": ("elastic_solves", ""),
    "iterations": ("iterations", "{:.0f}"),
    "memory, MB": ("memory_mb", "{:.0f}"),
}


def load() -> dict[str, Any]:
    """What is kept, whose checksum must be right.

    Raises:
        ValueError: it is not.
    """
    data = KEPT.read_bytes()
    if digest(data) != seal_of(KEPT).read_text(encoding="ascii").strip():
        raise ValueError(f"{KEPT.name} is not what was kept: its checksum is another one")
    kept: dict[str, Any] = json.loads(data)
    return kept


def seal_of(file: Path) -> Path:
    """Where the checksum of a file is."""
    return Path(f"{file}.sha256")


def digest(data: bytes) -> str:
    """SHA-256."""
    return hashlib.sha256(data).hexdigest()


def condensed(raw: dict[str, Any]) -> dict[str, Any]:
    """What is kept of a file of pytest-benchmark."""
    names = ("date", "machine", "python", "packages", "direct_solver", "backends")
    return {
        "measured": {name: raw["machine_info"][name] for name in names},
        "records": [
            {name: _rounded(value) for name, value in run["extra_info"].items()}
            for run in raw["benchmarks"]
        ],
    }


def joined(before: dict[str, Any], now: dict[str, Any]) -> dict[str, Any]:
    """Benchmarks that were not run again stay, if they were measured with the same."""
    then, measured = before["measured"], now["measured"]
    names = ("machine", "python", "direct_solver")
    old_ones, new_ones = _versions(then["packages"]), _versions(measured["packages"])
    if any(then[name] != measured[name] for name in names) or any(
        old_ones[name] != new_ones[name] for name in old_ones.keys() & new_ones.keys()
    ):
        return now
    anew = {_identity(record) for record in now["records"]}
    old = [record for record in before["records"] if _identity(record) not in anew]
    first = then["date"].partition(" to ")[0]
    date = f"{first} to {measured['date']}" if old else measured["date"]
    return {"measured": measured | {"date": date}, "records": [*old, *now["records"]]}


def _identity(record: dict[str, Any]) -> tuple[Any, ...]:
    return record["kind"], record["what"], record.get("triangles"), str(record.get("options") or "")


def _versions(packages: str) -> dict[str, str]:
    """By name, from ``name version, name version``."""
    return dict(package.rsplit(" ", 1) for package in packages.split(", "))


def records(kept: dict[str, Any]) -> pd.DataFrame:
    """One row a benchmark, sorted by kind, what was run and size."""
    frame = pd.DataFrame(kept["records"])
    frame = frame.reindex(columns=frame.columns.union(["options", "triangles"], sort=False))
    r = [options.get("r") if isinstance(options, dict) else None for options in frame["options"]]
    frame["label"] = [
        what if value is None else f"{what}, r = {value:g}"
        for what, value in zip(frame["what"], r, strict=True)
    ]
    return frame.sort_values(["kind", "label", "triangles"], kind="stable", ignore_index=True)


def table(frame: pd.DataFrame) -> str:
    """Markdown."""
    return _markdown(frame[~frame["kind"].isin(_OTHER)], _COLUMNS)


def walls(frame: pd.DataFrame) -> str:
    """Markdown of the certified loop on masonry walls."""
    return _markdown(frame[frame["kind"] == "wall"].sort_values("blocks"), _WALLS)


def paths(frame: pd.DataFrame) -> str:
    """Markdown of paths of large deformation."""
    return _markdown(frame[frame["kind"] == "path"], _PATHS)


def soils(frame: pd.DataFrame) -> str:
    """Markdown of soils beside von Mises."""
    return _markdown(frame[frame["kind"] == "soil"], _SOILS)


def brackets(frame: pd.DataFrame) -> str:
    """Markdown of brackets with proof."""
    return _markdown(frame[frame["kind"] == "bracket"], _BRACKETS)


def widths(frame: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Seconds and widths of brackets of problems that were asked for several, the widest first."""
    rows = frame[frame["kind"] == "bracket"]
    problem = np.array([what.rpartition(", ")[0] for what in rows["what"]], dtype=str)
    return {
        told: rows[problem == name].sort_values("width", ascending=False)[["seconds", "width"]]
        for name, told in _PROBLEMS.items()
        if (problem == name).sum() > 1
    }


def _markdown(frame: pd.DataFrame, columns: dict[str, tuple[str, str]]) -> str:
    lines = [_line(columns), "|---" + "|--:" * (len(columns) - 1) + "|"]
    for row in frame.to_dict("records"):
        cells = ((row.get(name), pattern) for name, pattern in columns.values())
        lines.append(_line("" if pd.isna(cell) else _text(cell, form) for cell, form in cells))
    return "\n".join(lines)


def growth(frame: pd.DataFrame) -> pd.DataFrame:
    """Exponents p of ``seconds ~ triangles^p`` and their standard errors, by log-log regression."""
    rows = []
    for label, runs in frame[~frame["kind"].isin(_OTHER)].groupby("label"):
        if runs["triangles"].nunique() > 2:
            fit = linregress(np.log(runs["triangles"]), np.log(runs["seconds"]))
            ends = (int(runs["triangles"].min()), int(runs["triangles"].max()))
            rows.append((label, fit.slope, fit.stderr, *ends))
    return pd.DataFrame(rows, columns=["label", "exponent", "error", "from", "to"])


def notes(kept: dict[str, Any], frame: pd.DataFrame) -> str:
    """Growth, the loop's own share, and what it was measured with."""
    paragraphs = []
    fits = growth(frame)
    if len(fits):
        exponents = ", ".join(
            f"{row.exponent:.2f} ± {row.error:.2f} ({row.label})" for row in fits.itertuples()
        )
        paragraphs.append(
            f"Time grows with the number of triangles to the power of {exponents}: log-log fits"
            f" from {fits['from'].min()} to {fits['to'].max()} triangles, with standard errors."
        )
    loops = frame[frame["kind"] == "loop"]
    if len(loops):
        paragraphs.append(
            f"Of a reaction loop on {loops['triangles'].min():.0f} triangles, lacore's own part"
            f" between the calls of clarabel takes at most {100 * loops['own_share'].max():.1f} %."
        )
    for sweep in frame[frame["kind"] == "sweep"].to_dict("records"):
        paragraphs.append(
            f"A sweep of {sweep['runs']:.0f} runs of {1000 * sweep['seconds_a_run']:.0f} ms"
            f" ({sweep['what']}), one at a time, takes {sweep['seconds']:.1f} s; all but building"
            f" and solving, the start of the process included, is {sweep['own_share']:.1%} of it."
        )
    if (frame["kind"] == "wall").any():
        paragraphs.append(
            "**The certified loop on masonry walls** with windows, mu = 0.65 in all joints, in"
            " units of one associated solve of the same wall; memory is the peak above that of"
            f" the assembled problem:\n\n{walls(frame)}"
        )
    if (frame["kind"] == "path").any():
        paragraphs.append(
            "**Paths of large deformation**, all steps with their certificates, beside the time"
            " before, of the loop that began each step at the associated state, what was aimed at,"
            " and in units of one associated solve of the first step:"
            f"\n\n{paths(frame)}"
        )
    if (frame["kind"] == "soil").any():
        paragraphs.append(
            "**Soil beside von Mises** on the same mesh, with the same loads, in turns, from the"
            f" problem to the certificate:\n\n{soils(frame)}"
        )
    if (frame["kind"] == "bracket").any():
        paragraphs.append(
            "**Brackets with proof**, from the start to the certificate, all solves and refinements"
            " included, beside what was aimed at and one elastic solve of the last mesh of the"
            " upper bound:"
            f"\n\n{brackets(frame)}"
        )
    for order in frame[frame["kind"] == "bracket order"].to_dict("records"):
        paragraphs.append(
            f"The width of the bracket of the {order['what']} goes with the number of triangles to"
            f" the power of {order['even']:.2f} on even meshes and {order['adaptive']:.2f} on"
            " adapted ones."
        )
    starts = [
        f"{start['what']} {start['seconds']:.2f} s, {start['bare_starts']:.2g} times a bare Python"
        for start in frame[frame["kind"] == "start"].to_dict("records")
    ]
    if starts:
        paragraphs.append(f"Processor time of a process of its own: {'; '.join(starts)}.")
    measured, analysis = kept["measured"], ""
    unit = frame[frame["what"] == "elastic solve, PARDISO"]  # SuperLU analyses every time
    if len(unit):
        largest = unit.sort_values("triangles").iloc[-1]
        share = 1 - largest["again_seconds"] / largest["seconds"]
        analysis = f", of which analysis takes {share:.0%} on {largest['triangles']:.0f} triangles"
    paragraphs.append(
        f"Elastic solves by {measured['direct_solver']}{analysis}; {measured['machine']}, one"
        f" thread; Python {measured['python']}, {measured['packages']}; {measured['date']}."
    )
    return "\n\n".join(paragraphs)


def shown(kept: dict[str, Any]) -> str:
    """What stands between the marks."""
    frame = records(kept)
    return f"{table(frame)}\n\n{notes(kept, frame)}\n"


def main() -> None:
    """Print all; or keep the records, and refresh the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("json", type=Path, help="written by pytest-benchmark")
    parser.add_argument("--page", action="store_true", help="refresh docs/benchmarks.md and .json")
    given = parser.parse_args()
    kept = condensed(json.loads(given.json.read_text(encoding="utf-8")))
    sys.stdout.write(shown(kept))
    if given.page:
        if KEPT.exists():
            kept = joined(load(), kept)
        lines = ",\n".join(json.dumps(record) for record in kept["records"])
        measured = json.dumps(kept["measured"], indent=1)
        text = f'{{"measured": {measured},\n"records": [\n{lines}\n]}}\n'
        KEPT.write_text(text, "utf-8")
        seal_of(KEPT).write_text(f"{digest(text.encode())}\n", "ascii")
        text = re.sub(
            MARKS,
            lambda marks: f"{marks[1]}{shown(kept)}{marks[2]}",
            PAGE.read_text(encoding="utf-8"),
            flags=re.DOTALL,
        )
        PAGE.write_text(text, encoding="utf-8")


def _line(cells: Any) -> str:
    return "| " + " | ".join(cells) + " |"


def _text(value: Any, pattern: str) -> str:
    """Without a pattern two digits, and all before the point."""
    return pattern.format(value) if pattern else f"{value:.{max(1 - floor(log10(value)), 0)}f}"


def _rounded(value: Any) -> Any:
    return float(f"{value:.{_DIGITS}g}") if isinstance(value, float) else value


if __name__ == "__main__":
    main()
