"""Advice on a limit state: sides of a soil that hold it back, found by solving larger problems.

On coarse meshes all motion ends in the last element, so speeds do not show whether a box is too
small (`lacore.limit.judges.reached`). The same mesh with an additional row of elements does. All
velocities of the problem are possible in the larger one, so its load factor is not higher, and it
is lower if the side restrains the mechanism.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Set
from dataclasses import replace
from typing import Any

import numpy as np
from skfem import MeshTri
from skfem.mesh import MeshTri1

from lacore.assembly.discretisation import Discretisation
from lacore.coupling.kinds import ASSOCIATED
from lacore.limit.constants import BEYOND, FLAT, LESS_LOAD, SHOWING_ELEMENTS
from lacore.limit.judges.reached import doubtful_supports, reached_supports, side
from lacore.limit.solve import solve
from lacore.limit.state import LimitState
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.boundaries import facets_of
from lacore.model.conditions.loads import Fix
from lacore.model.meshes.refinement import bisected
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError, typed
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Rigor, Status
from lacore.reporting.text import Quantity
from lacore.solvers.registry import PROVING_BACKEND


@typed()
def advice(state: LimitState) -> tuple[Finding, ...]:
    """Find sides of soils that hold a mechanism back, by solving with more ground beyond them.

    A mechanism that reaches a side through small elements is reported by `lacore.solve`. Next
    to large elements velocities do not show this: up to eight larger and finer problems are solved.

    Args:
        state: Of any status; without a certified load factor there is no advice.

    Returns:
        One finding for each side beyond which more ground lowers the load factor.

    Example:
        >>> la.advice(la.solve(la.examples.footing()))
        ()
    """
    discretisation, point = state.discretisation, state.point
    if state.status is not Status.SOLVED or point is None:
        return ()
    if reached_supports(discretisation, point.velocity):
        return ()
    normal = state.coupling == ASSOCIATED or discretisation.full.associated_flow
    known = state.load_factor if normal and state.rigor is not Rigor.REGULARISED else None
    return held_back(discretisation, point.velocity, _associated, known)


def held_back(
    discretisation: Discretisation,
    velocity: Floats,
    solved: Callable[[Problem], float],
    load: float | None = None,
) -> tuple[Finding, ...]:
    """Return which sides of soils a mechanism would pass, and how much less it would carry.

    Only those sides are checked next to which elements are too large to tell from speeds.

    Args:
        discretisation: Discretisation of the problem.
        velocity: Velocity of all unknowns, shape (n,).
        solved: Function that returns the load factor of a problem with associated flow and contact,
            or NaN without one.
        load: Load factor of the problem itself, if it is known.
    """
    found = []
    problem = discretisation.problem
    for support, outward in doubtful_supports(discretisation, velocity):
        depth = BEYOND * float(np.ptp(outward @ _body(problem, support.body).mesh.p))
        larger = with_ground_beyond(problem, support, depth * outward)
        less = 0.0 if larger is None else _less(problem, larger, support.body, solved, load)
        if less > LESS_LOAD:
            values = {"depth": Quantity(depth, "m", ".3g"), "percent": 100 * less}
            where = (side(support),)
            found.append(Finding(Kind.MORE_GROUND, where, values, Severity.WARNING))
    return tuple(found)


def _less(
    problem: Problem,
    larger: Problem,
    body: str,
    solved: Callable[[Problem], float],
    load: float | None,
) -> float:
    """Return the relative reduction of the load by the row, on finer meshes while it is large."""
    while True:
        load = solved(problem) if load is None else load
        less = 1 - solved(larger) / load if load > 0 else 0.0
        if not less > LESS_LOAD or _body(problem, body).mesh.nelements >= SHOWING_ELEMENTS:
            return less
        try:
            problem, larger, load = _finer(problem, body), _finer(larger, body), None
        except InputError:  # values element by element
            return 0.0


def _body(problem: Problem, name: str) -> Body:
    return of_kind(problem.bodies, Body)[name]


def _finer(problem: Problem, body: str) -> Problem:
    own = _body(problem, body)
    mesh, _ = bisected(own.mesh, np.arange(own.mesh.nelements))
    return replace(problem, bodies={**problem.bodies, body: replace(own, mesh=mesh)})


def with_ground_beyond(problem: Problem, support: Fix, step: Floats) -> Problem | None:
    """Return the problem with a row of elements beyond a fixed straight side of a body.

    The outer side of the row is fixed instead. Regions, fields and body forces continue into the
    row, and so do supports and dead loads of the adjacent sides.

    Args:
        problem: The problem.
        support: Support of the whole side.
        step: Vector across the row, normal to the side, m, shape (2,).

    Returns:
        None if the body extends next to the row, if the reference load or contact touches the
        side, or if values are given element by element or vertex by vertex.
    """
    body = _body(problem, support.body)
    if type(body.mesh) is not MeshTri1:
        return None
    mesh, facets = body.mesh, facets_of(support, body.mesh)
    held = np.unique(mesh.facets[:, facets])
    height = step @ mesh.p / np.linalg.norm(step)
    if height.max() - height[held].min() > FLAT * body.size:
        return None
    parts: dict[str, Ints] = {}
    continued: set[str] = set()

    def moved(part: Any, continues: bool) -> Any:
        if part.body != support.body or part.boundary is None:
            return part
        name = f"part {len(parts)}"
        parts[name] = facets_of(part, body.mesh)
        if continues:
            continued.add(name)
        return replace(part, where=name)

    def turned(own: Any) -> Any:
        """A side of an interface: an obstacle stays."""
        if not isinstance(own, tuple) or own[0] != support.body:
            return own
        name = f"part {len(parts)}"
        parts[name] = body.boundary(own[1], "Interface")[0]
        return own[0], name

    live = [moved(load, False) for load in problem.reference_loads]
    interfaces = [
        replace(own, slave=turned(own.slave), master=turned(own.master))
        for own in problem.interfaces
    ]
    if any(np.isin(mesh.facets[:, own], held).any() for own in parts.values()):
        return None
    supports = [moved(own, True) for own in problem.supports]
    dead = [moved(load, True) for load in problem.dead_loads]
    try:
        longer = _with_row_beyond(mesh, facets, step, parts, continued)
        bodies = {**problem.bodies, support.body: replace(body, mesh=longer)}
        return Problem(bodies, live, supports, interfaces, dead)
    except InputError:
        return None


def _with_row_beyond(
    mesh: MeshTri, facets: Ints, step: Floats, parts: Mapping[str, Ints], continued: Set[str]
) -> MeshTri:
    """Return a mesh with a row of crossed quadrilaterals beyond facets of its boundary.

    Vertices and elements of the mesh come first. Regions continue into the row.

    Args:
        mesh: Straight-edged triangles.
        facets: Facets of one side.
        step: Vector from the side across the row, m, shape (2,).
        parts: Facets of the boundary by their new names; those on the side move across the row.
        continued: Names of parts that continue along the ends of the row if they end there.
    """
    side = np.unique(mesh.facets[:, facets])
    across = dict(
        zip(side.tolist(), range(mesh.nvertices, mesh.nvertices + side.size), strict=True)
    )
    centre = mesh.nvertices + side.size + np.arange(facets.size)
    one, other = mesh.facets[:, facets]
    far_one, far_other = (np.array([across[v] for v in own.tolist()]) for own in (one, other))
    rim = [one, other, far_other, far_one]
    triangles = [
        np.stack([begin, end, centre]) for begin, end in zip(rim, rim[1:] + rim[:1], strict=True)
    ]
    places = np.concatenate(
        [
            mesh.p,
            mesh.p[:, side] + step[:, None],
            (mesh.p[:, one] + mesh.p[:, other] + step[:, None]) / 2,
        ],
        axis=1,
    )
    longer = MeshTri(places, np.concatenate([mesh.t, *triangles], axis=1))
    owner = np.concatenate([np.arange(mesh.nelements), np.tile(mesh.f2t[0, facets], 4)])
    number = {ends: facet for facet, ends in enumerate(map(frozenset, longer.facets.T.tolist()))}
    ends = np.flatnonzero(np.bincount(mesh.facets[:, facets].ravel()) == 1)
    names = {}
    for name, own in parts.items():
        pairs = [frozenset(pair) for pair in mesh.facets[:, np.setdiff1d(own, facets)].T.tolist()]
        moved = mesh.facets[:, np.intersect1d(own, facets)].T.tolist()
        pairs += [frozenset(across[vertex] for vertex in pair) for pair in moved]
        if name in continued:
            beside = np.intersect1d(mesh.facets[:, np.setdiff1d(own, facets)], ends)
            pairs += [frozenset((vertex, across[vertex])) for vertex in beside.tolist()]
        names[name] = np.array([number[pair] for pair in pairs], dtype=np.int64)
    longer = longer.with_boundaries(names)
    if mesh.subdomains:
        regions = {
            name: np.flatnonzero(np.isin(owner, own)) for name, own in mesh.subdomains.items()
        }
        longer = longer.with_subdomains(regions)
    return longer


def _associated(problem: Problem) -> float:
    return solve(problem, PROVING_BACKEND, ASSOCIATED).load_factor
