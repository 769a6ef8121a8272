"""Unknowns of a problem: of continua, footings, rigid blocks and frames, in this order."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import fsum

import numpy as np

from lacore.assembly.loading import count_speeds, numbered_speeds
from lacore.model.bodies.any_body import Dofs, RigidParts, numbered, of_kind, rigid_blocks
from lacore.model.bodies.blocks.dofs import RigidDofs
from lacore.model.bodies.blocks.rigid_blocks import RigidBlocks
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.frames.dofs import FrameDofs
from lacore.model.bodies.frames.frame import Frame
from lacore.model.conditions.footings import Footing
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats, Ints


@dataclass(frozen=True)
class Unknowns:
    """Meaning of the numbers of a velocity.

    Attributes:
        continua, blocks, frames: unknowns of bodies, by name.
        footings: first unknown of each, the speed that its load drives.
        n: number of unknowns.
    """

    continua: Mapping[str, BodyDofs]
    blocks: Mapping[str, RigidDofs[RigidBlocks]]
    frames: Mapping[str, FrameDofs]
    footings: Mapping[Footing, int]
    n: int

    @classmethod
    def of(cls, problem: Problem) -> "Unknowns":
        """Number all unknowns, one after the other."""
        continua = numbered(of_kind(problem.bodies, Body), BodyDofs.at)
        first = sum(own.count for own in continua.values())
        footings = numbered_speeds(problem, first)
        n = first + count_speeds(footings)
        blocks = numbered(rigid_blocks(problem.bodies), RigidDofs, n)
        n += sum(own.count for own in blocks.values())
        frames = numbered(of_kind(problem.bodies, Frame), FrameDofs, n)
        n += sum(own.count for own in frames.values())
        return cls(continua, blocks, frames, footings, n)

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return max(own.body.dimension for own in self.dofs.values())

    @property
    def speeds(self) -> Ints:
        """Unknowns of footings, all of them, shape (f,)."""
        own = [place + np.arange(one.speeds) for one, place in self.footings.items()]
        return np.concatenate([np.zeros(0, dtype=np.int64), *own])

    @cached_property
    def rigid(self) -> dict[str, RigidParts]:
        """Bodies with supports of a separate kind, in the order of their unknowns."""
        return {**self.blocks, **self.frames}

    @cached_property
    def dofs(self) -> dict[str, Dofs]:
        """All bodies, in the order of their unknowns."""
        return {**self.continua, **self.rigid}

    @cached_property
    def node_dofs(self) -> Ints:
        """Unknowns (x, y), or (x, y, z), of the nodes of all continua, shape (d, nodes)."""
        found = [own.dofs for own in self.continua.values()]
        return np.concatenate(found or [np.zeros((2, 0), dtype=np.int64)], axis=1)

    @property
    def parts(self) -> Ints:
        """Part of each unknown, shape (n,): a continuum with its footings, a block, a frame."""
        parts, count, first = np.zeros(self.n, dtype=np.int64), 0, {}
        for name, own in self.dofs.items():
            pieces, first[name] = own.pieces_of_unknowns, count
            parts[own.offset : own.offset + own.count] = count + pieces
            count += int(pieces.max(initial=-1)) + 1
        for footing, place in self.footings.items():
            parts[place : place + footing.speeds] = first[footing.body]
        return parts

    def load_size(self, load: Floats) -> float:
        """Return the sum of the sizes of all nodal, footing, block and frame forces.

        The unit is N/m, in three dimensions N.
        """
        node_dofs = self.node_dofs
        nodal = np.linalg.norm(load[node_dofs], axis=0).sum()
        return float(nodal + fsum(np.abs(load[node_dofs.size :])))
