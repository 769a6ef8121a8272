"""Division of elements at vertices on their edges, so that two meshes match."""

from itertools import pairwise

import numpy as np
from skfem import MeshTri

from lacore.model.meshes.refinement import facets_between, with_named_elements
from lacore.numerics.arrays import Floats, Ints

Ends = tuple[int, int]


def with_vertices(mesh: MeshTri, facets: Ints, places: Floats) -> MeshTri:
    """Return the mesh with vertices on boundary edges, where elements are divided.

    They are divided into fans, and in three. If only two elements meet at a vertex of a straight
    edge, stresses that are linear in both link the tractions on either side of it
    (`lacore.bounds.static_corners`); with four elements they do not.

    Args:
        mesh: mesh of straight triangles.
        facets: edge of each vertex, shape (k,).
        places: places inside them, shape (2, k).
    """
    start, end = (mesh.p[:, own] for own in mesh.facets[:, facets])
    along = end - start
    share = np.sum((places - start) * along, axis=0) / np.sum(along**2, axis=0)
    order = np.lexsort((share, facets))
    points: list[Floats] = list(mesh.p.T)
    chains: dict[Ends, list[int]] = {}
    for facet, at in zip(facets[order].tolist(), share[order].tolist(), strict=True):
        a, b = mesh.facets[:, facet].tolist()
        chains.setdefault((a, b), []).append(len(points))
        points.append((1 - at) * mesh.p[:, a] + at * mesh.p[:, b])
    whole = {ends: [ends[0], *inside, ends[1]] for ends, inside in chains.items()}
    triangles = [[own] for own in mesh.t.T.tolist()]
    touched = np.unique(mesh.f2t[0, facets]).tolist()
    for element in touched:
        triangles[element] = []
        for a, b, c in _divided(tuple(mesh.t[:, element].tolist()), whole):
            centre = len(points)
            points.append((points[a] + points[b] + points[c]) / 3)
            triangles[element] += [[a, b, centre], [b, c, centre], [c, a, centre]]
    parents = np.repeat(np.arange(len(triangles)), [len(own) for own in triangles])
    finer = MeshTri(
        np.ascontiguousarray(np.transpose(points)),
        np.ascontiguousarray(np.transpose([one for own in triangles for one in own])),
    )
    names = {}
    for name, own in (mesh.boundaries or {}).items():
        ends = []
        for a, b in mesh.facets[:, np.asarray(own, dtype=np.int64)].T.tolist():
            chain = whole.get((a, b), [a, b])
            ends += list(pairwise(chain))
        names[name] = facets_between(finer, np.array(ends, dtype=np.int64).reshape(-1, 2).T)
    finer = finer.with_boundaries(names) if names else finer
    return with_named_elements(finer, mesh, parents)


def _divided(corners: tuple[int, ...], chains: dict[Ends, list[int]]) -> list[list[int]]:
    """Return the triangles that replace one with vertices inside its edges, edge by edge."""
    parts = [list(corners)]
    for (a, b), chain in chains.items():
        for number, part in enumerate(parts):
            if a in part and b in part:
                (apex,) = set(part) - {a, b}
                fan = [[apex, one, other] for one, other in pairwise(chain)]
                parts[number : number + 1] = fan
                break
    return parts
