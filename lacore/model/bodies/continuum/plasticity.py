"""Dissipation of strains of a body as rows of the program (T6), one group for each region."""

import numpy as np
from scipy.sparse import csr_matrix

from lacore.model.bodies.continuum.regions.region import Region
from lacore.model.bodies.continuum.regions.varying import Varying, vertex_rule
from lacore.model.bodies.continuum.velocity_basis import VelocityBasis
from lacore.model.bodies.continuum.volume import conditions, volumetric_rows
from lacore.model.materials.fields import Field
from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.program.kinematic import DissipationGroup
from lacore.program.surfaces import Surfaces
from lacore.reporting.errors import InputError


def plasticity(
    name: str, velocity: VelocityBasis, offset: int, n: int
) -> tuple[DissipationGroup, ...]:
    """Return the dissipation at strain points of the regions of a body, over n unknowns (T6).

    Those of the body start at the offset.
    """
    basis = velocity.basis
    gradient = np.stack([np.asarray(shape[0].grad) for shape in basis.basis], axis=-1)
    rates = [gradient[0, 0], gradient[1, 1], gradient[0, 1] + gradient[1, 0]]
    if velocity.body.dimension == 3:
        rates.insert(2, gradient[2, 2])
        rates += [gradient[1, 2] + gradient[2, 1], gradient[2, 0] + gradient[0, 2]]
    if velocity.body.axisymmetric:  # Strain points lie off the axis.
        radial = np.stack([np.asarray(shape[0])[0] for shape in basis.basis], axis=-1)
        radius = np.asarray(basis.global_coordinates())[0]
        rates.insert(2, radial / radius[:, :, None])
    strain = np.stack(rates, axis=2)
    # shape of strain: (elements, points, components, shapes)
    columns = basis.element_dofs.T.astype(np.int64) + offset

    def rows(coefficients: Floats, elements: Ints) -> Sparse:
        values = np.einsum("rs,epsi->epri", coefficients, strain[elements])
        count = int(np.prod(values.shape[:3]))
        indices = np.broadcast_to(columns[elements][:, None, None, :], values.shape)
        start = np.arange(count + 1) * values.shape[3]
        return csr_matrix((values.ravel(), indices.ravel(), start), shape=(count, n))

    groups = []
    for region in velocity.body.regions:
        form = region.form
        bound, surfaces = at_strain_points(velocity, region)
        group = DissipationGroup(
            name=region.group_name(name),
            rows=rows(form.rows, region.elements),
            dim=form.rows.shape[0],
            weights=velocity.weights[region.elements].ravel(),
            bound=bound,
            volumetric=volumetric_rows(velocity, region, rows),
            volumetric_factor=form.volumetric_factor,
            surfaces=surfaces,
            conditions=conditions(velocity, region),
        )
        groups.append(group)
    return tuple(groups)


def at_strain_points(velocity: VelocityBasis, region: Region) -> tuple[Floats, Surfaces | None]:
    """Return the strengths at the strain points of a region: see `Region.strengths`.

    In a strict space they are such that the rule is above the dissipation of varying strengths;
    elsewhere they are those at the points.
    """
    count = velocity.weights.shape[1]

    def values(own: Field) -> Floats:
        varies = region.of(own)
        if not callable(own.values):
            listed = own.values.reshape(len(own.values), -1)[region.elements]
            if listed.shape[1] not in (1, count):
                raise InputError(
                    "Body.criterion",
                    own.values.shape,
                    f"values at {listed.shape[1]} points of each element, and the space"
                    f" {velocity.space.name!r} has {count}",
                    "give one value for each element",
                )
            return np.broadcast_to(listed, (region.elements.size, count)).ravel()
        if velocity.space.strict and velocity.linear:
            return by_rule(varies, count).ravel()
        places = np.asarray(velocity.basis.global_coordinates())[:, region.elements]
        return own.at(places.reshape(len(places), -1), "Body.criterion")

    return region.strengths(np.repeat(region.elements, count), values)


def by_rule(varies: Varying, points: int) -> Floats:
    """Return the strengths for the rule of one point or of the vertices, (elements, points), Pa.

    If a strength is unknown between places, those at the places are used, which prove nothing.
    """
    vertex = varies.above_if_known()
    if points == 1:
        return np.asarray(vertex.mean(axis=1, keepdims=True))
    return np.asarray(vertex @ vertex_rule(points) if varies.linear else vertex)
