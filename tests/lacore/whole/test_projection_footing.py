"""A smooth footing that moves along its own face: no stress feels it, and no warning tells."""

import pytest

import lacore as la

MESH = la.meshes.rectangle((0, 2), (0, 1), 4, 2, crossed=True)


def problem(direction, dead=0.0, rough=False):
    return la.Problem(
        {"b": la.Body(MESH, la.VonMises(1.0))},
        [la.RigidFooting("b", "top", direction, rough=rough)],
        [la.Fix("b", "bottom")],
        dead_loads=[la.BodyForce("b", (0, -dead))] if dead else [],
    )


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("dead", [0.0, 1.0])
@pytest.mark.parametrize("direction", [(1, 0), (-1, 0)])
def test_along_its_face_it_carries_nothing(direction, dead):
    """Without friction no force along it: the load factor is 0, from below and from above."""
    stated = problem(direction, dead)
    assert la.lower_bound(stated).load_factor <= 1e-9
    above = la.upper_bound(stated)
    assert above.load_factor == pytest.approx(0.0, abs=1e-6) or above.status is la.Status.FREE
    assert la.solve(stated, throw=False).status is la.Status.FREE


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("dead", [0.0, 1.0])
def test_nearly_along_its_face_the_bounds_keep_their_order(dead):
    """What little presses is of the order of the lean."""
    stated = problem((1, -1e-3), dead)
    below, above = la.lower_bound(stated).load_factor, la.upper_bound(stated).load_factor
    assert 1e-3 < below <= above < 1e-2


@pytest.mark.filterwarnings("error")
def test_a_rough_one_shears_the_body_as_ever():
    """A sheared layer of free sides: no more than slip along a plane costs, k; in order."""
    stated = problem((1, 0), rough=True)
    below, above = la.lower_bound(stated).load_factor, la.upper_bound(stated).load_factor
    assert 0.5 < below <= above <= 1 + 1e-6
