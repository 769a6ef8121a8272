"""Names for parts of a mesh by place."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from skfem import Mesh

from lacore.model.conditions.where import asked, edges_inside
from lacore.model.meshes.curved import edge_curves
from lacore.model.meshes.files.notes import noted, notes_of
from lacore.model.meshes.polygonal import labelled
from lacore.model.meshes.solid.faces import selected_faces
from lacore.model.meshes.solid.roundness import outline_of
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting.errors import InputError, typed
from lacore.reporting.showing import spanned
from lacore.reporting.text import Quantity, text

_INNER = 1 - 1e-6  # share of the way from the middle of an element to its corners


Places = Callable[[Floats], Bools]
"""Which of n places, coordinates of shape (2, n) or (3, n), are meant."""


@typed()
def named(
    mesh: Mesh,
    boundaries: Mapping[str, Places] | None = None,
    regions: Mapping[str, Places] | None = None,
) -> Any:
    """Return the mesh with additional names for parts of its boundary and for regions.

    Args:
        mesh: any mesh of scikit-fem.
        boundaries: by name, a function of coordinates (2, n), in three dimensions (3, n), that
            returns which places belong to it, such as `lacore.Within`; it selects whole edges or
            faces.
        regions: the same for elements, for `lacore.Body`.

    Raises:
        InputError: no edge, face or element, or a place that ends inside of one; it names the part.

    Example:
        >>> mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2)
        >>> mesh = la.meshes.named(mesh, boundaries={"strip": lambda x: (x[1] == 1) & (x[0] <= 1)})
        >>> len(mesh.boundaries["strip"])  # edges
        2
    """
    own = mesh.with_subdomains(_elements(mesh, regions)) if regions else mesh
    own = own.with_boundaries(_boundaries(mesh, boundaries)) if boundaries else own
    return noted(labelled(own, outline_of(mesh)), notes_of(mesh))


def _boundaries(mesh: Any, boundaries: Mapping[str, Places]) -> dict[str, Ints]:
    selected, kind = _SELECTED[mesh.p.shape[0]]
    found = {}
    for name, where in boundaries.items():
        field = f"boundaries[{name!r}]"
        own = selected(mesh, where, field)
        if not own.size:
            raise InputError(field, None, f"no {kind} of the boundary is there", _extent(mesh))
        found[name] = own
    return found


def _selected_edges(mesh: Any, where: Places, field: str) -> Ints:
    own = mesh.boundary_facets()
    curves = edge_curves(mesh, own)
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
    return np.asarray(own[whole], dtype=np.int64)


_SELECTED: Mapping[int, tuple[Callable[[Any, Places, str], Ints], str]] = {
    2: (_selected_edges, "edge"),
    3: (selected_faces, "face"),
}
"""By dimension, the function that finds the facets of a part, and their name."""


def _elements(mesh: Any, regions: Mapping[str, Places]) -> dict[str, Ints]:
    found = {}
    corner = mesh.p[:, mesh.t]  # shape (d, corners, elements)
    # Inside of elements, as their corners may lie on a line where another region begins.
    middle = corner.mean(axis=1, keepdims=True)
    samples = np.concatenate([middle, middle + _INNER * (corner - middle)], axis=1)
    for name, where in regions.items():
        field = f"regions[{name!r}]"
        inside = asked(where, samples.reshape(len(samples), -1), field)
        inside = inside.reshape(samples.shape[1:])
        cut = np.flatnonzero(inside.any(axis=0) & ~inside.all(axis=0))
        if cut.size:
            why = text(
                "its line runs through the element around {}",
                Quantity(tuple(middle[:, 0, cut[0]]), "m", ".6g"),
            )
            raise InputError(field, None, why, "let edges of the mesh follow it")
        if not inside.any():
            raise InputError(field, None, "no element is there", _extent(mesh))
        found[name] = np.flatnonzero(inside.all(axis=0))
    return found


def _extent(mesh: Any) -> str:
    return text("the mesh lies in {}", spanned(mesh.p.min(axis=1), mesh.p.max(axis=1)))
