"""Unknowns of rigid blocks, in the plane and in three dimensions (T70).

The unknowns of a block are the velocity of its centroid and its radius times its rates of rotation,
so that all unknowns are velocities, m/s, and all forces, moments over the radius included, are N/m;
in three dimensions N. For joints that crush, the crushing speed of each point follows the unknowns
of blocks: it opens the contact there, at the cost of strength times area (T95).
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import fsum
from typing import Generic, TypeVar, cast

import numpy as np
from scipy.sparse import block_diag, csr_matrix, eye_array

from lacore.model.bodies.blocks.loads import carried
from lacore.model.bodies.blocks.motions import free_motions, motion_count, motions
from lacore.model.bodies.blocks.rigid_blocks import RigidBlocks
from lacore.model.conditions.loads import Fix, Load
from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.program.kinematic import DissipationGroup
from lacore.reporting.showing import Compact

Assembly = TypeVar("Assembly", bound=RigidBlocks, covariant=True)
Kind = TypeVar("Kind", bound=RigidBlocks)


@dataclass(frozen=True, repr=False)
class RigidDofs(Compact, Generic[Assembly]):
    """Place of the velocity of an assembly among all unknowns.

    Attributes:
        body: the assembly.
        offset: number of its first unknown; block b has those from offset + `per_block` b on, and
            points that crush those from offset + `of_blocks` on, see `CrushingPoints`.
    """

    body: Assembly
    offset: int
    degree = 1  # degree of the velocity along an edge
    bent = axisymmetric = False

    @property
    def per_block(self) -> int:
        """Number of unknowns of a block, u."""
        return motion_count(self.body.dimension)

    @property
    def of_blocks(self) -> int:
        """Number of unknowns of motions of blocks, which come first."""
        return self.per_block * len(self.body.names)

    @property
    def count(self) -> int:
        """Number of unknowns."""
        return self.of_blocks + self.crushing.size

    @property
    def crushing(self) -> Ints:
        """Unknowns of points that crush, (m,)."""
        points = self.body.crushing_points
        return self.offset + self.of_blocks + np.arange(0 if points is None else points.block.size)

    @property
    def strength(self) -> float:
        """Shear stress that it can carry, Pa: a rigid block any."""
        return np.inf

    @property
    def pieces_of_unknowns(self) -> Ints:
        """The block of each unknown, of points that crush the slave, shape (count,)."""
        every = np.repeat(np.arange(len(self.body.names)), self.per_block)
        points = self.body.crushing_points
        return every if points is None else np.concatenate([every, points.block])

    @property
    def places(self) -> Floats:
        """Place of each unknown: centroids, points that crush, (d, count), m."""
        centroids = np.repeat(self.body.centroid, self.per_block, axis=1)
        points = self.body.crushing_points
        return centroids if points is None else np.concatenate([centroids, points.position], axis=1)

    @property
    def extent(self) -> float:
        """Area, m^2, or volume, m^3."""
        return fsum(self.body.measure)

    def groups(self, name: str, n: int) -> tuple[DissipationGroup, ...]:
        """Return the crushing group, with pressures as stresses; motions dissipate nothing."""
        points, m = self.body.crushing_points, self.crushing.size
        if points is None:
            return ()
        return (
            DissipationGroup(
                name=f"{name}: crushing",
                rows=csr_matrix((np.ones(m), (np.arange(m), self.crushing)), (m, n)),
                dim=1,
                weights=points.area,
                bound=np.full(m, points.strength),
                volumetric=csr_matrix((m, n)),
                volumetric_factor=0.0,
            ),
        )

    def crushed(self, n: int) -> tuple[Sparse, ...]:
        """Return the rows of the jump by crushing at points of joints, (m, n) for each axis."""
        points = self.body.crushing_points
        if points is None:
            return ()
        where, shape = (np.arange(points.block.size), self.crushing), (points.block.size, n)
        return tuple(csr_matrix((own, where), shape) for own in points.normal)

    def moving(self, blocks: Ints) -> Ints:
        """Return the blocks, each of which moves separately."""
        return blocks

    def thickness(self, places: Floats) -> Floats:
        """Return a thickness of one metre."""
        return np.ones_like(places[0])

    def parts(self, facets: Ints) -> Ints:
        """Return the blocks of edges or faces."""
        return self.body.blocks_of(facets)

    def velocity_rows(self, blocks: Ints, points: Floats, n: int) -> tuple[Sparse, ...]:
        """Return the rows of u_x, u_y (and u_z) of blocks at points.

        The points have the shape (d, k), and each matrix (k, n).
        """
        values, u = motions(self.body, blocks, points), self.per_block
        columns = self.offset + u * blocks[:, None] + np.arange(u)
        start = u * np.arange(blocks.size + 1)
        rows = [
            csr_matrix((own.ravel(), columns.ravel(), start), shape=(blocks.size, n))
            for own in values.transpose(1, 0, 2)
        ]
        for matrix in rows:
            matrix.eliminate_zeros()
        return tuple(rows)

    def motion(self, velocity: Floats) -> Floats:
        """Return the velocities of the centroids, m/s, and rates of rotation, rad/s.

        The shape is (u, blocks).
        """
        own = velocity[self.offset : self.offset + self.of_blocks]
        own = own.reshape(-1, self.per_block).T.copy()
        own[self.body.dimension :] /= self.body.radius
        return own

    def unknowns(self, motion: Floats) -> Floats:
        """Return the inverse of `motion`, shape (of_blocks,)."""
        own = motion.copy()
        own[self.body.dimension :] *= self.body.radius
        return np.asarray(own.T.ravel())

    def velocity_at(self, motion: Floats, blocks: Ints, points: Floats) -> Floats:
        """Return the velocities of blocks at points of shape (d, k) by a `motion`, m/s.

        The shape is (d, k).
        """
        own = self.unknowns(motion).reshape(-1, self.per_block)[blocks]
        return np.asarray(np.einsum("kdu,ku->dk", motions(self.body, blocks, points), own))

    def force(self, load: Load) -> Floats:
        """Return the forces of a load on the blocks' unknowns, shape (count,), N/m.

        In three dimensions N.
        """
        blocks, points, vectors = carried(load, self.body)
        total = np.zeros((len(self.body.names), self.per_block))
        turned = motions(self.body, blocks, points) * vectors.T[:, :, None]
        np.add.at(total, blocks, turned.sum(axis=1))
        return np.append(total.ravel(), np.zeros(self.crushing.size))

    def free(self, supports: Iterable[Fix]) -> Sparse:
        """Return a basis of the velocities that supports allow, shape (count, free)."""
        blocks = free_motions(self.body, supports)
        return csr_matrix(block_diag([blocks, eye_array(self.crushing.size)]))

    def support_forces(self, force: Floats, supports: Iterable[Fix]) -> tuple[Floats, Floats]:
        """Return centroids (d, k) of held blocks, and forces and moments of supports there (u, k).

        Args:
            force: forces of supports on the unknowns, shape (count,), N/m; in three dimensions N.
            supports: supports of this assembly.
        """
        facets = [self.body.outline(support.where, "Fix.where") for support in supports]
        blocks = np.unique(self.parts(np.concatenate([np.zeros(0, dtype=np.int64), *facets])))
        result = force[: self.of_blocks].reshape(-1, self.per_block)[blocks].T.copy()
        result[self.body.dimension :] *= self.body.radius[blocks]
        return self.body.centroid[:, blocks], result


def dofs_of_kind(
    blocks: Mapping[str, RigidDofs[RigidBlocks]], kind: type[Kind]
) -> dict[str, RigidDofs[Kind]]:
    """Return the unknowns of the assemblies of one kind, by name."""
    return {
        name: cast(RigidDofs[Kind], own)
        for name, own in blocks.items()
        if isinstance(own.body, kind)
    }
