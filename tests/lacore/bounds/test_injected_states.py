"""States that are wrong in exactly one way prove no bound."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import lacore as la
from lacore.bounds import lower as lower_module
from lacore.bounds import upper as upper_module
from lacore.bounds.stresses.attempt import Attempt
from lacore.bounds.velocity_projection import admissible_velocity
from lacore.limit.conversion import point_in_program
from lacore.program.certificate import certify
from lacore.program.kinematic import associated_contact, dimensionless
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Status
from tests.lacore.bounds.test_admissible_states import soil
from tests.lacore.models import CRITERION, cantilever
from tests.lacore.planted import flowing, flowing_field, on_free_unknowns

FLOWING = flowing()


@pytest.mark.parametrize("depth", [1e-9, 1e-3])
def test_a_velocity_that_penetrates_proves_no_upper_bound(monkeypatch, depth):
    """It falls with the dead load into the floor, and its load factor is too low by as much."""
    d, state = FLOWING
    sunk = on_free_unknowns(d, lambda x: flowing_field(x) - np.array([[0.0], [depth]]))
    monkeypatch.setattr(upper_module, "admissible_velocity", lambda program, velocity: sunk)
    bound = la.upper_bound(d)
    assert bound.status is la.Status.NOT_CERTIFIED
    assert np.isnan(bound.load_factor)
    monkeypatch.setattr(
        upper_module, "admissible_velocity", lambda program, velocity: state.velocity
    )
    assert la.upper_bound(d).load_factor == pytest.approx(state.load_factor, rel=1e-12)


def attempt_with(**residuals):
    d, state = FLOWING
    exact = certify(d.program, state, associated_contact(d.program.contact))
    perfect = dict.fromkeys(("equilibrium", "yield_violation", "cone"), 0.0)
    return Attempt(
        margin=0.0,
        inner=None,
        state=state,
        before=exact,
        after=replace(exact, **(perfect | residuals)),
        lacks=0.0,
        projection_time=0.0,
        exact=1e-12,
    )


def test_stresses_prove_a_lower_bound_where_nothing_is_violated():
    assert attempt_with().proves
    assert attempt_with(equilibrium=1e-13).proves  # round-off of sums
    assert attempt_with(gap=0.5, flow=0.5, penetration=0.5).proves  # residuals of velocities


@pytest.mark.parametrize(
    "wrong", [{"equilibrium": 1e-11}, {"yield_violation": 1e-15}, {"cone": 1e-15}], ids=str
)
@pytest.mark.parametrize("nan", [False, True])
def test_stresses_that_violate_one_law_prove_no_lower_bound(wrong, nan):
    assert not attempt_with(**(dict.fromkeys(wrong, np.nan) if nan else wrong)).proves


def varying_weight():
    """A weight that varies in elements, which needs quadratic stresses."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 1, 1)
    weight = la.Linear(-1.0, (0.5, 0.0), at=(0.0, 0.0))
    loads, supports = [la.BodyForce("b", (0.0, weight))], [la.Fix("b", "bottom")]
    return la.Problem({"b": la.Body(mesh, CRITERION)}, loads, supports)


@pytest.mark.parametrize(
    ("found", "asked"),
    [
        ([1.0, 0.9], [0.0, 1.001]),
        ([1.0, -2.0, -1.9], [0.0, 1.001, -2.002]),
        ([1.0, 1.5, 1.4], [0.0, 1.001, 1.5015]),
        ([-1.0, 0.5, 0.4], [0.0, -1.001, 0.5005]),
    ],
)
def test_a_load_factor_is_taken_where_strengths_were_reduced_for_it(monkeypatch, found, asked):
    """Quadratic stresses take of strengths in proportion to the load factor, of either sign.

    Strengths reduced for all load factors from 0 to 1.001 say nothing of -2.
    """
    values, seen = iter(found), []

    def scripted(model, most, *given):
        seen.append(most)
        found = SimpleNamespace(status=Status.SOLVED, load_factor=next(values))
        found.checked = lambda throw: found
        return found

    monkeypatch.setattr(lower_module, "_solved", scripted)
    monkeypatch.setattr(lower_module, "_bound", lambda solved, *given: solved)
    assert la.lower_bound(varying_weight()).load_factor == found[-1]
    assert seen == pytest.approx(asked)


@pytest.mark.parametrize("status", [Status.UNSAFE, Status.LOCKED, Status.NOT_CERTIFIED])
def test_a_solve_with_reduced_strengths_that_fails_is_reported_as_such(monkeypatch, status):
    """It has no load factor for which strengths could have been reduced too little."""
    solves = iter([(Status.SOLVED, 1.0), (status, np.nan)])

    def scripted(*given):
        status, load_factor = next(solves)
        return SimpleNamespace(status=status, load_factor=load_factor)

    def bound(solved, backend, options, settled, notes):
        return SimpleNamespace(checked=lambda throw: (solved.status, settled))

    monkeypatch.setattr(lower_module, "_solved", scripted)
    monkeypatch.setattr(lower_module, "_bound", bound)
    assert la.lower_bound(varying_weight()) == (status, True)


