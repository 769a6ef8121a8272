"""The runs of a first look: all that a suite shows of itself in a minute, and what is left to ask.

Chosen by what is known beforehand, never by measured times, so that everybody runs the same: of
each case the first variant, and the first of each other status that a variant must end with; on
the coarsest mesh all backends, but dense ones of rigid bodies only; on the finest mesh of the
variant, and along paths, the first exact backend.
"""

from collections.abc import Sequence

import lacore as la
from verification.campaigns.comparison import (
    capabilities,
    check_names,
    default_backends,
    default_couplings,
    is_regularised,
    pick,
    planned,
)
from verification.case import Case, Variant
from verification.catalogue.catalogue import Catalogue, catalogue
from verification.runs.run import Run


def overview(
    backends: Sequence[str] = (), meshes: Sequence[str] = (), known: Catalogue | None = None
) -> list[Run]:
    """Runs of a first look, bodies that deform first, then rigid ones, then paths.

    They are some of those of `verification.campaigns.comparison.plan`, and have the same keys.

    Args:
        backends, meshes: to run in place of those of a first look, on its variants.
        known: cases; None: those of lacore itself.

    Raises:
        InputError: an unknown name.
    """
    known = catalogue() if known is None else known
    if list(backends) == ["all"]:
        backends = la.backend_names()
    check_names(backends, (), meshes, known)
    cases = [case for case, _ in pick((), known)]
    return [
        planned(case, variant, mesh, backend, coupling)
        for case in sorted(cases, key=_kind)
        for variant in shown_first(case)
        for mesh in _levels(case, variant, meshes)
        for backend in backends or _backends(case, variant, mesh)
        for coupling in default_couplings(case, variant, backend)
    ]


def shown_first(case: Case) -> list[Variant]:
    """The first variant, and the first of each other status that one must end with."""
    by_status: dict[la.Status, Variant] = {}
    for variant in case.variants:
        by_status.setdefault(case.reference_of(variant).status, variant)
    return [*by_status.values()]


def _kind(case: Case) -> int:
    return 2 if case.path is not None else 0 if case.meshed else 1


def _levels(case: Case, variant: Variant, asked: Sequence[str]) -> tuple[str, ...]:
    """Those asked for, or the coarsest and the finest of those that the variant runs."""
    levels = case.levels(variant, asked)
    return levels if asked else tuple(dict.fromkeys((levels[0], levels[-1])))


def _backends(case: Case, variant: Variant, mesh: str) -> list[str]:
    found = default_backends(case, variant)
    exact = [name for name in found if not is_regularised(name)]
    if case.path is not None or mesh != case.levels(variant)[0]:
        return exact[:1]
    return [name for name in found if not (case.meshed and capabilities(name).dense)]
