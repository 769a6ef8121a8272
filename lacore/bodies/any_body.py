"""A body of any kind: parts of its boundary, and how exactly its coordinates agree."""

import numpy as np

from lacore.arrays import Ints
from lacore.bodies.blocks.block_assembly import BlockAssembly
from lacore.bodies.continuum.body import Body
from lacore.bodies.continuum.boundaries import boundary_facets, facet_geometry
from lacore.bodies.frames.frame import Frame
from lacore.bodies.touching import TOUCH, Edges
from lacore.conditions.where import Where

AnyBody = Body | BlockAssembly | Frame


def boundary_edges(body: AnyBody, where: Where, field: str) -> tuple[Ints, Edges]:
    """Numbers and geometry of a part of the boundary of a body; a node is an edge of length 0."""
    if isinstance(body, Frame):
        nodes = body.find(where, field)
        place = body.position[:, nodes]
        return nodes, Edges(place, place, np.zeros_like(place))
    if isinstance(body, BlockAssembly):
        edges = body.outline(where, field)
        every = body.edges
        return edges, Edges(every.start[:, edges], every.end[:, edges], every.normal[:, edges])
    facets = boundary_facets(body, where, field)
    return facets, Edges(*facet_geometry(body, facets))


def tolerance(body: AnyBody) -> float:
    """Distance up to which coordinates count as one, m."""
    if isinstance(body, BlockAssembly | Frame):
        assert body.tolerance is not None  # since it was built
        return body.tolerance
    return TOUCH * body.size
