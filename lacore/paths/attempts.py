"""Attempts at a step: until its error is accepted, and up to where a body touches itself."""

from __future__ import annotations

from dataclasses import replace

from lacore.paths.contact.folding import Fold, first_fold
from lacore.paths.pace import Pace
from lacore.paths.schemes import FoldedError, Here, Scheme, Stride, Walk, require_upright

_AHEAD = 1e-5  # of a step that ends that much before a body touches itself, so that it is a mesh
_SHORTEST = 1e-9  # of a step: no shorter part of it is tried


def whole_or_to_fold(
    walk: Walk, scheme: Scheme, here: Here, distance: float, pace: Pace
) -> tuple[Stride, Here, float, Fold | None]:
    """Return the step that the pace accepts, where it leads, and the fold that ends it.

    An element that would turn over comes first: new meshes may follow. The third value is the least
    Jacobian, see `require_upright`.

    Args:
        walk, scheme, pace: of the path.
        here: where the step begins.
        distance: of the first attempt.

    Raises:
        PathEndError: the path ends before the step.
    """
    shortest = _SHORTEST * distance
    while True:
        try:
            stride = scheme(walk, here, distance)
            if not pace.accepts(stride.error):
                distance = pace.shorter(distance, stride.error)
                continue
        except FoldedError as stop:
            if distance < shortest:
                raise
            distance *= stop.fold.share / (1 + _AHEAD / 2)
            continue
        moves = {name: stride.duration * v for name, v in stride.flow.velocity.items()}
        configuration = here.configuration.moved(moves, stride.strained)
        there = Here(
            step=here.step + 1,
            travel=here.travel + distance,
            configuration=configuration,
            velocity=stride.flow.velocity,
            strain_rate=stride.flow.strain_rate,
            speed=stride.speed,
            growth=1.0 if here.velocity is None else stride.speed / here.speed,
        )
        jacobian = require_upright(walk.stage, configuration)
        further = {name: (1 + _AHEAD) * moved for name, moved in moves.items()}
        beyond = here.configuration.moved(further, stride.strained)
        stage = walk.stage
        before, after = stage.meshes_at(here.configuration), stage.meshes_at(beyond)
        fold = first_fold(before, after, stage.pairs)
        if fold is not None:
            fold = replace(fold, share=(1 + _AHEAD) * fold.share)
        if fold is None or fold.share > 1 or distance < shortest:
            return stride, there, jacobian, fold
        distance *= fold.share / (1 + _AHEAD / 2)
