"""Run one case variant on one mesh with a backend and a coupling, and judge it: one row a run."""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from math import inf, isfinite, isnan, nan
from typing import Any

import lacore as la
from lacore.coupling import Iterate
from verification.case import (
    Allowed,
    Band,
    Case,
    Reference,
    Variant,
    allowed_values,
    lower_values,
    upper_values,
)

PASS, FAIL, SKIPPED, NO_RESULT = "pass", "FAIL", "skipped", "no result"
STRONG = 0.05  # of the value: above it the regularisation error hides a wrong answer
BOUNDS = {"associated": upper_values, "stick": upper_values, "frictionless": lower_values}
"""Couplings that bound the Coulomb load factors (T14) instead of finding one."""
_RAW = {"damping": 1.0, "anderson": 0}
RAW: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    "paper": ("reaction", {"start": "zero", **_RAW}),
    **{f"{name}-raw": (name, _RAW) for name in ("reaction", "shift", "kappa")},
}
"""Loops without damping and acceleration by name; ``paper`` starts from zero reactions, too."""
_CLAIMED = {la.Status.LOCKED: inf, la.Status.UNSAFE: -inf, la.Status.FREE: 0.0}
"""What statuses say of the load factor: they are claims, right or wrong, like a number."""


@dataclass(frozen=True)
class Row:
    """One finished run; a field is a column. Values that do not exist are NaN or empty.

    Attributes:
        case, variant, backend, coupling, mesh: what was run.
        n_elements, n_dofs: triangles and rigid blocks; unknowns after supports.
        load_factor, reference: in units of the case.
        reference_to: upper end of the reference, where it is an interval.
        expected: the reference as text: number, interval or status.
        error: distance from the reference, relative to its size or that of the dead loads; 0 inside
            an interval.
        rigor, status: labels.
        lower, upper: the load factor again, where rigor proves it to be such a bound.
        outer_iterations: inner solves of the coupling loop.
        gap: of the certificate.
        build_time, solve_time: s.
        peak_memory_mb: largest resident memory of the backend's process; NaN where not measured.
        message: of the status, or why a run was skipped or failed.
        verdict: ``pass``, ``FAIL``, ``skipped``, or ``no result`` of a coupling that is not the
            default and claims nothing; `why` says why.
        why: the rule that gave the verdict, with its numbers.
        alpha_reg, regularised_lambda, P: the values of T19, as load factors.
        energy: C of T19.
        parameters: of the variant; written as ``param_*``.
    """

    case: str
    variant: str
    backend: str
    coupling: str
    mesh: str
    n_elements: float = nan
    n_dofs: float = nan
    load_factor: float = nan
    reference: float = nan
    reference_to: float = nan
    expected: str = ""
    error: float = nan
    rigor: str = ""
    lower: float = nan
    upper: float = nan
    status: str = ""
    outer_iterations: float = nan
    gap: float = nan
    build_time: float = nan
    solve_time: float = nan
    peak_memory_mb: float = nan
    message: str = ""
    verdict: str = FAIL
    why: str = ""
    alpha_reg: float = nan
    regularised_lambda: float = nan
    P: float = nan
    energy: float = nan
    parameters: dict[str, float | bool | str] = field(default_factory=dict)

    def record(self) -> dict[str, Any]:
        """As columns."""
        values = {entry.name: getattr(self, entry.name) for entry in fields(self)}
        parameters = values.pop("parameters")
        values["lambda"] = values.pop("regularised_lambda")
        for name in ("n_elements", "n_dofs", "outer_iterations"):
            if values[name] == values[name]:
                values[name] = int(values[name])
        return {name: values[name] for name in COLUMNS} | {
            f"param_{name}": value for name, value in parameters.items()
        }


COLUMNS = [
    "lambda" if entry.name == "regularised_lambda" else entry.name
    for entry in fields(Row)
    if entry.name != "parameters"
]


