"""What a verification case is: a problem, its reference, and how far a result may lie from it."""

from __future__ import annotations  # not evaluated: names of lacore in them load nothing

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from math import inf, isclose, isfinite, isnan, nan
from typing import TYPE_CHECKING, Any

import lacore as la
from lacore.errors import require_known
from verification.bracketing import Bracketing
from verification.following import Following
from verification.guard import guarded

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_OURS = ("verification.cases.", "verification.fuzz.")
KINDS = ("continuum", "blocks", "frames", "contact", "hardening")
"""Tags that say what a case is about; every case of lacore has one at least, and free ones."""

SOLVER = 1e-6  # relative: bar of the certificate, so what a certified value may be off by
EXACT = 1e-5  # relative: the exact mechanism lies in the velocity space, what is left is solving


JAM = {"regularised": "only the certified loop tells jamming; the reaction loop goes on and on"}
CLAMPED = {"regularised": "penalties let go where nothing determines the clamping forces"}


UNKNOWN_KINDS = ("none", "no closed form", "unknown")
"""Kinds that say that nothing is known; only with them a reference may be NaN."""


@dataclass(frozen=True)
class Reference:
    """What must come out: a load factor, an interval of them, or a status.

    Attributes:
        value: in units of the case; of an interval its lower end. +inf where the status is LOCKED
            or JAM, -inf where it is UNSAFE; NaN where the kind says that nothing is known.
        formula: as text.
        source: where it comes from.
        kind: ``exact``, ``exact, numerical`` (integrated to all digits given), ``bracket``,
            ``interval`` (of Coulomb load factors: any certified one inside is right), ``status``,
            or one of `UNKNOWN_KINDS`: then there is nothing to pass.
        half_width: the reference is ``value +- half_width``.
        up_to: upper end of an interval.
        status: with which a Coulomb loop must end.
        associated: load factor with associated friction, +inf where nothing bounds it; None where
            it is not known, or no other.
        complete: whether there are no other Coulomb load factors; else the interval is that of one
            mechanism, others may carry other loads, and only `associated` bounds them.
    """

    value: float
    formula: str
    source: str
    kind: str
    half_width: float = 0.0
    up_to: float | None = None
    status: la.Status = la.Status.SOLVED
    associated: float | None = None
    complete: bool = True

    @property
    def unknown(self) -> bool:
        """Whether its kind says that there is nothing to compare with."""
        return self.kind in UNKNOWN_KINDS

    @property
    def wrong(self) -> str:
        """Why nothing can be judged by it, though its kind says so; empty where all is well.

        NaN and a distance without bounds are no references: comparisons with them are void.
        """
        if self.unknown:
            return ""
        if isnan(self.value):
            return f"the reference is NaN, and its kind {self.kind!r} does not say unknown"
        if not (isfinite(self.half_width) and self.half_width >= 0):
            return f"the reference is known to +- {self.half_width:g} only"
        known = (self.up_to, self.associated)
        if any(value is not None and isnan(value) for value in known) or self.high < self.low:
            return f"the reference [{self.low:g}, {self.high:g}] is no interval"
        return ""

    @property
    def low(self) -> float:
        """Lower end of what is right."""
        return self.value - self.half_width

    @property
    def high(self) -> float:
        """Upper end of what is right."""
        return self.value + self.half_width if self.up_to is None else self.up_to

    @property
    def text(self) -> str:
        """For tables: ``[1.26667, 1.6]``, ``2.197 ± 0.003``, ``jam``."""
        if self.status is not la.Status.SOLVED:
            return self.status.label
        if isnan(self.value):
            return "unknown"
        if self.up_to is not None:
            return f"[{self.value:.7g}, {self.up_to:.7g}]"
        return f"{self.value:.7g}" + (f" ± {self.half_width:g}" if self.half_width else "")

    @property
    def associated_differs(self) -> bool:
        """Whether associated friction is known to carry another load, or one of an interval."""
        if self.associated is None:
            return False
        return self.up_to is not None or not isclose(self.associated, self.value)

    def of_associated(self) -> Reference:
        """What associated friction must give, where that is known."""
        assert self.associated is not None
        status = la.Status.LOCKED if self.associated == inf else la.Status.SOLVED
        return Reference(
            self.associated, f"associated: {self.formula}", self.source, self.kind, status=status
        )


UNKNOWN = Reference(nan, "none is listed at these parameters", "", "none", complete=False)


