"""Run of a bracket: proven bounds of a load factor, and the distribution of the gap."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

import lacore as la
from lacore.bounds.bracket.marking import lower_shares
from lacore.bounds.bracket.whole import continua, mesh_of, with_kept_water
from lacore.bounds.enclosing import associated, has_coulomb
from lacore.coupling.kinds import ASSOCIATED
from lacore.numerics.arrays import Floats
from lacore.solvers.compilation import SolveClock
from lacore_verification.case.band import Bracketing
from lacore_verification.harness.evidence.bracket import Shares, packed_shares
from lacore_verification.harness.evidence.limit_state import records
from lacore_verification.harness.perform.irregular import irregular
from lacore_verification.harness.verdicts.allowed import about
from lacore_verification.harness.verdicts.bracket import between, judge_bracket
from lacore_verification.runs.outcome import Evidence, Outcome
from lacore_verification.runs.row import STRICT, Row
from lacore_verification.runs.run import Run

_LIMIT = 600.0  # s, by default.
_PART = 0.8  # Share of the time limit; the steps after the bracket have the rest.
_SOLVED = la.Status.SOLVED
_FEW = (la.Status.UNSAFE, la.Status.LOCKED)


def run_bracket(
    run: Run,
    names: Mapping[str, Any],
    problem: la.Problem,
    time_limit: float | None,
    memory: Callable[[], float],
) -> Outcome:
    """Return the row of a bracket, and the gap identity on four meshes.

    Args:
        run: the run.
        names: columns that are known already.
        problem: of the run.
        time_limit: s, of the whole run.
        memory: peak memory of this process, MB.

    Raises:
        InputError: the problem has no bracket.
        CapabilityError: the backend does not support it.
    """
    stated = run.case.bracket or Bracketing()
    stated = replace(stated, target_width=run.settings.get("target_width", stated.target_width))
    coulomb, problem = has_coulomb(problem), associated(problem)
    clock = SolveClock()
    found = la.bracket(
        problem,
        stated.target_width,
        stated.max_elements,
        _PART * (time_limit or _LIMIT),
        run.backend,
        jobs=1,  # Other runs use the other processors.
    )
    seconds = clock.seconds
    proven = np.isfinite(found.lower) and np.isfinite(found.upper)
    rigor = la.Rigor.DISCRETE.label if proven else la.Rigor.NOT_CERTIFIED.label
    row = Row(
        **{**names, "coupling": run.coupling, "n_elements": _elements(found.upper_bound)},
        rigor=STRICT if found.strict else rigor,
        lower=found.lower,
        upper=found.upper,
        width=found.width,
        n_elements_lower=_elements(found.lower_bound),
        status=(_SOLVED if proven else la.Status.NOT_CERTIFIED).label,
        outer_iterations=len(found.history),
        solve_time=seconds,
        peak_memory_mb=memory(),
        message=found.message,
        model=ASSOCIATED if coulomb else "",
    )
    reference = between(run.case.reference_of(run.variant), coulomb)
    band = run.case.band_of(run.variant, int(row.n_elements))
    verdict, why = judge_bracket(row, reference, stated, band)
    row = replace(row, verdict=verdict, why=why, **about(reference))
    shares = list(_identities(problem, found, run.backend)) if proven else []
    return Outcome(
        run, row, Evidence(_residuals(found), records(found.history), packed_shares(shares))
    )


def _elements(bound: la.UpperBound | la.LowerBound) -> int:
    where = bound.discretisation if isinstance(bound, la.UpperBound) else bound.model
    return where.n_elements


def _residuals(found: la.Bracket) -> dict[str, float]:
    """Return the residuals of both bounds, by names of `lacore.program.certificate.Certificate`."""
    upper, below = found.upper_bound, found.lower_bound.certificate
    residuals = {"divergence": upper.divergence, "penetration": upper.penetration}
    if below is not None:
        residuals |= {
            name: getattr(below, name) for name in ("equilibrium", "yield_violation", "cone")
        }
    return residuals


def _identities(problem: la.Problem, found: la.Bracket, backend: str) -> Iterator[Shares]:
    """Yield shares on the mesh of the problem, on an irregular one, and on those of both bounds."""
    problem = la.matching(problem)
    finer = {
        name: replace(body, mesh=irregular(body.mesh)) for name, body in continua(problem).items()
    }
    # A water table would pass through its elements: its pressures are those of the other mesh.
    disordered = replace(with_kept_water(problem), bodies={**problem.bodies, **finer})
    disordered = la.matching(disordered)
    for mesh, stated in (("uniform", problem), ("irregular", disordered)):
        lower = la.lower_bound(stated, backend)
        upper = la.upper_bound(stated, backend)
        # Meshes too coarse to carry the dead loads, or to flow, are no failure.
        if lower.status not in _FEW and upper.status not in _FEW:
            yield _shares(mesh, upper, la.gap_identity(upper, lower))
    yield _shares("upper", found.upper_bound, found.gaps())
    below = found.lower_bound
    above, stated = found.upper_bound, below.model.problem
    if above.discretisation.problem is not stated:
        above = la.upper_bound(stated, backend)
    marks = np.concatenate([lower_shares(below, name) for name in below.model.continua])
    yield _shares("lower", above, la.gap_identity(above, below), marks)


def _shares(
    mesh: str, upper: la.UpperBound, identity: la.GapIdentity, marks: Floats | None = None
) -> Shares:
    of = mesh_of(upper.discretisation.problem)
    power = sum(float(part.sum()) for part in upper.dissipation.values())
    return Shares(
        mesh=mesh,
        points=of.p,
        elements=of.t,
        shares=np.concatenate([*identity.elements.values()]),
        interfaces=np.array([*identity.interfaces.values()], dtype=float),
        marks=np.zeros(0) if marks is None else marks,
        lower=identity.lower,
        upper=identity.upper,
        scale=max(abs(identity.upper), power),
    )
