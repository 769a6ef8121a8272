"""A plate with a round hole, bounded strictly in spite of straight edges."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

import lacore as la
from lacore_verification.cases.plate_hole import RADIUS
from lacore_verification.catalogue.catalogue import find


@pytest.mark.slow
def test_plate_with_a_round_hole_is_bounded_strictly():
    """Less material carries less, and more carries more: a polygon around the hole, one in it."""
    case, (variant,) = find("plate-hole")
    level = {"n_radial": 4, "n_angular": 16, "ratio": 4.0}
    stated = case.build(**level)
    (body,) = stated.bodies.values()
    mesh = body.mesh
    # Further out by the secant of half the angle of a side, as much less as vertices are outside.
    reach = np.abs(mesh.p).max(axis=0)
    beyond = RADIUS * (1 / np.cos(pi / 4 / level["n_angular"]) - 1)
    radius = np.linalg.norm(mesh.p, axis=0)
    share = (1 - reach) / (1 - RADIUS * reach / radius)
    around = mesh.p * (1 + share * beyond / radius)
    lower, upper = (
        la.bracket(
            replace(
                stated,
                # The polygon is the body: bounds of either problem are strict.
                bodies={"plate": replace(body, mesh=polygon, geometry="exact")},
            ),
            0.003,
            max_elements=6000,
        )
        for polygon in (replace(mesh, doflocs=around), mesh)
    )
    for found in (lower, upper):
        assert found.status is la.Ending.REACHED
        assert found.strict
    assert lower.lower >= 0.797
    assert upper.upper <= 0.803
    assert lower.lower <= case.reference_of(variant).high
    assert upper.upper >= case.reference_of(variant).low
