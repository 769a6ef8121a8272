"""Clarabel on the regularised program: the same minimum as the others find, down to small r."""

from dataclasses import replace

import clarabel
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.sparse import csr_matrix

import lacore as la
from lacore.coupling.fixed_point import reaction_loop
from lacore.coupling.options import CouplingOptions
from lacore.coupling.run import Run
from lacore.program.certificate import certify
from lacore.program.kinematic import DissipationGroup, associated_contact, dimensionless
from lacore.program.regularization import Penalties, evaluate
from lacore.reporting.status import Status
from lacore.solvers.backend import find_backend
from lacore_backends._conic_form import ConicForm
from lacore_backends.clarabel_regularised import ClarabelRegularised, ClarabelRegularisedOptions
from lacore_backends.clarabel_socp import Clarabel, ClarabelOptions
from lacore_backends.newton import Newton
from tests.backends.test_clarabel import (
    LENGTH,
    SEQUENCE,
    W,
    group,
    no_contact,
    point_of_contact,
    program,
)
from tests.backends.test_clarabel import frozen as held
from tests.backends.test_clarabel import random_program as mixed_program
from tests.backends.test_regularised import NAMED, SOLVER, frozen
from tests.backends.variants import METALS
from tests.lacore.models import deformable_block, punch
from tests.lacore.random_programs import POINTS, random_program, random_step
from tests.lacore.random_programs import frozen as random_contact

TRIPLE = ("plastic", "alpha_reg", "load_factor")
ETA, KN, KT = 50.0, 200.0, 300.0


def prepared(stated, **options):
    return ClarabelRegularised().prepare(stated, ClarabelRegularisedOptions(**options))


def solve(stated, contact=None, **options):
    return prepared(stated, **options).solve(contact or held())


# By hand.


def test_one_cone():
    """T17: w (bound ||U|| - bound^2/(2 eta)) at U = F0; lambda is the rigid-plastic value."""
    stated = program([group(np.eye(2), [0, 0], 2.0, 3.0)], no_contact(2), [0.6, 0.8])
    answer = solve(stated, eta=ETA)
    energy = 2.0 * 3.0**2 / (2 * ETA)
    values = answer.regularised
    # The gap is 1e-10 at most, and P + 2 C doubles what C is off by.
    assert values.alpha_reg == pytest.approx(6.0 - energy, abs=1e-9)
    assert values.energy == pytest.approx(energy, abs=1e-8)
    assert values.load_factor == pytest.approx(6.0, abs=1e-8)
    assert values.multiplier == pytest.approx(6.0, abs=1e-8)
    assert answer.point.stress[0][0] == pytest.approx([1.8, 2.4], abs=1e-8)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_friction(sense):
    """T18: t_n = W/L presses by t_n/K_n; alpha = L g; C = L (t_n^2/K_n + g^2/K_t)/2."""
    answer = solve(point_of_contact((0.0, sense)), held([0.7]), normal=KN, tangential=KT)
    t_n = W / LENGTH
    assert answer.point.normal_reaction == pytest.approx([t_n], abs=1e-7)
    assert answer.point.tangential_reaction[0] == pytest.approx([-sense * 0.7], abs=1e-7)
    assert answer.point.velocity == pytest.approx([-t_n / KN, sense], abs=1e-8)
    energy = LENGTH * (t_n**2 / KN + 0.7**2 / KT) / 2
    assert answer.regularised.energy == pytest.approx(energy, abs=1e-8)
    assert answer.regularised.load_factor == pytest.approx(LENGTH * 0.7, abs=1e-8)


def test_dilatancy():
    """T18: the trial reaction on the edge of its cone: u_n = d |u_t| - t_n (1/K_n + d^2/K_t)."""
    answer = solve(point_of_contact(), held([0.0], dilatancy=0.4), normal=KN, tangential=KT)
    t_n = W / LENGTH
    lift = 0.4 - t_n * (1 / KN + 0.4**2 / KT)
    assert answer.point.velocity == pytest.approx([lift, 1.0], abs=1e-7)
    assert answer.point.tangential_reaction[0] == pytest.approx([-0.4 * t_n], abs=1e-7)
    assert answer.regularised.load_factor == pytest.approx(W * 0.4, abs=1e-7)


def test_stick():
    """K_t alone holds u_t = 1: lambda = L K_t, and nothing but a penalty carries it."""
    answer = solve(point_of_contact((0.0, 1.0)), held([np.inf]), normal=KN, tangential=KT)
    assert answer.status is Status.LOCKED
    assert answer.point is None
    assert answer.regularised.load_factor == pytest.approx(LENGTH * KT, rel=1e-8)


# The law that everybody shares.

LAWS = st.sampled_from(["smooth", "friction", "stick", "dilatant", "shifted"])


