"""cvxpy as an independent reading of the kinematic program, by every solver that is installed."""

import importlib
from importlib.metadata import version

import numpy as np
import pytest

import lacore as la
from lacore.program.certificate import certify
from lacore.program.kinematic import associated_contact, dimensionless, reaction_contact
from lacore.reporting.status import Status
from lacore.solvers.backend import find_backend, load_backend, read_options
from lacore_backends import _cvxpy_solvers
from tests.backends.hand_made import (
    CONIC,
    LINEAR,
    LOCKED,
    UNSAFE,
    check_answer,
    frozen,
    random_contact,
    random_linear_program,
    sliding_block,
)
from tests.lacore.models import deformable_block, punch

# Interior points and simplex stop at 1e-10 of the largest number in a program. Numbers go up to
# 20, weights down to 0.01, so that a stress or a slip may be off by 2e-7 of the largest number.
BAR = 2e-7
# SCS and OSQP state ten times their tolerance of 1e-8.
CONE_SOLVERS = ["CLARABEL", "ECOS", "MOSEK", "QOCO", "SCS"]
LP_SOLVERS = ["HIGHS", "OSQP"]
RUNAWAY = {"QOCO"}  # has no notion of infeasible and unbounded


def find(solver):
    backend = load_backend(f"cvxpy:{solver}")
    if reason := backend.unavailable():
        pytest.skip(reason)
    return backend


def solve(backend, program, contact, **options):
    return backend.prepare(program, backend.Options(**options)).solve(contact)


def each(solvers, programs):
    return [pytest.param(s, p, id=f"{s}-{name}") for s in solvers for name, p in programs.items()]


# Programs solved by hand.


@pytest.mark.parametrize(
    ("solver", "known"),
    each(CONE_SOLVERS, CONIC) + each(CONE_SOLVERS + LP_SOLVERS, LINEAR),
)
def test_known_programs(solver, known):
    """Value, velocity and every dual with its sign; the certificate is recomputed."""
    backend = find(solver)
    answer = solve(backend, known.program, known.contact)
    assert (answer.status, answer.native_status) == (Status.SOLVED, "optimal")
    check_answer(known, answer.point, BAR)


def test_a_solver_that_is_not_known_here_runs_with_its_own_defaults():
    backend, known = find("SCIPY"), LINEAR["clamped beam"]
    check_answer(known, solve(backend, known.program, known.contact).point, BAR)
    with pytest.raises(la.InputError, match="'tolerance': unknown name"):
        read_options(backend, {"tolerance": 1e-6})


@pytest.mark.parametrize(("solver", "given"), each(CONE_SOLVERS + LP_SOLVERS, LOCKED))
def test_infeasible_is_locked(solver, given):
    backend = find(solver)
    answer = solve(backend, *given)
    if solver in RUNAWAY:
        assert_no_certificate(given, answer)
    else:
        assert (answer.status, answer.point) == (Status.LOCKED, None)


@pytest.mark.parametrize(("solver", "given"), each(CONE_SOLVERS + LP_SOLVERS, UNSAFE))
def test_unbounded_is_unsafe(solver, given):
    backend = find(solver)
    answer = solve(backend, *given)
    if solver in RUNAWAY:
        assert_no_certificate(given, answer)
    else:
        assert (answer.status, answer.point) == (Status.UNSAFE, None)


def assert_no_certificate(given, answer):
    """Whatever the solver says, nothing that it returns is taken for an answer."""
    program, contact = given
    assert answer.status not in (Status.LOCKED, Status.UNSAFE)
    assert answer.point is None or not certify(program, answer.point, contact).holds(1e-3)


# The check of our own conic assembly, on meshes.

PROBLEMS = {
    "rough punch": lambda: punch(rough=True),
    "smooth punch": lambda: punch(rough=False),
    "sliding block": lambda: deformable_block(0.5),
    "crushed block": lambda: deformable_block(0.9),
}


@pytest.mark.parametrize("coupling", ["reaction", "associated"])
@pytest.mark.parametrize("name", PROBLEMS)
def test_same_answer_as_our_own_assembly(name, coupling):
    """At the reactions of our answer: one program, read twice, solved to 1e-10 twice."""
    discretisation = la.discretise(PROBLEMS[name]())
    state = la.solve(discretisation, coupling=coupling, throw=True)
    program = dimensionless(discretisation.program, discretisation.natural)
    contact = associated_contact(program.contact)
    if coupling == "reaction":
        t_n = state.point.normal_reaction / program.scales.stress
        contact = reaction_contact(program.contact, np.asarray(t_n))
    ours, theirs = (
        solve(find_backend(name), program, contact).point for name in ("clarabel", "cvxpy")
    )
    assert theirs.load_factor == pytest.approx(ours.load_factor, rel=1e-7)
    assert certify(program, theirs, contact).holds(BAR)


