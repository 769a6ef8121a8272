"""The reaction loop: acceleration, starts, statuses, history."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from lacore.coupling.fixed_point import reaction_loop
from lacore.coupling.options import CouplingOptions
from lacore.coupling.run import Run
from lacore.numerics.anderson import Anderson
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution
from tests.lacore.models import cantilever, deformable_block, obstacle, square
from tests.lacore.random_programs import random_program
from tests.shares import one_in

BETA = 0.3
DOWN = (np.sin(BETA), -np.cos(BETA))  # unit weight on an incline beta, axes along it


def on_square(reference, **given):
    return la.Problem({"block": square()}, [reference], **given)


# Fixed-point iteration.


def iterate(mixing, image, start, steps):
    x = start
    for _ in range(steps):
        x = np.asarray(mixing.step(x, image(x)))
    return x


@given(seed=st.integers(0, 10**6), size=st.integers(1, 3), damping=st.floats(0.3, 1))
def test_anderson_solves_a_linear_contraction_in_a_few_steps(seed, size, damping):
    """With as many directions as unknowns it is exact after size + 2 steps (GMRES)."""
    rng = np.random.default_rng(seed)
    orthogonal = np.linalg.qr(rng.normal(size=(size, size)))[0]
    matrix = orthogonal @ np.diag(rng.uniform(-0.9, 0.9, size)) @ orthogonal.T
    fixed = rng.uniform(-1, 1, size)
    x = iterate(
        Anderson(depth=size, damping=damping),
        lambda x: fixed + matrix @ (x - fixed),
        rng.uniform(-1, 1, size),
        2 * size + 3,
    )
    # Directions below 1e-8 of the largest are dropped, so that much can stay; rate 0.9 each step
    # would leave 0.4 of the error.
    assert np.abs(x - fixed).max() < 1e-6


@given(rate=st.floats(-0.99, 0.9), damping=st.floats(0.1, 1))
def test_plain_damping_contracts_at_its_rate(rate, damping):
    mixing = Anderson(depth=0, damping=damping)
    x = iterate(mixing, lambda x: rate * x, np.array([1.0]), 5)
    assert x[0] == pytest.approx((1 - damping * (1 - rate)) ** 5, abs=1e-14)


def test_anderson_converges_where_the_plain_iteration_diverges():
    mixing = Anderson(depth=1, damping=1.0)
    x = iterate(mixing, lambda x: -3.0 * x + 4.0, np.array([5.0]), 3)
    assert x[0] == pytest.approx(1.0, abs=1e-12)


def test_anderson_survives_an_exact_fixed_point():
    x = iterate(Anderson(depth=3, damping=0.7), lambda x: x, np.array([1.0, 2.0]), 5)
    assert np.array_equal(x, [1.0, 2.0])


# Starts.


@pytest.mark.parametrize("friction", [0.2, 0.5, 0.9])
def test_both_starts_end_at_the_same_load(friction):
    problem = deformable_block(friction)
    loads = [
        la.solve(problem, coupling="reaction", start=start).load_factor
        for start in ("associated", "zero")
    ]
    # Each within 1e-5 of the one value: residuals of 1e-6 and rates below 0.9 (T15).
    assert loads == pytest.approx([min(4 * friction, 3)] * 2, abs=1e-5)


@pytest.mark.parametrize(("damping", "anderson"), [(1.0, 0), (0.5, 0), (1.0, 3), (0.7, 1)])
def test_damping_and_depth_change_the_way_and_not_the_end(damping, anderson):
    state = la.solve(deformable_block(0.3), coupling="reaction", damping=damping, anderson=anderson)
    assert state.status is Status.SOLVED
    assert state.load_factor == pytest.approx(1.2, abs=1e-5)


def test_a_problem_without_friction_is_one_solve():
    state = la.solve(deformable_block(la.Tresca(0.3)))
    assert list(state.history.kind) == ["single"]
    assert state.load_factor == pytest.approx(1.2, abs=1e-6)


class Scripted:
    """A backend that answers with statuses from a list, and no point."""

    def __init__(self, *statuses):
        self.statuses, self.asked = list(statuses), []

    def solve(self, contact):
        self.asked.append(contact)
        return InnerSolution(self.statuses.pop(0), "scripted", 0, 0.0, None)


@pytest.mark.parametrize(
    ("start", "answers", "status", "kinds"),
    [
        # Associated unbounded is no error: friction may well be finite (T13).
        (
            "associated",
            [Status.LOCKED, Status.UNSAFE],
            Status.INVALID_START,
            ["associated", "zero"],
        ),
        # Frictionless unbounded is.
        ("associated", [Status.LOCKED, Status.LOCKED], Status.LOCKED, ["associated", "zero"]),
        ("zero", [Status.LOCKED], Status.LOCKED, ["zero"]),
        ("zero", [Status.UNSAFE], Status.INVALID_START, ["zero"]),
        ("associated", [Status.UNSAFE], Status.UNSAFE, ["associated"]),
        ("associated", [Status.FAILED], Status.FAILED, ["associated"]),
    ],
)
def test_statuses_of_the_start(start, answers, status, kinds):
    solver = Scripted(*answers)
    program = random_program(0)
    end = reaction_loop(Run(program, solver, False, CouplingOptions(start), lambda _: None))
    assert end.status is status
    assert [iterate.kind for iterate in end.iterates] == kinds
    for kind, contact in zip(kinds, solver.asked, strict=True):
        dilatancy = program.contact.coefficient if kind == "associated" else 0.0
        assert np.array_equal(contact.dilatancy, dilatancy + program.contact.dilatancy)
        assert np.array_equal(contact.bound, program.contact.limit)


# Progress and history.


def test_history_has_a_row_an_inner_solve():
    seen = []
    state = la.solve(deformable_block(0.3), coupling="reaction", on_iterate=seen.append)
    history = state.history
    assert len(history) == len(seen) == state.outer_iterations
    assert list(history.iteration) == list(range(len(history)))
    assert list(history.kind[:2]) == ["associated", "reaction"]
    assert set(history.columns) >= {
        "load_factor",
        "mismatch",
        "equilibrium",
        "yield_violation",
        "cone",
        "penetration",
        "divergence",
        "normalisation",
        "flow",
        "slip",
        "gap",
        "inner_status",
        "native_status",
        "inner_iterations",
        "solve_time",
        "reported_time",
    }
    assert history.load_factor.iloc[-1] == pytest.approx(state.load_factor, abs=1e-6)
    assert history.slip.iloc[-1] <= 1e-6 < history.slip.iloc[0]
    assert (history.solve_time > 0).all()
    assert state.build_time > 0
    assert state.solve_time >= history.solve_time.sum()


def test_history_is_in_si_units():
    state = la.solve(deformable_block(0.3, p=1e-3 * 1e6), tolerance=1e-4)
    small = la.solve(deformable_block(0.3))
    assert small.history.load_factor.iloc[0] == pytest.approx(small.load_factor, rel=1e-3)
    assert state.status is Status.UNSAFE  # a pressure of 1000 k on a block with free sides


# Statuses.


def ends(problem, status, **how):
    state = la.solve(problem, **how)
    assert state.status is status, state.history.T
    assert state.rigor is la.Rigor.NOT_CERTIFIED
    assert state.message.startswith(f"{status.label}: {status.value}")
    assert np.isinf(state.load_factor) if status is Status.LOCKED else np.isnan(state.load_factor)
    with pytest.raises(la.SolveError) as caught:
        la.solve(problem, throw=True, **how)
    assert str(caught.value) == state.message
    assert caught.value.state.status is status
    return state


SIDES = ("left", "right", "bottom", "top")


def test_locked_by_incompressibility():
    """No incompressible motion feels a uniform pressure all around."""
    problem = la.Problem({"block": square()}, [la.Pressure("block", side) for side in SIDES])
    state = ends(problem, Status.LOCKED)
    with pytest.raises(ValueError, match="no state"):
        _ = state.velocity


@pytest.mark.parametrize("start", ["associated", "zero"])
@pytest.mark.parametrize("friction", one_in(2, [0.3, la.SMOOTH, la.STICK]))
@pytest.mark.parametrize("weight", [(), (la.BodyForce("block", (0, -1)),)])
def test_locked_by_obstacles(start, friction, weight):
    """A block in a stiff box, pressed from above."""
    problem = on_square(
        la.Pressure("block", "top"),
        dead_loads=weight,
        interfaces=[obstacle(side, friction) for side in SIDES[:3]],
    )
    ends(problem, Status.LOCKED, coupling="reaction", start=start)
    ends(problem, Status.LOCKED)


@pytest.mark.parametrize("coupling", ["certified", "reaction", "associated"])
def test_unsafe_by_strength(coupling):
    """Weight 10 k over the height 1: a cut stands up to 3.78 k only."""
    problem = on_square(
        la.Traction("block", "top", (1, 0)),
        dead_loads=[la.BodyForce("block", (0, -10))],
        supports=[la.Fix("block", "bottom")],
    )
    ends(problem, Status.UNSAFE, coupling=coupling)


def pressed_on_incline(friction):
    return on_square(
        la.Pressure("block", "top"),
        dead_loads=[la.BodyForce("block", DOWN)],
        interfaces=[obstacle(friction=friction)],
    )


def test_unsafe_by_sliding():
    """Nothing holds a block on a smooth incline that is pressed against it."""
    ends(pressed_on_incline(la.SMOOTH), Status.UNSAFE)


def test_friction_by_the_live_load_alone_is_not_unsafe():
    """With mu = 0.2 < tan(beta) the dead load slides, and enough live pressure holds it (C2b):

    any load from sin(beta) = (cos(beta) + alpha) mu, alpha = 0.522, up to crushing.
    """
    state = la.solve(pressed_on_incline(0.2))
    assert state.status is Status.SOLVED
    upper = la.solve(pressed_on_incline(0.2), coupling="associated").load_factor
    assert np.sin(BETA) / 0.2 - np.cos(BETA) < state.load_factor <= upper + 1e-6


@pytest.mark.parametrize("friction", [la.SMOOTH, 0.3])
def test_free_without_dead_load(friction):
    """Nothing presses the block on its floor: no friction either."""
    ends(
        on_square(la.Traction("block", "left", (1, 0)), interfaces=[obstacle(friction=friction)]),
        Status.FREE,
    )


@pytest.mark.parametrize("coupling", ["certified", "reaction", "associated"])
def test_free_on_a_smooth_floor(coupling):
    problem = on_square(
        la.Traction("block", "left", (1, 0)),
        dead_loads=[la.Pressure("block", "top")],
        interfaces=[obstacle(friction=la.SMOOTH)],
    )
    ends(problem, Status.FREE, coupling=coupling)


def test_free_without_any_support():
    ends(la.Problem({"block": square()}, [la.Traction("block", "left", (1, 0))]), Status.FREE)


@pytest.mark.parametrize(
    "p",
    [
        1e-1,
        1e-2,
        1e-4,
    ],
)
def test_a_small_load_on_a_strong_block_is_not_free(p):
    """Sliding at mu p b/h = 1.2 p, far below the strength."""
    state = la.solve(deformable_block(0.3, p=p))
    assert state.status is Status.SOLVED
    assert state.load_factor == pytest.approx(1.2 * p, rel=1e-5)


def held_by_friction(mu=0.5):
    """Incline tan 0.309 < mu: the block stands; the live load lifts it off its base."""
    return on_square(
        la.Traction("block", "top", (0, 1)),
        dead_loads=[la.BodyForce("block", DOWN)],
        interfaces=[obstacle(friction=mu)],
    )


def test_invalid_start():
    """Without friction the dead load slides the block, and the live load cannot hold it."""
    state = ends(held_by_friction(), Status.INVALID_START, coupling="reaction", start="zero")
    assert "start='associated'" in state.message


def test_bounds_that_fail_in_the_loop_are_no_proof_of_collapse():
    """The same block from the associated start: frozen friction can only be too small.

    Lifting does not change the frozen bound, so the inner load is W cos(beta) or none: the
    reaction iteration cannot find W (cos(beta) - sin(beta)/mu), but the block is not unsafe.
    """
    ends(held_by_friction(), Status.NOT_CONVERGED, coupling="reaction")
    upper = la.solve(held_by_friction(), coupling="associated")
    assert upper.load_factor >= np.cos(BETA) - np.sin(BETA) / 0.5 - 1e-6


@pytest.mark.parametrize("start", ["associated", "zero"])
def test_not_converged(start):
    state = ends(
        deformable_block(0.3),
        Status.NOT_CONVERGED,
        coupling="reaction",
        start=start,
        max_iterations=1,
    )
    assert state.outer_iterations == 2
    assert state.point is not None, "the last iterate is there to be looked at"
    assert not state.certificate.holds(1e-6)


def test_the_solver_s_own_limit_is_passed_on():
    ends(
        deformable_block(0.3),
        Status.ITERATION_LIMIT,
        options={"max_iterations": 3},
        max_iterations=2,
    )


def test_not_certified():
    """A bar below what the solver's tolerance can reach."""
    ends(cantilever(), Status.NOT_CERTIFIED, tolerance=1e-15)


def test_status_texts_say_what_to_do():
    for status in Status:
        assert len(status.value) > 20
        assert status.label == status.name.lower().replace("_", " ")
    assert {s for s in Status if s.has_point} == {
        Status.SOLVED,
        Status.ALMOST_SOLVED,
        Status.STALLED,
        Status.ITERATION_LIMIT,
        Status.TIME_LIMIT,
    }


def test_free_without_friction_under_dead_load():
    blocks = la.BlockAssembly(
        {
            "floor": la.masonry.rectangle(-2, 2, -1, 0),
            "block": la.masonry.rectangle(-1, 1, 0, 1),
        },
        friction=0.5,
    )
    problem = la.Problem(
        bodies={"blocks": blocks},
        supports=[la.Fix("blocks", "floor")],
        reference_loads=[la.PointForce("blocks", "block", (1, 0))],
        dead_loads=[la.PointForce("blocks", "block", (0, -1))],
    )
    assert la.solve(problem, coupling="frictionless").status is Status.FREE
    assert la.solve(problem, throw=True).load_factor == pytest.approx(0.5, rel=1e-6)
