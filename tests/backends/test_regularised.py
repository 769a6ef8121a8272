"""The regularised backends against the exact program at frozen reactions (T17-T20)."""

import numpy as np
import pytest

import lacore as la
from lacore.program.kinematic import dimensionless, reaction_contact
from lacore_backends.clarabel_socp import Clarabel, ClarabelOptions
from lacore_backends.ipopt_nlp import Ipopt, IpoptOptions
from tests.backends.variants import METALS
from tests.lacore.models import deformable_block, punch, square
from tests.shares import one_in

# Two interior-point solutions, each to a relative gap of 1e-11, on values of order one.
SOLVER = 1e-9


def frozen(problem):
    """The dimensionless program, its contact at the reactions of the limit state, exact value."""
    discretisation = la.discretise(problem)
    program = dimensionless(discretisation.program, discretisation.natural)
    state = la.solve(discretisation, throw=True)
    contact = reaction_contact(program.contact, state.point.normal_reaction / program.scales.stress)
    exact = Clarabel().prepare(program, ClarabelOptions(tolerance=1e-11)).solve(contact)
    return program, contact, exact.point.load_factor


def values(program, contact, r):
    return Ipopt().prepare(program, IpoptOptions(r=r)).solve(contact).regularised


@pytest.mark.parametrize("mesh", ["coarse", pytest.param("medium", marks=pytest.mark.slow)])
@pytest.mark.parametrize(("case", "variant"), METALS)
def test_three_values_bound_the_exact_one_from_below(case, variant, mesh):
    """T19 at r = 1e-3: P <= alpha_reg <= lambda <= alpha*, and lambda within 1e-3."""
    program, contact, exact = frozen(case.problem(variant, mesh))
    found = values(program, contact, 1e-3)
    assert found.plastic <= found.alpha_reg <= found.load_factor <= exact * (1 + SOLVER)
    assert found.load_factor >= exact * (1 - 1e-3)
    # The multiplier is P + 2 C at a minimiser and only there; IPOPT stops at 1e-9.
    assert found.multiplier == pytest.approx(found.load_factor, rel=1e-7)


@pytest.mark.parametrize("rough", one_in(2, [False, True]))
def test_orders_in_r(rough):
    """T19: halving r halves the error of alpha_reg; that of lambda is o(r), in the end r^2.

    Asymptotic from r = 1e-3 down, where the errors of lambda (1e-7 ... 1e-9) stay above the
    solvers' 1e-11. On the rough punch points still yield one by one in this range, so its order
    is only known to be above one.
    """
    program, contact, exact = frozen(punch(rough=rough))
    r = 1e-3 / 2.0 ** np.arange(4)
    found = [values(program, contact, each) for each in r]
    errors = {
        name: exact - np.array([getattr(value, name) for value in found])
        for name in ("alpha_reg", "load_factor")
    }
    assert errors["alpha_reg"][:-1] / errors["alpha_reg"][1:] == pytest.approx(2.0, rel=0.02)
    assert np.all(errors["load_factor"][:-1] / errors["load_factor"][1:] > 2.0)
    if not rough:
        order = np.polyfit(np.log(r), np.log(errors["load_factor"]), 1)[0]
        assert order == pytest.approx(2.0, abs=0.2)


@pytest.mark.parametrize("penalty", one_in(2, ["eta", "bulk", "normal", "tangential"]))
def test_each_penalty_alone_is_linear(penalty):
    """T19: alpha_reg is linear in 1/penalty, the other three held: halving halves its change.

    Held at r = 1e-4, they change the reactions by some 1e-3 of themselves: second order.
    """
    program, contact, _ = frozen(deformable_block(0.5, n=2))
    scales = program.scales
    unit = scales.stress / scales.velocity
    if penalty in ("eta", "bulk"):
        unit *= scales.length
    found = []
    for stiffness in (1e2, 2e2, 4e2):
        options = IpoptOptions(r=1e-4, **{penalty: stiffness * unit})
        found.append(Ipopt().prepare(program, options).solve(contact).regularised.alpha_reg)
    first, second = np.diff(found)
    assert first > 0
    assert first / second == pytest.approx(2.0, rel=0.02)


