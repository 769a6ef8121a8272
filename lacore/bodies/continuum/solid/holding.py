"""What supports and footings hold of bodies of tetrahedra, and what they leave free (T90)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_diag, csr_matrix, eye_array, hstack, vstack

from lacore.arrays import Bools, Floats, Ints, Sparse
from lacore.bodies.continuum.body import Body
from lacore.bodies.continuum.boundaries import boundary_facets
from lacore.bodies.continuum.dofs import BodyDofs
from lacore.bodies.continuum.solid.faces import face_geometry
from lacore.bodies.continuum.solid.held_nodes import flowing_between_nodes
from lacore.bodies.continuum.solid.normal_flow import flowing, nodes_of_faces
from lacore.conditions.elimination import NodeConditions
from lacore.conditions.loads import Fix, RigidFooting
from lacore.errors import InputError
from lacore.showing import Compact

_ALONG = 1e-9  # sine: directions along or across a face, up to the round-off of its corners


@dataclass(frozen=True, repr=False)
class HeldFaces(Compact):
    """Faces of a body that supports and footings hold, each by one of them.

    Attributes:
        facets: of its mesh, shape (e,).
        normal: outward unit normals, shape (3, e).
        footing: number of the footing that holds each, -1 of supports, shape (e,).
        motion: velocity of what holds, per speed of the footing, at the control values of the
            faces, shape (3, e, copies); of supports 0.
        pressed: whether it holds the normal velocity, shape (e,).
        along: orthonormal directions in each face that it holds, 0 for none, shape (2, 3, e).
    """

    facets: Ints
    normal: Floats
    footing: Ints
    motion: Floats
    pressed: Bools
    along: Floats

    @property
    def sticking(self) -> Bools:
        """Faces along which something is held, shape (e,)."""
        return np.asarray(np.any(self.along, axis=(0, 1)))


def face_conditions(
    body: Body, supports: Sequence[Fix], footings: Sequence[RigidFooting], name: str
) -> NodeConditions:
    """Conditions of all that holds a body, on its faces in place of nodes, directions (c, 3).

    Without factors, which differ from place to place: see `RigidFooting.motion`.
    """
    parts = [_none()]
    for support in supports:
        if support.body == name:
            facets = boundary_facets(body, support.where, "Fix.where")
            _, outward = face_geometry(body.mesh, facets)
            for direction in _directions(support, outward.T):
                parts.append(_held(facets, direction))
    for number, footing in enumerate(footings):
        if footing.body == name:
            facets = boundary_facets(body, footing.where, "RigidFooting.where")
            _, outward = face_geometry(body.mesh, facets)
            for direction in footing.held(outward.T):
                parts.append(_held(facets, direction, number))
    return _joined(parts)


def held_faces(
    dofs: BodyDofs, asked: NodeConditions, footings: Sequence[RigidFooting]
) -> HeldFaces:
    """Faces that conditions hold, see `face_conditions`.

    Args:
        dofs: of the body.
        asked: on faces.
        footings: by whose numbers conditions are asked.

    Raises:
        InputError: a face held by two, or in a direction that is neither along nor across it.
    """
    facets, at = np.unique(asked.nodes, return_inverse=True)
    owner = np.full(facets.size, -1)
    np.maximum.at(owner, at, asked.footing)
    both = np.flatnonzero(asked.footing != owner[at])
    if both.size:
        raise InputError(
            "RigidFooting",
            None,
            "a support, or another footing, holds a face under it",
            "end one where the other begins",
        )
    _, normal = face_geometry(dofs.body.mesh, facets)
    gram = np.zeros((facets.size, 3, 3))
    np.add.at(gram, at, asked.directions[:, :, None] * asked.directions[:, None, :])
    n = normal.T
    pressing = np.einsum("eij,ej->ei", gram, n)
    across = np.sum(pressing * n, axis=1)
    oblique = np.linalg.norm(pressing - across[:, None] * n, axis=1) > _ALONG
    if oblique.any():
        raise InputError(
            "Fix.components",
            None,
            "holds a face in a direction that is neither along nor across it: where velocities"
            " jump in space, normal ones are unknowns of their own (T90)",
            "take 'normal', 'xyz', or the space 'p2-vertex'",
        )
    size, axes = np.linalg.eigh(gram - across[:, None, None] * n[:, :, None] * n[:, None, :])
    along = np.where(size[:, None, 1:] > _ALONG, axes[:, :, 1:], 0.0)  # the largest two of three
    places = face_places(dofs, facets)
    motion = np.zeros_like(places)
    for number, footing in enumerate(footings):
        mine = owner == number
        motion[:, mine] = footing.motion(places[:, mine])
    return HeldFaces(facets, normal, owner, motion, across > _ALONG, along.transpose(2, 1, 0))


def face_places(dofs: BodyDofs, facets: Ints) -> Floats:
    """Coordinates of the nodes of faces, shape (3, e, nodes of a face), m.

    What is linear on a face has its control values there, too.
    """
    return np.asarray(dofs.nodes[:, dofs.facet_nodes(facets)].transpose(0, 2, 1))


def solid_free_basis(
    bodies: Mapping[str, BodyDofs],
    supports: Sequence[Fix],
    footings: Sequence[RigidFooting],
) -> tuple[Sparse, Bools]:
    """All velocities of bodies and speeds of footings from the free ones, and which nodes are held.

    Returns:
        Matrix of shape (3 nodes + footings, free), the speeds last; mask of shape (nodes,).

    Raises:
        InputError: a footing that cannot move, faces held by two.
    """
    free, driven, touched = [], [], []
    for name, dofs in bodies.items():
        asked = face_conditions(dofs.body, supports, footings, name)
        nodes = dofs.facet_nodes(asked.nodes)
        if dofs.space.jumps:
            own = held_faces(dofs, asked, footings)
            pressed = np.zeros(dofs.body.mesh.nfacets, dtype=bool)
            pressed[own.facets] = own.pressed
            carried = np.zeros((pressed.size, nodes_of_faces(dofs), len(footings)))
            # Of normals as the mesh has them, out of the first element: of these faces the only.
            along = np.sum(own.normal[:, :, None] * own.motion, axis=0)
            for number in range(len(footings)):
                mine = own.footing == number
                carried[own.facets[mine], :, number] = along[mine]
            parts = flowing(dofs, pressed, carried)
        else:
            spread = _at_nodes(dofs, asked, nodes, footings)
            names = [footing.name for footing in footings]
            parts = flowing_between_nodes(spread, dofs.dofs - dofs.offset, names)
        free.append(parts[0])
        driven.append(parts[1])
        touched.append(np.isin(np.arange(dofs.nodes.shape[1]), nodes))
    first = vstack([hstack([block_diag(free, format="csr"), vstack(driven)])])
    count = len(footings)
    speeds = hstack([csr_matrix((count, first.shape[1] - count)), eye_array(count, format="csr")])
    return csr_matrix(vstack([first, speeds], format="csr")), np.concatenate(touched)


def _at_nodes(
    dofs: BodyDofs, asked: NodeConditions, nodes: Ints, footings: Sequence[RigidFooting]
) -> NodeConditions:
    """Conditions on faces as such on their nodes, shape (a, c), a node as often as it is asked."""
    at, copies = nodes.ravel(), len(nodes)
    directions, owner = np.tile(asked.directions, (copies, 1)), np.tile(asked.footing, copies)
    factors = np.zeros(at.size)
    for number, footing in enumerate(footings):
        mine = owner == number
        motion = footing.motion(dofs.nodes[:, at[mine]])
        factors[mine] = np.sum(directions[mine].T * motion, axis=0)
    return NodeConditions(at, directions, owner, factors)


def _directions(support: Fix, outward: Floats) -> list[Floats]:
    """Directions that a support holds at faces with outward normals of shape (e, 3)."""
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
