"""In what theta must vanish: as many conditions of volume as elements can bear (T24, T27).

A projection of theta at the strain points, orthogonal in their weights, so that mean stresses are
projected by it too: what it takes away does no work. Of quadrilaterals it leaves bilinear
functions. Of triangles all, but at crossings: where the edges at a vertex of four triangles lie on
two straight lines, the gradients of a continuous velocity make
``theta_1 - theta_2 + theta_3 - theta_4 = 0`` there by themselves: of the twelve conditions of four
straight triangles in the plane one says nothing. With curved edges, or with the hoop strain rate at
interior points, it says almost nothing, but not nothing: a constraint without a meaning in the
continuum, whose multiplier has no bound under refinement. It is taken away.
"""

from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_matrix, diags_array, eye_array, kron

from lacore.arrays import Floats, Ints, Sparse

if TYPE_CHECKING:
    from lacore.bodies.continuum.dofs import BodyDofs


def means_projector(dofs: "BodyDofs") -> Sparse:
    """Of all volumetric rows and mean stresses, L a strain point, shape (m L, m L).

    As `volume_projector` for rows that must vanish, and on quadrilaterals, which would lock where
    friction is small; nothing is taken from others: flow that dilates has all conditions it needs.
    """
    preserved = dofs.body.form.preserved
    count = preserved.size
    if dofs.space.pressures is not None:
        preserved = np.ones_like(preserved)
    if preserved.all() and count == 1:
        return volume_projector(dofs)
    every = eye_array(dofs.weights.size * count, format="csr")
    if not preserved.any():
        return csr_matrix(every)
    kept = diags_array(preserved.astype(np.float64))
    taken = kron(eye_array(dofs.weights.size) - volume_projector(dofs), kept)
    return csr_matrix(every - taken)


def judged_means(dofs: "BodyDofs", mean: Floats) -> Floats:
    """Mean stresses as criteria judge them, shape (m L,), Pa.

    Of a criterion that does not feel them as smooth as the elements have them; of one that does at
    the strain points, where on quadrilaterals only their projection does work.
    """
    if dofs.body.form.surfaces and dofs.space.pressures is not None:
        return mean
    return np.asarray(means_projector(dofs) @ mean)


def volume_projector(dofs: "BodyDofs") -> Sparse:
    """From theta at all strain points to what must vanish, and of mean stresses, shape (m, m).

    The volume of each quadrilateral, and of four triangles at a crossing together, is kept.
    """
    if dofs.space.pressures is not None:
        return _onto(dofs.weights, dofs.space.pressures)
    whole = csr_matrix(eye_array(dofs.weights.size, format="csr"))
    if dofs.linear or len(dofs.body.mesh.t) != 3:
        return whole
    modes = _alternating_sums(dofs)
    share = csr_matrix(diags_array(1 / dofs.weights.ravel()) @ modes.T)
    size = np.asarray(modes.multiply(share.T).sum(axis=1)).ravel()
    return csr_matrix(whole - share @ diags_array(1 / size) @ modes)


def _onto(weights: Floats, functions: Floats) -> Sparse:
    """Element by element onto functions (q, v), orthogonal in weights of shape (elements, q)."""
    weighted = functions[None] * weights[:, :, None]  # (elements, q, v)
    blocks = functions @ np.linalg.solve(functions.T @ weighted, weighted.transpose(0, 2, 1))
    count, q, _ = blocks.shape
    columns = np.arange(count * q).reshape(count, 1, q)
    columns = np.broadcast_to(columns, blocks.shape)
    start = np.arange(count * q + 1) * q
    return csr_matrix((blocks.ravel(), columns.ravel(), start), shape=(count * q,) * 2)


def _alternating_sums(dofs: "BodyDofs") -> Sparse:
    """Theta of the four elements at crossings, with alternating signs, from the strain points."""
    elements, corner = _crossings(dofs)
    count = dofs.space.points.shape[1]
    values = dofs.space.to_vertices()[corner] * np.array([1.0, -1.0, 1.0, -1.0])[:, None]
    columns = elements[:, :, None] * count + np.arange(count)
    start = np.arange(len(elements) + 1) * 4 * count
    shape = (len(elements), dofs.areas.size * count)
    return csr_matrix((values.ravel(), columns.ravel(), start), shape=shape)


def _crossings(dofs: "BodyDofs") -> tuple[Ints, Ints]:
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
