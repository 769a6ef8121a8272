"""Pictures of rigid blocks, displaced by the mechanism."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection

from lacore.limit.state import LimitState
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.blocks.dofs import RigidDofs
from lacore.model.bodies.blocks.rigid_blocks import RigidBlocks
from lacore.numerics.arrays import Bools, Floats
from lacore.pictures.continua import BEFORE

FIXED = "#9a9a9a"
_FACE = "#ece7dc"
_AT_REST = 1e-3  # by the largest velocity
_MANY = 150  # number of blocks from which lines are thin


def held_blocks(state: LimitState, dofs: RigidDofs[RigidBlocks]) -> Bools:
    """Return which blocks have no velocity because of supports, shape (blocks,)."""
    basis = state.discretisation.free_basis[dofs.offset : dofs.offset + dofs.of_blocks]
    largest = np.asarray(abs(basis).max(axis=1).todense()).reshape(-1, dofs.per_block)
    return np.asarray(~np.any(largest > 0, axis=1))


def draw_blocks(axes: Axes, state: LimitState, stretch: float, fastest: float) -> None:
    """Draw blocks displaced by `stretch` (s) times their velocity, with dashed original outlines.

    Displacements are linear in the rotation, so that closed contact looks closed; blocks grow by
    half the square of their rotation.
    """
    for name, dofs in state.discretisation.assemblies.items():
        held, edges = held_blocks(state, dofs), dofs.body.edges
        velocity = dofs.velocity_at(state.velocity[name], edges.block, edges.start)
        moves = np.zeros(held.size, dtype=bool)
        moves[edges.block[np.linalg.norm(velocity, axis=0) > _AT_REST * fastest]] = True
        lines = np.stack([edges.start, edges.end], axis=1)[:, :, moves[edges.block]].T
        axes.add_collection(LineCollection(list(lines), **BEFORE, zorder=1))
        fill_blocks(axes, outlines(dofs, edges.start + stretch * velocity), held, 2.0)


def outlines(dofs: RigidDofs[BlockAssembly], vertices: Floats) -> list[Floats]:
    """Return the polygons (k, 2) of all blocks from the starts of their edges."""
    return np.split(vertices.T, np.flatnonzero(np.diff(dofs.body.edges.block)) + 1)


def fill_blocks(axes: Axes, polygons: list[Floats], held: Bools, zorder: float) -> None:
    """Draw polygons (k, 2) of blocks, with held ones dark and hatched."""
    thin = 0.9 if held.size < _MANY else 0.4
    free = [polygon for polygon, fixed in zip(polygons, held, strict=True) if not fixed]
    fixed = [polygon for polygon, fixed in zip(polygons, held, strict=True) if fixed]
    axes.add_collection(
        PolyCollection(free, facecolors=_FACE, edgecolors="#555555", linewidths=thin, zorder=zorder)
    )
    if fixed:
        axes.add_collection(
            PolyCollection(
                fixed,
                facecolors=FIXED,
                edgecolors="#666666",
                hatch="////",
                linewidths=thin,
                zorder=zorder - 0.1,
            )
        )
