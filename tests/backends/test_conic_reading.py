"""The kinematic program read a second time, by cvxpy: a check of our own conic assembly."""

import cvxpy as cp
import numpy as np
import pytest

import lacore as la
from lacore.program import associated_contact, dimensionless, reaction_contact
from tests.lacore.models import deformable_block, punch


def load_factor(program, contact):
    """T6, word for word."""
    u = cp.Variable(program.n)
    cost = -program.dead_load @ u
    constraints = [program.reference_load @ u == 1]
    for group in program.groups:
        lengths = cp.norm(cp.reshape(group.rows @ u, (group.dim, -1), order="F"), axis=0)
        cost += (group.weights * group.bound) @ lengths
        constraints.append(group.volumetric @ u == 0)
    rows = program.contact
    if rows.count:
        slip = cp.norm(cp.reshape(rows.tangential @ u, (rows.tangent_dim, -1), order="F"), axis=0)
        cost += (rows.weights * contact.bound) @ slip
        constraints.append(rows.normal @ u + contact.shift >= cp.multiply(contact.dilatancy, slip))
    problem = cp.Problem(cp.Minimize(cost), constraints)
    problem.solve(solver=cp.CLARABEL)
    return problem.value


@pytest.mark.parametrize("coupling", ["reaction", "associated"])
@pytest.mark.parametrize(
    "problem",
    [punch(rough=True), punch(rough=False), deformable_block(0.5), deformable_block(0.9)],
    ids=["rough punch", "smooth punch", "sliding block", "crushed block"],
)
def test_same_load_factor(problem, coupling):
    """At the reactions of our answer; cvxpy's Clarabel stops at a gap of 1e-8, ours at 1e-9."""
    discretisation = la.discretise(problem)
    state = la.solve(discretisation, coupling=coupling, throw=True)
    program = dimensionless(discretisation.program, discretisation.natural)
    contact = associated_contact(program.contact)
    if coupling == "reaction":
        t_n = state.point.normal_reaction / program.scales.stress
        contact = reaction_contact(program.contact, np.asarray(t_n))
    ours = state.load_factor / program.scales.load_factor
    assert load_factor(program, contact) == pytest.approx(ours, rel=1e-6)