def test_options_in_si_units_are_those_of_r():
    """T20 by hand: eta = sigma L/(V r), K_c = 10 eta, K_n = K_t = 10 sigma/(V r)."""
    problem = deformable_block(0.5)
    scales = la.discretise(problem).natural
    r = 1e-2
    eta = scales.stress * scales.length / (scales.velocity * r)
    spring = 10 * scales.stress / (scales.velocity * r)
    by_r = la.solve(problem, "ipopt", options={"r": r})
    by_value = la.solve(
        problem,
        "ipopt",
        options={"eta": eta, "bulk": 10 * eta, "normal": spring, "tangential": spring},
    )
    assert by_value.regularised.alpha_reg == pytest.approx(by_r.regularised.alpha_reg, rel=1e-9)


@pytest.mark.parametrize(
    "friction",
    [
        0.3,
        *(
            pytest.param(law, marks=pytest.mark.slow)
            for law in (la.Coulomb(0.3, associated=True), la.Tresca(0.2), la.STICK)
        ),
    ],
)
def test_ipopt_and_slsqp_are_one_program(friction):
    """Two solvers, two codes of the laws (symbolic and numpy), one minimum at equal r.

    SLSQP leaves nodal forces out of balance by some 1e-7: second order in alpha_reg, first in
    lambda.
    """
    problem = deformable_block(friction)
    states = [
        la.solve(problem, name, options={"r": 0.1}, throw=True) for name in ("ipopt", "slsqp")
    ]
    a, b = (state.regularised for state in states)
    assert a.alpha_reg == pytest.approx(b.alpha_reg, rel=1e-9)
    assert a.load_factor == pytest.approx(b.load_factor, rel=1e-6)


@pytest.mark.parametrize("coupling", ["associated", "reaction"])
@pytest.mark.parametrize(("case", "variant"), METALS)
def test_newton_and_ipopt_are_one_program(case, variant, coupling):
    """At equal r the three values of T19 agree; both leave at most 1e-8 of the load unbalanced."""
    discretisation = la.discretise(case.problem(variant, "coarse"))
    a, b = (
        la.solve(discretisation, name, coupling, options={"r": 1e-3}, throw=True).regularised
        for name in ("newton", "ipopt")
    )
    for name in ("plastic", "alpha_reg", "load_factor"):
        assert getattr(a, name) == pytest.approx(getattr(b, name), rel=1e-6), name


@pytest.mark.parametrize("r", [1e-1, 1e-3, 1e-5])
def test_newton_converges_from_a_cold_start(r):
    """T21: no continuation, a number of iterations that hardly depends on r."""
    state = la.solve(punch(12, 8), "newton", options={"r": r}, throw=True)
    assert state.history.inner_iterations.iloc[0] <= 40


def test_all_backends_agree():
    """Value, power and total normal reaction on one mesh, to what T19 allows.

    lambda misses the exact value by less than C; the reaction resultant is fixed by the dead load.
    """
    discretisation = la.discretise(deformable_block(0.5))
    names = [name for name in la.backend_names() if not la.find_backend(name).capabilities.max_cone]
    states = {name: la.solve(discretisation, name, throw=True) for name in names}
    exact = states["clarabel"]
    for name, state in states.items():
        energy = state.regularised.energy if state.regularised else 1e-6
        assert state.load_factor == pytest.approx(exact.load_factor, abs=energy), name
        reactions = state.reactions
        # Vertical equilibrium with p b = 4; nodal forces balance to 1e-6 of the load.
        assert (reactions.t_n * reactions.length).sum() == pytest.approx(4.0, rel=1e-5), name
        power = state.discretisation.full.reference_load @ state.point.velocity
        assert power == pytest.approx(1.0, abs=1e-9), name


