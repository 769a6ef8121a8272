"""Meshes in a file with all of their data: elements in their order, curves, names."""

from __future__ import annotations

from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
from skfem.mesh import Mesh, MeshQuad1, MeshQuad2, MeshTet1, MeshTri1, MeshTri2

from lacore.model.meshes.polygonal import labelled
from lacore.model.meshes.solid.roundness import outline_of
from lacore.reporting.errors import InputError, typed

_KINDS = {kind.__name__: kind for kind in (MeshTri1, MeshTri2, MeshQuad1, MeshQuad2, MeshTet1)}
_NAMES = {"boundaries": "with_boundaries", "subdomains": "with_subdomains"}


@typed()
def save(mesh: Mesh, path: str | PathLike[str]) -> None:
    """Write a mesh as ``.npz``: `load` gives the same one, to the last digit.

    Raises:
        InputError: a name with another ending, a mesh of another kind than those of bodies, a file
            that cannot be written.

    Example:
        >>> la.meshes.save(la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2), "mesh.npz")
        >>> la.meshes.load("mesh.npz").nelements
        32
    """
    place = _named(path)
    if type(mesh).__name__ not in _KINDS:
        raise InputError(
            "mesh",
            type(mesh).__name__,
            "no body has such a mesh",
            f"give a skfem mesh: {', '.join(_KINDS)}",
        )
    arrays = {"points": mesh.doflocs, "elements": mesh.t}
    for what in _NAMES:
        named = getattr(mesh, what) or {}
        arrays |= {f"{what}/{name}": np.asarray(own, dtype=np.int64) for name, own in named.items()}
    kind, geometry = np.array(type(mesh).__name__), np.array(outline_of(mesh))
    try:
        with place.open("wb") as file:
            np.savez_compressed(file, **{"kind": kind, "geometry": geometry, **arrays})
    except OSError as error:
        why = f"cannot be written ({error.strerror or error})"
        raise InputError("path", str(place), why, "free space, or name another place") from error


@typed()
def load(path: str | PathLike[str]) -> Any:
    """Return a mesh written by `save`; no code of the file is run.

    Raises:
        InputError: no such file, or one that `save` did not write.

    Example:
        >>> la.meshes.save(la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2), "named.npz")
        >>> sorted(la.meshes.load("named.npz").boundaries)
        ['bottom', 'left', 'right', 'top']
    """
    place = _named(path)
    if not place.is_file():
        raise InputError("path", str(place), "no such file", "give the path of a mesh file")
    try:
        with np.load(place, allow_pickle=False) as archive:
            arrays = dict(archive)
        return _made(arrays)
    except Exception as error:  # errors of zip, keys and values: the file is not one of ours
        why = f"is not a mesh that lacore has saved ({type(error).__name__} {error})"
        raise InputError("path", str(place), why, "write it by lacore.model.meshes.save") from error


def _made(arrays: dict[str, Any]) -> Any:
    kind = _KINDS[str(arrays["kind"])]
    points, elements = arrays["points"].astype(np.float64), arrays["elements"].astype(np.int64)
    mesh = kind(np.ascontiguousarray(points), np.ascontiguousarray(elements))
    counts = {"boundaries": mesh.nfacets, "subdomains": mesh.nelements}
    for what, method in _NAMES.items():
        own = {
            name.partition("/")[2]: values.astype(np.int64)
            for name, values in arrays.items()
            if name.startswith(f"{what}/")
        }
        if any(len(v) and not 0 <= v.min() <= v.max() < counts[what] for v in own.values()):
            raise ValueError(f"{what} that the mesh lacks")
        mesh = getattr(mesh, method)(own) if own else mesh
    return labelled(mesh, str(arrays["geometry"]))


def _named(path: str | PathLike[str]) -> Path:
    place = Path(fspath(path))
    if place.suffix.lower() != ".npz":
        raise InputError("path", str(place), "not the name of a .npz file", "let it end in .npz")
    return place
