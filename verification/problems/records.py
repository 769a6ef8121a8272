"""An answer as a document for other programs."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

import lacore as la
from lacore.files.problem.reading import Stated
from lacore.reporting.findings import records, texts
from lacore.reporting.text import Reader, render
from lacore.reporting.units import Units
from verification.problems.answers import Answer
from verification.problems.more import MORE
from verification.problems.words import mechanism


def document(stated: Stated, answer: Answer, page: Path | None) -> dict[str, Any]:
    """All numbers of an answer, and where its files are."""
    state, reader = answer.state, Reader(stated.units, files=True)
    found: dict[str, Any] = {
        "title": stated.title,
        "file": str(stated.source.file),
        "status": state.status.label,
        "load_factor": state.load_factor,
        "rigor": state.rigor.label,
        "message": answer.report.text_for(reader),
        "findings": records(answer.findings, reader),
        "mechanism": None if state.point is None else mechanism(state, stated.units),
        "backend": state.backend,
        "coupling": state.coupling,
        "tolerance": state.tolerance,
        "certificate": None if state.certificate is None else asdict(state.certificate),
        "elements": state.discretisation.n_elements,
        "seconds": answer.seconds,
        "page": None if page is None else str(page),
        "units": _units(stated.units),
    }
    if answer.interval is not None:
        found["interval"] = _ends(answer.interval)
    if answer.stability is not None:
        own = answer.stability
        found["dead_loads"] = {"standing": own.standing.label, "low": own.low, "high": own.high}
    if answer.bracket is not None:
        found["bracket"] = {
            "lower": answer.bracket.lower,
            "upper": answer.bracket.upper,
            "width": answer.bracket.width,
            "strict": answer.bracket.strict,
            "status": answer.bracket.status.label,
            "failure": texts(answer.bracket.failures, reader),
        }
    if answer.range is not None:
        found["range"] = {
            "low": answer.range.low,
            "high": answer.range.high,
            "proven": list(answer.range.bracket),
            "status": answer.range.status.label,
            "stopped": answer.range.stopped,
        }
    if answer.safety is not None:
        found["safety"] = {
            "lower": answer.safety.lower,
            "upper": answer.safety.upper,
            "proven": answer.safety.proven,
            "interfaces": answer.safety.interfaces,
        }
    for name, own in answer.more.items():
        if isinstance(own, str):
            found[name] = {"failure": render(own, Reader(stated.units, files=True))}
        else:
            found[name] = MORE[name].document(MORE[name].told(own, stated.units))
    return found


def _units(units: Units) -> dict[str, str]:
    """What all numbers of the document are in; forces are per width, but those of frames."""
    return {"force": units.force, "length": units.length, "stress": units.stress}


def _ends(interval: la.Interval) -> dict[str, Any]:
    return {"low": interval.low, "high": interval.high, "exact": interval.exact}
