"""Unknowns of rigid block assemblies: for each block u_x, u_y of its centroid and w = omega r.

r is the block's radius, so that all unknowns are velocities, m/s, and all forces, moments over r
included, are N/m.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import fsum

import numpy as np
import shapely
from scipy.sparse import block_diag, csr_matrix

from lacore.arrays import Floats, Ints, Sparse
from lacore.bodies.any_body import tolerance
from lacore.bodies.blocks.block_assembly import BlockAssembly
from lacore.conditions.loads import BodyForce, Fix, PointForce, Pressure, RigidFooting, Traction
from lacore.errors import InputError, suggest
from lacore.program import DissipationGroup
from lacore.showing import Compact

_HELD = 1e-12  # squared: of the largest direction that supports hold; far above round-off
_ROUND_OFF = 1e-14  # of a unit vector
_AXES = {"x": (True, False), "y": (False, True), "xy": (True, True)}


@dataclass(frozen=True, repr=False)
class RigidDofs(Compact):
    """Where the velocity of an assembly stands in the vector of all unknowns.

    Attributes:
        body: the assembly.
        offset: number of its first unknown; block b has offset + 3 b, ... + 2.
    """

    body: BlockAssembly
    offset: int
    degree = 1  # of the velocity along an edge

    @property
    def count(self) -> int:
        """Number of unknowns."""
        return 3 * len(self.body.names)

    @property
    def strength(self) -> float:
        """Shear stress that it can carry, Pa: a rigid block any."""
        return np.inf

    @property
    def extent(self) -> float:
        """Area, m^2."""
        return fsum(self.body.area)

    @property
    def pieces_of_unknowns(self) -> Ints:
        """The block of each unknown, shape (count,)."""
        return np.repeat(np.arange(len(self.body.names)), 3)

    def groups(self, n: int) -> tuple[DissipationGroup, ...]:
        """Rigid blocks dissipate nothing."""
        return ()

    def parts(self, edges: Ints) -> Ints:
        """The blocks of outline edges: what moves as one."""
        return np.asarray(self.body.edges.block[edges])

    def moving(self, blocks: Ints) -> Ints:
        """What moves continuously: each block for itself."""
        return blocks

    def velocity_rows(self, blocks: Ints, points: Floats, n: int) -> tuple[Sparse, Sparse]:
        """Rows of u_x and u_y of blocks at points of shape (2, k), each of shape (k, n)."""
        x, y = self._lever(blocks, points)
        first = self.offset + 3 * blocks
        start = 2 * np.arange(blocks.size + 1)

        def rows(axis: int, turn: Floats) -> Sparse:
            columns = np.stack([first + axis, first + 2], axis=1)
            values = np.stack([np.ones(blocks.size), turn], axis=1)
            matrix = csr_matrix((values.ravel(), columns.ravel(), start), shape=(blocks.size, n))
            matrix.eliminate_zeros()
            return matrix

        return rows(0, -y), rows(1, x)

    def _lever(self, blocks: Ints, points: Floats) -> Floats:
        """Place against the centroid, per radius, shape (2, k)."""
        body = self.body
        return np.asarray((points - body.centroid[:, blocks]) / body.radius[blocks])

    def motion(self, velocity: Floats) -> Floats:
        """u_x, u_y of the centroids, m/s, and rotation rates, rad/s, shape (3, blocks)."""
        own = velocity[self.offset : self.offset + self.count].reshape(-1, 3).T.copy()
        own[2] /= self.body.radius
        return own

    def unknowns(self, motion: Floats) -> Floats:
        """The inverse of `motion`, shape (count,)."""
        own = motion.copy()
        own[2] *= self.body.radius
        return np.asarray(own.T.ravel())

    def vertex_velocity(self, motion: Floats) -> Floats:
        """Velocity at the starts of all outline edges by a `motion`, m/s, shape (2, n)."""
        edges = self.body.edges
        u_x, u_y, omega = motion[:, edges.block]
        x, y = edges.start - self.body.centroid[:, edges.block]
        return np.stack([u_x - omega * y, u_y + omega * x])

    def force(self, load: Traction | Pressure | BodyForce | PointForce | RigidFooting) -> Floats:
        """Forces of a load on the blocks' unknowns, shape (count,), N/m."""
        body, total = self.body, np.zeros((len(self.body.names), 3))
        if isinstance(load, RigidFooting):
            raise InputError(
                "RigidFooting.body", load.body, "its blocks are rigid already", "load the blocks"
            )
        if isinstance(load, BodyForce):
            blocks = _named(body, load.where, "BodyForce.where")
            points = body.centroid[:, blocks]
            vectors = np.outer(load.vector, body.area[blocks])
        elif isinstance(load, PointForce):
            blocks, points = _loaded_block(body, load)
            vectors = np.reshape(load.vector, (2, 1))
        else:
            edges = body.outline(load.where, f"{type(load).__name__}.where")
            start, end = body.edges.start[:, edges], body.edges.end[:, edges]
            blocks, points = self.parts(edges), (start + end) / 2
            length = np.linalg.norm(end - start, axis=0)
            if isinstance(load, Pressure):
                vectors = -load.value * body.edges.normal[:, edges] * length
            else:
                vectors = np.outer(load.vector, length)
        x, y = self._lever(blocks, points)
        turning = x * vectors[1] - y * vectors[0]
        np.add.at(total, blocks, np.stack([*vectors, turning], axis=1))
        return total.ravel()

    def free(self, supports: Iterable[Fix]) -> Sparse:
        """Basis of the velocities that supports leave free, shape (count, free)."""
        held = np.zeros((len(self.body.names), 3, 3))
        for support in supports:
            edges = self.body.outline(support.where, "Fix.where")
            for end in (self.body.edges.start, self.body.edges.end):
                self._hold(held, edges, end[:, edges], support.components)
        values, vectors = np.linalg.eigh(held)
        is_free = values <= _HELD * np.maximum(values.max(axis=1, keepdims=True), 1.0)
        untouched = is_free.all(axis=1)
        vectors[untouched] = np.eye(3)
        vectors[np.abs(vectors) < _ROUND_OFF] = 0.0
        return csr_matrix(
            block_diag(
                [axes[:, kept] for axes, kept in zip(vectors, is_free, strict=True)], format="csr"
            )
        )

    def support_forces(self, force: Floats, supports: Iterable[Fix]) -> tuple[Floats, Floats]:
        """Centroids (2, k) of held blocks, and what supports exert there: forces, moments (3, k).

        Args:
            force: what supports exert on the unknowns, shape (count,), N/m.
            supports: of this assembly.
        """
        edges = [self.body.outline(support.where, "Fix.where") for support in supports]
        blocks = np.unique(self.parts(np.concatenate([np.zeros(0, dtype=np.int64), *edges])))
        result = force.reshape(-1, 3)[blocks].T.copy()
        result[2] *= self.body.radius[blocks]
        return self.body.centroid[:, blocks], result

    def _hold(self, held: Floats, edges: Ints, points: Floats, components: str) -> None:
        """Add the directions that a support holds at points of edges to their Gram matrices."""
        blocks = self.parts(edges)
        x, y = self._lever(blocks, points)
        one, zero = np.ones(edges.size), np.zeros(edges.size)
        axes = np.stack([np.stack([one, zero, -y], axis=1), np.stack([zero, one, x], axis=1)])
        if components in _AXES:
            directions = axes[np.array(_AXES[components])]
        else:
            normal = self.body.edges.normal[:, edges]
            along = normal if components == "normal" else np.stack([-normal[1], normal[0]])
            directions = np.einsum("ak,akd->kd", along, axes)[None]
        for direction in directions:
            np.add.at(held, blocks, direction[:, :, None] * direction[:, None, :])


