"""HiGHS on linear programs solved by hand, and against Clarabel on random ones."""

import highspy
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from lacore.program.certificate import certify
from lacore.reporting.status import Status
from lacore.solvers.backend import find_backend
from lacore_backends import highs_lp
from tests.backends.hand_made import (
    LINEAR,
    LOCKED,
    UNSAFE,
    check_answer,
    frozen,
    random_contact,
    random_linear_program,
    sliding_block,
)
from tests.lacore.models import punch

# A vertex is exact to round-off: the rows are met to 1e-10, of numbers up to 20.
EXACT = 1e-9
# Clarabel stops at 1e-10 of the largest number, and a hand-made program has weights from 0.01.
AGREE = 1e-7


def prepared(program, **options):
    backend = find_backend("highs")
    return backend.prepare(program, backend.Options(**options))


def solve(program, contact, **options):
    return prepared(program, **options).solve(contact)


def by_name(table):
    return [pytest.param(value, id=name) for name, value in table.items()]


@pytest.mark.parametrize("solver", ["simplex", "ipm"])
@pytest.mark.parametrize("known", by_name(LINEAR))
def test_known_programs(known, solver):
    """Value, velocity and every dual with its sign; the certificate is recomputed."""
    answer = solve(known.program, known.contact, solver=solver)
    assert (answer.status, answer.native_status) == (Status.SOLVED, "kOptimal")
    check_answer(known, answer.point, EXACT)


@pytest.mark.parametrize("solver", ["simplex", "ipm"])
@pytest.mark.parametrize("known", by_name(LOCKED))
def test_infeasible_is_locked(known, solver):
    answer = solve(*known, solver=solver)
    assert (answer.status, answer.point) == (Status.LOCKED, None)


@pytest.mark.parametrize("solver", ["simplex", "ipm"])
@pytest.mark.parametrize("known", by_name(UNSAFE))
def test_unbounded_is_unsafe(known, solver):
    answer = solve(*known, solver=solver)
    assert (answer.status, answer.point) == (Status.UNSAFE, None)


@given(seed=st.integers(0, 10**6))
def test_random_programs_as_clarabel(seed):
    """Any mixture of stick, friction, dilatancy and shift: one value, by two methods."""
    program, contact = random_linear_program(seed), random_contact(np.random.default_rng(seed))
    exact, clarabel = solve(program, contact), find_backend("clarabel")
    other = clarabel.prepare(program, clarabel.Options()).solve(contact)
    assert exact.status is other.status is Status.SOLVED
    assert exact.point.load_factor == pytest.approx(other.point.load_factor, rel=AGREE)


@given(seed=st.integers(0, 10**6))
def test_random_programs_have_a_certificate(seed):
    program, contact = random_linear_program(seed), random_contact(np.random.default_rng(seed))
    contact.shift[:] = 0.0
    certificate = certify(program, solve(program, contact).point, contact)
    # Rows are met to 1e-10 after multiplication by weights from 0.01.
    assert certificate.holds(1e-7), certificate


# Repeated solves.

SEQUENCE = [
    frozen([0.3, 0.2, 0.1, 0.4]),
    frozen([0.1, 0.5, 0.6, 0.2]),  # costs only
    frozen([0.1, 0.5, 0.6, 0.2], shift=[0.1, 0.0, 0.2, 0.0]),  # and offsets
    frozen([0.0, 0.5, np.inf, 0.2]),  # and stick
    frozen([np.inf] * 4),
    frozen([0.0] * 4, dilatancy=[0.3, 0.0, 0.2, 0.1]),  # other rows
    frozen([0.0] * 4, dilatancy=[0.5, 0.0, 0.2, 0.1], shift=[0.3, 0.3, 0.0, 0.0]),
    frozen([0.3, 0.2, 0.1, 0.4]),
]


@pytest.mark.parametrize("seed", range(3))
def test_repeated_solves_are_fresh_solves(seed):
    program = random_linear_program(seed)
    solver = prepared(program)
    for held in SEQUENCE:
        again, fresh = solver.solve(held), solve(program, held)
        assert again.status is fresh.status is Status.SOLVED
        assert again.point.load_factor == pytest.approx(fresh.point.load_factor, rel=EXACT)
    solver.close()


def test_a_solve_starts_from_the_vertex_before():
    """The same contact again is no work at all; a slightly other one is little."""
    solver = prepared(random_linear_program(0))
    first = solver.solve(SEQUENCE[0]).iterations
    assert first > 0
    assert solver.solve(SEQUENCE[0]).iterations == 0
    assert solver.solve(frozen(1.001 * SEQUENCE[0].bound)).iterations < first


