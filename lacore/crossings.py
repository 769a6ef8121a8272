"""Vertices where four triangles meet: one condition of constant volume too many (T27, T31).

Where the edges at such a vertex lie on two straight lines, the gradients of a continuous velocity
make ``theta_1 - theta_2 + theta_3 - theta_4 = 0`` there by themselves: of the twelve conditions of
four straight triangles in the plane one says nothing. With curved edges, or with the hoop strain
rate at interior points, it says almost nothing, but not nothing: a constraint without a meaning in
the continuum, whose multiplier has no bound under refinement. It is taken out of the rows.
"""

import numpy as np
from scipy.sparse import csr_matrix, diags_array, eye_array

from lacore.arrays import Ints, Sparse
from lacore.dofs import BodyDofs


def without_crossings(dofs: BodyDofs, volumetric: Sparse) -> Sparse:
    """Rows of theta less the alternating sum at each crossing, shape (m, n).

    The volume of the four elements together is still kept: what is left free is a theta whose
    integral over them vanishes.
    """
    modes = _alternating_sums(dofs)
    share = csr_matrix(diags_array(1 / dofs.weights.ravel()) @ modes.T)
    size = np.asarray(modes.multiply(share.T).sum(axis=1)).ravel()
    removed = share @ diags_array(1 / size) @ modes
    kept = csr_matrix((eye_array(volumetric.shape[0], format="csr") - removed) @ volumetric)
    return kept


def _alternating_sums(dofs: BodyDofs) -> Sparse:
    """Theta of the four elements at crossings, with alternating signs, from the strain points."""
    elements, corner = _crossings(dofs)
    count = dofs.space.points.shape[1]
    values = dofs.space.to_vertices()[corner] * np.array([1.0, -1.0, 1.0, -1.0])[:, None]
    columns = elements[:, :, None] * count + np.arange(count)
    start = np.arange(len(elements) + 1) * 4 * count
    shape = (len(elements), dofs.areas.size * count)
    return csr_matrix((values.ravel(), columns.ravel(), start), shape=shape)


def _crossings(dofs: BodyDofs) -> tuple[Ints, Ints]:
    """Elements around inner vertices of four triangles, in turn, and which corner of each it is.

    Both of shape (crossings, 4). Of crossings that share elements only some are taken.
    """
    mesh = dofs.body.mesh
    inner = np.bincount(mesh.t.ravel(), minlength=mesh.nvertices) == 4
    inner[np.unique(mesh.facets[:, mesh.boundary_facets()])] = False
    corner, element = np.nonzero(inner[mesh.t])
    vertex = mesh.t[corner, element]
    away = mesh.p[:, mesh.t].mean(axis=1)[:, element] - mesh.p[:, vertex]
    order = np.lexsort((np.arctan2(away[1], away[0]), vertex))
    around, corners = (part[order].reshape(-1, 4) for part in (element, corner))
    # An element may have two or three such vertices: it goes with the first.
    first = np.full(mesh.nelements, len(around))
    np.minimum.at(first, around.ravel(), np.repeat(np.arange(len(around)), 4))
    own = (first[around] == np.arange(len(around))[:, None]).all(axis=1)
    return around[own].astype(np.int64), corners[own].astype(np.int64)
