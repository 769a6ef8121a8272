"""Results as a document for other programs."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

from lacore.files.problem.reading import Stated
from lacore.reporting.findings import records
from lacore.reporting.text import Reader, render
from lacore.reporting.units import Units
from lacore_verification.report.problems.answers import ProblemResults
from lacore_verification.report.problems.more import ANALYSES
from lacore_verification.report.problems.words import mechanism


def document(stated: Stated, answer: ProblemResults, page: Path | None) -> dict[str, Any]:
    """Return all numbers of the results, and the places of its files."""
    state, reader = answer.state, Reader(stated.units, files=True)
    found: dict[str, Any] = {
        "title": stated.title,
        "file": str(stated.source.file),
        "status": state.status.label,
        "load_factor": state.load_factor,
        "rigor": state.rigor.label,
        "carried": None if state.carried is None else state.carried.record(),
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
    for name, own in answer.results.items():
        if isinstance(own, str):
            found[name] = {"failure": render(own, reader)}
        else:
            analysis = ANALYSES[name]
            found[name] = analysis.document(analysis.told(own, stated.units), stated.units)
    return found


def _units(units: Units) -> dict[str, str]:
    """Return the units of all numbers; forces are per width, except those of frames."""
    return {"force": units.force, "length": units.length, "stress": units.stress}