@dataclass(frozen=True)
class Band:
    """Relative discretisation error that is allowed, and why.

    Attributes:
        below, above: of the reference, both >= 0.
        reason: how they were derived.
        scale: load factor that stands for the size of the dead loads. They pass their errors on to
            a reference that is small against them, or 0: `below` and `above` are of the larger.
    """

    below: float
    above: float
    reason: str
    scale: float = 0.0

    @property
    def wrong(self) -> str:
        """Why nothing can be judged with it; empty where all is well."""
        if all(isfinite(own) and own >= 0 for own in (self.below, self.above, self.scale)):
            return ""
        return f"a band of -{self.below:g} ... +{self.above:g}, scale {self.scale:g}, is none"

    def size(self, value: float) -> float:
        """What the band of a value is relative to; an infinite one needs none."""
        return max(abs(value), self.scale) if isfinite(value) else 0.0


@dataclass(frozen=True)
class Convergence:
    """Relative error as measured under refinement, ``coefficient * elements**-order``.

    Attributes:
        coefficient, order: fitted with the exact backend on meshes graded like those of the case.
        fitted: which meshes, which errors: for the reader of the report.
        safety: factor on the fit: results scatter about a fit, other meshes are not nested.
    """

    coefficient: float
    order: float
    fitted: str
    safety: float = 1.3

    def error(self, elements: int) -> float:
        """Fitted relative error of a mesh."""
        return float(self.coefficient * elements**-self.order)

    def strict(self, elements: int) -> Band:
        """Band of a strict upper bound: never below the reference."""
        return Band(
            below=SOLVER,
            above=self.safety * self.error(elements),
            reason=f"A strict upper bound (vertex rule, exact geometry): never below the reference"
            f" by more than the solver tolerance {SOLVER:g}. {self._fit(elements)}",
        )

    def two_sided(self, elements: int, why: str) -> Band:
        """Band of a value that is not a bound."""
        allowed = self.safety * self.error(elements)
        return Band(
            below=allowed, above=allowed, reason=f"Not a bound: {why} {self._fit(elements)}"
        )

    def _fit(self, elements: int) -> str:
        return (
            f"Error measured under refinement: {self.coefficient:.3g} N^-{self.order:.2f} for N"
            f" elements ({self.fitted}); allowed {self.safety:g} times that,"
            f" {100 * self.safety * self.error(elements):.3g} % at N = {elements}."
        )


def exact_patch(why: str) -> Band:
    """Band of a case whose exact mechanism lies in the velocity space of every mesh level."""
    return Band(
        below=EXACT,
        above=EXACT,
        reason=f"Exact on every mesh: {why} What is left is the solver, {EXACT:g}.",
    )


def rigid(dead: float) -> Band:
    """Band of rigid blocks and frames: there is no discretisation error.

    Args:
        dead: load factor at which the live load is as large as the dead load.
    """
    return Band(
        below=SOLVER,
        above=SOLVER,
        reason=f"Rigid bodies are exact: what is left is what the certificate lets through,"
        f" {SOLVER:g} of the load factor or, if larger, of the dead loads.",
        scale=dead,
    )


@dataclass(frozen=True)
class Order:
    """Order of convergence that refinement must show.

    Attributes:
        meshes: a ladder of at least four sizes, coarse to fine: keyword arguments of `Case.build`.
        expected: p of ``error ~ elements**-p``, from a regression over the ladder.
        tolerance: on p, either way.
        reason: where both come from.
    """

    meshes: Sequence[Mapping[str, Any]]
    expected: float
    tolerance: float
    reason: str

    def holds(self, order: float) -> bool:
        """Whether a measured order is the expected one; never NaN."""
        return abs(order - self.expected) <= self.tolerance


@dataclass(frozen=True)
class Variant:
    """One setting of a case's parameters.

    Attributes:
        name: unique in the case.
        parameters: keyword arguments of `Case.build`, `Case.reference` and `Case.band`.
        meshes: levels that are run by default; none: the two coarsest, or the only one there is.
        unfit: backends that cannot do it, or ``regularised`` for all that are, and why.
    """

    name: str
    parameters: Mapping[str, float | bool | str]
    meshes: tuple[str, ...] = ()
    unfit: Mapping[str, str] = field(default_factory=dict)


