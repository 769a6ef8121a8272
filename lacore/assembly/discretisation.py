"""An assembled problem: its programs, and the meaning of their unknowns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.blocks.dofs import RigidDofs, dofs_of_kind
from lacore.model.bodies.blocks.rigid_blocks import RigidBlocks
from lacore.model.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.jumps import Jumps
from lacore.model.bodies.continuum.slip import Slip
from lacore.model.bodies.continuum.solid.memory import told_memory, velocity_memory
from lacore.model.bodies.frames.dofs import FrameDofs
from lacore.model.contact.rows import ContactPoints
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Bools, Ints, Sparse
from lacore.program.kinematic import KinematicProgram, Scales
from lacore.reporting.showing import Facts, Picture, Shown, counted, listed, sized
from lacore.reporting.status import Claim, Rigor, Scope

_EXACT = Claim("exact", "rigid blocks and frames have no discretisation")
_OF_POLYGONS = {
    Rigor.LOWER: Claim("strict lower bound", "polygons inside the yield curves of sections"),
    Rigor.UPPER: Claim("strict upper bound", "polygons around the yield curves of sections"),
    Rigor.DISCRETE: Claim("not a bound", "polygons inside and around the yield curves of sections"),
}


@dataclass(frozen=True, repr=False)
class Discretisation(Shown):
    """Assembled problem.

    Attributes:
        problem: the problem.
        full: program of all unknowns, SI units.
        program: program of the free unknowns q, SI units.
        free_basis: ``U = free_basis @ q``.
        held_nodes: which nodes a support or a footing acts on, shape (nodes of all continua,).
        continua: deformable bodies by name.
        blocks: assemblies of rigid blocks by name.
        frames: frames by name; their hinges are the groups of these names.
        jumps: velocity jumps of the regions of continua (T23), by name (of a region ``soil.clay``),
            where the velocity space has jumps or the body slips along boundaries. Groups of the
            programs are the regions of the continua, these jumps, the seams, and the hinges of
            frames.
        seams: jumps across bonded interfaces by name, where the sides do not move together.
        slips: boundaries along which continua slip past their supports, by name.
        points: geometry of the contact points.
        shared_corners: contact points with friction at corners that are in contact on both sides:
            the reactions there, and with them the load factor, may not be unique, shape (m,).
        footings: unknowns of the footings in the order of the loads: the speed of each along its
            direction, then in three dimensions the rotations about its axes, shape (f,).
        natural: scales in which the results are of order one (T20).
    """

    problem: Problem
    full: KinematicProgram
    program: KinematicProgram
    free_basis: Sparse
    held_nodes: Bools
    continua: Mapping[str, BodyDofs]
    blocks: Mapping[str, RigidDofs[RigidBlocks]]
    frames: Mapping[str, FrameDofs]
    jumps: Mapping[str, Jumps]
    slips: Mapping[str, Slip]
    seams: Mapping[str, Jumps]
    points: ContactPoints
    shared_corners: Bools
    footings: Ints
    natural: Scales

    @property
    def scope(self) -> Scope:
        """Problem to which its load factors belong."""
        return Scope.DISCRETE if self.continua or self.crushing.size else Scope.ITSELF

    def claim(self, rigor: Rigor) -> Claim:
        """Return what a load factor proves; without a discretisation it bounds no continuum."""
        known = (Rigor.UPPER, Rigor.LOWER, Rigor.DISCRETE)
        if self.scope is Scope.DISCRETE or rigor not in known:
            return rigor.claim
        if self.full.associated_flow:
            sides = [side for frame in self.frames.values() for side in frame.body.polygons]
            return _OF_POLYGONS[rigor] if sides else _EXACT
        if rigor is Rigor.UPPER:
            return Claim(
                "strict upper bound of Coulomb load factors", "friction dilates, or sticks"
            )
        return Claim("certified Coulomb state", "not a bound: other load factors may be possible")

    @cached_property
    def assemblies(self) -> dict[str, RigidDofs[BlockAssembly]]:
        """Plane assemblies of `blocks`."""
        return dofs_of_kind(self.blocks, BlockAssembly)

    @property
    def solids(self) -> dict[str, RigidDofs[BlockAssembly3D]]:
        """Three-dimensional assemblies of `blocks`."""
        return dofs_of_kind(self.blocks, BlockAssembly3D)

    @property
    def crushing(self) -> Ints:
        """Unknowns of points that crush, see `RigidDofs`; none of them acts on two points."""
        own = [dofs.crushing for dofs in self.blocks.values()]
        return np.concatenate([np.zeros(0, dtype=np.int64), *own])

    @property
    def jumping(self) -> list[Jumps]:
        """All velocity jumps."""
        return [*self.jumps.values(), *self.seams.values()]

    @property
    def contents(self) -> str:
        """``576 elements, 2401 unknowns, 12 contact points``."""
        return sized(self.n_elements, self.program.n, self.program.contact.count)

    def facts(self) -> Facts:
        """Return the size and contents, for printing."""
        natural, free = self.natural, counted(self.program.n, "free unknown")
        told = {
            "size": f"{self.contents}; {self.full.n} unknowns with those that are held",
            "bodies": listed(self.problem.bodies),
            "contact": listed(self.points.names) or "none",
            "scales": f"{natural.length:.4g} m, {natural.stress:.4g} Pa",
        }
        if needed := velocity_memory({name: dofs.body for name, dofs in self.continua.items()}):
            told["memory"] = told_memory(needed)
        return Facts(f"Discretisation: {free}, of {self.scope.value}", told)

    def picture(self) -> Picture:
        """Return the picture of the problem."""
        return Picture(self.problem.plot(), "the problem")

    @property
    def n_elements(self) -> int:
        """Elements of meshes, rigid blocks and rigid pieces of members."""
        elements = sum(dofs.body.mesh.nelements for dofs in self.continua.values())
        blocks = sum(len(dofs.body.names) for dofs in self.blocks.values())
        return int(elements) + blocks + sum(f.body.pieces.start.size for f in self.frames.values())
