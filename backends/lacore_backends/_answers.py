"""Answers of solvers of the regularised program. Not a backend."""

from lacore.program.regularization import RegularisedPoint
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution


def told(
    point: RegularisedPoint, status: Status, native: str, iterations: int, seconds: float
) -> InnerSolution:
    """Return the answer of a solver, with the values at its last point for every status."""
    return InnerSolution(
        status=status,
        native_status=native,
        iterations=iterations,
        solve_time=seconds,
        point=point.state if status.has_point else None,
        regularised=point.values,
    )
