"""A problem file to change, and the same problem in Python."""

import lacore as la

TEXT = """\
title = "Footing"

[bodies.clay]
kind = "continuum"
mesh = { shape = "rectangle", x = [0, "3 m"], y = [-1, 0], nx = 6, ny = 2, grade_x = [0.5, 3] }
material = { criterion = "von-mises", shear_strength = "20 kPa" }
boundaries.footing = { x = [0, 0.5], y = 0 }

[[supports]]
body = "clay"
where = "left"
components = "x"

[[supports]]
body = "clay"
where = "bottom"

[[supports]]
body = "clay"
where = { x = 3 }

[[reference_loads]]
load = "rigid-footing"
body = "clay"
where = "footing"
direction = [0, -1]
pressure = "20 kPa"

[[dead_loads]]
load = "weight"
body = "clay"
unit_weight = "18 kN/m3"
"""


def problem():
    mesh = la.meshes.rectangle((0, 3), (-1, 0), 6, 2, grade_x=(0.5, 3))
    return la.Problem(
        bodies={"clay": la.Body(mesh, la.VonMises(shear_strength=20e3))},
        supports=[
            la.Fix("clay", "left", "x"),
            la.Fix("clay", "bottom"),
            la.Fix("clay", lambda x: x[0] == 3),
        ],
        reference_loads=[
            la.RigidFooting("clay", lambda x: (x[1] == 0) & (x[0] <= 0.5), (0, -1), 20e3)
        ],
        dead_loads=[la.BodyForce("clay", (0, -18e3))],
    )
