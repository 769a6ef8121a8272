"""Paths of large deformation of cases (T29), and requirements on them."""

from __future__ import annotations  # Annotations are not evaluated, so they do not load lacore.

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf
from typing import TYPE_CHECKING

import lacore as la
from lacore.paths.ending import Ending
from lacore.reporting.errors import require_count, require_known, require_positive

if TYPE_CHECKING:
    from lacore.paths.control import Control
    from lacore.paths.renewal.remeshing import Remesh

ORDERS: Mapping[str, float] = {
    "explicit": 1.0,
    "leapfrog": 2.0,
    "implicit-euler": 1.0,
    "implicit-midpoint": 2.0,
}
"""p of ``error ~ steps**-p`` by scheme (T30)."""
ORDER_TOLERANCE = 0.15
"""Allowed error of p: effect of terms of higher order for steps of a tenth of the body size."""
STEPPING = ("steps", "scheme")
"""Parameters that each variant of a path has: number of steps, and name of the scheme."""
_LAST = {"explicit": 1.0, "leapfrog": 0.5}


@dataclass(frozen=True)
class Reading:
    """Another result of a path with its required range.

    Attributes:
        name: its name.
        of: function that reads it.
        low, high: required range.
    """

    name: str
    of: Callable[[la.Path], float]
    low: float = -inf
    high: float = inf


@dataclass(frozen=True)
class Following:
    """How a variant is followed.

    Attributes:
        travel: how far.
        steps: how many.
        scheme: of the steps.
        control: what the travel is of.
        exact: the load at a travel; None where it is not known.
        load: the column of the history that is the load: ``load_factor``, or ``force``, which does
            not feel to first order how large the face of a footing has become.
        approaching: interfaces with planes that bodies do not touch yet.
        ending: how the path must end; None: however it does.
        volume: largest change of volume of a step, of the volume, that is allowed.
        reading: what else is read; None for nothing.
        tools: tools of an exact shape that drive the path. Elsewhere the reference loads of the
            problem, and its rigid blocks of the same names, stand for them.
        remesh: makes new meshes on the way; None: the path ends where elements would invert.
        bounded: whether the load with which the path begins is to lie between strict bounds.
        ladder: numbers of steps over which the error must fall with the order of the scheme, at
            least four; none if not required.

    Raises:
        InputError: no travel, no number of steps, an unknown scheme.
    """

    travel: float
    steps: int
    scheme: str
    control: Control
    exact: Callable[[float], float] | None = None
    load: str = "load_factor"
    approaching: Sequence[la.Interface] = ()
    ending: Ending | None = Ending.REACHED
    volume: float = inf
    reading: Reading | None = None
    tools: Mapping[str, la.Tool] = field(default_factory=dict)
    remesh: Remesh | None = None
    bounded: bool = False
    ladder: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        require_positive("travel", self.travel)
        require_count("steps", self.steps)
        require_known("scheme", self.scheme, ORDERS)

    def problem(self, given: la.Problem) -> la.Problem:
        """Return a problem as the path takes it: without what stands for the tools elsewhere."""
        if not self.tools:
            return given
        return replace(
            given,
            bodies={name: own for name, own in given.bodies.items() if name not in self.tools},
            supports=[own for own in given.supports if own.body not in self.tools],
            interfaces=[
                own for own in given.interfaces if not any(n in self.tools for n, _ in own.sides)
            ],
            reference_loads=(),
        )

    @property
    def last(self) -> float:
        """Travel for which the last load is."""
        return last_load(self.travel, self.steps, self.scheme)


def last_load(travel: float, steps: int, scheme: str) -> float:
    """Return the travel at which the load of the last of equal steps is computed."""
    return travel * (1 - _LAST.get(scheme, 0.0) / steps)