@pytest.mark.parametrize("claimed", [Status.NOT_CERTIFIED, Status.UNSAFE])
def test_a_claim_without_proof_proves_no_lower_bound(monkeypatch, claimed):
    """Without stresses there is no residual to report, only why the claim is not proven."""
    refuted = Finding(Kind.NO_STRESSES, severity=Severity.REASON)
    monkeypatch.setattr(lower_module, "prove_claim", lambda *given: (claimed, refuted, None))
    heavy = replace(cantilever(), dead_loads=[la.BodyForce("block", (0, -10.0))])
    bound = la.lower_bound(heavy)
    assert (bound.status, bound.rigor) == (claimed, la.Rigor.NOT_CERTIFIED)
    assert bound.certificate is bound.point is bound.ray is None
    assert np.isnan(bound.load_factor)
    assert np.isnan(bound.lost)
    assert bound.findings == (refuted,)


@pytest.mark.parametrize("space", ["p1-disc", "p2-disc"])
def test_a_jump_at_a_bond_gives_half_of_its_power_to_either_side(space):
    """Two squares of unlike strength that are bonded: shares of the gap are >= 0 and add up."""
    bodies = {
        name: la.Body(
            la.meshes.rectangle((0, 1), (low, low + 1), 2, 1), la.VonMises(strength), space=space
        )
        for name, low, strength in (("low", 0, 1.5), ("top", 1, 1.0))
    }
    problem = la.Problem(
        bodies,
        [la.Traction("top", "left", (1, 0))],
        [la.Fix("low", "bottom")],
        [la.Interface(("top", "bottom"), ("low", "top"), la.BOND)],
    )
    upper = la.upper_bound(problem)
    assert upper.discretisation.jumping
    identity = la.gap_identity(upper, la.lower_bound(problem))
    gap = identity.upper - identity.lower
    assert identity.total == pytest.approx(gap, abs=1e-9)
    assert identity.least >= -1e-9


@pytest.mark.parametrize("speed", [1e-5, 1e-3, 1e-1])
def test_contact_that_opens_stays_open(speed):
    """A velocity that is admissible already is its own projection, however slowly it opens."""
    d, _ = FLOWING
    lifted = on_free_unknowns(d, lambda x: flowing_field(x) + np.array([[0.0], [speed]]))
    assert np.allclose(admissible_velocity(d.program, lifted), lifted, rtol=0, atol=1e-9)


def test_soil_that_strains_is_not_rigid():
    """Parts that are taken for rigid prove a bound if their strains are round-off, else none."""
    d = soil()
    state = la.solve(d)
    program = dimensionless(d.program, d.natural)
    point = point_in_program(d, state.point)
    found = upper_module._bound(state, program, point, np.array([True]))
    (group,) = d.full.groups
    rates = np.linalg.norm(group.cone_vectors(found.velocity), axis=1)
    assert found.status is Status.NOT_CERTIFIED
    assert found.divergence == pytest.approx(group.weights @ rates / np.abs(found.velocity).max())


@pytest.mark.parametrize(
    ("status", "with_point"),
    [(Status.NOT_CERTIFIED, False), (Status.UNSAFE, True), (Status.LOCKED, True)],
)
def test_a_state_without_a_limit_state_has_no_upper_bound(status, with_point):
    """Its status is that of the bound, whether or not a point was kept."""
    d, _ = FLOWING
    state = replace(la.solve(d), status=status, load_factor=np.nan)
    bound = la.upper_bound(state if with_point else replace(state, point=None))
    assert (bound.status, bound.rigor) == (status, la.Rigor.NOT_CERTIFIED)
    assert np.isnan(bound.load_factor)
    assert np.isnan(bound.velocity).all()


@pytest.mark.parametrize(
    ("status", "rigor", "has_state", "criterion", "kinds"),
    [
        (Status.UNSAFE, la.Rigor.NOT_CERTIFIED, False, CRITERION, [Kind.NO_STRESSES]),
        (Status.LOCKED, la.Rigor.NOT_CERTIFIED, False, CRITERION, []),
        (Status.NOT_CERTIFIED, la.Rigor.NOT_CERTIFIED, False, CRITERION, []),
        (
            Status.NOT_CERTIFIED,
            la.Rigor.NOT_CERTIFIED,
            True,
            CRITERION,
            [Kind.STRESSES_NOT_ADMISSIBLE, Kind.COARSE_TOLERANCE],
        ),
        (
            Status.NOT_CERTIFIED,
            la.Rigor.NOT_CERTIFIED,
            True,
            la.MohrCoulomb(1e-9, 30.0),
            [Kind.STRESSES_NOT_ADMISSIBLE, Kind.STRENGTH_TOO_SMALL],
        ),
        (Status.SOLVED, la.Rigor.LOWER, True, CRITERION, [Kind.ADMISSIBLE_STRESSES]),
        (
            Status.SOLVED,
            la.Rigor.DISCRETE,
            True,
            CRITERION,
            [Kind.ADMISSIBLE_STRESSES, Kind.POLYGON],
        ),
    ],
)
@pytest.mark.parametrize("message", ["", "slow progress"])
def test_a_lower_bound_reports_what_is_proven_or_lacking(
    status, rigor, has_state, criterion, kinds, message
):
    """A negligible cohesion is not a matter of tolerances or meshes; other stresses are."""
    body = la.Body(la.meshes.rectangle((0, 1), (0, 1), 1, 1), criterion)
    full = SimpleNamespace(dead_load=np.array([1.0, -1.0]))
    model = SimpleNamespace(full=full, continua={"b": SimpleNamespace(body=body)})
    inner = SimpleNamespace(message=message, native_status="")
    after = attempt_with().after if has_state else None
    last = SimpleNamespace(after=after, inner=inner)
    found = lower_module._findings(model, status, rigor, last)
    assert [own.kind for own in found] == [*kinds, *([Kind.BACKEND] if message else [])]
