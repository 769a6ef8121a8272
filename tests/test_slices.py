"""Slices of slow tests."""

from tests.slices import SLICES, Budget, slice_of, slice_of_today


def test_each_test_belongs_to_one_slice_and_slices_are_of_one_size():
    names = [f"tests/test_slices.py::test_it[{number}]" for number in range(3000)]
    counts = [[slice_of(name) for name in names].count(part) for part in range(SLICES)]
    assert sum(counts) == len(names)
    assert min(counts) > 0.6 * len(names) / SLICES
    assert max(counts) < 1.4 * len(names) / SLICES


def test_a_slice_does_not_depend_on_other_tests():
    assert slice_of("tests/test_slices.py::test_it") == slice_of("tests/test_slices.py::test_it")
    assert 0 <= slice_of_today() < SLICES


def test_a_budget_is_spent_when_its_time_is_over():
    assert not Budget(60.0).spent
    assert Budget(-1.0).spent
