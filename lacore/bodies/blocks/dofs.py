"""Unknowns of rigid block assemblies: for each block u_x, u_y of its centroid and w = omega r.

r is the block's radius, so that all unknowns are velocities, m/s, and all forces, moments over r
included, are N/m.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import fsum
from typing import Any, ClassVar

import numpy as np
from scipy.sparse import csr_matrix

from lacore.arrays import Floats, Ints, Sparse
from lacore.bodies.blocks.block_assembly import BlockAssembly
from lacore.bodies.blocks.held import free_motions, lever
from lacore.bodies.blocks.loaded import carried
from lacore.conditions.loads import Fix, Load
from lacore.program import DissipationGroup
from lacore.showing import Compact


class RigidUnknowns(Compact):
    """What unknowns of rigid blocks have in common, in the plane and in space.

    Attributes:
        body: the assembly.
        per_block: unknowns of a block.
    """

    body: Any
    per_block: ClassVar[int]
    degree = 1  # of the velocity along an edge
    bent = axisymmetric = False

    @property
    def of_blocks(self) -> int:
        """Number of unknowns of motions of blocks, which come first."""
        return self.per_block * len(self.body.names)

    @property
    def count(self) -> int:
        """Number of unknowns."""
        return self.of_blocks

    @property
    def strength(self) -> float:
        """Shear stress that it can carry, Pa: a rigid block any."""
        return np.inf

    @property
    def pieces_of_unknowns(self) -> Ints:
        """The block of each unknown, shape (count,)."""
        return np.repeat(np.arange(len(self.body.names)), self.per_block)

    @property
    def places(self) -> Floats:
        """Where each unknown moves something: the centroid of its block, (d, count), m."""
        return np.repeat(self.body.centroid, self.per_block, axis=1)

    def crushed(self, n: int) -> tuple[Sparse, ...]:
        """Joints crush in space alone, see `RigidDofs3D.crushed`."""
        return ()

    def groups(self, name: str, n: int) -> tuple[DissipationGroup, ...]:
        """Rigid blocks dissipate nothing."""
        return ()

    def moving(self, blocks: Ints) -> Ints:
        """What moves continuously: each block for itself."""
        return blocks

    def thickness(self, places: Floats) -> Floats:
        """One metre."""
        return np.ones_like(places[0])


@dataclass(frozen=True, repr=False)
class RigidDofs(RigidUnknowns):
    """Where the velocity of an assembly stands in the vector of all unknowns.

    Attributes:
        body: the assembly.
        offset: number of its first unknown; block b has offset + 3 b, ... + 2.
    """

    body: BlockAssembly
    offset: int
    per_block = 3

    @property
    def extent(self) -> float:
        """Area, m^2."""
        return fsum(self.body.area)

    def parts(self, edges: Ints) -> Ints:
        """The blocks of outline edges: what moves as one."""
        return np.asarray(self.body.edges.block[edges])

    def velocity_rows(self, blocks: Ints, points: Floats, n: int) -> tuple[Sparse, Sparse]:
        """Rows of u_x and u_y of blocks at points of shape (2, k), each of shape (k, n)."""
        x, y = lever(self.body, blocks, points)
        first = self.offset + 3 * blocks
        start = 2 * np.arange(blocks.size + 1)

        def rows(axis: int, turn: Floats) -> Sparse:
            columns = np.stack([first + axis, first + 2], axis=1)
            values = np.stack([np.ones(blocks.size), turn], axis=1)
            matrix = csr_matrix((values.ravel(), columns.ravel(), start), shape=(blocks.size, n))
            matrix.eliminate_zeros()
            return matrix

        return rows(0, -y), rows(1, x)

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

    def force(self, load: Load) -> Floats:
        """Forces of a load on the blocks' unknowns, shape (count,), N/m."""
        blocks, points, vectors = carried(load, self.body)
        total = np.zeros((len(self.body.names), 3))
        x, y = lever(self.body, blocks, points)
        turning = x * vectors[1] - y * vectors[0]
        np.add.at(total, blocks, np.stack([*vectors, turning], axis=1))
        return total.ravel()

    def free(self, supports: Iterable[Fix]) -> Sparse:
        """Basis of the velocities that supports leave free, shape (count, free)."""
        return free_motions(self.body, supports)

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
