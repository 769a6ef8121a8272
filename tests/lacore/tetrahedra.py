"""Small problems of tetrahedra, and what one needs to look at their stresses."""

import numpy as np

import lacore as la

CRITERION = la.VonMises(shear_strength=1.0)
SPACES = ("p2-vertex", "p1-disc", "p2-disc")


def cube(space="p2-disc", n=1, crossed=False, mesh=None, load=None, criterion=CRITERION):
    """An eighth of a block between smooth platens: sqrt(3) k."""
    mesh = la.meshes.box((0, 1), (0, 1), (0, 1), n, n, n, crossed) if mesh is None else mesh
    return la.Problem(
        bodies={"block": la.Body(mesh, criterion, kinematics="3d", space=space)},
        reference_loads=[load or la.Pressure("block", "top")],
        supports=[la.Fix("block", side, "normal") for side in ("left", "front", "bottom")],
    )


def under_strip(x):
    return (x[2] == 0) & (x[0] <= 1)


def strip(space="p2-disc", n=4, rough=False, crossed=False, criterion=CRITERION):
    """Half of a strip footing on a slab one element thick, symmetric on both faces: 2 + pi."""
    mesh = la.meshes.box((0, 2.5), (0, 0.5), (-1.25, 0), n + 1, 1, n, crossed, (1.0, 2.0))
    return la.Problem(
        bodies={"soil": la.Body(mesh, criterion, kinematics="3d", space=space)},
        reference_loads=[la.RigidFooting("soil", under_strip, (0, 0, -1), rough=rough)],
        supports=[
            *(la.Fix("soil", side, "normal") for side in ("left", "front", "back")),
            *(la.Fix("soil", side, "xyz") for side in ("right", "bottom")),
        ],
    )


def gradients(p, t):
    """Gradients of barycentric coordinates, (elements, 4, 3), and volumes."""
    corner = p.T[t.T]
    matrix = np.concatenate([np.ones((*corner.shape[:2], 1)), corner], axis=2)
    inverse = np.linalg.inv(matrix)
    return inverse[:, 1:].transpose(0, 2, 1), np.abs(np.linalg.det(matrix)) / 6


def tensors(stress):
    """Matrices of stresses (xx, yy, zz, xy, yz, zx)."""
    xx, yy, zz, xy, yz, zx = np.moveaxis(stress, -1, 0)
    return np.stack(
        [np.stack([xx, xy, zx], -1), np.stack([xy, yy, yz], -1), np.stack([zx, yz, zz], -1)], -2
    )


def torsion(space, n, crossed=False):
    """A bar of 2 by 2 by 1, one end held along its section: torque k a^3/3 = 8/3, a = 2."""
    mesh = la.meshes.box((-1, 1), (-1, 1), (0, 1), 2 * n, 2 * n, n, crossed)
    return la.Problem(
        bodies={"bar": la.Body(mesh, CRITERION, kinematics="3d", space=space)},
        reference_loads=[la.Twist("bar", "top", (0, 0, 1))],
        supports=[la.Fix("bar", "bottom", axis) for axis in ("x", "y")],
    )
