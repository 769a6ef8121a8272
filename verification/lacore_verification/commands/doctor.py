"""Check an installation: packages, BLAS threads, and a self-test of every backend."""

import re
from collections.abc import Callable, Iterator
from importlib.metadata import PackageNotFoundError, entry_points, version
from typing import Any

from threadpoolctl import threadpool_info

import lacore as la
from lacore.solvers.backend import Backend, Capabilities, Family, load_backend
from lacore.solvers.registry import rejected_backends
from lacore_verification import conformance
from lacore_verification.harness.store.provenance import describe

SELF_TEST = ("friction", "plasticity on a rough plane")  # a linear program, and one with cones
LIMIT = 10.0  # s, limit of one of their solves including imports; they take milliseconds


def all_backends() -> Iterator[tuple[str, Backend | None, str]]:
    """Yield every registered backend and every variant: name, backend, and why it cannot run."""
    for name in la.backend_names():
        try:
            backend = load_backend(name)
        except la.CapabilityError as error:
            yield name, None, str(error)
            continue
        yield name, backend, backend.unavailable()
        if isinstance(backend, Family):
            for variant in backend.variants():
                member = backend.variant(variant)
                yield f"{name}:{variant}", member, member.unavailable()
    for rejected in rejected_backends():
        yield rejected.label, None, rejected.conflict


def backend_record(name: str, backend: Backend | None, missing: str) -> dict[str, str]:
    """Return the properties of a backend, and whether it can run, as text."""
    if backend is None:
        blank = dict.fromkeys(
            ("version", "title", "solves", "takes", "hardening", "warm_start", "run"), ""
        )
        return {"name": name, **blank, "state": missing}
    can = backend.capabilities
    takes = {None: "cones", 1: "linear programs"}.get(can.max_cone, f"cones of {can.max_cone} rows")
    if can.max_unknowns is not None:
        takes += f", up to {can.max_unknowns} unknowns"
    return {
        "name": name,
        "version": "" if missing else backend.version(),
        "title": backend.title,
        "solves": "regularised" if can.regularised else "exact",
        "takes": takes,
        "hardening": "yes" if can.hardening else "no",
        "warm_start": "yes" if can.warm_start else "no",
        "run": _when(name, can),
        "state": missing or "ready",
    }


def _when(name: str, can: Capabilities) -> str:
    """Return when comparisons run a backend; variants of a family run if they are named."""
    if can.on_demand or ":" in name:
        return "by name"
    return "on rigid bodies" if can.linear_only else "by default"


def packages() -> list[dict[str, str]]:
    """Return every package that lacore uses: required and installed version, and advice."""
    records = []
    for requirement in _requirements():
        wanted, _, marker = (part.strip() for part in requirement.partition(";"))
        extra = "".join(re.findall(r"""extra == ["']([^"']+)""", marker))
        if extra == "dev":
            continue
        name = re.split(r"[^\w.-]", wanted)[0]
        try:
            found = version(name)
        except PackageNotFoundError:
            found = ""
        good = bool(found) and _new_enough(found, wanted)
        records.append(
            {
                "package": name,
                "wanted": wanted[len(name) :] or "any",
                "found": found or "not installed",
                "for": f"extra {extra}" if extra else "lacore",
                "remedy": "" if good else f"pip install '{wanted}'",
            }
        )
    return records


def _requirements() -> list[str]:
    """Return the requirements of the distribution that installs our command, whatever its name."""
    own = __name__.partition(".")[0]
    for entry in entry_points(group="console_scripts"):
        if entry.module.partition(".")[0] == own and entry.dist is not None:
            return entry.dist.requires or []
    return []


def _new_enough(found: str, wanted: str) -> bool:
    """Return whether a version satisfies the lower bound of a requirement."""
    least = re.search(r">=\s*([\d.]+)", wanted)
    return least is None or _numbers(found) >= _numbers(least[1])


def _numbers(text: str) -> list[int]:
    return [int(number) for number in re.findall(r"\d+", text.split("+")[0])]


def blas() -> list[dict[str, str]]:
    """Return the loaded libraries with their own thread pools."""
    return [
        {
            "library": str(pool["internal_api"]),
            "version": str(pool.get("version") or "unknown"),
            "threads": str(pool["num_threads"]),
        }
        for pool in threadpool_info()
    ]


def self_tests(on_start: Callable[[str], None]) -> list[dict[str, str]]:
    """Solve two small programs with each backend in a process that can be stopped."""
    records = []
    with la.SolverProcess() as process:
        for name, backend, missing in all_backends():
            on_start(name)
            state, remedy = "missing", missing
            if backend is not None and not missing:
                state, remedy = _self_test(process.isolated(backend))
            records.append({"backend": name, "self_test": state, "remedy": remedy})
    return records


def _self_test(backend: Backend) -> tuple[str, str]:
    for program in SELF_TEST:
        findings = conformance.run(
            backend,
            {"time_limit": LIMIT},
            programs=[program],
            on_start=lambda _: None,
        )
        for wrong in conformance.failures(findings):  # only the first, as a backend may hang
            return "FAIL", f"{wrong} (all checks: lacore conformance {backend.name})"
    return "pass", ""


def examine(on_start: Callable[[str], None]) -> dict[str, Any]:
    """Return the complete examination as one document; `healthy` tells if it is complete.

    Packages of extras or variants may be missing; a package that lacore requires must not, nor may
    a backend fail its self-test.
    """
    needed = packages()
    tests = self_tests(on_start)
    broken = [record for record in needed if record["remedy"] and record["for"] == "lacore"]
    failed = [record for record in tests if record["self_test"] == "FAIL"]
    return {
        "healthy": not (broken or failed),
        "environment": {key: text for key, text in describe().items() if key != "packages"},
        "packages": needed,
        "libraries": blas(),
        "backends": tests,
    }
