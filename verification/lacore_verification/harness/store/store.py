"""The store: one durable row for each finished run, as soon as it ends (SQLite, one writer).

All content is text or numpy arrays: nothing that is read is executed. Each row has a checksum and a
seal, and each field is checked on reading (`lacore_verification.harness.store.stored_rows`); the
file has a schema version. A run is identified by its `Run.key` and the version of the code that
solved it; `load_results` gives the newest of each.
"""

import hashlib
import json
import sqlite3
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from filelock import FileLock, Timeout

from lacore.reporting.errors import InputError
from lacore_verification.harness.store.stored_rows import (
    TEXTS,
    WrongFieldError,
    check_texts,
    read_json,
    seal_of,
)
from lacore_verification.runs.outcome import Evidence, Outcome, columns
from lacore_verification.runs.row import Row
from lacore_verification.runs.run import Run, canonical

NAME = "results.sqlite"
SCHEMA = 2
_APPLICATION = 0x6C61636F  # "laco", in the header of the file.
_TABLES = """
CREATE TABLE sessions (id INTEGER PRIMARY KEY, provenance TEXT NOT NULL) STRICT;
CREATE TABLE runs (
    run TEXT NOT NULL, code TEXT NOT NULL, session INTEGER NOT NULL REFERENCES sessions (id),
    finished TEXT NOT NULL, identity TEXT NOT NULL, row TEXT NOT NULL, residuals TEXT NOT NULL,
    history TEXT NOT NULL, arrays BLOB NOT NULL, seal TEXT NOT NULL DEFAULT '',
    checksum TEXT NOT NULL, PRIMARY KEY (run, code)
) STRICT;
"""
_UNSEALED = 1  # The rows of this schema have no seal.
_SEALED = "ALTER TABLE runs ADD COLUMN seal TEXT NOT NULL DEFAULT ''"
_COLUMNS = (*TEXTS, "arrays", "seal", "checksum")
_OF_THE_DISK = (
    *(sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR, sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN),
    *(sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED, sqlite3.SQLITE_PERM, sqlite3.SQLITE_NOMEM),
)
"""Errors that do not concern the file itself."""
_PATIENCE = 60.0  # s: a reader of a large store may be active while a run ends.


