"""The laws that IPOPT is given of soils, beside those of `lacore.program.regularization`."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lacore.program.regularization import penalties
from lacore_backends._barrier_laws import BarrierLaw
from lacore_backends._barrier_program import BarrierSolver, Fading
from lacore_backends._conic_laws import ConicLaws
from tests.backends.one_law import check_law
from tests.lacore.random_programs import N, frozen, random_program, random_soil, random_step

R, TOLERANCE = 0.1, 1e-9
KINDS = [random_program, random_step, random_soil]
CONTACTS = [
    frozen(0.6),
    frozen(0.0, shift=0.1),
    frozen([np.inf, 0.5, 0.0], dilatancy=[0.0, 0.0, 0.4], shift=[0.0, 0.2, -0.1]),
]
GAP = 1e-9  # ten times what mu leaves at the end, and round-off of powers


def laws_of(program, contact):
    laws = ConicLaws(program, contact, penalties(program.scales, R))
    return [BarrierLaw(law) for law in laws.each]


@pytest.mark.parametrize("make", KINDS)
@given(st.integers(0, 10_000), st.sampled_from(CONTACTS), st.sampled_from([1.0, 1e-3, 1e-6, 1e-10]))
def test_rates_are_shared_and_the_gap_is_known(make, seed, contact, mu):
    """``C sigma + G^T z = x`` and ``t.z = mu`` a plane, with stresses within yield."""
    velocity = np.random.default_rng(seed).uniform(-1, 1, N)
    for own in laws_of(make(seed), contact):
        law, found = own.law, own.at(velocity, mu)
        assert found.sound
        left = law.rates(velocity) + law.prescribed - found.stress * law.compliance
        gap = 0.0
        for cones, z in zip(law.cones, found.multipliers, strict=True):
            left = left - cones.rates(z)
            t = cones.strength(z) - cones.used(found.stress)
            for part in (t, z):
                # Within 1e-12 of strengths and rates of about 1: what is left of them is mu.
                assert np.all(part[..., 0] - np.linalg.norm(part[..., 1:], axis=-1) >= -1e-12)
            gap += float(law.weights @ np.sum(t * z, axis=(1, 2)))
        np.testing.assert_allclose(left, 0.0, atol=1e-9)
        # Rooms are found to round-off of strengths, beside rates of up to 10.
        assert gap == pytest.approx(mu * own.volume, rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("make", KINDS)
@given(st.integers(0, 10_000), st.sampled_from(CONTACTS))
def test_derivatives(make, seed, contact):
    """Forces are those of the energy, the stiffness that of the forces: central differences.

    At mu = 0.01 curvatures change over rates of no less than 1e-3: steps of 1e-5 leave 1e-4 of
    them, relative.
    """
    rng, step = np.random.default_rng(seed), 1e-5
    velocity, along = rng.uniform(-1, 1, N), rng.uniform(-1, 1, N)
    for own in laws_of(make(seed), contact):
        law = own.law
        at, ahead, behind = (own.at(velocity + s * step * along, 0.01) for s in (0, 1, -1))
        power = law.force(at.stress) @ along
        assert (ahead.energy - behind.energy) / (2 * step) == pytest.approx(power, abs=1e-3)
        rates = np.asarray(law.rows @ along).reshape(-1, law.dim)
        more = np.einsum("mij,mj->mi", at.stiffness, rates)
        slope = (ahead.stress - behind.stress) / (2 * step) * law.weights[:, None]
        size = 1 + np.abs(more).max(initial=0.0)
        np.testing.assert_allclose(slope, more, atol=1e-2 * size)


@pytest.mark.parametrize("make", KINDS)
@pytest.mark.parametrize("contact", CONTACTS)
@pytest.mark.parametrize("seed", range(2))
def test_one_law_in_two_forms(make, seed, contact):
    """Energies, stresses and reactions of the answer are those of the law at its velocity."""
    program = make(seed)
    penalty = penalties(program.scales, R)
    answer = BarrierSolver(program, penalty, Fading(0.1, TOLERANCE, 300, 60.0)).solve(contact)
    check_law(program, contact, penalty, answer, GAP)
