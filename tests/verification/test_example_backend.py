"""The example package is installed as a third party would install its own, and compared."""

import csv
import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "lacore-ecos"


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Run a Python module where the example is installed, far from the repository."""
    if importlib.util.find_spec("ecos") is None:
        pytest.skip("ecos has no wheel for this Python")
    folder = tmp_path_factory.mktemp("example")
    source, target = folder / "source", folder / "site"
    shutil.copytree(EXAMPLE, source)  # a build leaves its artefacts beside its sources
    path = os.pathsep.join([str(target), str(ROOT)])
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


def test_it_is_listed(run):
    listed = run("verification", "backends", "--json")
    assert listed.returncode == 0, listed.stderr
    assert '"ecos"' in listed.stdout
    assert "ECOS, exact second-order cone program" in listed.stdout


def test_it_is_compared(run, tmp_path):
    case, backends = "shear-patch", "ecos,clarabel"
    options = ["--backends", backends, "--meshes", "coarse", "--out", str(tmp_path)]
    compared = run("verification", "compare", case, *options)
    assert compared.returncode == 0, compared.stdout + compared.stderr
    with (tmp_path / "results.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["backend"] for row in rows] == ["ecos", "clarabel"] * 2
    assert {row["verdict"] for row in rows} == {"pass"}
    for ecos, clarabel in (rows[:2], rows[2:]):
        assert float(ecos["load_factor"]) == pytest.approx(float(clarabel["load_factor"]), rel=1e-7)


def test_it_conforms(run):
    """By its own test, one call."""
    tested = run("pytest", "-q", "-p", "no:cacheprovider", "source/tests")
    assert tested.returncode == 0, tested.stdout + tested.stderr
