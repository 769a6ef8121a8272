"""Files with the programs of the runs of a comparison next to its report, with their minima."""

from __future__ import annotations  # Annotations are not evaluated: their names are not loaded.

import csv
import hashlib
import shutil
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from math import inf, isnan
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import lacore as la
from lacore.coupling.kinds import ASSOCIATED
from lacore.reporting.errors import InputError
from lacore_verification.case import is_of_lacore
from lacore_verification.defaults import cores
from lacore_verification.harness.campaigns.instances import (
    INDEX,
    Instance,
    Known,
    known_of,
    table_of,
    write,
    writer_of,
)
from lacore_verification.harness.perform.pool import answers
from lacore_verification.harness.store.manifest import replace_files
from lacore_verification.harness.store.provenance import code_of
from lacore_verification.runs.commands import INSTANCES, commands_of
from lacore_verification.runs.outcome import Outcome

ENDING = "npz"
"""Format of the files."""
MOST_UNKNOWNS = 300_000
"""Unknowns of all programs that are written, smallest first: about 30 MB."""
_LIMIT = 120.0  # s, for each program.
_WORKER = f"{__name__}:ProgramWriter"
_STATES = {status.label: status.name for status in la.Status}
_CERTIFIED = "certified"  # Solves the associated problem if there is no friction.

Program = tuple[Instance, bytes]
"""A row of the index, and the content of its file."""


@dataclass(frozen=True)
class Source:
    """A run whose program is written, and the version of its code."""

    outcome: Outcome
    code: str


class ProgramWriter:
    """Writer of one program after the other, in a separate process."""

    def program(self, source: Source) -> list[Program]:
        """Return the program of a run with its minimum; empty if no file can express it.

        The minimum is the load factor of the run if its certificate proves that. Otherwise the
        associated problem is solved once.
        """
        run, problem = source.outcome.run, source.outcome.run.problem()
        stated, known = _proven(source, problem)
        if known is None:
            state = la.solve(problem, coupling=ASSOCIATED)
            stated, known = state.discretisation, known_of(state, source.code)
        with TemporaryDirectory() as name:
            rows = write(run, stated, known, {ENDING: writer_of(ENDING)}, Path(name))
            return [(row, (Path(name) / row.file).read_bytes()) for row in rows if row.file]


def write_programs(
    sources: Mapping[str, Outcome],
    folder: Path,
    on_done: Callable[[str], object] = lambda _: None,
) -> None:
    """Write the programs of a comparison and their index to the folder `INSTANCES` of its report.

    A program that the same code wrote earlier is kept. Files of an earlier comparison that belong
    to no run of this one are removed.

    Args:
        sources: Run by file, as from `sources_of`.
        folder: Of its report.
        on_done: Called with the run of each program that is written.

    Raises:
        InputError: The folder cannot be written.
    """
    place = folder / INSTANCES
    found = _kept(sources, place)
    due = [
        Source(outcome, code_of(outcome.run))
        for name, outcome in sources.items()
        if name not in found
    ]
    isolate = not all(is_of_lacore(source.outcome.run.case) for source in due)
    for source, answer in answers(_WORKER, "program", due, cores(), _LIMIT, isolate):
        # A case that was changed meanwhile may raise: its rows have the command only.
        if not isinstance(answer, Exception):
            found |= {row.file: (row, data) for row, data in answer}
        on_done(source.outcome.run.label)
    rows = [found[name] for name in sources if name in found]
    files = {row.file: data for row, data in rows}
    index = table_of([row for row, _ in rows]).to_csv(index=False)
    try:
        replace_files(place, files | {INDEX: index.encode()})
    except OSError as error:
        raise InputError(
            "--out", str(place), f"cannot write there ({error.strerror})", "name a folder"
        ) from error


def program_files(folder: Path) -> frozenset[str]:
    """Return the names of the programs next to a report that agree with their index."""
    place = folder / INSTANCES
    return frozenset(row["file"] for row in _index(place) if _data(row, place) is not None)


def copy_programs(source: Path, target: Path) -> None:
    """Copy the programs of a comparison, if there are any, to the folder of another report.

    Raises:
        InputError: A file cannot be written.
    """
    if source.resolve() == target.resolve() or not (source / INSTANCES).is_dir():
        return
    try:
        shutil.copytree(source / INSTANCES, target / INSTANCES, dirs_exist_ok=True)
    except (OSError, shutil.Error) as error:
        raise InputError(
            "--out", str(target), f"cannot write there ({error})", "name another folder"
        ) from error


