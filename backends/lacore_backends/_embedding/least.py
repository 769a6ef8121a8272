"""Smallest program with every kind of row, solved once to compile all loops.

If no compiled code is cached, numba takes seconds to compile the loops, and longer on a busy
machine. During a solve this time would count to its time limit.
"""

import numpy as np
from scipy.sparse import csr_matrix

from lacore.program import ContactRows, DissipationGroup, FrozenContact, KinematicProgram

_CONES, _POINTS = 2, 4
_N = 2 * _CONES + _POINTS


def least_program() -> tuple[KinematicProgram, FrozenContact]:
    """Return a small program with a positive load, and its contact.

    Its cones keep their volume, and its contact points rub, dilate and stick.
    """
    rows = np.eye(_N)
    volumes = np.zeros((_CONES, _N))
    volumes[:, 0] = 0.5
    volumes[:, 2] = -0.5
    group = DissipationGroup(
        name="cones",
        rows=csr_matrix(rows[: 2 * _CONES]),
        dim=2,
        weights=np.ones(_CONES),
        bound=np.ones(_CONES),
        volumetric=csr_matrix(volumes),
        volumetric_factor=0.5,
    )
    zero = np.zeros(_POINTS)
    contact = ContactRows(
        normal=csr_matrix(rows[:_POINTS]),
        tangential=csr_matrix(rows[2 * _CONES :]),
        tangent_dim=1,
        weights=np.ones(_POINTS),
        coefficient=zero,
        limit=zero,
        dilatancy=zero,
        interface=zero.astype(int),
    )
    frozen = FrozenContact(np.array([1.0, 1.0, 0.0, np.inf]), np.array([0.0, 0.5, 0.5, 0.0]), zero)
    return KinematicProgram((group,), contact, np.ones(_N), np.zeros(_N)), frozen
