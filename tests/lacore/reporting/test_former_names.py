"""Modules are imported by their former names, with a warning that names the new one."""

import subprocess
import sys
from importlib import import_module

import pytest

import lacore as la
from lacore import FORMER
from lacore.paths.steady import SteadyState
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from tests.lacore.pictures.readings import column

INSIDE = {
    "contact.obstacles": "model.contact.obstacles",
    "materials.conic_form": "model.materials.conic_form",
    "materials.criterion": "model.materials.criterion",
}


@pytest.mark.parametrize(("former", "new"), (FORMER | INSIDE).items())
def test_a_former_name_is_the_module_of_today(former, new, monkeypatch):
    former, new = f"lacore.{former}", f"lacore.{new}"
    monkeypatch.delitem(sys.modules, former, raising=False)
    with pytest.warns(DeprecationWarning, match="is now") as caught:
        module = import_module(former)
    assert module is import_module(new)
    assert module.__spec__.name == module.__name__ == new
    assert f"{former} is now {new}" in [str(warning.message) for warning in caught]
    import_module(former)  # warns once


def test_the_warning_is_one_of_the_line_that_imports():
    name = "lacore" + ".state"  # spelled so that no list of modules takes it for one
    code = f"import lacore\nfrom {name} import ProgramState\nimport {name}"
    message = f"{name} is now lacore.program.state"
    done = subprocess.run(
        [sys.executable, "-W", f"error:{message}", "-c", code],
        capture_output=True,
        text=True,
    )
    assert 'File "<string>", line 2' in done.stderr
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert shown.stderr.count(message) == 1
    assert shown.stderr.startswith("<string>:2: DeprecationWarning")


def test_an_argument_is_taken_by_its_former_name():
    problem = column((1, 1), 0.5)
    reactions = la.solve(problem).point.normal_reaction
    with pytest.warns(DeprecationWarning, match=r"solve\(normal_reaction=\)"):
        old = la.solve(problem, pressed=reactions)
    assert old.load_factor == pytest.approx(0.5, abs=1e-6)


def test_attributes_are_read_by_their_former_names():
    stability = la.solve(column((1, 1), 0.5)).stability()
    with pytest.warns(DeprecationWarning, match=r"Stability\.message"):
        assert stability.why == stability.message
    reason = Finding(Kind.NOT_STEADY, (), {"loads": "loads"})
    steady = SteadyState(False, None, 1.0, 0.1, 0.1, (reason,))
    with pytest.warns(DeprecationWarning, match="findings"):
        assert steady.finding is reason
