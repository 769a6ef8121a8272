"""Forces of contact on the rigid blocks of a path: what tools feel."""

import numpy as np
import pandas as pd

from lacore.limit.state import LimitState


def block_forces(state: LimitState) -> pd.DataFrame:
    """Resultants of contact on each rigid block, one row a block.

    Columns ``body``, ``f_x`` and ``f_y`` [N/m], and ``moment`` [N], anticlockwise: about the
    centroid, of a `Tool` about its reference point.
    """
    d, point, rows = state.discretisation, state.point, []
    assert point is not None
    contact = d.full.contact
    across = contact.weights * point.normal_reaction
    along = contact.weights[:, None] * point.tangential_reaction
    force = contact.normal.T @ across + contact.tangential.T @ along.ravel()
    for name, dofs in d.assemblies.items():
        f_x, f_y, turning = np.asarray(force)[dofs.offset : dofs.offset + dofs.count]
        moment = turning * dofs.body.radius[0]
        rows.append({"body": name, "f_x": f_x, "f_y": f_y, "moment": moment})
    return pd.DataFrame(rows, columns=["body", "f_x", "f_y", "moment"])
