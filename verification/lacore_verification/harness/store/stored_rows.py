"""Checks of a row of the store: field by field, and all fields together.

A checksum detects accidental changes of a row. A deliberate change can have a checksum, too:
therefore nothing is read that lacore could not have written, and a digest of each text, the seal,
accompanies the checksum. Only recomputed residuals show whether a state proves its row:
`lacore_verification.harness.verify`.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, fields
from datetime import datetime
from math import isfinite, isnan
from typing import Any

import lacore as la
from lacore.paths.ending import Ending
from lacore.program.certificate import Certificate
from lacore.reporting.findings import restored
from lacore_verification.case.band import BRACKET
from lacore_verification.case.case import RANGE
from lacore_verification.harness.store.logs import FILE
from lacore_verification.harness.verdicts.words import (
    BOUND_ONLY,
    FAIL,
    NO_REFERENCE,
    NO_RESULT,
    PASS,
    SKIPPED,
)
from lacore_verification.runs.row import COUNTS, STRICT, Row
from lacore_verification.runs.run import FUZZ

TEXTS = ("run", "code", "session", "finished", "identity", "row", "residuals", "history")
"""Columns of the store that are text or a number; the seal is of them."""
_SOLVED = la.Status.SOLVED.label
_WORDS: Mapping[str, tuple[str, ...]] = {
    "status": (*(own.label for own in la.Status), "skipped", "refused"),
    "rigor": ("", STRICT, *(own.label for own in la.Rigor)),
    "verdict": (PASS, FAIL, SKIPPED, NO_RESULT, NO_REFERENCE, BOUND_ONLY),
    "ending": ("", *(own.label for own in Ending)),
    "standing": ("", *(own.label for own in la.Standing)),
    "side": ("", "below", "above", "both"),
}
_SIZES = (
    *("build_time", "solve_time", "peak_memory_mb", "compile_time", "solver_time"),
    *("calibration_before", "calibration_after"),
)
_MOST = 2.0**53  # Larger integers are not exact in double precision.
_YEARS = (2000, 2200)
_IDENTITY: Mapping[str, type] = {
    **dict.fromkeys(("case", "variant", "mesh", "backend"), str),
    **dict.fromkeys(("parameters", "size", "settings", "options"), dict),
}
_OF_LOOPS = {"inner_status", "inner_iterations", "solve_time", "peak_memory"}
_OF_RANGES = {"status", "load_factor", "gap", "solves"}
_SINCE_0_4 = {"overlap"}  # Of paths; results of earlier versions can be read without it.


class WrongFieldError(ValueError):
    """A field that lacore has not written; the message names it."""

    def __init__(self, field: str, why: str) -> None:
        super().__init__(f"field {field!r} {why}")


def seal_of(texts: Sequence[Any]) -> str:
    """Return the digest of each of the `TEXTS` of a row, as text."""
    return json.dumps(
        {name: _digest(name, text) for name, text in zip(TEXTS, texts, strict=True)},
        sort_keys=True,
    )


def _digest(name: str, text: Any) -> str:
    return hashlib.sha256(f"{name}={text}".encode()).hexdigest()[:32]


def read_json(field: str, text: object, kind: type) -> Any:
    """Return text as JSON of a given type.

    Raises:
        WrongFieldError: it is no JSON, or of another type.
    """
    if not isinstance(text, str):
        raise WrongFieldError(field, "is no text")
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        raise WrongFieldError(field, "is no JSON") from None
    if not isinstance(found, kind):
        raise WrongFieldError(field, f"is no {kind.__name__}")
    return found


def check_texts(
    record: Mapping[str, Any],
) -> tuple[dict[str, Any], Row, dict[str, float], list[Any]]:
    """Return identity, row, residuals and history of a record of the store by column.

    Raises:
        WrongFieldError: a field has another format than that of lacore, or fields are inconsistent.
    """
    _check_head(record)
    identity = _identity(record["identity"], record["run"])
    row = _row(record["row"])
    residuals = _residuals(record["residuals"])
    history = _history(record["history"])
    _check_arrays(record["arrays"])
    _check_together(identity, row, residuals, history, record["arrays"])
    if record["seal"]:
        _check_seal(record)
    return identity, row, residuals, history


def _check_head(record: Mapping[str, Any]) -> None:
    for name in ("run", "code"):
        text = record[name]
        if not (isinstance(text, str) and text.isalnum() and text.isascii()):
            raise WrongFieldError(name, "is no digest")
    session = record["session"]
    if not isinstance(session, int) or not 0 < session < _MOST:
        raise WrongFieldError("session", "is not the number of a session")
    try:
        finished = datetime.fromisoformat(record["finished"])
    except (TypeError, ValueError):
        raise WrongFieldError("finished", "is no time") from None
    if finished.tzinfo is None or not _YEARS[0] <= finished.year < _YEARS[1]:
        raise WrongFieldError("finished", "is no time of a run, with its zone")


def _check_seal(record: Mapping[str, Any]) -> None:
    seal = read_json("seal", record["seal"], dict)
    for name in TEXTS:
        if seal.get(name) != _digest(name, record[name]):
            raise WrongFieldError(name, "was changed after it was written")


def _identity(text: object, key: str) -> dict[str, Any]:
    found: dict[str, Any] = read_json("identity", text, dict)
    if set(found) != {*_IDENTITY, "coupling"}:
        raise WrongFieldError("identity", f"has not the fields {', '.join(_IDENTITY)}, coupling")
    for name, kind in _IDENTITY.items():
        if not isinstance(found[name], kind):
            raise WrongFieldError(f"identity.{name}", f"is no {kind.__name__}")
        if kind is dict:
            for own, value in found[name].items():
                _check_plain(f"identity.{name}.{own}", value)
    if not (found["coupling"] is None or isinstance(found["coupling"], str)):
        raise WrongFieldError("identity.coupling", "is no name")
    if hashlib.sha256(str(text).encode()).hexdigest()[:16] != key:
        raise WrongFieldError("run", "is not the key of its identity")
    return found


def _check_plain(field: str, value: object) -> None:
    """Raise an error unless keyword arguments of a run are plain values, or lists of them."""
    for own in value if isinstance(value, list) else [value]:
        if isinstance(own, str | bool | None):
            continue
        if not (isinstance(own, int | float) and abs(own) < 2.0**63):
            raise WrongFieldError(field, "is neither text nor a finite number")


def _row(text: object) -> Row:
    found = read_json("row", text, dict)
    kinds = {entry.name: entry.type for entry in fields(Row)}
    needed = {entry.name for entry in fields(Row) if entry.default is MISSING}
    odd = sorted((set(found) - set(kinds)) | (needed - set(found)))
    if odd:  # Later columns have defaults.
        raise WrongFieldError("row", f"has not the columns of a row: {', '.join(odd)[:200]}")
    for name, value in found.items():
        kind = kinds[name]
        if kind is float:
            _number(f"row.{name}", value)
        elif not isinstance(value, kind):  # type: ignore[arg-type]  # str or bool
            raise WrongFieldError(f"row.{name}", f"is no {getattr(kind, '__name__', kind)}")
    row = Row(**found)
    try:
        restored(row.findings)
    except ValueError:
        raise WrongFieldError("row.findings", "are no findings") from None
    if not FILE.fullmatch(row.log):
        raise WrongFieldError("row.log", f"= {row.log!r:.60} is no file of a log")
    for name, words in _WORDS.items():
        if getattr(row, name) not in words:
            raise WrongFieldError(f"row.{name}", f"= {getattr(row, name)!r:.60} is no {name}")
    for name in (*COUNTS, *_SIZES):
        value = getattr(row, name)
        whole = name in _SIZES or isnan(value) or value == int(min(max(value, -1.0), _MOST))
        if not (isnan(value) or 0 <= value < _MOST) or not whole:
            raise WrongFieldError(f"row.{name}", f"= {value!r} is none, which is never negative")
    return row


def _number(field: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or abs(value) >= 2.0**1023:
        if value in (float("inf"), float("-inf")) and not isinstance(value, bool):
            return float(value)
        raise WrongFieldError(field, "is not a number")
    return float(value)


def _residuals(text: object) -> dict[str, float]:
    found = read_json("residuals", text, dict)
    known = {entry.name for entry in fields(Certificate)}
    for name, value in found.items():
        if name not in known:
            raise WrongFieldError(f"residuals.{name}", "is no residual")
        _number(f"residuals.{name}", value)
    return dict(found)


def _history(text: object) -> list[Any]:
    found: list[Any] = read_json("history", text, list)
    for number, step in enumerate(found):
        if not isinstance(step, dict) or set(step) != set(found[0]):
            raise WrongFieldError(f"history[{number}]", "has not the columns of the first one")
        for name, value in step.items():
            if not isinstance(value, str | bool | None):
                _number(f"history[{number}].{name}", value)
    return found


def _check_arrays(arrays: object) -> None:
    if not isinstance(arrays, bytes):
        raise WrongFieldError("arrays", "are no bytes")


def _check_together(
    identity: Mapping[str, Any],
    row: Row,
    residuals: Mapping[str, float],
    history: Sequence[Mapping[str, Any]],
    arrays: bytes,
) -> None:
    """Raise an error for inconsistent fields."""
    for name in ("case", "variant", "backend", "mesh"):
        if getattr(row, name) != identity[name]:
            raise WrongFieldError(f"row.{name}", "is not that of its identity")
    if row.coupling != (identity["coupling"] or row.coupling):
        raise WrongFieldError("row.coupling", "is not that of its identity")
    if row.coupling == BRACKET:
        from lacore.bounds.bracket.bracket import Step  # Not imported for other runs.

        _check_history(history, {entry.name for entry in fields(Step)})
        _check_bracket(row, history)
    elif row.coupling == RANGE:
        _check_history(history, _OF_RANGES)
        _check_range(row, history)
    elif row.ending:
        from lacore.paths.path import PathStep  # Not imported for other runs.

        _check_history(history, {*(entry.name for entry in fields(PathStep)), "exact"} - _SINCE_0_4)
        _check_path(row, history)
    elif history:
        _check_history(history, _OF_LOOPS)
        _check_loop(row, residuals, history)
    if row.status == _SOLVED and row.coupling != FUZZ:  # Its numbers define it again.
        _check_solved(row, residuals, arrays)


def _check_history(history: Sequence[Mapping[str, Any]], needed: set[str]) -> None:
    missing = needed - set(history[0]) if history else set()
    if missing:
        raise WrongFieldError("history", f"has no {', '.join(sorted(missing))}")


def _check_solved(row: Row, residuals: Mapping[str, float], arrays: bytes) -> None:
    if not residuals or not arrays:
        raise WrongFieldError("row.status", f"is {_SOLVED!r}, without anything that proves it")
    ends = {BRACKET: ("lower", "upper"), RANGE: ("lowest", "highest")}
    for name in (*ends.get(row.coupling, ("load_factor",)), "n_elements"):
        if not isfinite(getattr(row, name)):
            raise WrongFieldError(f"row.{name}", f"is missing, and the status is {_SOLVED!r}")


def _check_loop(
    row: Row, residuals: Mapping[str, float], history: Sequence[Mapping[str, Any]]
) -> None:
    _require_same("row.gap", row.gap, residuals.get("gap", float("nan")))
    _require_same("row.outer_iterations", row.outer_iterations, len(history))
    _require_same("row.iterations", row.iterations, _total(history, "inner_iterations"))
    if row.claimed != (history[-1]["inner_status"] == _SOLVED):
        raise WrongFieldError("row.claimed", "is not what its history says")
    if row.rigor == la.Rigor.UPPER.label:
        _require_same("row.upper", row.upper, row.load_factor)


def _check_bracket(row: Row, history: Sequence[Mapping[str, Any]]) -> None:
    if not history:
        return _check_stopped(row)
    _require_same("row.outer_iterations", row.outer_iterations, len(history))
    for name in ("lower", "upper", "width"):
        _require_same(f"row.{name}", getattr(row, name), history[-1][name])


def _check_stopped(row: Row) -> None:
    """Raise an error unless a refused, crashed or stopped run has no history and no numbers."""
    if row.status == _SOLVED:
        raise WrongFieldError("history", f"is missing, and the status is {_SOLVED!r}")
    if not isnan(row.outer_iterations):
        _require_same("row.outer_iterations", row.outer_iterations, 0)


def _check_range(row: Row, history: Sequence[Mapping[str, Any]]) -> None:
    if not history:
        return _check_stopped(row)
    _require_same("row.outer_iterations", row.outer_iterations, _total(history, "solves"))
    found = [step["load_factor"] for step in history if step["status"] == "certified"]
    if found:
        _require_same("row.lowest", row.lowest, min(found))
        _require_same("row.highest", row.highest, max(found))


def _check_path(row: Row, history: Sequence[Mapping[str, Any]]) -> None:
    _require_same("row.outer_iterations", row.outer_iterations, _total(history, "solves"))
    if history and row.load_factor not in (history[-1]["load_factor"], history[-1]["force"]):
        raise WrongFieldError("row.load_factor", "is not that of its last step")


def _total(history: Sequence[Mapping[str, Any]], name: str) -> float:
    return float(sum(_number(f"history.{name}", step[name]) for step in history))


def _require_same(field: str, one: float, other: float) -> None:
    if not (one == other or (isnan(one) and isnan(other))):
        raise WrongFieldError(field, f"= {one!r} contradicts {other!r}, which stands elsewhere")
