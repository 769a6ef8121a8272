"""Models, built once; one thread; the machine in the record."""

from functools import cache
from importlib.metadata import version

import pytest
from threadpoolctl import threadpool_limits

from lacore.backend import backend_names, load_backend
from lacore.numerics.symmetric import symmetric_solver
from tests.benchmarks.measuring import Model, punch
from verification.store.provenance import describe

THREADS = ("MKL_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")


@pytest.fixture(scope="session")
def one_thread():
    """Numerical libraries, here and in processes of backends."""
    symmetric_solver().close()  # loads its library, which only then can be limited
    with pytest.MonkeyPatch.context() as patch, threadpool_limits(1):
        for name in THREADS:
            patch.setenv(name, "1")
        yield


@pytest.fixture(scope="session")
def model(one_thread):
    """The punch on 4 nx ny triangles, by nx and ny."""
    return cache(lambda nx, ny: Model(punch(nx, ny)))


def pytest_benchmark_update_machine_info(config, machine_info):
    """Versions, as the reports have them; the name of the machine is nobody's business."""
    backends = [load_backend(name) for name in backend_names()]
    machine_info.update(
        describe(backend_names()),
        node="",
        threads="one",
        direct_solver=_direct_solver(),
        backends={one.name: one.version() for one in backends if not one.unavailable()},
    )


def _direct_solver():
    name = symmetric_solver().name
    return name if name == "SuperLU" else f"{name} through pypardiso {version('pypardiso')}"
