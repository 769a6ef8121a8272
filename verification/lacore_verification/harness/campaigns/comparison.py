"""Comparison of backends on cases: plan the runs, run them, keep every row."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import lacore as la
from lacore.coupling.kinds import ASSOCIATED, COUPLINGS, coupling_for
from lacore.reporting.errors import require_known
from lacore.solvers.backend import Capabilities, load_backend
from lacore.solvers.registry import fault_of, rejected_backends
from lacore_verification.case import Case, Variant
from lacore_verification.case.band import BRACKET
from lacore_verification.case.case import RANGE
from lacore_verification.catalogue.catalogue import Catalogue, catalogue, find
from lacore_verification.defaults import RAW
from lacore_verification.runs.run import Run


def plan(
    names: Sequence[str] = (),
    backends: Sequence[str] = (),
    meshes: Sequence[str] = (),
    couplings: Sequence[str] = (),
    known: Catalogue | None = None,
) -> list[Run]:
    """Return runs of cases (``id`` or ``id:variant``; none: all) with backends on mesh levels.

    Cases are searched in `known`; without it, among those of lacore itself. Without `names` all
    cases but those on demand. Without `backends` those of `default_backends`; ``all`` is every
    registered one, and variants of a family are named as ``cvxpy:SCS``. Without `meshes` the
    default levels of each variant. Without `couplings` the default one of each backend, and with
    exact ones ``associated`` if its result is known to differ.

    Raises:
        InputError: an unknown name.
    """
    known = catalogue() if known is None else known
    if list(backends) == ["all"]:
        backends = la.backend_names()
    check_names(backends, couplings, meshes, known)
    return [
        planned(case, variant, mesh, backend, coupling)
        for case, variants in pick(names, known)
        for variant in variants
        for mesh in case.levels(variant, meshes)
        for backend in dict.fromkeys(backends or default_backends(case, variant))
        for coupling in dict.fromkeys(couplings or default_couplings(case, variant, backend))
    ]


def check_names(
    backends: Sequence[str], couplings: Sequence[str], meshes: Sequence[str], known: Catalogue
) -> None:
    """Raise `InputError` for an unknown name; rows report missing backends.

    Rigid bodies have no meshes, and run with any level; a level that no case has is a typing error.
    """
    if meshes:
        cases = (*catalogue().values(), *known.values())
        levels = {level for case in cases for level in case.meshes}
        for name in meshes:
            require_known("mesh", name, levels)
    for name in backends:
        with suppress(la.CapabilityError):
            load_backend(name)
    for name in couplings:
        require_known("coupling", name, [*COUPLINGS, *RAW, BRACKET, RANGE])


def pick(names: Sequence[str], known: Catalogue) -> list[tuple[Case, list[Variant]]]:
    """Return cases with their selected variants; without names, as `plan`.

    Raises:
        InputError: an unknown name.
    """
    picked: dict[str, list[str]] = {}
    for name in names or (case.id for case in known.values() if not case.on_demand):
        case, variants = find(name, known)
        picked.setdefault(case.id, []).extend(variant.name for variant in variants)
    return [
        (known[case_id], [one for one in known[case_id].variants if one.name in chosen])
        for case_id, chosen in picked.items()
    ]


def planned(case: Case, variant: Variant, mesh: str, backend: str, coupling: str | None) -> Run:
    """Return a run, which is skipped if the backend is known not to support it."""
    # One convex program has a solution, or a proof that it has none; other loops may not converge.
    skip, insist = _unfit(variant, backend), coupling in (None, ASSOCIATED)
    # Penalties and smooth laws may exceed a solver, which reports it: only exact ones must solve.
    with suppress(la.CapabilityError):  # The row reports a missing backend.
        engine = load_backend(backend)
        insist |= coupling == coupling_for(engine, None)
        insist &= not engine.capabilities.regularised
        name = RAW.get(coupling or "", (coupling, {}))[0]
        try:
            if name in COUPLINGS:  # Brackets and ranges choose their backends.
                coupling_for(engine, name)
        except la.InputError as error:
            skip = str(error)
    return Run(case, variant, mesh, backend, coupling, insist, skip)


def default_backends(case: Case, variant: Variant) -> list[str]:
    """Return backends that a comparison runs by default, by their capabilities.

    None on demand, none that cannot be loaded, none that do not support the variant; linear
    programs are for rigid bodies, and pressure-dependent strengths are for backends that support
    surfaces. Paths, tens of solves each, are for the fast ones; where the exact loads are not
    known, and for implicit schemes, which take several solves per step, for the exact ones of them.
    """
    usable = (name for name in la.backend_names() if not (fault_of(name) or _unfit(variant, name)))
    found = {name: capabilities(name) for name in usable}
    names = [name for name, can in found.items() if not can.on_demand]
    if case.meshed:
        names = [name for name in names if not found[name].linear_only]
    if case.surfaces:
        names = [name for name in names if found[name].surfaces]
    if case.path is not None:
        dear = _is_dear(case, variant)
        names = [name for name in names if found[name].paths]
        names = [name for name in names if not (dear and found[name].regularised)]
    return names


def _is_dear(case: Case, variant: Variant) -> bool:
    stated = case.following_of(variant)
    return stated.exact is None or stated.scheme.startswith("implicit")


def default_couplings(case: Case, variant: Variant, backend: str) -> list[str | None]:
    """Return couplings that a comparison runs by default."""
    telling = case.reference_of(variant).associated_differs
    return [None, "associated"] if telling and not is_regularised(backend) else [None]


def _unfit(variant: Variant, backend: str) -> str:
    """Return why a backend cannot solve a variant; empty if it can."""
    family = "regularised" if is_regularised(backend) else "exact"
    return variant.unfit.get(backend, variant.unfit.get(family, ""))


def is_regularised(backend: str) -> bool:
    """Return whether a backend is known to be regularised; False for a missing one."""
    return capabilities(backend).regularised


def capabilities(backend: str) -> Capabilities:
    """Return the capabilities of a backend; for a missing one, the default."""
    with suppress(la.CapabilityError):
        return load_backend(backend).capabilities
    return Capabilities(regularised=False)


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
