"""What answers leave where nothing is turned over, and the word of a solver beside it."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.program.certificate import certify
from lacore.program.kinematic import associated_contact
from lacore.program.residuals import idle, impossible, scaled_residual, solve_residual
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution, find_backend, read_options
from lacore.solvers.inner.preparing import preparer
from lacore.solvers.inner.rescaling import RescalingSolver, good_for, proven
from lacore_verification.fuzz.programs.drawn import draw_program

BAR = 1e-6
PHI = 30.0


def on_rails(across):
    """A square of soil that nothing holds along y, pressed to its rails, pushed along them."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 4, 4)
    return la.Problem(
        bodies={"block": la.Body(mesh, la.MohrCoulomb(1.0, PHI), space="p2-gauss")},
        supports=[la.Fix("block", "left", "x")],
        reference_loads=[la.BodyForce("block", (0.0, 1.0))],
        dead_loads=[la.BodyForce("block", (across, 0.0))],
    )


@pytest.fixture(scope="module")
def free():
    """Its program, contact and answer."""
    program = la.discretise(on_rails(-0.05)).program
    contact = associated_contact(program.contact)
    backend = find_backend("clarabel")
    prepare = preparer(backend, read_options(backend, {}))
    return program, contact, prepare(program).solve(contact)


def test_flow_that_is_not_possible_is_a_rate_where_no_power_is_turned_over(free):
    """The divergence of soil is a power: of round-off per round-off, of order one."""
    program, contact, answer = free
    assert idle(program, answer.point, contact)
    assert certify(program, answer.point, contact).divergence > BAR
    assert scaled_residual(program, answer.point, contact)[1] <= BAR
    # A square that shrinks at a rate of one, and its load's speed is one: no soil flows like that.
    volumes = program.groups[0].volumetric
    shrinking = np.linalg.lstsq(volumes.toarray(), -np.ones(volumes.shape[0]))[0]
    moved = replace(answer.point, velocity=answer.point.velocity + shrinking)
    assert impossible(program, moved) > 0.1
    assert scaled_residual(program, moved, contact)[1] > BAR


def test_the_load_factor_of_a_motion_that_takes_no_power_is_zero():
    """Nothing of it was asked: without dead loads any load factor beside it was proven."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    problem = la.Problem(
        bodies={"block": la.Body(mesh, la.VonMises(1.0))},
        supports=[la.Fix("block", "left", "x")],
        reference_loads=[la.BodyForce("block", (0.0, 1.0))],
    )
    program = la.discretise(problem).program
    contact = associated_contact(program.contact)
    answer = find_backend("interior_point")
    solver = answer.prepare(program, read_options(answer, {}))
    point = solver.solve(contact).point
    solver.close()
    assert idle(program, point, contact)
    assert solve_residual(program, point, contact, BAR)[1] <= BAR
    for claimed in (1e-3, -1.0, 1e3):
        name, left = solve_residual(program, replace(point, load_factor=claimed), contact, BAR)
        assert name == "load"
        assert left > BAR


def test_what_overflows_is_above_every_bar(free):
    program, contact, answer = free
    stress = tuple(1e200 * (1 + stress) for stress in answer.point.stress)
    velocity = 1e200 * (1 + answer.point.velocity)
    off = replace(answer.point, stress=stress, velocity=velocity)
    with np.errstate(all="ignore"):
        assert solve_residual(program, off, contact, BAR)[1] == np.inf


def test_soil_that_nothing_holds_is_free():
    state = la.solve(on_rails(-0.05), "clarabel", throw=False)
    assert state.status is la.Status.FREE


def test_the_word_of_a_solver_is_not_kept_above_the_bar(free):
    program, contact, answer = free
    assert answer.status is Status.SOLVED
    assert proven(program, answer, contact, good_for(BAR)) is answer
    off = replace(answer.point, load_factor=0.01)
    doubted = proven(program, replace(answer, point=off), contact, good_for(BAR))
    assert doubted.status is Status.ALMOST_SOLVED
    assert "recomputed" in doubted.message
    nothing = replace(answer, point=None, status=Status.FAILED)
    assert proven(program, nothing, contact, good_for(BAR)) is nothing


class Stubborn:
    """A solver that says the same in whatever units."""

    def __init__(self, answer):
        self._answer = answer

    def solve(self, contact):
        return self._answer

    def close(self):
        pass


def test_a_light_block_out_of_balance_is_solved_again_or_not_called_solved():
    """By the word of Clarabel a program of weights decades apart is solved, and is not."""
    drawn = draw_program("weights", 6, 9, 24)
    backend = find_backend("clarabel")
    alone = backend.prepare(drawn.program, read_options(backend, {})).solve(drawn.contact)
    assert alone.status is Status.SOLVED
    assert certify(drawn.program, alone.point, drawn.contact).worst[1] > BAR

    prepare = preparer(backend, read_options(backend, {}), good=good_for(BAR))
    again = prepare(drawn.program).solve(drawn.contact)
    assert certify(drawn.program, again.point, drawn.contact).holds(BAR)
    assert again.status is Status.SOLVED
    stubborn = RescalingSolver(drawn.program, lambda _: Stubborn(alone), good_for(BAR))
    assert stubborn.solve(drawn.contact).status is Status.ALMOST_SOLVED


def test_iterations_of_a_solve_in_vain_count():
    """In units of loads first, then as stated, and neither is an answer: those of one were told."""
    drawn = draw_program("weights", 12, 0, 18)
    nothing = InnerSolution(Status.STALLED, "stuck", 7, 1.0, None)
    found = RescalingSolver(drawn.program, lambda _: Stubborn(nothing)).solve(drawn.contact)
    assert (found.iterations, found.solve_time) == (14, 2.0)


def test_what_units_of_loads_do_not_solve_is_asked_as_it_is():
    """Weights decades apart: in units of them it stalled at 0.16, and as it is it is solved."""
    drawn = draw_program("weights", 12, 0, 18)
    backend = find_backend("clarabel")
    prepare = preparer(backend, read_options(backend, {}), good=good_for(BAR))
    found = prepare(drawn.program).solve(drawn.contact)
    assert found.status is Status.SOLVED
    assert certify(drawn.program, found.point, drawn.contact).holds(BAR)
