"""Unknowns of rigid blocks in space: for each block u of its centroid and w = r omega (T70).

r is the block's radius, so that all unknowns are velocities, m/s, and all forces, moments over r
included, are N.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import fsum

import numpy as np
from scipy.sparse import csr_matrix

from lacore.arrays import Floats, Ints, Sparse
from lacore.bodies.blocks.dofs import RigidDofs, RigidUnknowns
from lacore.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.bodies.blocks3d.held import free_motions, lever, motions
from lacore.bodies.blocks3d.loaded import carried
from lacore.conditions.loads import Fix, Load


@dataclass(frozen=True, repr=False)
class RigidDofs3D(RigidUnknowns):
    """Where the velocity of an assembly in space stands in the vector of all unknowns.

    Attributes:
        body: the assembly.
        offset: number of its first unknown; block b has offset + 6 b, ... + 5.
    """

    body: BlockAssembly3D
    offset: int
    per_block = 6

    @property
    def extent(self) -> float:
        """Volume, m^3."""
        return fsum(self.body.volume)

    def parts(self, faces: Ints) -> Ints:
        """The blocks of faces: what moves as one."""
        return np.asarray(self.body.faces.block[faces])

    def velocity_rows(self, blocks: Ints, points: Floats, n: int) -> tuple[Sparse, ...]:
        """Rows of u_x, u_y and u_z of blocks at points of shape (3, k), each of shape (k, n)."""
        values = motions(self.body, blocks, points)
        first = self.offset + 6 * blocks

        def rows(axis: int) -> Sparse:
            turns = 3 + (axis + 1) % 3, 3 + (axis + 2) % 3
            own = np.array([axis, *sorted(turns)])
            columns = (first[:, None] + own).ravel()
            start = own.size * np.arange(blocks.size + 1)
            matrix = csr_matrix(
                (values[:, axis, own].ravel(), columns, start), shape=(blocks.size, n)
            )
            matrix.eliminate_zeros()
            return matrix

        return tuple(map(rows, range(3)))

    def motion(self, velocity: Floats) -> Floats:
        """Velocities of the centroids, m/s, and of rotation, rad/s, shape (6, blocks)."""
        own = velocity[self.offset : self.offset + self.count].reshape(-1, 6).T.copy()
        own[3:] /= self.body.radius
        return own

    def unknowns(self, motion: Floats) -> Floats:
        """The inverse of `motion`, shape (count,)."""
        own = motion.copy()
        own[3:] *= self.body.radius
        return np.asarray(own.T.ravel())

    def force(self, load: Load) -> Floats:
        """Forces of a load on the blocks' unknowns, shape (count,), N."""
        blocks, points, vectors = carried(load, self.body)
        total = np.zeros((len(self.body.names), 6))
        turning = np.cross(lever(self.body, blocks, points), vectors, axis=0)
        np.add.at(total, blocks, np.concatenate([vectors, turning]).T)
        return total.ravel()

    def free(self, supports: Iterable[Fix]) -> Sparse:
        """Basis of the velocities that supports leave free, shape (count, free)."""
        return free_motions(self.body, supports)

    def support_forces(self, force: Floats, supports: Iterable[Fix]) -> tuple[Floats, Floats]:
        """Centroids (3, k) of held blocks, and what supports exert there: forces, moments (6, k).

        Args:
            force: what supports exert on the unknowns, shape (count,), N.
            supports: of this assembly.
        """
        faces = [self.body.outline(support.where, "Fix.where") for support in supports]
        blocks = np.unique(self.parts(np.concatenate([np.zeros(0, dtype=np.int64), *faces])))
        result = force.reshape(-1, 6)[blocks].T.copy()
        result[3:] *= self.body.radius[blocks]
        return self.body.centroid[:, blocks], result


AnyRigidDofs = RigidDofs | RigidDofs3D
"""Unknowns of rigid blocks, in the plane or in space."""
