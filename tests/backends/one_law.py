"""Answers of regularised solvers against the law of `lacore.program.regularization`."""

import numpy as np
import pytest

from lacore.program.regularization import evaluate
from lacore.reporting.status import Status


def check_law(program, contact, penalty, answer, gap):
    """Energies, stresses and reactions of an answer, whose gap is that per power."""
    if answer.status is not Status.SOLVED:  # its dead load collapses it, or none can
        assert answer.status in (Status.UNSAFE, Status.LOCKED)
        return
    at = evaluate(program, contact, penalty, answer.point.velocity)
    power = 1 + abs(answer.regularised.load_factor)
    power += abs(float(program.dead_load @ answer.point.velocity))
    assert answer.regularised.alpha_reg == pytest.approx(at.values.alpha_reg, abs=1e-6 * power)
    # Stresses are apart by d with w d^2/(2 K) <= gap; weights are 0.1 and more.
    stiffest = max(penalty.eta, penalty.bulk, penalty.normal, penalty.tangential)
    apart = 2 * np.sqrt(2 * stiffest * gap * power / 0.1)
    for found, wanted in (
        (answer.point.stress[0], at.state.stress[0]),
        (answer.point.mean_stress[0], at.state.mean_stress[0]),
        (answer.point.normal_reaction, at.state.normal_reaction),
        (answer.point.tangential_reaction, at.state.tangential_reaction),
    ):
        np.testing.assert_allclose(found, wanted, atol=apart)
