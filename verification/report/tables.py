"""Tables of the report, from a DataFrame with the columns of results, one row a run."""

from collections.abc import Mapping

import pandas as pd

import lacore as la
from verification.report.blocks import Anchor, Column, Table

VERDICTS: Mapping[str, str] = {"pass": "good", "FAIL": "bad"}
"""Colours of verdicts; all others are mild."""
RUN = Anchor("run", "run")
"""Row of a run."""
CERTIFICATE = Anchor("certificate", "certificate")
"""Certificate of a run."""
_RESIDUAL = "residual_"
_WHO = (Column("variant"), Column("backend"))
"""First, so that the load factor beside them is seen on a telephone."""
_HOW = (Column("mesh", order="n_elements"), Column("coupling"))
_NAMES = (*_WHO, *_HOW)


def results_table(results: pd.DataFrame) -> Table:
    """Every run; its load factor links to its certificate, where it has one."""
    solved = results["status"] == la.Status.SOLVED.label
    outcome = results["rigor"].where(solved, results["status"])
    columns = (
        Column("verdict", moods=VERDICTS, hover="why"),
        *_WHO,
        Column("load_factor", "load factor", ".7f", link=CERTIFICATE),
        Column("error", "error %", "+.4f", scale=100),
        Column("expected", "reference", "g", order="reference"),
        *_HOW,
        Column("n_elements", "elements", ".0f"),
        *_varied(results),
        Column("energy", "C", ".2g"),
        Column("outcome", "rigor, status"),
        *_standing(results),
        Column("outer_iterations", "solves", ".0f"),
        Column("build_time", "build s", ".2f"),
        Column("solve_time", "solve s", ".2f"),
    )
    return Table(columns, with_certificates(results).assign(outcome=outcome), anchor=RUN)


def _standing(results: pd.DataFrame) -> tuple[Column, ...]:
    """Whether structures stand under their dead loads, where that was asked."""
    if "standing" not in results or not results["standing"].fillna("").ne("").any():
        return ()
    return Column("standing", "dead loads"), Column("side", "holds")


def reasons_table(results: pd.DataFrame) -> Table:
    """Why each verdict is what it is."""
    columns = (Column("verdict", moods=VERDICTS), *_NAMES, Column("why", long=True))
    return Table(columns, results)


def certificates_table(results: pd.DataFrame) -> Table:
    """Residuals of the runs that have any; each load factor links back to its run."""
    proven = with_certificates(results)
    proven = proven[proven[CERTIFICATE.column].notna()]
    columns = (
        *_WHO,
        Column("load_factor", "load factor", ".7f", link=RUN),
        *_HOW,
        *_varied(results),
        *(
            Column(name, name.removeprefix(_RESIDUAL).replace("_", " "), ".1e")
            for name in _residuals(results)
        ),
    )
    return Table(columns, proven, anchor=CERTIFICATE)


def _varied(results: pd.DataFrame) -> list[Column]:
    """What was set besides the case: sizes of its mesh, settings of the loop, options."""
    found = []
    for name in map(str, results.columns):
        kind, _, rest = name.partition("_")
        if kind in ("size", "setting", "option") and results[name].notna().any():
            form = "g" if pd.api.types.is_numeric_dtype(results[name]) else ""
            found.append(Column(name, rest.replace("_", " "), form))
    return found


def _residuals(results: pd.DataFrame) -> list[str]:
    return [str(name) for name in results.columns if str(name).startswith(_RESIDUAL)]


def with_certificates(results: pd.DataFrame) -> pd.DataFrame:
    """With a column ``certificate``: the run where it has residuals, else nothing."""
    has = results[_residuals(results)].notna().any(axis=1)
    return results.assign(certificate=results["run"].where(has))
