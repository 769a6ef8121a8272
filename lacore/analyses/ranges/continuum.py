"""Bounds of every Coulomb load factor of the continuum (T14), by strict bounds of two problems."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import Any

from lacore.assembly.discretisation import Discretisation
from lacore.bounds.bracket.bracket import Ending
from lacore.bounds.bracket.refine import bracket
from lacore.bounds.enclosing import associated, frictionless
from lacore.bounds.lower import LowerBound, lower_bound
from lacore.bounds.upper import UpperBound, upper_bound
from lacore.reporting.errors import CapabilityError, InputError
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.reporting.showing import Compact
from lacore.reporting.status import Rigor


@dataclass(frozen=True, repr=False)
class ContinuumRange(Compact):
    """Two bounds of all Coulomb load factors of the continuum.

    Attributes:
        lower, upper: strict bounds of the problem without Coulomb friction and of that with
            associated friction; -inf and inf without a bound.
        missing: Why a bound is missing; empty if there are both.
    """

    lower: float
    upper: float
    missing: tuple[Finding, ...]


def continuum_range(
    stated: Discretisation,
    backend: str,
    options: Mapping[str, Any],
    target_width: float | None,
) -> ContinuumRange:
    """Return bounds on the mesh of the problem, or on refined meshes, see `lacore.bracket`.

    Args:
        stated: a problem with deformable bodies.
        backend: name of an exact backend.
        options: options of the backend, for bounds on the mesh of the problem.
        target_width: value of ``(upper - lower)/mean``; None: no refinement.

    Raises:
        InputError: a target for a problem without a bracket.
    """
    if stated.points.obstacles or not stated.program.homogeneous:
        return ContinuumRange(-inf, inf, (Finding(Kind.STEP_OF_PATH),))
    if stated.crushing.size:
        return ContinuumRange(-inf, inf, (Finding(Kind.CELLS_OF_JOINTS),))
    if target_width is not None:
        found = bracket(stated.problem, target_width, backend=backend)
        lower = -inf if found.lent else _strict(found.lower_bound)
        ends = lower, _strict(found.upper_bound)
        if found.status is Ending.CROSSED:
            ends = -inf, inf  # One of them is missing.
        both = ends[0] > -inf and ends[1] < inf
        return ContinuumRange(*ends, () if both else found.failures or found.lent or (_NOT_STRICT,))
    lower, upper, missing = -inf, inf, list[Finding]()
    try:
        below = lower_bound(frictionless(stated.problem), backend, options=options)
        lower = _strict(below)
        if lower == -inf:
            missing.append(_none("lower", _why(below, backend)))
    except (InputError, CapabilityError) as error:
        missing.append(_none("lower", error.text))
    try:
        above = upper_bound(associated(stated.problem), backend, options=options)
        upper = _strict(above)
        if upper == inf:
            missing.append(_none("upper", _why(above, backend)))
    except (InputError, CapabilityError) as error:
        missing.append(_none("upper", error.text))
    return ContinuumRange(lower, upper, tuple(missing))


_NOT_STRICT = Finding(Kind.STRAIGHT_EDGES)


def _none(side: str, why: Finding | str) -> Finding:
    return Finding(Kind.NO_BOUND, (side,), {"why": why})


def _strict(bound: LowerBound | UpperBound) -> float:
    """Return the load factor of a strict bound of the continuum, else an infinite one."""
    if isinstance(bound, LowerBound):
        return bound.load_factor if bound.rigor is Rigor.LOWER else -inf
    return bound.load_factor if bound.rigor is Rigor.UPPER else inf


def _why(bound: LowerBound | UpperBound, backend: str) -> Finding:
    if bound.rigor is Rigor.DISCRETE:
        return _NOT_STRICT
    return bound.unanswered(backend)
