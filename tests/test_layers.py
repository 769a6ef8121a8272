"""The rooms of the house and who may enter which (DESIGN)."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
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


def test_import_lacore_loads_neither_plots_nor_solvers():
    heavy = ("matplotlib", "backends", "verification", *SOLVERS)
    code = f"import sys, lacore; print([m for m in {heavy} if m in sys.modules])"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"
