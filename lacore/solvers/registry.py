"""Installed backends by name: lacore's own, and those of other packages.

A backend of another package works in a separate process (`lacore.solvers.isolation`), and so does
one of ours that requires it. If the environment variable `ISOLATE` is set, all of them do; the
processes that assess results set it.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path

from lacore.reporting.errors import CapabilityError, InputError, require_known, suggest, typed
from lacore.solvers.contract import Backend, Family
from lacore.solvers.isolation import IsolatedBackend, SolverProcess
from lacore.solvers.served_process import ISOLATE, Source

GROUP = "lacore.backends"
_OWN = "lacore_backends"  # package of our own backends
CALIBRATION = "clarabel"
"""Backend of lacore with which comparisons repeat a short solve, to measure the machine."""
PROVING_BACKEND = "auto"
"""Exact backend that proves what others claim, where these prove no equilibrium; by two solvers."""


@dataclass(frozen=True)
class Registered:
    """Entry point of a backend.

    Attributes:
        name: Name under which it is registered.
        target: ``module:attribute`` of its class.
        file: File that registers it.
        own: Whether it is one of lacore's.
        conflict: Why it cannot be used; empty if it can.
    """

    name: str
    target: str
    file: str
    own: bool
    conflict: str = ""

    @property
    def label(self) -> str:
        """Name with the package that registers it, as names of rejected ones are not unique."""
        return f"{self.name} ({Path(self.file).name})"


def backend_names() -> list[str]:
    """Return the names of all registered backends, sorted.

    Example:
        >>> "clarabel" in la.backend_names()
        True
    """
    return sorted(_registered(tuple(sys.path))[0])


def rejected_backends() -> list[Registered]:
    """Return the entry points with the name of another backend, with the reason of rejection."""
    return [*_registered(tuple(sys.path))[1]]


@cache
def _registered(path: tuple[str, ...]) -> tuple[Mapping[str, Registered], tuple[Registered, ...]]:
    """Return the backends on a path by name, and those whose name is taken. Reading takes ms."""
    own: dict[str, Registered] = {}
    others: dict[str, list[Registered]] = {}
    for entry in entry_points(group=GROUP):
        found = Registered(entry.name, entry.value, _file(entry), _is_own(entry))
        if found.own:
            own.setdefault(entry.name, found)
        elif found not in others.setdefault(entry.name, []):
            others[entry.name].append(found)
    valid, rejected = dict(own), list[Registered]()
    for name, found_here in others.items():
        files = sorted(one.file for one in found_here)
        for one in found_here:
            if name in own:
                why = f"lacore has a backend {name!r} of its own: register another name"
            elif ":" in name or not name:
                why = f"{name!r} is no name of a backend: a colon separates variants of a family"
            elif len(found_here) > 1:
                why = f"several packages register a backend {name!r}: {', '.join(files)}"
            else:
                valid[name] = one
                continue
            rejected.append(Registered(name, one.target, one.file, False, f"{why} ({one.file})"))
    return valid, tuple(rejected)


def _is_own(entry: EntryPoint) -> bool:
    return entry.module.partition(".")[0] == _OWN


def _file(entry: EntryPoint) -> str:
    if entry.dist is None:
        return entry.value
    place = entry.dist.locate_file("")
    return str(Path(str(place)) / f"{entry.dist.name} {entry.dist.version}")


@typed()
def find_backend(name: str, process: SolverProcess | None = None) -> Backend:
    """Return the backend registered under a name, or ``name:variant`` of a family (``cvxpy:SCS``).

    Args:
        name: Name of the backend.
        process: Process in which it works; None: a backend of another package, and one that
            requires isolation, works in a process that is kept for it, and any other in this one.

    Raises:
        InputError: There is no such name.
        CapabilityError: It is registered, but cannot be loaded or run here.

    Example:
        >>> la.find_backend("clarabel").name
        'clarabel'
    """
    backend = load_backend(name, process)
    if reason := backend.unavailable():
        raise CapabilityError(f"backend {name!r} is not available: {reason}")
    return backend


def load_backend(name: str, process: SolverProcess | None = None) -> Backend:
    """Return the backend as `find_backend`, even if it cannot run, to query the reason."""
    if not isinstance(name, str):
        raise InputError("backend", name, "not a name", f"give one of {', '.join(backend_names())}")
    first, _, variant = name.partition(":")
    known, rejected = _registered(tuple(sys.path))
    for own in rejected:
        if name == own.label:
            raise CapabilityError(own.conflict)
    if first not in known:
        count = f"`lacore backends` lists the {len(known)} that are registered"
        raise InputError("backend", first, "unknown name", f"{suggest(first, known)} {count}")
    entry = known[first]
    if process is None and entry.own and not os.environ.get(ISOLATE):
        backend = _here(entry, name)
        if not backend.capabilities.isolated:
            return backend
        return _isolated(entry, name, variant).knowing(backend)
    isolated = _isolated(entry, name, variant)
    isolated = isolated if process is None else isolated.within(process)
    # Read it now, so that a faulty backend is known before it works.
    assert isolated.about.name == name
    return isolated


def own_backend(name: str) -> Backend:
    """Return a backend of lacore that works in this process, even where all others are isolated.

    Raises:
        InputError: lacore has no backend of this name.
    """
    own = {key: entry for key, entry in _registered(tuple(sys.path))[0].items() if entry.own}
    require_known("backend", name.partition(":")[0], own)
    return _here(own[name.partition(":")[0]], name)


def fault_of(name: str) -> str:
    """Return why a registered backend cannot be loaded; empty if it can, even if it cannot run."""
    try:
        load_backend(name)
    except CapabilityError as error:
        return str(error)
    return ""


def _here(entry: Registered, name: str) -> Backend:
    """Return one of our backends in this process."""
    try:
        backend: Backend = EntryPoint(entry.name, entry.target, GROUP).load()()
    except Exception as error:  # A broken installation must not affect other backends.
        why = f"{type(error).__name__}: {error}"
        raise CapabilityError(f"backend {entry.name!r} cannot be loaded: {why}") from error
    first, colon, variant = name.partition(":")
    if not colon:
        return backend
    if not isinstance(backend, Family):
        raise InputError("backend", name, "has no variants", f"give {first!r}")
    require_known(f"variant of backend {first!r}", variant, backend.variants())
    return backend.variant(variant)


@cache
def _isolated(entry: Registered, name: str, variant: str) -> IsolatedBackend:
    """Return a backend that works in a separate process; both are kept."""
    first, colon, _ = name.partition(":")
    if colon:
        known = _isolated(entry, first, "").variants()
        if not known:
            raise InputError("backend", name, "has no variants", f"give {first!r}")
        require_known(f"variant of backend {first!r}", variant, known)
    return IsolatedBackend(Source(name, entry.target, variant, entry.file), load_backend)
