"""A body in contact with itself: the same as two bodies that are bonded where it is whole."""

from dataclasses import replace

import numpy as np
import pytest
from skfem import MeshQuad

import lacore as la
from lacore.model.meshes.curved import jacobians
from tests.lacore.paths.test_path_remesh import require_gmsh

SLOT, MIDDLE = 0.2, 0.6  # m: height of the slot between the arms of a hairpin, and of its middle
TRAVEL, STEPS = 0.25, 4


def hairpin():
    """Arms 0.5 m thick and 2.5 m long, joined by a web on the left."""
    x = np.r_[np.linspace(0, 0.5, 3)[:-1], np.linspace(0.5, 3, 6)]
    low = np.linspace(0, 0.5, 3)
    mesh = MeshQuad.init_tensor(x, np.r_[low, MIDDLE, low + 0.5 + SLOT])
    x, y = mesh.p[:, mesh.t].mean(axis=1)
    return mesh.restrict(np.flatnonzero((x < 0.5) | (np.abs(y - MIDDLE) > SLOT / 2)))


def named(mesh):
    x, y = mesh.p[:, mesh.facets].mean(axis=1)
    outer = np.isin(np.arange(mesh.nfacets), mesh.boundary_facets())
    inner = outer & (x > 0.6) & (x < 2.9) & (y > 0.1) & (y < 1.1)
    parts = {
        "lower": inner & (y < MIDDLE),
        "upper": inner & (y > MIDDLE),
        "top": outer & (y > 1.19) & (x > 2.4),
        "bottom": outer & (y < 0.01),
        "seam": outer & (np.abs(y - MIDDLE) < 0.01) & (x < 0.5),
    }
    return mesh.with_boundaries({n: np.flatnonzero(own) for n, own in parts.items() if own.any()})


def squeezed(bodies, low, high, slave, master, **more):
    """The end of the upper arm is pushed down by more than the height of the slot."""
    metal = la.VonMises(hardening=la.hardening.Linear(1.0, slope=0.5))
    seams = [la.Interface((low, "seam"), (high, "seam"), la.BOND)] if low != high else []
    problem = la.Problem(
        {name: la.Body(named(mesh), metal, space="q2") for name, mesh in bodies.items()},
        [la.RigidFooting(high, "top", (0, -1), rough=False)],
        [la.Fix(low, "bottom")],
        seams,
    )
    contact = [la.Interface(slave, master, 0.2)]
    return la.sequential(problem, TRAVEL, STEPS, approaching=contact, **more)


def one(slave="lower", master="upper", **more):
    sides = (("pin", slave), ("pin", master))
    return squeezed({"pin": hairpin()}, "pin", "pin", *sides, **more)


def two():
    mesh = hairpin()
    y = mesh.p[1, mesh.t].mean(axis=0)
    bodies = {
        "low": mesh.restrict(np.flatnonzero(y < MIDDLE)),
        "high": mesh.restrict(np.flatnonzero(y > MIDDLE)),
    }
    return squeezed(bodies, "low", "high", ("low", "lower"), ("high", "upper"))


@pytest.mark.slow
def test_arms_that_close_are_like_two_bonded_bodies():
    folded, turned, apart = one(), one("upper", "lower"), two()
    for other in (turned, apart):
        assert folded.message == other.message
        for name, within in (("force", 1e-5), ("volume", 1e-6)):
            assert folded.history[name].to_numpy() == pytest.approx(
                other.history[name].to_numpy(), rel=within
            )
        assert folded.history["overlap"].to_numpy() == pytest.approx(
            other.history["overlap"].to_numpy(), abs=1e-5
        )
    force = folded.history["force"].to_numpy()
    assert force[-1] > 5 * force[0]  # the arms bend until they meet
    assert "contact closed" in set(folded.events["kind"])
    assert folded.history["overlap"].max() < 1e-3 * SLOT
    assert folded.history["gap"].max() < 1e-6
    assert folded.state().reactions["t_n"].max() > 0


def test_new_meshes_of_arms_that_touch():
    """The arms overlap by less than an edge is wide, as they do at the end of a step."""
    require_gmsh()
    mesh = named(hairpin())
    x, y = mesh.p
    down = np.where(y > MIDDLE, (SLOT + 1e-4) * np.clip((x - 0.5) / 0.5, 0, 1), 0)
    closed = replace(mesh, doflocs=np.stack([x, y - down]))
    new = la.meshes.remeshed(closed, size=0.3)
    assert sorted(new.boundaries) == sorted(closed.boundaries)
    area = np.sum(jacobians(closed).mean(axis=1))
    assert np.sum(jacobians(new).mean(axis=1)) / 2 == pytest.approx(area, rel=1e-9)
    assert jacobians(new).min() > 0


def test_parts_of_a_boundary_that_cannot_meet():
    with pytest.raises(la.InputError, match="contain the same 5 edges; give the two parts"):
        one("lower", "lower")
    body = la.Body(named(hairpin()), la.VonMises(1.0), space="q2")
    block = la.RigidBlock([(2.5, 1.2), (3, 1.2), (3, 1.4), (2.5, 1.4)])
    problem = la.Problem(
        {"pin": body, "block": block},
        [la.PointForce("block", "block", (0, -1))],
        [la.Fix("pin", "bottom"), la.Fix("block", "block", "x")],
        [la.Interface(("pin", "top"), ("block", "block"), 0.0)],
    )
    itself = la.Interface(("block", "block"), ("block", "block"), 0.0)
    with pytest.raises(la.InputError, match="a rigid block does not touch itself"):
        la.sequential(problem, 0.1, 1, approaching=[itself])
