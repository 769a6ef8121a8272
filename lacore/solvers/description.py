"""Description of a backend as plain data, so that other processes need not import it.

`describe` runs in the process of the backend, where its properties may raise or hang; `Description`
is read from the result on the other side, and reports missing or wrong entries.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, asdict, dataclass, field, fields, is_dataclass, make_dataclass
from functools import partial
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

from lacore.reporting.errors import CapabilityError
from lacore.reporting.status import Status
from lacore.solvers.contract import Backend, Capabilities, Family, Writes

_KINDS: dict[str, type] = {"bool": bool, "int": int, "float": float, "str": str}
_KINDS |= {"NoneType": NoneType}


@dataclass(frozen=True)
class Option:
    """Option of a backend: its name, its default, and the accepted types."""

    name: str
    default: Any
    kinds: tuple[str, ...]

    @property
    def annotation(self) -> Any:
        """The type of its values; `Any` where they are of other kinds."""
        known = tuple(_KINDS[kind] for kind in self.kinds if kind in _KINDS)
        return Union[known] if known and len(known) == len(self.kinds) else Any  # noqa: UP007


@dataclass(frozen=True)
class Description:
    """Description of a backend.

    Attributes:
        name, title, source, version: See `lacore.solvers.contract.Backend`.
        missing: Why it cannot run; empty if it can.
        capabilities: Capabilities of the backend.
        statuses: Native statuses as text, with their meaning.
        options: All options.
        frozen: Whether its class of options is frozen.
        variants: Variants of a family; None for others.
        formats: Formats of the files that it writes.
    """

    name: str
    title: str
    source: str
    version: str
    missing: str
    capabilities: Capabilities
    statuses: Mapping[str, Status]
    options: tuple[Option, ...]
    frozen: bool
    variants: tuple[str, ...] | None
    formats: tuple[str, ...]

    def options_class(self, check: Callable[[Any], None], made: Callable[..., Any]) -> type:
        """Return a class of options with the same fields and defaults.

        Args:
            check: Called with each new instance; raises `InputError` for values out of range.
            made: Module-level function that makes an instance from its reduced form (for pickle).
        """
        name = self.name

        def checked(options: Any) -> None:
            check(options)

        def reduce(options: Any) -> tuple[Any, tuple[str, dict[str, Any]]]:
            return made, (name, asdict(options))

        return make_dataclass(
            "Options",
            [(own.name, own.annotation, field(default=own.default)) for own in self.options],
            frozen=self.frozen,
            namespace={"__post_init__": checked, "__reduce__": reduce},
        )


def describe(backend: Backend) -> dict[str, Any]:
    """Return the description of a backend as plain data; errors are listed under ``faults``."""
    faults: list[str] = []

    def asked(name: str, get: Callable[[], Any]) -> Any:
        try:
            return get()
        except Exception as error:  # A fault of another package becomes a line of the description.
            faults.append(f"{name} raised {type(error).__name__}: {error}")
            return None

    found: dict[str, Any] = {
        name: asked(name, partial(_text_of, backend, name)) for name in ("name", "title", "source")
    }
    found["missing"] = asked("unavailable()", lambda: _text("it", backend.unavailable()))
    found["version"] = (
        "" if found["missing"] else asked("version()", lambda: _text("it", backend.version()))
    )
    found["capabilities"] = asked("capabilities", lambda: _capabilities(backend.capabilities))
    found["statuses"] = asked("statuses", lambda: _statuses(backend.statuses))
    found["options"] = asked("Options", lambda: _options(backend.Options))
    found["frozen"] = asked("Options", lambda: _is_frozen(backend.Options))
    found["variants"] = asked(
        "variants()", lambda: list(backend.variants()) if isinstance(backend, Family) else None
    )
    found["formats"] = asked(
        "writers", lambda: list(backend.writers) if isinstance(backend, Writes) else []
    )
    return {**found, "faults": faults}


def _text_of(backend: Backend, name: str) -> str:
    return _text(name, getattr(backend, name))


def _text(name: str, value: object) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{name} is {value!r}, not text")
    return value


def _capabilities(value: object) -> dict[str, Any]:
    if not isinstance(value, Capabilities):
        raise TypeError(f"it is {value!r}, not a lacore.solvers.backend.Capabilities")
    return {**asdict(value), "packages": [_text("a package", own) for own in value.packages]}


def _statuses(value: object) -> list[list[str]]:
    if not isinstance(value, Mapping):
        raise TypeError(f"it is {value!r}, not a mapping from native statuses to lacore.Status")
    wrong = {key: status for key, status in value.items() if not isinstance(status, Status)}
    if wrong:
        raise TypeError(f"not a lacore.Status: {wrong}")
    return [[str(key), status.name] for key, status in value.items()]


def _options(kind: object) -> list[dict[str, Any]]:
    if not (isinstance(kind, type) and is_dataclass(kind)):
        raise TypeError(f"it is {kind!r}, not a dataclass")
    hints = get_type_hints(kind)
    found = []
    for own in fields(kind):
        if own.default is not MISSING:
            default = own.default
        elif own.default_factory is not MISSING:
            default = own.default_factory()
        else:
            raise TypeError(f"the option {own.name!r} has no default")
        hint = hints[own.name]
        union = get_origin(hint) in (Union, UnionType)
        kinds = [
            getattr(part, "__name__", str(part)) for part in (get_args(hint) if union else [hint])
        ]
        found.append({"name": own.name, "default": default, "kinds": kinds})
    if "time_limit" not in {own["name"] for own in found}:
        raise TypeError("there is no option 'time_limit'")
    return found


def _is_frozen(kind: type) -> bool:
    return bool(getattr(kind, "__dataclass_params__").frozen)  # noqa: B009


def read_description(data: Any, name: str, file: str) -> Description:
    """Return the description of the backend registered as `name`.

    Args:
        data: Result of `describe`, from a process that may send anything.
        name: Name under which it is registered.
        file: File that registers it, for messages.

    Raises:
        CapabilityError: Something is missing or wrong.
    """
    try:
        if data["faults"]:
            raise ValueError("; ".join(map(str, data["faults"])))
        if data["name"] != name:
            raise ValueError(
                f"its class is named {data['name']!r}: give both the same name, since results are"
                " stored under it"
            )
        can = {**data["capabilities"], "packages": tuple(data["capabilities"]["packages"])}
        return Description(
            **{key: _text(key, data[key]) for key in ("name", "title", "source", "version")},
            missing=_text("unavailable()", data["missing"]),
            capabilities=Capabilities(**can),
            statuses={str(key): Status[status] for key, status in data["statuses"]},
            options=tuple(
                Option(own["name"], _frozen(own["default"]), tuple(own["kinds"]))
                for own in data["options"]
            ),
            frozen=bool(data["frozen"]),
            variants=None if data["variants"] is None else tuple(map(str, data["variants"])),
            formats=tuple(map(str, data["formats"])),
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise CapabilityError(
            f"backend {name!r} describes itself wrongly: {error} ({file})"
        ) from None


def _frozen(value: Any) -> Any:
    return tuple(map(_frozen, value)) if isinstance(value, list) else value
