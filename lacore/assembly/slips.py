"""Slip along held boundaries whose support meets other conditions at a corner (T23).

A continuous velocity that sticks to a support, or to a rough footing, sticks to it at its last
vertex too. If contact of another direction, or a support with another motion, begins there, no mesh
has an admissible velocity, although the continuum has one: the body yields next to the support. Its
tangential velocity jumps, at ``k |[u_t]|`` per area, which is at least the power of any admissible
stress, so that bounds remain strict; ``[u_n] = 0`` is kept. Such a boundary slips along all of its
length, on every mesh; all others stick, as in the limit of fine meshes they may.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from lacore.assembly.bonds import supports_of
from lacore.model.bodies.continuum.boundaries import boundary_facets, facet_geometry
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.slip import Slip
from lacore.model.conditions.elimination import NodeConditions, contradictory, join
from lacore.model.conditions.footings import Footing
from lacore.model.conditions.nodes import footing_conditions, support_conditions
from lacore.model.problem.matching import glued
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting.showing import Compact

_NONE = np.zeros(0, dtype=np.int64)
_PARALLEL = 1e-12  # squared sine between directions that count as equal, as in `elimination`


def slips(
    problem: Problem,
    bodies: Mapping[str, BodyDofs],
    footings: Sequence[Footing],
    first: int,
) -> dict[str, Slip]:
    """Return where the bodies of a problem slip, by name; those without slip are left out.

    Only straight triangles in the plane slip: elsewhere no load factor is a bound, and meshes of
    paths would leave their supports. Boundaries with dilatant friction do not, since slip would
    have to open them.

    Args:
        problem: the problem.
        bodies: its continua.
        footings: footings in the order of their unknowns.
        first: number of the first of these.
    """
    touched = [
        contact_facets(problem, index)
        for index, interface in enumerate(problem.interfaces)
        if not interface.bonded
    ]
    vertices = _bonded_vertices(problem, bodies)
    able = []
    for name, dofs in bodies.items():
        if dofs.linear and dofs.body.dimension == 2:
            asked, owner = asked_of(problem, name, dofs, footings)
            contact = np.concatenate([_NONE, *(part[name] for part in touched if name in part)])
            own = _able(name, dofs, asked, owner, footings, np.unique(contact))
            if own.facets.size:
                able.append(own)
    if not able:
        return {}
    # A connected part of the boundary of bonded bodies slips as a whole.
    ends = [vertices[own.name][own.dofs.body.mesh.facets[:, own.facets]] for own in able]
    owner = np.concatenate([own.owner for own in able])
    part = _parts(np.concatenate(ends, axis=1), owner)
    slipping = np.isin(part, part[np.concatenate([own.must for own in able])])
    masks = np.split(slipping, np.cumsum([own.facets.size for own in able])[:-1])
    motion = np.array([*(footing.motion(np.zeros(2)) for footing in footings), (0.0, 0.0)])
    return {
        own.name: own.slip(mask, first, motion)
        for own, mask in zip(able, masks, strict=True)
        if mask.any()
    }


def asked_of(
    problem: Problem, name: str, dofs: BodyDofs, footings: Sequence[Footing]
) -> tuple[NodeConditions, Ints]:
    """Return the conditions on facets, and their owners: a footing, or -1 for supports.

    The conditions are numbered by facets instead of nodes.
    """
    parts = []
    for support in supports_of(problem):
        if support.body == name:
            facets = boundary_facets(dofs.body.mesh, support.where, "Fix.where")
            *_, outward = facet_geometry(dofs.body.mesh, facets)
            parts.append((-1, support_conditions(support, facets, outward.T)))
    for number, footing in enumerate(footings):
        if footing.body == name:
            facets = boundary_facets(dofs.body.mesh, footing.where, "RigidFooting.where")
            *_, outward = facet_geometry(dofs.body.mesh, facets)
            parts.append((number, footing_conditions(footing, facets, outward.T, number)))
    owners = [np.full(own.nodes.size, number) for number, own in parts]
    return join([own for _, own in parts]), np.concatenate([_NONE, *owners])


def contact_facets(problem: Problem, index: int) -> dict[str, Ints]:
    """Return the facets, edges or nodes of each body that an interface touches."""
    edges = problem.touching[index].edges
    sides = zip(problem.interfaces[index].sides, edges, strict=False)
    return {name: np.unique(edges) for (name, _), edges in sides}


@dataclass(frozen=True, repr=False)
class _Able(Compact):
    """Facets of a body that may slip past their support.

    Attributes:
        name, dofs: name and unknowns of the body.
        facets, normal, owner, holds_normal, straight: see `Slip`, shape (e,) or (2, e).
        must: which of them have no admissible velocity otherwise, shape (e,).
    """

    name: str
    dofs: BodyDofs
    facets: Ints
    normal: Floats
    owner: Ints
    holds_normal: Bools
    straight: Bools
    must: Bools

    def slip(self, kept: Bools, first: int, motion: Floats) -> Slip:
        """Return the slip of a mask.

        `first` is the first footing's unknown, `motion` theirs, (f, 2).
        """
        owner = self.owner[kept]
        return Slip(
            facets=self.facets[kept],
            normal=self.normal[:, kept],
            footing=owner,
            unknown=np.where(owner < 0, 0, first + owner),
            motion=motion[owner].T,
            holds_normal=self.holds_normal[kept],
            stuck=self.straight[:, kept],
        )


def _able(
    name: str,
    dofs: BodyDofs,
    asked: NodeConditions,
    asking: Ints,
    footings: Sequence[Footing],
    contact: Ints,
) -> _Able:
    mesh = dofs.body.mesh
    facets, owner, holds_normal = _sticking(dofs, asked, asking)
    apart = ~np.isin(facets, contact) & ~_pressure_dependent(dofs)[mesh.f2t[0, facets]]
    facets, owner, holds_normal = facets[apart], owner[apart], holds_normal[apart]
    *_, normal = facet_geometry(dofs.body.mesh, facets)
    turned, straight = meetings(dofs, facets, contact)
    corners = [
        NodeConditions(end, asked.directions, asked.footing, asked.factors)
        for end in mesh.facets[:, asked.nodes].astype(np.int64)
    ]
    against = contradictory(join(corners), mesh.nvertices, len(footings))
    must = np.any(turned | np.isin(mesh.facets[:, facets], against), axis=0)
    return _Able(name, dofs, facets, normal, owner, holds_normal, straight, must)


def _bonded_vertices(problem: Problem, bodies: Mapping[str, BodyDofs]) -> dict[str, Ints]:
    """Return the numbers of the vertices of bodies, equal where they are bonded."""
    if not bodies:
        return {}
    counts = [dofs.body.mesh.p.shape[1] for dofs in bodies.values()]
    start = dict(zip(bodies, np.cumsum([0, *counts[:-1]]).tolist(), strict=True))
    pairs = [np.zeros((2, 0), dtype=np.int64)]
    for own in glued(problem, bonded=True):
        pairs.append(own.vertices + np.reshape([start[own.first], start[own.second]], (2, 1)))
    one, other = np.concatenate(pairs, axis=1)
    graph = csr_matrix((np.ones(one.size), (one, other)), shape=(sum(counts),) * 2)
    number = np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)
    return {name: number[start[name] :][:count] for name, count in zip(bodies, counts, strict=True)}


def _pressure_dependent(dofs: BodyDofs) -> Bools:
    """Return the elements whose strength depends on pressure, shape (elements,)."""
    found = np.zeros(dofs.body.mesh.nelements, dtype=bool)
    for region in dofs.body.regions:
        found[region.elements] = bool(region.form.surfaces)
    return found


def _sticking(dofs: BodyDofs, asked: NodeConditions, asking: Ints) -> tuple[Ints, Ints, Bools]:
    """Return the facets whose tangential velocity is held, by whom, and if the normal one is."""
    # One entry per facet and owner.
    keys = np.stack([asked.nodes, asking])
    (facets, owner), entry = np.unique(keys, axis=1, return_inverse=True)
    entry = entry.ravel()
    *_, normal = facet_geometry(dofs.body.mesh, facets)
    n, d = normal[:, entry], asked.directions.T
    across, along = np.sum(n * d, axis=0), n[0] * d[1] - n[1] * d[0]
    nn, nt, tt = (
        np.bincount(entry, values, minlength=facets.size)
        for values in (across**2, across * along, along**2)
    )
    both = nn * tt - nt**2 > _PARALLEL
    only = (tt > _PARALLEL) & (nn <= _PARALLEL)
    owners = np.bincount(facets[tt > _PARALLEL], minlength=dofs.body.mesh.nfacets)
    able = (both | only) & (owners[facets] == 1)
    return facets[able], owner[able], both[able]


def meetings(dofs: BodyDofs, facets: Ints, others: Ints) -> tuple[Bools, Bools]:
    """Return which ends of facets meet others in another direction, and in their own, (2, e)."""
    mesh = dofs.body.mesh
    *_, normal = facet_geometry(dofs.body.mesh, facets)
    *_, facing = facet_geometry(dofs.body.mesh, others)
    vertices, count = mesh.facets[:, others].ravel(), others.size
    touching = csr_matrix(
        (np.ones(2 * count), (vertices, np.tile(np.arange(count), 2))), (mesh.nvertices, count)
    )
    end, other = touching[mesh.facets[:, facets].ravel()].nonzero()
    n, m = normal[:, end % facets.size], facing[:, other]
    parallel = (n[0] * m[1] - n[1] * m[0]) ** 2 <= _PARALLEL
    turned, straight = (
        np.isin(np.arange(2 * facets.size), end[mask]).reshape(2, -1)
        for mask in (~parallel, parallel)
    )
    return turned, straight


def _parts(ends: Ints, owner: Ints) -> Ints:
    """Return the numbers of the connected parts with one owner, shape (e,), from ends (2, e)."""
    count = owner.size
    joints = np.stack([ends.ravel(), np.tile(owner, 2)])
    _, joint = np.unique(joints, axis=1, return_inverse=True)
    incidence = csr_matrix((np.ones(2 * count), (np.tile(np.arange(count), 2), joint.ravel())))
    return np.asarray(connected_components(incidence @ incidence.T, directed=False)[1])
