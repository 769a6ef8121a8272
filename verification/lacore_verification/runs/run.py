"""Runs as plain data that can be sent through pipes and stored."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

import lacore as la
from lacore_verification.case import Case, Variant


@dataclass(frozen=True)
class Run:
    """One run.

    Attributes:
        case, variant, mesh, backend: names and objects.
        coupling: a name of `la.solve` or `lacore_verification.defaults.RAW`; None is the default of
            the backend; `BRACKET` means a lower and an upper bound, `RANGE` the lowest and the
            highest load factor of a soil.
        insist: whether a run without result is a failure; not for regularised backends, nor with
            other `settings` or `options` than the default.
        skip: why it is not run.
        size: keyword arguments of `Case.build` instead of those of the mesh level.
        settings: keyword arguments of `la.solve` for the loop: damping, anderson, ...; for a
            bracket its `target_width`, instead of that of the case.
        options: options of the backend, by name.
    """

    case: Case
    variant: Variant
    mesh: str
    backend: str
    coupling: str | None = None
    insist: bool = True
    skip: str = ""
    size: Mapping[str, Any] = field(default_factory=dict)
    settings: Mapping[str, Any] = field(default_factory=dict)
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def label(self) -> str:
        """For progress."""
        varied = {**self.size, **self.settings}
        names = (
            f"{self.case.id}:{self.variant.name}",
            self.mesh,
            self.backend,
            self.coupling,
            *_assigned(varied),
            self.options_text,
        )
        return " ".join(name for name in names if name)

    @property
    def options_text(self) -> str:
        """The options of the backend, as ``tolerance=1e-06 max_iterations=50``; empty without."""
        return " ".join(_assigned(self.options))

    def problem(self) -> "la.Problem":  # not evaluated, as it would load the whole core
        """Return the problem; runs with equal `problem_key` have equal problems."""
        return self.case.problem_of(
            {**self.case.meshes[self.mesh], **self.size}, self.variant.parameters
        )

    @property
    def problem_key(self) -> tuple[object, ...]:
        """Equal for runs of the same problem, in one process."""
        return (id(self.case.build), self.mesh, canonical(self.size), canonical(self.parameters))

    @property
    def parameters(self) -> dict[str, Any]:
        """Parameters of the case."""
        return dict(self.variant.parameters)

    @property
    def identity(self) -> dict[str, Any]:
        """Names and numbers that identify the run."""
        return {
            "case": self.case.id,
            "variant": self.variant.name,
            "parameters": self.parameters,
            "mesh": self.mesh,
            "size": dict(self.size),
            "backend": self.backend,
            "coupling": self.coupling,
            "settings": dict(self.settings),
            "options": dict(self.options),
        }

    @property
    def names(self) -> dict[str, Any]:
        """Names of the run, as columns of its row."""
        return {
            "case": self.case.id,
            "variant": self.variant.name,
            "backend": self.backend,
            "coupling": self.coupling or "",
            "mesh": self.mesh,
            "options": self.options_text,
        }

    @property
    def key(self) -> str:
        """Hash of `identity`."""
        return hashlib.sha256(canonical(self.identity).encode()).hexdigest()[:16]


def canonical(data: Any) -> str:
    """Return JSON of plain data, equal for equal data.

    Raises:
        TypeError: a value that JSON does not support.
    """
    return json.dumps(data, sort_keys=True, separators=(",", ":"), default=_of_numpy)


def _of_numpy(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__} {value!r} is neither text nor a number")


def _assigned(values: Mapping[str, Any]) -> list[str]:
    return [f"{name}={_short(value)}" for name, value in values.items()]


def _short(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


FUZZ = "fuzz"
"""Name used as coupling in runs of random problems, whose rows have no evidence."""
