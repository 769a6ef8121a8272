"""Errors that `make mutants` injects: each is one change, and fits the sources of today."""

import ast
from pathlib import Path

import pytest

from tests.mutants.mutants import PACKAGES, StaleError, _known, generated, known
from tests.mutants.order import Ran, changed_lines, ordered
from tests.mutants.sites import edits

ROOT = Path(__file__).parents[1]


def changed(source):
    return {edit.apply(source.encode()).decode() for edit in edits(source.encode())}


@pytest.mark.parametrize(
    ("source", "errors"),
    [
        ("a < b", {"a > b"}),
        ("a is not b", {"a is b"}),
        ("a + b", {"a - b", "a"}),
        ("a * b", {"a / b"}),
        ("-a", {"(a)"}),
        ("a and b", {"a or b", "(a)", "(b)"}),
        ("np.maximum(a, b)", {"np.minimum(a, b)"}),
        ("np.abs(a)", {"(a)"}),
        ("_SMALL = 1e-6", {"_SMALL = 0.001"}),
        ("_SWEEPS = 3", {"_SWEEPS = 1"}),
        ("def f(a):\n    if a:\n        return 1", {"def f(a):\n    if False:\n        return 1"}),
        ("'é' if a > b else c", {"'é' if a < b else c"}),  # columns count bytes
        ("def f(a: int | None = 2.0): ...", set()),
        ("np.where(a, b, 1.0)", set()),
        ("np.where(a, b, 3.0)", {"np.where(a, b, 3000.0)"}),
        ("np.full(n, -1.0)", set()),
        ("_TRIED = (1.0, 2.0)", set()),
        ("_SHARES: tuple[float, ...] = (0.1, 0.2)", set()),
        ("_GOOD, _MOST = 1.0, 2.0", {"_GOOD, _MOST = 1000.0, 2.0", "_GOOD, _MOST = 1.0, 2000.0"}),
        ("np.full(n, -2.0)", {"np.full(n, (2.0))", "np.full(n, -2000.0)"}),
        ("a.max(initial=0.0)", {"a.min(initial=0.0)"}),
        ("raise InputError('a' + b)", set()),
        ("def facts(a):\n    return a + b", set()),
    ],
)
def test_each_error_is_one_change(source, errors):
    assert changed(source) == errors


def test_the_list_fits_the_sources():
    mutants = known(ROOT)
    for mutant in mutants:
        assert ast.parse(mutant.source)
        assert mutant.source != (ROOT / mutant.path).read_bytes()
        assert all((ROOT / test).exists() for test in mutant.tests), mutant
    assert len({mutant.key for mutant in mutants}) == len(mutants)


def test_an_entry_whose_code_has_changed_is_named():
    with pytest.raises(StaleError, match=r"file = 'surfaces\.py': 0 of \d+ files"):
        _known(ROOT, "surfaces.py", "no such text", "", "")


def test_a_seed_draws_the_same_errors():
    one, other = (generated(ROOT, 20, 3, only="claims") for _ in range(2))
    assert [mutant.key for mutant in one] == [mutant.key for mutant in other]
    assert len({mutant.key for mutant in one}) == 20
    for mutant in one:
        assert ast.parse(mutant.source)
        assert mutant.tests == ("tests/lacore/coupling/claims",)


@pytest.mark.parametrize("package", PACKAGES, ids=str)
def test_each_package_has_errors_and_tests(package):
    assert (ROOT / package).exists()
    (mutant,) = generated(ROOT, 1, 0, only=str(package))
    assert all((ROOT / test).exists() for test in mutant.tests), mutant


SOURCE = b"""_SMALL = 1.0


def f(a):
    if a > _SMALL:
        return a
    return (
        a
        + 1
    )
"""


@pytest.mark.parametrize(
    ("original", "changed", "lines"),
    [
        (b"1.0", b"2.0", {1}),
        (b"a >", b"a <", {5}),
        (b"return a\n", b"return 2\n", {6}),
        (b"+ 1", b"- 1", {7, 8, 9, 10}),
        (b"        + 1\n", b"", {7, 8, 9, 10}),
        (b"return a\n    return", b"return b\n    yield", {6, 7}),
    ],
)
def test_a_change_belongs_to_a_statement(original, changed, lines):
    assert set(changed_lines(SOURCE, SOURCE.replace(original, changed))) == lines


def test_tests_that_run_the_statement_are_the_first_ones():
    tests = [
        Ran("a.py::others", 1.0, {"f.py": frozenset({5, 6})}),
        Ran("a.py::slow", 9.0, {"f.py": frozenset({5, 7})}),
        Ran("b.py::quick", 2.0, {"f.py": frozenset({9})}),
        Ran("c.py::branch", 1.0, {"f.py": frozenset({5, 6})}),
        Ran("d.py::elsewhere", 1.0, {"g.py": frozenset({7})}),
    ]

    def names(changed):
        return [own.test for own in ordered(tests, "f.py", SOURCE, SOURCE.replace(*changed))]

    first = ["b.py::quick", "a.py::slow"]
    assert names((b"+ 1", b"- 1")) == [*first, "a.py::others"]
    assert sorted(names((b"1.0", b"2.0"))) == sorted(own.test for own in tests[:4])
