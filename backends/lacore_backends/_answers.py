"""What solvers of the regularised program answer. Not a backend."""

from lacore.program.regularization import RegularisedPoint
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution


def told(
    point: RegularisedPoint, status: Status, native: str, iterations: int, seconds: float
) -> InnerSolution:
    """Of a solver that ended at a point, the values of which are told whatever its status is."""
    return InnerSolution(
        status=status,
        native_status=native,
        iterations=iterations,
        solve_time=seconds,
        point=point.state if status.has_point else None,
        regularised=point.values,
    )