BLOCKS: Mapping[str, Mapping[str, Any]] = {"blocks": {}}
"""The one level of a case without meshes."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """A verification case.

    Attributes:
        id: unique.
        title: one line.
        tags: for finding it: some of `KINDS`, and free ones.
        unit: of the load factor.
        explanation: paragraphs; indented ones are a sketch.
        hand_calculation: how the reference is found with pencil and paper, line by line.
        meshes: levels, coarse to fine: keyword arguments of `build`; rigid bodies have none.
        build: the problem, from those of a mesh level and a variant.
        reference: the reference of a variant.
        band: allowed error from the number of elements and the parameters of a variant.
        variants: settings, in the order of the report.
        sweep: parameter against which a figure of the load factor is drawn; empty for none.
        valid: whether the closed form holds at the parameters of a variant; its docstring says why.
        on_demand: whether it is run only when it is named.
        order: what refinement must show, from the parameters of a variant; None where no order is
            expected, or known.
        bracket: what is asked of a lower and an upper bound around it; None for none. Rigid bodies
            have none in any case.
        path: how a variant is followed through large deformation, from its parameters, which are
            then to have those of `verification.following.STEPPING`; None: one limit problem.
            `reference` and `band` are those of the last load, the band of all others, too.
        sketch: draws onto a sketch of the problem (`lacore.Problem.plot`) what it does not show,
            lines of a mechanism, say; called with the axes and the problem.
    """

    id: str
    title: str
    tags: tuple[str, ...]
    unit: str
    explanation: str
    hand_calculation: str
    meshes: Mapping[str, Mapping[str, Any]] = field(default_factory=lambda: BLOCKS)
    build: Callable[..., la.Problem]
    reference: Callable[..., Reference]
    band: Callable[..., Band]
    variants: tuple[Variant, ...]
    sweep: str = ""
    valid: Callable[..., bool] | None = None
    on_demand: bool = False
    order: Callable[..., Order | None] | None = None
    bracket: Bracketing | None = field(default_factory=Bracketing)
    path: Callable[..., Following] | None = None
    sketch: Callable[[Axes, la.Problem], None] | None = None

    @property
    def meshed(self) -> bool:
        """Whether there are meshes to choose from."""
        return "blocks" not in self.meshes

    def levels(self, variant: Variant, asked: Sequence[str] = ()) -> tuple[str, ...]:
        """Mesh levels to run of a variant: those asked for, or its own.

        Raises:
            InputError: an unknown level, of a case that has meshes.
        """
        if not self.meshed:
            return tuple(self.meshes)
        for mesh in asked:
            require_known(f"mesh of case {self.id!r}", mesh, self.meshes)
        return tuple(dict.fromkeys(asked or variant.meshes or tuple(self.meshes)[:2]))

    def problem(self, variant: Variant, mesh: str) -> la.Problem:
        """The problem of a variant on a mesh level."""
        return self.problem_of(self.meshes[mesh], variant.parameters)

    def problem_of(self, size: Mapping[str, Any], parameters: Mapping[str, Any]) -> la.Problem:
        """The problem of any size and parameters, keyword arguments of `build`."""
        with guarded():
            return self.build(**size, **parameters)

    def reference_of(self, variant: Variant) -> Reference:
        """The reference of a variant; of one that is not listed, where only a table is, unknown.

        Raises:
            LookupError: a variant of the case is not in its table.
        """
        try:
            return self.reference(**variant.parameters)
        except LookupError:
            if variant in self.variants:
                raise
            return UNKNOWN

    def band_of(self, variant: Variant, elements: int) -> Band:
        """The band of a variant."""
        return self.band(elements, **variant.parameters)

    @property
    def bracketed_from(self) -> str:
        """Mesh level that a bracket starts from."""
        named = "" if self.bracket is None else self.bracket.mesh
        return named or next(iter(self.meshes))

    def following_of(self, variant: Variant) -> Following:
        """How a variant of a path is followed."""
        assert self.path is not None
        return self.path(**variant.parameters)

    def order_of(self, variant: Variant) -> Order | None:
        """What refinement must show of a variant; None where nothing is expected."""
        return None if self.order is None else self.order(**variant.parameters)


def is_of_lacore(case: Case) -> bool:
    """Whether a case is known to be harmless; what others wrote may do anything."""
    build = case.build.func if isinstance(case.build, partial) else case.build
    return getattr(build, "__module__", "").startswith(_OURS)
