"""Three-dimensional blocks for pictures: polygons, edges, and motions."""

from collections.abc import Iterable
from dataclasses import dataclass
from heapq import heappop, heappush

import numpy as np
import shapely

from lacore.limit.state import LimitState
from lacore.model.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.model.bodies.blocks3d.hulls import hull_corners
from lacore.model.bodies.blocks3d.polyhedron import Polyhedron
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.pictures.blocks import held_blocks
from lacore.reporting.showing import Compact

_TINY = np.finfo(float).tiny
_SAME = 1e-6  # by the size of the structure, and by unit normals


@dataclass(frozen=True, eq=False, repr=False)
class Blocks(Compact):
    """All three-dimensional blocks, one assembly after the other.

    Attributes:
        first: number of the first block of each assembly, by name.
        points: vertices, (3, n), m; `block`: their blocks, (n,).
        faces: vertex numbers of polygons that cover all surfaces, counterclockwise from outside.
        whole: which of them are a plane face: others are parts of one with holes, (p,).
        edges: vertex numbers of the ends of edges between plane faces, (2, e).
        centroid: centroids, (3, B), m. `radius`: radii, (B,), m.
        joined: slave and master of joints, (2, J). `normal`: normal out of the master, (3, J).
    """

    first: dict[str, int]
    points: Floats
    block: Ints
    faces: list[Ints]
    whole: Bools
    edges: Ints
    centroid: Floats
    radius: Floats
    joined: Ints
    normal: Floats

    @property
    def size(self) -> float:
        """Diagonal of the bounding box, m."""
        return float(np.linalg.norm(np.ptp(self.points, axis=1)))


def blocks_of(assemblies: Iterable[tuple[str, BlockAssembly3D]]) -> Blocks:
    """Return the blocks of assemblies, by name."""
    named = list(assemblies)
    solids = [own for _, body in named for own in body.polyhedra.values()]
    sizes = np.cumsum([0, *(len(body.names) for _, body in named)])
    shift = np.cumsum([0, *(len(own.vertices) for own in solids)])
    covers = [_cover(own) for own in solids]
    return Blocks(
        first={name: int(at) for (name, _), at in zip(named, sizes[:-1], strict=True)},
        points=np.concatenate([own.vertices for own in solids]).T,
        block=np.repeat(np.arange(len(solids)), np.diff(shift)),
        faces=[
            face + at
            for (faces, _), at in zip(covers, shift[:-1].tolist(), strict=True)
            for face in faces
        ],
        whole=np.concatenate([whole for _, whole in covers]),
        edges=np.concatenate(
            [own.edges + at for own, at in zip(solids, shift[:-1].tolist(), strict=True)], axis=1
        ),
        centroid=np.concatenate([body.centroid for _, body in named], axis=1),
        radius=np.concatenate([body.radius for _, body in named]),
        joined=np.concatenate(
            [
                np.stack([body.joints.slave, body.joints.master]) + at
                for (_, body), at in zip(named, sizes[:-1].tolist(), strict=True)
            ],
            axis=1,
        ),
        normal=np.concatenate([body.joints.normal for _, body in named], axis=1),
    )


def from_behind(blocks: Blocks, eye: Floats) -> list[int]:
    """Return the blocks in an order in which each hides only those before it.

    Of two blocks with a joint the one on the viewer's side comes later, else the closer one; if
    blocks hide each other in a cycle, the farthest of them is drawn first.

    Args:
        blocks: blocks that do not overlap.
        eye: unit vector towards the viewer, (3,).
    """
    depth = (eye @ blocks.centroid).tolist()
    towards = eye @ blocks.normal
    front = np.where(towards > 0, blocks.joined[0], blocks.joined[1])
    back = np.where(towards > 0, blocks.joined[1], blocks.joined[0])
    seen = np.abs(towards) > _SAME
    waits = np.bincount(front[seen], minlength=len(depth)).tolist()
    hides: list[list[int]] = [[] for _ in depth]
    for one, other in zip(back[seen].tolist(), front[seen].tolist(), strict=True):
        hides[one].append(other)
    left = sorted(range(len(depth)), key=depth.__getitem__)  # for cycles
    ready = [(depth[block], block) for block in left if not waits[block]]
    drawn: dict[int, None] = {}
    while len(drawn) < len(depth):
        if ready:
            _, block = heappop(ready)
        else:
            block = next(own for own in left if own not in drawn)
        if block in drawn:
            continue
        drawn[block] = None
        for other in hides[block]:
            waits[other] -= 1
            if waits[other] == 0 and other not in drawn:
                heappush(ready, (depth[other], other))
    return list(drawn)


