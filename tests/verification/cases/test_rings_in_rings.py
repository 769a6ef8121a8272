"""The pressure between two tubes: known where both flow, and not where one of them does not."""

from math import log

import numpy as np
import pytest

import lacore as la
from lacore_verification.cases import rings_in_rings
from lacore_verification.cases.hardening_cylinder import INNER, OUTER

JOINT = rings_in_rings.JOINT


def test_the_pressure_between_tubes_that_flow_is_that_of_the_outer_one():
    """Perfectly plastic, k = s0/sqrt(3): 2 k ln(b/c) on either side of meshes that do not match."""
    given = {"law": "perfect", "rows": 2, "slave": "inner", "steps": 1, "scheme": "explicit"}
    stated = rings_in_rings.path(**given)
    problem = rings_in_rings.build(16, **given)
    path = la.sequential(problem, 1e-3, 1, "explicit", stated.control)
    state = path.state(1)
    contact = state.discretisation.full.contact
    mean = np.average(state.point.normal_reaction, weights=contact.weights)
    assert mean == pytest.approx(2 / np.sqrt(3) * log(OUTER / JOINT), rel=1e-3)


@pytest.mark.parametrize("between", [0.1, 0.3])
def test_the_pressure_between_tubes_at_rest_is_not_known(between):
    """Both tubes carry any of these with the same pressure in the bore, below the limit."""
    bore = 0.4
    inner = [la.Pressure("tube", "left", bore), la.Pressure("tube", "right", between)]
    outer = [la.Pressure("tube", "left", between)]
    for radii, loads in (((INNER, JOINT), inner), ((JOINT, OUTER), outer)):
        mesh = la.meshes.quadrilaterals(radii, (0, 0.25), 4, 1)
        tube = la.Body(mesh, la.VonMises(1.0), kinematics="axisymmetric", space="q2")
        held = [la.Fix("tube", side, "y") for side in ("bottom", "top")]
        carried = la.solve(la.Problem({"tube": tube}, loads, held), backend="clarabel")
        assert carried.load_factor > 1.05
