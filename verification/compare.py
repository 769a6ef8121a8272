"""Compare backends on cases: plan the runs, run them, keep every row."""

from collections.abc import Callable, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from math import isfinite, isinf, isnan, nan
from pathlib import Path
from statistics import median

import lacore as la
from lacore.backend import load_backend
from lacore.coupling.names import COUPLINGS
from lacore.errors import require_known
from lacore.limit.solve import coupling_for
from verification.bracketing import BRACKET
from verification.case import Case, Variant
from verification.catalogue import Catalogue, catalogue, find
from verification.defaults import ON_DEMAND, RAW, TIME_LIMIT
from verification.execution import Executor, execute
from verification.judging import FAIL, NO_REFERENCE, NO_RESULT, PASS, SKIPPED
from verification.provenance import code_of, describe
from verification.run import Outcome, Row, Run
from verification.store import Store

PATHS = ("clarabel", "newton")
"""Backends that paths are compared with, each of them tens of solves; only the first where the
exact loads are not known, and of implicit schemes, which take several solves a step."""

LINEAR = ("highs",)
"""Those of them that rigid bodies are compared with."""


def plan(
    names: Sequence[str] = (),
    backends: Sequence[str] = (),
    meshes: Sequence[str] = (),
    couplings: Sequence[str] = (),
    known: Catalogue | None = None,
) -> list[Run]:
    """Runs of cases (``id`` or ``id:variant``; none: all) with backends on mesh levels.

    Cases are looked for in `known`; without it, among those of lacore itself.
    Without `names` all cases but those on demand. Without `backends` all registered ones but those
    `ON_DEMAND`, of rigid bodies those of linear programs too, and without those
    that cannot do a variant; ``all`` is every one of them, and variants of a family are named as
    ``cvxpy:SCS``. Without `meshes` the default levels of each variant. Without `couplings` the
    default one of each backend, and with exact ones ``associated`` where that is known to differ.

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
    """Raise `InputError` on an unknown name; of a missing backend the rows say so.

    Rigid bodies have no meshes, and run whatever level is asked for; one that no case at all has is
    a slip of the keyboard.
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
        require_known("coupling", name, [*COUPLINGS, *RAW, BRACKET])


