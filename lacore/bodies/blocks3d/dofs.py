"""Unknowns of rigid blocks in space: for each block u of its centroid and w = r omega (T70).

r is the block's radius, so that all unknowns are velocities, m/s, and all forces, moments over r
included, are N. Where joints crush, the speed of that at each point comes after those of blocks: it
opens the contact there, at the cost of strength times area (T95).
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import fsum

import numpy as np
from scipy.sparse import block_diag, csr_matrix, eye_array

from lacore.arrays import Floats, Ints, Sparse
from lacore.bodies.blocks.dofs import RigidDofs, RigidUnknowns
from lacore.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.bodies.blocks3d.crushing import crushing_of
from lacore.bodies.blocks3d.held import free_motions, lever, motions
from lacore.bodies.blocks3d.loaded import carried
from lacore.conditions.loads import Fix, Load
from lacore.program import DissipationGroup


@dataclass(frozen=True, repr=False)
class RigidDofs3D(RigidUnknowns):
    """Where the velocity of an assembly in space stands in the vector of all unknowns.

    Attributes:
        body: the assembly.
        offset: number of its first unknown; block b has offset + 6 b, ... + 5, points that crush
            those from offset + `of_blocks` on, in the order of `Joints3D.points`.
    """

    body: BlockAssembly3D
    offset: int
    per_block = 6

    @property
    def count(self) -> int:
        """Number of unknowns."""
        return self.of_blocks + self.crushing.size

    @property
    def crushing(self) -> Ints:
        """Unknowns of points that crush, (m,)."""
        points = 0 if self.body.crushing is None else self.body.joints.joint.size
        return self.offset + self.of_blocks + np.arange(points)

    @property
    def _crushing_blocks(self) -> Ints:
        """The slave at each point that crushes, (m,)."""
        joints = self.body.joints
        return joints.slave[joints.joint][: self.crushing.size]

    @property
    def pieces_of_unknowns(self) -> Ints:
        """The block of each unknown, of points that crush the slave, shape (count,)."""
        return np.concatenate([super().pieces_of_unknowns, self._crushing_blocks])

    @property
    def places(self) -> Floats:
        """Where each unknown moves something: centroids, points that crush, (3, count), m."""
        points = self.body.joints.points[:, : self.crushing.size]
        return np.concatenate([super().places, points], axis=1)

    def groups(self, name: str, n: int) -> tuple[DissipationGroup, ...]:
        """Crushing: the stress of each cell is its pressure."""
        law, m = crushing_of(self.body.crushing), self.crushing.size
        if law is None:
            return ()
        rows = csr_matrix((np.ones(m), (np.arange(m), self.crushing)), (m, n))
        return (
            DissipationGroup(
                name=f"{name}: crushing",
                rows=rows,
                dim=1,
                weights=self.body.joints.weight,
                bound=np.full(m, law.strength),
                volumetric=csr_matrix((m, n)),
                volumetric_factor=0.0,
            ),
        )

    def crushed(self, n: int) -> tuple[Sparse, ...]:
        """Rows of what crushing adds to the jump at points of joints along x, y, z, (m, n) each."""
        if self.body.crushing is None:
            return ()
        m, joints = self.crushing.size, self.body.joints
        where = np.arange(m), self.crushing
        return tuple(csr_matrix((own[joints.joint], where), (m, n)) for own in joints.normal)

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
        own = velocity[self.offset : self.offset + self.of_blocks].reshape(-1, 6).T.copy()
        own[3:] /= self.body.radius
        return own

    def unknowns(self, motion: Floats) -> Floats:
        """The inverse of `motion`, shape (of_blocks,)."""
        own = motion.copy()
        own[3:] *= self.body.radius
        return np.asarray(own.T.ravel())

    def force(self, load: Load) -> Floats:
        """Forces of a load on the blocks' unknowns, shape (count,), N."""
        blocks, points, vectors = carried(load, self.body)
        total = np.zeros((len(self.body.names), 6))
        turning = np.cross(lever(self.body, blocks, points), vectors, axis=0)
        np.add.at(total, blocks, np.concatenate([vectors, turning]).T)
        return np.append(total.ravel(), np.zeros(self.crushing.size))

    def free(self, supports: Iterable[Fix]) -> Sparse:
        """Basis of the velocities that supports leave free, shape (count, free)."""
        blocks = free_motions(self.body, supports)
        return csr_matrix(block_diag([blocks, eye_array(self.crushing.size)]))

    def support_forces(self, force: Floats, supports: Iterable[Fix]) -> tuple[Floats, Floats]:
        """Centroids (3, k) of held blocks, and what supports exert there: forces, moments (6, k).

        Args:
            force: what supports exert on the unknowns, shape (count,), N.
            supports: of this assembly.
        """
        faces = [self.body.outline(support.where, "Fix.where") for support in supports]
        blocks = np.unique(self.parts(np.concatenate([np.zeros(0, dtype=np.int64), *faces])))
        result = force[: self.of_blocks].reshape(-1, 6)[blocks].T.copy()
        result[3:] *= self.body.radius[blocks]
        return self.body.centroid[:, blocks], result


AnyRigidDofs = RigidDofs | RigidDofs3D
"""Unknowns of rigid blocks, in the plane or in space."""
