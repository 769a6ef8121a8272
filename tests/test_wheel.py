"""What pip installs is all of it: built, unpacked elsewhere, put to work from another folder."""

import os
import shutil
import subprocess
import sys

import pytest

from tests.conftest import ROOT

ROOMS = ("lacore", "lacore_start", "backends", "verification")
KINDS = (".py", ".pyi", ".typed", ".j2", ".toml", ".json")
SOURCES = ("pyproject.toml", "README.md", "LICENSE")


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """A folder with the packages as pip installs them, and how to run modules of it."""
    folder = tmp_path_factory.mktemp("wheel")
    source, target, empty = folder / "source", folder / "site", folder / "empty"
    # A copy: a build leaves its artefacts beside its sources, and finds those of an earlier one.
    source.mkdir()
    empty.mkdir()
    for name in ROOMS:
        shutil.copytree(ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in SOURCES:
        shutil.copy(ROOT / name, source)
    ours = {name: value for name, value in os.environ.items() if not name.startswith("PIP_")}
    environment = ours | {"PYTHONPATH": str(target), "PIP_CONFIG_FILE": os.devnull}

    def run(*command):
        return subprocess.run(
            [sys.executable, *command],
            env=environment,
            cwd=empty,
            capture_output=True,
            text=True,
        )

    options = ["--no-deps", "--no-build-isolation", "--no-index", "--no-cache-dir", "--no-compile"]
    made = run("-m", "pip", "install", *options, "--target", str(target), str(source))
    assert made.returncode == 0, made.stderr
    return target, run


def files(place):
    found = (file.relative_to(place) for room in ROOMS for file in (place / room).rglob("*"))
    return {file for file in found if file.suffix in KINDS}


@pytest.mark.slow
def test_every_room_is_in_it(installed):
    """Folders without `__init__.py` are left out, and so is what is no code and not named."""
    target, _ = installed
    there = files(ROOT)
    assert {file.suffix for file in there} == set(KINDS)
    assert files(target) == there


@pytest.mark.slow
def test_a_case_is_compared_by_it(installed, tmp_path):
    target, run = installed
    where = run("-c", "import lacore, verification; print(lacore.__file__, verification.__file__)")
    assert where.stdout.count(str(target)) == 2
    out = tmp_path / "out"
    options = ["--meshes", "coarse", "--backends", "clarabel,newton", "--out", str(out)]
    compared = run("-m", "lacore_start", "compare", "prandtl-punch", *options)
    assert compared.returncode == 0, compared.stdout + compared.stderr
    assert " 0 FAIL" in compared.stdout
    page = (out / "cases" / "prandtl-punch.html").read_text(encoding="utf-8")
    assert "<style>" in page
    assert "<script>" in page


@pytest.mark.slow
def test_cases_are_verified_by_it(installed):
    options = ["-q", "-p", "no:cacheprovider", "-k", "prandtl"]
    _, run = installed
    verified = run("-m", "pytest", "--pyargs", "verification", *options)
    assert verified.returncode == 0, verified.stdout + verified.stderr
    assert " passed" in verified.stdout