@dataclass(frozen=True)
class Run:
    """What to run.

    Attributes:
        case, variant, mesh, backend: names and things.
        coupling: a name of `la.solve` or `RAW`; None is the default of the backend.
        insist: whether to end without a result is a failure.
        skip: why it is not run after all.
    """

    case: Case
    variant: Variant
    mesh: str
    backend: str
    coupling: str | None = None
    insist: bool = True
    skip: str = ""

    @property
    def label(self) -> str:
        """For progress."""
        names = (f"{self.case.id}:{self.variant.name}", self.mesh, self.backend, self.coupling)
        return " ".join(name for name in names if name)


@dataclass(frozen=True)
class Outcome:
    """A run with its row, and its state where there is one."""

    run: Run
    row: Row
    state: la.LimitState | None


def judge(
    state: la.LimitState, reference: Reference, band: Band, insist: bool = True
) -> tuple[str, str]:
    """Verdict on a result, and why.

    Exact backends must lie in the band of the case. Regularised ones approach the exact discrete
    value from below with an error smaller than the energy C = alpha_reg - P (T19), so the band is
    lowered by C; and C must be small, or the verdict would be worth nothing. Couplings that bound
    the Coulomb load factors must bound the reference. Unless we `insist` on a result, a solve that
    claims nothing is none.
    """
    if state.status not in (la.Status.SOLVED, reference.status, *_CLAIMED):
        return FAIL if insist else NO_RESULT, f"not solved: {state.message}"
    if isnan(reference.value):
        return PASS, f"{state.status.label}: proven by its certificate, nothing to compare with"
    allowed_of = BOUNDS.get(state.coupling, allowed_values)
    if state.coupling == "associated" and reference.associated is not None:
        reference, allowed_of = reference.of_associated(), allowed_values
    found_only = {state.status, reference.status} - {la.Status.SOLVED}
    if allowed_of is allowed_values and found_only:
        verdict = PASS if state.status is reference.status else FAIL
        return verdict, f"{state.status.label}, expected {reference.text}"
    return _judge_value(state, reference, band, allowed_of(reference, band))


def _judge_value(
    state: la.LimitState, reference: Reference, band: Band, allowed: Allowed
) -> tuple[str, str]:
    value = _CLAIMED.get(state.status, state.load_factor)
    if state.regularised is not None:
        energy = max(state.regularised.energy, 0.0)
        if not energy <= STRONG * band.size(value):
            return FAIL, (
                f"regularisation too strong to judge: C = {energy:.3g} is above"
                f" {100 * STRONG:g} % of the value; lower r"
            )
        allowed = Allowed(allowed.low - energy, allowed.high)
    verdict = PASS if allowed.holds(value) else FAIL
    why = f"{value:.7g} {'in' if verdict == PASS else 'not in'} {allowed}"
    if not (reference.complete or reference.low <= value <= reference.high):
        why += f"; listed are {reference.text}"
    return verdict, why


def execute(
    runs: Iterable[Run],
    on_start: Callable[[Run], None],
    on_iterate: Callable[[Iterate], None],
    process: la.SolverProcess | None = None,
    time_limit: float | None = None,
) -> Iterator[Outcome]:
    """Run one after the other; neighbours of one variant and mesh share their discretisation.

    Backends work in `process` where there is one; `time_limit`: s, of each inner solve.
    """
    options = {} if time_limit is None else {"time_limit": time_limit}
    shared: tuple[Case, Variant, str] | None = None
    assembled: _Assembled | Exception = RuntimeError("nothing assembled")
    for run in runs:
        on_start(run)
        key = (run.case, run.variant, run.mesh)
        if shared is None or any(a is not b for a, b in zip(shared, key, strict=True)):
            shared = key
            try:
                assembled = _assemble(run)
            except Exception as error:  # the other cases go on
                assembled = error
        yield run_one(run, assembled, on_iterate, process, options)


@dataclass(frozen=True)
class _Assembled:
    discretisation: la.Discretisation
    build_time: float


