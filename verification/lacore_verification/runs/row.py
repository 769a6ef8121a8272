"""One finished run as a row: what comes out, a field a column."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from math import nan
from typing import Any

from lacore.reporting.status import Rigor

STRICT = f"{Rigor.LOWER.label}, {Rigor.UPPER.label}"
"""Rigour of brackets of the continuum, whose bounds are both strict."""


@dataclass(frozen=True)
class Row:
    """One finished run; a field is a column. Values that do not exist are NaN or empty.

    Attributes:
        case, variant, backend, coupling, mesh: what was run.
        answered_by: Who found the answer: the backend, or path following of lacore, or both; empty
            without an answer. Rates of backends count only what they answered themselves.
        n_elements, n_dofs: triangles and rigid blocks; unknowns after supports. Of a bracket those
            of its upper bound, and ``n_elements_lower`` those of its lower one.
        load_factor, reference: in units of the case.
        reference_to: upper end of the reference, where it is an interval.
        expected: the reference as text: number, interval or status.
        error: distance from the reference, relative to its size or that of the dead loads; 0 inside
            an interval.
        rigor, status: labels.
        lower, upper: proven bounds: of a bracket, or the load factor again, where rigor proves it
            to be one.
        width: of a bracket, per its mean.
        ending: of a path; `load_factor` is that of its last step, `outer_iterations` and the gap
            are of all.
        path_error: largest relative error of the loads of a path, as far as they are known.
        volume_change: largest of a step of a path, of the volume.
        start: load factor with which a path begins; `lower` and `upper` are strict bounds of it.
        reading: what else is read from a path, see `lacore_verification.case.following.Reading`.
        standing: what is proven of the dead loads alone, see `la.Stability`: ``stands``, ``falls``,
            ``undecided``; empty where it is not asked: of regularised backends, brackets and paths.
        side: on which side of the load factor loads are carried: ``below``, ``above``, ``both``.
        carried_low, carried_high: ends of the load factors that are proven to be carried.
        lowest, highest: load factors that a range of a soil found; `lower` and `upper` are proven
            of all on its mesh.
        davis: load factor with Davis's strength, of a range; it bounds nothing.
        model: the model that was solved in place of that of the case, such as ``associated``; empty
            where it is that of the case.
        outer_iterations: inner solves of the coupling loop.
        gap: of the certificate.
        build_time, solve_time: s. The second is the whole of the solve, without `compile_time`.
        compile_time: s, that the backend took to warm up in its process, before its first solve
            there (`warm_up`); the same for all runs of a process. NaN of a backend without it.
        solver_time: s, of the inner solves, as lacore measures them; part of `solve_time`.
        reported_time: s, of the same inner solves, as the backend reports them.
        calibration_before, calibration_after: s, of a short program that is always the same, solved
            in the process of the run before and after it; NaN where it was not repeated. Their
            scatter is the noise of the machine.
        log: file with the end of what the run printed, relative to the folder of the store; empty
            where it printed nothing.
        options: of the backend, as far as they differ from its defaults: ``tolerance=1e-06``.
        peak_memory_mb: largest resident memory of the process of the run; NaN where not measured.
        message: of the status, or why a run was skipped or failed.
        findings: What a state has to report, as `lacore.reporting.findings.stored` writes it; empty
            for brackets, ranges, paths and runs without a state.
        verdict: ``pass``, ``FAIL``, ``skipped``, ``bound only`` of another model whose own load
            factor is not known, which is on the right side of the reference, ``no reference`` of
            what is proven and cannot be compared, or ``no result`` of what claims nothing and need
            not: a regularised backend, or a coupling that is not the default; `why` says why.
        why: the rule that gave the verdict, with its numbers.
        check: of a random problem that fails, the name of the check, or of the error.
        alpha_reg, regularised_lambda, P: the values of T19, as load factors.
        energy: C of T19.
        contraction: of the coupling loop.
        iterations: of the solver, in all inner solves.
        claimed: whether the solver itself called its last inner solve solved.
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
        """As columns."""
        values = asdict(self)
        values["lambda"] = values.pop("regularised_lambda")
        for name in _COUNTS:
            if values[name] == values[name]:
                values[name] = int(values[name])
        return {name: values[name] for name in TYPES}


_COUNTS = ("n_elements", "n_elements_lower", "n_dofs", "outer_iterations", "iterations")


_KINDS: Mapping[Any, str] = {str: "string", float: "float64", bool: "boolean"}


TYPES = {
    "lambda" if entry.name == "regularised_lambda" else entry.name: "Int64"
    if entry.name in _COUNTS
    else _KINDS[entry.type]
    for entry in fields(Row)
}
"""Columns of a row, and their types in a table."""
