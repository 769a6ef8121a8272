"""What IPOPT is given, by CasADi, is the law that numpy evaluates: value, gradient, Hessian."""

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lacore.program.regularization import Penalties, evaluate
from lacore_backends.ipopt_nlp import _build
from tests.lacore.random_programs import N, frozen, random_program, random_step

PENALTY = Penalties(eta=3.0, bulk=7.0, normal=5.0, tangential=4.0)
CONTACTS = [frozen(0.6), frozen(0.6, shift=0.2), frozen(0.0, dilatancy=0.4, shift=-0.1)]


@pytest.mark.parametrize("make", [random_program, random_step])
@given(st.integers(0, 10_000), st.sampled_from(CONTACTS))
def test_one_law_in_two_codes(make, seed, contact):
    program = make(seed)
    problem, given_to_ipopt = _build(program, contact)
    u = np.random.default_rng(seed + 1).uniform(-1, 1, N)
    numbers = [PENALTY.eta, PENALTY.bulk, PENALTY.normal, PENALTY.tangential, 1.0]
    p = np.concatenate([numbers, contact.bound, contact.shift])
    at = evaluate(program, contact, PENALTY, u)

    value = ca.Function("f", [problem["x"], problem["p"]], [problem["f"]])(u, p)
    assert float(value) == pytest.approx(at.objective, rel=1e-12, abs=1e-12)
    again, gradient = given_to_ipopt["grad_f"](u, p)
    assert float(again) == pytest.approx(float(value), rel=1e-12)
    np.testing.assert_allclose(np.array(gradient).ravel(), at.gradient, rtol=1e-10, atol=1e-11)

    step = 1e-6  # central differences: 1e-12 of the third derivative, 1e-10 of round-off
    upper = np.array(ca.DM(given_to_ipopt["hess_lag"](u, p, 1.0, 0.0)))
    hessian = upper + np.triu(upper, 1).T
    along = np.random.default_rng(seed + 2).uniform(-1, 1, N)
    ahead, behind = (
        evaluate(program, contact, PENALTY, u + s * along).gradient for s in (step, -step)
    )
    kink = np.abs(ahead - 2 * at.gradient + behind).max()  # a point between two branches
    if kink < 1e-9:
        found = (ahead - behind) / (2 * step)
        np.testing.assert_allclose(hessian @ along, found, rtol=1e-5, atol=1e-5)
