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
    equal: tuple[Sparse, Floats],
    lower: Floats,
    upper: Floats,
    at_most: tuple[Sparse, Floats] | None = None,
) -> Floats | None:
    """Minimise ``cost.x`` subject to ``E x = d``, ``lower <= x <= upper``, ``A x <= b``.

    Args:
        cost: shape (n,).
        equal: E and d.
        lower, upper: shape (n,), may be infinite.
        at_most: A and b; None: none.

    Returns:
        The solution x, or None without one.
    """
    even, value = equal
    given: dict[str, Any] = {
        "A_eq": csr_matrix(even) if even.shape[0] else None,
        "b_eq": value if even.shape[0] else None,
        "bounds": np.stack([lower, upper], axis=1),
        "options": {
            "primal_feasibility_tolerance": _SHARP,
            "dual_feasibility_tolerance": _SHARP,
            "time_limit": _SECONDS,
        },
    }
    if at_most is not None and at_most[0].shape[0]:
        given |= {"A_ub": csr_matrix(at_most[0]), "b_ub": at_most[1]}
    # Import it here, because it takes a third of a second to load and few problems need it.
    from scipy.optimize import linprog

    found = linprog(cost, method="highs", **given)
    return None if found.x is None else np.array(found.x, dtype=float)
