"""Names for parts of a mesh, by places."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from skfem import Mesh

from lacore.arrays import Bools, Floats, Ints
from lacore.conditions.where import edges_inside
from lacore.errors import InputError, typed
from lacore.meshes.curved import edge_curves
from lacore.meshes.polygonal import geometry_of, labelled
from lacore.showing import spanned

_INNER = 1 - 1e-6  # of the way from the middle of an element to its corners


Places = Callable[[Floats], Bools]
"""Which of n places, coordinates of shape (2, n) or (3, n), are meant."""


@typed()
def named(
    mesh: Mesh,
    boundaries: Mapping[str, Places] | None = None,
    regions: Mapping[str, Places] | None = None,
) -> Any:
    """The mesh with names for parts of its boundary and for regions, beside those that it has.

    Args:
        mesh: any of scikit-fem.
        boundaries: by name a function of coordinates (2, n) that says which places belong to it,
            such as `lacore.Within`; whole edges do.
        regions: the same of elements, for `lacore.Body`: whole ones do.

    Raises:
        InputError: no edge or element, or a place that ends inside of one; it names the part.

    Example:
        >>> mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2)
        >>> mesh = la.meshes.named(mesh, boundaries={"strip": lambda x: (x[1] == 1) & (x[0] <= 1)})
        >>> len(mesh.boundaries["strip"])  # edges
        2
    """
    own = mesh.with_subdomains(_elements(mesh, regions)) if regions else mesh
    own = own.with_boundaries(_facets(mesh, boundaries)) if boundaries else own
    return labelled(own, geometry_of(mesh))


def _facets(mesh: Any, boundaries: Mapping[str, Places]) -> dict[str, Ints]:
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
            raise InputError(field, None, "no edge of the boundary is there", _extent(mesh))
        found[name] = np.asarray(own[whole], dtype=np.int64)
    return found


def _elements(mesh: Any, regions: Mapping[str, Places]) -> dict[str, Ints]:
    found = {}
    corner = mesh.p[:, mesh.t]  # (2, corners, elements)
    # Inside of elements: their corners may lie on a line that another region begins at.
    middle = corner.mean(axis=1, keepdims=True)
    samples = np.concatenate([middle, middle + _INNER * (corner - middle)], axis=1)
    for name, where in regions.items():
        field = f"regions[{name!r}]"
        inside = where(samples.reshape(2, -1)).reshape(samples.shape[1:])
        cut = np.flatnonzero(inside.any(axis=0) & ~inside.all(axis=0))
        if cut.size:
            x, y = middle[:, 0, cut[0]]
            why = f"its line runs through the element around ({x:.6g}, {y:.6g})"
            raise InputError(field, None, why, "let edges of the mesh follow it")
        if not inside.any():
            raise InputError(field, None, "no element is there", _extent(mesh))
        found[name] = np.flatnonzero(inside.all(axis=0))
    return found


def _extent(mesh: Any) -> str:
    return f"the mesh lies in {spanned(mesh.p.min(axis=1), mesh.p.max(axis=1))}"
