"""Motions of bodies whose rates and moments are known in closed form."""

import numpy as np
import pytest

import lacore as la
from lacore.model.bodies.blocks.dofs import RigidDofs
from lacore.model.bodies.continuum.strain_rates import equivalent_rate, principal_rates
from tests.lacore.model.bodies.blocks3d.solids import box


@pytest.mark.parametrize("criterion", [la.VonMises(1.0), la.MohrCoulomb(1.0, 30)])
def test_a_ring_that_widens_strains_around_its_axis(criterion):
    """u = (r, -2 z): rates 1 along r and around the axis, -2 along z; equivalent 2 everywhere."""
    mesh = la.meshes.rectangle((1, 2), (3, 5), 2, 2)
    body = la.Body(mesh, criterion, space="p2-gauss", kinematics="axisymmetric")
    d = la.discretise(
        la.Problem({"ring": body}, [la.Pressure("ring", "right")], [la.Fix("ring", "bottom", "y")])
    )
    dofs = d.continua["ring"]
    velocity = np.zeros(d.full.n)
    velocity[dofs.dofs] = dofs.nodes * np.array([[1.0], [-2.0]])
    rates = np.sort(principal_rates(dofs, velocity[dofs.dofs]), axis=0)
    assert np.allclose(rates.T, [-2.0, 1.0, 1.0], atol=1e-12)
    assert np.allclose(equivalent_rate(dofs, d.full.groups, velocity), 2.0, rtol=1e-12)


def plane_block():
    return la.BlockAssembly({"block": la.masonry.rectangle(0, 3, 0, 1)}, friction=0.5)


def solid_block():
    return la.BlockAssembly3D({"block": box((0, 0, 0), (3, 1, 2))}, friction=0.5)


@pytest.mark.parametrize(
    ("body", "centroid", "force", "point"),
    [
        (plane_block(), (1.5, 0.5), (0.0, 2.0), (3.0, 0.5)),
        (solid_block(), (1.5, 0.5, 1.0), (0.0, 2.0, 1.0), (3.0, 1.0, 1.0)),
    ],
    ids=["plane", "solid"],
)
def test_a_support_exerts_the_force_and_the_moment_of_a_load(body, centroid, force, point):
    """About the centroid of the held block, whatever its radius."""
    dofs = RigidDofs(body, 0)
    load = la.PointForce("b", point, force)
    place, found = dofs.support_forces(-dofs.force(load), [la.Fix("b", "block")])
    lever = np.zeros((2, 3))  # and the force, in space
    lever[:, : len(point)] = np.subtract(point, centroid), force
    moment = np.cross(*lever)[-1:] if len(point) == 2 else np.cross(*lever)
    assert place[:, 0] == pytest.approx(centroid)
    assert found[:, 0] == pytest.approx(-np.append(force, moment))
