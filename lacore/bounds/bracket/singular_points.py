"""Points with possibly unbounded strain rates, and the number of elements around them (T26b)."""

from math import ceil, pi, sqrt

import numpy as np
from skfem import MeshTri

from lacore.bounds.bracket.whole import continua, whole
from lacore.bounds.constants import NO_COHESION, SECTORS, SECTORS_BY_FRICTION, STRAIGHT
from lacore.bounds.lending import weight_per_area
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.boundaries import boundary_facets
from lacore.model.meshes.joined import Joined
from lacore.model.meshes.refinement import facets_between
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats, Ints


def singular_points(problem: Problem, name: str) -> list[int]:
    """Return the vertices of a body with unbounded strain rates, see `singular_vertices`."""
    own = whole(problem)
    number = {vertex: place for place, vertex in enumerate(own.vertices[name].tolist())}
    return sorted(number[v] for v in singular_vertices(problem) if v in number)


def singular_vertices(problem: Problem) -> list[int]:
    """Return the vertices with possibly unbounded strain rates.

    Re-entrant corners and ends of loads.

    They are numbered as in `whole`, on the boundaries of bodies, with bonded bodies as one: where
    the interior angle is above 180 degrees, or where loads, supports or interfaces end along a
    straight line. The end of a free edge of a heavy soil without cohesion is not one: stresses
    vanish there, and turn equally at any distance.
    """
    bonded = whole(problem, bonded=True)
    mesh = bonded.mesh
    alike = [
        np.concatenate([_facets(problem, bonded, name, facets) for name, facets in parts])
        for parts in _conditions(problem)
    ]
    boundary = mesh.boundary_facets()
    conditions = np.zeros((mesh.nfacets, len(alike)), dtype=bool)
    for column, facets in enumerate(alike):
        conditions[facets, column] = True
    loose = np.zeros(mesh.nfacets, dtype=bool)
    for name, body in continua(problem).items():
        if _loose(problem, name):
            loose[_facets(problem, bonded, name, body.mesh.boundary_facets())] = True
    angle = _angles(mesh)
    sides: dict[int, list[int]] = {}
    for facet in boundary.tolist():
        for vertex in mesh.facets[:, facet].tolist():
            sides.setdefault(vertex, []).append(facet)
    found = []
    for vertex, (one, *others) in sorted(sides.items()):
        if any(loose[side] and not conditions[side].any() for side in (one, *others)):
            continue
        changes = any(np.any(conditions[one] != conditions[other]) for other in others)
        if angle[vertex] > pi + STRAIGHT or (changes and angle[vertex] > pi - STRAIGHT):
            found.append(vertex)
    number = np.zeros(mesh.p.shape[1], dtype=np.int64)
    for name, vertices in whole(problem).vertices.items():
        number[bonded.vertices[name]] = vertices
    return np.unique(number[found]).tolist() if found else []


def _conditions(problem: Problem) -> list[list[tuple[str, Ints]]]:
    """Return the facets of each body with a common condition: a support, a load, an interface."""
    bodies = continua(problem)
    alike: dict[object, list[tuple[str, Ints]]] = {}
    # Supports of the same components count as one, also on different bonded bodies.
    parts = [(own.components, own) for own in problem.supports]
    for key, part in (*parts, *enumerate(problem.loads.values())):
        if part.boundary is not None and part.body in bodies:
            facets = boundary_facets(bodies[part.body].mesh, part.boundary, "where")
            alike.setdefault(key, []).append((part.body, facets))
    for pair, segments in zip(problem.interfaces, problem.segments, strict=True):
        for (name, _), facets in zip(pair.sides, segments.edges, strict=False):
            if name in bodies:
                alike[pair.name, name] = [(name, np.asarray(facets))]
    return list(alike.values())


def _facets(problem: Problem, joined: Joined, name: str, facets: Ints) -> Ints:
    """Return the facets of a body as those of the joined mesh."""
    ends = continua(problem)[name].mesh.facets[:, facets]
    return facets_between(joined.mesh, joined.vertices[name][ends])


def sectors_for(target_width: float, friction: float = 0.0) -> int:
    """Return the number of sectors in 180 degrees that cost less than half of a relative width.

    It follows from the punch, whose load increases by about ``1/(4 n^2)`` with n sectors in 90
    degrees (T26b); with friction 2.6 times as much at 20 degrees, 3.7 times at 30.

    Args:
        target_width: width of the bracket.
        friction: tangent of the friction angle of the body.
    """
    return ceil(SECTORS * sqrt((1 + SECTORS_BY_FRICTION * friction) / target_width))


def friction_of(body: Body) -> float:
    """Return the tangent of the largest friction angle of a body, 0 without friction."""
    surfaces = [one for region in body.regions for one in region.form.surfaces]
    largest = [float(np.max(slope)) for one in surfaces for slope in one.slope]
    slopes = [slope for slope in largest if 0 < slope < 1]
    return max((slope / sqrt(1 - slope**2) for slope in slopes), default=0.0)


def _loose(problem: Problem, name: str) -> bool:
    """Return whether a body has almost no strength along a free edge, compared with its weight."""
    body = of_kind(problem.bodies, Body)[name]
    carried = [
        2 * float(np.min(region.seen(one.strength))) / (1 - float(np.min(one.slope[0])))
        for region in body.regions
        for one in region.form.surfaces
        if one.normed and np.all(np.less(one.slope[0], 1))
    ]
    return min(carried, default=np.inf) < NO_COHESION * weight_per_area(problem, name)


def _angles(mesh: MeshTri) -> Floats:
    """Return the sum of the angles of elements at vertices, shape (vertices,), rad."""
    corner = mesh.p[:, mesh.t]
    after, before = np.roll(corner, -1, axis=1) - corner, np.roll(corner, 1, axis=1) - corner
    cross = np.abs(after[0] * before[1] - after[1] * before[0])
    total = np.zeros(mesh.p.shape[1])
    np.add.at(total, mesh.t, np.arctan2(cross, np.sum(after * before, axis=0)))
    return total
