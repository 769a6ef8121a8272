"""Names for parts of a mesh, by places."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from lacore.arrays import Bools, Floats
from lacore.conditions.where import edges_inside
from lacore.errors import InputError
from lacore.meshes.curved import edge_curves
from lacore.meshes.polygonal import geometry_of, labelled


def named(mesh: Any, boundaries: Mapping[str, Callable[[Floats], Bools]]) -> Any:
    """The mesh with names for parts of its boundary, beside those that it has.

    Args:
        mesh: any of scikit-fem.
        boundaries: by name a function of coordinates (2, n) that says which places belong to it,
            such as `lacore.Within`; whole edges do.

    Raises:
        InputError: no edge, or a place that ends inside of one; it names the boundary.
    """
    own = mesh.boundary_facets()
    curves = edge_curves(mesh, own)
    found = {}
    for name, where in boundaries.items():
        field = f"boundaries[{name!r}]"
        whole, cut = edges_inside(where, curves.start, curves.end, field, curves.middle)
        if cut.size:
            first = int(cut[0])
            start, end = (tuple(side[:, first].tolist()) for side in (curves.start, curves.end))
            raise InputError(
                field,
                None,
                f"ends inside the edge of the mesh from {start} to {end}",
                "put a vertex of the mesh where it ends",
            )
        if not whole.size:
            (left, low), (right, high) = mesh.p.min(axis=1), mesh.p.max(axis=1)
            raise InputError(
                field,
                None,
                "no edge of the boundary is there",
                f"the mesh goes from x = {left:.6g} to {right:.6g}, y = {low:.6g} to {high:.6g}",
            )
        found[name] = np.asarray(own[whole], dtype=np.int64)
    return labelled(mesh.with_boundaries(found), geometry_of(mesh))
