"""Smooth footings on arcs: a pile section that clay flows around, and slides along."""

import numpy as np
import pytest

import lacore as la


def bent(x):
    return x[0] * np.array([np.cos(np.pi / 2 * x[1]), np.sin(np.pi / 2 * x[1])])


def chords():
    """A polygon in place of the quarter ring."""
    flat = la.meshes.rectangle((1, 5), (0, 1), 6, 6)
    return type(flat)(bent(flat.p), flat.t).with_boundaries(
        {
            "pile": lambda x: np.hypot(*x) < 1.01,
            "below": lambda x: x[1] < 1e-9,
            "behind": lambda x: x[0] < 1e-9,
        }
    )


def pushed(space, rough=False):
    """A quarter of the ground around a pile that pushes it away."""
    if space == "q2":
        flat = la.meshes.quadrilaterals((1, 5), (0, 1), 6, 6)
        mesh, names, how = la.meshes.isoparametric(flat, bent), ("left", "bottom", "top"), {}
    else:
        mesh, names = chords(), ("pile", "below", "behind")
        how = {"geometry": "approximated"}
    pile, below, behind = names
    return la.Problem(
        {"clay": la.Body(mesh, la.VonMises(1.0), space=space, **how)},
        [la.RigidFooting("clay", pile, (1, 0), rough=rough)],
        [la.Fix("clay", below, "y"), la.Fix("clay", behind, "x")],
    )


@pytest.fixture(scope="module")
def jumping():
    """Of velocities that jump: each edge has nodes of its own, along which it slides."""
    return la.solve(pushed("p2-disc"), throw=True).load_factor


@pytest.mark.parametrize("space", ["p2-vertex", "p2-gauss", "q2"])
def test_continuous_velocities_slide_along_arcs_as_jumping_ones_do(space, jumping):
    """With two normals at each vertex they would stick: 1.3 to 1.4 times as much."""
    found = la.solve(pushed(space), throw=True)
    assert found.load_factor == pytest.approx(jumping, rel=0.02)
    assert found.rigor is la.Rigor.DISCRETE


def test_a_rough_pile_sticks(jumping):
    assert la.solve(pushed("p2-disc", rough=True)).load_factor > 1.1 * jumping


def test_upper_bounds_slide_along_the_edges(jumping):
    """Those of the polygon, in a space whose velocities jump: a bracket takes it by itself."""
    with pytest.raises(la.InputError, match=r"rough = False.*'p2-disc'"):
        la.upper_bound(pushed("p2-vertex"))
    found = la.bracket(pushed("p2-vertex"), 0.2)
    assert found.upper <= jumping * (1 + 1e-6)
    assert found.lower < found.upper
    assert found.width < 0.2


def test_a_corner_that_is_meant_holds_in_both_directions():
    """A square pile: at its corner the ground cannot slide along both sides."""
    mesh = la.meshes.rectangle((0, 2), (0, 2), 4, 4)
    keep = np.flatnonzero(~np.all(mesh.p[:, mesh.t].mean(axis=1) < 1, axis=0))
    ground = mesh.restrict(keep).with_boundaries(
        {"pile": lambda x: (x[0] <= 1) & (x[1] <= 1) & ((x[0] == 1) | (x[1] == 1))}
    )
    body = la.Body(ground, la.VonMises(1.0), geometry="approximated")
    problem = la.Problem(
        {"ground": body},
        [la.RigidFooting("ground", "pile", (1, 0), rough=False)],
        [la.Fix("ground", lambda x: x[1] == 0, "y"), la.Fix("ground", lambda x: x[0] == 0, "x")],
    )
    corner = np.flatnonzero(np.all(ground.p == 1, axis=0))
    state = la.solve(problem, throw=True)
    speed = state.velocity["ground"][:, corner].ravel()
    assert speed == pytest.approx([0.5, 0.0], abs=1e-6)  # of 2 m of pile, at F0.u = 1
