"""Assemblies of plane rigid blocks: polygons, the joints between them, and their friction."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import ClassVar

import numpy as np
import shapely
from numpy.typing import ArrayLike

from lacore.model.bodies.blocks.checks import check_contact, check_resting_corners
from lacore.model.bodies.blocks.joints import JointFriction, Joints, find_joints, joint_law
from lacore.model.bodies.blocks.loads import carried
from lacore.model.bodies.blocks.meeting_corners import Meetings, meetings
from lacore.model.bodies.blocks.polygons import (
    BlockEdges,
    Polygons,
    counterclockwise,
    outline_edges,
    read_polygons,
    require_apart,
    require_no_slits,
)
from lacore.model.bodies.blocks.rigid_blocks import RigidBlocks, require_resolved
from lacore.model.bodies.touching import Edges, Touched
from lacore.model.conditions.loads import Fix, Load
from lacore.model.conditions.where import Where, edges_inside
from lacore.model.materials.friction import Friction
from lacore.model.meshes.curved import EdgeCurves
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting.errors import InputError, require_positive
from lacore.reporting.text import Quantity, text

_TOLERANCE = 1e-6  # by the mean block size
_GAP = 1e-3  # by the shortest edge; a tenth of the gaps at which blocks nearly touch
_SLIVER = 1e-6  # by the size of its block; shorter edges are ignored


@dataclass(frozen=True, eq=False, repr=False)
class BlockAssembly(RigidBlocks):
    """Rigid blocks and the joints between them.

    A joint is a segment that two outlines share: two edges face each other, overlap along more than
    `tolerance`, and are at most `tolerance` apart. The ends of the segment are its contact points.
    Corners that touch an edge or a corner make no joint. `Problem` rejects corners that rest inside
    an edge, and corners that meet where no joints keep their blocks apart.

    Attributes:
        blocks: Polygons by name, with vertices (k, 2) in m in either sense, convex or not. Those of
            a sequence are named "0", "1", ... They are stored counterclockwise.
        friction: Law of all joints: a Coulomb coefficient, `Coulomb`, `Tresca`, `SMOOTH`, `STICK`.
        joint_friction: Other laws for single pairs ``(name, name)``, in either order.
        tolerance: Distance up to which outlines touch, m. The default is 1e-6 of the mean block
            size (root of the area), or 1e-3 of the shortest edge if that is less.
        names: Names of the blocks, (B,).
        area: Areas of the blocks, (B,), m^2.
        centroid: Centroids of the blocks, (2, B), m.
        radius: Largest distance of a vertex from the centroid, (B,), m, which scales rates of
            rotation to velocities.
        size: Diagonal of the bounding box, m.
        edges: Edges of all outlines, with block numbers.
        joints: See `Joints`; the master is the block that comes first.
        joint_terms: Coefficient, limit, dilatancy and tension of the laws of joints, (4, J).
        meetings: Corners that meet where joints alone do not keep them apart, see `Meetings`.

    Raises:
        InputError: There is no block; a polygon has fewer than 3 vertices, coordinates that are not
            finite, no area, or crosses itself; blocks overlap deeper than `tolerance`, or nearly
            touch (a gap above `tolerance` and below 1 % of the shorter edge); friction is negative
            or NaN; a pair of `joint_friction` is given twice, is unknown, or shares no joint. The
            message names the blocks.

    Example:
        >>> outlines = {
        ...     "base": la.masonry.rectangle(left=0, right=2, bottom=-1, top=0),
        ...     "stone": [(0, 0), (2, 0), (1, 2)],
        ... }
        >>> la.BlockAssembly(outlines, friction=0.6).names
        ('base', 'stone')
    """

    blocks: Polygons
    friction: float | Friction
    joint_friction: JointFriction | None = None
    tolerance: float | None = None
    dimension: ClassVar[int] = 2
    facet: ClassVar[str] = "edge"
    rim: ClassVar[str] = "a corner"
    names: tuple[str, ...] = field(init=False, repr=False)
    area: Floats = field(init=False, repr=False)
    centroid: Floats = field(init=False, repr=False)
    radius: Floats = field(init=False, repr=False)
    size: float = field(init=False, repr=False)
    edges: BlockEdges = field(init=False, repr=False)
    joints: Joints = field(init=False, repr=False)
    joint_terms: Floats = field(init=False, repr=False)
    meetings: Meetings = field(init=False, repr=False)

    def __post_init__(self) -> None:
        outlines = read_polygons(self.blocks, "BlockAssembly.blocks")
        polygons = counterclockwise(outlines, "BlockAssembly.blocks")
        names = tuple(outlines)
        points, block = shapely.get_coordinates(polygons, return_index=True)
        area = np.asarray(shapely.area(polygons))
        tolerance = _length_tolerance(self.tolerance, points, block, area)
        require_apart(names, polygons, tolerance, "BlockAssembly.blocks")
        edges = outline_edges(polygons, tolerance)
        require_no_slits(names, polygons, edges, tolerance, "BlockAssembly.blocks")
        friction = joint_law(self.friction, "BlockAssembly.friction")
        laws = {} if self.joint_friction is None else self.joint_friction
        joints = find_joints(
            names, edges, friction, laws, tolerance, "BlockAssembly.joint_friction"
        )
        centroid = shapely.get_coordinates(shapely.centroid(polygons)).T
        radius = np.zeros(area.size)
        np.maximum.at(radius, block, np.linalg.norm(points.T - centroid[:, block], axis=0))
        ends = np.flatnonzero(np.diff(block)) + 1
        rings = (ring[:-1] for ring in np.split(points, ends))  # The last one closes the ring.
        computed = {
            "blocks": MappingProxyType(dict(zip(names, rings, strict=True))),
            "friction": friction,
            "joint_friction": MappingProxyType(dict(laws)),
            "tolerance": tolerance,
            "names": names,
            "area": area,
            "centroid": centroid,
            "radius": radius,
            "size": float(np.linalg.norm(np.ptp(points, axis=0))),
            "edges": edges,
            "joints": joints,
            "joint_terms": np.stack(
                [joints.coefficient, joints.limit, joints.dilatancy, joints.tension]
            ),
            "meetings": meetings(edges, joints, tolerance),
        }
        for name, value in computed.items():
            object.__setattr__(self, name, value)

    @property
    def box(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner of the bounding box of all, m, shape (2,) each."""
        return self.edges.start.min(axis=1), self.edges.start.max(axis=1)

    @property
    def polygons(self) -> Mapping[str, Floats]:
        """Vertices (k, 2) by name, counterclockwise."""
        assert isinstance(self.blocks, Mapping)  # set in the constructor
        return self.blocks  # type: ignore[return-value]

    @property
    def jointed_facets(self) -> Ints:
        """Numbers of the edges that have a joint."""
        return np.union1d(self.joints.slave_edge, self.joints.master_edge)

    @property
    def measure(self) -> Floats:
        """Areas, (B,), m^2."""
        return self.area

    @property
    def facet_blocks(self) -> Ints:
        """The block of each edge."""
        return self.edges.block

    def rims(self, edges: Ints) -> tuple[Floats, Floats, Ints]:
        """Return the ends of edges, (2, k), m, normals there, (2, k), and blocks, (k,)."""
        every, twice = self.edges, np.tile(edges, 2)
        places = np.concatenate([every.start[:, edges], every.end[:, edges]], axis=1)
        return places, every.normal[:, twice], every.block[twice]

    def geometry_of(self, edges: Ints) -> tuple[Floats, Floats, Floats]:
        """Return the middles of edges and normals, (2, k) each, and lengths, (k,), m."""
        start, end = self.edges.start[:, edges], self.edges.end[:, edges]
        length = np.linalg.norm(end - start, axis=0)
        return (start + end) / 2, self.edges.normal[:, edges], np.asarray(length)

    def simplices(self, blocks: Ints) -> tuple[Floats, Floats, Ints]:
        """Return the triangles of blocks.

        Returns:
            corners (2, 3, t), m, areas (t,), m^2, and the block of each.
        """
        rings = [shapely.Polygon(self.polygons[self.names[block]]) for block in blocks]
        cut = [shapely.get_parts(shapely.constrained_delaunay_triangles(own)) for own in rings]
        corners = shapely.get_coordinates(np.concatenate(cut)).reshape(-1, 4, 2)[:, :3]
        corners = corners.transpose(2, 1, 0)
        u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        area = np.abs(u[0] * v[1] - u[1] * v[0]) / 2
        return corners, area, np.repeat(blocks, [len(own) for own in cut])

    def away(self, place: Floats) -> Floats:
        """Return the distances of a place from all blocks, m, (B,)."""
        outlines = [shapely.Polygon(ring) for ring in self.polygons.values()]
        return np.asarray(shapely.distance(outlines, shapely.Point(place)))

    def boundary(self, where: Where, field: str) -> tuple[Ints, Edges]:
        """Return the outline edges of a part of the blocks, and their geometry.

        Errors name the `field`.
        """
        edges, every = self.outline(where, field), self.edges
        return edges, Edges(every.start[:, edges], every.end[:, edges], every.normal[:, edges])

    def curves(self, edges: Ints) -> EdgeCurves:
        """Return the edges as curves, which are straight."""
        start, end = self.edges.start[:, edges], self.edges.end[:, edges]
        return EdgeCurves(start, (start + end) / 2, end)

    @property
    def lone_meetings(self) -> tuple[Ints, Ints, Floats]:
        """Blocks that meet with corners where no chain of joints links them, and where, m."""
        own, alone = self.meetings, ~self.meetings.linked
        return own.first[alone], own.second[alone], own.place[:, alone]

    def check_load(self, load: Load, field: str) -> None:
        """Raise `InputError` if no block carries a load."""
        carried(load, self)

    def check_contact(
        self, field: str, supports: Sequence[Fix], touched: Sequence[Touched]
    ) -> None:
        """Raise `InputError` if a block touches nothing, or only by a corner."""
        check_resting_corners(self.edges, self.joints, self.names, self.allowed, field)
        check_contact(self, field, supports, touched)

    def facets_inside(self, where: Callable[[Floats], Bools], field: str) -> Ints:
        """Return the edges that satisfy a predicate along their whole length.

        Raises:
            InputError: a predicate that ends inside an edge; it names the `field`.
        """
        chosen, cut = edges_inside(where, self.edges.start, self.edges.end, field)
        if cut.size:
            first = cut[0]
            raise InputError(
                field,
                None,
                text(
                    "it ends inside an edge of block {}, from {} to {}",
                    repr(self.names[self.edges.block[first]]),
                    Quantity(tuple(self.edges.start[:, first]), "m", ".6g"),
                    Quantity(tuple(self.edges.end[:, first]), "m", ".6g"),
                ),
                "put a vertex of the block where it ends",
            )
        return chosen


def _length_tolerance(given: float | None, points: Floats, block: Ints, area: Floats) -> float:
    """Return the tolerance in m; rejected if coordinates do not resolve it.

    Args:
        given: value of the user.
        points: vertices, (n, 2), of all blocks; the last of each repeats its first.
        block: numbers, (n,).
        area: areas of the blocks.
    """
    if given is not None:
        require_positive("BlockAssembly.tolerance", given)
        tolerance = given
    else:
        size = np.sqrt(area)
        length = np.linalg.norm(np.diff(points, axis=0), axis=1)[block[1:] == block[:-1]]
        own = size[block[1:][block[1:] == block[:-1]]]
        shortest = length[length > _SLIVER * own].min()
        tolerance = min(_TOLERANCE * np.mean(size), _GAP * shortest)
    return require_resolved(float(tolerance), points, "BlockAssembly.tolerance")


def RigidBlock(vertices: ArrayLike) -> BlockAssembly:  # noqa: N802  it reads as a body
    """Return an assembly of one block, named "block".

    Example:
        >>> la.RigidBlock([(0, 0), (1, 0), (1, 2), (0, 2)]).names
        ('block',)
    """
    return BlockAssembly({"block": vertices}, friction=0.0)
