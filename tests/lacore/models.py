"""Small problems that the tests share."""

import numpy as np

import lacore as la

CRITERION = la.VonMises(shear_strength=1.0)


def square(n=2, **body):
    """Unit square [0, 1] x [0, 1], k = 1."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), n, n)
    return la.Body(mesh, CRITERION, **body)


def obstacle(where="bottom", friction=0.3, body="block"):
    """The boundary `where` against a rigid obstacle of its shape."""
    return la.Interface(slave=(body, where), master=la.RigidObstacle(), friction=friction)


def deformable_block(friction, n=1, b=4.0, h=1.0, p=1.0, space="p2-vertex"):
    """CLOSED_FORMS C14 with k = 1: alpha = min(mu p b/h, p + 2 k), no toppling for b = 4 h."""
    mesh = la.meshes.rectangle((0, b), (0, h), 4 * n, n)
    return la.Problem(
        bodies={"block": la.Body(mesh, CRITERION, space=space)},
        interfaces=[obstacle(friction=friction)],
        reference_loads=[la.Traction("block", "left", (1, 0))],
        dead_loads=[la.Pressure("block", "top", p)],
    )


def under_footing(x):
    return (x[1] == 0) & (x[0] <= 1)


def punch(nx=6, ny=4, rough=True, space="p2-vertex", dead=()):
    """Half of the Prandtl punch: half-width 1, half model [0, 4] x [-2, 0]; exact 2 + pi."""
    mesh = la.meshes.rectangle((0, 4), (-2, 0), nx, ny, grade_x=(1.0, 12.0), grade_y=(0.0, 12.0))
    return la.Problem(
        bodies={"soil": la.Body(mesh, CRITERION, space=space)},
        supports=[
            la.Fix("soil", "bottom"),
            la.Fix("soil", "right"),
            la.Fix("soil", "left", components="x"),
        ],
        reference_loads=[la.RigidFooting("soil", under_footing, (0, -1), rough=rough)],
        dead_loads=dead,
    )


def cantilever():
    """A square held at its left edge and pulled down at its top: no contact."""
    return la.Problem(
        bodies={"block": square()},
        supports=[la.Fix("block", "left")],
        reference_loads=[la.Traction("block", "right", (0, -1))],
    )


def polynomial(rng, degree=2):
    """A random plane vector field, polynomial of a degree: functions of x (2, n) -> (2, n).

    Returns the field and its gradient ``g[i, j] = d u_i / d x_j`` of shape (2, 2, n).
    """
    powers = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]
    c = rng.uniform(-1, 1, (2, len(powers)))

    def field(x):
        return c @ np.stack([x[0] ** i * x[1] ** j for i, j in powers])

    def gradient(x):
        dx = np.stack([i * x[0] ** max(i - 1, 0) * x[1] ** j for i, j in powers])
        dy = np.stack([j * x[0] ** i * x[1] ** max(j - 1, 0) for i, j in powers])
        return np.stack([c @ dx, c @ dy], axis=1)

    return field, gradient


def sheared(dilation, cells=2, confined=1.0, cohesion=1.0):
    """A layer of soil of 30 degrees between rough plates, one of which moves along it."""
    mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=2 * cells, ny=cells)
    soil = la.MohrCoulomb(cohesion, 30.0, dilation_angle=dilation)
    return la.Problem(
        bodies={"layer": la.Body(mesh, soil)},
        supports=[
            la.Fix("layer", "bottom"),
            la.Fix("layer", "left", "y"),
            la.Fix("layer", "right", "y"),
        ],
        reference_loads=[la.RigidFooting("layer", "top", (1, 0))],
        dead_loads=[la.Pressure("layer", side, confined) for side in ("left", "right")],
    )
