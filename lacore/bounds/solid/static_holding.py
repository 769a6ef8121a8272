"""Multipliers of equilibrium elements in space that supports and footings leave free (T91)."""

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.sparse import block_diag, csr_matrix, eye_array, hstack, vstack

from lacore.arrays import Floats, Ints, Sparse
from lacore.bodies.continuum.solid.faces import face_corners
from lacore.bodies.continuum.solid.held_nodes import flowing_between_nodes
from lacore.bodies.continuum.solid.holding import face_conditions
from lacore.bounds.equilibrium import EquilibriumDofs
from lacore.conditions.elimination import NodeConditions
from lacore.conditions.loads import Fix, RigidFooting


def static_free_basis(
    bodies: Mapping[str, EquilibriumDofs],
    supports: Sequence[Fix],
    footings: Sequence[RigidFooting],
) -> Sparse:
    """All multipliers and speeds of footings from the free ones, shape (n, free), speeds last.

    A multiplier of tractions that are linear on a face follows what moves it by the weights of
    these: at corner a of a face ``(V_a + sum V)/4`` of the velocities V at its corners (T91).

    Raises:
        InputError: a footing that its supports, or another footing, keep from moving.
    """
    free, driven = [], []
    names = [footing.name for footing in footings]
    for name, dofs in bodies.items():
        asked = face_conditions(dofs.body, supports, footings, name)
        nodes = dofs.facet_nodes(asked.nodes) - dofs.first_node
        factors = np.zeros((3, asked.nodes.size))
        for number, footing in enumerate(footings):
            mine = asked.footing == number
            moved = _followed(footing, face_corners(dofs.body.mesh, asked.nodes[mine]))
            factors[:, mine] = np.sum(asked.directions[mine].T[:, None] * moved, axis=0)
        spread = NodeConditions(
            nodes.ravel(),
            np.tile(asked.directions, (3, 1)),
            np.tile(asked.footing, 3),
            factors.ravel(),
        )
        node_dofs: Ints = np.arange(dofs.count).reshape(-1, 3).T
        parts = flowing_between_nodes(spread, node_dofs, names)
        free.append(parts[0])
        driven.append(parts[1])
    first = hstack([block_diag(free, format="csr"), vstack(driven)], format="csr")
    count = len(footings)
    speeds = hstack([csr_matrix((count, first.shape[1] - count)), eye_array(count, format="csr")])
    return csr_matrix(vstack([first, speeds], format="csr"))


def _followed(footing: RigidFooting, corner: Floats) -> Floats:
    """Multipliers at the corners of faces that a footing moves, per its speed, (3, 3, faces)."""
    motion = footing.motion(corner)
    return np.asarray((motion + motion.sum(axis=1, keepdims=True)) / 4)
