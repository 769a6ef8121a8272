"""Strengths that go along with a body as it deforms: by its strain points, not by places."""

from dataclasses import replace

import numpy as np

from lacore.bodies.continuum.body import Body
from lacore.bodies.continuum.dofs import BodyDofs
from lacore.bodies.continuum.regions.region import Region
from lacore.materials.criterion import Criterion
from lacore.materials.fields import Field, varying, with_fields


def moving_along(body: Body) -> Body:
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
