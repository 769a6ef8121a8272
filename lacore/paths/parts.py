"""Bodies, loads and supports in the form that a path can follow."""

from dataclasses import replace
from functools import singledispatch
from typing import Any

import numpy as np
from skfem import Mesh

from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.regions.region import Region
from lacore.model.bodies.continuum.spaces import VelocitySpace, isoparametric
from lacore.model.conditions.body_forces import BodyForce
from lacore.model.conditions.loads import Load
from lacore.model.conditions.water import PorePressure, StandingWater
from lacore.model.materials.criterion import Criterion
from lacore.model.materials.fields import Field, varying, with_fields
from lacore.reporting import terms
from lacore.reporting.errors import InputError
from lacore.reporting.text import Term, text


@singledispatch
def check_load(load: Load, field: str) -> None:
    """Refuse loads that do not go along with bodies as these deform."""


@check_load.register(PorePressure)
@check_load.register(StandingWater)
def _no_water(load: PorePressure | StandingWater, field: str) -> None:
    raise InputError(
        field,
        load.told,
        "water at rest has its surface where it is, and the vertices of a body that flows far leave"
        " it",
        text(
            "leave it out, or give {} along the boundary; `solve` takes it in the shape that is"
            " given",
            terms.PRESSURE,
        ),
    )


@check_load.register(BodyForce)
def _uniform(load: BodyForce, field: str) -> None:
    if not load.uniform:
        raise InputError(
            field,
            load.told,
            "varies by place or by element, and the body moves and gets other meshes",
            text(
                "give a number for each region{}",
                Term(": BodyForce(body, (x, y), where=region)", " (where = region)"),
            ),
        )


def of_block(part: Any, kind: str) -> Any:
    """A load or support of a whole rigid block: a function of coordinates would lose it."""
    if callable(part.where):
        raise InputError(
            f"{kind}.where",
            None,
            f"a function of coordinates, and the rigid block {part.body!r} moves away from them",
            text(
                "give the name of the block, 'block' of a {}, or a {}",
                terms.RIGID_BLOCK,
                Term("PointForce", "point force"),
            ),
        )
    return part


def curved_body(name: str, body: object) -> Body:
    """Return a deformable body with curved elements of an isoparametric space.

    Raises:
        InputError: no path follows a body of this kind.
    """
    if not isinstance(body, Body):
        raise InputError(
            f"Problem.bodies[{name!r}]",
            type(body).__name__,
            "a path follows deformable bodies and single rigid blocks in the plane",
            text("give a {} or a {}", terms.CONTINUUM, terms.RIGID_BLOCK),
        )
    if body.kinematics not in ("plane_strain", "axisymmetric"):
        raise InputError(
            f"Problem.bodies[{name!r}].kinematics",
            body.kinematics,
            "no path follows tetrahedra, or a thickness that changes from point to point",
            "take 'plane_strain' or 'axisymmetric'",
        )
    for region in body.regions:
        if region.criterion.law is not None and region.form.surfaces:
            part = f"[{region.name!r}]" if region.name else ""
            raise InputError(
                f"Problem.bodies[{name!r}].criterion{part}.law",
                region.criterion.law,
                "strength that depends on pressure does not harden along a path",
                "let it be None",
            )
    space = isoparametric(body.mesh, body.space)
    return _moving_along(replace(body, mesh=_quadratic(body.mesh, space), space=space.name))


def _quadratic(mesh: Mesh, space: VelocitySpace) -> Mesh:
    assert space.curved is not None  # it is isoparametric
    if isinstance(mesh, space.curved):
        return mesh
    curved = space.curved.from_mesh(mesh)
    assert np.array_equal(curved.facets, mesh.facets)
    curved = curved.with_boundaries({n: np.asarray(f) for n, f in (mesh.boundaries or {}).items()})
    regions = {n: np.asarray(own) for n, own in (mesh.subdomains or {}).items()}
    return curved.with_subdomains(regions) if regions else curved


def _moving_along(body: Body) -> Body:
    """A body whose functions of place are values at strain points, where it is now."""
    if not any(
        callable(own.values)
        for region in body.regions
        for own in varying(region.criterion).values()
    ):
        return body
    places = np.asarray(BodyDofs.at(body, 0).basis.global_coordinates())  # (2, elements, q)

    def kept(region: Region) -> Criterion:
        def listed(own: Field) -> Field:
            if not callable(own.values):
                return own
            values = np.zeros(places.shape[1:])
            inside = places[:, region.elements]
            found = own.at(inside.reshape(2, -1), "Body.criterion")
            values[region.elements] = found.reshape(inside.shape[1:])
            return replace(own, values=values, steepest=None)

        changed: Criterion = with_fields(region.criterion, listed)
        return changed

    if not body.regions[0].name:
        return replace(body, criterion=kept(body.regions[0]))
    return replace(body, criterion={region.name: kept(region) for region in body.regions})
