"""What `make` would install before a command: what it needs, once."""

import os
import shutil
import subprocess

import pytest

from tests.conftest import ROOT

pytestmark = pytest.mark.skipif(shutil.which("make") is None, reason="make is not installed")
SOLVES, TESTS = "--editable '.'", "--editable '.[dev]'"


@pytest.fixture
def clone(tmp_path):
    for name in ("Makefile", "pyproject.toml", "constraints.txt", "README.md"):
        shutil.copy(ROOT / name, tmp_path)
    return tmp_path


def told(clone, *targets):
    done = subprocess.run(
        ["make", "--dry-run", *targets], cwd=clone, capture_output=True, text=True, check=True
    )
    return done.stdout


def stands(clone, mark):
    (clone / ".venv").mkdir(exist_ok=True)
    (clone / ".venv" / mark).touch()


@pytest.mark.parametrize("target", ["compare", "verify", "fuzz"])
def test_who_solves_installs_no_tools_of_developers(clone, target):
    assert SOLVES in told(clone, target)
    assert TESTS not in told(clone, target)
    stands(clone, ".runtime")
    assert "pip install" not in told(clone, target)


@pytest.mark.parametrize("target", ["test", "lint"])
def test_who_tests_installs_them(clone, target):
    assert TESTS in told(clone, target)
    stands(clone, ".runtime")
    assert TESTS in told(clone, target)
    stands(clone, ".ready")
    assert "pip install" not in told(clone, target)


def test_the_environment_of_developers_solves_too(clone):
    stands(clone, ".ready")
    assert "pip install" not in told(clone, "compare")
    later = (clone / ".venv" / ".ready").stat().st_mtime + 10
    os.utime(clone / "pyproject.toml", (later, later))
    assert TESTS in told(clone, "compare")


def test_long_steps_are_announced(clone):
    steps = told(clone, "compare")
    for message, step in (
        ("Creating", "-m venv"),
        ("Installing", "-m pip"),
        ("Comparing", "lacore compare"),
    ):
        assert steps.index(message) < steps.index(step)


def test_help_begins_with_compare_and_test():
    done = subprocess.run(
        ["make", "--no-print-directory", "help"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    assert [line.split()[1] for line in done.stdout.splitlines()[:2]] == ["compare", "test"]
