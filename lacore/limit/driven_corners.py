"""Whether a mechanism drives corners of blocks into each other, where nothing models contact."""

import numpy as np

from lacore.arrays import Floats
from lacore.assembly.discretisation import Discretisation
from lacore.bodies.blocks.block_assembly import BlockAssembly
from lacore.bodies.blocks.dofs import RigidDofs


def driven_corners(
    discretisation: Discretisation, velocity: Floats | None, tolerance: float
) -> str:
    """In words which corners a velocity drives together, the worst first; empty where none.

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
            x, y = meetings.place[:, worst]
            does = "drives" if known else "may drive"
            return (
                f"of {name!r} the mechanism {does} corners of {one!r} and {other!r} into each other"
                f" at ({x:.6g}, {y:.6g}) (such corners: {driven.size}), and contact at corners is"
                " not modelled: cut one off, so that edges touch there"
            )
    return ""


def _relative(dofs: RigidDofs[BlockAssembly], velocity: Floats) -> Floats:
    """Velocities of the first of two blocks against the second where corners meet, (2, k)."""
    meetings = dofs.body.meetings
    own, other = (
        np.stack([rows @ velocity for rows in dofs.velocity_rows(b, meetings.place, velocity.size)])
        for b in (meetings.first, meetings.second)
    )
    return np.asarray(own - other)
