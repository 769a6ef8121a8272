"""Conditions on theta: as many conditions of volume as elements allow (T24, T27).

They are a projection of theta at the strain points, orthogonal in their weights, which also
projects the mean stresses: the removed part does no work. On quadrilaterals bilinear functions
remain. On triangles all remain except at crossings: where the edges at a vertex of four triangles
lie on two straight lines, the gradients of a continuous velocity satisfy ``theta_1 - theta_2 +
theta_3 - theta_4 = 0`` there, so one of the twelve conditions of four straight plane triangles is
redundant. With curved edges, or with the hoop strain rate at interior points, it is almost
redundant: a constraint without a meaning in the continuum, whose multiplier is unbounded under
refinement. It is removed.
"""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.sparse import csr_matrix, diags_array, eye_array, vstack

from lacore.model.bodies.continuum.regions.region import Region
from lacore.model.bodies.continuum.velocity_basis import VelocityBasis
from lacore.numerics.arrays import Bools, Floats, Ints, Sparse


def volumetric_rows(
    velocity: VelocityBasis, region: Region, rows: Callable[[Floats, Ints], Sparse]
) -> Sparse:
    """Return the volumetric rows of a region, projected if they must vanish, shape (m L, n).

    Args:
        velocity: basis of the velocity of the body.
        region: region of the body.
        rows: function of coefficients (r, components) in elements, with r strain points.
    """
    form, projected = region.form, _projected(velocity, region)
    if not projected.any():
        return rows(form.volumes, region.elements)
    points, projector = _points(velocity, region), volume_projector(velocity)
    every = np.arange(velocity.body.mesh.nelements)
    parts = [
        csr_matrix(projector[points] @ rows(row[None], every))
        if own
        else rows(row[None], region.elements)
        for row, own in zip(form.volumes, projected, strict=True)
    ]
    order = np.arange(points.size * len(parts)).reshape(len(parts), -1).T.ravel()
    return csr_matrix(vstack(parts, format="csr")[order])


def conditions(velocity: VelocityBasis, region: Region) -> Sparse | None:
    """Return the independent conditions of a region, (k, m); None: all its rows.

    See `lacore.program.dissipation.DissipationGroup.conditions`. The rows of surfaces are equations
    of each point with separate multipliers.
    """
    if region.form.surfaces or not (velocity.space.pressures is not None or _crossed(velocity)):
        return None
    points = _points(velocity, region)
    place = np.full(velocity.weights.size, -1)
    place[points] = np.arange(points.size)
    at, blocks = _bases(velocity)
    at = place[at]
    whole = (at >= 0).all(axis=1)
    if not whole.any():
        return None
    at, blocks = at[whole], blocks[whole]
    left = np.setdiff1d(np.arange(points.size), at)
    count, rows = blocks.shape[:2]
    row = np.broadcast_to(np.arange(count * rows).reshape(count, rows, 1), blocks.shape)
    column = np.broadcast_to(at[:, None, :], blocks.shape)
    entries = np.concatenate([blocks.ravel(), np.ones(left.size)])
    every = np.concatenate([row.ravel(), count * rows + np.arange(left.size)])
    places = every, np.concatenate([column.ravel(), left])
    found = csr_matrix((entries, places), (count * rows + left.size, points.size))
    found.eliminate_zeros()
    return found


def _bases(velocity: VelocityBasis) -> tuple[Ints, Floats]:
    """Return the strain points of each projection, (b, r), and an orthonormal basis, (b, k, r).

    They apply to theta times roots of weights, for which `volume_projector` is orthogonal.
    """
    count, roots = velocity.weights.shape[1], np.sqrt(velocity.weights)
    if velocity.space.pressures is not None:
        own = np.arange(velocity.weights.size).reshape(-1, count)
        basis = np.linalg.qr(roots[:, :, None] * velocity.space.pressures)[0]
        return own, basis.transpose(0, 2, 1)
    elements, corner = _crossings(velocity)
    own = count * elements[:, :, None] + np.arange(count)
    return own.reshape(-1, 4 * count), _beside(_alternating(velocity, corner) / roots[elements])


def _beside(mode: Floats) -> Floats:
    """Return an orthonormal basis orthogonal to a mode of four elements (b, 4, q).

    The shape is (b, 4q-1, 4q). It has as many zeros as possible: all but one of the q vectors are
    within each element, then one within each pair of them. Dense bases would fill the factors of a
    solver.
    """
    b, _, q = mode.shape
    size = np.linalg.norm(mode, axis=2)
    turned = np.linalg.qr((mode / size[:, :, None])[..., None], mode="complete")[0]
    basis = np.zeros((b, 4, q, 4, q))
    for element in range(4):
        basis[:, element, : q - 1, element] = turned[:, element, :, 1:].transpose(0, 2, 1)
    along = mode / size[:, :, None]
    one, two = np.hypot(size[:, 0], size[:, 1]), np.hypot(size[:, 2], size[:, 3])
    none = np.zeros(b)
    shares = (
        (size[:, 1] / one, -size[:, 0] / one, none, none),
        (none, none, size[:, 3] / two, -size[:, 2] / two),
        tuple(
            factor / np.hypot(one, two) * size[:, element]
            for element, factor in enumerate((two / one, two / one, -one / two, -one / two))
        ),
    )
    for row, share in enumerate(shares):
        basis[:, row, q - 1] = np.stack(share, axis=1)[:, :, None] * along
    return basis.reshape(b, 4 * q, 4 * q)[:, :-1]