@pytest.mark.parametrize("seed", range(10))
def test_same_answer_for_all_kinds_of_contact(seed):
    """Random mixtures of stick, friction, dilatancy and shift."""
    program, contact = random_linear_program(seed), random_contact(np.random.default_rng(seed))
    ours, theirs = (solve(find_backend(name), program, contact) for name in ("clarabel", "cvxpy"))
    assert ours.status is theirs.status is Status.SOLVED
    assert theirs.point.load_factor == pytest.approx(ours.point.load_factor, rel=1e-7)


def test_first_order_to_what_it_states():
    """Ten times the tolerance, on a mesh."""
    backend = find("SCS")
    discretisation = la.discretise(punch())
    program = dimensionless(discretisation.program, discretisation.natural)
    contact = associated_contact(program.contact)
    exact = solve(find_backend("clarabel"), program, contact).point.load_factor
    for tolerance in (1e-6, 1e-8):
        point = solve(backend, program, contact, tolerance=tolerance).point
        assert point.load_factor == pytest.approx(exact, rel=10 * tolerance)
        assert certify(program, point, contact).holds(10 * tolerance)


@pytest.mark.parametrize("backend", ["cvxpy", pytest.param("cvxpy:ECOS", marks=pytest.mark.slow)])
def test_the_whole_loop(backend):
    """CLOSED_FORMS C14: alpha = mu p b/h; ECOS knows no time limit and gets its own process."""
    if reason := load_backend(backend).unavailable():
        pytest.skip(reason)
    state = la.solve(deformable_block(0.5), backend, throw=True)
    assert state.load_factor == pytest.approx(2.0, abs=1e-6)


# Repeated solves.

SEQUENCE = [
    frozen([0.3, 0.2, 0.1, 0.4]),
    frozen([0.1, 0.5, 0.6, 0.2]),  # costs only
    frozen([0.1, 0.5, 0.6, 0.2], shift=[0.1, 0.0, 0.2, 0.0]),  # and offsets
    frozen([0.0, 0.5, np.inf, 0.2]),  # other rows
    frozen([0.0, 0.0, np.inf, np.inf], dilatancy=[0.3, 0.0, 0.0, 0.0]),
    frozen([np.inf] * 4),
    frozen([0.0] * 4),
    frozen([0.3, 0.2, 0.1, 0.4]),
]


@pytest.mark.parametrize("solver", ["CLARABEL", "SCS"])
def test_repeated_solves_are_fresh_solves(solver):
    backend, program = find(solver), random_linear_program(1)
    solver = backend.prepare(program, backend.Options())
    for held in SEQUENCE:
        again, fresh = solver.solve(held), solve(backend, program, held)
        assert again.status is fresh.status is Status.SOLVED
        assert again.point.load_factor == pytest.approx(fresh.point.load_factor, rel=BAR)


def test_a_change_of_costs_builds_no_model(monkeypatch):
    from lacore_backends import cvxpy_conic  # here and below: cvxpy takes a second to load

    count, build = [], cvxpy_conic._Model
    monkeypatch.setattr(cvxpy_conic, "_Model", lambda *given: count.append(1) or build(*given))
    backend = find_backend("cvxpy")
    solver = backend.prepare(random_linear_program(0), backend.Options())
    for held in SEQUENCE[:3]:
        solver.solve(held)
    assert len(count) == 1
    solver.solve(SEQUENCE[3])
    assert len(count) == 2


def test_a_failed_solve_spoils_nothing():
    """Unbounded in the middle of a loop, with the rows of the one before."""
    backend = find_backend("cvxpy")
    solver = backend.prepare(sliding_block((1.0, 0.0), (-5.0, 3.0)), backend.Options())
    statuses = [solver.solve(frozen([bound])).status for bound in (2.0, 1.0, 2.0)]
    assert statuses == [Status.SOLVED, Status.UNSAFE, Status.SOLVED]


# Limits and failures.


@pytest.mark.parametrize("solver", ["CLARABEL", "ECOS", "MOSEK", "QOCO", "SCS", "OSQP", "HIGHS"])
def test_iteration_limit(solver):
    backend = find(solver)
    answer = solve(backend, random_linear_program(0), SEQUENCE[0], max_iterations=2)
    assert answer.status is Status.ITERATION_LIMIT
    assert answer.iterations <= 2
    assert answer.point is None or np.all(np.isfinite(answer.point.velocity))


