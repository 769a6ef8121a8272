"""Regions of a body from the arguments of the user."""

from collections.abc import Mapping

import numpy as np
from skfem import Mesh

from lacore.model.bodies.continuum.regions.angles import envelopes, near
from lacore.model.bodies.continuum.regions.region import Region
from lacore.model.bodies.continuum.regions.varying import in_elements
from lacore.model.materials.criterion import Criterion
from lacore.model.materials.fields import Field, varying
from lacore.model.meshes.curved import vertices
from lacore.numerics.arrays import Ints
from lacore.reporting import terms
from lacore.reporting.errors import InputError, suggest_all
from lacore.reporting.showing import counted, listed, short, spanned
from lacore.reporting.text import Quantity, Term, text


def regions_of(
    mesh: Mesh, criterion: Criterion | Mapping[str, Criterion], kinematics: str
) -> tuple[Region, ...]:
    """Return the regions of a body, checked.

    Raises:
        InputError: unknown regions, regions that overlap or leave out elements; strengths that are
            negative somewhere, or of other elements than those of the mesh.
    """
    if not isinstance(criterion, Mapping):
        require_criterion("Body.criterion", criterion)
        return (_with_effect(_region("", np.arange(mesh.nelements), criterion, kinematics, mesh)),)
    elements = _elements(mesh, criterion)
    return tuple(
        _with_effect(_region(name, elements[name], own, kinematics, mesh))
        for name, own in criterion.items()
    )


def require_criterion(name: str, given: object) -> None:
    """Raise `InputError` unless something is a yield criterion."""
    if isinstance(given, type) or not isinstance(given, Criterion):
        raise InputError(
            name,
            given,
            "not a yield criterion",
            "give lacore.VonMises(shear_strength=...), or an object with strength, label, law"
            " and conic_form (lacore.model.materials.criterion.Criterion); or {region: criterion}",
        )


def _elements(mesh: Mesh, criteria: Mapping[str, Criterion]) -> dict[str, Ints]:
    known = mesh.subdomains or {}
    if not criteria:
        raise InputError("Body.criterion", {}, "no region", "give {region: criterion}")
    found: dict[str, Ints] = {}
    owner = np.full(mesh.nelements, -1)
    for number, (name, own) in enumerate(criteria.items()):
        place = f"Body.criterion[{name!r}]"
        if name not in known:
            fix = (
                suggest_all(str(name), known)
                if known
                else text(
                    "name parts by {}{}, or by physical groups of surfaces",
                    Term("mesh.with_subdomains({name: function of coordinates}), by ", ""),
                    terms.LAYERED,
                )
            )
            raise InputError(place, name, "no such region of the mesh", fix)
        require_criterion(place, own)
        elements = np.unique(np.asarray(known[name], dtype=np.int64))
        if not elements.size:
            raise InputError(place, name, "a region without elements", "leave it out")
        taken = np.flatnonzero(owner[elements] >= 0)
        if taken.size:
            other = list(criteria)[owner[elements[taken[0]]]]
            raise InputError(
                place,
                name,
                text(
                    "overlaps region {} in {}, {}",
                    repr(other),
                    counted(taken.size, "element"),
                    _where(mesh, elements[taken]),
                ),
                "let each element lie in one region",
            )
        owner[elements] = number
        found[str(name)] = elements
    left = np.flatnonzero(owner < 0)
    if left.size:
        unused = [name for name in known if name not in criteria]
        raise InputError(
            "Body.criterion",
            list(criteria),
            f"{counted(left.size, 'element')} in no region, near {near(mesh, int(left[0]))}",
            f"give these a criterion, too: the mesh has also {listed(unused)}"
            if unused
            else "let regions cover the mesh",
        )
    return found


def _where(mesh: Mesh, elements: Ints) -> str:
    """Return the place of elements, and how deep it is: the smaller side of the box around them."""
    places = vertices(mesh)[:, np.unique(mesh.t[:, elements])]
    low, high = places.min(axis=1), places.max(axis=1)
    return text("{} deep, within {}", Quantity((high - low).min(), "m", ".4g"), spanned(low, high))


def _with_effect(region: Region) -> Region:
    """Return the region; raises `InputError` if a cut-off has no effect in any element."""
    if region.without_effect == 1:
        raise InputError(
            f"{_place(region.name)}.tension_cutoff",
            region.told,
            "beyond the apex c cot(phi) everywhere, which no stress exceeds",
            "give less somewhere, or none",
        )
    return region


def _place(name: str) -> str:
    return f"Body.criterion[{name!r}]" if name else "Body.criterion"


def _region(name: str, elements: Ints, criterion: Criterion, kinematics: str, mesh: Mesh) -> Region:
    place = _place(name)
    if {"friction_angle", "dilation_angle"} & varying(criterion).keys():
        known = tuple(
            (own, in_elements(f"{place}.{key}", own, mesh, elements, False))
            for key, own in varying(criterion).items()
        )
        both = envelopes(place, criterion, known, mesh, elements, kinematics)
        return Region(name, elements, criterion, both.above, known, both.below)
    form = criterion.conic_form(kinematics)
    for own in form.strengths:
        if not isinstance(own, Field) and np.ndim(own) and len(np.asarray(own)) != mesh.nelements:
            raise InputError(
                place,
                short(own),
                f"strengths of {len(np.asarray(own))} elements on a mesh of {mesh.nelements}",
                "give one for each element of the mesh",
            )
    known = tuple(
        (own, in_elements(f"{place}.{key}", own, mesh, elements, not form.surfaces))
        for key, own in varying(criterion).items()
    )
    return Region(name, elements, criterion, form, known)
