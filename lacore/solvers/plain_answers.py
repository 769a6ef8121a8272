"""Answers of a backend's process as plain data, written and read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from lacore.program.regularization import RegularisedValues
from lacore.program.state import ProgramState
from lacore.reporting.errors import BackendError, CapabilityError, InputError
from lacore.reporting.status import Status
from lacore.solvers import plain
from lacore.solvers.contract import InnerSolution, failed_answer, fault_of_kinds

_INPUT, _CAPABILITY = "input", "capability"


class PlainAnswers:
    """`lacore.solvers.child_process.Codec` whose messages contain plain data only."""

    def answer(self, value: Any) -> bytes:
        """Encode plain data.

        Raises:
            TypeError: It holds something that is not plain.
        """
        return plain.dumps({"value": value})

    def error(self, error: Exception) -> bytes:
        """Encode an error by its kind and its text."""
        about: dict[str, Any] = {"kind": type(error).__name__, "text": str(error)}
        about["notes"] = list(map(str, getattr(error, "__notes__", ())))
        if isinstance(error, InputError):
            about |= {"raised": _INPUT, "field": str(error.field), "why": str(error.reason)}
            about |= {"value": _plain_or_text(error.value), "fix": str(error.fix)}
        elif isinstance(error, CapabilityError):
            about["raised"] = _CAPABILITY
        return plain.dumps({"error": about})

    def read(self, message: bytes) -> Any:
        """Decode an answer.

        Raises:
            InputError, CapabilityError: As the backend raised it.
            BackendError: The backend raised anything else, or the message cannot be read.
        """
        try:
            found = plain.loads(message)
            about = found.get("error")
            error = None if about is None else _error(about)
            value = found.get("value")
        except (ValueError, TypeError, KeyError, AttributeError) as unreadable:
            raise BackendError(f"its process sent a message that is none: {unreadable}") from None
        if error is not None:
            raise error
        return value


def _plain_or_text(value: object) -> Any:
    plain_kind = value is None or isinstance(value, (bool, int, float, str))
    return value if plain_kind else repr(value)


def _error(about: dict[str, Any]) -> Exception:
    raised = about.get("raised")
    error: Exception
    if raised == _INPUT:
        error = InputError(about["field"], about["value"], about["why"], about["fix"])
    elif raised == _CAPABILITY:
        error = CapabilityError(about["text"])
    else:
        error = BackendError(f"{about['kind']}: {about['text']}")
    for note in about["notes"]:
        error.add_note(str(note))
    return error


def pack_answer(answer: object) -> dict[str, Any]:
    """Return the answer of a backend as plain data, or what is wrong with it."""
    if fault := fault_of_kinds(answer):
        return {"fault": fault}
    assert isinstance(answer, InnerSolution)
    point, values = answer.point, answer.regularised
    return {
        "status": answer.status.name,
        "native_status": answer.native_status,
        "iterations": int(answer.iterations),
        "solve_time": float(answer.solve_time),
        "message": answer.message,
        "point": None if point is None else _packed_point(point),
        "regularised": None
        if values is None
        else {field.name: float(getattr(values, field.name)) for field in fields(values)},
    }


def _packed_point(point: ProgramState) -> dict[str, Any]:
    return {
        "velocity": _numbers(point.velocity),
        "load_factor": _numbers(point.load_factor),
        "stress": [*map(_numbers, point.stress)],
        "mean_stress": [*map(_numbers, point.mean_stress)],
        "normal_reaction": _numbers(point.normal_reaction),
        "tangential_reaction": _numbers(point.tangential_reaction),
    }


def _numbers(values: object) -> Any:
    """Return an array of numbers unchanged, or else a message on what it is."""
    array = np.asarray(values)
    return array if array.dtype.kind in "fiub" else np.full(array.shape, np.nan)


def read_answer(data: Any, seconds: float, memory: float) -> InnerSolution:
    """Return the answer in plain data.

    Args:
        data: Result of `pack_answer`, from a process that may send anything.
        seconds: Time between request and answer, measured on this side, s.
        memory: Peak memory of the process, MB.
    """
    try:
        if fault := data.get("fault"):
            return failed_answer(str(fault), seconds)
        answer = InnerSolution(
            status=Status[data["status"]],
            native_status=data["native_status"],
            iterations=data["iterations"],
            solve_time=seconds,
            point=None if data["point"] is None else _point(data["point"]),
            regularised=None if data["regularised"] is None else _values(data["regularised"]),
            message=data["message"],
            peak_memory=memory,
            reported_time=float(data["solve_time"]),
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        return failed_answer(f"an answer that cannot be read: {error}", seconds)
    fault = fault_of_kinds(answer)
    return failed_answer(fault, seconds) if fault else answer


def _point(data: dict[str, Any]) -> ProgramState:
    return ProgramState(
        velocity=_array(data["velocity"]),
        load_factor=float(_array(data["load_factor"])),
        stress=_arrays(data["stress"]),
        mean_stress=_arrays(data["mean_stress"]),
        normal_reaction=_array(data["normal_reaction"]),
        tangential_reaction=_array(data["tangential_reaction"]),
    )


def _array(values: object) -> np.ndarray:
    return np.asarray(values, dtype=np.float64)


def _arrays(values: Sequence[object]) -> tuple[np.ndarray, ...]:
    return tuple(map(_array, values))


def _values(data: dict[str, Any]) -> RegularisedValues:
    return RegularisedValues(**{str(name): float(value) for name, value in data.items()})
