"""Plugin of pytest: record which lines each test runs, and run tests in an order that is given."""

import json
import sys
import threading
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
_ROWS = pytest.StashKey[list[dict[str, object]]]()


def pytest_addoption(parser):
    parser.addoption("--lines-to", type=Path, metavar="FILE", help="write the lines of each test")
    parser.addoption("--order", type=Path, metavar="FILE", help="run the tests of a list, in order")


def pytest_configure(config):
    config.stash[_ROWS] = []


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config, items):
    """Keep the listed tests, in the order of the list."""
    if config.option.order is not None:
        names = json.loads(config.option.order.read_text(encoding="utf-8"))
        place = {name: number for number, name in enumerate(names)}
        items[:] = sorted(
            (own for own in items if own.nodeid in place), key=lambda own: place[own.nodeid]
        )


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item):
    """Record the lines of a test and of the fixtures that it sets up."""
    if item.config.option.lines_to is None:
        return (yield)
    lines = {}
    before, begin = sys.gettrace(), time.perf_counter()
    trace = _tracer(lines)
    threading.settrace(trace)
    sys.settrace(trace)
    try:
        return (yield)
    finally:
        sys.settrace(before)
        threading.settrace(before)
        row = {"test": item.nodeid, "seconds": time.perf_counter() - begin}
        ran = {path: sorted(numbers) for path, numbers in lines.items() if numbers}
        item.config.stash[_ROWS].append(row | {"lines": ran})


def pytest_sessionfinish(session):
    if session.config.option.lines_to is not None:
        rows = json.dumps(session.config.stash[_ROWS])
        session.config.option.lines_to.write_text(rows, encoding="utf-8")


def _tracer(lines):
    """Return a trace function that adds lines of the tree that are run, without its tests."""
    local = {}  # trace functions by file; None: not traced

    def tracer_of(name):
        path = Path(name)
        if not path.is_relative_to(ROOT) or path.is_relative_to(ROOT / "tests"):
            return None
        numbers = lines.setdefault(path.relative_to(ROOT).as_posix(), set())

        def trace(frame, event, _):
            if event == "line":
                numbers.add(frame.f_lineno)
            return trace

        return trace

    def enter(frame, _event, _):
        name = frame.f_code.co_filename
        if name not in local:
            local[name] = tracer_of(name)
        return local[name]

    return enter
