"""Prove whether a structure stands under its dead loads, and which load factors it carries.

A load factor is *carried* if stresses and reactions within all strengths and friction cones are in
equilibrium with it and with the dead loads. The carried load factors form an interval. Outside it
no equilibrium exists, whatever the friction is. With Coulomb friction, which is non-associated, a
carried load may still have mechanisms (T14b), so the structure can stand but need not.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any
from warnings import warn

import numpy as np

from lacore.assembly.discretisation import Discretisation
from lacore.coupling.claims.carried import carried_end
from lacore.coupling.claims.dead_loads import DeadLoadProof, prove_dead_loads
from lacore.coupling.kinds import COUPLINGS
from lacore.limit import cells
from lacore.limit.carried import CarriedLoads, end_in_si, loads_between
from lacore.limit.constants import SAME_LOAD_FACTOR
from lacore.limit.conversion import point_in_si
from lacore.limit.judges.driven_corners import driven_corners
from lacore.limit.span_moments import span_excess
from lacore.program.kinematic import (
    associated_contact,
    dimensionless,
    require_homogeneous,
)
from lacore.program.state import ProgramState
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.reporting.showing import Facts
from lacore.reporting.status import Result, Standing, Status
from lacore.reporting.text import PYTHON, Reader
from lacore.solvers.backend import find_backend
from lacore.solvers.inner.preparing import preparer_named
from lacore.solvers.registry import PROVING_BACKEND

Verdict = tuple[Standing, tuple[Finding, ...]]
Conclude = Callable[[Standing, tuple[Finding, ...]], Verdict]
"""Returns the verdict to report, given what is proven of the discrete problem."""


@dataclass(frozen=True, repr=False)
class Stability(Result):
    """Proven behaviour of a structure under its dead loads, and the load factors that it carries.

    Attributes:
        standing: Behaviour under the dead loads alone.
        low, high: Ends of the load factors that are proven to be carried; NaN without any. With
            associated flow, if the structure stands, they are 0 and the load factor of the state.
            If it collapses, no load factor between 0 and these is carried.
        side: Side of the load factor of the state on which loads are carried: ``below``, ``above``
            or ``both``; empty if nothing is proven.
        point: State in SI units: stresses and reactions under the dead loads alone, without a
            velocity, if the structure stands; the mechanism, at ``Fd.u = 1``, if it collapses. None
            if this is undecided.
        residual: Largest residual of that proof; NaN if undecided.
        findings: Why it is undecided, or the conditions of the proof.
    """

    standing: Standing
    low: float
    high: float
    side: str
    point: ProgramState | None
    residual: float
    findings: tuple[Finding, ...] = ()

    @property
    def why(self) -> str:
        """The message, by the name of this attribute until 0.4."""
        warn("Stability.why is now Stability.message", DeprecationWarning, stacklevel=2)
        return self.message

    def facts(self) -> Facts:
        """Return the proven behaviour and the residual of the proof."""
        facts = {"findings": self.message} if self.findings else {}
        facts["carried"] = f"load factors {self.low:.7g} to {self.high:.7g}"
        if np.isnan(self.low):
            facts["carried"] = "no load factor is proven to be"
        facts["residual"] = f"largest {self.residual:.1e}"
        return Facts(f"Stability: {self.standing.label}: {self.standing.value}", facts)

    def text_for(self, reader: Reader) -> str:
        """Return the proven behaviour for a reader, without the label."""
        findings = self.report.text_for(reader)
        return f"{self.proven} ({findings})" if findings else self.proven

    def __str__(self) -> str:
        return f"{self.standing.label}: {self.text_for(PYTHON)}"

    @property
    def proven(self) -> str:
        """Proven behaviour, without the findings."""
        return f"{self.standing.value}{self._carried}"

    @property
    def _carried(self) -> str:
        """The load factors that are carried, as the end of a sentence."""
        if np.isnan(self.low):
            return "; no load factor is carried" if self.standing is Standing.FALLS else ""
        if self.low == self.high:
            return "" if self.low == 0 else f"; the load factor {self.low:.6g} is carried"
        loads = loads_between(self.low, self.high)
        if self.standing is Standing.STANDS:
            return f", as are {loads if loads.startswith('all') else f'all {loads}'}"
        return f"; {loads} are carried"


def stability_of(
    discretisation: Discretisation,
    backend: str,
    options: Mapping[str, Any],
    coupling: str,
    tolerance: float,
    load_factor: float,
    conclude: Conclude = lambda *proven: proven,
    carried: CarriedLoads | None = None,
) -> Stability:
    """Prove whether a structure stands under its dead loads, and which load factors it carries.

    It solves one conic program if the dead loads are carried or the carried loads are known, and
    up to four if not.

    Args:
        discretisation: Discretisation of the problem.
        backend, options: Backend and options of the state; a regularised backend is replaced by an
            exact one.
        coupling: Coupling of the state, whose laws define admissible reactions.
        tolerance: Tolerance for all residuals.
        load_factor: Load factor of the state, if its own stresses and reactions prove that it is
            carried; +inf for a locked load; NaN otherwise.
        conclude: Function that returns the verdict to report, given what is proven of the discrete
            problem.
        carried: Load factors with equilibrium, if the solve of the state computed them.

    Raises:
        InputError: The state belongs to a step of a path, which has a given speed.
        CapabilityError: The exact backend is missing.
    """
    require_homogeneous(
        discretisation.program,
        "LimitState.stability",
        "ask for the stability of a state of lacore.solve",
    )
    if find_backend(backend).capabilities.regularised:
        backend, options, load_factor = PROVING_BACKEND, {}, np.nan
    scaled = dimensionless(discretisation.program, discretisation.natural)
    kind = COUPLINGS[coupling]
    program = kind.program_of(scaled).associated()  # carried loads do not depend on flow
    rows = program.contact
    laws = kind.laws_of(rows) or associated_contact(rows)
    known = [load_factor] if not np.isnan(load_factor) else []
    prepare = preparer_named(backend, options)
    found = prove_dead_loads(program, laws, prepare, tolerance)
    standing, point, why = _proven(discretisation, found, tolerance)
    if carried is not None:
        known += [carried.low, carried.high]
    elif standing is Standing.STANDS:
        known = [0.0, *known]
    elif standing is Standing.FALLS:
        ends = (
            end_in_si(
                discretisation, carried_end(program, laws, sign, prepare, tolerance), tolerance
            ).load_factor
            for sign in (1.0, -1.0)
        )
        proven = [end for end in ends if not np.isnan(end)]
        known += proven if np.isfinite(proven).any() else []
    standing, findings = conclude(standing, (why,) if why else ())
    low, high = min(known, default=np.nan), max(known, default=np.nan)
    return Stability(
        standing=standing,
        low=low,
        high=high,
        side=_side(low, high, load_factor) if carried is None else carried.side,
        point=point,
        residual=np.nan if standing is Standing.UNDECIDED else found.residual,
        findings=findings,
    )


def _proven(
    discretisation: Discretisation, found: DeadLoadProof, tolerance: float
) -> tuple[Standing, ProgramState | None, Finding | None]:
    """Return what is proven of the discrete problem, its state in SI units, and what to report."""
    if found.equilibrium is not None:
        point = point_in_si(discretisation, found.equilibrium)
        if (excess := span_excess(discretisation, point)) > tolerance:
            inside = Finding(Kind.MOMENTS_INSIDE, values={"excess": excess})
            return Standing.UNDECIDED, None, inside
        why = Finding(Kind.STANDS_ON_MESH) if discretisation.continua else None
        return Standing.STANDS, point, why
    if found.mechanism is None:
        return Standing.UNDECIDED, None, None
    point = point_in_si(discretisation, found.mechanism)
    point = replace(point, velocity=point.velocity / discretisation.natural.load_factor)
    if corners := driven_corners(discretisation, point.velocity, tolerance):
        return Standing.UNDECIDED, None, corners
    return Standing.FALLS, point, cells.fall_of_cells(discretisation.problem, Status.UNSAFE)


def _side(low: float, high: float, load_factor: float) -> str:
    """Return on which side of a load factor others are carried."""
    if not np.isfinite(load_factor):
        return ""
    slack = SAME_LOAD_FACTOR * max(
        abs(value) for value in (low, high, load_factor) if np.isfinite(value)
    )
    below, above = low < load_factor - slack, high > load_factor + slack
    return {(1, 0): "below", (0, 1): "above", (1, 1): "both"}.get((below, above), "")
