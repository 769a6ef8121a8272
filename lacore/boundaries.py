"""From a name or a predicate on coordinates to boundary facets."""

from collections.abc import Callable

import numpy as np

from lacore.arrays import Bools, Floats, Ints
from lacore.bodies import Body
from lacore.curved import edge_curves
from lacore.errors import InputError, suggest_all

Where = str | tuple[str, ...] | Callable[[Floats], Bools]  # names: of blocks, nodes, members
# Shares of an edge: inside it, so that `<` and `<=` with a vertex select the same, and close to its
# ends, so that a predicate that ends just past a vertex is seen; 1e-3 leaves room for slack.
_SAMPLES = np.array([1e-3, *np.linspace(0.0, 1.0, 17)[1:-1], 1 - 1e-3])
_UNNAMED = (
    "none is known: name boundaries by mesh.with_boundaries or by physical groups of lines, or give"
    " a function of coordinates (2, n)"
)


def where_name(where: Where) -> str:
    """A name for messages and tables: that of the boundary, of the parts, or of the function."""
    if isinstance(where, str):
        return where
    if isinstance(where, tuple):
        return "+".join(map(str, where))
    name = getattr(where, "__name__", "")
    return name if name.isidentifier() else "part"


def boundary_facets(body: Body, where: Where, field: str) -> Ints:
    """Facets of the part `where` of the boundary of `body`, sorted.

    A name selects the facets that the mesh gives under it. A predicate gets coordinates of shape
    (2, n), returns a mask (n,), and selects the boundary facets that satisfy it along their whole
    length; it must not end inside a facet (the velocity would have a jump there that the space
    cannot follow).

    Raises:
        InputError: unknown name, nothing selected, an interior facet, a predicate that ends
            inside a facet.
    """
    mesh = body.mesh
    if isinstance(where, str):
        named = mesh.boundaries or {}
        if where not in named:
            mend = suggest_all(where, named) if named else _UNNAMED
            raise InputError(field, where, "no such boundary", mend)
        facets = np.unique(np.asarray(named[where], dtype=np.int64))
        if np.any(mesh.f2t[1, facets] >= 0):
            raise InputError(
                field, where, "holds facets inside the body", "name facets of the boundary only"
            )
    elif callable(where):
        facets = _selected(body, where, field)
    else:
        raise InputError(
            field,
            where,
            "not a boundary",
            "give a boundary name or a function of coordinates (2, n)",
        )
    if facets.size == 0:
        shown = where if isinstance(where, str) else None
        raise InputError(field, shown, "an empty boundary", "select at least one boundary facet")
    return facets


def _selected(body: Body, where: Callable[[Floats], Bools], field: str) -> Ints:
    mesh = body.mesh
    boundary = mesh.boundary_facets()
    curves = edge_curves(mesh, boundary)
    start, end = curves.start, curves.end
    whole, cut = edges_inside(where, start, end, field, curves.middle)
    if cut.size:
        first = cut[0]
        raise InputError(
            field,
            None,
            f"it ends inside the element edge from {start[:, first]} to {end[:, first]}"
            " (at a midside node or elsewhere between vertices)",
            "put a vertex of the mesh where it ends",
        )
    return np.asarray(boundary[whole], dtype=np.int64)


def edges_inside(
    where: Callable[[Floats], Bools],
    start: Floats,
    end: Floats,
    field: str,
    middle: Floats | None = None,
) -> tuple[Ints, Ints]:
    """Numbers of the edges that satisfy a predicate along their whole length, and in part only.

    Args:
        where: the predicate.
        start, end: of the edges, shape (2, n).
        field: for messages.
        middle: of curved edges, shape (2, n).

    Raises:
        InputError: the predicate fails, or does not return one bool a point.
    """
    middle = (start + end) / 2 if middle is None else middle
    samples = start[:, :, None] * (1 - _SAMPLES) + end[:, :, None] * _SAMPLES
    bulge = middle - (start + end) / 2
    samples += bulge[:, :, None] * (4 * _SAMPLES * (1 - _SAMPLES))
    # In its Bernstein hull without round-off, so that `x[1] == 0.7` holds along an edge at 0.7.
    hull = np.stack([start, middle + bulge, end])
    samples = np.clip(samples, hull.min(axis=0)[:, :, None], hull.max(axis=0)[:, :, None])
    try:
        inside = np.asarray(where(samples.reshape(2, -1)))
    except Exception as error:  # of others
        raise InputError(
            field,
            None,
            f"the predicate fails for coordinates (2, n): {type(error).__name__}: {error}",
            "compare arrays, and join conditions by & and |, each in brackets",
        ) from error
    if inside.shape != (samples[0].size,) or inside.dtype != bool:
        raise InputError(
            field,
            inside.dtype.name,
            "the predicate does not return one bool a point",
            "return an array of bool of shape (n,) for coordinates (2, n)",
        )
    inside = inside.reshape(start.shape[1], _SAMPLES.size)
    whole = inside.all(axis=1)
    return np.flatnonzero(whole), np.flatnonzero(inside.any(axis=1) & ~whole)


def outward_normals(body: Body, facets: Ints, s: float) -> Floats:
    """Unit outward normals of boundary facets at a share of their parameter, shape (2, n)."""
    *_, outward = facet_geometry(body, facets)
    return edge_curves(body.mesh, facets).normal(s, outward)


def facet_geometry(body: Body, facets: Ints) -> tuple[Floats, Floats, Floats]:
    """Ends and unit outward normals of (chords of) boundary facets: three arrays (2, n)."""
    mesh = body.mesh
    start, end = mesh.p[:, mesh.facets[0, facets]], mesh.p[:, mesh.facets[1, facets]]
    along = end - start
    normal = np.stack([along[1], -along[0]]) / np.linalg.norm(along, axis=0)
    centre = mesh.p[:, mesh.t[:, mesh.f2t[0, facets]]].mean(axis=1)
    outward = np.sign(np.sum(normal * (start - centre), axis=0))
    return start, end, normal * outward
