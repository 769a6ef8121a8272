"""Thick cylinders and spheres under internal pressure."""

from math import pi

import numpy as np

import lacore as la


def cavity(criterion, sphere, space, cells):
    """A quarter, of radii 1 and 2, `cells` in each direction."""
    make = la.meshes.quadrilaterals if space == "q2" else la.meshes.rectangle
    flat = make((1, 2), (0, pi / 2), cells, cells, grade_x=(1.0, 2.0))

    def around(x):
        radius, angle = x
        # Nodes of the axis lie on it, without round-off.
        return radius * np.stack([np.where(angle == pi / 2, 0.0, np.cos(angle)), np.sin(angle)])

    kinematics = "axisymmetric" if sphere else "plane_strain"
    body = la.Body(la.meshes.isoparametric(flat, around), criterion, kinematics, space)
    held = [la.Fix("wall", "bottom", "y")] + ([] if sphere else [la.Fix("wall", "top", "x")])
    return la.Problem({"wall": body}, [la.Pressure("wall", "left")], supports=held)
