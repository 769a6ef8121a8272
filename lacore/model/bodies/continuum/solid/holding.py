"""Faces of tetrahedra held by supports and footings, and their free velocities (T90)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_diag, csr_matrix, eye_array, hstack, vstack

from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.boundaries import boundary_facets
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.solid.faces import face_geometry
from lacore.model.bodies.continuum.solid.held_nodes import flowing_between_nodes
from lacore.model.bodies.continuum.solid.normal_flow import flowing, nodes_of_faces
from lacore.model.conditions.elimination import NodeConditions
from lacore.model.conditions.footings import Footing
from lacore.model.conditions.loads import Fix
from lacore.numerics.arrays import Bools, Floats, Ints, Sparse
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact

_ALONG = 1e-9  # sine of directions along or across a face, up to the round-off of its corners


@dataclass(frozen=True, repr=False)
class HeldFaces(Compact):
    """Faces of a body that supports and footings hold, each by one of them.

    Attributes:
        facets: facets of its mesh, shape (e,).
        normal: outward unit normals, shape (3, e).
        footing: number of the footing that holds each, -1 for supports, shape (e,).
        motion: velocity of the footing, per speed of the footings, at the control values of the
            faces, shape (s, 3, e, copies); 0 for supports.
        holds_normal: whether it holds the normal velocity, shape (e,).
        along: orthonormal held directions in each face, 0 for none, shape (2, 3, e).
    """

    facets: Ints
    normal: Floats
    footing: Ints
    motion: Floats
    holds_normal: Bools
    along: Floats

    @property
    def sticking(self) -> Bools:
        """Faces held in some tangential direction, shape (e,)."""
        return np.asarray(np.any(self.along, axis=(0, 1)))

    @property
    def altogether(self) -> Bools:
        """Faces held in all directions, shape (e,)."""
        return np.asarray(self.holds_normal & np.any(self.along, axis=1).all(axis=0))

    @property
    def directions(self) -> Floats:
        """Orthonormal held directions of faces, 0 for none, shape (3, 3, e)."""
        return np.concatenate([self.along, [self.normal * self.holds_normal]])

    def kept(self, mask: Bools) -> "HeldFaces":
        """Return the faces of a mask of shape (e,)."""
        return HeldFaces(
            self.facets[mask],
            self.normal[:, mask],
            self.footing[mask],
            self.motion[:, :, mask],
            self.holds_normal[mask],
            self.along[:, :, mask],
        )


def face_conditions(
    body: Body, supports: Sequence[Fix], footings: Sequence[Footing], name: str
) -> NodeConditions:
    """Return the conditions of all supports of a body, on faces as nodes, directions (c, 3).

    They have no factors, which differ from place to place: see `RigidFooting.motion`.
    """
    parts = [_none()]
    for support in supports:
        if support.body == name:
            facets = boundary_facets(body.mesh, support.where, "Fix.where")
            _, outward = face_geometry(body.mesh, facets)
            for direction in _directions(support, outward.T):
                parts.append(_held(facets, direction))
    for number, footing in enumerate(footings):
        if footing.body == name:
            facets = boundary_facets(body.mesh, footing.where, "RigidFooting.where")
            _, outward = face_geometry(body.mesh, facets)
            for direction in footing.held(outward.T):
                parts.append(_held(facets, direction, number))
    return _joined(parts)


def slid_past(
    dofs: BodyDofs, supports: Sequence[Fix], footings: Sequence[Footing], name: str
) -> HeldFaces:
    """Return the faces of a body with discontinuous velocities that may slip past a support.

    In soil, which opens as it slips, only completely held faces slip; others stick.

    Raises:
        InputError: see `held_faces`.
    """
    conditions = face_conditions(dofs.body, supports, footings, name)
    held = held_faces(dofs, conditions, footings)
    return held if dofs.normal_flow else held.kept(held.altogether)


def held_faces(
    dofs: BodyDofs, conditions: NodeConditions, footings: Sequence[Footing]
) -> HeldFaces:
    """Return the faces that conditions hold, see `face_conditions`.

    Args:
        dofs: unknowns of the body.
        conditions: conditions on faces.
        footings: footings by their numbers in the conditions.

    Raises:
        InputError: a face held by two, or in a direction that is neither along nor across it.
    """
    facets, at = np.unique(conditions.nodes, return_inverse=True)
    owner = np.full(facets.size, -1)
    np.maximum.at(owner, at, conditions.footing)
    both = np.flatnonzero(conditions.footing != owner[at])
    if both.size:
        raise InputError(
            "RigidFooting",
            None,
            "a support, or another footing, holds a face under it",
            "end one where the other begins",
        )
    _, normal = face_geometry(dofs.body.mesh, facets)
    gram = np.zeros((facets.size, 3, 3))
    np.add.at(gram, at, conditions.directions[:, :, None] * conditions.directions[:, None, :])
    n = normal.T
    pressing = np.einsum("eij,ej->ei", gram, n)
    across = np.sum(pressing * n, axis=1)
    oblique = np.linalg.norm(pressing - across[:, None] * n, axis=1) > _ALONG
    if oblique.any():
        raise InputError(
            "Fix.components",
            None,
            "holds a face in a direction that is neither along nor across it: where velocities"
            " jump, normal ones are separate unknowns (T90)",
            "take 'normal', 'xyz', or the space 'p2-vertex'",
        )
    size, axes = np.linalg.eigh(gram - across[:, None, None] * n[:, :, None] * n[:, None, :])
    along = np.where(size[:, None, 1:] > _ALONG, axes[:, :, 1:], 0.0)  # the largest two of three
    places = face_places(dofs, facets)
    motion = np.zeros((len(_speeds(footings)), *places.shape))
    for row, (number, footing, speed) in enumerate(_speeds(footings)):
        mine = owner == number
        motion[row][:, mine] = footing.motion(places[:, mine], speed)
    return HeldFaces(facets, normal, owner, motion, across > _ALONG, along.transpose(2, 1, 0))


def face_places(dofs: BodyDofs, facets: Ints) -> Floats:
    """Return the coordinates of the nodes of faces, shape (3, e, nodes of a face), m.

    The control values of functions that are linear on a face are there, too.
    """
    return np.asarray(dofs.nodes[:, dofs.facet_nodes(facets)].transpose(0, 2, 1))


def solid_free_basis(
    bodies: Mapping[str, BodyDofs],
    supports: Sequence[Fix],
    footings: Sequence[Footing],
) -> tuple[Sparse, Bools]:
    """Return all velocities and speeds of footings from the free ones, and which nodes are held.

    Returns:
        Matrix of shape (3 nodes + footings, free), the speeds last; mask of shape (nodes,).

    Raises:
        InputError: a footing cannot move, or faces are held by two.
    """
    free, driven, touched = [], [], []
    for name, dofs in bodies.items():
        conditions = face_conditions(dofs.body, supports, footings, name)
        nodes = dofs.facet_nodes(conditions.nodes)
        if dofs.normal_flow:
            own = held_faces(dofs, conditions, footings)
            holds_normal = np.zeros(dofs.body.mesh.nfacets, dtype=bool)
            holds_normal[own.facets] = own.holds_normal
            carried = np.zeros((holds_normal.size, nodes_of_faces(dofs), len(own.motion)))
            # Normals point out of the first element, which is the only one at these faces.
            carried[own.facets] = np.einsum("xe,sxen->ens", own.normal, own.motion)
            parts = flowing(dofs, holds_normal, carried)
        else:
            stuck = np.ones(conditions.nodes.size, dtype=bool)
            if dofs.space.jumps:
                past = slid_past(dofs, supports, footings, name).facets
                stuck = ~np.isin(conditions.nodes, past)
            at = nodes[:, stuck].ravel()
            directions = np.tile(conditions.directions[stuck], (len(nodes), 1))
            owner = np.tile(conditions.footing[stuck], len(nodes))
            wanted = moved_along(directions, owner, dofs.nodes[:, at], footings)
            node_dofs = dofs.dofs - dofs.offset
            parts = flowing_between_nodes(at, directions, wanted, node_dofs, speed_names(footings))
        free.append(parts[0])
        driven.append(parts[1])
        touched.append(np.isin(np.arange(dofs.nodes.shape[1]), nodes))
    first = vstack([hstack([block_diag(free, format="csr"), vstack(driven)])])
    count = len(_speeds(footings))
    speeds = hstack([csr_matrix((count, first.shape[1] - count)), eye_array(count, format="csr")])
    return csr_matrix(vstack([first, speeds], format="csr")), np.concatenate(touched)


def moved_along(
    directions: Floats, owner: Ints, places: Floats, footings: Sequence[Footing]
) -> Floats:
    """Return the velocity along directions (c, 3) at places (3, c) per support speed, (c, s)."""
    own = _speeds(footings)
    wanted = np.zeros((owner.size, len(own)))
    for column, (number, footing, speed) in enumerate(own):
        mine = owner == number
        wanted[mine, column] = np.sum(
            directions[mine].T * footing.motion(places[:, mine], speed), axis=0
        )
    return wanted


def speed_names(footings: Sequence[Footing]) -> list[str]:
    """Return the name of the footing of each speed, for messages."""
    return [footing.name for _, footing, _ in _speeds(footings)]


def _speeds(footings: Sequence[Footing]) -> list[tuple[int, Footing, int]]:
    """Return, for each speed, the number of its footing, the footing, and the number within it."""
    return [
        (number, footing, speed)
        for number, footing in enumerate(footings)
        for speed in range(footing.speeds)
    ]


def _directions(support: Fix, outward: Floats) -> list[Floats]:
    """Return the directions that a support holds at faces with outward normals (e, 3)."""
    if support.components == "normal":
        return [outward]
    axes = ["xyz".index(letter) for letter in support.components]
    return [np.broadcast_to(np.eye(3)[axis], outward.shape) for axis in axes]


def _held(facets: Ints, directions: Floats, owner: int = -1) -> NodeConditions:
    return NodeConditions(facets, directions, np.full(facets.size, owner), np.zeros(facets.size))


def _none() -> NodeConditions:
    return _held(np.zeros(0, dtype=np.int64), np.zeros((0, 3)))


def _joined(parts: Sequence[NodeConditions]) -> NodeConditions:
    names = ("nodes", "directions", "footing", "factors")
    return NodeConditions(
        *(np.concatenate([getattr(part, name) for part in parts]) for name in names)
    )
