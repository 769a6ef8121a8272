"""Sparse symmetric matrices of one pattern, with each solver that is installed."""

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given
from hypothesis import strategies as st

from lacore.numerics import symmetric
from lacore.numerics.linear_algebra import Gram, SingularError, SuperLU
from lacore.numerics.symmetric import factorised, fast_solver, symmetric_solver

SOLVERS = [solver for solver in (SuperLU, fast_solver()) if solver is not None]


def rows(rng, count, dim, n):
    return sp.random_array((count * dim, n), density=0.3, rng=rng, format="csr")


@given(st.integers(0, 1000), st.booleans())
def test_gram_is_the_sum_and_keeps_its_pattern(seed, cancels):
    rng = np.random.default_rng(seed)
    first, second = rows(rng, 5, 2, 12), rows(rng, 4, 1, 12)
    gram = Gram([first, second], [2, 1])
    blocks = [rng.normal(size=(5, 2, 2)), rng.normal(size=(4, 1, 1))]
    blocks[0] += blocks[0].transpose(0, 2, 1)
    if cancels:
        blocks[0][::2] = 0.0
    matrix = gram.matrix(blocks)
    plain = (
        first.T @ sp.block_diag(blocks[0]) @ first + second.T @ sp.block_diag(blocks[1]) @ second
    )
    np.testing.assert_allclose(matrix.toarray(), plain.toarray(), atol=1e-13)
    full = gram.matrix([np.ones((5, 2, 2)), np.ones((4, 1, 1))])
    assert np.array_equal(matrix.indices, full.indices)
    assert np.array_equal(matrix.indptr, full.indptr)


def laplacian(n, stiffness=1.0):
    matrix = sp.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(n, n)) * stiffness
    matrix = sp.csr_matrix(matrix)
    matrix.sort_indices()
    return matrix


@pytest.mark.parametrize("solver", SOLVERS)
def test_one_solver_takes_matrices_one_after_the_other(solver):
    """Of one pattern and of another; 1e-12: condition 1e3 of the Laplacian times round-off."""
    subject, right = solver(), np.linspace(-1, 1, 50)
    for matrix in (laplacian(50), laplacian(50, 1e6), laplacian(50), laplacian(20)):
        subject.factorise(matrix)
        given_right = right[: matrix.shape[0]]
        solution = subject.solve(given_right)
        assert np.abs(matrix @ solution - given_right).max() < 1e-12
    subject.close()


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("entry", [np.nan, np.inf])
def test_what_is_no_number_is_refused_before_it_is_factorised(solver, entry):
    """Looking for a pivot among such PARDISO writes beside its memory: processes end much later."""
    subject, matrix = solver(), laplacian(30)
    matrix.data[40] = entry
    with pytest.raises(SingularError, match="not a number"):
        subject.factorise(matrix)
    subject.factorise(laplacian(30))
    assert np.isfinite(subject.solve(np.ones(30))).all()
    subject.close()


@pytest.mark.parametrize("solver", SOLVERS)
def test_two_solvers_do_not_share_their_factors(solver):
    first, second, right = solver(), solver(), np.ones(30)
    first.factorise(laplacian(30))
    second.factorise(laplacian(30, 10.0))
    assert first.solve(right) == pytest.approx(10 * second.solve(right))
    second.close()
    first.factorise(laplacian(30))
    assert np.abs(laplacian(30) @ first.solve(right) - right).max() < 1e-12
    first.close()


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_singular_matrix_has_a_name(solver):
    singular = laplacian(10)
    singular.data[:] = 0.0
    with pytest.raises(SingularError, match=solver.name):
        solver().factorise(singular)


def test_without_the_extra_superlu_does_it(monkeypatch):
    monkeypatch.setattr(symmetric, "fast_solver", lambda: None)
    assert isinstance(symmetric_solver(), SuperLU)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("large", [10, 100])
def test_one_matrix_is_factorised_by_the_best_that_can(monkeypatch, sign, large):
    """With pivots of both signs PARDISO, which counts on positive ones, leaves it to SuperLU."""
    monkeypatch.setattr(symmetric, "_LARGE", large)
    matrix, right = laplacian(50), np.linspace(-1, 1, 50)
    matrix.data[-1] *= sign
    solver = factorised(matrix)
    assert np.abs(matrix @ solver.solve(right) - right).max() < 1e-12
    best = symmetric_solver().name if sign > 0 and large <= 50 else SuperLU.name
    assert solver.name == best
    solver.close()
