"""Bonded interfaces: boundaries that move together, up to the strength of the weaker side.

Where the edges of two continua match, and velocities are continuous on both sides, their nodes move
together: a body that is cut in two, and bonded, is the uncut one. Elsewhere velocities may jump, at
the cost of a layer of the weaker side: see `lacore.assembly.seams`. A rigid obstacle holds a bonded
body like a support. Two rigid sides have no strength at which a bond could break, and move
together.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_diag, csr_matrix, vstack
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import lsqr

from lacore.model.bodies.any_body import Dofs, RigidParts
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.conditions.loads import Fix
from lacore.model.contact.interfaces import Interface
from lacore.model.contact.segments import Segments
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Bools, Floats, Ints, Sparse
from lacore.numerics.null_space import null_space_by_parts


@dataclass(frozen=True)
class Ties:
    """Nodes of continua that move together.

    Attributes:
        first: the first node that each one moves with, usually itself, shape (nodes,).
        tied: which segments of each interface tie them, by its number.
    """

    first: Ints
    tied: Mapping[int, Bools]

    @property
    def following(self) -> Ints:
        """Nodes that move with one before them, ascending."""
        return np.flatnonzero(self.first != np.arange(self.first.size))

    @property
    def both_axes(self) -> Floats:
        """Directions that hold all that follows, shape (2, following, 2)."""
        return np.repeat(np.eye(2)[:, None], self.following.size, axis=1)

    def all_of(self, nodes: Bools) -> Bools:
        """Return a mask of nodes with all nodes that move with them, shape (nodes,)."""
        return np.isin(self.first, self.first[nodes])

    def spread(self, basis: Sparse, node_dofs: Ints) -> Sparse:
        """Return a basis in which tied nodes, without rows, move with the first ones."""
        row, own = np.arange(basis.shape[0]), self.following
        row[node_dofs[:, own]] = node_dofs[:, self.first[own]]
        return csr_matrix(basis[row]) if own.size else basis


def ties(problem: Problem, bodies: Mapping[str, BodyDofs]) -> Ties:
    """Return which nodes of the continua the bonds of a problem tie."""
    count = sum(own.nodes.shape[1] for own in bodies.values())
    pairs, tied = [np.zeros((2, 0), dtype=np.int64)], {}
    for index, interface, segments in problem.bonds:
        names = [name for name, _ in interface.sides]
        if len(names) < 2 or not all(name in bodies for name in names):
            continue
        one, other = (bodies[name] for name in names)
        same, turned = matching(one, other, segments)
        tied[index] = same & (one.degree == other.degree)
        tied[index] &= not (one.space.jumps or other.space.jumps)
        mine, its = (
            own.facet_nodes(edges[tied[index]]) + own.first_node
            for own, edges in zip((one, other), segments.edges, strict=True)
        )
        its = np.where(turned[tied[index]], its[::-1], its)
        pairs.append(np.stack([mine.ravel(), its.ravel()]))
    one, other = np.concatenate(pairs, axis=1)
    graph = csr_matrix((np.ones(one.size), (one, other)), shape=(count, count))
    _, group = connected_components(graph, directed=False)
    _, leader = np.unique(group, return_index=True)
    return Ties(np.asarray(leader[group], dtype=np.int64), tied)


def matching(one: BodyDofs, other: BodyDofs, segments: Segments) -> tuple[Bools, Bools]:
    """Return which segments are a whole edge of both sides, and which of them are reversed."""
    near = max(one.body.allowed, other.body.allowed)

    def ends(dofs: BodyDofs, edges: Ints) -> Floats:
        mesh = dofs.body.mesh
        return np.asarray(mesh.p[:, mesh.facets[:, edges]])  # shape (2, ends, segments)

    a, b = ends(one, segments.slave), ends(other, segments.master)
    straight, turned = (
        np.all(np.linalg.norm(a - facing, axis=0) <= near, axis=0) for facing in (b, b[:, ::-1])
    )
    return straight | turned, np.asarray(turned)


def supports_of(problem: Problem) -> Sequence[Fix]:
    """Return the supports of a problem, including obstacles to which bodies are bonded."""
    return (*problem.supports, *(Fix(*one.slave, "xy") for one in _held(problem)))


def _held(problem: Problem) -> list[Interface]:
    return [one for one in problem.interfaces if one.bonded and one.obstacle is not None]


def rigid_basis(problem: Problem, rigid: Mapping[str, RigidParts], n: int) -> Sparse:
    """Return a basis of rigid bodies with supports and bonds, (m, free).

    The m unknowns of rigid bodies are the last ones of n.
    """
    basis = _supported(problem, rigid)
    rows = rigid_bonds(problem, rigid, n)[:, n - basis.shape[0] :]
    return csr_matrix(basis @ null_space_by_parts(rows @ basis)) if rows.shape[0] else basis


def _supported(problem: Problem, rigid: Mapping[str, RigidParts]) -> Sparse:
    """Return a basis of the m unknowns of rigid bodies with supports, (m, free)."""
    supports = supports_of(problem)
    own = [
        part.free([support for support in supports if support.body == name])
        for name, part in rigid.items()
    ]
    return csr_matrix(block_diag(own, format="csr")) if own else csr_matrix((0, 0))


def rigid_bonds(problem: Problem, rigid: Mapping[str, RigidParts], n: int) -> Sparse:
    """Return the rows of n unknowns that bonds between rigid bodies make zero, shape (k, n)."""
    found = [csr_matrix((0, n))]
    for _, interface, segments in problem.bonds:
        names = [name for name, _ in interface.sides]
        if len(names) == 2 and all(name in rigid for name in names):
            for places in (segments.start, segments.end):
                one, other = (
                    rigid[name].velocity_rows(rigid[name].parts(edges), places, n)
                    for name, edges in zip(names, segments.edges, strict=True)
                )
                found += [csr_matrix(a - b) for a, b in zip(one, other, strict=True)]
    return csr_matrix(vstack(found, format="csr"))


def without_bonds(problem: Problem, rigid: Mapping[str, RigidParts], force: Floats) -> Floats:
    """Return the forces of supports and bonds minus those of bonds between rigid bodies, (n,).

    Where supports make bonds redundant, the smallest possible forces of bonds are used.
    """
    rows = rigid_bonds(problem, rigid, force.size)
    if not rows.shape[0]:
        return force
    basis = _supported(problem, rigid)
    first = force.size - basis.shape[0]
    freed = csr_matrix(rows[:, first:] @ basis)
    multiplier = lsqr(freed.T, basis.T @ force[first:], atol=0.0, btol=0.0)[0]
    return np.asarray(force - rows.T @ multiplier)


def joined_parts(parts: Ints, problem: Problem, dofs: Mapping[str, Dofs]) -> Ints:
    """Return the parts of unknowns, shape (n,), with bodies that move together as one part.

    Args:
        parts: parts without bonds.
        problem: problem with the bonds.
        dofs: unknowns of all bodies.
    """
    pairs = [np.zeros((2, 0), dtype=np.int64)]
    for _, interface, segments in problem.bonds:
        if interface.obstacle is None:
            meeting = zip(interface.sides, segments.edges, strict=True)
            pairs.append(
                np.stack([parts[_unknowns(dofs[own], edges)] for (own, _), edges in meeting])
            )
    together = np.array([parts[dofs[name].offset] for name in problem.driven], dtype=np.int64)
    pairs.append(np.stack([together[:-1], together[1:]]))
    one, other = np.concatenate(pairs, axis=1)
    count = int(parts.max(initial=-1)) + 1
    graph = csr_matrix((np.ones(one.size), (one, other)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1][parts], dtype=np.int64)


def _unknowns(dofs: Dofs, edges: Ints) -> Ints:
    """Return an unknown of the piece that each edge belongs to; a continuum is one piece."""
    pieces = dofs.pieces_of_unknowns
    piece = np.minimum(dofs.parts(edges), pieces.max())
    return np.asarray(dofs.offset + np.searchsorted(pieces, piece))
