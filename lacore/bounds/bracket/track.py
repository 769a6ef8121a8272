"""Meshes during the refinement: their bounds, and the growth of the next ones."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import ceil, log
from typing import Any

import numpy as np
from skfem import MeshTri

from lacore.bounds.bracket.asking import Bound
from lacore.bounds.bracket.whole import mesh_of, on_mesh, with_jumps
from lacore.bounds.constants import (
    COST,
    LEAST_GROWTH,
    LEAST_REST,
    LOCKED_MESHES,
    MOST_GROWTH,
    ORDERS,
    RECENT,
    SMALL_MESH,
    TOTAL_GROWTH,
    WIDTH_AIMS,
)
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats


@dataclass(frozen=True)
class Track:
    """A mesh during the refinement, and the bounds computed on it.

    Attributes:
        kinds: ``lower``, ``upper`` or both.
        problem: problem on the mesh.
        last: bounds on it, by kind.
        gains: gains of the refinements, in the unit of load factors.
        times: growth of the elements in each of them.
        seconds: time of the last solves.
        too_fine: whether the next mesh has too many elements.
        late: elements of the next mesh if its solve would end too late; else 0.
    """

    kinds: tuple[str, ...]
    problem: Problem
    last: Mapping[str, Bound] = field(default_factory=dict)
    gains: tuple[float, ...] = ()
    times: tuple[float, ...] = ()
    seconds: float = 0.0
    too_fine: bool = False
    late: int = 0

    @property
    def mesh(self) -> MeshTri:
        """Joined mesh of all bodies."""
        return mesh_of(self.problem)

    @property
    def elements(self) -> int:
        """Number of elements of the mesh."""
        return int(self.mesh.nelements)

    @property
    def rests(self) -> tuple[float, ...]:
        """Remaining gains after the last refinements, if errors fall as elements grow."""
        every = zip(self.gains[-RECENT:], self.times[-RECENT:], strict=True)
        return tuple(gain / (times - 1) for gain, times in every)

    @property
    def rest(self) -> float:
        """Remaining gain, the largest of the last estimates as bounds rise in steps.

        NaN at first.
        """
        left = 0.0
        for rest, times in zip(self.rests, self.times[-RECENT:], strict=True):
            left = max(left / times, rest)
        return left if self.gains else np.nan

    def moved(
        self,
        problem: Problem,
        found: Mapping[str, Bound],
        gained: Mapping[str, float],
        seconds: float,
    ) -> "Track":
        """Return the track on the next mesh, with the bounds found there and their gains."""
        last = {kind: found[kind] for kind in self.kinds if kind in found}
        gain = sum(gained[kind] for kind in self.kinds)
        gains, times = self.gains, self.times
        if np.isfinite(gain):
            gains = (*gains, gain)
            times = (*times, mesh_of(problem).nelements / self.elements)
        return replace(self, problem=problem, last=last, gains=gains, times=times, seconds=seconds)


def on_finer(problem: Problem, mesh: MeshTri, rows: Sequence[Mapping[str, Any]]) -> Problem:
    """Return the problem on the next mesh, with velocities that jump if no upper bound was found.

    Where contact ends at a support in its direction, no mesh has a continuous mechanism. The first
    mesh may merely be too coarse, so that two meshes without an upper bound are required.

    Args:
        problem: problem on the last mesh.
        mesh: the next one.
        rows: rows of the history of a bracket.
    """
    solved = [row["solved"] for row in rows if row["bound"] == "upper"]
    locked = len(solved) >= LOCKED_MESHES and not np.any(np.isfinite(solved))
    return with_jumps(on_mesh(problem, mesh)) if locked else on_mesh(problem, mesh)


def order(seen: Sequence[tuple[int, float]]) -> float:
    """Return the order at which widths fall with elements: the mean of the last order and 1.

    The order changes between refinements, and tends to 1.

    Args:
        seen: elements of all meshes and width of the bracket, after each iteration.
    """
    recent = [(elements, width) for elements, width in seen if np.isfinite(width)][-RECENT - 1 :]
    if not recent or recent[-1][0] <= recent[0][0]:
        return 1.0
    (few, wide), (many, narrow) = recent[0], recent[-1]
    return (1 + float(np.clip(np.log(wide / narrow) / np.log(many / few), *ORDERS))) / 2


def growths(
    tracks: Sequence[Track], missing: float, order: float, apart: float = 0.0
) -> list[float]:
    """Return the growth factors of the next meshes, in even steps towards the target; 1 for none.

    At the target, the remaining gains of the meshes add up to it, and their solves take the least
    time: ``sum e_k n_k^-p`` is given, and ``sum N_k^q n_k^q`` is smallest where ``n_k ~
    (e_k/N_k^q)^(1/(p+q))``, for remaining gains e_k, elements N_k and growths n_k.

    Args:
        tracks: tracks to refine.
        missing: width of the bracket by the requested one; inf if there is none.
        order: p, at which widths fall.
        apart: part of the width that their refinement does not remove.
    """
    rests = np.array([track.rest for track in tracks])
    elements = np.array([track.elements for track in tracks], dtype=float)
    aim = WIDTH_AIMS[len(tracks)]
    known = bool(np.all(np.isfinite(rests))) and rests.max() > 0
    if not (known and apart < 1 and np.isfinite(missing)):
        small = int(np.argmin(elements))
        alone = elements[small] < SMALL_MESH * elements.max() and not np.isfinite(rests[small])
        every = np.full(len(tracks), max(missing / aim, 1.0) ** (1 / order))
        return _in_steps(np.where(np.arange(len(tracks)) == small, every, 1.0) if alone else every)
    rests = np.maximum(rests, LEAST_REST * rests.max())
    rests *= (1 - apart) * missing / rests.sum()
    wanted = aim * max(1 - apart * missing, LEAST_REST)
    shape = (rests / elements**COST) ** (1 / (order + COST))
    more, stays = shape, np.zeros(len(tracks), dtype=bool)
    for _ in tracks:  # Meshes that would become coarser are kept, and the others compensate for it.
        left = max(wanted - rests[stays].sum(), LEAST_REST * wanted)
        scale = float(np.sum((rests * shape**-order)[~stays])) / left
        more = np.where(stays, 1.0, shape * scale ** (1 / order))
        stays |= more < 1.0
    return _in_steps(np.maximum(more, 1.0))


def _in_steps(more: Floats) -> list[float]:
    """Return the growths of one step towards a total growth.

    The largest one must pay for a solve.
    """
    steps = max(ceil(log(min(more.max(), TOTAL_GROWTH)) / log(MOST_GROWTH)), 1)
    even = np.minimum(more ** (1 / steps), MOST_GROWTH)
    even[np.argmax(even)] = max(even.max(), LEAST_GROWTH)
    return [float(own) if own >= LEAST_GROWTH else 1.0 for own in even]
