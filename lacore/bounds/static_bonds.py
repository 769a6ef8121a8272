"""Bonds of equilibrium elements: tractions of any size that are equal on both sides.

The multipliers of the facets of both sides are then the same, as those of an interior facet; those
of a facet on a rigid block are its motion. The weaker side yields at its own strength.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.bounds.equilibrium import EquilibriumDofs
from lacore.bounds.static_contact import selected, traction_station
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.blocks.dofs import RigidDofs
from lacore.model.conditions.elimination import NodeConditions, held, join
from lacore.model.contact.interfaces import Interface
from lacore.model.contact.segments import Segments
from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact


@dataclass(frozen=True, repr=False)
class StaticBonds(Compact):
    """Multipliers that follow others.

    Attributes:
        following: nodes, of two multipliers each, shape (k,).
        followed: the nodes that they follow, -1 for rigid blocks, shape (k,).
        rows: their values from all n multipliers: those of x, then those of y, shape (2 k, n).
    """

    following: Ints
    followed: Ints
    rows: Sparse

    @property
    def _unknowns(self) -> Ints:
        return np.concatenate([2 * self.following, 2 * self.following + 1])

    @property
    def conditions(self) -> NodeConditions:
        """Conditions that hold the following multipliers until `spread` sets them."""
        count = self.following.size
        return join([held(self.following, np.tile(axis, (count, 1))) for axis in np.eye(2)])

    def spread(self, basis: Sparse) -> Sparse:
        """Return a basis, shape (n, free), in which held multipliers follow the others."""
        if not self.following.size:
            return basis
        n, own = basis.shape[0], self._unknowns
        placed = csr_matrix((np.ones(own.size), (own, np.arange(own.size))), shape=(n, own.size))
        return csr_matrix(basis + placed @ (self.rows @ basis))

    def carried(self, velocity: Floats) -> Floats:
        """Return a velocity, shape (n,), with the mean of both sides on bonds, or a block's.

        Either side then gets half of the power of tractions on a jump; a body gets all of it on a
        bond with a block.
        """
        moved = velocity.copy()
        pair = self.followed >= 0
        for axis in (0, 1):
            own, other = 2 * self.following[pair] + axis, 2 * self.followed[pair] + axis
            moved[other] = (velocity[own] + velocity[other]) / 2
        moved[self._unknowns] = self.rows @ moved
        return moved


def static_bonds(
    interfaces: Sequence[Interface],
    segments: Sequence[Segments],
    bodies: Mapping[str, EquilibriumDofs],
    rigid: Mapping[str, RigidDofs[BlockAssembly]],
    conditions: NodeConditions,
    n: int,
) -> StaticBonds:
    """Return the multipliers that follow others through bonds.

    Args:
        interfaces, segments: interfaces of the problem.
        bodies, rigid: its continua and assemblies.
        conditions: conditions of supports and footings.
        n: number of multipliers.

    Raises:
        InputError: edges of both sides do not match, or a support or footing holds them.
    """
    following = followed = np.zeros(0, dtype=np.int64)
    x = y = csr_matrix((0, n))
    for index, (interface, own) in enumerate(zip(interfaces, segments, strict=True)):
        names = [name for name, _ in interface.sides]
        if not interface.bonded or len(names) < 2 or all(name in rigid for name in names):
            continue
        turned = interface.slave[0] in rigid
        station = traction_station(interface, own, index, bodies, rigid, n)
        nodes, others = station.moving.T[::-1] if turned else station.moving.T
        between = any(name in rigid for name in names)
        _check_free(
            np.concatenate([nodes, others[:0] if between else others]), conditions, interface
        )
        mine, jump = selected(nodes, n), station.axes
        sign = -1.0 if turned else 1.0
        facing = [csr_matrix(rows - sign * part) for rows, part in zip(mine, jump, strict=True)]
        for rows in facing:
            rows.eliminate_zeros()
        x, y = (vstack(part, format="csr") for part in zip((x, y), facing, strict=True))
        following = np.concatenate([following, nodes])
        followed = np.concatenate([followed, np.full_like(others, -1) if between else others])
    return StaticBonds(following, followed, csr_matrix(vstack([x, y], format="csr")))


def _check_free(nodes: Ints, conditions: NodeConditions, interface: Interface) -> None:
    if np.isin(nodes, conditions.nodes).any():
        raise InputError(
            "Problem.interfaces",
            interface.name,
            "a support or a footing holds edges that are bonded",
            "let it end before them",
        )
