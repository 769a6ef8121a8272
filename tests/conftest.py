"""Hypothesis is derandomised: the same examples at each run, on each machine.

And the example package, installed once for all tests.
"""

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from tests.processes import SOURCES
from tests.slices import BUDGET, LATE, SLICES, Budget, slice_of, slice_of_today

for name, examples in {"fast": 5, "all": 40}.items():
    settings.register_profile(
        name,
        derandomize=True,
        deadline=None,
        max_examples=examples,
        suppress_health_check=[HealthCheck.too_slow],
    )


BUDGET_OF_SLICE = pytest.StashKey[Budget]()


def pytest_configure(config):
    """Fewer examples of each property in the fast tests; those that say how many have as many."""
    every = config.option.markexpr in ("slow or not slow", "slow")
    settings.load_profile("all" if every else "fast")
    config.stash[BUDGET_OF_SLICE] = Budget()


ROOT = Path(__file__).parents[1]


SLOW = frozenset((Path(__file__).parent / "slow.txt").read_text(encoding="utf-8").splitlines())
"""Slow tests whose code other tests run as well (docs/design-decisions.md)."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config, items):
    """Those of the list are slow, like those that are marked; a slice may be chosen."""
    for item in items:
        if not SLOW.isdisjoint((item.nodeid, item.nodeid.partition("::")[0])):
            item.add_marker(pytest.mark.slow)
    if config.option.slice is not None:
        others = [item for item in items if slice_of(item.nodeid) != config.option.slice]
        config.hook.pytest_deselected(items=others)
        items[:] = [item for item in items if slice_of(item.nodeid) == config.option.slice]


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item):
    """A slice starts no test after its time."""
    if item.config.option.slice is not None and item.config.stash[BUDGET_OF_SLICE].spent:
        pytest.skip(LATE)


def pytest_terminal_summary(terminalreporter):
    """Report how many tests of a slice were not started."""
    skipped = terminalreporter.getreports("skipped")
    if late := sum(LATE in str(report.longrepr) for report in skipped):
        terminalreporter.write_line(f"{late} tests of this slice were not started in {BUDGET:g} s")


def pytest_addoption(parser):
    parser.addoption(
        "--slice",
        type=lambda text: slice_of_today() if text == "today" else int(text),
        default=None,
        metavar="N",
        help=f"run only the tests of slice N, 0 to {SLICES - 1} or today, and start none after"
        f" {BUDGET:g} s; with -m slow: the slow tests of a day",
    )
    parser.addoption(
        "--require-browser",
        action="store_true",
        help="fail where playwright or Chromium is missing, instead of skipping the tests of pages",
    )


@pytest.fixture(scope="session")
def with_example(tmp_path_factory):
    """Run a Python module where the example is installed, far from the repository."""
    if importlib.util.find_spec("ecos") is None:
        pytest.skip("ecos has no wheel for this Python")
    folder = tmp_path_factory.mktemp("example")
    source, target = folder / "source", folder / "site"
    # A copy: a build leaves its artefacts beside its sources.
    shutil.copytree(ROOT / "examples" / "lacore-ecos", source)
    path = os.pathsep.join([str(target), *SOURCES])
    ours = {name: value for name, value in os.environ.items() if not name.startswith("PIP_")}
    environment = ours | {"PYTHONPATH": path, "PIP_CONFIG_FILE": os.devnull}

    def run(*command):
        return subprocess.run(
            [sys.executable, "-m", *command],
            env=environment,
            cwd=folder,
            capture_output=True,
            text=True,
        )

    options = ["--no-deps", "--no-build-isolation", "--no-index", "--no-cache-dir"]
    installed = run("pip", "install", *options, "--target", str(target), str(source))
    assert installed.returncode == 0, installed.stderr
    return run
