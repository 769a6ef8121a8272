"""Bodies on meshes with the same vertices on both sides of their contact."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
from skfem.mesh import MeshTri1

from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.body_forces import free_of_mesh
from lacore.model.bodies.continuum.regions import inheriting
from lacore.model.conditions.loads import Load
from lacore.model.contact.interfaces import Interface
from lacore.model.contact.segments import Segments
from lacore.model.contact.touching import in_plane
from lacore.model.meshes.hanging import with_vertices
from lacore.model.meshes.joined import Glued
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting.errors import InputError, typed

# An added vertex lies on an edge of the other side, so the second pass adds none there.
_ROUNDS = 3


@typed()
def matching(problem: Problem) -> Problem:
    """Return the problem on meshes with the same vertices wherever two bodies touch.

    Elements with vertices of the other side on an edge are divided there, which keeps the domains,
    the names and the laws. If the meshes already match, the same problem is returned.

    Raises:
        InputError: a body with such an edge does not consist of straight triangles.

    Example:
        >>> lower = la.meshes.rectangle(x=(0, 2), y=(-1, 0), nx=3, ny=1)
        >>> upper = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=2, ny=1)
        >>> clay = la.VonMises(shear_strength=1.0)
        >>> bonded = la.Problem(
        ...     bodies={"lower": la.Body(lower, clay), "upper": la.Body(upper, clay)},
        ...     supports=[la.Fix("lower", "bottom")],
        ...     interfaces=[la.Interface(("upper", "bottom"), ("lower", "top"), friction=la.BOND)],
        ...     reference_loads=[la.Traction("upper", "right", (1, 0))],
        ... )
        >>> lower.nelements, la.matching(bonded).bodies["lower"].mesh.nelements
        (12, 17)
    """
    for _ in range(_ROUNDS):
        finer: dict[str, Body] = {}
        for name, body in of_kind(problem.bodies, Body).items():
            facets, places = _hanging(problem, name)
            if facets.size:
                mesh = with_vertices(_triangles(name, body), facets, places)
                finer[name] = inheriting.on_mesh(body, mesh, body.space)
        if not finer:
            return problem
        problem = _on_finer(problem, finer)
    return problem


def _on_finer(problem: Problem, finer: Mapping[str, Body]) -> Problem:
    """Return the problem with bodies on other meshes, and the same loads there."""
    coarse = of_kind(problem.bodies, Body)

    def held(load: Load) -> Load:
        return free_of_mesh(load, coarse[load.body].mesh) if load.body in finer else load

    return replace(
        problem,
        bodies={**problem.bodies, **finer},
        reference_loads=[held(load) for load in problem.reference_loads],
        dead_loads=[held(load) for load in problem.dead_loads],
    )


def glued(problem: Problem, bonded: bool) -> list[Glued]:
    """Return the vertices that two bodies share where they touch, or only where they are bonded."""
    found = []
    for interface, segments in _pairs(problem):
        if bonded and not interface.bonded:
            continue
        first, second = (name for name, _ in interface.sides)
        same, turned, ends = _ends(problem, interface, segments)
        one, other = (own[:, same] for own in ends)
        other = np.where(turned[same], other[::-1], other)
        found.append(Glued(first, second, np.stack([one.ravel(), other.ravel()])))
    return found


def _pairs(problem: Problem) -> Iterator[tuple[Interface, Segments]]:
    """Yield the interfaces of two continua."""
    continua = of_kind(problem.bodies, Body)
    for interface, touching in zip(problem.interfaces, problem.touching, strict=True):
        names = [name for name, _ in interface.sides]
        if len(names) == 2 and all(name in continua for name in names):
            yield interface, in_plane(touching)


def _ends(
    problem: Problem, interface: Interface, segments: Segments
) -> tuple[Bools, Bools, list[Ints]]:
    """Return which segments are an edge of both sides, which are reversed, and the vertices."""
    bodies = [of_kind(problem.bodies, Body)[name] for name, _ in interface.sides]
    near = max(body.allowed for body in bodies)
    vertices = [
        body.mesh.facets[:, edges].astype(np.int64)
        for body, edges in zip(bodies, segments.edges, strict=True)
    ]
    a, b = (body.mesh.p[:, own] for body, own in zip(bodies, vertices, strict=True))
    straight, turned = (
        np.all(np.linalg.norm(a - facing, axis=0) <= near, axis=0) for facing in (b, b[:, ::-1])
    )
    return straight | turned, turned, vertices


def _hanging(problem: Problem, name: str) -> tuple[Ints, Floats]:
    """Return the edges of a body inside which a segment ends, (k,), and the places, (2, k).

    Each place is included once.
    """
    edges, places = [np.zeros(0, dtype=np.int64)], [np.zeros((2, 0))]
    body = of_kind(problem.bodies, Body)[name]
    for interface, segments in _pairs(problem):
        for (own, _), touched in zip(interface.sides, segments.edges, strict=True):
            if own != name:
                continue
            ends = body.mesh.p[:, body.mesh.facets[:, touched]]  # shape (2, ends, segments)
            for place in (segments.start, segments.end):
                away = np.linalg.norm(ends - place[:, None], axis=0).min(axis=0)
                inside = away > body.allowed
                edges.append(touched[inside])
                places.append(place[:, inside])
    edge, place = np.concatenate(edges), np.concatenate(places, axis=1)
    if not edge.size:
        return edge, place
    start = body.mesh.p[:, body.mesh.facets[0, edge]]
    along = np.linalg.norm(place - start, axis=0)
    order = np.lexsort((along, edge))
    edge, place, along = edge[order], place[:, order], along[order]
    again = np.concatenate([[False], (np.diff(edge) == 0) & (np.diff(along) <= body.allowed)])
    return edge[~again], place[:, ~again]


def _triangles(name: str, body: Body) -> MeshTri1:
    if type(body.mesh) is not MeshTri1:
        raise InputError(
            f"Problem.bodies[{name!r}].mesh",
            type(body.mesh).__name__,
            "its edges do not match those of what it touches, and only straight triangles are"
            " divided so that they do",
            "give both sides the same vertices",
        )
    return body.mesh
