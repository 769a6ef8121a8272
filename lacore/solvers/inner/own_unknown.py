"""Programs with one more, separate unknown, as needed for rays and shares."""

from dataclasses import replace

import numpy as np
from scipy.sparse import csr_matrix

from lacore.numerics.arrays import Sparse
from lacore.program.kinematic import DissipationGroup, KinematicProgram


def with_own_unknown(
    program: KinematicProgram, name: str, reference: float = 0.0, dead: float = 0.0
) -> KinematicProgram:
    """Append an unknown that dissipates its size.

    Args:
        program: Program in any units.
        name: Name of its group, the last one.
        reference, dead: Forces of the loads on it.
    """
    n = program.n

    def wide(rows: Sparse) -> Sparse:
        return csr_matrix((rows.data, rows.indices, rows.indptr), (rows.shape[0], n + 1))

    own, none = csr_matrix(([1.0], ([0], [n])), (1, n + 1)), csr_matrix((1, n + 1))
    alone = DissipationGroup(name, own, 1, np.ones(1), np.ones(1), none, 0.0)
    rows = program.contact
    return replace(
        program,
        groups=(
            *(
                replace(group, rows=wide(group.rows), volumetric=wide(group.volumetric))
                for group in program.groups
            ),
            alone,
        ),
        contact=replace(rows, normal=wide(rows.normal), tangential=wide(rows.tangential)),
        reference_load=np.append(program.reference_load, reference),
        dead_load=np.append(program.dead_load, dead),
        parts=np.append(program.part, program.part.max(initial=-1) + 1),
    )
