"""Options of backends in a comparison: ``NAME.option=value``, several settings of one backend."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields, replace
from types import NoneType
from typing import Any, get_args, get_type_hints

import lacore as la
from lacore.reporting.errors import InputError, suggest
from lacore.solvers.backend import load_backend
from lacore_verification.case.band import BRACKET
from lacore_verification.harness.campaigns.axis import read_value
from lacore_verification.harness.campaigns.varied import options
from lacore_verification.runs.run import Run

_FIELD = "--option"
_NONE = "none"
_FORM = "write NAME.OPTION=VALUE, as in clarabel.tolerance=1e-9"


def with_options(runs: Sequence[Run], texts: Sequence[str]) -> list[Run]:
    """Return runs with options of their backends; for several settings of a backend, one run each.

    With changed options, a run may end without a result, which is then no failure. Brackets choose
    their options themselves.

    Args:
        runs: of a comparison.
        texts: see `read_settings`.

    Raises:
        InputError: an option or a backend does not exist, or no run has it.
    """
    settings = read_settings(texts)
    taking_part = {run.backend for run in runs if run.coupling != BRACKET}
    for name in settings:
        if name not in taking_part:
            raise InputError(
                _FIELD, name, "this backend has no run here", f"add it: --backends {name}"
            )
    found: dict[str, Run] = {}
    for run in runs:
        own = [{}] if run.coupling == BRACKET else settings.get(run.backend, [{}])
        for point in own:
            changed = replace(run, options=point, insist=run.insist and not point)
            found.setdefault(changed.key, changed)
    return [*found.values()]


def read_settings(texts: Sequence[str]) -> dict[str, list[dict[str, Any]]]:
    """Return settings by backend, each without the options that have the default value.

    Args:
        texts: ``NAME.option=value``, several separated by commas. An option that is given again
            begins another setting of its backend. A further value, as in
            ``NAME.option=value,value``, repeats the previous setting with that value.

    Raises:
        InputError: an unknown backend or option, or a value that the backend rejects.
        CapabilityError: the backend cannot be loaded.
    """
    found: dict[str, list[dict[str, Any]]] = {}
    for name, option, value, further in _assignments(texts):
        settings = found.setdefault(name, [{}])
        if option in settings[-1]:
            settings.append(dict(settings[-1]) if further else {})
        settings[-1][option] = value
    return {name: _distinct(name, settings) for name, settings in found.items()}


def _assignments(texts: Sequence[str]) -> Iterator[tuple[str, str, Any, bool]]:
    """Yield backend, option and value, and whether it is a further value of the same option."""
    for text in texts:
        name = option = ""
        for part in map(str.strip, text.split(",")):
            place, equals, value = (piece.strip() for piece in part.partition("="))
            if equals:
                name, _, option = place.rpartition(".")
            else:  # A further value of the previous option.
                value = place
            if not (name and option and value):
                raise InputError(_FIELD, part, "is no option of a backend with its value", _FORM)
            yield name, option, _value(name, option, value), not equals


def _value(name: str, option: str, text: str) -> Any:
    backend = load_backend(name)
    known = options(name)
    if option not in known:
        defaults = ", ".join(f"{own.name}={_default(backend, own.name)}" for own in _fields(name))
        raise InputError(
            f"{_FIELD} {name}.{option}",
            text,
            "unknown option",
            f"{suggest(option, known)} Options of this backend and their defaults: {defaults}",
        )
    if text.lower() == _NONE and _may_be_none(backend.Options, option):
        return None
    return read_value(f"{_FIELD} {name}.{option}", text, known[option])


def _fields(name: str) -> tuple[Any, ...]:
    return fields(load_backend(name).Options)


def _default(backend: la.solvers.backend.Backend, option: str) -> Any:
    return getattr(backend.Options(), option)


def _may_be_none(kind: type, option: str) -> bool:
    hints: dict[str, Any] = {}
    # Some names are known to type checkers only.
    with suppress(NameError, TypeError, AttributeError):
        hints = get_type_hints(kind)
    return NoneType in get_args(hints.get(option))


def _distinct(name: str, settings: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return settings that differ, by their differences from the defaults."""
    kind = load_backend(name).Options
    defaults, found = kind(), list[dict[str, Any]]()
    for given in settings:
        kind(**given)
        changed = {key: value for key, value in given.items() if value != getattr(defaults, key)}
        if changed not in found:
            found.append(changed)
    return found