@pytest.mark.parametrize("make", [random_program, random_step])
@given(seed=st.integers(0, 10**6), law=LAWS)
def test_it_is_the_minimum_of_the_shared_law(make, seed, law):
    """The gradient of `evaluate`, which Clarabel never sees, is that of the load.

    A gap of 1e-10 in an energy of curvature K = 100 leaves stresses off by sqrt(2 K gap) = 1.4e-4;
    both are per multiplier where that is above one, as the gap is.
    """
    rng = np.random.default_rng(seed)
    stated = make(seed)
    stated = replace(stated, dead_load=0.05 * stated.dead_load)
    bound = {"friction": rng.uniform(0.1, 1, POINTS), "stick": np.inf}.get(law, 0.0)
    dilatancy = rng.uniform(0.1, 1, POINTS) if law in ("dilatant", "shifted") else 0.0
    shift = rng.uniform(0, 1, POINTS) if law == "shifted" else 0.0
    contact = random_contact(bound, dilatancy, shift)
    answer = solve(stated, contact, r=0.1)
    assume(answer.status is not Status.LOCKED)  # what r = 0.1 makes of a stiff program
    assert answer.status is Status.SOLVED
    multiplier = answer.regularised.multiplier
    bar = 1.4e-4 * max(1.0, abs(multiplier))
    law_at = evaluate(stated, contact, Penalties(10.0, 100.0, 100.0, 100.0), answer.point.velocity)
    assert law_at.gradient == pytest.approx(multiplier * stated.reference_load, abs=bar)
    mine, its = answer.point, law_at.state
    assert mine.stress[0] == pytest.approx(its.stress[0], abs=bar)
    assert mine.mean_stress[0] == pytest.approx(its.mean_stress[0], abs=bar)
    assert mine.normal_reaction == pytest.approx(its.normal_reaction, abs=bar)
    assert mine.tangential_reaction == pytest.approx(its.tangential_reaction, abs=bar)


def judged(problem, coupling, r, other):
    """Triples of T19 by Clarabel and another at frozen reactions, and the exact value."""
    stated, contact, exact = frozen(problem)
    if coupling == "associated":
        contact = associated_contact(stated.contact)
        exact = Clarabel().prepare(stated, ClarabelOptions(tolerance=1e-11)).solve(contact)
        exact = exact.point.load_factor
    mine = solve(stated, contact, r=r)
    # "Almost" is its own word: what follows judges both alike.
    assert mine.status in (Status.SOLVED, Status.ALMOST_SOLVED)
    certificate = certify(stated, mine.point, contact)
    # What the loop judges at 1e-6, by stresses that the solver leaves balanced to 1e-8.
    assert certificate.equilibrium <= 1e-7
    assert certificate.yield_violation <= 1e-7
    assert certificate.normalisation <= 1e-7
    return mine.regularised, other.prepare(stated, other.Options(r=r)).solve(contact), exact


@pytest.mark.parametrize("mesh", ["coarse", pytest.param("medium", marks=pytest.mark.slow)])
@pytest.mark.parametrize("coupling", ["associated", "reaction"])
@pytest.mark.parametrize(("case", "variant"), METALS)
def test_newton_finds_the_same_triple(case, variant, coupling, mesh):
    """T19 at equal r, and its order: P <= alpha_reg <= lambda <= alpha*.

    Newton leaves 1e-8 of the load unbalanced, Clarabel a gap of 1e-10: both first order in lambda,
    1e-6 as asked.
    """
    mine, newton, exact = judged(case.problem(variant, mesh), coupling, 1e-3, Newton())
    assert newton.status is Status.SOLVED
    for name in TRIPLE:
        other = getattr(newton.regularised, name)
        assert getattr(mine, name) == pytest.approx(other, rel=1e-6), name
    # A gap g leaves the elastic shares off by d with K d^2/2 <= g, and C = K e^2/2 by K e d at
    # most, 2 sqrt(C g): so much may lambda = alpha_reg + C be off, though alpha_reg only by g.
    off = 2 * np.sqrt(mine.energy * 1e-10)
    assert mine.plastic <= mine.alpha_reg <= mine.load_factor <= exact * (1 + SOLVER) + off
    assert mine.multiplier == pytest.approx(mine.load_factor, rel=1e-7)


@pytest.mark.parametrize("coupling", ["associated", "reaction"])
def test_ipopt_finds_the_same_triple(coupling):
    mine, ipopt, _ = judged(deformable_block(0.3), coupling, 1e-3, find_backend("ipopt"))
    for name in TRIPLE:
        other = getattr(ipopt.regularised, name)
        assert getattr(mine, name) == pytest.approx(other, rel=1e-6), name


@pytest.mark.parametrize("r", [1e-1, 1e-3, 1e-5])
@pytest.mark.parametrize("problem", [deformable_block(0.3), punch(rough=True)])
def test_any_r_is_certified(problem, r):
    """Nodal forces balance at any r, by duals that the gap proves to be the stresses of the law.

    The stresses of the law at the velocity found miss balance by 1e-3 at r = 1e-5.
    """
    state = la.solve(problem, "clarabel-regularised", options={"r": r}, throw=True)
    assert state.certificate.equilibrium <= 1e-7


