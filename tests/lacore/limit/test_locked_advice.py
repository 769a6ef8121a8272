"""Advice on a body that is locked on its mesh."""

import pytest

import lacore as la


@pytest.mark.parametrize("space", ["p2-vertex", "p2-disc"])
def test_advice_on_a_locked_body_recommends_no_space_that_it_has(space):
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    sides = ("left", "right", "bottom", "top")
    state = la.solve(
        la.Problem(
            bodies={"clay": la.Body(mesh, la.VonMises(1.0), space=space)},
            supports=[la.Fix("clay", side, "normal") for side in sides[:3]],
            reference_loads=[la.Pressure("clay", "top", 1.0)],
        )
    )
    assert state.status is la.Status.LOCKED
    assert "refine the mesh" in state.message
    assert ("take the space 'p2-disc'" in state.message) == (space != "p2-disc")
