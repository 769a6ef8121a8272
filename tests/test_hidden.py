"""Folders and files of users with the names of our packages: real interpreters beside them."""

import os
import subprocess
import sys
import sysconfig
import tomllib
from pathlib import Path
from pkgutil import resolve_name

import pytest

import lacore as la
from lacore_start import PACKAGES, hidden, place
from lacore_start.__main__ import main
from tests.shares import one_in
from verification.commands import doctor

ROOT = Path(__file__).parents[1]
SOLVE = """
import lacore as la
block = la.masonry.stack([(1, 1)], 0.3)
problem = la.Problem({"block": block}, [la.BodyForce("block", (1, 0))],
                     [la.Fix("block", "base")], dead_loads=[la.BodyForce("block", (0, -1))])
print(la.solve(problem, BACKEND))
"""
CLARABEL = SOLVE.replace("BACKEND", "'clarabel'")
ISOLATED = SOLVE.replace("BACKEND", "'clarabel', process=la.SolverProcess()")
# As `pip install --editable` has it: found after all that is on the path.
EDITABLE = f"""
import sys
from importlib.machinery import PathFinder
from importlib.util import spec_from_file_location
from pathlib import Path

class Finder:
    def find_spec(name, path=None, target=None):
        file = Path({str(ROOT)!r}, name, "__init__.py")
        return spec_from_file_location(name, file) if file.is_file() else None

sys.meta_path.insert(sys.meta_path.index(PathFinder) + 1, Finder)
"""


def run(folder, *arguments, path=(ROOT,)):
    """An interpreter in a folder.

    Without `-S` an editable installation, if there is one, finds modules of ours also in a package
    of others that hides the one they are in; with it packages are where the path says.
    """
    if "-S" in arguments:
        path = (*path, *{sysconfig.get_path(name) for name in ("purelib", "platlib")})
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(map(str, path))}
    return subprocess.run(
        [sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True
    )


def hide(folder, name, text=""):
    """A package of that name in a folder, or a file where it ends so; what messages must name."""
    own = folder / name
    if own.suffix:
        own.write_text(text)
    else:
        own.mkdir()
        (own / "__init__.py").write_text(text)
    return own


def explains(text, own):
    return f"{own} hides the package" in text and "rename it" in text


@pytest.mark.parametrize(
    ("name", "how"),
    [
        ("backends", ("-S", "work.py")),
        pytest.param("backends.py", ("work.py",), marks=pytest.mark.slow),
        pytest.param("backends", ("-S", "-c", CLARABEL), marks=pytest.mark.slow),
        pytest.param("backends.py", ("-m", "work"), marks=pytest.mark.slow),
    ],
)
def test_solve_names_what_hides_the_backends(tmp_path, name, how):
    own = hide(tmp_path, name)
    (tmp_path / "work.py").write_text(CLARABEL)
    done = run(tmp_path, *how)
    assert done.returncode == 1
    last = done.stderr.strip().splitlines()[-1]
    assert "CapabilityError: backend 'clarabel' cannot be loaded" in last
    assert explains(last, own)


@pytest.mark.slow
def test_a_folder_without_python_hides_editable_packages_only(tmp_path):
    (tmp_path / "backends").mkdir()
    (tmp_path / "work.py").write_text(CLARABEL)
    assert "load factor 0.3" in run(tmp_path, "work.py").stdout
    (tmp_path / "work.py").write_text(EDITABLE + CLARABEL)
    done = run(tmp_path, "-S", "work.py", path=())
    assert explains(done.stderr, tmp_path / "backends")


@pytest.mark.parametrize("name", ["verification", "lacore"])
def test_the_command_line_names_what_hides_its_packages(tmp_path, name):
    own = hide(tmp_path, name)
    done = run(tmp_path, "-m", "lacore_start", "cases")
    assert (done.returncode, done.stdout) == (2, "")
    assert explains(done.stderr, own)
    assert "Traceback" not in done.stderr
    # Elsewhere, but by PYTHONPATH, as the console script is started.
    done = run(ROOT.parent, "-P", "-m", "lacore_start", "cases", path=(tmp_path, ROOT))
    assert done.returncode == 2
    assert explains(done.stderr, own)


def test_the_command_line_says_that_no_backend_can_be_loaded(tmp_path):
    own = hide(tmp_path, "backends.py")
    done = run(tmp_path, "-m", "lacore_start", "conformance", "clarabel")
    assert done.returncode == 2
    assert explains(" ".join(done.stderr.split()), own)


def test_the_installed_command_is_the_one_that_looks():
    """It must not lie in a package that may be hidden."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    command = project["scripts"]["lacore"]
    assert resolve_name(command) is main
    assert command.partition(".")[0] not in PACKAGES


@pytest.mark.parametrize("name", one_in(2, ["backends.py", "lacore.py"]))
def test_child_processes_name_what_hides_packages_from_them(tmp_path, name):
    """The folder is changed after ours are loaded: the process that is started finds others."""
    own = hide(tmp_path, name)
    ours = "import os, lacore as la; la.find_backend('clarabel'); la.solve"
    done = run(ROOT.parent, "-c", f"{ours}; os.chdir({str(tmp_path)!r})\n{ISOLATED}")
    assert explains(done.stdout + done.stderr, own)


@pytest.mark.slow
def test_tests_of_users_say_it_too(tmp_path):
    own = hide(tmp_path, "backends.py")
    (tmp_path / "test_mine.py").write_text(f"def test_mine():\n    exec({CLARABEL!r}, {{}})\n")
    done = run(tmp_path, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--color=no")
    assert done.returncode == 1
    assert explains(done.stdout, own)


def test_nothing_is_hidden_here():
    assert hidden() == ""
    for name in PACKAGES:
        own = place(name)
        assert own.ours
        assert Path(own.path).name == name
        assert own.fix == ""


def test_a_package_that_is_nowhere_is_missing(monkeypatch):
    monkeypatch.setattr(sys, "meta_path", [])
    monkeypatch.delitem(sys.modules, "backends", raising=False)
    assert "install lacore again" in place("backends").fix
    assert hidden("backends") == ""  # nothing hides it


def test_packages_of_others_are_none_of_ours(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    hide(tmp_path, "numpy_of_mine")
    assert hidden("numpy_of_mine", "numpy") == ""


def test_the_doctor_shows_where_each_is_and_what_hides_it(tmp_path, monkeypatch):
    found = {record["package"]: record for record in doctor.places()}
    assert list(found) == ["lacore", "backends", "verification"]
    for name, record in found.items():
        assert Path(record["loaded_from"]) == Path(resolve_name(name).__file__).parent
        assert record["remedy"] == ""
    own = hide(tmp_path, "verification")
    monkeypatch.chdir(tmp_path)
    *others, last = doctor.places()
    assert last["remedy"].startswith("for scripts in this folder ")
    assert explains(last["remedy"], own)
    assert not any(record["remedy"] for record in others)
    monkeypatch.setattr(doctor, "all_backends", lambda: iter(()))
    assert not doctor.examine(lambda _: None)["healthy"]


def test_a_backend_of_others_that_fails_is_told_as_it_is(monkeypatch):
    import lacore.solvers.registry
    from lacore.solvers.registry import Registered

    broken = Registered("broken", "no_such_module:Solver", "", own=True)
    found = {"broken": broken}, ()
    monkeypatch.setattr(lacore.solvers.registry, "_registered", lambda path: found)
    with pytest.raises(la.CapabilityError, match="ModuleNotFoundError: No module named"):
        la.find_backend("broken")