def sources_of(outcomes: Iterable[Outcome]) -> dict[str, Outcome]:
    """Choose for each file the run whose program and minimum it states.

    This is the run that proves the minimum with the smallest residual. Programs beyond
    `MOST_UNKNOWNS` are omitted.
    """
    best: dict[str, Outcome] = {}
    sizes: dict[str, float] = {}
    for outcome in outcomes:
        name = commands_of(outcome.run)["instance_file"]
        if name:
            sizes[name] = max(sizes.get(name, 0.0), outcome.row.n_dofs)
            best[name] = min(best.get(name, outcome), outcome, key=_rank)
    total, chosen = 0.0, set[str]()
    for name in sorted(sizes, key=lambda name: sizes[name]):
        total += sizes[name]
        if total <= MOST_UNKNOWNS:
            chosen.add(name)
    return {name: outcome for name, outcome in best.items() if name in chosen}


def _rank(outcome: Outcome) -> tuple[bool, bool, float]:
    """Order runs by whether they may prove the minimum, and by their residual."""
    return (
        not _may_prove(outcome),
        outcome.row.coupling != ASSOCIATED,
        _residual(outcome),
    )


def _may_prove(outcome: Outcome) -> bool:
    """Return whether a run proves the minimum of the associated program, if it has no friction."""
    return (
        outcome.run.case.path is None
        and outcome.row.coupling in (ASSOCIATED, _CERTIFIED)
        and outcome.row.status == la.Status.SOLVED.label
        and outcome.row.rigor in _EXACT
    )


_EXACT = (la.Rigor.DISCRETE.label, la.Rigor.UPPER.label, la.Rigor.LOWER.label)
"""Rigour of load factors that certificates of the exact program prove."""


def _residual(outcome: Outcome) -> float:
    """Return the largest residual of a run; infinite without any."""
    residuals = outcome.evidence.residuals.values()
    return max((inf if isnan(one) else one for one in residuals), default=inf)


def _proven(source: Source, problem: la.Problem) -> tuple[la.Discretisation, Known | None]:
    """Return the discretisation of a run, and the minimum in its row.

    The second is None if the run solved another problem.
    """
    outcome, stated = source.outcome, la.discretise(problem)
    if not _may_prove(outcome):
        return stated, None
    from lacore_verification.harness.evidence.span_nodes import as_solved

    stated = as_solved(problem, stated, outcome.evidence)
    if not stated.program.associated_flow and outcome.row.coupling != ASSOCIATED:
        return stated, None
    known = Known(
        status=_STATES[outcome.row.status],
        load_factor=outcome.row.load_factor,
        residual=_residual(outcome),
        backend=outcome.run.backend,
        solver=str(outcome.evidence.history[-1]["native_status"]),
        code=source.code,
    )
    return stated, known


def _kept(sources: Mapping[str, Outcome], place: Path) -> dict[str, Program]:
    """Return existing programs that were written by the code of their runs."""
    found: dict[str, Program] = {}
    for row in _index(place):
        outcome = sources.get(row["file"])
        if outcome is None or row["code"] != code_of(outcome.run):
            continue
        data = _data(row, place)
        if data is not None:
            found[row["file"]] = _instance(row), data
    return found


def _index(place: Path) -> list[dict[str, str]]:
    """Return the rows of an index; none if there is no index of this format."""
    try:
        text = (place / INDEX).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return []
    rows = list(csv.DictReader(text.splitlines()))
    names = list(Instance.__annotations__)
    return [row for row in rows if list(row) == names and None not in row.values()]


def _data(row: Mapping[str, str], place: Path) -> bytes | None:
    """Return the content of the file of a row; None if it is missing or was changed."""
    try:
        data = (place / Path(row["file"]).name).read_bytes()
    except OSError:
        return None
    return data if hashlib.sha256(data).hexdigest() == row["sha256"] else None


def _instance(row: Mapping[str, str]) -> Instance:
    def read(name: str, kind: Any) -> Any:
        text = row[name]
        return float(text or "nan") if kind is float else kind(text)

    return Instance(**{name: read(name, kind) for name, kind in Instance.__annotations__.items()})
