"""Ends of the load factors with equilibrium: an answer that is off proves less, or nothing."""

from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.coupling.bounds import upper_bound
from lacore.coupling.claims.carried import carried_end
from lacore.limit import carried
from lacore.program.kinematic import associated_contact, dimensionless, stick_contact
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution
from lacore.solvers.inner.preparing import preparer_named

TOLERANCE = 1e-6


def column():
    """Return a column, its dimensionless program, and the answer for its upper end."""
    d = la.discretise(la.examples.column(friction=0.3))
    program = dimensionless(d.program, d.natural).associated()
    end = carried_end(program, associated_contact(program.contact), 1.0, prepare(), TOLERANCE)
    return d, program, InnerSolution(Status.SOLVED, "", 0, 0.0, end.point), end


def prepare():
    return preparer_named("clarabel", {})


def test_reactions_out_of_balance_prove_no_equilibrium():
    _, program, answer, end = column()
    heavier = replace(answer.point, normal_reaction=1.001 * answer.point.normal_reaction)
    laws = associated_contact(program.contact)
    wrong = carried_end(program, laws, 1.0, prepare(), TOLERANCE, replace(answer, point=heavier))
    assert np.isfinite([end.load_factor, end.residual]).all()
    assert np.isnan([wrong.load_factor, wrong.residual]).all()
    assert wrong.bound == pytest.approx(end.bound, rel=1e-5)  # one of the velocity alone


def test_moments_and_corners_that_no_program_has_remove_the_proofs(monkeypatch):
    d, _, _, end = column()
    for name, lost in (("driven_corners", "bound"), ("span_excess", "load_factor")):
        with monkeypatch.context() as patch:
            patch.setattr(carried, name, lambda *_: 1.0)
            found = carried.end_in_si(d, end, TOLERANCE)
        value = getattr(found, lost)
        assert value == np.inf or np.isnan(value)
    assert np.isfinite(carried.end_in_si(d, end, TOLERANCE).bound)


def test_slip_where_contact_sticks_raises_the_bound():
    """A velocity that also slides by 1e-8 does more power; forces that stick take it back."""
    _, program, _, _ = column()
    laws = stick_contact(program.contact)
    with closing(prepare()(program)) as solver:
        exact = solver.solve(laws)
    sliding = np.zeros(program.n)
    sliding[0] = 1e-8  # of the only block, along the load
    moved = exact.point.velocity + sliding
    moved /= program.reference_load @ moved
    own = -program.dead_load @ moved  # no joint dissipates: contact sticks or opens
    slips = replace(exact, point=replace(exact.point, velocity=moved, load_factor=own))
    assert own < exact.point.load_factor * (1 - 1e-9)
    assert upper_bound(program, slips, TOLERANCE, laws) >= exact.point.load_factor * (1 - 1e-12)
