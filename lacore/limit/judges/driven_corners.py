"""Whether a mechanism drives corners of blocks into each other, where nothing models contact."""

import numpy as np

from lacore.assembly.discretisation import Discretisation
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.blocks.dofs import RigidDofs
from lacore.numerics.arrays import Floats
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.text import Quantity


def driven_corners(
    discretisation: Discretisation, velocity: Floats | None, tolerance: float
) -> Finding | None:
    """Return which corners a velocity drives together, the worst of them; None without any.

    Args:
        discretisation: of the problem.
        velocity: all unknowns, shape (n,); None where it is not known: any may be driven together.
        tolerance: of the largest velocity.
    """
    known = velocity is not None
    if velocity is None:
        velocity = np.where(np.diff(discretisation.free_basis.indptr) > 0, np.nan, 0.0)
    least = tolerance * float(np.abs(velocity).max(initial=0.0)) if known else 0.0
    for name, dofs in discretisation.assemblies.items():
        meetings = dofs.body.meetings
        opening = meetings.opening(_relative(dofs, velocity))
        driven = np.flatnonzero(~(opening >= -least))
        if driven.size:
            worst = driven[np.argmin(opening[driven])]
            one, other = (
                dofs.body.names[block] for block in (meetings.first[worst], meetings.second[worst])
            )
            kind = Kind.CORNERS_DRIVEN if known else Kind.CORNERS_MAY_BE_DRIVEN
            place = Quantity(tuple(meetings.place[:, worst].tolist()), "m", ".6g")
            values = {"one": one, "other": other, "place": place, "count": driven.size}
            return Finding(kind, (name,), values, Severity.REASON)
    return None


def _relative(dofs: RigidDofs[BlockAssembly], velocity: Floats) -> Floats:
    """Velocities of the first of two blocks against the second where corners meet, (2, k)."""
    meetings = dofs.body.meetings
    own, other = (
        np.stack([rows @ velocity for rows in dofs.velocity_rows(b, meetings.place, velocity.size)])
        for b in (meetings.first, meetings.second)
    )
    return np.asarray(own - other)