def _named(body: BlockAssembly, where: str | tuple[str, ...] | None, field: str) -> Ints:
    """Numbers of blocks from their names; None: of all."""
    if where is None:
        return np.arange(len(body.names))
    if not isinstance(where, str | Sequence):
        raise InputError(field, where, "no names of blocks", "give a name, or a tuple of names")
    number = {name: index for index, name in enumerate(body.names)}
    names = (where,) if isinstance(where, str) else tuple(where)
    for place, name in enumerate(names):
        if not isinstance(name, str) or name not in number:
            raise InputError(field, name, "no such block", suggest(str(name), number))
        if name in names[:place]:
            raise InputError(field, name, "this block is given twice", "give each block once")
    return np.array([number[name] for name in names], dtype=np.int64)


def _loaded_block(body: BlockAssembly, load: PointForce) -> tuple[Ints, Floats]:
    """The block that a point force acts on, and where, shapes (1,) and (2, 1)."""
    if isinstance(load.at, str):
        block = _named(body, load.at, "PointForce.at")
        if load.where not in (None, load.at):
            raise InputError(
                "PointForce.where", load.where, f"`at` names {load.at!r}", "leave `where` out"
            )
        return block, body.centroid[:, block]
    away = shapely.distance(
        [shapely.Polygon(ring) for ring in body.polygons.values()], shapely.Point(load.at)
    )
    blocks = np.flatnonzero(away <= tolerance(body))
    if load.where is not None:
        blocks = np.intersect1d(blocks, _named(body, load.where, "PointForce.where"))
    names = [body.names[block] for block in blocks]
    if len(names) != 1:
        why = f"lies on the blocks {', '.join(names)}" if names else "lies on no block"
        nearest = body.names[int(np.argmin(away))]
        mend = "say by `where` which one carries it" if names else f"the nearest is {nearest!r}"
        raise InputError("PointForce.at", load.at, why, mend)
    return blocks, np.reshape(np.asarray(load.at, dtype=float), (2, 1))
