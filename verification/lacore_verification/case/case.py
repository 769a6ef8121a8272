"""Verification case: a problem, its reference, and the allowed error of results."""

from __future__ import annotations  # Annotations are not evaluated, so they do not load lacore.

import contextlib
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

import lacore as la
from lacore.reporting.errors import require_known
from lacore_verification.case.band import Band, Bracketing, Order
from lacore_verification.case.following import Following
from lacore_verification.case.reference import UNKNOWN, Reference

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_OURS = ("lacore_verification.cases.", "lacore_verification.fuzz.")
KINDS = ("continuum", "blocks", "frames", "contact", "hardening")
"""Main tags of cases; every case of lacore has at least one, and may have others."""


JAM = {"regularised": "only the certified loop tells jamming; the reaction loop does not end"}
CLAMPED = {"regularised": "penalties let go where nothing determines the clamping forces"}
RANGE = "range"
"""Name used as coupling in runs that search for low and high load factors (T59)."""
CLOSE = 0.05
"""Relative: the largest distance from the reference that a run of the first comparison may have."""


@dataclass(frozen=True)
class Beside:
    """Load factor of others, shown on the page of a case without being assessed.

    Attributes:
        name: its name, such as ``Davis's strength``.
        value: in units of the case.
        source: its origin, and what it proves.
        half_width: the range is ``value +- half_width``.
    """

    name: str
    value: float
    source: str
    half_width: float = 0.0


@dataclass(frozen=True)
class First:
    """The runs of a case in the first comparison; each must be within `CLOSE` of the reference.

    If the coarsest mesh is too coarse for that, a case names another mesh or variant, or a bracket.
    The coarse meshes are run by ``lacore compare --all``.

    Attributes:
        variant: Name of the variant to run. Empty: the first one of the case.
        meshes: Levels to run, the first of them with several backends, all others with one exact
            backend. None: the coarsest and the finest level of the variant.
        bracket: Width of a bracket to compute in addition, relative to its mean. 0: no bracket.
    """

    variant: str = ""
    meshes: tuple[str, ...] | None = None
    bracket: float = 0.0


@dataclass(frozen=True)
class Variant:
    """One setting of a case's parameters.

    Attributes:
        name: unique in the case.
        parameters: keyword arguments of `Case.build`, `Case.reference` and `Case.band`.
        meshes: levels that are run by default; by default the two coarsest, or the only one.
        unfit: backends that do not support it, or ``regularised`` for all regularised ones, with
            the reason.
    """

    name: str
    parameters: Mapping[str, float | bool | str]
    meshes: tuple[str, ...] = ()
    unfit: Mapping[str, str] = field(default_factory=dict)


BLOCKS: Mapping[str, Mapping[str, Any]] = {"blocks": {}}
"""The one level of a case without meshes."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """Verification case.

    Attributes:
        id: unique name.
        title: one line.
        tags: some of `KINDS`, and others, for searches.
        unit: unit of the load factor.
        explanation: paragraphs; indented ones are a sketch.
        hand_calculation: analytical derivation of the reference, line by line.
        meshes: levels, coarse to fine: keyword arguments of `build`; rigid bodies have none.
        build: function for the problem, from the arguments of a mesh level and a variant.
        reference: function for the reference of a variant.
        band: function for the allowed error, from the number of elements and the parameters of a
            variant.
        variants: variants in the order of the report.
        sweep: parameter of a figure of the load factor; may be empty.
        valid: function that returns whether the closed form holds for the parameters of a variant;
            its docstring gives the reason.
        on_demand: whether it is run only if it is named.
        surfaces: whether strength depends on pressure (T39), in at least one variant. Comparisons
            leave out backends that do not support it.
        order: function for the required order of refinement, from the parameters of a variant; None
            if no order is expected, or known.
        bracket: requirements on lower and upper bounds; None for no bounds. Rigid bodies never have
            any.
        first: runs of the case in the first comparison, `lacore compare` without a case.
        path: function for the path of large deformation of a variant, from its parameters, which
            must include those of `lacore_verification.case.following.STEPPING`; None: one limit
            problem. `reference` and `band` are those of the last load, and the band applies to all
            others.
        beside: function for load factors of others for a variant, shown next to the results.
        sketch: function that adds details, such as lines of a mechanism, to a sketch of the problem
            (`lacore.Problem.plot`); called with the axes and the problem.
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
    surfaces: bool = False
    order: Callable[..., Order | None] | None = None
    bracket: Bracketing | None = field(default_factory=Bracketing)
    first: First = field(default_factory=First)
    path: Callable[..., Following] | None = None
    beside: Callable[..., Sequence[Beside]] | None = None
    sketch: Callable[[Axes, la.Problem], None] | None = None

    @property
    def meshed(self) -> bool:
        """Whether it has meshes."""
        return "blocks" not in self.meshes

    def levels(self, variant: Variant, asked: Sequence[str] = ()) -> tuple[str, ...]:
        """Return the mesh levels to run for a variant: the requested ones, or its own.

        Raises:
            InputError: an unknown level, for a case with meshes.
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
        """Return the problem for any size and parameters, keyword arguments of `build`."""
        with guarded():
            return self.build(**size, **parameters)

    def reference_of(self, variant: Variant) -> Reference:
        """Return the reference of a variant; unknown for one that is missing in a table.

        Raises:
            LookupError: a variant of the case is missing in its table.
        """
        try:
            return self.reference(**variant.parameters)
        except LookupError:
            if variant in self.variants:
                raise
            return UNKNOWN

    def band_of(self, variant: Variant, elements: int) -> Band:
        """Return the band of a variant."""
        return self.band(elements, **variant.parameters)

    @property
    def bracketed_from(self) -> str:
        """Mesh level that a bracket starts from."""
        named = "" if self.bracket is None else self.bracket.mesh
        return named or next(iter(self.meshes))

    def following_of(self, variant: Variant) -> Following:
        """Return the requirements on the path of a variant."""
        assert self.path is not None
        return self.path(**variant.parameters)

    def beside_of(self, variant: Variant) -> Sequence[Beside]:
        """Return load factors of others for a variant."""
        return () if self.beside is None else self.beside(**variant.parameters)

    def order_of(self, variant: Variant) -> Order | None:
        """Return the required order of a variant; None if there is none."""
        return None if self.order is None else self.order(**variant.parameters)


def is_of_lacore(case: Case) -> bool:
    """Return whether a case is one of lacore; cases of users may contain any code."""
    build = case.build.func if isinstance(case.build, partial) else case.build
    return getattr(build, "__module__", "").startswith(_OURS)


@contextlib.contextmanager
def guarded() -> Iterator[None]:
    """Redirect output to stderr, keep the working directory, and prevent an exit.

    Raises:
        RuntimeError: instead of `SystemExit`.
    """
    folder = os.getcwd()
    try:
        with contextlib.redirect_stdout(sys.stderr):
            yield
    except SystemExit as error:
        raise RuntimeError(f"sys.exit({error.code!r}) was called") from error
    finally:
        os.chdir(folder)


def described(error: BaseException) -> str:
    """Return an exception in one line."""
    text = error.msg if isinstance(error, SyntaxError) else str(error)
    return " ".join(f"{type(error).__name__}: {text}".split()).removesuffix(":")
