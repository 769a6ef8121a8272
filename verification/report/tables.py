"""What tables of runs share, and those that all runs have, from results, one row a run."""

from collections.abc import Mapping

import pandas as pd

from verification.report.blocks import Anchor, Column, Table

VERDICTS: Mapping[str, str] = {"pass": "good", "FAIL": "bad"}
"""Colours of verdicts; all others are mild."""
RUN = Anchor("run", "run")
"""Row of a run."""
CERTIFICATE = Anchor("certificate", "certificate")
"""Certificate of a run."""
_RESIDUAL = "residual_"
WHO = (Column("variant"), Column("backend"))
"""First, so that the load factor beside them is seen on a telephone."""
HOW = (Column("mesh", order="n_elements"), Column("coupling"))
_NAMES = (*WHO, *HOW)


def reasons_table(results: pd.DataFrame) -> Table:
    """Why each verdict is what it is."""
    columns = (Column("verdict", moods=VERDICTS), *_NAMES, Column("why", long=True))
    return Table(columns, results)


def certificates_table(results: pd.DataFrame) -> Table:
    """Residuals of the runs that have any; each load factor links back to its run."""
    proven = with_certificates(results)
    proven = proven[proven[CERTIFICATE.column].notna()]
    columns = (
        *WHO,
        Column("load_factor", "load factor", ".7f", link=RUN),
        *HOW,
        *varied(results),
        *(
            Column(name, name.removeprefix(_RESIDUAL).replace("_", " "), ".1e")
            for name in _residuals(results)
        ),
    )
    return Table(columns, proven, anchor=CERTIFICATE)


def varied(results: pd.DataFrame) -> list[Column]:
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
