"""Checks that joints, interfaces and supports can carry the contact of rigid blocks."""

from collections.abc import Sequence

import numpy as np

from lacore.model.bodies.blocks.corners import resting_corners
from lacore.model.bodies.blocks.joints import Joints
from lacore.model.bodies.blocks.motions import moving_blocks
from lacore.model.bodies.blocks.polygons import BlockEdges
from lacore.model.bodies.blocks.rigid_blocks import RigidBlocks
from lacore.model.bodies.touching import Touched
from lacore.model.conditions.loads import Fix
from lacore.reporting.errors import InputError
from lacore.reporting.text import Quantity, text


def check_contact(
    body: RigidBlocks, field: str, supports: Sequence[Fix], touched: Sequence[Touched]
) -> None:
    """Reject contact that neither joints nor interfaces carry.

    Args:
        body: Assembly of a problem.
        field: Name of the assembly, for messages.
        supports: Supports of this assembly.
        touched: Where interfaces touch it.

    Raises:
        InputError: An obstacle acts on a facet that has a joint; two blocks meet without a joint
            where no other blocks keep them apart; a block touches nothing.
    """
    for own in touched:
        if own.by_obstacle:
            _check_unjointed(body, own)
    _check_meetings(body, field, supports)
    _check_isolated(body, field, supports, touched)


def check_resting_corners(
    edges: BlockEdges, joints: Joints, names: Sequence[str], tolerance: float, field: str
) -> None:
    """Reject corners that rest inside an edge: without a joint, blocks would fall through it.

    Args:
        edges: Edges of all outlines.
        joints: Joints of all blocks.
        names: Names of the blocks.
        tolerance: Distance up to which coordinates count as one, m.
        field: Name of the assembly, for messages.

    Raises:
        InputError: There is such a corner.
    """
    places, blocks, others = resting_corners(edges, joints, tolerance)
    if blocks.size:
        block, other = names[blocks[0]], names[others[0]]
        raise InputError(
            field,
            (block, other),
            f"a corner of {block!r} rests on an edge of {other!r} at {places[:, 0]} without a joint"
            f" (such corners: {blocks.size})",
            "cut the corner off, so that an edge rests there, or move the blocks apart",
        )


def _check_unjointed(body: RigidBlocks, touched: Touched) -> None:
    """Reject an obstacle on a facet that has a joint, because another block is there."""
    taken = np.intersect1d(touched.edges, body.jointed_facets)[:1]
    if taken.size:
        (block,), (centroid, *_) = body.blocks_of(taken), body.geometry_of(taken)
        raise InputError(
            touched.field,
            touched.name,
            text(
                "the {} of block {} about {} has a joint with another block",
                body.facet,
                repr(body.names[block]),
                Quantity(tuple(centroid[:, 0]), "m", ".6g"),
            ),
            f"select the {body.facet}s that touch the obstacle by a function of coordinates",
        )


def _check_isolated(
    body: RigidBlocks, field: str, supports: Sequence[Fix], touched: Sequence[Touched]
) -> None:
    """Reject a block that touches nothing and has no support."""
    if not body.isolated:
        return
    facets = [np.zeros(0, dtype=np.int64), *(own.edges for own in touched)]
    facets += [body.outline(support.where, "Fix.where") for support in supports]
    known = {body.names[block] for block in body.blocks_of(np.concatenate(facets))}
    loose = [block for block in body.isolated if block not in known]
    if loose:
        raise InputError(
            field,
            loose[0],
            "a block that touches nothing: no joint, no interface, no support",
            "move it against its neighbours, or give it an interface or a support",
        )


def _check_meetings(body: RigidBlocks, field: str, supports: Sequence[Fix]) -> None:
    """Reject blocks that can move and meet another one where no joint keeps them apart."""
    first, second, places = body.lone_meetings
    if not first.size:
        return
    moving = moving_blocks(body, supports)
    own = np.flatnonzero(np.isin(first, moving) | np.isin(second, moving))
    if own.size:
        one, other = (body.names[blocks[own[0]]] for blocks in (first, second))
        raise InputError(
            field,
            (one, other),
            text(
                "these blocks touch at {} with {} only, which makes no joint, and "
                "nothing else keeps them apart there (such places: {})",
                Quantity(tuple(places[:, own[0]]), "m", ".6g"),
                body.rim,
                own.size,
            ),
            f"cut {body.rim} off, so that {body.facet}s touch there, or move the blocks apart",
        )
