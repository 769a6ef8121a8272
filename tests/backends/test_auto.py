"""Who is asked by `auto`, who after it, and what comes of both."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.assembly.discretise import discretise
from lacore.bounds.static_model import static_model
from lacore.program.certificate import certify
from lacore.program.kinematic import associated_contact, dimensionless
from lacore.reporting.status import Status
from lacore_backends import interior_point
from lacore_backends._embedding.follow import EmbeddingResult
from lacore_backends.auto import Auto, AutoOptions, AutoSolver
from lacore_backends.clarabel_socp import ClarabelSolver
from lacore_verification.fuzz.programs.drawn import draw_program
from tests.lacore.models import punch, square
from tests.lacore.random_programs import frozen, random_program, random_soil

BAR = 1e-6  # residuals, of certificates: a hundred tolerances of 1e-8


@pytest.fixture(scope="module")
def smooth():
    """A smooth punch, associated."""
    d = la.discretise(punch(8, 4, rough=False))
    program = dimensionless(d.program, d.natural)
    return program, associated_contact(program.contact)


@pytest.fixture
def fast(monkeypatch):
    """As where PARDISO is installed."""
    monkeypatch.setattr("lacore_backends.auto._factorises_fast", lambda: True)


def test_auto_takes_clarabel_for_little_for_several_surfaces_and_for_blocks(smooth):
    soil = random_soil(1)
    blocks = draw_program("walls", 1, 0, 60)
    cases = ((*smooth, 10**6), (soil, frozen(1.0), 0), (blocks.program, blocks.contact, 0))
    for program, contact, least in cases:
        solver = AutoSolver(program, AutoOptions(), least)
        assert solver.solve(contact).native_status.startswith("clarabel: ")
        solver.close()


def test_auto_takes_the_interior_point_for_upper_bounds_of_soil_of_one_surface(fast):
    """Pressed between smooth platens; lower ones lose too much of little cohesion."""
    problem = la.Problem(
        bodies={"soil": replace(square(2), criterion=la.MohrCoulomb(1.0, 20.0))},
        supports=[la.Fix("soil", "bottom", "y"), la.Fix("soil", "left", "x")],
        reference_loads=[la.Traction("soil", "top", (0, -1))],
    )
    asked = (discretise(problem), "interior_point: solved"), (static_model(problem), "clarabel: ")
    for stated, first in asked:
        solver = AutoSolver(stated.program, AutoOptions(), 0)
        native = solver.solve(associated_contact(stated.program.contact)).native_status
        solver.close()
        assert native.startswith(first)


def test_auto_tells_who_solved(smooth, fast):
    solver = AutoSolver(smooth[0], AutoOptions(), 0)
    assert solver.solve(smooth[1]).native_status == "interior_point: solved"
    solver.close()


def test_auto_takes_lower_bounds_from_more_unknowns_up(fast):
    """Of twice as many unknowns for as many points of yield, half count."""
    problem = punch(8, 4)
    above = discretise(problem).program
    below = static_model(problem).program
    for program, least, first in (
        (above, above.n, "interior_point: "),
        (below, int(0.4 * below.n), "interior_point: "),
        (below, int(0.6 * below.n), "clarabel: "),
    ):
        solver = AutoSolver(program, AutoOptions(), least)
        native = solver.solve(associated_contact(program.contact)).native_status
        solver.close()
        assert native.startswith(first)


def test_auto_leaves_slip_that_is_given_to_clarabel_and_keeps_both(fast):
    program, contact, shifted = random_program(1), frozen(1.0), frozen(1.0, 0.0, 0.1)
    solver = AutoSolver(program, AutoOptions(), 0)
    words = [solver.solve(own).native_status for own in (contact, shifted, contact, shifted)]
    solver.close()
    assert words == 2 * ["interior_point: solved", "clarabel: Solved"]


def test_auto_falls_back_in_the_same_call(smooth, fast, lost):
    (found,) = asked(smooth[0], smooth[1:], 0)
    assert found.status is Status.SOLVED
    assert found.native_status == "interior_point: no progress; clarabel: Solved"
    assert certify(smooth[0], found.point, smooth[1]).holds(BAR)


def test_the_history_tells_which_solver_it_was():
    state = la.solve(punch(4, 2), "auto", coupling="associated")
    assert state.history["native_status"].iloc[-1] == "clarabel: Solved"


STALLED = "InsufficientProgress"


@pytest.fixture
def stopped(monkeypatch):
    """Clarabel stops on its way, at a velocity that is off by as much as stated."""

    def stops(by=1e-3, status=Status.STALLED, native=STALLED):
        solve = ClarabelSolver.solve

        def stalled(self, contact):
            found = solve(self, contact)
            off = replace(found.point, velocity=(1 + by) * found.point.velocity)
            return replace(found, status=status, native_status=native, point=off)

        monkeypatch.setattr(ClarabelSolver, "solve", stalled)

    return stops


@pytest.fixture
def lost(monkeypatch):
    """The interior point ends nowhere; the iterations that each way was given."""
    follow, given = interior_point.follow, []

    def stalls(system, goal, *begin) -> EmbeddingResult:
        given.append(goal.max_iterations)
        once = replace(goal, max_iterations=1)
        return replace(follow(system, once, *begin), native="no progress")

    monkeypatch.setattr(interior_point, "follow", stalls)
    return given


def asked(program, contacts, least):
    solver = AutoSolver(program, AutoOptions(), least)
    found = [solver.solve(contact) for contact in contacts]
    solver.close()
    return found


def test_auto_asks_the_interior_point_where_clarabel_stops_on_its_way(smooth, fast, stopped):
    program, contact = smooth
    (right,) = asked(program, [contact], program.n + 1)
    stopped()
    for found in asked(program, [contact, contact], program.n + 1):
        assert found.native_status == f"clarabel: {STALLED}; interior_point: solved"
        assert found.status is Status.SOLVED
        assert certify(program, found.point, contact).holds(BAR)
        assert found.point.load_factor == pytest.approx(right.point.load_factor, rel=BAR)


def test_auto_believes_no_word_that_residuals_refute(smooth, fast, stopped):
    stopped(status=Status.SOLVED, native="Solved")
    (found,) = asked(smooth[0], smooth[1:], smooth[0].n + 1)
    assert found.native_status == "clarabel: Solved; interior_point: solved"
    assert certify(smooth[0], found.point, smooth[1]).holds(BAR)


def test_auto_is_content_where_residuals_prove_what_is_almost_solved(smooth, fast, stopped):
    # A hundredth of what 1e-8 allows: the normalisation is missed by as much.
    stopped(by=1e-8, status=Status.ALMOST_SOLVED, native="AlmostSolved")
    (found,) = asked(smooth[0], smooth[1:], smooth[0].n + 1)
    assert found.native_status == "clarabel: AlmostSolved"


def test_auto_asks_the_interior_point_once_in_vain(smooth, fast, stopped, lost):
    """Of hundreds of contacts of a loop, and with few iterations."""
    stopped()
    first, *later = asked(smooth[0], 3 * [smooth[1]], smooth[0].n + 1)
    assert first.native_status.count(";") == 1
    assert lost
    assert max(lost) < AutoOptions().max_iterations
    assert {one.native_status for one in later} == {f"clarabel: {STALLED}"}


def test_auto_asks_clarabel_alone_after_the_interior_point_was_in_vain(smooth, fast, lost):
    first, second = asked(smooth[0], 2 * [smooth[1]], 0)
    assert first.native_status == "interior_point: no progress; clarabel: Solved"
    assert max(lost) == AutoOptions().max_iterations
    assert second.native_status == "clarabel: Solved"


@pytest.mark.parametrize("by", [1e-4, 1e4])
def test_auto_tells_the_closer_of_two_that_stall_last(smooth, fast, stopped, lost, by):
    stopped(by)
    (found,) = asked(smooth[0], smooth[1:], smooth[0].n + 1)
    closer = "clarabel" if by < 1 else "interior_point"
    assert found.native_status.split("; ")[-1].startswith(closer)
    assert found.status is Auto().statuses[found.native_status]


def test_auto_keeps_a_load_of_zero_of_which_all_residuals_are_of_order_one(fast, lost):
    """A block that slides where nothing presses it: 0/0, and the loop around it calls it free."""
    program = replace(random_program(1), groups=(), dead_load=np.zeros(9))
    (found,) = asked(program, [frozen(1.0)], program.n + 1)
    assert found.status is Status.SOLVED
    assert found.point.load_factor == pytest.approx(0, abs=1e-9)


def test_without_a_fast_factorisation_clarabel_is_asked_alone(smooth, stopped, monkeypatch):
    monkeypatch.setattr("lacore_backends.auto._factorises_fast", lambda: False)
    stopped()
    (found,) = asked(smooth[0], smooth[1:], 0)
    assert found.native_status == f"clarabel: {STALLED}"
