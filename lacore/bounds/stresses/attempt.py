"""One solve for a lower bound, and what its stresses prove when made admissible (T26c)."""

import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from lacore.bounds.constants import EXCESS_REMOVED, LOSS_PER_GAP, SCALING_LOSS
from lacore.bounds.stresses.admissible import lacking, scaled, within_friction
from lacore.bounds.stresses.within_strength import within_strength
from lacore.program.certificate import Certificate
from lacore.program.kinematic import KinematicProgram, associated_contact
from lacore.program.projection import alike, by_area, onto_equilibrium
from lacore.program.state import ProgramState
from lacore.solvers.backend import InnerSolution


@dataclass(frozen=True)
class Attempt:
    """One inner solve, and the state made from it, in the units of the program.

    Attributes:
        margin: reduction of all strengths.
        inner: answer of the backend.
        state: the state made from it; None if there is no point.
        before, after: certificates of the point and of the state.
        lacks: see `lacore.bounds.stresses.admissible.lacking`.
        projection_time: s, wall clock, certificates included.
        exact: residual that counts as zero.
    """

    margin: float
    inner: InnerSolution
    state: ProgramState | None
    before: Certificate | None
    after: Certificate | None
    lacks: float
    projection_time: float
    exact: float

    @property
    def proves(self) -> bool:
        """Whether the state is admissible."""
        return self.after is not None and _proves(self.after, self.exact)

    def row(self, scale: float) -> dict[str, Any]:
        """Return a row of the history; load factors in SI units."""
        solved, proven = (
            np.nan if state is None else state.load_factor * scale
            for state in (self.inner.point, self.state if self.proves else None)
        )
        row: dict[str, Any] = {"margin": self.margin, "solved": solved, "load_factor": proven}
        for suffix, seen in (("_solved", self.before), ("", self.after)):
            if seen is not None:
                row |= {f"{name}{suffix}": value for name, value in asdict(seen).items()}
        return row | {
            "inner_status": self.inner.status.label,
            "native_status": self.inner.native_status,
            "inner_iterations": self.inner.iterations,
            "solve_time": self.inner.solve_time,
            "projection_time": self.projection_time,
            "peak_memory": self.inner.peak_memory,
        }


def attempt(
    program: KinematicProgram,
    less: KinematicProgram,
    margin: float,
    inner: InnerSolution,
    exact: float,
) -> Attempt:
    """Make the state of an answer admissible and certify it.

    Args:
        program: dimensionless program.
        less: the solved program, with strengths reduced by a margin.
        margin: the reduction.
        inner: the answer.
        exact: residual that counts as zero.
    """
    if inner.point is None:
        return Attempt(margin, inner, None, None, None, 0.0, 0.0, exact)
    begin = time.perf_counter()
    laws = associated_contact(program.contact)
    before = Certificate.of(program, inner.point, laws)
    scalable = not np.any(program.dead_load)
    worth, aim = (
        (max(SCALING_LOSS, LOSS_PER_GAP * before.gap), EXCESS_REMOVED) if scalable else (0.0, 0.0)
    )
    point = within_friction(program, inner.point, margin)

    def candidates() -> Iterator[ProgramState]:
        # Reactions may leave their cones as stresses are moved; then those of the projection count.
        for moves in (alike, by_area):
            with onto_equilibrium(program, point, moves) as nearest:
                projected = nearest(point)
                moved = within_strength(program, less, projected, nearest, worth, aim)
            yield moved
            if moved is not projected:
                yield projected

    for found in candidates():
        state = scaled(program, found) if scalable else found
        after = Certificate.of(program, state, laws)
        if _proves(after, exact):
            break
    return Attempt(
        margin,
        inner,
        state,
        before=before,
        after=after,
        lacks=lacking(program, state),
        projection_time=time.perf_counter() - begin,
        exact=exact,
    )


def _proves(seen: Certificate, exact: float) -> bool:
    return seen.equilibrium <= exact and seen.yield_violation <= 0 and seen.cone <= 0
