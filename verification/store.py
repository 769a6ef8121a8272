"""Rows on disk: written as they finish, so that a crash loses no finished result."""

import csv
import os
from collections.abc import Iterable
from pathlib import Path
from types import TracebackType
from typing import Any

from lacore.errors import InputError


class ResultFile:
    """A CSV file that grows by one row a finished run; each row is on the disk when it returns."""

    def __init__(self, path: Path, columns: Iterable[str]) -> None:
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("w", newline="", encoding="utf-8")
        except OSError as error:
            raise InputError(
                "--out", str(path.parent), f"cannot write there ({error.strerror})", "name a folder"
            ) from error
        self._writer = csv.DictWriter(self._file, list(columns), restval="")
        self._writer.writeheader()
        self._flush()

    def append(self, record: dict[str, Any]) -> None:
        """Write one row; NaN is left empty."""
        self._writer.writerow(
            {name: "" if value != value else value for name, value in record.items()}
        )
        self._flush()

    def _flush(self) -> None:
        self._file.flush()
        os.fsync(self._file.fileno())

    def __enter__(self) -> "ResultFile":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._file.close()
