"""Statuses, version and matrices of the IPOPT backends. Not a backend."""

from collections.abc import Mapping
from importlib.metadata import version
from typing import Any

import casadi as ca
from scipy.sparse import csc_matrix

from lacore.numerics.arrays import Sparse
from lacore.reporting.status import Status

# "Diverged" and "infeasible" are guesses of IPOPT; LOCKED and UNSAFE need evidence, which the
# backends check.
STATUS_MAP: Mapping[str, Status] = {
    "Solve_Succeeded": Status.SOLVED,
    "Solved_To_Acceptable_Level": Status.ALMOST_SOLVED,
    "Feasible_Point_Found": Status.ALMOST_SOLVED,
    "Search_Direction_Becomes_Too_Small": Status.STALLED,
    "Restoration_Failed": Status.STALLED,
    "Error_In_Step_Computation": Status.STALLED,
    "Maximum_Iterations_Exceeded": Status.ITERATION_LIMIT,
    "Maximum_CpuTime_Exceeded": Status.TIME_LIMIT,
    "Maximum_WallTime_Exceeded": Status.TIME_LIMIT,
    "Diverging_Iterates": Status.FAILED,
    "Infeasible_Problem_Detected": Status.FAILED,
    "User_Requested_Stop": Status.FAILED,
    "Not_Enough_Degrees_Of_Freedom": Status.FAILED,
    "Invalid_Problem_Definition": Status.FAILED,
    "Invalid_Option": Status.FAILED,
    "Invalid_Number_Detected": Status.FAILED,
    "Unrecoverable_Exception": Status.FAILED,
    "NonIpopt_Exception_Thrown": Status.FAILED,
    "Insufficient_Memory": Status.FAILED,
    "Internal_Error": Status.FAILED,
}


def unavailable() -> str:
    """Return why IPOPT cannot run; empty if it can."""
    if ca.has_nlpsol("ipopt"):
        return ""
    return "this CasADi was built without IPOPT; install it from PyPI (pip install casadi)"


def solver_version() -> str:
    """Return the name and version of the solver."""
    return f"IPOPT, CasADi {version('casadi')}"


def to_casadi(matrix: Sparse) -> Any:
    """Return a sparse matrix in the type of CasADi."""
    columns = csc_matrix(matrix)
    columns.sort_indices()
    pattern = ca.Sparsity(*columns.shape, columns.indptr.tolist(), columns.indices.tolist())
    return ca.DM(pattern, columns.data)
