"""A finished run as a row with one field per column."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from math import nan
from typing import Any

from lacore.reporting.status import Rigor

STRICT = f"{Rigor.LOWER.label}, {Rigor.UPPER.label}"
"""Rigour of brackets of the continuum, whose bounds are both strict."""


@dataclass(frozen=True)
class Row:
    """One finished run, with one field per column. Missing values are NaN or empty.

    Attributes:
        case, variant, backend, coupling, mesh: names of the run.
        answered_by: origin of the result: the backend, or path following of lacore, or both; empty
            without a result. Rates of backends count only their own results.
        n_elements, n_dofs: triangles and rigid blocks; unknowns after supports. For a bracket those
            of its upper bound, and ``n_elements_lower`` those of its lower one.
        load_factor, reference: in units of the case.
        reference_to: upper end of the reference, if it is an interval.
        expected: the reference as text: number, interval or status.
        error: distance from the reference, relative to its size or that of the dead loads; 0 inside
            an interval.
        rigor, status: labels.
        lower, upper: proven bounds: of a bracket, or the load factor if rigor proves it to be one.
        width: width of a bracket, by its mean.
        ending: ending of a path; `load_factor` is that of its last step, `outer_iterations` and the
            gap are totals.
        path_error: largest relative error of the known loads of a path.
        volume_change: largest change of volume of a step of a path, by the volume.
        start: initial load factor of a path; `lower` and `upper` are its strict bounds.
        reading: other result of a path, see `lacore_verification.case.following.Reading`.
        standing: proven status of the dead loads alone, see `la.Stability`: ``stands``, ``falls``,
            ``undecided``; empty for regularised backends, brackets and paths.
        side: side of the load factor on which loads are carried: ``below``, ``above``, ``both``.
        carried_low, carried_high: range of load factors that are proven to be carried.
        lowest, highest: load factors found for a range of a soil; `lower` and `upper` are proven
            for all on its mesh.
        davis: load factor with Davis's strength, for a range; it is not a bound.
        model: model that was solved instead of that of the case, such as ``associated``; empty if
            it is that of the case.
        outer_iterations: inner solves of the coupling loop.
        gap: gap of the certificate.
        build_time, solve_time: s. The second is the whole of the solve, without `compile_time`.
        compile_time: s, of the warm-up of the backend in its process, before its first solve there
            (`warm_up`); equal for all runs of a process. NaN without a warm-up.
        solver_time: s, of the inner solves, measured by lacore; part of `solve_time`.
        reported_time: s, of the same inner solves, reported by the backend.
        calibration_before, calibration_after: s, of a short constant program, solved in the process
            of the run before and after it; NaN if it was not. Their scatter is the noise of the
            machine.
        log: file with the end of the printed output, relative to the folder of the store; may be
            empty.
        options: options of the backend that differ from its defaults: ``tolerance=1e-06``.
        peak_memory_mb: largest resident memory of the process of the run; NaN if not measured.
        message: message of the status, or why a run was skipped or failed.
        findings: findings of a state, as stored by `lacore.reporting.findings.stored`; empty for
            brackets, ranges, paths and runs without a state.
        verdict: ``pass``, ``FAIL``, ``skipped``, ``bound only`` for another model with unknown load
            factor that is on the correct side of the reference, ``no reference`` for a proven
            result without comparison, or ``no result`` if no result is claimed or required: for a
            regularised backend, or a coupling other than the default; `why` gives the reason.
        why: rule of the verdict, with its numbers.
        check: for a random problem that fails, the name of the check, or of the error.
        alpha_reg, regularised_lambda, P: values of T19, as load factors.
        energy: C of T19.
        contraction: contraction of the coupling loop.
        iterations: iterations of the solver, in all inner solves.
        claimed: whether the solver reported its last inner solve as solved.
    """

    case: str
    variant: str
    backend: str
    coupling: str
    mesh: str
    answered_by: str = ""
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
    verdict: str = "FAIL"
    why: str = ""
    alpha_reg: float = nan
    regularised_lambda: float = nan
    P: float = nan
    energy: float = nan
    contraction: float = nan
    iterations: float = nan
    claimed: bool = False
    n_elements_lower: float = nan
    width: float = nan
    ending: str = ""
    path_error: float = nan
    volume_change: float = nan
    start: float = nan
    reading: float = nan
    standing: str = ""
    side: str = ""
    carried_low: float = nan
    carried_high: float = nan
    lowest: float = nan
    highest: float = nan
    davis: float = nan
    model: str = ""
    options: str = ""
    compile_time: float = nan
    solver_time: float = nan
    reported_time: float = nan
    calibration_before: float = nan
    calibration_after: float = nan
    log: str = ""
    findings: str = ""
    check: str = ""

    def record(self) -> dict[str, Any]:
        """Return the columns."""
        values = asdict(self)
        values["lambda"] = values.pop("regularised_lambda")
        for name in COUNTS:
            if values[name] == values[name]:
                values[name] = int(values[name])
        return {name: values[name] for name in TYPES}


COUNTS = ("n_elements", "n_elements_lower", "n_dofs", "outer_iterations", "iterations")
"""Columns of whole numbers, which are never negative."""


_KINDS: Mapping[Any, str] = {str: "string", float: "float64", bool: "boolean"}


TYPES = {
    "lambda" if entry.name == "regularised_lambda" else entry.name: "Int64"
    if entry.name in COUNTS
    else _KINDS[entry.type]
    for entry in fields(Row)
}
"""Columns of a row, and their types in a table."""
