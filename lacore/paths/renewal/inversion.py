"""Elements that a step would turn inside out (T31)."""

import numpy as np
from skfem import Mesh

from lacore.model.meshes.curved import signed_jacobians
from lacore.numerics.arrays import Floats
from lacore.paths.configuration import Configuration
from lacore.paths.ending import Ending, PathEndError
from lacore.paths.stage import Stage
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.text import Quantity

_INVERTED = 1e-3  # least Jacobian of an element, per its mean at the beginning of the path
_PARTS = 100  # of a motion, by which the message states when an element is inverted


def require_upright(
    stage: Stage, before: Configuration, after: Configuration, share: float = 1.0
) -> float:
    """Return the least Jacobian of all elements, divided by the mean over its element (T31).

    Args:
        stage: whose meshes move.
        before: where the step begins.
        after: where the elements are checked.
        share: of the step, in which they move from one to the other.

    Raises:
        PathEndError: It is not positive, so an element is inverted or may be.
    """
    least = np.inf
    begin = stage.meshes_at(before)
    for name, mesh in stage.meshes_at(after).items():
        each = _least(mesh, stage.turns[name])
        worst = int(np.argmin(each))
        least = min(least, float(each[worst]))
        if not each[worst] > _INVERTED:
            middle = tuple(mesh.p[:, mesh.t[:, worst]].mean(axis=1).tolist())
            upright = share * _upright(begin[name], mesh, stage.turns[name], worst)
            found = {
                "element": worst,
                "place": Quantity(middle, "m", ".4g"),
                "share": f"{100 * upright:.0f} %",
            }
            element = Finding(Kind.ELEMENT, (name,), found, Severity.DETAIL)
            raise PathEndError(Ending.INVERSION, element)
    return least


def _least(mesh: Mesh, turns: Floats) -> Floats:
    """The least Jacobian of each element, divided by its mean, shape (elements,)."""
    values = signed_jacobians(mesh) * turns[:, None]
    return np.asarray(values.min(axis=1) / np.abs(values.mean(axis=1)))


def _upright(before: Mesh, after: Mesh, turns: Floats, element: int) -> float:
    """Share of a motion along straight lines after which an element is inverted."""
    nodes, by = before.doflocs, after.doflocs - before.doflocs
    for part in range(_PARTS):
        moved = type(before)(nodes + part / _PARTS * by, before.t)
        if not _least(moved, turns)[element] > _INVERTED:
            return part / _PARTS
    return 1.0
