"""`stable`: stability of a structure under its dead loads alone."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from lacore.assembly.discretisation import Discretisation
from lacore.assembly.discretise import discretise
from lacore.bounds.enclosing import associated, with_associated_flow
from lacore.bounds.lower import lower_bound
from lacore.bounds.upper import upper_bound
from lacore.limit import cells
from lacore.limit.outcome import strict_bound
from lacore.limit.stability import Stability, Verdict, stability_of
from lacore.limit.state import LimitState
from lacore.model.problem.problem import Problem
from lacore.reporting import views
from lacore.reporting.errors import CapabilityError, InputError, require_positive, typed
from lacore.reporting.findings import Finding, Message, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.showing import Facts, Picture
from lacore.reporting.status import Reported, Rigor, Standing, Status
from lacore.solvers.backend import find_backend
from lacore.solvers.compilation import SolveClock
from lacore.solvers.registry import PROVING_BACKEND

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_STATUS = {
    Standing.STANDS: Status.SOLVED,
    Standing.FALLS: Status.UNSAFE,
    Standing.UNDECIDED: Status.NOT_CERTIFIED,
}


@dataclass(frozen=True, repr=False)
class Stable(Reported):
    """Stability of a structure under its dead loads alone, with the proof.

    Attributes:
        stands: True, with stresses and reactions that carry the dead loads; False, with a mechanism
            that they drive; None without a proof.
        stability: the proof, and the range of load factors of the reference loads that are carried.
        state: state for pictures: if it stands, the stresses and reactions under the dead loads,
            without motion; if it collapses, the mechanism at ``Fd.u = 1``; without a proof, both of
            the discrete problem, if available.
    """

    stands: bool | None
    stability: Stability
    state: LimitState

    @property
    def status(self) -> Status:
        """That of the state: SOLVED, UNSAFE or NOT_CERTIFIED."""
        return self.state.status

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What is proven, and conditions of the proof or the reason why there is none."""
        return self.state.findings

    def __bool__(self) -> bool:
        """Return whether it is proven to stand."""
        return self.stands is True

    def facts(self) -> Facts:
        """Return what is proven, with residuals, for printing."""
        told = {"residual": f"largest {self.stability.residual:.1e}"}
        if self.stability.findings:
            told["findings"] = self.stability.message
        told["solved by"] = f"{self.state.backend} in {self.state.solve_time:.3g} s"
        told["size"] = self.state.discretisation.contents
        standing = self.stability.standing
        return Facts(f"Stable: {standing.label}: {standing.value}", told)

    def picture(self) -> Picture:
        """Return the mechanism, or the stresses; without a proof the problem."""
        if self.state.point is None:
            return Picture(self.state.discretisation.problem.plot(), "the problem: undecided")
        return Picture(self.plot())

    def plot(self) -> Figure:
        """Plot the proof: see `lacore.pictures.analyses.plot_stable`."""
        return views.picture(self)


@typed()
def stable(
    problem: Problem,
    backend: str = "auto",
    *,
    tolerance: float = 1e-6,
    options: Mapping[str, Any] | None = None,
) -> Stable:
    """Determine whether a structure stands under its dead loads alone: proven, or None.

    It stands if stresses within all strengths and reactions within all friction cones carry the
    dead loads; with non-associated friction they need not be the actual ones (T14b). If it
    collapses, no friction with these coefficients can hold it, and no pressures up to the strength
    of joints that crush. Deformable bodies stand by stresses of a `lacore.lower_bound`, in
    equilibrium in each element: if those of the mesh carry less than the dead loads, refine it.

    Args:
        problem: problem with dead loads; its reference loads do not act.
        backend, options: an exact backend.
        tolerance: tolerance for the residuals of either proof.

    Raises:
        InputError: no dead loads; anything that `lacore.discretise` rejects.
        CapabilityError: the backend is missing, or does not support the problem.

    Example:
        >>> bool(la.stable(la.examples.column()))  # it stands under its weight alone
        True
    """
    require_positive("tolerance", tolerance)
    begin = time.perf_counter()
    require_dead_loads(problem)
    discretisation = discretise(problem)
    build_time, clock = time.perf_counter() - begin, SolveClock()
    given = backend, options or {}, "associated", tolerance, np.nan

    def conclude(standing: Standing, findings: tuple[Finding, ...]) -> Verdict:
        falls = standing is Standing.FALLS and cells.from_below(problem)
        stands = standing is Standing.STANDS and cells.from_above(problem)
        if falls or stands:
            other = cells.on_side(problem, "above" if falls else "below")
            same = stability_of(discretise(other), *given).standing is standing
            standing, findings = (standing, ()) if same else (Standing.UNDECIDED, findings)
        why = _not_of_the_continuum(problem, discretisation, standing, backend, options or {})
        return (standing, findings) if why is None else (Standing.UNDECIDED, (why,))

    found = stability_of(discretisation, *given, conclude)
    status = _STATUS[found.standing]
    state = LimitState(
        status=status,
        load_factor=0.0 if status is Status.SOLVED else np.nan,
        rigor=Rigor.NOT_CERTIFIED,
        backend=backend,
        coupling="associated",
        certificate=None,
        contraction=np.nan,
        bracket=None,
        regularised=None,
        history=pd.DataFrame({"peak_memory": []}),
        build_time=build_time,
        solve_time=clock.seconds,
        compile_time=clock.compile_time,
        options=dict(options or {}),
        tolerance=tolerance,
        findings=(
            Finding(Kind.DEAD_LOADS, (), {"standing": found.proven}, Severity.REASON),
            *found.findings,
        ),
        discretisation=discretisation,
        point=found.point,
    )
    answer = {Standing.STANDS: True, Standing.FALLS: False, Standing.UNDECIDED: None}
    return Stable(answer[found.standing], found, state)


def _not_of_the_continuum(
    problem: Problem,
    discretisation: Discretisation,
    standing: Standing,
    backend: str,
    options: Mapping[str, Any],
) -> Finding | None:
    """Return why it is not proven for deformable bodies, as one mesh may prove less; else None.

    Their discrete equilibrium is not that of each element, and in some spaces flow dissipates more
    than at their points. All dead loads together are carried from zero up to their load factor.
    """
    sure = standing is Standing.FALLS and strict_bound(discretisation)
    if not discretisation.continua or standing is Standing.UNDECIDED or sure:
        return None
    if find_backend(backend).capabilities.regularised:
        backend, options = PROVING_BACKEND, {}
    why: Message | str
    try:
        alone = associated(with_associated_flow(problem.with_loads(problem.dead_loads, [])))
        if standing is Standing.STANDS:
            below = lower_bound(alone, backend, options=options)
            carried = below.rigor is Rigor.LOWER and below.load_factor >= 1
            proven, why = carried or below.status is Status.LOCKED, below.report
        else:
            above = upper_bound(alone, backend, options=options)
            proven = above.rigor is Rigor.UPPER and above.load_factor < 1
            why = above.report
    except (InputError, CapabilityError) as refused:
        proven, why = False, refused.text
    if proven:
        return None
    values = {"standing": standing.label, "why": why}
    return Finding(Kind.CONTINUUM_NOT_PROVEN, values=values)


@typed()
def require_dead_loads(problem: Problem) -> None:
    """Raise `InputError` if there are only loads that a load factor multiplies."""
    if not problem.dead_loads:
        raise InputError(
            "Problem.dead_loads",
            None,
            "there is none, and stability concerns these alone",
            "give the weights as dead_loads; reference loads do not act here",
        )