def _cover(solid: Polyhedron) -> tuple[list[Ints], Bools]:
    """Return the polygons that cover a surface: plane faces, or parts of those with holes."""
    holed = np.bincount(solid.ring_face) > 1
    rings = zip(solid.rings, solid.ring_face, strict=True)
    whole = [ring for ring, face in rings if not holed[face]]
    parts = [
        np.array(own) for own, face in zip(solid.faces, solid.plane, strict=True) if holed[face]
    ]
    return [*whole, *parts], np.arange(len(whole) + len(parts)) < len(whole)


@dataclass(frozen=True, eq=False, repr=False)
class Motion(Compact):
    """Velocities of blocks.

    Attributes:
        blocks: the blocks.
        rate: velocities of the centroids, m/s, and rotation, rad/s, (6, B).
        held: whether supports prevent their motion, (B,).
    """

    blocks: Blocks
    rate: Floats
    held: Bools

    def at(self, points: Floats, block: Ints) -> Floats:
        """Return the velocities of blocks at points (3, k), m/s; 0 for block -1."""
        arm = points - self.blocks.centroid[:, block]
        velocity = self.rate[:3, block] + np.cross(self.rate[3:, block], arm, axis=0)
        return np.where(block >= 0, velocity, 0.0)

    @property
    def vertices(self) -> Floats:
        """Velocities of the vertices, (3, n), m/s."""
        return self.at(self.blocks.points, self.blocks.block)


STRETCH = 0.08  # largest drawn displacement, by the size of the structure
TURN = 0.3  # largest drawn rotation, rad: blocks grow by half its square


def stretch_of(motion: "Motion") -> float:
    """Return the time by which velocities are multiplied, s."""
    fastest = float(np.linalg.norm(motion.vertices, axis=0).max())
    spin = float(np.linalg.norm(motion.rate[3:], axis=0).max())
    return min(STRETCH * motion.blocks.size / max(fastest, _TINY), TURN / max(spin, _TINY))


def motion_of(state: LimitState) -> Motion:
    """Return the motion of three-dimensional blocks in the mechanism of a state."""
    d = state.discretisation
    rate = np.concatenate([state.velocity[name] for name in d.solids], axis=1)
    held = [held_blocks(state, dofs) for dofs in d.solids.values()]
    blocks = blocks_of((name, dofs.body) for name, dofs in d.solids.items())
    return Motion(blocks, rate, np.concatenate(held))


@dataclass(frozen=True, eq=False, repr=False)
class Touches(Compact):
    """Plane polygons in which two blocks touch, or a block and an obstacle.

    Attributes:
        corners: corners of the hull of the contact points of each, in order around it, (3, c) each,
            m.
        slave, master: block numbers, (k,); an obstacle is -1.
        normal: normal from the master into the slave, (3, k).
        force: force on the slave, N, (3, k). `centre`: centre of pressure, m, (3, k).
        kind: ``stick``, ``slip``, ``open`` or ``crush``, (k,): the state of most of its points.
    """

    corners: list[Floats]
    slave: Ints
    master: Ints
    normal: Floats
    force: Floats
    centre: Floats
    kind: np.ndarray