def test_slsqp_refuses_large_problems():
    """A sentence with the size, the limit and the way out, before any solve."""
    with pytest.raises(la.CapabilityError, match=r"at most 1200 .* coarser mesh.*'clarabel'"):
        la.solve(punch(24, 12), "slsqp")


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"r": -1.0}, "r = -1.0: not a positive number"),
        ({"eta": float("nan")}, "eta = nan"),
        ({"max_iterations": 0}, "max_iterations"),
        ({"tolerence": 1e-3}, "did you mean 'tolerance'"),
    ],
)
@pytest.mark.parametrize("backend", ["ipopt", "newton", "slsqp"])
def test_bad_options_are_named(backend, options, text):
    with pytest.raises(la.InputError, match=text):
        la.solve(deformable_block(0.3), backend, options=options)


@pytest.mark.parametrize("backend", ["ipopt", "slsqp"])
def test_a_continuation_that_does_not_end_is_refused(backend):
    with pytest.raises(la.InputError, match=r"reduction = 2\.0: outside"):
        la.solve(deformable_block(0.3), backend, options={"reduction": 2.0})


def test_iteration_and_time_limits_are_statuses():
    """A solver stopped early gives a name and no number."""
    for backend, options, status in (
        ("ipopt", {"max_iterations": 3}, la.Status.ITERATION_LIMIT),
        ("ipopt", {"time_limit": 1e-9}, la.Status.TIME_LIMIT),
        ("newton", {"max_iterations": 3}, la.Status.ITERATION_LIMIT),
        ("newton", {"time_limit": 1e-9}, la.Status.TIME_LIMIT),
        ("slsqp", {"max_iterations": 3}, la.Status.ITERATION_LIMIT),
        ("slsqp", {"time_limit": 1e-9}, la.Status.TIME_LIMIT),
    ):
        state = la.solve(deformable_block(la.STICK), backend, options=options)
        assert state.status is status, backend
        assert np.isnan(state.load_factor)
        assert state.rigor is la.Rigor.NOT_CERTIFIED


def test_every_ipopt_status_is_mapped():
    """The return codes of IPOPT (IpReturnCodes_inc.h), none without a meaning here."""
    from lacore_backends.ipopt_nlp import STATUS_MAP

    assert len(STATUS_MAP) == 20


def _held(**parts):
    return la.Problem({"block": square()}, **parts)


CORNERED = (
    la.Fix("block", "left", "x"),
    la.Fix("block", "right", "x"),
    la.Fix("block", "bottom", "y"),
)
NAMED = [
    pytest.param(
        _held(reference_loads=[la.Pressure("block", "top")], supports=CORNERED),
        la.Status.LOCKED,
        id="confined",
    ),
    pytest.param(
        _held(
            reference_loads=[la.Traction("block", "right", (1, 0))],
            supports=[la.Fix("block", "bottom")],
            dead_loads=[la.Traction("block", "top", (0, -5.0))],
        ),
        la.Status.UNSAFE,
        id="crushed by dead load",
    ),
    pytest.param(
        _held(
            reference_loads=[la.Traction("block", "right", (1, 0))],
            supports=[la.Fix("block", "bottom", "y")],
            dead_loads=[la.Pressure("block", "top", 1.0)],
        ),
        la.Status.FREE,
        id="on rollers",
    ),
]


@pytest.mark.parametrize(
    "backend", ["clarabel", "ipopt", "newton", pytest.param("slsqp", marks=pytest.mark.slow)]
)
@pytest.mark.parametrize(("problem", "status"), NAMED)
def test_what_has_no_limit_load_has_a_name(problem, status, backend):
    """T13, with penalties too: they make every program feasible, and hide what is not."""
    state = la.solve(problem, backend)
    assert state.status is status
    assert state.rigor is la.Rigor.NOT_CERTIFIED
    assert np.isinf(state.load_factor) == (status is la.Status.LOCKED)
