"""Pressures of water that are the same on all meshes of a bracket."""

import numpy as np
import pytest

import lacore as la
from lacore.bounds.bracket.kept_water import Interpolated, differs, kept

K = la.VonMises(1.0)


def body(nx, ny=1):
    return la.Body(la.meshes.rectangle((0, 2), (-1, 0), nx, ny), K)


def places(count=200, seed=0):
    return np.random.default_rng(seed).uniform([0, -1], [2, 0], (count, 2)).T


@pytest.mark.parametrize("seed", range(3))
def test_a_linear_function_is_its_own_interpolation(seed):
    """In every triangle, at its vertices, and on its edges."""
    a, b, c = np.random.default_rng(seed).uniform(-1, 1, 3)
    mesh = body(3, 2).mesh
    own = Interpolated(mesh, a + b * mesh.p[0] + c * mesh.p[1])
    for x in (places(), mesh.p, mesh.p[:, mesh.facets].mean(axis=1)):
        assert own(x) == pytest.approx(a + b * x[0] + c * x[1])


def test_between_vertices_it_is_linear_in_each_triangle():
    mesh = body(2, 1).mesh
    values = np.arange(1.0, mesh.nvertices + 1)
    shares = np.array([0.2, 0.3, 0.5])
    inside = np.einsum("dke,k->de", mesh.p[:, mesh.t], shares)
    assert Interpolated(mesh, values)(inside) == pytest.approx(shares @ values[mesh.t])


def bent(x):
    return 1 + x[0] ** 2


@pytest.mark.parametrize(
    "load",
    [la.PorePressure("soil", bent), la.StandingWater("soil", "top", bent)],
    ids=["pores", "standing"],
)
def test_water_is_kept_as_it_is_on_the_first_mesh(load):
    """On a finer mesh the function would be another one; its values between vertices are kept."""
    coarse = body(2)
    fine = la.Body(coarse.mesh.refined(1), K)
    assert differs(load, coarse, fine)
    assert not differs(load, coarse, coarse)
    own = kept(load, coarse)
    assert not differs(own, coarse, fine)
    middle = np.array([[0.5], [0.0]])
    assert own.pressure(middle) == pytest.approx((bent([0.0]) + bent([1.0])) / 2)


@pytest.mark.parametrize(("change", "other"), [(1e-6, True), (1e-12, False)])
def test_round_off_is_no_other_water(change, other):
    """Relative to the largest pressure, of one vertex alone."""
    coarse = body(2)
    values = np.full(coarse.mesh.nvertices, 7e4)
    moved = values.copy()
    moved[-1] *= 1 + change
    one, two = (Interpolated(coarse.mesh, own) for own in (values, moved))

    load = la.PorePressure("soil", lambda x: two(x) if x.shape[1] > 6 else one(x))
    assert differs(load, coarse, body(4)) is other


def test_other_loads_are_the_same_on_every_mesh():
    load = la.Pressure("soil", "top", 3.0)
    assert kept(load, body(2)) == load
    assert not differs(load, body(2), body(4))
    weight = kept(la.BodyForce("soil", (0.0, -1.0)), body(2))
    assert weight == la.BodyForce("soil", (0.0, -1.0))
