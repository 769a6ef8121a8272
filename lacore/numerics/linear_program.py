"""Linear programs of proofs, by the vertex method of HiGHS, with exact zeros at any scale."""

from typing import Any

import numpy as np
from scipy.sparse import csr_matrix

from lacore.numerics.arrays import Floats, Sparse

_SHARP = 1e-10  # tolerance of rows and reduced costs: the smallest of HiGHS
_SECONDS = 60.0


def least(
    cost: Floats,
    *,
    at_most: tuple[Sparse, Floats],
    equal: tuple[Sparse, Floats],
    lower: Floats,
    upper: Floats,
) -> Floats | None:
    """Minimise ``cost.x`` subject to ``A x <= b``, ``E x = d``, ``lower <= x <= upper``.

    Args:
        cost: shape (n,).
        at_most: A and b.
        equal: E and d.
        lower, upper: shape (n,), may be infinite.

    Returns:
        The solution x, or None without one.
    """
    (over, most), (even, value) = at_most, equal
    given: dict[str, Any] = {
        "A_ub": csr_matrix(over) if over.shape[0] else None,
        "b_ub": most if over.shape[0] else None,
        "A_eq": csr_matrix(even) if even.shape[0] else None,
        "b_eq": value if even.shape[0] else None,
        "bounds": np.stack([lower, upper], axis=1),
        "options": {
            "primal_feasibility_tolerance": _SHARP,
            "dual_feasibility_tolerance": _SHARP,
            "time_limit": _SECONDS,
        },
    }
    # Import it here, because it takes a third of a second to load and few problems need it.
    from scipy.optimize import linprog

    found = linprog(cost, method="highs", **given)
    return None if found.x is None else np.array(found.x, dtype=float)
