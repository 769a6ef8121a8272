"""Settings of the backends in a comparison: every option, its value and its default."""

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import fields
from typing import Any

import pandas as pd

import lacore as la
from lacore.solvers.backend import load_backend
from lacore_verification.harness.analysis.columns import with_prefix
from lacore_verification.runs.run import Run, canonical

COLUMNS = ("backend", "setting", "option", "value", "default", "changed")
MOST_SETTINGS = 5
"""Settings that a backend may have in a comparison; with more, they are a sweep of an option."""
DEFAULT = "default"
"""Name of the setting in which no option is changed."""


def settings(runs: Iterable[Run]) -> pd.DataFrame:
    """Return one row for each option of each setting of a backend that was run.

    Args:
        runs: Of a comparison. Of a backend that is missing here, only the changed options are
            known.

    Returns:
        Columns ``backend``; ``setting``, the changed options as in the column ``options`` of the
        results, or ``default``; ``option``; ``value``; ``default``, both as text; ``changed``.
    """
    distinct = {(run.backend, canonical(dict(run.options))): run for run in runs}
    rows = []
    for run in sorted(distinct.values(), key=lambda run: (run.backend, run.options_text)):
        defaults = _defaults(run.backend)
        for name in dict.fromkeys((*defaults, *run.options)):
            default = defaults.get(name, "")
            rows.append(
                {
                    "backend": run.backend,
                    "setting": run.options_text or DEFAULT,
                    "option": name,
                    "value": str(run.options.get(name, default)),
                    "default": str(default),
                    "changed": name in run.options,
                }
            )
    return pd.DataFrame(rows, columns=list(COLUMNS))


def with_settings(results: pd.DataFrame) -> pd.DataFrame:
    """Return results in which each setting of a backend is a separate backend.

    Its name has the changed options, as in ``clarabel tolerance=1e-06``. Backends with more than
    `MOST_SETTINGS` settings keep their name and their columns ``option_*``.

    Args:
        results: One row for each run; older results have no column ``options``.
    """
    if "options" not in results.columns:
        return results
    changed = results["options"].fillna("")
    few = changed.groupby(results["backend"]).transform("nunique") <= MOST_SETTINGS
    renamed = few & (changed != "")
    name = (results["backend"] + " " + changed).where(renamed, results["backend"])
    found = results.assign(backend=name)
    if "answered_by" in results.columns:
        own = renamed & (results["answered_by"] == results["backend"])
        found["answered_by"] = name.where(own, results["answered_by"])
    for column in with_prefix(results, "option_"):
        found[column] = results[column].mask(renamed)
    return found


def _defaults(backend: str) -> dict[str, Any]:
    with suppress(la.LacoreError):  # The rows report a missing backend.
        found = load_backend(backend).Options
        made = found()
        return {own.name: getattr(made, own.name) for own in fields(found)}
    return {}
