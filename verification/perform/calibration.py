"""A short solve that is always the same: the scatter of its times is the noise of the machine."""

import time
from collections.abc import Callable
from math import inf, nan

import lacore as la
from lacore.program import associated_contact, dimensionless
from lacore.solvers.registry import CALIBRATION, own_backend

_LEAST_PAUSE = 100.0  # of its own time, between two of these solves: they take at most 1 %


class Calibration:
    """The solve, repeated now and then in one process; it is prepared when it is first needed."""

    def __init__(self) -> None:
        self._solve: Callable[[], object] | None = None
        self._due = -inf

    def seconds(self) -> float:
        """Solve again; return the time that it took, s, or NaN if it was done a short time ago."""
        if time.perf_counter() < self._due:
            return nan
        if self._solve is None:
            self._solve = _prepared()
            self._solve()  # the first one loads libraries and fills caches
        begin = time.perf_counter()
        self._solve()
        end = time.perf_counter()
        self._due = end + _LEAST_PAUSE * (end - begin)
        return end - begin


def _prepared() -> Callable[[], object]:
    """A footing on clay with a backend of lacore, in this process."""
    backend = own_backend(CALIBRATION)
    discretisation = la.discretise(la.examples.footing())
    program = dimensionless(discretisation.program, discretisation.natural).associated()
    contact = associated_contact(program.contact)
    solver = backend.prepare(program, backend.Options())
    return lambda: solver.solve(contact)
