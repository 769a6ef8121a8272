"""Strain rate of a body as one number at each point: the equivalent strain rate (T29)."""

from collections.abc import Sequence
from math import sqrt

import numpy as np

from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.regions.gathering import gathered
from lacore.model.bodies.continuum.regions.region import Region
from lacore.model.materials.fields import Field
from lacore.numerics.arrays import Floats
from lacore.program.dissipation import DissipationGroup


def equivalent_rate(dofs: BodyDofs, groups: Sequence[DissipationGroup], velocity: Floats) -> Floats:
    """Return the equivalent strain rate at the strain points, shape (elements, q), 1/s.

    If strength does not depend on pressure, it is the rate with the same dissipation at the yield
    stress in tension. Else it is ``sqrt(2/3) ||e||`` of the deviator e of the strain rate, for
    velocities that keep volumes and for those that dilate. In plane stress the rate across the
    plane is left out, since a velocity does not determine it.

    Args:
        dofs: unknowns of the body.
        groups: dissipation of its regions, over all unknowns.
        velocity: velocity of all unknowns, m/s.
    """
    rates = []
    for region, group in zip(dofs.body.regions, groups, strict=True):
        if group.surfaces is None:
            lengths = np.linalg.norm(group.cone_vectors(velocity), axis=1)
            own = strain_per_length(region) * lengths.reshape(region.elements.size, -1)
        else:
            own = deviatoric(principal_rates(dofs, velocity[dofs.dofs]))[region.elements]
        rates.append(np.asarray(own))
    return gathered(dofs.body, rates)


def strain_per_length(region: Region) -> float:
    """Return the equivalent strain rate per length of a cone vector of equal dissipation.

    For pressure-dependent strength it is that of lengths of ``(eps_xx - eps_yy, gamma)``; if
    strength varies with place, that of von Mises.
    """
    form = region.form
    if form.surfaces or isinstance(form.bound, Field):
        return 1 / sqrt(3)
    return float(np.max(form.bound) / (sqrt(3) * region.largest_shear))


def deviatoric(principal: Floats) -> Floats:
    """Return the equivalent strain, or its rate, of principal ones of shape (3, ...)."""
    deviator = principal - principal.mean(axis=0)
    return np.asarray(np.sqrt(2 / 3 * np.sum(deviator**2, axis=0)))


def principal_rates(dofs: BodyDofs, velocity: Floats) -> Floats:
    """Return the principal strain rates at the strain points, shape (3, elements, q), 1/s.

    Args:
        dofs: unknowns of the body.
        velocity: velocity of its nodes, shape (d, nodes), m/s.
    """
    field = dofs.basis.interpolate(velocity.T.ravel())
    gradient = np.asarray(field.grad)
    if dofs.body.dimension == 3:
        strain = (gradient + gradient.swapaxes(0, 1)).transpose(2, 3, 0, 1) / 2
        return np.asarray(np.linalg.eigvalsh(strain).transpose(2, 0, 1))
    mean = (gradient[0, 0] + gradient[1, 1]) / 2
    radius = np.hypot((gradient[0, 0] - gradient[1, 1]) / 2, (gradient[0, 1] + gradient[1, 0]) / 2)
    out = np.zeros_like(mean)
    if dofs.body.axisymmetric:
        out = np.asarray(field)[0] / np.asarray(dofs.basis.global_coordinates())[0]
    return np.stack([mean + radius, mean - radius, out])
