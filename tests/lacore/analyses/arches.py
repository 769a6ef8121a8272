"""Semicircular arches of unit radius, and what statics alone says of them."""

import numpy as np
from scipy.optimize import linprog

import lacore as la


def arch(thickness, mu=0.5, voussoirs=27):
    """Radius 1 to the middle of the ring, unit weight; the reference load pushes sideways."""
    stones = la.masonry.arch(voussoirs, 1 - thickness / 2, thickness, mu)
    return la.Problem(
        {"arch": stones},
        [la.BodyForce("arch", (1, 0))],
        [la.Fix("arch", ("left", "right"))],
        dead_loads=[la.BodyForce("arch", (0, -1))],
    )


def room(thickness, mu, voussoirs=27):
    """Least room, per thickness, that forces in equilibrium leave in all joints; negative: none.

    Statics of the polygonal stones, written anew: forces on the left springing are H, V and M;
    those in a joint follow. With N pressing and T along the joint, its centre m away from the line
    of N: |m| N <= t/2 N - room N_0, |T| <= mu N - room N_0, N_0 the weight of the arch.
    """
    angle = np.pi * (1 - np.arange(voussoirs + 1) / voussoirs)
    radial = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    inner, outer = (1 - thickness / 2) * radial, (1 + thickness / 2) * radial
    corners = np.stack([inner[:-1], inner[1:], outer[1:], outer[:-1]], axis=1)
    x, y = corners[..., 0], corners[..., 1]
    cross = x * np.roll(y, -1, 1) - np.roll(x, -1, 1) * y
    area = cross.sum(axis=1) / 2
    centre = ((x + np.roll(x, -1, 1)) * cross).sum(axis=1) / (6 * area)
    weight = np.abs(area)
    left, total = -1.0, weight.sum()
    rows, bounds = [], []
    for joint, (c, s) in enumerate(radial):
        # On what lies left of the joint: H, V at the springing, weights, and the rest beyond it.
        before = slice(0, joint)
        force = np.array([[1, 0, 0], [0, 1, 0]]), np.array([0, -weight[before].sum()])
        arm = centre[before] - c
        moment = np.array([s, left - c, 1]), float(-(arm * weight[before]).sum())
        along = np.array([s, -c])  # the way on along the arch
        normal = along @ force[0], float(along @ force[1])
        tangent = np.array([c, s]) @ force[0], float(np.array([c, s]) @ force[1])
        for sign in (1, -1):
            rows.append([*(sign * moment[0] - thickness / 2 * normal[0]), thickness * total])
            bounds.append(thickness / 2 * normal[1] - sign * moment[1])
            rows.append([*(sign * tangent[0] - mu * normal[0]), total])
            bounds.append(mu * normal[1] - sign * tangent[1])
    found = linprog([0, 0, 0, -1], np.array(rows), np.array(bounds), bounds=[(None, None)] * 4)
    return found.x[3]