@pytest.mark.parametrize("solver", ["CLARABEL", "MOSEK", "SCS", "OSQP", "HIGHS"])
def test_time_limit(solver):
    backend = find(solver)
    assert not backend.capabilities.isolated
    answer = solve(backend, random_linear_program(0), SEQUENCE[0], time_limit=1e-9)
    assert answer.status is Status.TIME_LIMIT


def test_solvers_without_a_time_limit_are_isolated():
    for solver in ("ECOS", "QOCO", "SCIPY"):
        assert load_backend(f"cvxpy:{solver}").capabilities.isolated


def test_a_solver_error_is_a_status(monkeypatch):
    import cvxpy as cp

    def failing(*_, **__):
        raise cp.error.SolverError("Solver 'CLARABEL' failed.")

    monkeypatch.setattr(cp.Problem, "solve", failing)
    answer = solve(find_backend("cvxpy"), sliding_block(), frozen([0.7]))
    assert (answer.status, answer.native_status) == (Status.FAILED, "solver_error")
    assert answer.message == "SolverError: Solver 'CLARABEL' failed."
    assert answer.point is None


@pytest.mark.parametrize(("given", "status"), [(LOCKED, Status.LOCKED), (UNSAFE, Status.UNSAFE)])
def test_infeasible_or_unbounded_is_found_out(monkeypatch, given, status):
    """Some solvers leave it open; the program without costs knows."""
    from lacore_backends import cvxpy_conic

    run = cvxpy_conic.CvxpySolver._run
    words = iter(["infeasible_or_unbounded"])
    monkeypatch.setattr(
        cvxpy_conic.CvxpySolver,
        "_run",
        lambda self, problem: (next(words, None) or run(self, problem)[0], 0, ""),
    )
    answer = solve(find_backend("cvxpy"), *next(iter(given.values())))
    assert (answer.status, answer.point) == (status, None)


def test_every_word_of_cvxpy_has_a_meaning():
    from cvxpy import settings

    from lacore_backends import cvxpy_conic

    words = {*settings.SOLUTION_PRESENT, *settings.INF_OR_UNB, *settings.INACCURATE}
    assert len(words) == 8
    assert words | set(settings.ERROR) == set(cvxpy_conic.STATUS_MAP)


# The plug.


def test_registered():
    backend = find_backend("cvxpy")
    assert backend.name == "cvxpy"
    assert backend.version() == f"cvxpy {version('cvxpy')}, CLARABEL {version('clarabel')}"
    assert backend.capabilities.max_cone is None
    assert "CLARABEL" in backend.title
    assert backend.source


def test_variants():
    family = find_backend("cvxpy")
    installed = importlib.import_module("cvxpy").installed_solvers()
    assert {*installed, *_cvxpy_solvers.SOLVERS} <= set(family.variants())
    for solver in family.variants():
        backend = load_backend(f"cvxpy:{solver}")
        assert backend.name == f"cvxpy:{solver}"
        assert backend.Options().time_limit > 0
        assert solver in backend.version() or backend.unavailable()
    with pytest.raises(la.InputError, match="did you mean 'ECOS'"):
        load_backend("cvxpy:EKOS")


def test_a_solver_that_is_not_installed_says_how_to_get_it(monkeypatch):
    monkeypatch.setattr("lacore_backends.cvxpy_conic.installed", lambda: frozenset(["CLARABEL"]))
    with pytest.raises(la.CapabilityError, match="ECOS is not installed: pip install ecos"):
        find_backend("cvxpy:ECOS")


def test_mosek_without_a_licence_says_so(monkeypatch):
    mosek = pytest.importorskip("mosek")
    monkeypatch.setattr(mosek.Env, "checkoutlicense", refuse)
    with pytest.raises(la.CapabilityError, match=r"MOSEK has no licence here .*mosek\.lic"):
        find_backend("cvxpy:MOSEK")


def refuse(*_):
    import mosek

    raise mosek.Error(mosek.rescode.err_missing_license_file, "planted")


def test_linear_solvers_refuse_cones():
    """A sentence with the reason and the way out, before any solve."""
    with pytest.raises(la.CapabilityError, match=r"linear programs.*cones of 2 rows.*'clarabel'"):
        la.solve(punch(), "cvxpy:HIGHS")


@pytest.mark.parametrize("solver", ["CLARABEL", "SCS", "HIGHS"])
@pytest.mark.parametrize("name", ["tolerance", "max_iterations", "time_limit"])
@pytest.mark.parametrize("value", [0, -1, np.nan])
def test_options_refuse(solver, name, value):
    with pytest.raises(la.InputError, match=f"cvxpy.{name} = .*> 0"):
        load_backend(f"cvxpy:{solver}").Options(**{name: value})
