"""How long it takes to start: the processor time of a process, and starts of a bare Python."""

import os
import resource
import subprocess
import sys

import pytest

STARTS = {
    "import lacore": ("-c", "import lacore"),
    "the names of a first problem": ("-c", "from lacore import Body, Problem, solve"),
    "lacore --help": ("-m", "lacore_verification", "--help"),
    "a mistyped name": ("-m", "lacore_verification", "compare", "prandtl-pnuch"),
}


def start(*arguments):
    """A process from its begin to its end; `sys.executable` keeps what it has compiled."""
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, check=False)


def processor_time(*arguments):
    """s, the least of a few: the first one compiles, and others may disturb it."""
    return min(_once(*arguments) for _ in range(5))


def _once(*arguments):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start(*arguments)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


@pytest.mark.skipif(os.name != "posix", reason="asks the kernel for processor times")
@pytest.mark.parametrize("name", STARTS)
@pytest.mark.benchmark(group="start")
def test_start(benchmark, name):
    """No time is asserted: it is the machine's."""
    done = benchmark.pedantic(start, args=STARTS[name], rounds=1)
    seconds, bare = processor_time(*STARTS[name]), processor_time("-c", "pass")
    benchmark.extra_info.update(
        kind="start", what=name, seconds=seconds, bare_starts=seconds / bare
    )
    assert done.returncode == (2 if name == "a mistyped name" else 0)
    if name == "a mistyped name":
        assert "prandtl-punch" in done.stderr  # what was meant
