"""Supports and footings as a basis of the free velocities."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from lacore.model.conditions.elimination import NodeConditions, free_basis, held, join

ANGLES = [0.0, np.pi / 2, 0.3, 0.3 + np.pi, -1.1]  # 0.3 and 0.3 + pi: one line, two senses


def direction(angle):
    return np.array([np.cos(angle), np.sin(angle)])


@st.composite
def conditions(draw):
    """Supports anywhere; at most one footing a node, on nodes that no support touches."""
    n_nodes, n_footings = draw(st.integers(1, 6)), draw(st.integers(0, 2))
    motions = [direction(draw(st.floats(0, 6.3))) for _ in range(n_footings)]
    rows = []
    for node in range(n_nodes):
        angles = draw(st.lists(st.sampled_from(ANGLES), max_size=3))
        footing = draw(st.integers(-1, n_footings - 1))
        for angle in angles:
            d = direction(angle)
            rows.append((node, d, footing, d @ motions[footing] if footing >= 0 else 0.0))
    return (
        NodeConditions(
            np.array([r[0] for r in rows], dtype=np.int64),
            np.array([r[1] for r in rows]).reshape(-1, 2),
            np.array([r[2] for r in rows], dtype=np.int64),
            np.array([r[3] for r in rows], dtype=float),
        ),
        n_nodes,
        n_footings,
    )


def matrix(given_conditions, n_nodes, n_footings):
    """The conditions as rows over all unknowns, written out one by one."""
    c = given_conditions
    rows = np.zeros((c.nodes.size, 2 * n_nodes + n_footings))
    for row, (node, d, footing, factor) in enumerate(
        zip(c.nodes, c.directions, c.footing, c.factors, strict=True)
    ):
        rows[row, [node, n_nodes + node]] = d
        if footing >= 0:
            rows[row, 2 * n_nodes + footing] = -factor
    return rows


def numbering(n_nodes):
    return np.arange(2 * n_nodes).reshape(2, n_nodes)


@given(conditions())
def test_columns_satisfy_all_conditions_and_span_them(drawn):
    c, n_nodes, n_footings = drawn
    basis = free_basis(c, numbering(n_nodes), [f"f{i}" for i in range(n_footings)]).toarray()
    rows = matrix(c, n_nodes, n_footings)
    # Directions are at least 0.17 rad apart or parallel: 2 x 2 solves lose two digits at most.
    assert np.abs(rows @ basis).max(initial=0.0) < 1e-13
    # Dimension: unknowns less independent conditions; singular values are above 0.1 or round-off.
    rank = np.linalg.matrix_rank(rows, tol=1e-9) if rows.size else 0
    assert basis.shape[1] == 2 * n_nodes + n_footings - rank
    assert np.linalg.matrix_rank(basis, tol=1e-9) == basis.shape[1]


@given(motion=st.floats(0, 6.3))
def test_a_support_across_a_footing_that_moves_along_it_is_no_conflict(motion):
    """A support along d and a footing moving across d: both hold."""
    m = direction(motion)
    across = np.array([-m[1], m[0]])
    moved = NodeConditions(np.array([0]), m[None], np.array([0]), np.array([1.0]))
    basis = free_basis(join([moved, held(np.array([0]), across[None])]), numbering(1), ["f"])
    assert basis.shape == (3, 1)
    assert np.allclose(basis.toarray()[:, 0], [*m, 1.0], atol=1e-14)


@pytest.mark.parametrize("angle", [0.0, 0.5])
def test_conflict_with_a_support_names_the_footing(angle):
    m = direction(angle)[None]
    node = np.array([0])
    c = join([NodeConditions(node, m, np.array([1]), np.array([1.0])), held(node, -m)])
    with pytest.raises(la.InputError, match=r"RigidFooting = 'soil: right'.*keeps it from moving"):
        free_basis(c, numbering(1), ["soil: left", "soil: right"])


def test_conflict_of_two_footings():
    node, d = np.array([0]), np.array([[0.0, 1.0]])
    c = join([NodeConditions(node, d, np.array([f]), np.array([1.0])) for f in (0, 1)])
    with pytest.raises(la.InputError, match="another footing"):
        free_basis(c, numbering(1), ["a", "b"])


def test_nothing_held():
    basis = free_basis(join([]), numbering(3), [])
    assert np.array_equal(basis.toarray(), np.eye(6))
