"""Joints of three-dimensional blocks: shared areas of two plane faces (T71)."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import shapely

from lacore.model.bodies.blocks3d.crushing import Cells, Crushing, cells, points_of
from lacore.model.bodies.blocks3d.faces import Faces, faces_of, facing, flat_polygons
from lacore.model.bodies.blocks3d.hulls import hull_corners
from lacore.model.bodies.blocks3d.polyhedron import Polyhedron
from lacore.model.bodies.blocks3d.surface import axes_of
from lacore.numerics.arrays import Floats, Geometries, Ints
from lacore.reporting.showing import Compact

_POLYGON = 3  # type number of shapely


@dataclass(frozen=True, eq=False, repr=False)
class Joints3D(Compact):
    """Areas that two faces share, and the contact points at their corners (T71, T72).

    For joints that crush, the contact points are the centroids of cells (T95). Joints are sorted by
    master, slave, and their faces. Two blocks may share several.

    Attributes:
        slave, master: block numbers, (J,); the master comes first in the assembly.
        slave_face, master_face: plane faces, numbered in their blocks, (J,).
        normal: unit normal from the master into the slave, (3, J).
        area: shared area, m^2, (J,); for a piece that is not convex it is less than that of its
            hull.
        points: contact points, (3, m), m: corners of the convex hulls of the joints, each joint's
            one after the other, counterclockwise about its normal.
        joint: number of the joint of each point, (m,).
        weight: area of the joint over its number of points, or that of the cell, (m,), m^2.
        cells: cells of joints that crush; else None.
    """

    slave: Ints
    master: Ints
    slave_face: Ints
    master_face: Ints
    normal: Floats
    area: Floats
    points: Floats
    joint: Ints
    weight: Floats
    cells: Cells | None = None

    @property
    def count(self) -> int:
        """Number of joints."""
        return self.slave.size

    @property
    def centroid(self) -> Floats:
        """Mean of the contact points of each joint, (3, J), m."""
        number = np.bincount(self.joint, minlength=self.count)
        return np.stack([np.bincount(self.joint, own, self.count) for own in self.points]) / number


def find_joints(
    polyhedra: Mapping[str, Polyhedron], tolerance: float, crushing: Crushing | None = None
) -> Joints3D:
    """Return the joints of blocks.

    Two faces form a joint if they lie in one plane, face each other, and overlap on more than a
    strip as wide as the tolerance. Results that do not depend on the order of the blocks are equal
    to the last digit for any order.

    Args:
        polyhedra: polyhedra by name.
        tolerance: m: largest gap or overlap of the two faces.
        crushing: law of joints with cells instead of corners.
    """
    faces = faces_of(list(polyhedra.values()))
    first, second = facing(faces, tolerance)
    normal = faces.normal[:, first] - faces.normal[:, second]  # from the first into the second
    normal /= np.linalg.norm(normal, axis=0)
    one, two = axes_of(normal)
    pair, shared = shared_pieces(faces, first, second, one, two, tolerance)
    area = np.asarray(shapely.area(shared))
    flat, joint = hull_corners(shared, tolerance)

    def placed(flat: Floats, joint: Ints) -> tuple[Floats, Floats]:
        own = pair[joint]
        axes = normal[:, own], one[:, own], two[:, own]
        low, gap = gaps(faces, first[own], second[own], axes, flat)
        points = axes[0] * (low + gap / 2) + axes[1] * flat[0] + axes[2] * flat[1]
        return points + faces.origin[:, None], gap

    points, gap = placed(flat, joint)
    apart = np.zeros(pair.size)
    np.maximum.at(apart, joint, np.abs(gap))
    joints, label = _sorted(
        faces,
        np.where(apart <= tolerance)[0],
        first[pair],
        second[pair],
        normal[:, pair],
        area,
        points,
        joint,
    )
    if crushing is None:
        return joints
    own = crushing.cells
    if own is None:
        rims, piece = cells(shared, crushing.divisions, tolerance)
        corners, _ = placed(rims.reshape(2, -1), np.repeat(piece, 4))
        order = np.argsort(label[piece], kind="stable")
        order = order[label[piece][order] >= 0]
        corners = corners.reshape(3, -1, 4)[:, order].reshape(3, -1)
        own = Cells(corners, np.repeat(np.arange(order.size), 4), label[piece][order])
    points, joint, weight = points_of(own, crushing.side)
    return replace(joints, points=points, joint=joint, weight=weight, cells=own)


def shared_pieces(
    faces: Faces, first: Ints, second: Ints, one: Floats, two: Floats, width: float
) -> tuple[Ints, Geometries]:
    """Return the polygons in which faces overlap along the normal, wider than `width` (m).

    Returns:
        the number of its pair, (k,), and each polygon, (k,), in the axes of its pair.
    """
    common = shapely.intersection(
        flat_polygons(faces, first, one, two), flat_polygons(faces, second, one, two)
    )
    shared, pair = shapely.get_parts(common, return_index=True)
    wide = shapely.get_type_id(shared) == _POLYGON
    wide &= 2 * shapely.area(shared) > width * shapely.length(shared)
    return pair[wide], shared[wide]


def gaps(
    faces: Faces, first: Ints, second: Ints, axes: tuple[Floats, Floats, Floats], flat: Floats
) -> tuple[Floats, Floats]:
    """Return the height of the first face, and the gap to the second, along normals, m, (k,).

    Args:
        faces: faces of all blocks.
        first, second: numbers of the pairs, (k,).
        axes: normal, and the two axes of the plane of the places, (3, k) each.
        flat: the places, (2, k), m.
    """
    low, high = (_height(faces, which, *axes, flat) for which in (first, second))
    return low, high - low


def _height(
    faces: Faces, which: Ints, normal: Floats, one: Floats, two: Floats, flat: Floats
) -> Floats:
    """Return where lines along `normal` meet the planes of faces, m, (m,)."""
    own = faces.normal[:, which]
    across = np.sum(own * (one * flat[0] + two * flat[1]), axis=0)
    return np.asarray((faces.offset[which] - across) / np.sum(own * normal, axis=0))


def _sorted(
    faces: Faces,
    kept: Ints,
    first: Ints,
    second: Ints,
    normal: Floats,
    area: Floats,
    points: Floats,
    joint: Ints,
) -> tuple[Joints3D, Ints]:
    """Return the joints to keep, sorted by the numbers of their blocks, masters before slaves.

    The second value is the new number of each given joint, -1 if it is not kept.
    """
    turned = faces.block[first] > faces.block[second]
    slave, master = np.where(turned, first, second), np.where(turned, second, first)
    number = np.bincount(joint, minlength=first.size)
    middle = np.stack([np.bincount(joint, own, first.size) for own in points]) / number
    blocks = faces.block[slave], faces.block[master]
    keys = np.stack([*middle[::-1], slave, master, *blocks])[:, kept]
    order = kept[np.lexsort(keys)]
    label = np.full(first.size, -1)
    label[order] = np.arange(order.size)
    place = np.flatnonzero(label[joint] >= 0)
    # From the other side, counterclockwise corners are clockwise.
    inside = np.where(turned[joint[place]], -place, place)
    place = place[np.lexsort((inside, label[joint[place]]))]
    joint = label[joint[place]]
    begin = np.append(0, np.cumsum(np.bincount(faces.block)))[:-1]
    joints = Joints3D(
        faces.block[slave[order]],
        faces.block[master[order]],
        slave[order] - begin[faces.block[slave[order]]],
        master[order] - begin[faces.block[master[order]]],
        np.where(turned, -1.0, 1.0)[order] * normal[:, order],
        area[order],
        points[:, place],
        joint,
        (area[order] / number[order])[joint],
    )
    return joints, label
