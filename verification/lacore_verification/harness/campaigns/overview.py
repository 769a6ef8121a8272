"""The runs of the first comparison: `lacore compare` without a case, about a minute of solving.

They are chosen by data of the cases and capabilities of the backends, never by measured times, so
that the runs are the same on all machines. Each case runs the variant, the meshes and the bracket
that `Case.first` names; by default its first variant on its coarsest and its finest mesh. On the
first of these meshes all backends are compared, without dense ones on continua, and only the fast
exact ones if it is not the coarsest mesh of the case. One exact backend runs all other meshes,
brackets and paths, a variant of each other status that a case must end with, and cases tagged
`LARGE`.
"""

from collections.abc import Iterator, Sequence

import lacore as la
from lacore_verification.case import BRACKET, Case, Variant
from lacore_verification.catalogue.catalogue import Catalogue, catalogue
from lacore_verification.harness.campaigns.comparison import (
    capabilities,
    check_names,
    default_backends,
    default_couplings,
    is_regularised,
    pick,
    plan,
    planned,
)
from lacore_verification.runs.run import Run

LARGE = "large"
"""Tag of cases whose program is so large that the first comparison solves it once."""


def overview(
    backends: Sequence[str] = (), meshes: Sequence[str] = (), known: Catalogue | None = None
) -> list[Run]:
    """List the runs of the first comparison: paths first, then continua, then rigid bodies.

    The longest runs are first, so that no process waits for the last of them.

    Args:
        backends, meshes: Run these in place of those of the first comparison, on its variants;
            no bracket is computed then.
        known: Cases. None: those of lacore itself.

    Raises:
        InputError: A name is unknown.
    """
    known = catalogue() if known is None else known
    if list(backends) == ["all"]:
        backends = la.backend_names()
    check_names(backends, (), meshes, known)
    cases = [case for case, _ in pick((), known)]
    return [
        run
        for case in sorted(cases, key=_kind)
        for variant in variants(case)
        for run in _runs(case, variant, backends, meshes)
    ]


def everything(
    backends: Sequence[str] = (), meshes: Sequence[str] = (), known: Catalogue | None = None
) -> list[Run]:
    """List the runs of `plan` without a case, and those of the first comparison, case by case.

    Args:
        backends, meshes, known: As of `overview`.

    Raises:
        InputError: A name is unknown.
    """
    known = catalogue() if known is None else known
    found = {run.key: run for run in plan((), backends, meshes, (), known)}
    found |= {run.key: run for run in overview(backends, meshes, known) if run.key not in found}
    places = {case_id: place for place, case_id in enumerate(known)}
    return sorted(found.values(), key=lambda run: places[run.case.id])


def shown_first(case: Case) -> list[Variant]:
    """Return the first variant of a case, and the first of each other status that it ends with."""
    return _one_of_each_status(case, case.variants)


def variants(case: Case) -> list[Variant]:
    """Return the variant of the first comparison, and the first of each other status."""
    named = [variant for variant in case.variants if variant.name == case.first.variant]
    return _one_of_each_status(case, (*named, *case.variants))


def _one_of_each_status(case: Case, among: Sequence[Variant]) -> list[Variant]:
    by_status: dict[la.Status, Variant] = {}
    for variant in among:
        by_status.setdefault(case.reference_of(variant).status, variant)
    return [*by_status.values()]


def _kind(case: Case) -> int:
    return 0 if case.path is not None else 1 if case.meshed else 2


def _runs(
    case: Case, variant: Variant, backends: Sequence[str], meshes: Sequence[str]
) -> Iterator[Run]:
    main = variant is variants(case)[0]
    levels = _levels(case, variant, meshes, main)
    if backends and not levels:  # A case that is represented by its bracket alone.
        levels = case.levels(variant)[:1]
    for place, mesh in enumerate(levels):
        several = place == 0 and main and LARGE not in case.tags
        for backend in backends or _backends(case, variant, mesh, several):
            for coupling in default_couplings(case, variant, backend):
                yield planned(case, variant, mesh, backend, coupling)
    if main and case.first.bracket and not (backends or meshes):
        yield _bracket(case, variant)


def _levels(case: Case, variant: Variant, asked: Sequence[str], main: bool) -> tuple[str, ...]:
    """Return the given levels, those that the case names, or coarsest and finest."""
    levels = case.levels(variant, asked)
    if asked:
        return levels
    if main and case.first.meshes is not None:
        return case.first.meshes
    return tuple(dict.fromkeys((levels[0], levels[-1])))


def _backends(case: Case, variant: Variant, mesh: str, several: bool) -> list[str]:
    """Return the backends to compare on a mesh; without `several`, the first exact one."""
    found = default_backends(case, variant)
    if not several or case.path is not None:
        return [name for name in found if not is_regularised(name)][:1]
    if not case.meshed:
        return found
    coarsest = mesh == next(iter(case.meshes))
    can = {name: capabilities(name) for name in found}
    quick = [name for name in found if can[name].paths and not can[name].regularised]
    return [name for name in found if not can[name].dense] if coarsest else quick


def _bracket(case: Case, variant: Variant) -> Run:
    """Return the run that computes the bracket of the first comparison, with an exact backend."""
    (backend,) = _backends(case, variant, case.bracketed_from, several=False)
    settings = {"target_width": case.first.bracket}
    return Run(case, variant, case.bracketed_from, backend, BRACKET, settings=settings)