def test_an_alternation_starts_from_the_vertices_of_its_kind():
    """Bounds and shifts in turn (T12): the second round starts where the first one ended."""
    program = random_linear_program(0)
    turns = [frozen([0.3, 0.2, 0.1, 0.4]), frozen([0.0] * 4, 0.5, 0.2)]
    solver = prepared(program)
    first = [solver.solve(held) for held in turns]
    again = [solver.solve(held) for held in turns]
    assert all(answer.iterations > 0 for answer in first)
    assert [answer.iterations for answer in again] == [0, 0]
    assert [answer.point.load_factor for answer in again] == [
        pytest.approx(answer.point.load_factor, rel=EXACT) for answer in first
    ]
    # A third kind of rows takes the place of the oldest.
    solver.solve(frozen([0.0] * 4, [0.5, 0.5, 0.0, 0.0]))
    assert solver.solve(turns[1]).iterations == 0
    assert solver.solve(turns[0]).iterations > 0


def test_a_little_more_dilatancy_starts_from_the_vertex_before():
    """As continuation in the friction coefficient asks."""
    solver = prepared(random_linear_program(0))
    first = solver.solve(frozen([0.0] * 4, 0.5))
    more = frozen([0.0] * 4, 0.501)
    assert solver.solve(more).iterations < first.iterations
    fresh = solve(random_linear_program(0), more)
    assert solver.solve(more).point.load_factor == pytest.approx(fresh.point.load_factor, rel=EXACT)


def test_a_failed_solve_spoils_nothing():
    solver = prepared(sliding_block((1.0, 0.0), (-5.0, 3.0)))
    statuses = [solver.solve(frozen([bound])).status for bound in (2.0, 1.0, np.inf, 2.0)]
    assert statuses == [Status.SOLVED, Status.UNSAFE, Status.SOLVED, Status.SOLVED]


# Limits.


@pytest.mark.parametrize(
    ("options", "status"),
    [
        ({"max_iterations": 1}, Status.ITERATION_LIMIT),
        ({"max_iterations": 1, "solver": "ipm"}, Status.ITERATION_LIMIT),
        ({"time_limit": 1e-9}, Status.TIME_LIMIT),
    ],
)
def test_limits(options, status):
    answer = solve(random_linear_program(0), SEQUENCE[0], **options)
    assert answer.status is status
    assert answer.iterations <= 1


def test_the_time_limit_is_that_of_one_solve():
    """The clock of HiGHS counts all solves of one model."""
    program = random_linear_program(0)
    limit = 0.2  # s, some hundred times one solve
    solver = prepared(program, time_limit=limit)
    spent = 0.0
    for k in range(10**4):
        answer = solver.solve(frozen(np.random.default_rng(k).uniform(0.1, 1, 4)))
        assert answer.status is Status.SOLVED
        spent = solver._models[0]._highs.getRunTime()
        if spent > limit:
            return
    pytest.fail(f"the clock of HiGHS reached {spent} s only")


def test_unbounded_or_infeasible_is_found_out():
    """Presolve leaves it open where it is let; without presolve it is known."""
    for table, status in ((LOCKED, Status.LOCKED), (UNSAFE, Status.UNSAFE)):
        for program, contact in table.values():
            solver = prepared(program)
            model = solver._model(contact)
            native = []
            model._highs.setOptionValue("allow_unbounded_or_infeasible", True)
            run = model._run
            model._run = lambda run=run, native=native: native.append(run()) or native[-1]
            assert solver.solve(contact).status is status
            assert "kUnboundedOrInfeasible" not in native[1:]


def test_every_native_status_has_a_meaning():
    native = set(highspy.HighsModelStatus.__members__)
    assert len(native) > 15
    assert native == set(highs_lp.STATUS_MAP)


# The plug.


def test_registered():
    backend = find_backend("highs")
    assert (backend.name, backend.unavailable()) == ("highs", "")
    assert backend.version().startswith("HiGHS 1.")
    assert backend.capabilities.max_cone == 1
    assert backend.capabilities.warm_start


def test_cones_are_refused():
    """A sentence with the reason and the way out, before any solve."""
    with pytest.raises(la.CapabilityError, match=r"linear programs.*cones of 2 rows.*'clarabel'"):
        la.solve(punch(), "highs")


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"tolerance": -1.0}, "highs.tolerance = -1.0"),
        ({"tolerance": 1e-11}, "no tolerance below 1e-10"),
        ({"max_iterations": 0}, "highs.max_iterations = 0"),
        ({"time_limit": float("nan")}, "highs.time_limit = nan"),
        ({"solver": "simplx"}, "did you mean 'simplex'"),
    ],
)
def test_options_refuse(options, text):
    with pytest.raises(la.InputError, match=text):
        find_backend("highs").Options(**options)
