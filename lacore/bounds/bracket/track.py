"""Meshes on their way: what was solved on them, and how much finer the next ones are."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import ceil, log
from typing import Any

import numpy as np
from skfem import MeshTri

from lacore.bounds.bracket.asking import Bound
from lacore.bounds.bracket.whole import mesh_of, on_mesh, with_jumps
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats

RECENT = 2  # refinements whose gains count
_LOCKED = 2  # meshes without an upper bound, after which velocities jump
_SMALL = 0.5  # of the elements of the other mesh: below it a solve costs little
_GROWTH = 3.4  # of a mesh at most: marks see no further ahead
_LEAST_GROWTH = 1.2  # below it a solve is not worth its time
_FAR = 1e6  # times the elements: farther nobody looks
_ORDERS = (0.7, 2.0)  # of widths in elements: even meshes have 0.45, adapted ones 1.0 to 1.3
_COST = 1.25  # power of elements with which the time of a solve rises
_LEAST_REST = 0.1  # of the largest: what any mesh leaves to gain, as bounds rise in steps
# Of the target, where the last meshes are to land, one or two: a miss takes another round, and two
# go farther than they are asked to.
_AIM = {1: 0.94, 2: 0.97}


@dataclass(frozen=True)
class Track:
    """A mesh on its way, and the bounds that are solved on it.

    Attributes:
        kinds: ``lower``, ``upper`` or both.
        problem: on the mesh.
        last: bounds on it, by kind.
        gains: what refinements gained, in the unit of load factors.
        times: how many times the elements there were after each of them.
        seconds: of the last solves.
        too_fine: whether the next mesh has too many elements.
        late: elements of the next mesh, of which a solve would end too late; else 0.
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
        """Of all bodies, as one."""
        return mesh_of(self.problem)

    @property
    def elements(self) -> int:
        """Of the mesh."""
        return int(self.mesh.nelements)

    @property
    def rests(self) -> tuple[float, ...]:
        """What the last refinements left to gain, if errors fall as elements rise."""
        every = zip(self.gains[-RECENT:], self.times[-RECENT:], strict=True)
        return tuple(gain / (times - 1) for gain, times in every)

    @property
    def rest(self) -> float:
        """What is left to gain, the most by the last ones: bounds rise in steps; NaN while new."""
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
        """On the next mesh, with the bounds found there and what they gained."""
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
        problem: on the last mesh.
        mesh: the next one.
        rows: of the history of a bracket.
    """
    solved = [row["solved"] for row in rows if row["bound"] == "upper"]
    locked = len(solved) >= _LOCKED and not np.any(np.isfinite(solved))
    return with_jumps(on_mesh(problem, mesh)) if locked else on_mesh(problem, mesh)


def order(seen: Sequence[tuple[int, float]]) -> float:
    """At which widths fall as elements rise: half what the last refinements say, half 1.

    It changes from one to the next, and tends to 1.

    Args:
        seen: elements of all meshes and width of the bracket, after each round.
    """
    recent = [(elements, width) for elements, width in seen if np.isfinite(width)][-RECENT - 1 :]
    if not recent or recent[-1][0] <= recent[0][0]:
        return 1.0
    (few, wide), (many, narrow) = recent[0], recent[-1]
    return (1 + float(np.clip(np.log(wide / narrow) / np.log(many / few), *_ORDERS))) / 2


def growths(
    tracks: Sequence[Track], missing: float, order: float, apart: float = 0.0
) -> list[float]:
    """Of the next meshes, 1 of those that stay: in even steps to where all land on the target.

    There what meshes leave to gain adds up to the target, and their solves take the least time:
    ``sum e_k n_k^-p`` is given, ``sum N_k^q n_k^q`` least where ``n_k ~ (e_k/N_k^q)^(1/(p+q))``,
    for rests e_k, elements N_k and growths n_k.

    Args:
        tracks: those that go on.
        missing: width of the bracket per that which is asked for; inf while there is none.
        order: p, at which widths fall.
        apart: part of the width that their refinement does not take away.
    """
    rests = np.array([track.rest for track in tracks])
    elements = np.array([track.elements for track in tracks], dtype=float)
    aim = _AIM[len(tracks)]
    if not (np.all(np.isfinite(rests)) and rests.max() > 0 and np.isfinite(missing)):
        small = int(np.argmin(elements))
        alone = elements[small] < _SMALL * elements.max() and not np.isfinite(rests[small])
        every = np.full(len(tracks), max(missing / aim, 1.0) ** (1 / order))
        return _in_steps(np.where(np.arange(len(tracks)) == small, every, 1.0) if alone else every)
    rests = np.maximum(rests, _LEAST_REST * rests.max())
    rests *= (1 - apart) * missing / rests.sum()
    wanted = aim * max(1 - apart * missing, _LEAST_REST)
    shape = (rests / elements**_COST) ** (1 / (order + _COST))
    more, stays = shape, np.zeros(len(tracks), dtype=bool)
    for _ in tracks:  # those that would become coarser stay, and the others make up for it
        left = max(wanted - rests[stays].sum(), _LEAST_REST * wanted)
        scale = float(np.sum((rests * shape**-order)[~stays])) / left
        more = np.where(stays, 1.0, shape * scale ** (1 / order))
        stays |= more < 1.0
    return _in_steps(np.maximum(more, 1.0))


def _in_steps(more: Floats) -> list[float]:
    """Growths on the way to so many times the elements; at least the largest is worth a solve."""
    steps = max(ceil(log(min(more.max(), _FAR)) / log(_GROWTH)), 1)
    even = np.minimum(more ** (1 / steps), _GROWTH)
    even[np.argmax(even)] = max(even.max(), _LEAST_GROWTH)
    return [float(own) if own >= _LEAST_GROWTH else 1.0 for own in even]
