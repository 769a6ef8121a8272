"""Whether blocks touch what holds them: by edges, and each of them something."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from lacore.bodies.blocks.corners import resting_corners
from lacore.bodies.blocks.motions import moving_blocks
from lacore.bodies.blocks.rigid_blocks import RigidBlocks
from lacore.bodies.touching import Touched
from lacore.conditions.loads import Fix
from lacore.errors import InputError

if TYPE_CHECKING:
    from lacore.bodies.blocks.block_assembly import BlockAssembly


def check_contact(
    body: "BlockAssembly", field: str, supports: Sequence[Fix], touched: Sequence[Touched]
) -> None:
    """Refuse what no contact carries.

    Args:
        body: of a problem.
        field: its own, for messages.
        supports: of this body.
        touched: where interfaces touch it.

    Raises:
        InputError: a corner that rests on an edge or meets others with nothing but corners; an
            obstacle along an edge that has a joint; a block that touches nothing.
    """
    _check_corners(body, field, supports)
    for own in touched:
        if own.by_obstacle:
            _check_free(body, own)
    check_isolated(body, field, supports, touched, lambda _: "")


def _check_corners(body: "BlockAssembly", field: str, supports: Sequence[Fix]) -> None:
    """Refuse contacts at single points, which no joint carries: blocks would fall through."""
    places, blocks, others = resting_corners(body.edges, body.joints, body.allowed)
    if blocks.size:
        block, other = body.names[blocks[0]], body.names[others[0]]
        raise InputError(
            field,
            (block, other),
            f"a corner of {block!r} rests on an edge of {other!r} at {places[:, 0]} without a joint"
            f" (such corners: {blocks.size})",
            "cut the corner off, so that an edge rests there, or move the blocks apart",
        )
    met = body.meetings
    alone = np.flatnonzero(~met.linked)
    if not alone.size:
        return
    moving = moving_blocks(body, supports)
    alone = alone[np.isin(met.first[alone], moving) | np.isin(met.second[alone], moving)]
    if alone.size:
        block, other = body.names[met.first[alone[0]]], body.names[met.second[alone[0]]]
        raise InputError(
            field,
            (block, other),
            f"{block!r} and {other!r} touch at {met.place[:, alone[0]]} with nothing but corners"
            f" (such places: {alone.size}), where contact has no normal",
            "cut a corner off, so that edges touch there, or move the blocks apart",
        )


def _check_free(body: "BlockAssembly", touched: Touched) -> None:
    """No obstacle along an edge of a block that has a joint: the joint's block is there."""
    taken = np.intersect1d(touched.edges, body.jointed_edges)
    if taken.size:
        name = body.names[body.edges.block[taken[0]]]
        start, end = body.edges.start[:, taken[0]], body.edges.end[:, taken[0]]
        raise InputError(
            touched.field,
            touched.name,
            f"the edge of block {name!r} from {start} to {end} has a joint with another block",
            "select the edges that touch the obstacle by a function of coordinates",
        )


def check_isolated(
    body: RigidBlocks,
    field: str,
    supports: Sequence[Fix],
    touched: Sequence[Touched],
    why: Callable[[str], str],
) -> None:
    """Raise `InputError` unless each block touches something, or a support holds it.

    Args:
        body: an assembly.
        field, supports, touched: see `check_contact`.
        why: what else there is to say of a block that does not; empty of most.
    """
    if not body.isolated:
        return
    edges = [np.zeros(0, dtype=np.int64), *(own.edges for own in touched)]
    edges += [body.outline(support.where, "Fix.where") for support in supports]
    known = {body.names[block] for block in body.blocks_of(np.concatenate(edges))}
    loose = [block for block in body.isolated if block not in known]
    if loose:
        raise InputError(
            field,
            loose[0],
            "a block that touches nothing: no joint, no interface, no support"
            + (f"; {more}" if (more := why(loose[0])) else ""),
            "move it against its neighbours, or give it an interface or a support",
        )
