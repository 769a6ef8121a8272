"""Logs of runs: the output of solvers, next to the store, in a file for each run with output."""

import re
import shutil
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from lacore.reporting.errors import InputError
from lacore_verification.harness.store.manifest import whole_file
from lacore_verification.runs.outcome import Outcome

FOLDER = "logs"
FILE = re.compile(rf"|{FOLDER}/[0-9a-f]+\.txt")
"""Values of the column ``log`` of a row: a path relative to the folder of results, or empty."""


def with_log(outcome: Outcome, folder: Path) -> Outcome:
    """Write the log of an outcome to a folder of results, and return it with a row that names it.

    An empty log leaves no file.

    Raises:
        InputError: The file cannot be written.
    """
    file = f"{FOLDER}/{outcome.run.key}.txt"
    path = folder / file
    try:
        if not outcome.log.strip():
            path.unlink(missing_ok=True)
            return outcome
        path.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(path) as unfinished:
            unfinished.write_text(outcome.log, encoding="utf-8", errors="replace")
    except OSError as error:
        raise InputError(
            "log", str(path), f"cannot be written ({error.strerror})",
            "free space or name another folder; every finished run is kept",
        ) from error  # fmt: skip
    return replace(outcome, row=replace(outcome.row, log=file))


def copy_logs(outcomes: Iterable[Outcome], source: Path, target: Path) -> None:
    """Copy the logs that rows name, as far as they exist, from one folder of results to another.

    Raises:
        InputError: A file cannot be written.
    """
    if source.resolve() == target.resolve():
        return
    try:
        for file in {outcome.row.log for outcome in outcomes} - {""}:
            if (source / file).is_file():
                (target / file).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source / file, target / file)
    except OSError as error:
        raise InputError(
            "--out", str(target), f"cannot write there ({error.strerror})", "name another folder"
        ) from error
