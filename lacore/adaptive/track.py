"""Meshes on their way: what was solved on them, and how much finer the next ones are."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import ceil, log

import numpy as np
from skfem import MeshTri

from lacore.adaptive.asking import Bound
from lacore.adaptive.whole import mesh_of
from lacore.problem.problem import Problem

RECENT = 2  # refinements whose gains count
_SMALL = 0.5  # of the elements of the other mesh: below it a solve costs little
_AS_GOOD = 0.5  # of the best gain per element, with which a mesh is refined beside the best
_GROWTH = 3.0  # of a mesh at most: marks see no further ahead
_LEAST_GROWTH = 1.2
_ORDERS = (0.7, 1.3)  # of widths in elements: even meshes have 0.45, adapted ones 1.0 to 1.3


@dataclass(frozen=True)
class Track:
    """A mesh on its way, and the bounds that are solved on it.

    Attributes:
        kinds: ``lower``, ``upper`` or both.
        problem: on the mesh.
        last: bounds on it, by kind.
        gains: what the last refinements gained, in the unit of load factors.
        rests: what they leave to gain, if errors fall as elements rise.
        seconds: of the last solves.
        too_fine: whether the next mesh has too many elements.
        late: elements of the next mesh, of which a solve would end too late; else 0.
    """

    kinds: tuple[str, ...]
    problem: Problem
    last: Mapping[str, Bound] = field(default_factory=dict)
    gains: tuple[float, ...] = ()
    rests: tuple[float, ...] = ()
    seconds: float = 0.0
    too_fine: bool = False
    late: int = 0

    @property
    def mesh(self) -> MeshTri:
        """Of all bodies, as one."""
        return mesh_of(self.problem)

    @property
    def elements(self) -> int:
        """Of the mesh."""
        return int(self.mesh.nelements)

    @property
    def rate(self) -> float:
        """Largest recent gain per element: bounds rise in steps. What is new goes first."""
        return max(self.gains[-RECENT:], default=np.inf) / self.elements

    def moved(
        self,
        problem: Problem,
        found: Mapping[str, Bound],
        gained: Mapping[str, float],
        seconds: float,
    ) -> "Track":
        """On the next mesh, with the bounds found there and what they gained."""
        last = {kind: found[kind] for kind in self.kinds if kind in found}
        gain = sum(gained[kind] for kind in self.kinds)
        gains, rests = self.gains, self.rests
        if np.isfinite(gain):
            gains = (*gains, gain)
            rests = (*rests, gain / (mesh_of(problem).nelements / self.elements - 1))
        return replace(self, problem=problem, last=last, gains=gains, rests=rests, seconds=seconds)


def next_round(open_: Sequence[int], tracks: Sequence[Track]) -> list[int]:
    """The mesh that promises more, or costs little, and the others that promise about as much."""
    small = min(open_, key=lambda number: tracks[number].elements)
    if tracks[small].elements < _SMALL * max(tracks[number].elements for number in open_):
        return [small]
    best = max(tracks[number].rate for number in open_)
    return [number for number in open_ if not tracks[number].rate < _AS_GOOD * best]


def order(seen: Sequence[tuple[int, float]]) -> float:
    """At which widths fall as elements rise, in the last refinements; 1 before it is known.

    Args:
        seen: elements of all meshes and width of the bracket, after each round.
    """
    recent = [(elements, width) for elements, width in seen if np.isfinite(width)][-RECENT - 1 :]
    if not recent or recent[-1][0] <= recent[0][0]:
        return 1.0
    (few, wide), (many, narrow) = recent[0], recent[-1]
    return float(np.clip(np.log(wide / narrow) / np.log(many / few), *_ORDERS))


def growth(missing: float, order: float) -> float:
    """Of the next meshes, in even steps to the target.

    Args:
        missing: width of the bracket per that which is asked for; inf while there is none.
        order: at which widths fall.
    """
    if not np.isfinite(missing):
        return _GROWTH
    more = max(missing, 1.0) ** (1 / order)
    steps = max(ceil(log(more) / log(_GROWTH)), 1)
    return max(float(more ** (1 / steps)), _LEAST_GROWTH)