def pick(names: Sequence[str], known: Catalogue) -> list[tuple[Case, list[Variant]]]:
    """Cases with those of their variants that are named; without names, as `plan`.

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
    """A run, skipped where it is known that the backend cannot do it."""
    known = False
    if coupling == "associated":
        with suppress(Exception):  # of others, at parameters of others: the row says so
            known = case.reference_of(variant).associated is not None
    skip, insist = _unfit(variant, backend), coupling is None or known
    # Penalties and smooth laws may be beyond a solver, which says so: only exact ones must answer.
    with suppress(la.CapabilityError):  # of a missing backend the row says so
        engine = load_backend(backend)
        insist |= coupling == coupling_for(engine, None)
        insist &= not engine.capabilities.regularised
        try:
            coupling_for(engine, RAW.get(coupling or "", (coupling, {}))[0])
        except la.InputError as error:
            skip = str(error)
    return Run(case, variant, mesh, backend, coupling, insist, skip)


def default_backends(case: Case, variant: Variant) -> list[str]:
    """Backends that a comparison runs when none is named."""
    linear = () if case.meshed else LINEAR
    names = la.backend_names() if case.path is None else _path_backends(case, variant)
    return [
        name
        for name in names
        if (name not in ON_DEMAND or name in linear) and not _unfit(variant, name)
    ]


def _path_backends(case: Case, variant: Variant) -> Sequence[str]:
    stated = case.following_of(variant)
    dear = stated.exact is None or stated.scheme.startswith("implicit")
    return PATHS[:1] if dear else PATHS


def default_couplings(case: Case, variant: Variant, backend: str) -> list[str | None]:
    """Couplings that a comparison runs when none is named."""
    telling = case.reference_of(variant).associated_differs
    return [None, "associated"] if telling and not is_regularised(backend) else [None]


def _unfit(variant: Variant, backend: str) -> str:
    """Why a backend cannot do a variant; empty where it can."""
    family = "regularised" if is_regularised(backend) else "exact"
    return variant.unfit.get(backend, variant.unfit.get(family, ""))


def is_regularised(backend: str) -> bool:
    """Whether a backend is known to be regularised; not of one that is missing."""
    with suppress(la.CapabilityError):
        return load_backend(backend).capabilities.regularised
    return False


@dataclass(frozen=True)
class Tally:
    """How many runs ended how."""

    passed: int
    failed: int
    skipped: int
    no_result: int
    no_reference: int

    @property
    def text(self) -> str:
        """One line."""
        rare = {NO_RESULT: self.no_result, NO_REFERENCE: self.no_reference}
        parts = [f"{self.passed} pass", f"{self.failed} FAIL", f"{self.skipped} skipped"]
        return ", ".join(parts + [f"{count} {kind}" for kind, count in rare.items() if count])


def tally(outcomes: Sequence[Outcome]) -> Tally:
    """Count verdicts."""
    verdicts = [outcome.row.verdict for outcome in outcomes]
    kinds = (PASS, FAIL, SKIPPED, NO_RESULT, NO_REFERENCE)
    return Tally(*(verdicts.count(kind) for kind in kinds))


@dataclass(frozen=True)
class Effort:
    """What a coupling came to with one backend.

    Attributes:
        backend, coupling: names.
        cases: runs that were to end with a number.
        solved: how many of them ended with a certified one.
        median, most: inner solves of these; NaN without any.
        failed: runs judged wrong.
    """

    backend: str
    coupling: str
    cases: int
    solved: int
    median: float
    most: float
    failed: int


def efforts(outcomes: Sequence[Outcome]) -> list[Effort]:
    """Each coupling with each backend, over all variants that have a load factor.

    That is known, or some coupling has found one. Brackets are no couplings.
    """
    outcomes = [outcome for outcome in outcomes if outcome.row.coupling != BRACKET]
    solved = la.Status.SOLVED.label
    finite_ones = {
        (row.case, row.variant)
        for row in (outcome.row for outcome in outcomes)
        if isfinite(row.reference) or (isnan(row.reference) and row.status == solved)
    }
    by_pair: dict[tuple[str, str], list[Row]] = {}
    for row in (outcome.row for outcome in outcomes):
        if row.verdict != SKIPPED:
            by_pair.setdefault((row.backend, row.coupling), []).append(row)
    found = []
    for (backend, coupling), rows in by_pair.items():
        finite = [
            row
            for row in rows
            if (row.case, row.variant) in finite_ones and not isinf(row.reference)
        ]
        solves = [row.outer_iterations for row in finite if row.status == solved]
        found.append(
            Effort(
                backend,
                coupling,
                cases=len(finite),
                solved=len(solves),
                median=median(solves) if solves else nan,
                most=max(solves, default=nan),
                failed=sum(row.verdict == FAIL for row in rows),
            )
        )
    return found


def run_all(
    runs: Sequence[Run],
    path: Path,
    on_start: Callable[[Run], None] = lambda _: None,
    on_finish: Callable[[Outcome], None] = lambda _: None,
    executor: Executor = execute,
    time_limit: float = TIME_LIMIT,
    fresh: bool = False,
) -> list[Outcome]:
    """Outcomes of runs, in their order; each is in the store at `path` as soon as it is finished.

    Those that are there already, by the same code, are not run again, unless all is to be `fresh`.
    `executor` runs them; `time_limit`: s, of a run; one that takes longer, or whose process dies,
    costs its own row.

    Raises:
        InputError: the store cannot be used.
    """
    codes = {run.key: code_of(run) for run in runs}
    with Store(path, describe()) as store:
        found = {} if fresh else store.settled((run, codes[run.key]) for run in runs)
        for outcome in found.values():
            on_finish(outcome)
        due = list({run.key: run for run in runs if run.key not in found}.values())
        with closing(executor(due, time_limit=time_limit, on_start=on_start)) as outcomes:
            for outcome in outcomes:
                store.append(outcome, codes[outcome.run.key])
                found[outcome.run.key] = outcome
                on_finish(outcome)
    return [found[run.key] for run in runs]
