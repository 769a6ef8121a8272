"""Three-dimensional velocities as multipliers of equilibrium elements of equal power (T26, T91)."""

import numpy as np

from lacore.assembly.loading import footings_of
from lacore.bounds.equilibrium import EquilibriumDofs
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.solid.faces import face_nodes
from lacore.model.bodies.continuum.solid.holding import slid_past
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats, Ints

# 3/A int N_a u dA at the corners of a face, from its nodes: corners, then `SIDES`.
_LINEAR = (np.ones((3, 3)) + np.eye(3)) / 4
_QUADRATIC = np.concatenate(
    [
        np.full((3, 3), -0.05) + 0.15 * np.eye(3),
        0.4 - 0.2 * np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]]),
    ],
    axis=1,
)
# Means over an element from its nodes: vertices, then edges.
_MEANS = {1: np.full(4, 1 / 4), 2: np.repeat([-1 / 20, 1 / 5], [4, 6])}


def solid_restriction(
    name: str,
    dofs: BodyDofs,
    multipliers: EquilibriumDofs,
    velocity: Floats,
    problem: Problem,
    speeds: Floats,
) -> tuple[Ints, Floats]:
    """Return nodes, shape (k,), and velocities, (3, k), see `lacore.bounds.gap_identity`.

    As `restriction` there, in three dimensions. Where velocities jump at a support, the velocity of
    the support is used.

    Args:
        name, dofs, multipliers, velocity: data of a body.
        problem: problem of the body.
        speeds: speeds of all footings, shape (s,).
    """
    mesh = dofs.body.mesh
    u = velocity[dofs.dofs]
    weights = _LINEAR if dofs.degree == 1 else _QUADRATIC
    inner = np.flatnonzero(mesh.f2t[1] >= 0)
    every = np.arange(mesh.nfacets)
    total = _at_corners(dofs, u, weights, every, 0)  # shape (3, corners, facets)
    other = _at_corners(dofs, u, weights, inner, 1)
    total[:, :, inner] = (total[:, :, inner] + other) / 2
    if dofs.space.jumps:
        footings = footings_of(problem)
        held = slid_past(dofs, problem.supports, footings, name)
        moving = np.einsum("sxfn,s,an->xaf", held.motion, speeds, weights)
        away = moving - total[:, :, held.facets]
        for axis in held.directions:
            along = np.sum(axis[:, None] * away, axis=0)
            total[:, :, held.facets] += axis[:, None] * along
    mean = np.einsum("xne,n->xe", u[:, dofs.element_nodes], _MEANS[dofs.degree])
    nodes = np.concatenate([multipliers.facet_nodes(every).ravel(), multipliers.element_nodes])
    return nodes, np.concatenate([total.reshape(3, -1), mean], axis=1)


def _at_corners(dofs: BodyDofs, u: Floats, weights: Floats, facets: Ints, side: int) -> Floats:
    nodes = face_nodes(dofs.body.mesh, dofs.element_nodes, dofs.degree, facets, side)
    return np.asarray(np.einsum("xnf,an->xaf", u[:, nodes], weights))