class Store:
    """A store open for writing; a context manager.

    Args:
        path: of the file; it and its folder are made if they do not exist.
        provenance: of the rows to be appended: versions, machine, date, ...

    Raises:
        InputError: the file cannot be written, is no store, is damaged, is of a newer lacore, or
            another process writes it.
    """

    def __init__(self, path: Path, provenance: Mapping[str, str]) -> None:
        self._path = path
        with _said(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            self._lock = FileLock(f"{path}.lock", timeout=0)
            self._lock.acquire()
        with ExitStack() as undone:
            undone.callback(self._lock.release)
            self._database = _connected(path, create=True)
            undone.callback(self._database.close)
            with _said(path), self._database:
                text = json.dumps(dict(provenance))
                added = self._database.execute(
                    "INSERT INTO sessions (provenance) VALUES (?)", (text,)
                )
            self._session = added.lastrowid
            undone.pop_all()

    def append(self, outcome: Outcome, code: str) -> None:
        """Store an outcome: it is on the disk when this returns.

        An outcome of the same run and code replaces the previous one.

        Raises:
            InputError: it cannot be written; earlier rows stay.
        """
        evidence = outcome.evidence
        texts = (
            *(outcome.run.key, code, self._session, datetime.now(UTC).isoformat()),
            canonical(outcome.run.identity),
            *(canonical(part) for part in (vars(outcome.row), dict(evidence.residuals))),
            canonical([dict(record) for record in evidence.history]),
            evidence.arrays,
        )
        texts = (*texts, seal_of(texts[:-1]))
        marks = ", ".join("?" * len(_COLUMNS))
        with _said(self._path), self._database:
            self._database.execute(
                f"INSERT OR REPLACE INTO runs ({', '.join(_COLUMNS)}) VALUES ({marks})",
                (*texts, _checksum(texts)),
            )

    def finished(self, runs: Iterable[tuple[Run, str]]) -> dict[str, Outcome]:
        """Return outcomes that are stored already, by key, for runs and their codes.

        Also failures.
        """
        found = {}
        for run, code in runs:
            query = f"SELECT {', '.join(_COLUMNS)} FROM runs WHERE run = ? AND code = ?"
            with _said(self._path):
                record = self._database.execute(query, (run.key, code)).fetchone()
            if record is not None:
                found[run.key] = _entry(record, self._path).outcome(run)
        return found

    def close(self) -> None:
        """Let others write."""
        self._database.close()
        self._lock.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


@dataclass(frozen=True)
class Entry:
    """A stored row.

    Attributes:
        run, code, session, finished: key of the run, version of the code, number of the session,
            time (UTC, ISO 8601).
        identity: of the run, see `Run.identity`.
        row: the results.
        evidence: their proof.
    """

    run: str
    code: str
    session: int
    finished: str
    identity: Mapping[str, Any]
    row: Row
    evidence: Evidence

    def outcome(self, run: Run) -> Outcome:
        """Return the entry as an outcome of a run."""
        return Outcome(run, self.row, self.evidence)

    def record(self) -> dict[str, Any]:
        """Return the columns of `lacore_verification.load_results`."""
        names = ("run", "session", "finished")
        return columns(self.row, self.evidence.residuals, self.identity) | {
            name: getattr(self, name) for name in names
        }


def entries(path: Path) -> list[Entry]:
    """Return the newest row of each run in a store, in the order in which they were finished.

    Raises:
        InputError: there is no store, it is damaged, or of a newer lacore.
    """
    if not path.is_file():
        raise InputError("DIR", str(path), "there is no store", "name the folder of a finished run")
    with closing(_connected(path, create=False)) as database, _said(path):
        names = _columns(database)
        query = f"SELECT {names}, max(finished) FROM runs GROUP BY run ORDER BY finished"
        return [_entry(record[:-1], path) for record in database.execute(query)]


def sessions(path: Path) -> dict[int, dict[str, str]]:
    """Return the provenance of the sessions that wrote a store, by number.

    Raises:
        InputError: as `entries`.
    """
    with closing(_connected(path, create=False)) as database, _said(path):
        rows = database.execute("SELECT id, provenance FROM sessions").fetchall()
    return {number: _provenance(number, text, path) for number, text in rows}


def _provenance(number: int, text: object, path: Path) -> dict[str, str]:
    field = f"session {number}, provenance"
    try:
        found = read_json(field, text, dict)
        for name, value in found.items():
            if not isinstance(value, str):
                raise WrongFieldError(f"{field}.{name}", "is no text")
    except WrongFieldError as error:
        raise _damaged(path, str(error)) from error
    return dict(found)


def _connected(path: Path, create: bool) -> sqlite3.Connection:
    with _said(path):
        # Readers may write, too: they undo incomplete changes of a killed writer.
        mode = "rwc" if create else "rw"
        uri = f"{path.resolve().as_uri()}?mode={mode}"
        database = sqlite3.connect(uri, uri=True, timeout=_PATIENCE)
        try:
            database.execute("PRAGMA synchronous = FULL")
            (pages,) = database.execute("PRAGMA page_count").fetchone()
            if create and not pages:
                with database:
                    database.executescript(
                        f"BEGIN; PRAGMA application_id = {_APPLICATION};"
                        f" PRAGMA user_version = {SCHEMA}; {_TABLES} COMMIT;"
                    )
            _check(database, path)
            if create and _schema(database) == _UNSEALED:
                with database:
                    database.executescript(
                        f"BEGIN; {_SEALED}; PRAGMA user_version = {SCHEMA}; COMMIT;"
                    )
        except BaseException:
            database.close()
            raise
    return database


def _check(database: sqlite3.Connection, path: Path) -> None:
    """Raise an error for another, damaged or newer file, before anything is written."""
    (application,) = database.execute("PRAGMA application_id").fetchone()
    schema = _schema(database)
    if application != _APPLICATION:
        raise InputError("store", str(path), "is no store of lacore", "name another folder")
    if schema < _UNSEALED:
        raise _damaged(path, f"schema {schema}, which never was")
    if schema > SCHEMA:
        raise InputError(
            "store", str(path), f"has schema {schema}, this lacore knows {SCHEMA}", "update lacore"
        )
    (pages,) = database.execute("PRAGMA page_count").fetchone()
    (size,) = database.execute("PRAGMA page_size").fetchone()
    if path.stat().st_size < pages * size:  # A truncated last page may pass the next check.
        raise _damaged(path, f"{path.stat().st_size} bytes of {pages * size}")
    (verdict,) = database.execute("PRAGMA integrity_check(1)").fetchone()
    if verdict != "ok":
        raise _damaged(path, " ".join(verdict.split()))
    sessions = {number for (number,) in database.execute("SELECT id FROM sessions")}
    for record in database.execute(f"SELECT {_columns(database)} FROM runs"):
        found = _entry(record, path)
        if found.session not in sessions:
            raise _damaged(path, f"row {found.run}: field 'session' names none")


def _schema(database: sqlite3.Connection) -> int:
    (schema,) = database.execute("PRAGMA user_version").fetchone()
    return int(schema)


def _columns(database: sqlite3.Connection) -> str:
    """Return the columns of a row; those from before seals have an empty one."""
    unsealed = _schema(database) == _UNSEALED
    return ", ".join("''" if unsealed and name == "seal" else name for name in _COLUMNS)


def _damaged(path: Path, how: str) -> InputError:
    return InputError(
        "store", str(path), f"is damaged ({how})", "restore a copy, or name another folder"
    )


@contextmanager
def _said(path: Path) -> Iterator[None]:
    """Convert errors of the file to messages with a fix."""
    try:
        yield
    except Timeout as error:
        raise InputError(
            "store",
            str(path),
            "is being written by another process",
            "wait, or name another folder",
        ) from error
    except sqlite3.DatabaseError as error:
        # The lower byte is the kind of error. Invalid text has no code.
        if getattr(error, "sqlite_errorcode", 0) & 0xFF not in _OF_THE_DISK:
            raise _damaged(path, str(error)) from error
        raise InputError(
            "store", str(path), f"cannot be used ({error})",
            "free space or name another folder; every finished run is kept",
        ) from error  # fmt: skip
    except UnicodeDecodeError as error:  # sqlite3 cannot decode its own message.
        raise _damaged(path, "text that is none") from error
    except OSError as error:
        raise InputError(
            "store", str(path), f"cannot be used ({error.strerror or error})", "name another folder"
        ) from error


def _checksum(values: Sequence[Any]) -> str:
    digest = hashlib.sha256()
    for value in values:
        data = value if isinstance(value, bytes) else str(value).encode()
        digest.update(len(data).to_bytes(8, "little") + data)
    return digest.hexdigest()


def _check_sum(record: Sequence[Any], path: Path) -> None:
    *values, seal, checksum = record
    if _checksum([*values, seal] if seal else values) != checksum:
        raise _damaged(path, f"checksum of run {record[0]}")


def _entry(record: Sequence[Any], path: Path) -> Entry:
    """Return a row that is unchanged.

    Raises:
        InputError: it was changed.
    """
    _check_sum(record, path)
    found = dict(zip(_COLUMNS, record, strict=True))
    try:
        identity, row, residuals, history = check_texts(found)
    except WrongFieldError as error:
        raise _damaged(path, f"row {record[0]!r:.40}: {error}") from error
    evidence = Evidence(residuals, tuple(history), found["arrays"])
    return Entry(
        run=found["run"],
        code=found["code"],
        session=found["session"],
        finished=found["finished"],
        identity=identity,
        row=row,
        evidence=evidence,
    )


def file_of(place: Path) -> Path:
    """Return the store in a folder; or the file itself."""
    return place if place.suffix == Path(NAME).suffix else place / NAME
