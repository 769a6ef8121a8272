"""A mesh that goes on beyond one of its sides, by one row of triangles."""

from collections.abc import Mapping, Set

import numpy as np
from skfem import MeshTri

from lacore.arrays import Floats, Ints


def with_row_beyond(
    mesh: MeshTri, facets: Ints, step: Floats, parts: Mapping[str, Ints], going_on: Set[str]
) -> MeshTri:
    """The mesh with a row of crossed quadrilaterals beyond facets of its boundary.

    Vertices and elements of the mesh come first. Regions go on into the row.

    Args:
        mesh: straight-edged triangles.
        facets: a side of it.
        step: from the side across the row, m, shape (2,).
        parts: facets of the boundary by the name that they get; what lies on the side moves across
            the row.
        going_on: names of parts that go on along the ends of the row, where they end there.
    """
    side = np.unique(mesh.facets[:, facets])
    across = dict(
        zip(side.tolist(), range(mesh.nvertices, mesh.nvertices + side.size), strict=True)
    )
    centre = mesh.nvertices + side.size + np.arange(facets.size)
    one, other = mesh.facets[:, facets]
    far_one, far_other = (np.array([across[v] for v in own.tolist()]) for own in (one, other))
    rim = [one, other, far_other, far_one]
    triangles = [
        np.stack([begin, end, centre]) for begin, end in zip(rim, rim[1:] + rim[:1], strict=True)
    ]
    places = np.concatenate(
        [
            mesh.p,
            mesh.p[:, side] + step[:, None],
            (mesh.p[:, one] + mesh.p[:, other] + step[:, None]) / 2,
        ],
        axis=1,
    )
    longer = MeshTri(places, np.concatenate([mesh.t, *triangles], axis=1))
    owner = np.concatenate([np.arange(mesh.nelements), np.tile(mesh.f2t[0, facets], 4)])
    number = {ends: facet for facet, ends in enumerate(map(frozenset, longer.facets.T.tolist()))}
    ends = np.flatnonzero(np.bincount(mesh.facets[:, facets].ravel()) == 1)
    names = {}
    for name, own in parts.items():
        pairs = [frozenset(pair) for pair in mesh.facets[:, np.setdiff1d(own, facets)].T.tolist()]
        moved = mesh.facets[:, np.intersect1d(own, facets)].T.tolist()
        pairs += [frozenset(across[vertex] for vertex in pair) for pair in moved]
        if name in going_on:
            beside = np.intersect1d(mesh.facets[:, np.setdiff1d(own, facets)], ends)
            pairs += [frozenset((vertex, across[vertex])) for vertex in beside.tolist()]
        names[name] = np.array([number[pair] for pair in pairs], dtype=np.int64)
    longer = longer.with_boundaries(names)
    if mesh.subdomains:
        regions = {
            name: np.flatnonzero(np.isin(owner, own)) for name, own in mesh.subdomains.items()
        }
        longer = longer.with_subdomains(regions)
    return longer
