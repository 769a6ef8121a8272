"""The result of `lacore solve` of a file with a path: on the terminal, as a report, as JSON."""

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import lacore as la
from lacore.files.problem.reading import Stated
from lacore.files.problem.script import path_script, script
from lacore.reporting import views
from lacore.reporting.findings import records
from lacore.reporting.showing import counted
from lacore.reporting.text import Reader, render
from lacore.reporting.units import Units
from lacore_verification.harness.store.provenance import describe
from lacore_verification.report.blocks import (
    Block,
    Details,
    Facts,
    Gallery,
    Page,
    PageLink,
    PageLinks,
    Picture,
    Preformatted,
    Report,
    Section,
)
from lacore_verification.report.charts.figures import png
from lacore_verification.report.files import INDEX, write
from lacore_verification.report.problems.answers import Status
from lacore_verification.report.problems.following import ANIMATION, HISTORY, SHAPES, Followed
from lacore_verification.report.problems.page import described, table_of
from lacore_verification.report.problems.writing import SCRIPT, write_text

_DPI = 110
_LINES = 10  # lines of a history on the terminal
_SHOWN = ("travel", "load_factor", "force", "max_strain", "overlap")


def lines(stated: Stated, found: Followed) -> dict[str, str]:
    """Return the lines that describe a path, by name."""
    path, units, rows = found.path, stated.units, found.path.history
    reader = Reader(units, files=True)
    told = {"path": f"{_reached(path, units)}, {path.report.text_for(reader)}"}
    if len(rows):
        loads, gap, overlap = (rows[own].to_numpy() for own in ("load_factor", "gap", "overlap"))
        name, size, label = "load factor", 1.0, ""
        if not stated.problem.reference_loads:  # Tools drive the path, so it is their force.
            name, size, label = "force", units.size(_force(path)), f" {units.label(_force(path))}"
        told[name] = (
            f"from {loads[0] / size:.6g} in the first step to {loads[-1] / size:.6g}{label} in the"
            f" last; {certified(path)}, not a bound"
        )
        deepest = units.told(float(overlap.max()), "m", digits=2)  # NaN if one of them is NaN
        told["residual"] = f"gap {gap.max():.1e}, overlap of bodies {deepest}"
        if forces := _forces(path, units):
            told["force on tools"] = forces
    kinds = path.events["kind"].value_counts()
    told["events"] = ", ".join(f"{count} {kind}" for kind, count in kinds.items()) or "none"
    solves = counted(int(rows["solves"].sum()), "solve")
    told["solver"] = f"{found.backend}, {solves}, {found.seconds:.3g} s in total"
    return told


def certified(path: la.Path) -> str:
    """Say in how many steps the gap of the certificate is within the tolerance; NaN is not."""
    gap = path.history["gap"].to_numpy()
    tolerance = float("nan") if path.last is None else path.last.tolerance
    count = int(np.sum(gap <= tolerance))
    return f"certified in {'each step' if count == gap.size else f'{count} of {gap.size} steps'}"


def _forces(path: la.Path, units: Units) -> str:
    """Return the contact forces on all tools in the last step; empty without tools."""
    table, size = path.tool_forces(), units.size("N/m")
    told = [
        f"{name} ({x / size:.4g}, {y / size:.4g}) {units.label('N/m')}"
        for name, x, y in zip(table["body"], table["f_x"], table["f_y"], strict=True)
    ]
    return ", ".join(told)


def _reached(path: la.Path, units: Units) -> str:
    travel = path.snapshots[-1].travel
    far = units.told(travel, "m") if path.unit == "m" else f"{travel:.4g} {path.unit}"
    return f"{counted(len(path.history), 'step')} to a travel of {far}"


def history_in(stated: Stated, path: la.Path) -> tuple[pd.DataFrame, dict[str, str]]:
    """Return the main columns of a history in the units of the file, and their headings."""
    units = stated.units
    kinds = {"travel": "m", "force": _force(path)} if path.unit == "m" else {}
    table, heads = path.history[["step", *_SHOWN]].copy(), {"step": "step"}
    for name in _SHOWN:
        unit = {"overlap": "m", **kinds}.get(name, path.unit if name == "travel" else "")
        table[name] = table[name] / units.size(unit)
        head = name.replace("_", " ").replace("max ", "largest ")
        heads[name] = f"{head} [{units.label(unit)}]" if unit else head
    if path.unit != "m":  # A force needs a length along which it acts.
        del table["force"], heads["force"]
    # Tools drive the path, so the load factor is their force.
    if not stated.problem.reference_loads:
        del table["load_factor"], heads["load_factor"]
    return table, heads


def _force(path: la.Path) -> str:
    """Return the unit of the force of a control."""
    return "N" if any(body.axisymmetric for body in path.stage.bodies.values()) else "N/m"


