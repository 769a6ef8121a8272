"""Limits of the stress around the axis, of bodies that have no other way to carry a pressure."""

import numpy as np
import pytest

import lacore as la

LIMITED = [la.NoTension(1.0), la.Rankine(0.0, 1.0)]


@pytest.mark.parametrize("criterion", LIMITED)
def test_hoop_stress_beyond_the_strength_in_compression_is_seen(criterion):
    """Uniaxial compression around the axis, and along it: the strength is 1 in any direction."""
    form = criterion.conic_form("axisymmetric")
    own = form.surfaces_of(np.zeros(1, dtype=int))
    for stress in np.diag([-1.1, -1.1, -1.1]):  # (rr, zz, tt)
        rr, zz, tt = stress
        size = np.array([abs(rr - zz) / 2])
        mean = np.array([(rr + zz) / 2, tt - (rr + zz) / 2])
        assert own.beyond(size, mean) > 0.01
        assert own.beyond(size / 1.1, mean / 1.1) == pytest.approx(0.0, abs=1e-12)


def test_a_ring_without_tension_carries_its_hoop_stress():
    """Radii 1 and 2, pressed from outside: p 2 = 1 x 1, all of it around the axis."""
    mesh = la.meshes.rectangle((1, 2), (0, 0.5), 4, 1)
    ring = la.Body(mesh, la.NoTension(1.0), space="p2-gauss", kinematics="axisymmetric")
    problem = la.Problem(
        {"ring": ring}, [la.Pressure("ring", "right")], [la.Fix("ring", "bottom", "y")]
    )
    state = la.solve(problem)
    assert state.status is la.Status.SOLVED
    assert state.load_factor == pytest.approx(0.5, rel=0.05)  # of a coarse mesh
