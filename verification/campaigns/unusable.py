"""Plug-ins that cannot be used: each of them is one row of a comparison, and nothing else fails."""

from collections.abc import Sequence
from dataclasses import replace

import lacore as la
from lacore.solvers.registry import fault_of, rejected_backends
from verification.runs.run import Run


def unusable_backends() -> dict[str, str]:
    """Return why registered backends cannot be used, with their files, by their names.

    They cannot be imported, describe themselves wrongly, or have the name of another backend.
    """
    found = {name: fault_of(name) for name in la.backend_names()}
    found |= {own.label: own.conflict for own in rejected_backends()}
    return {name: why for name, why in found.items() if why}


def with_unusable(runs: Sequence[Run], backends: Sequence[str]) -> list[Run]:
    """Return runs in which each unusable backend has one, which is skipped with the reason.

    Args:
        runs: Of a comparison.
        backends: Named for it; without names, or with ``all``, all unusable backends are added.
    """
    faults = {name: fault_of(name) for name in {run.backend for run in runs}}
    if runs and (not backends or list(backends) == ["all"]):
        faults = unusable_backends() | faults
    unusable = {name: why for name, why in faults.items() if why}
    first = {run.backend: run for run in reversed(runs)}
    usable = [run for run in runs if run.backend not in unusable]
    skipped = [
        replace(
            first.get(name, replace(runs[0], backend=name)), coupling=None, settings={}, skip=why
        )
        for name, why in sorted(unusable.items())
    ]
    return [*usable, *skipped]
