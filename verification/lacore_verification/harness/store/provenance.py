"""Provenance of numbers: versions, machine, git state, and a digest of the code."""

import hashlib
import inspect
import os
import platform
import subprocess
from collections.abc import Iterable, Iterator
from contextlib import suppress
from datetime import UTC, datetime
from functools import cache
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import lacore as la
from lacore import __version__
from lacore.solvers.backend import load_backend
from lacore.solvers.registry import PROVING_BACKEND
from lacore_verification.runs.run import FUZZ, Run, canonical

PACKAGES = (
    *("lacore", "numpy", "scipy", "scikit-fem", "pypardiso", "numba", "shapely", "pandas"),
    "matplotlib",
)
"""Packages behind all numbers; backends name further ones."""
PROVENANCE = "provenance.json"
"""File next to the table of results."""
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
_SOURCES = ("lacore", "lacore_backends", "lacore_verification")
_LENGTH = 12


def describe(backends: Iterable[str] = ()) -> dict[str, str]:
    """Return date, machine, Python, threads, versions of packages, git state and seed, as text.

    `backends` are the names of those in use, whose packages are included.
    """
    threads = [f"{name}={os.environ[name]}" for name in _THREADS if name in os.environ]
    return {
        "date": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "machine": f"{_processor()}, {os.cpu_count()} logical cores,"
        f" {platform.system()} {platform.machine()}",
        "threads": ", ".join(threads) or "not limited by the environment",
        "python": platform.python_version(),
        "packages": ", ".join(f"{name} {_version(name)}" for name in _packages(backends)),
        "code": f"{code_version()}, {_git_state()}",
        "seed": "none: nothing is drawn at random",
    }


@cache
def code_version(*backends: str) -> str:
    """Return the digest of the sources behind a number, and of the versions of its packages.

    Those of `backends` are included.
    """
    digest = hashlib.sha256(platform.python_version().encode())
    for name, path in _sources():
        digest.update(name.encode() + b"\0" + path.read_bytes() + b"\0")
    digest.update("\0".join(_version(name) for name in _packages(backends)).encode())
    digest.update("\0".join(map(_backend_version, backends)).encode())
    return digest.hexdigest()[:_LENGTH]


def _sources() -> Iterator[tuple[str, Path]]:
    """Yield files with their places in the packages, as names of files are not unique."""
    for name in _SOURCES:
        for place in map(Path, import_module(name).__path__):
            for path in sorted(place.rglob("*.py")):
                yield path.relative_to(place.parent).as_posix(), path


def code_of(run: Run) -> str:
    """Return the version of all the code behind a run: of lacore, its case and its backend."""
    parts = [code_version(*solvers_of(run)), _source_digest(run)]
    return hashlib.sha256(canonical(parts).encode()).hexdigest()[:_LENGTH]


def solvers_of(run: Run) -> tuple[str, ...]:
    """Return the backends of the row of a run: random problems are compared with others."""
    return (run.backend, *la.backend_names()) if run.coupling == FUZZ else (run.backend,)


def _packages(backends: Iterable[str]) -> tuple[str, ...]:
    """Return the packages of backends, and of the backend that proves claims."""
    found = [*PACKAGES]
    for name in dict.fromkeys((PROVING_BACKEND, *backends)):
        with suppress(la.CapabilityError):  # The rows report a missing backend.
            found += load_backend(name).capabilities.packages
    return tuple(dict.fromkeys(found))


def _backend_version(name: str) -> str:
    try:
        return load_backend(name).version()
    except la.CapabilityError as error:
        return f"missing: {error}"


def _source_digest(run: Run) -> str:
    """Return the digest of the files of a case."""
    digest = hashlib.sha256()
    for part in (run.case.build, run.case.reference, run.case.band):
        with suppress(OSError, TypeError):
            digest.update(_bytes_of(inspect.getfile(part)))
    return digest.hexdigest()


@cache
def _bytes_of(file: str) -> bytes:
    return Path(file).read_bytes()


def _git_state() -> str:
    """Return the commit of the checkout with the code, and whether it was changed since."""
    place = Path(la.__file__).parent.parent
    if not (place / ".git").exists():
        return "no git checkout"
    try:
        commit, changes = (
            subprocess.run(
                ["git", "-C", str(place), *words], capture_output=True, text=True, check=True
            ).stdout.strip()
            for words in (["rev-parse", "--short=12", "HEAD"], ["status", "--porcelain"])
        )
    except (OSError, subprocess.CalledProcessError):
        return "git state unknown"
    return f"git {commit}" + (" with changes" if changes else "")


def _version(name: str) -> str:
    if name == "lacore":  # This is the name of the package, not of the distribution.
        return __version__
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    models = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor() or "unknown processor"
