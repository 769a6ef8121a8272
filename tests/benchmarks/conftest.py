"""Models, built once; one thread; each record kept, with the machine, as soon as it is there."""

import json
from dataclasses import replace
from functools import cache
from importlib.metadata import version
from pathlib import Path

import pytest
from threadpoolctl import threadpool_limits

from lacore.numerics.symmetric import symmetric_solver
from lacore.solvers.backend import backend_names, load_backend
from lacore_backends.cvxpy_conic import Cvxpy
from lacore_verification.harness.store.provenance import describe
from tests.benchmarks.measuring import Model, punch

THREADS = ("MKL_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")
_DIGITS = 8


def pytest_addoption(parser):
    parser.addoption(
        "--records", type=Path, help="append what each benchmark that passes has found to this file"
    )


def pytest_configure(config):
    config.addinivalue_line("markers", "dear: takes several minutes; run by `make bench-all`")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    """A line a benchmark, at once: what crashes later loses none."""
    report = yield
    file = item.config.getoption("records", None)
    found = getattr(getattr(item, "funcargs", {}).get("benchmark"), "extra_info", None)
    if file is not None and found and report.when == "call" and report.passed:
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("a", encoding="utf-8") as kept:
            kept.write(json.dumps({"measured": measured(), "record": _rounded(found)}) + "\n")
    return report


@pytest.fixture(scope="session")
def one_thread():
    """Numerical libraries, here and in processes of backends."""
    symmetric_solver().close()  # loads its library, which only then can be limited
    with pytest.MonkeyPatch.context() as patch, threadpool_limits(1):
        for name in THREADS:
            patch.setenv(name, "1")
        yield


@pytest.fixture
def in_this_process(monkeypatch):
    """Solvers of cvxpy that have a process of their own elsewhere, whose start would count."""
    own = Cvxpy.capabilities.fget
    monkeypatch.setattr(
        Cvxpy, "capabilities", property(lambda self: replace(own(self), isolated=False))
    )


@pytest.fixture(scope="session")
def model(one_thread):
    """The punch on 4 nx ny triangles, by nx and ny."""
    return cache(lambda nx, ny: Model(punch(nx, ny)))


@cache
def measured():
    """When, with what machine and versions; its name is nobody's business."""
    told = describe(backend_names())
    names = ("date", "machine", "python", "packages")
    backends = [load_backend(name) for name in backend_names()]
    return {name: told[name] for name in names} | {
        "direct_solver": _direct_solver(),
        "backends": {one.name: one.version() for one in backends if not one.unavailable()},
    }


def _direct_solver():
    name = symmetric_solver().name
    return name if name == "SuperLU" else f"{name} through pypardiso {version('pypardiso')}"


def _rounded(value):
    if isinstance(value, dict):
        return {name: _rounded(own) for name, own in value.items()}
    if isinstance(value, list):
        return [_rounded(own) for own in value]
    return float(f"{value:.{_DIGITS}g}") if isinstance(value, float) else value