def judged_means(velocity: VelocityBasis, means: Sequence[Floats]) -> list[Floats]:
    """Return the mean stresses of regions for criteria, shape (m L,) each, Pa.

    If a criterion does not depend on them, they are as smooth as on the elements; else they are
    those at the strain points, where on quadrilaterals only their projection does work.
    """
    regions, count = velocity.body.regions, velocity.weights.size
    columns = [
        own.reshape(-1, len(region.form.volumes))
        for region, own in zip(regions, means, strict=True)
    ]
    projector = volume_projector(velocity)
    judged = []
    for region, own in zip(regions, columns, strict=True):
        projected = _projected(velocity, region)
        if region.form.surfaces and velocity.space.pressures is not None:
            projected = np.zeros_like(projected)
        result = own.copy()
        for column in np.flatnonzero(projected).tolist():
            whole = np.zeros(count)
            for other, theirs in zip(regions, columns, strict=True):
                if column < theirs.shape[1]:
                    whole[_points(velocity, other)] = theirs[:, column]
            result[:, column] = (projector @ whole)[_points(velocity, region)]
        judged.append(result.ravel())
    return judged


def _projected(velocity: VelocityBasis, region: Region) -> Bools:
    """Return which volumetric rows are projected, shape (L,): those that must vanish.

    On quadrilaterals, which would lock with small friction, all are projected. On other elements
    dilatant flow keeps all its conditions.
    """
    preserved = region.form.preserved
    return np.ones_like(preserved) if velocity.space.pressures is not None else preserved


def _points(velocity: VelocityBasis, region: Region) -> Ints:
    """Return the numbers of the strain points of a region among those of its body."""
    count = velocity.weights.shape[1]
    return np.asarray((count * region.elements[:, None] + np.arange(count)).ravel())


def volume_projector(velocity: VelocityBasis) -> Sparse:
    """Return the projection of theta at all strain points, and of mean stresses, shape (m, m).

    The volume of each quadrilateral, and of four triangles at a crossing together, is kept.
    """
    if velocity.space.pressures is not None:
        return _onto(velocity.weights, velocity.space.pressures)
    whole = csr_matrix(eye_array(velocity.weights.size, format="csr"))
    if not _crossed(velocity):
        return whole
    modes = _alternating_sums(velocity)
    share = csr_matrix(diags_array(1 / velocity.weights.ravel()) @ modes.T)
    size = np.asarray(modes.multiply(share.T).sum(axis=1)).ravel()
    return csr_matrix(whole - share @ diags_array(1 / size) @ modes)


def _crossed(velocity: VelocityBasis) -> bool:
    """Return whether crossings have an almost redundant condition."""
    return not velocity.linear and len(velocity.body.mesh.t) == 3


def _onto(weights: Floats, functions: Floats) -> Sparse:
    """Return the projection by element onto functions (q, v).

    It is orthogonal in weights of shape (elements, q).
    """
    weighted = functions[None] * weights[:, :, None]  # shape (elements, q, v)
    blocks = functions @ np.linalg.solve(functions.T @ weighted, weighted.transpose(0, 2, 1))
    count, q, _ = blocks.shape
    columns = np.arange(count * q).reshape(count, 1, q)
    columns = np.broadcast_to(columns, blocks.shape)
    start = np.arange(count * q + 1) * q
    return csr_matrix((blocks.ravel(), columns.ravel(), start), shape=(count * q,) * 2)


def _alternating_sums(velocity: VelocityBasis) -> Sparse:
    """Return the alternating sums of theta of the four elements at crossings.

    They are rows over the strain points.
    """
    elements, corner = _crossings(velocity)
    count = velocity.space.points.shape[1]
    values = _alternating(velocity, corner)
    columns = elements[:, :, None] * count + np.arange(count)
    start = np.arange(len(elements) + 1) * 4 * count
    shape = (len(elements), velocity.areas.size * count)
    return csr_matrix((values.ravel(), columns.ravel(), start), shape=shape)


def _alternating(velocity: VelocityBasis, corner: Ints) -> Floats:
    """Return the factors of theta at the strain points of four elements, (crossings, 4, q)."""
    signs = np.array([1.0, -1.0, 1.0, -1.0])
    return np.asarray(velocity.space.to_vertices()[corner] * signs[:, None])


def _crossings(velocity: VelocityBasis) -> tuple[Ints, Ints]:
    """Return the elements around inner vertices of four triangles, in turn, and their corners.

    Both have the shape (crossings, 4). Of crossings that share elements only some are used.
    """
    mesh = velocity.body.mesh
    inner = np.bincount(mesh.t.ravel(), minlength=mesh.nvertices) == 4
    inner[np.unique(mesh.facets[:, mesh.boundary_facets()])] = False
    corner, element = np.nonzero(inner[mesh.t])
    vertex = mesh.t[corner, element]
    away = mesh.p[:, mesh.t].mean(axis=1)[:, element] - mesh.p[:, vertex]
    order = np.lexsort((np.arctan2(away[1], away[0]), vertex))
    around, corners = (part[order].reshape(-1, 4) for part in (element, corner))
    flows = np.ones(mesh.nelements, dtype=bool)  # without a change of volume
    for region in velocity.body.regions:
        flows[region.elements] = region.form.preserved[0]
    whole = flows[around].all(axis=1)
    around, corners = around[whole], corners[whole]
    # An element may have two or three such vertices, and belongs to the first.
    first = np.full(mesh.nelements, len(around))
    np.minimum.at(first, around.ravel(), np.repeat(np.arange(len(around)), 4))
    own = (first[around] == np.arange(len(around))[:, None]).all(axis=1)
    return around[own].astype(np.int64), corners[own].astype(np.int64)
