"""The rooms of the house and who may enter which (DESIGN)."""

import ast
import re
import subprocess
import sys
import tomllib
from importlib.metadata import packages_distributions
from itertools import chain
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ROOMS = ("lacore", "lacore_start", "backends", "verification")
SOLVERS = ("casadi", "clarabel", "cvxpy", "ecos", "highspy", "mosek", "osqp", "qoco", "scs")


def imports(path):
    """Top-level packages and full names that a file imports, wherever in the file."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: a relative import"
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def files(folder):
    found = sorted((ROOT / folder).rglob("*.py"))
    assert found, f"no files in {folder}: the check would be empty"
    return [pytest.param(path, id=str(path.relative_to(ROOT))) for path in found]


def within(name, package):
    return name == package or name.startswith(f"{package}.")


@pytest.mark.parametrize("path", files("lacore"))
def test_the_core_knows_no_solver_and_no_case(path):
    banned = ("backends", "verification", *SOLVERS)
    assert not [name for name in imports(path) if any(within(name, b) for b in banned)]


@pytest.mark.parametrize("path", files("backends"))
def test_a_backend_knows_the_core_only(path):
    """And private modules beside it, which are no backends: what several share exists once."""
    banned = ("backends", "verification", "skfem", "matplotlib")
    names = [name for name in imports(path) if not name.startswith("backends._")]
    assert not [name for name in names if any(within(name, b) for b in banned)]


@pytest.mark.parametrize("path", files("verification/cases"))
def test_a_case_knows_no_backend(path):
    banned = ("backends", *SOLVERS)
    assert not [name for name in imports(path) if any(within(name, b) for b in banned)]


def test_the_start_knows_the_standard_library_only():
    """It speaks of our packages where they cannot be imported, and opens the command line."""
    names = {name for path in (ROOT / "lacore_start").glob("*.py") for name in imports(path)}
    ours = {"lacore_start", "lacore_start.hidden", "verification.cli", "verification.cli.main"}
    assert not {name.partition(".")[0] for name in names - ours} - sys.stdlib_module_names


HEAVY = (
    *("matplotlib", "pandas", "scipy", "skfem", "shapely", "meshio", "pypardiso", "PIL"),
    *("cvxpy", "casadi", "clarabel", "highspy", "dask", "distributed"),
    *("playwright", "jinja2", "rich", "IPython"),
)
"""What takes a tenth of a second or more to load; together they take several."""


@pytest.mark.parametrize(
    ("code", "more"),
    [
        ("import lacore", ("numpy", "lacore.errors", "backends", "verification")),
        ("import lacore.process.child_process", ("numpy", "backends", "verification")),
        ("import lacore.process.isolation", ("pandas", "skfem", "backends", "verification")),
        ("import lacore as la; dir(la); la.InputError; la.Status", ("lacore.solving",)),
        ("import verification", ("numpy", "lacore", "backends")),
    ],
)
def test_names_load_what_they_need_only(code, more):
    banned = [*more, *(name for name in HEAVY if "isolation" not in code or name != "scipy")]
    assert loaded_of(code, banned) == []


@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        ["compar"],
        ["compare", "--help"],
        ["compare", "prandl-punch"],
        ["verify", "prandl-punch"],
        ["sweep", "wall-9", "--vary", "mu=0.1,0.2"],
        ["manual", "prandl-punch"],
        ["fuzz", "--help"],
    ],
    ids=" ".join,
)
def test_help_and_slips_of_the_keyboard_load_nothing_that_solves_or_draws(arguments):
    call = f"""
try:
    from verification.cli import main
    main({arguments!r})
except SystemExit:
    pass"""
    banned = [*HEAVY, "backends", "lacore.solving", "verification.execution"]
    assert loaded_of(call, [*banned, "verification.cases.prandtl_punch"]) == []


def test_every_name_that_lacore_promises_is_there():
    """Also where a function has the name of its module, and that was imported before."""
    code = """
import lacore.coulomb_range, lacore.gap_identity, lacore.sequential
import lacore as la
from types import ModuleType
found = {name: getattr(la, name) for name in la.__all__}
print(sorted(name for name, value in found.items() if isinstance(value, ModuleType)))
"""
    assert printed_by(code) == "['hardening', 'masonry', 'meshes']"


def loaded_of(code, banned):
    """Which of some modules a fresh interpreter has loaded after running code."""
    asked = f"import sys; print([name for name in {banned!r} if name in sys.modules])"
    return ast.literal_eval(printed_by(f"{code}\n{asked}").splitlines()[-1])


def printed_by(code):
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    return run.stdout.strip()


@pytest.mark.parametrize("room", ROOMS)
def test_what_is_imported_is_installed_with_us(room):
    """Packages of others are named in pyproject.toml; this environment may have them by luck."""
    stated = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lines = [*stated["dependencies"], *chain(*stated["optional-dependencies"].values())]
    named = {_normal(re.split(r"[^\w.-]", line)[0]) for line in lines}
    owners = packages_distributions()
    missing = {
        f"{path.relative_to(ROOT)}: {top}"
        for path in (ROOT / room).rglob("*.py")
        for top in {name.split(".")[0] for name in imports(path)}
        if top not in (*sys.stdlib_module_names, *ROOMS)
        and not named & set(map(_normal, owners.get(top, [top])))
    }
    assert not missing


def _normal(distribution):
    return distribution.lower().replace("_", "-")
