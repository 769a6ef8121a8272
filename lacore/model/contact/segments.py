"""Segments along which the two sides of an interface touch: geometry without unknowns."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from lacore.model.bodies.any_body import PlaneBody
from lacore.model.bodies.blocks.corners import loose_corners
from lacore.model.bodies.blocks.joints import Joints
from lacore.model.bodies.touching import Edges, near_misses, touching
from lacore.model.conditions.where import where_name
from lacore.model.contact.interfaces import Interface
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting import terms
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact
from lacore.reporting.text import Quantity, text

_SAME_FACE = 1 - 1e-9  # cosine between the normals of faces on one line


@dataclass(frozen=True, repr=False)
class Segments(Compact):
    """Straight parts along which one edge of the slave touches one of the master.

    Attributes:
        slave, master: facets of a continuum, outline edges of an assembly, or nodes of a frame,
            shape (k,); an obstacle has the edges -1.
        start, end: shape (2, k).
        normal: unit vectors from the master into the slave, shape (2, k).
    """

    slave: Ints
    master: Ints
    start: Floats
    end: Floats
    normal: Floats

    @property
    def edges(self) -> tuple[Ints, Ints]:
        """Edges of slave and master, as `Interface.sides`."""
        return self.slave, self.master


def of_joints(joints: Joints) -> Segments:
    """Return the segments of joints within an assembly, which have blocks but no edges."""
    nothing = np.full(joints.count, -1)
    return Segments(nothing, nothing, joints.start, joints.end, joints.normal)


def interface_segments(
    interface: Interface, bodies: Mapping[str, PlaneBody], field: str
) -> Segments:
    """Return the segments of an interface; those at nodes of a frame are points.

    Raises:
        InputError: the two sides do not touch, touch up to a small gap, or somewhere only with a
            corner; a node at a corner, or against an obstacle without a normal.
    """
    (name, where), *second = interface.sides
    slave = bodies[name]
    numbers, edges = slave.boundary(where, f"{field}.slave")
    if not second:
        _check_obstacle(slave, numbers, edges, interface, field)
        nothing = np.full(numbers.size, -1)
        normal = -edges.normal
        if slave.pointwise:
            normal = _obstacle_normals(interface, edges.start, field)
        return Segments(numbers, nothing, edges.start, edges.end, normal)
    master = bodies[second[0][0]]
    others, facing = master.boundary(second[0][1], f"{field}.master")
    allowed = max(slave.allowed, master.allowed)
    if slave.pointwise and master.pointwise:
        raise InputError(
            field,
            interface.name,
            "nodes of two frames: there is no face whose normal they could slide across",
            "join the frames, or let one of them stand on a body",
        )
    if slave.pointwise:
        face, normal = _faces(edges.start, facing, allowed, interface, field)
        return Segments(numbers, others[face], edges.start, edges.end, normal)
    if master.pointwise:
        face, normal = _faces(facing.start, edges, allowed, interface, field)
        return Segments(numbers[face], others, facing.start, facing.end, -normal)
    shared = touching(edges, facing, allowed)
    for gap in near_misses(edges, facing, allowed).gap[:1]:
        raise InputError(
            field,
            interface.name,
            text("its two sides are {} apart", Quantity(gap, "m", ".3g")),
            "move one body so that they touch",
        )
    if not shared.first.size:
        raise InputError(
            field,
            interface.name,
            f"does not touch {second[0][0]}.{where_name(second[0][1])}",
            "give two boundaries that lie on each other",
        )
    corners = loose_corners(edges, facing, shared, allowed)
    if corners.size:
        raise InputError(
            field,
            interface.name,
            f"its two sides touch with a corner only at {corners[:, 0]} (such places:"
            f" {corners.shape[1]}), where contact has no normal or no length",
            "cut the corner off, so that edges touch there, or leave the edge out of the interface",
        )
    segments = Segments(
        slave=numbers[shared.first],
        master=others[shared.second],
        start=shared.start,
        end=shared.end,
        normal=-edges.normal[:, shared.first],
    )
    _check_curves(slave, master, segments, allowed, interface, field)
    return segments


def _check_curves(
    slave: PlaneBody,
    master: PlaneBody,
    segments: Segments,
    allowed: float,
    interface: Interface,
    field: str,
) -> None:
    """Check that edges whose chords touch also touch in the middle."""
    middle = (segments.start + segments.end) / 2
    places = []
    for body, edges in ((slave, segments.slave), (master, segments.master)):
        curves = body.curves(edges)
        places.append(curves.at(curves.parameter(middle)))
    gap = np.linalg.norm(places[0] - places[1], axis=0)
    for worst in np.flatnonzero(gap > allowed)[:1]:
        raise InputError(
            field,
            interface.name,
            text(
                "its two sides are curved, and {} apart at {}",
                Quantity(gap[worst], "m", ".3g"),
                Quantity(tuple(middle[:, worst]), "m", ".6g"),
            ),
            "give both the same vertices and midside nodes there, or straight edges",
        )


def _check_obstacle(
    body: PlaneBody, numbers: Ints, edges: Edges, interface: Interface, field: str
) -> None:
    face = interface.face
    if face is None:
        return
    places = [edges.start, edges.end]
    places.append(body.curves(numbers).middle)
    gap = np.concatenate([face.distance(x) for x in places])
    worst = gap[np.argmax(np.abs(gap))]
    if abs(worst) > body.allowed:
        raise InputError(
            field,
            interface.name,
            text(
                "does not touch its obstacle: a node lies {} {} it",
                Quantity(abs(worst), "m", ".3g"),
                "above" if worst > 0 else "inside",
            ),
            text("move the body or {} so that the two coincide", terms.POINT_OF_PLANE),
        )
    normal = face.normal((edges.start + edges.end) / 2)
    outward = np.flatnonzero(np.sum(normal * edges.normal, axis=0) > 0)
    if outward.size:
        raise InputError(
            f"{field}.master.normal",
            tuple(normal[:, outward[0]].tolist()),
            "the obstacle's normal points out of the body",
            "give the normal from the obstacle into the body",
        )


def _obstacle_normals(interface: Interface, places: Floats, field: str) -> Floats:
    """Return the unit normals of the obstacle at nodes, shape (2, k)."""
    face = interface.face
    if face is None:
        raise InputError(
            field,
            interface.name,
            "a node of a frame has no shape that an obstacle could follow",
            text("give {}", terms.PLANE),
        )
    return face.normal(places)


def _faces(
    nodes: Floats, faces: Edges, allowed: float, interface: Interface, field: str
) -> tuple[Ints, Floats]:
    """Return the face that each node, (2, k), lies on: numbers (k,) and outward normals (2, k)."""
    along = faces.end - faces.start
    length = np.linalg.norm(along, axis=0)
    away = nodes[:, :, None] - faces.start[:, None, :]  # shape (2, nodes, faces)
    share = np.clip(np.sum(away * along[:, None, :], axis=0) / length**2, 0.0, 1.0)
    gap = np.linalg.norm(away - share * along[:, None, :], axis=0)
    face = np.argmin(gap, axis=1)
    normal = faces.normal[:, face]
    least = gap[np.arange(face.size), face]
    for node in np.flatnonzero(least > allowed)[:1]:
        raise InputError(
            field,
            interface.name,
            text(
                "its node at {} is {} from the other side",
                Quantity(tuple(nodes[:, node]), "m", ".6g"),
                Quantity(least[node], "m", ".3g"),
            ),
            "move one body so that they touch",
        )
    cosine = np.einsum("ik,ij->kj", normal, faces.normal)
    for node in np.flatnonzero(((gap <= allowed) & (cosine < _SAME_FACE)).any(axis=1))[:1]:
        raise InputError(
            field,
            interface.name,
            f"its node at {nodes[:, node]} stands on a corner, which has no normal",
            "select the face that carries it, or move it off the corner",
        )
    return face, normal
