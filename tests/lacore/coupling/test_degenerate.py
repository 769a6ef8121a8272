"""Matrices and speeds at the edge of what they are made for: an answer or an error, no warning."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csr_matrix

import lacore as la
from lacore.coupling.blocks.matrix import Factor, Pattern
from lacore.coupling.faces import faces
from lacore.limit.conversion import point_in_program
from lacore.numerics.linear_algebra import SingularError
from lacore.program.kinematic import dimensionless


@pytest.mark.parametrize("value", [0.0, np.nan, np.inf])
def test_a_matrix_without_a_diagonal_is_singular(value):
    normal, tangential = csr_matrix(np.eye(2)), csr_matrix(np.eye(2))
    pattern = Pattern.of(normal, tangential, np.array([0, 1]), 1)
    entries = np.ones(pattern.sums.shape[1])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Factor(pattern, 2.0 + entries)
        with pytest.raises(SingularError):
            Factor(pattern, value * entries)


def test_a_body_at_rest_has_speeds_of_zero():
    state = la.solve(la.examples.column(friction=0.3))
    d = state.discretisation
    point = point_in_program(d, state.point)
    at_rest = replace(point, velocity=np.zeros_like(point.velocity))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        first = next(faces(dimensionless(d.program, d.natural), at_rest))
    assert np.all(np.isfinite(first.point.velocity))
