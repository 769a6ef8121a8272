"""Checks of each case with each backend, and the runs that they need."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import lacore as la
from lacore_verification.case import Case, Reference, Variant
from lacore_verification.case.band import BRACKET
from lacore_verification.case.case import RANGE
from lacore_verification.catalogue.catalogue import Catalogue
from lacore_verification.harness.campaigns.comparison import capabilities, is_regularised, plan
from lacore_verification.harness.campaigns.overview import shown_first
from lacore_verification.harness.verdicts.bracket import between
from lacore_verification.harness.verify.nature import Nature, nature_of
from lacore_verification.runs.run import Run

CHECKS: Mapping[str, str] = {
    "value": "the load factor lies in the band of the reference",
    "status": "the solve ends with the status that the case must end with",
    "side": "a strict upper bound is not below the reference, lambda not above the exact value",
    "residuals": "the residuals, computed afresh from the stored state, prove it",
    "order": "the error falls under refinement as the case says",
    "bracket": "a proven lower and a proven upper bound enclose the reference, closely enough",
    "range": "the lowest and the highest load factor found are where they may be, both certified",
    "path": "a path ends as it must, and all of its loads lie in the band of the exact ones",
    "steps": "the error of a path falls with its steps as the scheme says",
    "gap": "shares of elements add up to the gap between both bounds, and none is below 0",
}
"""Description of each check, by name."""


@dataclass(frozen=True)
class Question:
    """One check of a variant of a case with a backend.

    Attributes:
        check: a name of `CHECKS`.
        runs: of one variant, backend and coupling.
        exact: for a regularised backend and ``side``: the corresponding runs of an exact backend.
        coulomb: for a bracket: whether the problem has Coulomb friction, which is made associated.
    """

    check: str
    runs: tuple[Run, ...]
    exact: tuple[Run, ...] = ()
    coulomb: bool = False

    @property
    def case(self) -> Case:
        """The case."""
        return self.runs[0].case

    @property
    def variant(self) -> Variant:
        """Return its variant."""
        return self.runs[0].variant

    @property
    def backend(self) -> str:
        """The backend."""
        return self.runs[0].backend

    @property
    def coupling(self) -> str:
        """The coupling; empty for the default one."""
        return self.runs[0].coupling or ""

    @property
    def reference(self) -> Reference:
        """Return the reference of its coupling."""
        if self.coupling == BRACKET:
            return between(self.case.reference_of(self.variant), self.coulomb)
        return _reference(self.case, self.variant, self.coupling)

    @property
    def name(self) -> str:
        """Return a name such as ``prandtl-punch:smooth-clarabel-order``."""
        parts = (f"{self.case.id}:{self.variant.name}", self.backend, self.coupling, self.check)
        return "-".join(dict.fromkeys(part for part in parts if part))


def ask(
    names: Sequence[str] = (),
    backends: Sequence[str] = (),
    meshes: Sequence[str] = (),
    known: Catalogue | None = None,
) -> list[Question]:
    """Return questions on cases (``id`` or ``id:variant``; none: all but those on demand).

    Without any names, expensive ones on further variants of a case are omitted, see `left_out`.
    Without `backends` those of a comparison; only the first exact one runs the ladder of an order,
    which is a property of the discretisation; and so for a bracket, with any names. Without
    `meshes` exact backends run the levels of each variant, regularised ones the coarsest of them;
    ladders and brackets have separate meshes.

    Raises:
        InputError: an unknown name.
    """
    left = {run.key for run in left_out(names, backends, meshes, known)}
    groups = _by_variant(names, backends, meshes, known)
    return [
        question
        for runs in groups
        for question in _of_variant([run for run in runs if run.key not in left], bool(backends))
        if not any(run.key in left for run in question.runs)
    ]


def _by_variant(
    names: Sequence[str], backends: Sequence[str], meshes: Sequence[str], known: Catalogue | None
) -> list[list[Run]]:
    """Return runs of a comparison, by variant; without given meshes, those of `_quick`."""
    groups: dict[tuple[str, str], list[Run]] = {}
    for run in plan(names, backends, meshes, known=known):
        groups.setdefault((run.case.id, run.variant.name), []).append(run)
    return [runs if meshes else _quick(runs) for runs in groups.values()]


def left_out(
    names: Sequence[str] = (),
    backends: Sequence[str] = (),
    meshes: Sequence[str] = (),
    known: Catalogue | None = None,
) -> list[Run]:
    """Return expensive and less informative runs, which are omitted without names.

    For variants that are not among the first (`shown_first`): dense backends, those that are slow
    on soils, and further exact ones on meshes, brackets, and regularised ones along paths. These
    solve the first variant, and the first exact one solves all.
    """
    if names or backends or meshes:
        return []
    left: list[Run] = []
    for runs in _by_variant((), (), (), known):
        if runs[0].variant in shown_first(runs[0].case):
            continue
        exact = [run.backend for run in runs if not is_regularised(run.backend)]
        most = [run for run in runs if not _tells_least(run, exact[:1])]
        if not most:
            continue
        left += [run for run in runs if run not in most]
        asked = [one for one in _of_variant(most, each=False) if one.check == "bracket"]
        left += [run for question in asked for run in question.runs]
    return left


def _tells_least(run: Run, first: Sequence[str]) -> bool:
    regularised = is_regularised(run.backend)
    if run.case.path is not None:
        return regularised
    further = not regularised and run.backend not in first
    can = capabilities(run.backend)
    slow = can.dense or (can.slow_surfaces and run.case.surfaces)
    return run.case.meshed and (further or slow)


def runs_of(questions: Sequence[Question]) -> list[Run]:
    """Return every run that is needed, once; consecutive runs share their problem if possible.

    Expensive runs are first: one that is started last would keep all other processes waiting.
    """
    runs = {run.key: run for question in questions for run in (*question.runs, *question.exact)}
    problems: dict[tuple[object, ...], list[Run]] = {}
    for run in runs.values():
        problems.setdefault(run.problem_key, []).append(run)
    shared = [run for neighbours in problems.values() for run in neighbours]
    return sorted(shared, key=lambda run: not _dear(run))


def _dear(run: Run) -> bool:
    """Return whether a run takes tens of solves, or has a backend with slow solves."""
    several = run.coupling in (BRACKET, RANGE) or run.case.path is not None
    return several or capabilities(run.backend).dense


def _quick(runs: Sequence[Run]) -> list[Run]:
    coarsest = runs[0].mesh
    return [run for run in runs if run.mesh == coarsest or not is_regularised(run.backend)]


def _of_variant(runs: Sequence[Run], each: bool) -> Iterator[Question]:
    """Yield questions on a variant; `each` is whether each exact backend checks the order."""
    case, variant = runs[0].case, runs[0].variant
    if case.path is not None:
        yield from _of_path(runs)
        return
    nature = nature_of(case, variant, runs[0].mesh)
    solvers: dict[tuple[str, str | None], list[Run]] = {}
    for run in runs:
        solvers.setdefault((run.backend, run.coupling), []).append(run)
    exact = [run for run in runs if run.coupling is None and not is_regularised(run.backend)]
    for (backend, coupling), group in solvers.items():
        reference = _reference(case, variant, coupling or "")
        if reference.status is not la.Status.SOLVED:
            yield Question("status", tuple(group))
            continue
        yield Question("value", tuple(group))
        if is_regularised(backend):
            if nature.normal:
                yield from _beside(group, exact)
        elif nature.strict and (nature.normal or coupling) and not reference.unknown:
            yield Question("side", tuple(group))
        yield Question("residuals", tuple(group))
        if coupling is None:
            first = bool(exact) and backend == exact[0].backend
            yield from _of_default_loop(group[0], nature, first, each)


def _of_default_loop(run: Run, nature: Nature, first: bool, each: bool) -> Iterator[Question]:
    """Yield questions on the default loop of a backend, most for the `first` exact one only."""
    if first and nature.bounded:
        yield from _bracket(run, not nature.normal)
    if first and nature.ranged:
        yield Question("range", (replace(run, coupling=RANGE),))
    if first or (each and not is_regularised(run.backend)):
        yield from _ladder(run)


def _of_path(runs: Sequence[Run]) -> Iterator[Question]:
    """Yield questions on loads and last states of paths, and on steps with one exact backend."""
    for backend in dict.fromkeys(run.backend for run in runs):
        group = tuple(run for run in runs if run.backend == backend)
        yield Question("path", group)
        yield Question("residuals", group)
    exact = next((run for run in runs if not is_regularised(run.backend)), None)
    if exact is None:
        return
    ladder = exact.case.following_of(exact.variant).ladder
    stepped = [_stepped(exact, steps) for steps in ladder]
    if stepped:  # The run of the variant is first, as the question is one on it.
        yield Question("steps", tuple(sorted(stepped, key=lambda run: run.key != exact.key)))


def _stepped(run: Run, steps: int) -> Run:
    """Return a run with another number of steps."""
    variant = run.variant
    if variant.parameters["steps"] == steps:
        return run
    named = f"{variant.name}-steps-{steps}"
    return replace(
        run, variant=replace(variant, name=named, parameters={**variant.parameters, "steps": steps})
    )


def _beside(group: Sequence[Run], exact: Sequence[Run]) -> Iterator[Question]:
    """Yield the side of regularised values if there are exact ones of the same problems."""
    partners = {run.mesh: run for run in reversed(exact)}
    runs = tuple(run for run in group if run.mesh in partners)
    if runs:
        yield Question("side", runs, tuple(partners[run.mesh] for run in runs))


def _ladder(run: Run) -> Iterator[Question]:
    order = run.case.order_of(run.variant)
    if order is not None:
        yield Question(
            "order",
            tuple(
                Run(run.case, run.variant, run.mesh, run.backend, skip=run.skip, size=size)
                for size in order.meshes
            ),
        )


def _bracket(run: Run, coulomb: bool) -> Iterator[Question]:
    """Yield questions on a deformable body that has a load factor with any friction."""
    case, variant = run.case, run.variant
    if case.bracket is None or not case.meshed:
        return
    if between(case.reference_of(variant), coulomb).status is not la.Status.SOLVED:
        return
    asked = Run(case, variant, case.bracketed_from, run.backend, BRACKET, skip=run.skip)
    for check in ("bracket", "gap"):
        yield Question(check, (asked,), coulomb=coulomb)


def _reference(case: Case, variant: Variant, coupling: str) -> Reference:
    reference = case.reference_of(variant)
    if coupling == "associated" and reference.associated is not None:
        return reference.of_associated()
    return reference
