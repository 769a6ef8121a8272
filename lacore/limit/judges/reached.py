"""Check whether a mechanism reaches the supports of its body, because the mesh is too small."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from lacore.assembly.discretisation import Discretisation
from lacore.assembly.slips import contact_facets
from lacore.limit.constants import FACING_SIDES, IN_DOUBT, MOVES, NEAR_SUPPORT, ROLLS
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.boundaries import facets_of, outward_normals
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.conditions.loads import Fix
from lacore.model.conditions.where import where_name
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind

_WHOLE = ("xy", "xyz")  # supports of all components, in two and three dimensions


def reached_supports(discretisation: Discretisation, velocity: Floats | None) -> Finding | None:
    """Return which supports the mechanism reaches; None without any.

    It checks bodies in plane strain, axisymmetric and three-dimensional bodies, and supports that
    fix all components or are the rollers of a box. Planes of symmetry are not supports of a box.
    Speeds grow with the distance from a support. Those at 2 % of the size of the body are taken
    from the adjacent elements, so that large elements, in which any motion ends, matter little.

    Args:
        discretisation: Discretisation of the problem.
        velocity: Velocity of all unknowns, shape (n,); None if it is unknown.
    """
    reached, rolling = [], False
    for support, dofs, speed, fastest in _held(discretisation, velocity):
        rollers = support.components not in _WHOLE
        if rollers and not _of_a_box(support, discretisation.problem, dofs.body):
            continue
        near = _beside(dofs, facets_of(support, dofs.body.mesh), speed)
        if near > (ROLLS if rollers else MOVES) * fastest > 0:
            reached.append(side(support))
            rolling |= rollers
    if not reached:
        return None
    kind = Kind.REACHES_ROLLERS if rolling else Kind.REACHES_SUPPORT
    return Finding(kind, tuple(reached), severity=Severity.WARNING)


def doubtful_supports(
    discretisation: Discretisation, velocity: Floats
) -> tuple[tuple[Fix, Floats], ...]:
    """Return straight fixed sides of soils with fast motion next to them, and their normals.

    Only soils with friction are checked, whose mechanisms are wide. `reached_supports` does not
    detect these sides if elements are so large that the motion ends within one.
    """
    found = []
    for support, dofs, speed, fastest in _held(discretisation, velocity):
        outward = _held_across(support, dofs.body)
        if support.components not in _WHOLE or outward is None or not _rubs(dofs.body):
            continue
        nodes = _nodes_beside(dofs, facets_of(support, dofs.body.mesh))
        if float(speed[nodes].max(initial=0.0)) > IN_DOUBT * fastest > 0:
            found.append((support, outward))
    return tuple(found)


def side(support: Fix) -> str:
    """Return the name of the side that a support holds: ``soil.bottom``."""
    return f"{support.body}.{where_name(support.where)}"


def _held(
    discretisation: Discretisation, velocity: Floats | None
) -> Iterator[tuple[Fix, BodyDofs, Floats, float]]:
    """Supports of bodies, their unknowns, speeds of their nodes, and the largest of all bodies.

    Plates in plane stress are structures that end at their supports.
    """
    if velocity is None or not discretisation.continua:
        return
    speeds = {
        name: np.hypot.reduce(velocity[dofs.dofs], axis=0)
        for name, dofs in discretisation.continua.items()
    }
    fastest = max(float(speed.max(initial=0.0)) for speed in speeds.values())
    for support in discretisation.problem.supports:
        dofs = discretisation.continua.get(support.body)
        if dofs is not None and dofs.body.kinematics != "plane_stress":
            yield support, dofs, speeds[support.body], fastest


def _of_a_box(support: Fix, problem: Problem, body: Body) -> bool:
    """Whether rollers end a body that is held on two sides which face each other.

    Where the load, or contact, begins at them they are a plane of symmetry. A quarter of a block,
    whose planes of symmetry do not face each other, is no box.
    """
    own = [one for one in problem.supports if one.body == support.body]
    held = [normal for one in own if (normal := _held_across(one, body)) is not None]
    faced = any(float(one @ other) < FACING_SIDES for one in held for other in held)
    if not faced or _held_across(support, body) is None:
        return False
    ends = np.unique(body.mesh.facets[:, facets_of(support, body.mesh)])
    loaded = [load for load in problem.reference_loads if load.body == support.body]
    touched = [
        body.mesh.facets[:, facets_of(load, body.mesh)]
        for load in loaded
        if load.boundary is not None
    ]
    contacts = (contact_facets(problem, index) for index in range(len(problem.interfaces)))
    touched += [body.mesh.facets[:, own[support.body]] for own in contacts if support.body in own]
    return not any(np.isin(ends, one).any() for one in touched)


def _held_across(support: Fix, body: Body) -> Floats | None:
    """Outward normal of a straight support that holds the motion across it; None of any other."""
    normals = outward_normals(body.mesh, facets_of(support, body.mesh), 0.5)
    normal = normals[:, 0]
    across = {axis: abs(part) for axis, part in zip("xyz", normal, strict=False)}
    across["tangential"] = 0.0
    straight = float((normal @ normals).min()) > -FACING_SIDES
    held = across.get(support.components, 1.0) > -FACING_SIDES
    return np.asarray(normal) if straight and held else None


def _rubs(body: Body) -> bool:
    """Whether a body has friction within: without tension slopes are 1."""
    surfaces = [one for region in body.regions for one in region.form.surfaces]
    steepest = [float(np.max(slope)) for one in surfaces for slope in one.slope]
    return any(0 < slope < 1 for slope in steepest)


def _nodes_beside(dofs: BodyDofs, facets: Ints) -> Ints:
    """Of the elements that touch facets."""
    mesh = dofs.body.mesh
    beside = np.isin(mesh.t, np.unique(mesh.facets[:, facets])).any(axis=0)
    return np.unique(dofs.element_nodes[: len(mesh.t), beside])


def _beside(dofs: BodyDofs, facets: Ints, speed: Floats) -> float:
    """Largest speed at 2 % of the size of a body from facets, as it rises to the next vertices."""
    mesh, near = dofs.body.mesh, NEAR_SUPPORT * dofs.body.size
    nodes = _nodes_beside(dofs, facets)
    distance = _distance(dofs.nodes[:, nodes], mesh.p[:, mesh.facets[:, facets]])
    return float((speed[nodes] * near / np.maximum(distance, near)).max(initial=0.0))


def _distance(points: Floats, corner: Floats) -> Floats:
    """From points (d, k) to the nearest of edges (2, 2, f), or faces (3, 3, f), shape (k,), m."""
    sides = [(corner[:, i], corner[:, j]) for i, j in combinations(range(corner.shape[1]), 2)]
    apart = [_from_segments(points, start, end).min(axis=1) for start, end in sides]
    if len(sides) > 1:
        apart.append(_above_faces(points, corner))
    return np.asarray(np.min(apart, axis=0))


def _from_segments(points: Floats, start: Floats, end: Floats) -> Floats:
    """From points (d, k) to segments (d, f), shape (k, f), m."""
    along, to = end - start, points[:, :, None] - start[:, None, :]
    share = np.einsum("if,ikf->kf", along, to) / np.sum(along**2, axis=0)
    foot = np.clip(share, 0.0, 1.0)[None] * along[:, None, :]
    return np.asarray(np.linalg.norm(to - foot, axis=0))


def _above_faces(points: Floats, corner: Floats) -> Floats:
    """From points (3, k) to the nearest of the faces that they are above, shape (k,), m; or inf."""
    first, second = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    to = points[:, :, None] - corner[:, 0, None, :]
    inverse = np.linalg.pinv(np.stack([first, second], axis=-1).transpose(1, 0, 2))  # (f, 2, 3)
    share = np.einsum("fai,ikf->akf", inverse, to)
    inside = (share >= 0).all(axis=0) & (share.sum(axis=0) <= 1)
    foot = share[0] * first[:, None] + share[1] * second[:, None]
    return np.asarray(np.where(inside, np.linalg.norm(to - foot, axis=0), np.inf).min(axis=1))
