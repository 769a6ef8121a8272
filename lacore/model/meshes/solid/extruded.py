"""Tetrahedra extruded from a section of triangles."""

from __future__ import annotations

import numpy as np
from skfem import MeshTet, MeshTri
from skfem.mesh import MeshTri1

from lacore.model.meshes.polygonal import geometry_of, labelled
from lacore.model.meshes.structured import along_axis
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError

_ENDS = ("start", "end")


def extruded(
    section: MeshTri,
    z: tuple[float, float],
    nz: int,
    grade_z: tuple[float, float] | None = None,
) -> MeshTet:
    """Return a prism with three tetrahedra above each triangle of a section in each layer.

    Boundaries and regions of the section keep their names as sides and regions; the ends are
    `start` and `end`. A label of the section on curved boundaries applies to the sides.

    Args:
        section: straight-edged triangles in the plane z = 0.
        z: extent.
        nz: number of layers.
        grade_z: ``(at, ratio)``, see `lacore.model.meshes.graded`.

    Raises:
        InputError: not a mesh of straight-edged triangles, or a side with the name of an end; see
            `graded`.

    Example:
        >>> section = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=2, ny=1)
        >>> section.nelements, la.meshes.extruded(section, z=(0, 1), nz=1).nelements
        (8, 24)
    """
    if type(section) is not MeshTri1:
        raise InputError(
            "section",
            type(section).__name__,
            "not a mesh of straight-edged triangles",
            "give a skfem.MeshTri, such as a lacore.model.meshes.rectangle",
        )
    taken = set(section.boundaries or {}) & set(_ENDS)
    if taken:
        raise InputError(
            "section",
            sorted(taken),
            "sides with the names of the ends of a prism",
            "name them otherwise (lacore.model.meshes.named)",
        )
    rows = along_axis("z", z, nz, grade_z)
    mesh = _filled(section, rows)
    count = section.nvertices
    within = mesh.boundary_facets()
    corner = np.sort(mesh.facets[:, within].astype(np.int64), axis=0)
    level, below = np.divmod(corner, count)
    names = {
        name: within[np.all(level == at, axis=0)]
        for name, at in zip(_ENDS, (0, rows.size - 1), strict=True)
    }
    # A face of a side lies above one edge of the section.
    edges = np.sort(section.facets.astype(np.int64), axis=0)
    known = edges[0] * count + edges[1]
    order = np.argsort(known)
    key = below.min(axis=0) * count + below.max(axis=0)
    at = np.searchsorted(known[order], key).clip(max=order.size - 1)
    edge = np.where(known[order[at]] == key, order[at], -1)
    upright = np.ptp(level, axis=0) > 0
    for name, own in (section.boundaries or {}).items():
        names[name] = within[upright & np.isin(edge, np.asarray(own, dtype=np.int64))]
    named = mesh.with_boundaries(names)
    if section.subdomains:
        first = section.nelements * np.arange(3 * (rows.size - 1))[:, None]
        named = named.with_subdomains(
            {
                name: (first + np.asarray(own, dtype=np.int64)).ravel()
                for name, own in section.subdomains.items()
            }
        )
    return labelled(named, geometry_of(section))


def _filled(section: MeshTri, rows: Floats) -> MeshTet:
    """Return the prisms cut along diagonals that rise from the lower number of two vertices.

    Prisms that share a side thus agree on its diagonal.
    """
    count = section.nvertices
    places = np.concatenate(
        [np.tile(section.p, rows.size), np.repeat(rows, count)[None]],
        axis=0,
    )
    a, b, c = np.sort(section.t.astype(np.int64), axis=0)
    parts: list[Ints] = []
    for low in count * np.arange(rows.size - 1):
        high = low + count
        parts += [
            np.stack([low + a, low + b, low + c, high + c]),
            np.stack([low + a, low + b, high + b, high + c]),
            np.stack([low + a, high + a, high + b, high + c]),
        ]
    return MeshTet(*map(np.ascontiguousarray, (places, np.concatenate(parts, axis=1))))
