"""No function has more branches than a reader can follow."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FOLDERS = ("lacore", "backends", "verification", "docs", "examples", "reports")
MOST_BRANCHES = 20


def branches(function):
    """Return the cyclomatic complexity as radon counts it, nested functions included."""
    return 1 + sum(map(_branches_at, ast.walk(function)))


def _branches_at(node):
    match node:
        case ast.For() | ast.AsyncFor() | ast.While():
            return 1 + bool(node.orelse)
        case ast.Try():
            return len(node.handlers) + bool(node.orelse)
        case ast.comprehension():
            return 1 + len(node.ifs)
        case ast.BoolOp():
            return len(node.values) - 1
        case ast.If() | ast.IfExp() | ast.Assert() | ast.match_case() | ast.Lambda():
            return 1
    return 0


@pytest.mark.parametrize("folder", FOLDERS)
def test_no_function_has_many_branches(folder):
    many = {
        f"{path.relative_to(ROOT)}: {node.name}": count
        for path in (ROOT / folder).rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        and (count := branches(node)) > MOST_BRANCHES
    }
    assert not many


def test_branches_are_counted():
    code = """
def function(values):
    def inner(x):
        return x if x > 0 and x < 1 else 0
    for value in values:
        if value or not values:
            continue
    else:
        assert values
    try:
        return [inner(x) for x in values if x]
    except ValueError:
        return None
"""
    assert branches(ast.parse(code).body[0]) == 11