def _assemble(run: Run) -> _Assembled:
    begin = time.perf_counter()
    discretisation = la.discretise(run.case.problem(run.variant, run.mesh))
    return _Assembled(discretisation, time.perf_counter() - begin)


def run_one(
    run: Run,
    assembled: _Assembled | Exception,
    on_iterate: Callable[[Iterate], None],
    process: la.SolverProcess | None,
    options: Mapping[str, Any],
) -> Outcome:
    """One row, whatever happens."""
    names: dict[str, Any] = {
        "case": run.case.id,
        "variant": run.variant.name,
        "backend": run.backend,
        "coupling": run.coupling or "",
        "mesh": run.mesh,
        "parameters": dict(run.variant.parameters),
    }
    if isinstance(assembled, Exception):
        return Outcome(run, _failed(names, assembled), None)
    discretisation = assembled.discretisation
    names["n_elements"] = discretisation.n_elements
    names["n_dofs"] = discretisation.program.n
    names["build_time"] = assembled.build_time
    try:
        reference = run.case.reference_of(run.variant)
        names |= _about(reference)
        band = run.case.band_of(run.variant, discretisation.n_elements)
        if run.skip:
            return _skipped(run, names, run.skip)
        coupling, settings = RAW.get(run.coupling or "", (run.coupling, {}))
        state = la.solve(
            discretisation,
            backend=run.backend,
            coupling=coupling,
            **settings,
            options=options,
            on_iterate=on_iterate,
            process=process,
        )
    except la.CapabilityError as error:
        return _skipped(run, names, str(error))
    except Exception as error:  # a broken backend must not take the others' results with it
        return Outcome(run, _failed(names, error), None)
    names["coupling"] = run.coupling or state.coupling
    verdict, why = judge(state, reference, band, run.insist)
    if state.coupling == "associated" and reference.associated is not None:
        reference = reference.of_associated()
        names |= _about(reference)
    distance = _distance(state.load_factor, reference, band)
    return Outcome(run, _row(names, state, distance, verdict, why), state)


def _about(reference: Reference) -> dict[str, Any]:
    up_to = nan if reference.up_to is None else reference.up_to
    return {"reference": reference.value, "reference_to": up_to, "expected": reference.text}


def _distance(value: float, reference: Reference, band: Band) -> float:
    """Relative distance from a reference; NaN without a value, or of another Coulomb state."""
    nearest = reference.value
    if reference.up_to is not None:
        nearest = min(max(value, nearest), reference.up_to)
        if not (reference.complete or reference.low <= value <= reference.high):
            return nan
    size = abs(nearest) or band.scale
    return (value - nearest) / size if isfinite(nearest) and size > 0 else nan


def _skipped(run: Run, names: dict[str, Any], why: str) -> Outcome:
    row = Row(**names, status="skipped", message=why, verdict=SKIPPED, why=why)
    return Outcome(run, row, None)


def _failed(names: dict[str, Any], error: Exception) -> Row:
    message = f"{type(error).__name__}: {error}"
    return Row(**names, status="failed", message=message, verdict=FAIL, why=message)


def _row(names: dict[str, Any], state: la.LimitState, error: float, verdict: str, why: str) -> Row:
    values = state.regularised
    return Row(
        **names,
        load_factor=state.load_factor,
        error=error,
        rigor=state.rigor.label,
        upper=state.load_factor if state.rigor is la.Rigor.UPPER else nan,
        status=state.status.label,
        outer_iterations=state.outer_iterations,
        gap=state.certificate.gap if state.certificate else nan,
        solve_time=state.solve_time,
        peak_memory_mb=state.peak_memory,
        message=state.message,
        verdict=verdict,
        why=why,
        alpha_reg=values.alpha_reg if values else nan,
        regularised_lambda=values.load_factor if values else nan,
        P=values.plastic if values else nan,
        energy=values.energy if values else nan,
    )
