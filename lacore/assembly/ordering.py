"""Order of the unknowns and contact points of rigid blocks that depends on geometry alone.

Coulomb load factors are not unique (T14b), and the one that a loop finds may depend on the order of
rows and columns, as solvers stop at different points of a face. With this order, the program does
not depend on the order in which blocks are listed.
"""

from collections.abc import Mapping

import numpy as np

from lacore.model.bodies.blocks.dofs import RigidDofs
from lacore.model.bodies.blocks.rigid_blocks import RigidBlocks
from lacore.model.contact.rows import ContactPoints
from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.program.kinematic import ContactRows

_DIGITS = 9  # digits of places by the size, and of normals: above round-off


def column_order(basis: Sparse, assemblies: Mapping[str, RigidDofs[RigidBlocks]]) -> Ints:
    """Return the columns of the free unknowns, those of blocks by centroid, shape (n_free,)."""
    by_column = basis.tocsc()
    row = by_column.indices[by_column.indptr[:-1]].astype(np.int64)
    order = np.arange(row.size)
    for dofs in assemblies.values():
        own = np.flatnonzero((row >= dofs.offset) & (row < dofs.offset + dofs.count))
        place = dofs.places[:, row[own] - dofs.offset]
        order[own] = own[np.lexsort((own, *_digits(place, dofs.body.size)))]
    return order


def point_order(
    contact: ContactRows,
    points: ContactPoints,
    assemblies: Mapping[str, RigidDofs[RigidBlocks]],
    interfaces: int,
) -> Ints:
    """Return the contact points, those of joints by place, for any choice of slaves, shape (m,)."""
    order, first = np.arange(contact.count), interfaces
    for dofs in assemblies.values():
        joints, size = dofs.body.joints, dofs.body.size
        number = contact.interface
        own = np.flatnonzero((number >= first) & (number < first + joints.count))
        joint = number[own] - first
        normal = np.round(points.normal[own].T, _DIGITS)
        first_along = np.take_along_axis(normal, np.argmax(normal != 0, axis=0)[None], axis=0)
        normal *= np.where(first_along < 0, -1.0, 1.0)
        pair = (
            dofs.body.centroid[:, joints.slave[joint]] + dofs.body.centroid[:, joints.master[joint]]
        )
        keys = (*_digits(pair, size), *normal, *_digits(points.position[own].T, size))
        order[own] = own[np.lexsort(keys)]
        first += joints.count
    return order


def _digits(place: Floats, size: float) -> Floats:
    return np.asarray(np.round(place / size, _DIGITS))
