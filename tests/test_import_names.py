"""What is installed has no generic name: folders of users cannot hide packages of lacore."""

import os
import signal
import subprocess
import sys
import tomllib
from pkgutil import resolve_name

import pytest

import lacore as la
from lacore_verification.__main__ import main
from lacore_verification.harness.store.provenance import _sources
from tests.conftest import ROOT
from tests.processes import SOURCES, hear_ctrl_c
from tests.test_layers import PLACES

SOLVE = """
import lacore as la
block = la.masonry.stack([(1, 1)], 0.3)
problem = la.Problem({"block": block}, [la.BodyForce("block", (1, 0))],
                     [la.Fix("block", "base")], dead_loads=[la.BodyForce("block", (0, -1))])
print(la.solve(problem, "clarabel"))
"""


@pytest.fixture
def folder(tmp_path):
    """A folder of a user with packages of the names that the folders of the repository have."""
    for name in ("backends", "verification"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("raise RuntimeError('not of lacore')")
    (tmp_path / "work.py").write_text(SOLVE)
    return tmp_path


@pytest.mark.parametrize(
    ("command", "output"),
    [
        (("work.py",), "load factor 0.3"),
        (("-m", "lacore_verification", "conformance", "clarabel"), "0 FAIL"),
    ],
)
def test_folders_next_to_a_script_have_no_effect(folder, command, output):
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(SOURCES)}
    done = subprocess.run(
        [sys.executable, *command], cwd=folder, env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert output in done.stdout


def test_packages_and_command_have_names_of_their_own():
    pyproject = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    project, tool = pyproject["project"], pyproject["tool"]["setuptools"]
    assert tool["packages"]["find"]["include"] == ["lacore*"]
    assert resolve_name(project["scripts"]["lacore"]) is main
    assert all(
        target.startswith("lacore_backends.")
        for target in project["entry-points"]["lacore.backends"].values()
    )


@pytest.mark.skipif(os.name != "posix", reason="sends a signal")
def test_ctrl_c_during_the_start_exits_quietly():
    """Sent as soon as the first module of the command line is looked up."""
    code = """
import os, signal, sys

class Interrupted:
    def find_spec(name, path=None, target=None):
        if name == "lacore_verification.commands.cli":
            os.kill(os.getpid(), signal.SIGINT)

from lacore_verification.__main__ import main
sys.meta_path.insert(0, Interrupted)
main()
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, preexec_fn=hear_ctrl_c
    )
    assert (done.returncode, done.stdout, done.stderr) == (128 + signal.SIGINT, "", "")


def test_a_broken_backend_is_reported_with_its_error(monkeypatch):
    import lacore.solvers.registry
    from lacore.solvers.registry import Registered

    broken = Registered("broken", "no_such_module:Solver", "", own=True)
    found = {"broken": broken}, ()
    monkeypatch.setattr(lacore.solvers.registry, "_registered", lambda path: found)
    with pytest.raises(la.CapabilityError, match="ModuleNotFoundError: No module named"):
        la.find_backend("broken")


def test_the_version_of_the_code_is_that_of_all_packages():
    """Stored results are of other code as soon as a file of any of them changes."""
    named = [name for name, _ in _sources()]
    assert len(named) == len(set(named))
    assert set(named) == {
        path.relative_to(folder.parent).as_posix()
        for folder in PLACES.values()
        for path in folder.rglob("*.py")
    }
