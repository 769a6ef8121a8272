"""The source distribution and the wheel contain what they should, and work elsewhere.

Both are built from a copy of the repository, the wheel from the unpacked source distribution as
``python -m build`` does. The wheel is installed with its dependencies for each Python version that
pyproject.toml names and this machine has, on PATH or in pyenv.
"""

import json
import math
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from email.parser import Parser
from pathlib import Path

import pytest

import lacore as la
from lacore.reporting.errors import DISTRIBUTION
from tests.conftest import ROOT

PLACES = {"lacore": ".", "lacore_backends": "backends", "lacore_verification": "verification"}
"""Packages of the wheel, and the folders of the repository that contain them."""
KINDS = (".py", ".pyi", ".typed", ".j2", ".toml", ".json", ".txt")
STEM = f"{DISTRIBUTION.replace('-', '_')}-{la.__version__}"
BUILD = "import sys; from setuptools import build_meta; build_meta.build_sdist(sys.argv[1])"
NO_INDEX = ("--no-deps", "--no-build-isolation", "--no-index", "--no-cache-dir")
OWN_TESTS = (
    *("tests/test_docs.py", "tests/test_prose.py", "tests/test_set_up.py", "tests/test_readme.py"),
    *("tests/lacore/reporting/test_errors.py", "tests/lacore/files/problem/test_reading.py"),
    *("tests/verification/catalogue", "tests/verification/report/test_reference_report.py"),
)
"""A sample that reads pages, examples, constraints, the Makefile and the reference report."""


def _unwanted(folder, names):
    """What is not copied: hidden files, and what builds and commands have written."""
    if Path(folder) == ROOT / "reports":
        return {*names} - {"reference"}
    written = {"__pycache__", "build", "dist"}
    return {n for n in names if n in written or n.startswith(".") or n.endswith(".egg-info")}


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """A copy of the repository, because a build writes into the folder that it reads."""
    folder = tmp_path_factory.mktemp("source") / "copy"
    shutil.copytree(ROOT, folder, ignore=_unwanted)
    return folder


@pytest.fixture(scope="module")
def sdist(source, tmp_path_factory):
    """The folder of the unpacked source distribution."""
    folder = tmp_path_factory.mktemp("sdist")
    run(sys.executable, "-c", BUILD, str(folder), at=source)
    with tarfile.open(folder / f"{STEM}.tar.gz") as archive:
        archive.extractall(folder, filter="data")
    return folder / STEM


@pytest.fixture(scope="module")
def wheel(sdist, tmp_path_factory):
    """The wheel, built from the source distribution."""
    folder = tmp_path_factory.mktemp("wheel")
    own = shutil.copytree(sdist, folder / "source")
    options = [*NO_INDEX, "-w", str(folder), str(own)]
    run(sys.executable, "-m", "pip", "wheel", *options, at=folder, PIP_CONFIG_FILE=os.devnull)
    return folder / f"{STEM}-py3-none-any.whl"


