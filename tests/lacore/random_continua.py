"""Random problems of continua on random meshes: anything that both bounds can state."""

import numpy as np
from scipy.spatial import Delaunay
from skfem import MeshTri

import lacore as la

SIDES = ("left", "right", "bottom", "top")


def delaunay_square(rng, inner=12, edge=3):
    """The unit square, its sides split evenly and `inner` random points inside."""
    s = np.linspace(0, 1, edge + 1)
    zero, one = np.zeros(edge + 1), np.ones(edge + 1)
    sides = np.concatenate(
        [np.stack(p) for p in ((s, zero), (s, one), (zero, s), (one, s))], axis=1
    )
    points = np.concatenate([np.unique(sides, axis=1), rng.uniform(0.1, 0.9, (2, inner))], axis=1)
    triangles = Delaunay(points.T).simplices.T
    corner = points[:, triangles]
    (ax, ay), (bx, by) = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    mesh = MeshTri(points, triangles[:, np.abs(ax * by - ay * bx) > 1e-9])
    return mesh.with_boundaries(
        {
            "left": lambda x: x[0] == 0,
            "right": lambda x: x[0] == 1,
            "bottom": lambda x: x[1] == 0,
            "top": lambda x: x[1] == 1,
        }
    )


def friction(rng):
    """Any law that has bounds."""
    return [
        la.SMOOTH,
        la.STICK,
        la.Tresca(float(rng.uniform(0.1, 1.5))),
        la.Coulomb(float(rng.uniform(0.05, 0.8)), associated=True),
    ][rng.integers(4)]


def problem(seed):
    """A random problem: supports, obstacles, footings, tractions and weights as they come."""
    rng = np.random.default_rng(seed)
    mesh = delaunay_square(rng, inner=int(rng.integers(4, 16)))
    strength = float(rng.uniform(0.5, 2.0))
    held, *others = rng.permutation(SIDES)
    supports, interfaces = [], []
    if rng.random() < 0.5:
        supports.append(la.Fix("block", str(held), ["xy", "normal", "xy"][rng.integers(3)]))
    else:
        interfaces.append(la.Interface(("block", str(held)), la.RigidObstacle(), friction(rng)))
    if rng.random() < 0.4:
        supports.append(la.Fix("block", str(others[1]), ["x", "y", "tangential"][rng.integers(3)]))
    loads = [
        la.Traction("block", str(others[0]), tuple(rng.uniform(-1, 1, 2))),
        la.Pressure("block", str(others[0]), float(rng.uniform(0.2, 1))),
        la.BodyForce("block", tuple(rng.uniform(-1, 1, 2))),
        la.RigidFooting(
            "block", str(others[0]), tuple(rng.uniform(-1, 1, 2)), rough=bool(rng.random() < 0.5)
        ),
    ]
    reference = loads[rng.integers(4)]
    dead = []
    if rng.random() < 0.5:
        dead.append(la.BodyForce("block", tuple(rng.uniform(-0.4, 0.4, 2))))
    if rng.random() < 0.3:
        dead.append(la.Pressure("block", str(others[2]), float(rng.uniform(0.1, 0.5))))
    body = la.Body(mesh, la.VonMises(shear_strength=strength))
    return la.Problem({"block": body}, [reference], supports, interfaces, dead)
