"""What one inner solve of a loop is solved with, and which state it yields."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from lacore.coupling.fixed_point import fixed_point
from lacore.coupling.options import CouplingOptions
from lacore.coupling.run import Run
from lacore.program.kinematic import family_contact, reaction_contact
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution
from tests.lacore.planted import sliding

D, STATE = sliding()
CONTACT = reaction_contact(D.program.contact, STATE.normal_reaction)


class Solver:
    """A solver that returns one state, and counts its solves."""

    def __init__(self, state=STATE):
        self.state, self.solves, self.closed = state, 0, False

    def solve(self, contact):
        self.solves += 1
        return InnerSolution(Status.SOLVED, "", 1, 0.0, self.state)

    def close(self):
        self.closed = True


def run_of(solver, prepare=None):
    return Run(D.program, solver, False, CouplingOptions(), lambda _: None, prepare)


def test_an_answer_that_holds_needs_no_partner():
    """Its own velocity and reactions are a limit state; only those that are none are paired."""
    wrong = replace(STATE, load_factor=1.1 * STATE.load_factor)
    for own, paired in ((STATE, False), (wrong, True)):
        other = replace(STATE)
        found = run_of(Solver(own)).solve("K", CONTACT, partner=lambda _, other=other: other)
        assert found.state is (other if paired else own)
        assert found.certificate.holds(1e-6)
        assert found.inner.point is own


@pytest.mark.parametrize("program", [None, D.program])
def test_the_program_of_a_run_is_prepared_once(program):
    own, prepared = Solver(), []
    run = run_of(own, prepared.append)
    for _ in range(3):
        run.solve("K", CONTACT, program=program)
    assert own.solves == 3
    assert not prepared


def test_another_program_is_prepared_and_closed_again():
    """Unless a solver is given for it, or the run can prepare none."""
    own, other, stated = Solver(), Solver(), replace(D.program)
    run = run_of(own, lambda program: other if program is stated else SimpleNamespace())
    run.solve("K", CONTACT, program=stated)
    assert (own.solves, other.solves, other.closed) == (0, 1, True)
    stated_solver = Solver()
    run.solve("K", CONTACT, program=stated, solver=stated_solver)
    assert (stated_solver.solves, stated_solver.closed) == (1, False)
    run_of(own).solve("K", CONTACT, program=stated)
    assert own.solves == 1


@pytest.mark.parametrize("kappa", [0.0, 0.25, 1.0])
def test_a_fixed_point_loop_freezes_the_friction_of_its_start_first(kappa):
    """Reactions of 0.8 and speeds of 3: each is divided by its size, and multiplied again."""
    faster = replace(STATE, velocity=3 * STATE.velocity)
    frozen, rows = [], D.program.contact

    def solve(kind, contact):
        frozen.append(contact)
        return SimpleNamespace(inner=SimpleNamespace(point=None, status=Status.TIME_LIMIT))

    run = SimpleNamespace(program=D.program, exhausted=False, solve=solve, finish=lambda own: own)
    fixed_point(run, "K", kappa, faster, None)
    slip = np.linalg.norm(rows.slip(faster.velocity), axis=1)
    assert slip == pytest.approx(3.0)
    exact = family_contact(rows, kappa, STATE.normal_reaction, slip)
    assert frozen[0].bound == pytest.approx(exact.bound)
    assert frozen[0].shift == pytest.approx(exact.shift)