def run(*command, at, **more):
    """Run what must go well, away from the repository."""
    ours = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(command, env=ours | more, cwd=at, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """A folder with the packages as pip installs them, and how to run modules of it."""
    target, empty = tmp_path_factory.mktemp("site"), tmp_path_factory.mktemp("empty")
    options = ["--no-deps", "--no-index", "--no-cache-dir", "--no-compile"]
    install = [sys.executable, "-m", "pip", "install", *options, "--target", str(target)]
    run(*install, str(wheel), at=empty, PIP_CONFIG_FILE=os.devnull)
    return target, lambda *command: run(sys.executable, *command, at=empty, PYTHONPATH=str(target))


def files(places):
    """Files of our packages by their names in a wheel; `places`: package, and where it lies."""
    found = (
        file.relative_to(place) for name, place in places for file in (place / name).rglob("*")
    )
    return {file for file in found if file.suffix in KINDS}


@pytest.mark.slow
def test_the_source_distribution_is_complete(source, sdist):
    """It contains every file of the repository that is not hidden."""
    there = {file.relative_to(sdist) for file in sdist.rglob("*") if file.is_file()}
    wanted = {file.relative_to(source) for file in source.rglob("*") if file.is_file()}
    assert {file for file in wanted - there if "egg-info" not in str(file)} == set()


@pytest.mark.slow
def test_the_wheel_contains_our_packages_and_no_tests(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    assert {name.partition("/")[0] for name in names} == {*PLACES, f"{STEM}.dist-info"}
    assert [name for name in names if re.search(r"(^|/)(test_\w*|conftest)\.py$", name)] == []


@pytest.mark.slow
def test_the_metadata_of_the_wheel_state_name_and_version(wheel):
    with zipfile.ZipFile(wheel) as archive:
        text = archive.read(f"{STEM}.dist-info/METADATA").decode()
    metadata = Parser().parsestr(text, headersonly=True)
    assert metadata["Name"] == DISTRIBUTION
    assert metadata["Version"] == la.__version__
    assert metadata["License-Expression"] == PROJECT["license"]


@pytest.mark.slow
def test_every_package_is_complete_in_the_wheel(installed):
    """Setuptools leaves out folders without `__init__.py` and data files that nothing names."""
    target, _ = installed
    there = files([(name, ROOT / folder) for name, folder in PLACES.items()])
    assert {file.suffix for file in there} == set(KINDS)
    assert files([(name, target) for name in PLACES]) == there


@pytest.mark.slow
def test_a_case_is_compared_by_it(installed, tmp_path):
    target, run = installed
    where = run(
        "-c", "import lacore, lacore_verification as cases; print(lacore.__file__, cases.__file__)"
    )
    assert where.stdout.count(str(target)) == 2
    out = tmp_path / "out"
    options = ["--meshes", "coarse", "--backends", "clarabel,newton", "--out", str(out)]
    compared = run("-m", "lacore_verification", "compare", "prandtl-punch", *options)
    assert " 0 FAIL" in compared.stdout
    page = (out / "cases" / "prandtl-punch.html").read_text(encoding="utf-8")
    assert "<style>" in page
    assert "<script>" in page


@pytest.mark.slow
def test_cases_are_verified_by_it(installed):
    options = ["-q", "-p", "no:cacheprovider", "-k", "prandtl"]
    _, run = installed
    verified = run("-m", "pytest", "--pyargs", "lacore_verification.case_checks", *options)
    assert " passed" in verified.stdout


PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
VERSIONS = re.findall(r"Python :: (3\.\d+)", " ".join(PROJECT["classifiers"]))
HERE = "{}.{}".format(*sys.version_info)
FIRST_STEPS = """
import json
import sys
from importlib.metadata import packages_distributions

before = set(sys.modules)
import lacore as la

loaded = {name.partition(".")[0] for name in sys.modules.keys() - before}
loaded &= packages_distributions().keys()
stack = la.masonry.stack([(1, 1)], 0.3)
pushed = la.Problem(
    {"stack": stack},
    [la.BodyForce("stack", (1, 0))],
    [la.Fix("stack", "base")],
    dead_loads=[la.BodyForce("stack", (0, -1))],
)

def pressed(material):
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    return la.Problem(
        {"block": la.Body(mesh, material)},
        [la.Traction("block", "top", (0, -1))],
        [la.Fix("block", "left", "x"), la.Fix("block", "bottom", "y")],
    )

dome = la.masonry3d.dome(
    meridians=8, rings=4, radius=1.0, thickness=0.15, oculus=0.25, friction=0.5
)
springing = tuple(name for name in dome.names if name.startswith("base"))
shaken = la.Problem(
    {"dome": dome},
    [la.BodyForce("dome", (1, 0, 0))],
    [la.Fix("dome", springing)],
    dead_loads=[la.BodyForce("dome", (0, 0, -1))],
)
state = la.solve(shaken)
bracket = la.bracket(pressed(la.VonMises(shear_strength=1.0)), 0.01, jobs=1)
soil = pressed(la.MohrCoulomb(1.0, 30.0))
print(json.dumps({
    "where": la.__file__,
    "imported": sorted(loaded),
    "stack": la.solve(pushed).load_factor,
    "bracket": [bracket.lower, bracket.upper],
    "soil": [la.lower_bound(soil).load_factor, la.upper_bound(soil).load_factor],
    "dome": [state.load_factor, la.solve(shaken, coupling="associated").load_factor],
    "dome holds": bool(state.certificate.holds(1e-6)),
}))
"""


def python_of(version):
    """An interpreter of a version that runs; None where there is none."""
    versions = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    named = [found for found in [shutil.which(f"python{version}")] if found]
    for path in [sys.executable, *named, *map(str, versions.glob(f"{version}.*/bin/python"))]:
        code = "import sys, venv, ensurepip; print('{}.{}'.format(*sys.version_info))"
        asked = subprocess.run([path, "-c", code], capture_output=True, text=True)
        if asked.returncode == 0 and asked.stdout.strip() == version:
            return path
    return None


def test_this_python_is_one_of_those_that_are_named():
    least = re.fullmatch(r">=(3\.\d+)", PROJECT["requires-python"])
    assert VERSIONS[0] == least[1]
    assert HERE in VERSIONS
    assert python_of(HERE) == sys.executable


@pytest.fixture(scope="module", params=VERSIONS)
def clean(request, wheel, tmp_path_factory):
    """The folder of commands of a new environment: the wheel, and what pip takes with it."""
    python = python_of(request.param)
    if python is None:
        pytest.skip(f"there is no Python {request.param} here")
    folder = tmp_path_factory.mktemp("clean")
    run(python, "-m", "venv", "env", at=folder)
    commands = folder / "env" / ("Scripts" if os.name == "nt" else "bin")
    pip = [str(commands / "python"), "-m", "pip"]
    pins = ["--constraint", str(ROOT / "constraints.txt")]
    run(*pip, "install", "--quiet", "--no-compile", *pins, str(wheel), at=folder)
    assert "No broken requirements" in run(*pip, "check", at=folder).stdout
    return commands


@pytest.mark.slow
def test_first_steps_in_a_clean_environment(clean, tmp_path):
    """A solve, a bracket, a soil, a dome; before them nothing is loaded but what is called."""
    done = run(str(clean / "python"), "-c", FIRST_STEPS, at=tmp_path)
    told = json.loads(done.stdout)
    assert Path(told["where"]).is_relative_to(clean.parent)
    assert told["imported"] == ["lacore", "lazy_loader"]
    # It slides: tolerances of solvers, 1e-6 of the load.
    assert told["stack"] == pytest.approx(0.3, rel=1e-6)
    # A homogeneous field is in every space: round-off, and what bounds keep as a margin.
    exact = {"bracket": 2.0, "soil": 2 * math.cos(math.pi / 6) / (1 - math.sin(math.pi / 6))}
    for name, value in exact.items():
        low, high = told[name]
        assert low <= value * (1 + 1e-9)
        assert high >= value * (1 - 1e-9)
        assert high - low < 0.01 * value
    coulomb, associated = told["dome"]
    assert told["dome holds"]
    assert 0 < coulomb <= associated * (1 + 1e-6)  # T14, to the tolerance of both


@pytest.mark.slow
def test_the_source_distribution_passes_its_tests(sdist, wheel, tmp_path_factory):
    """In a new environment with the wheel and its optional dependencies for developers."""
    folder = tmp_path_factory.mktemp("tested")
    source = shutil.copytree(sdist, folder / "source")
    run(sys.executable, "-m", "venv", "env", at=folder)
    python = str(folder / "env" / ("Scripts" if os.name == "nt" else "bin") / "python")
    pins = ["--constraint", str(source / "constraints.txt")]
    install = [python, "-m", "pip", "install", "--quiet", "--no-compile", *pins]
    run(*install, f"{wheel}[dev]", at=folder)
    tested = run(python, "-m", "pytest", "-q", *OWN_TESTS, at=source)
    assert " passed" in tested.stdout


@pytest.mark.slow
def test_the_command_in_a_clean_environment(clean, tmp_path):
    command = str(clean / "lacore")
    assert "Usage: lacore" in run(command, "--help", at=tmp_path).stdout
    cases = ["prandtl-punch", "platens-soil:associated", "dome-plain-8x4"]
    options = ["--meshes", "coarse", "--backends", "clarabel", "--jobs", "1", "--out", "out"]
    compared = run(command, "compare", *cases, *options, at=tmp_path)
    assert " 0 FAIL" in compared.stdout
    assert (tmp_path / "out" / "index.html").is_file()