def history_text(stated: Stated, path: la.Path) -> str:
    """Return the history as a short table of text; of a long one, evenly distributed rows."""
    table, heads = history_in(stated, path)
    if table.empty:
        return ""
    table = table.drop(columns="overlap")
    places = np.unique(np.linspace(0, len(table) - 1, _LINES).round().astype(int))
    cells = table.iloc[places].map(lambda own: f"{own:.5g}").rename(columns=heads)
    widths = [max(map(len, (head, *cells[head]))) for head in cells]
    rows = [list(cells.columns), *cells.to_numpy().tolist()]
    said = ["  ".join(f"{own:>{wide}}" for own, wide in zip(row, widths, strict=True))
            for row in rows]  # fmt: skip
    return "\n" + "\n".join(f"  {line}" for line in said)


def written(stated: Stated, found: Followed, folder: Path, doing: Status) -> Path:
    """Write the report of a path and its script; returns the path of the page."""
    files = {
        SCRIPT: "the same path as a Python script",
        HISTORY: "the history of the path, in SI units",
        f"{SHAPES}/path.pvd": "the shapes with strains and stresses for ParaView, in SI units",
    }
    if (folder / ANIMATION).is_file():
        files[ANIMATION] = "an animation of the path"
    write_text(folder / SCRIPT, as_python(stated, found, folder))
    with doing("writing the report"):
        return write(_report(stated, found, files), folder)


def _report(stated: Stated, found: Followed, files: dict[str, str]) -> Report:
    told = lines(stated, found)
    text = stated.source.file.read_text(encoding="utf-8-sig")
    sections = [
        Section("path", "The path", [*_pictures(found.path)], told["path"]),
        Section("history", "History", [*_tables(stated, found.path)]),
        Section("problem", "The problem", [*described(stated.problem, stated.units)]),
        Section("file", "The problem file", [Preformatted(text)]),
        Section(
            "files",
            "Files",
            [PageLinks([PageLink(file, file, why) for file, why in files.items()])],
        ),
        Section("machine", "Machine and versions", [Facts(describe([found.backend]))]),
    ]
    kept = [section for section in sections if section.blocks]
    lead = f"{told['path'][:1].upper()}{told['path'][1:]}."
    return Report({INDEX: Page(stated.title, lead, kept, [Facts(told)])})


def _pictures(path: la.Path) -> Iterator[Block]:
    """Yield the pictures, in SI units as the files for ParaView."""
    drawn = [Picture("path", "Shape at the end, and load factor", png(views.picture(path), _DPI))]
    if len(path.history):
        drawn.append(Picture("force", "Force over the travel", png(path.plot_force(), _DPI)))
    yield Gallery(drawn)


def _tables(stated: Stated, path: la.Path) -> Iterator[Block]:
    if path.history.empty:
        return
    table, heads = history_in(stated, path)
    yield table_of(table, "Steps", heads)
    if len(path.events):
        count = f"Events: {len(path.events)}"
        reader = Reader(stated.units, files=True)
        own = path.events.assign(what=path.events["what"].map(lambda what: render(what, reader)))
        yield Details(count, [table_of(own, "Events", {"travel": f"travel [{path.unit}]"})])
    forces = path.tool_forces()
    if len(forces):
        size, label = stated.units.size("N/m"), stated.units.label("N/m")
        own = forces.assign(f_x=forces["f_x"] / size, f_y=forces["f_y"] / size)
        heads = {"f_x": f"f x [{label}]", "f_y": f"f y [{label}]", "moment": "moment [N]"}
        yield table_of(own, "Forces of contact on tools in the last step", heads)


def as_python(stated: Stated, found: Followed, folder: Path) -> str:
    """Return the problem and its path, as a script in a folder."""
    more = {"backend": found.backend}
    more |= {"coupling": stated.asked.coupling} if stated.asked.coupling else {}
    problem = script(stated.program, folder)
    paths = "from pathlib import Path\n\n" if "Path(__file__)" in problem else ""
    title = " ".join(stated.title.replace("\\", "/").replace('"', "'").split())
    head = f'"""{title}: from {stated.source.file.name}."""\n\n'
    end = 'print(path)\nprint(path.history[["travel", "load_factor", "force", "max_strain"]])\n'
    path = path_script(stated.program, folder, more)
    return f"{head}{paths}import lacore as la\n\n{problem}{path}{end}"


def document(stated: Stated, found: Followed, page: Path | None) -> dict[str, Any]:
    """Return all numbers of a path, and the places of its files, in the units of the file."""
    path, units = found.path, stated.units
    table, _ = history_in(stated, path)
    last = path.last
    certificate = None if last is None else last.certificate
    return {
        "title": stated.title,
        "file": str(stated.source.file),
        "status": path.status.label,
        "message": path.report.text_for(Reader(units, files=True)),
        "findings": records(path.findings, Reader(units, files=True)),
        "history": table.to_dict("records"),
        "events": path.events.to_dict("records"),
        "certificate": None if certificate is None else asdict(certificate),
        "tolerance": None if last is None else last.tolerance,
        "backend": found.backend,
        "seconds": found.seconds,
        "page": None if page is None else str(page),
        "units": {"force": units.force, "length": units.length, "stress": units.stress},
    }
