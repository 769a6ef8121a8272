"""Contact patches of three-dimensional blocks: plane polygons, without unknowns (T71).

No tension crosses a patch, so pressures on it have the same resultants as those at the corners of
its convex hull: these are its contact points, each with the same share of its area.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from lacore.model.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.model.bodies.blocks3d.faces import flat_polygons
from lacore.model.bodies.blocks3d.hulls import hull_corners
from lacore.model.bodies.blocks3d.joints import Joints3D, find_joints
from lacore.model.bodies.blocks3d.surface import axes_of
from lacore.model.conditions.where import where_name
from lacore.model.contact.interfaces import Interface
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting import terms
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact
from lacore.reporting.text import Quantity, text


@dataclass(frozen=True, eq=False, repr=False)
class Patches(Compact):
    """Contact patches of faces of blocks with each other, or with an obstacle.

    Attributes:
        slave, master: numbers of faces, (k,); an obstacle has the face -1; joints within an
            assembly only have blocks, and -1 on both sides.
        normal: unit vectors from the master into the slave, (3, k).
        point: contact points, (3, m), m.
        patch: number of the patch of each point, (m,).
        weight: area of each point, (m,), m^2.
    """

    slave: Ints
    master: Ints
    normal: Floats
    point: Floats
    patch: Ints
    weight: Floats

    @property
    def edges(self) -> tuple[Ints, Ints]:
        """Faces of slave and master, as `Interface.sides`."""
        return self.slave, self.master


def of_joints(joints: Joints3D) -> Patches:
    """Return the patches of joints within an assembly, which have blocks but no faces of bodies."""
    nothing = np.full(joints.count, -1)
    return Patches(nothing, nothing, joints.normal, joints.points, joints.joint, joints.weight)


def interface_patches(
    interface: Interface, bodies: Mapping[str, BlockAssembly3D], field: str
) -> Patches:
    """Return the patches of a three-dimensional interface.

    Raises:
        InputError: the two sides do not touch.
    """
    (name, where), *second = interface.sides
    slave = bodies[name]
    faces = slave.outline(where, f"{field}.slave")
    if not second:
        _check_obstacle(slave, faces, interface, field)
        return _whole(slave, faces)
    master = bodies[second[0][0]]
    facing = master.outline(second[0][1], f"{field}.master")
    patches = _shared(slave, faces, master, facing)
    if not patches.slave.size:
        raise InputError(
            field,
            interface.name,
            f"does not touch {second[0][0]}.{where_name(second[0][1])}",
            "give two boundaries that lie on each other",
        )
    return patches


def _whole(body: BlockAssembly3D, faces: Ints) -> Patches:
    """Return whole faces against an obstacle: the convex hull of each."""
    own = body.faces
    normal = own.normal[:, faces]
    one, two = axes_of(normal)
    polygons = flat_polygons(own, faces, one, two)
    flat, patch = hull_corners(polygons, body.allowed)
    heights = (own.offset[faces] * normal)[:, patch]
    point = one[:, patch] * flat[0] + two[:, patch] * flat[1] + heights + own.origin[:, None]
    weight = own.area[faces] / np.bincount(patch, minlength=faces.size)
    return Patches(faces, np.full(faces.size, -1), -normal, point, patch, weight[patch])


def _shared(slave: BlockAssembly3D, faces: Ints, master: BlockAssembly3D, facing: Ints) -> Patches:
    """Return the shared areas of faces of two assemblies, as joints of one assembly."""
    sides = ((master, facing), (slave, faces))
    blocks = [np.unique(body.blocks_of(own)) for body, own in sides]
    polyhedra = {
        f"{side}|{number}": body.polyhedra[body.names[number]]
        for side, ((body, _), numbers) in enumerate(zip(sides, blocks, strict=True))
        for number in numbers.tolist()
    }
    joints = find_joints(polyhedra, max(slave.allowed, master.allowed))
    count = blocks[0].size
    across = np.flatnonzero((joints.master < count) & (joints.slave >= count))
    mine = _numbers(slave, blocks[1][joints.slave[across] - count], joints.slave_face[across])
    its = _numbers(master, blocks[0][joints.master[across]], joints.master_face[across])
    asked = np.isin(mine, faces) & np.isin(its, facing)
    kept = across[asked]
    number = np.full(joints.count, -1)
    number[kept] = np.arange(kept.size)
    corner = np.flatnonzero(number[joints.joint] >= 0)
    return Patches(
        mine[asked],
        its[asked],
        joints.normal[:, kept],
        joints.points[:, corner],
        number[joints.joint[corner]],
        joints.weight[corner],
    )


def _numbers(body: BlockAssembly3D, blocks: Ints, faces: Ints) -> Ints:
    """Return the numbers among all faces of an assembly, from those in their blocks."""
    return np.asarray(np.searchsorted(body.faces.block, blocks) + faces)


def _check_obstacle(body: BlockAssembly3D, faces: Ints, interface: Interface, field: str) -> None:
    """Check that faces lie on the plane of their obstacle, which is on their outer side."""
    plane = interface.face
    if plane is None:
        return
    corners, face = body.corners_of(faces)
    gap = plane.distance(corners)
    worst = int(np.argmax(np.abs(gap)))
    if abs(gap[worst]) > body.allowed:
        block = body.names[body.faces.block[face[worst]]]
        raise InputError(
            field,
            interface.name,
            text(
                "does not touch its obstacle: the corner of {} at {} lies {} {} it",
                repr(block),
                Quantity(tuple(corners[:, worst]), "m", ".6g"),
                Quantity(abs(gap[worst]), "m", ".3g"),
                "above" if gap[worst] > 0 else "inside",
            ),
            text(
                "move the block or {} so that the two coincide, or select the faces that touch it",
                terms.POINT_OF_PLANE,
            ),
        )
    normal = plane.normal(body.face_centroid[:, faces])
    if np.any(np.sum(normal * body.faces.normal[:, faces], axis=0) > 0):
        raise InputError(
            f"{field}.master.normal",
            tuple(normal[:, 0].tolist()),
            "the obstacle's normal points out of the body",
            "give the normal from the obstacle into the body",
        )