# What is reported.


def test_unproven_duals_are_not_reported(monkeypatch):
    """Where the gap does not close, the stresses are those of the law at the velocity."""
    stated, contact, _ = frozen(deformable_block(0.3))
    proven = solve(stated, contact, r=1e-1).point
    monkeypatch.setattr(ConicForm, "complementary_energy", lambda form, z, contact: np.nan)
    unproven = solve(stated, contact, r=1e-1).point
    by_law = evaluate(stated, contact, Penalties(10.0, 100.0, 100.0, 100.0), unproven.velocity)
    assert np.array_equal(unproven.stress[0], by_law.state.stress[0])
    assert not np.array_equal(unproven.stress[0], proven.stress[0])
    assert unproven.stress[0] == pytest.approx(proven.stress[0], abs=1e-4)


class Planted:
    """A solver whose multiplier is wrong by a factor."""

    def __init__(self, solver, factor):
        self._solver, self._factor = solver, factor

    def solve(self, contact):
        answer = self._solver.solve(contact)
        wrong = self._factor * answer.regularised.multiplier
        return replace(answer, regularised=replace(answer.regularised, multiplier=wrong))


@pytest.mark.parametrize("name", ["clarabel-regularised", "ipopt", "newton", "slsqp"])
@pytest.mark.parametrize(("factor", "status"), [(1.0, "SOLVED"), (1 + 1e-5, "NOT_CERTIFIED")])
def test_a_wrong_multiplier_is_refused(name, factor, status):
    """T19: |multiplier - (P + 2 C)| is judged by the loop, whatever the backend says of itself."""
    d = la.discretise(deformable_block(la.Tresca(0.2)))
    stated = dimensionless(d.program, d.natural)
    backend = find_backend(name)
    solver = Planted(backend.prepare(stated, backend.Options(r=0.1)), factor)
    coupled = reaction_loop(Run(stated, solver, True, CouplingOptions(), lambda iterate: None))
    assert coupled.final.inner.status is Status.SOLVED
    assert coupled.status is Status[status]


# Repeated solves.


def test_repeated_solves_are_fresh_solves():
    stated = mixed_program(np.random.default_rng(0))
    solver = prepared(stated)
    for contact in SEQUENCE:
        one, other = solver.solve(contact), solve(stated, contact)
        assert one.status is other.status is Status.SOLVED
        assert one.regularised.alpha_reg == pytest.approx(other.regularised.alpha_reg, abs=1e-8)
        # As close as exact solves of it come (test_clarabel.same).
        assert one.point.velocity == pytest.approx(other.point.velocity, abs=1e-4)


def test_a_change_of_costs_builds_nothing(monkeypatch):
    built, build = [], clarabel.DefaultSolver
    monkeypatch.setattr(clarabel, "DefaultSolver", lambda *given: built.append(1) or build(*given))
    solver = prepared(mixed_program(np.random.default_rng(0)))
    for contact in SEQUENCE[:3]:  # bounds, then shifts
        assert solver.solve(contact).status is Status.SOLVED
    assert len(built) == 1
    solver.solve(SEQUENCE[3])
    assert len(built) == 2


def test_empty_groups():
    empty = DissipationGroup(
        "nothing", csr_matrix((0, 2)), 2, np.zeros(0), np.zeros(0), csr_matrix((0, 2)), 1.0
    )
    stated = program([empty, group(np.eye(2), [0, 0], 2.0, 3.0)], no_contact(2), [0.6, 0.8])
    answer = solve(stated)
    assert answer.regularised.load_factor == pytest.approx(6.0, abs=1e-7)
    assert [stress.shape for stress in answer.point.stress] == [(0, 2), (1, 2)]


# Statuses.


@pytest.mark.parametrize(("problem", "status"), NAMED)
def test_what_has_no_limit_load_has_a_name(problem, status):
    assert la.solve(problem, "clarabel-regularised").status is status


@pytest.mark.parametrize(
    ("options", "status"),
    [
        ({"max_iterations": 1}, Status.ITERATION_LIMIT),
        ({"time_limit": 1e-9}, Status.TIME_LIMIT),
    ],
)
def test_limits_leave_a_point(options, status):
    answer = solve(mixed_program(np.random.default_rng(0)), SEQUENCE[0], **options)
    assert answer.status is status
    assert np.all(np.isfinite(answer.point.velocity))


def test_unbounded_is_unsafe():
    """A dead load of 3 along a frozen friction of L g = 1.4."""
    answer = solve(point_of_contact((1.0, 0.0), (-W, 3.0)), held([0.7]))
    assert answer.status is Status.UNSAFE
    assert answer.point is None


@pytest.mark.parametrize("name", ["r", "eta", "bulk", "normal", "tangential", "tolerance"])
def test_options_refuse(name):
    with pytest.raises(la.InputError, match=name):
        la.solve(deformable_block(0.3), "clarabel-regularised", options={name: -1.0})
