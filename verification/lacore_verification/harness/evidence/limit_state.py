"""Serialisation of states, so that a stored number can be proven and drawn again."""

import io
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from math import isnan, nan
from typing import Any

import numpy as np
import pandas as pd

import lacore as la
from lacore.limit.checking import recomputed
from lacore.limit.constants import ACCEPTED, TOLERANCE
from lacore.numerics.arrays import Floats
from lacore.program.certificate import Certificate
from lacore.program.regularization import RegularisedValues
from lacore.program.state import ProgramState
from lacore.reporting.findings import Finding
from lacore.reporting.findings import restored as restored_findings
from lacore.reporting.kinds import Kind
from lacore_verification.case import SOLVER
from lacore_verification.harness.evidence.span_nodes import as_solved, nodes_of, require_hinges
from lacore_verification.runs.outcome import Evidence
from lacore_verification.runs.row import Row
from lacore_verification.runs.run import Run

_SINGLE = ("velocity", "normal_reaction", "tangential_reaction")
_SEVERAL = ("stress", "mean_stress")


def evidence_of(state: la.LimitState) -> Evidence:
    """Return the evidence of a state."""
    return Evidence(
        residuals=asdict(state.certificate) if state.certificate else {},
        history=records(state.history),
        arrays=b"" if state.point is None else packed(state.point, **nodes_of(state)),
    )


def records(frame: pd.DataFrame) -> tuple[dict[str, Any], ...]:
    """Return rows as plain Python, by columns, five times faster than `DataFrame.to_dict`."""
    names = [str(name) for name in frame]
    columns = [frame[name].tolist() for name in frame]
    return tuple(dict(zip(names, row, strict=True)) for row in zip(*columns, strict=True))


def _certificate(residuals: Mapping[str, float]) -> Certificate | None:
    """Return a stored certificate; residuals that were not computed are NaN and never pass."""
    names = [entry.name for entry in fields(Certificate)]
    return Certificate(**(dict.fromkeys(names, nan) | dict(residuals))) if residuals else None


def _findings(row: Row) -> tuple[Finding, ...]:
    """Return stored findings; results of earlier versions have the text alone."""
    if row.findings or not row.message:
        return restored_findings(row.findings)
    return (Finding(Kind.EARLIER, values={"text": row.message}),)


def _values(row: Row) -> RegularisedValues:
    return RegularisedValues(row.P, row.alpha_reg, row.regularised_lambda, nan)


def packed(point: ProgramState, **more: Floats) -> bytes:
    """Return a state in numpy's archive format, with further arrays that define its problem."""
    arrays = {name: getattr(point, name) for name in _SINGLE}
    arrays |= {
        f"{name}_{n}": part for name in _SEVERAL for n, part in enumerate(getattr(point, name))
    }
    buffer = io.BytesIO()
    arrays |= {"load_factor": np.array(point.load_factor), "groups": np.array(len(point.stress))}
    # Compression takes five times as long, and the file is hardly smaller.
    np.savez(buffer, **(arrays | more))
    return buffer.getvalue()


def unpacked(data: bytes) -> ProgramState:
    """Return the inverse of `packed`; nothing in the data is executed.

    Raises:
        ValueError: the bytes are no such archive.
    """
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            arrays = dict(archive)
        return ProgramState(
            velocity=arrays["velocity"],
            load_factor=float(arrays["load_factor"]),
            stress=_parts(arrays, "stress"),
            mean_stress=_parts(arrays, "mean_stress"),
            normal_reaction=arrays["normal_reaction"],
            tangential_reaction=arrays["tangential_reaction"],
        )
    # zip, struct, key and value errors mean that the bytes have another format.
    except Exception as error:
        raise ValueError(f"no state: {error}") from error


def _parts(arrays: Mapping[str, Floats], name: str) -> tuple[Floats, ...]:
    return tuple(arrays[f"{name}_{n}"] for n in range(int(arrays["groups"])))


@dataclass(frozen=True)
class Proof:
    """Recomputed proof of a stored state.

    Attributes:
        load_factor: that the row must have.
        certificate: of the state.
        bar: tolerance of its residuals if none is given.
    """

    load_factor: float
    certificate: Certificate
    bar: float = TOLERANCE


def recheck(discretisation: la.Discretisation, row: Row, evidence: Evidence) -> Proof:
    """Return residuals of a stored state, recomputed from the problem of its run.

    Raises:
        ValueError: there is no state, or it is not one of this problem.
    """
    point = unpacked(evidence.arrays)
    loose = discretisation.program.frictional and row.coupling == "certified"
    certificate = recomputed(discretisation, point, row.coupling)
    require_hinges(discretisation, point, row.rigor != la.Rigor.REGULARISED.label)
    return Proof(point.load_factor, certificate, ACCEPTED if loose else TOLERANCE)


def restored(run: Run, row: Row, evidence: Evidence) -> la.LimitState:
    """Return the state of a row for display; its options are those of the run.

    Raises:
        ValueError: there is none, or it is not one of this problem.
    """
    problem = run.problem()
    solved = as_solved(problem, la.discretise(problem), evidence)
    return restored_on(solved, run, row, evidence)


def restored_on(
    discretisation: la.Discretisation, run: Run, row: Row, evidence: Evidence
) -> la.LimitState:
    """Return the state as `restored`, for a problem that is discretised already."""
    return la.LimitState(
        status=next(status for status in la.Status if status.label == row.status),
        load_factor=row.load_factor,
        rigor=next(rigor for rigor in la.Rigor if rigor.label == row.rigor),
        backend=row.backend,
        coupling=row.coupling,
        certificate=_certificate(evidence.residuals),
        contraction=row.contraction,
        bracket=None,
        regularised=None if isnan(row.P) else _values(row),
        history=pd.DataFrame(list(evidence.history)),
        build_time=row.build_time,
        solve_time=row.solve_time,
        options=run.options,
        tolerance=run.settings.get("tolerance", SOLVER),
        findings=_findings(row),
        discretisation=discretisation,
        point=unpacked(evidence.arrays),
    )