def touches_of(state: LimitState, motion: Motion, rest: float) -> Touches:
    """Return the contact of a state, polygon by polygon.

    Args:
        state: a state with a point.
        motion: motion of its blocks.
        rest: m/s: invisible slip or opening.
    """
    d, table = state.discretisation, state.reactions
    sides = _sides(state, motion.blocks)
    position, normal = d.points.position.T, d.points.normal.T
    number = d.full.contact.interface
    size = motion.blocks.size
    level = np.round(np.sum(normal * position, axis=0) / (_SAME * size))
    key = np.column_stack([number, sides.T, np.round(normal.T / _SAME), level]) + 0.0
    _, first, group = np.unique(key, axis=0, return_index=True, return_inverse=True)
    group, count = group.ravel(), first.size

    def total(values: Floats) -> Floats:
        return np.stack([np.bincount(group, row, count) for row in values]).astype(np.float64)

    area, t_n = table["area"].to_numpy(), table["t_n"].to_numpy()
    t_t = table[["t_t_x", "t_t_y", "t_t_z"]].to_numpy().T
    force = total(area * (t_n * normal + t_t))
    pressed = total((area * np.maximum(t_n, 0.0))[None])[0]
    weight = np.where(pressed[group] > 0, area * np.maximum(t_n, 0.0), area)
    centre = total(weight * position) / total(weight[None])

    slip = table[["u_t_x", "u_t_y", "u_t_z"]].to_numpy()
    opening = total((area * table["u_n"].to_numpy())[None])[0] / total(area[None])[0]
    sliding = total((area * np.linalg.norm(slip, axis=1))[None])[0] / total(area[None])[0]
    does = [opening > rest, opening < -rest, sliding > rest]
    kind = np.select(does, ["open", "crush", "slip"], "stick")
    corners = _around(position, normal[:, first], group)
    slave, master = sides[:, first]
    return Touches(corners, slave, master, normal[:, first], force, centre, kind)


def _sides(state: LimitState, blocks: Blocks) -> Ints:
    """Return the block numbers of slave and master at all contact points, (2, m); -1: obstacle."""
    d = state.discretisation
    number, moving = d.full.contact.interface, d.points.moving
    shift = np.full((2, len(d.points.names)), -1)
    for index, interface in enumerate(d.problem.interfaces):
        for side, (name, _) in enumerate(interface.sides):
            shift[side, index] = blocks.first[name]
    first = len(d.problem.interfaces)
    sides = np.where(shift[:, number] >= 0, shift[:, number] + moving.T, -1)
    for name, dofs in d.solids.items():
        joints = dofs.body.joints
        own = np.flatnonzero((number >= first) & (number < first + joints.count))
        both = np.stack([joints.slave, joints.master])[:, number[own] - first]
        sides[:, own] = both + blocks.first[name]
        first += joints.count
    return np.asarray(sides)


def _around(position: Floats, normal: Floats, group: Ints) -> list[Floats]:
    """Return the corners of the hull of each group of points, in order around its normal.

    The shape is (3, c) each.
    """
    count = normal.shape[1]
    number = np.bincount(group, minlength=count)
    middle = np.stack([np.bincount(group, row, count) for row in position]) / number
    axis = np.eye(3)[np.argmin(np.abs(normal), axis=0)].T
    one = np.cross(axis, normal, axis=0)
    two = np.cross(normal, one, axis=0)
    own = position - middle[:, group]
    flat = np.stack([np.sum(own * across[:, group], axis=0) for across in (one, two)])
    order = np.argsort(group, kind="stable")
    clouds = shapely.multipoints(flat[:, order].T, indices=group[order])
    corners, rim = hull_corners(clouds, 0.0)
    places = middle[:, rim] + corners[0] * one[:, rim] + corners[1] * two[:, rim]
    return np.split(places, np.flatnonzero(np.diff(rim)) + 1, axis=1)
