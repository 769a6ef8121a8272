"""What a verification case is: a problem, its reference, and how far a result may lie from it."""

from __future__ import annotations  # not evaluated: names of lacore in them load nothing

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
"""Tags that say what a case is about; every case of lacore has one at least, and free ones."""


JAM = {"regularised": "only the certified loop tells jamming; the reaction loop goes on and on"}
CLAMPED = {"regularised": "penalties let go where nothing determines the clamping forces"}
RANGE = "range"
"""What stands for a coupling in runs that search for low and high load factors (T59)."""
CLOSE = 0.05
"""Relative: the largest distance from the reference that a run of the first comparison may have."""


@dataclass(frozen=True)
class Beside:
    """A load factor that others give, shown on the page of a case; nothing is judged by it.

    Attributes:
        name: what it is, such as ``Davis's strength``.
        value: in units of the case.
        source: where it comes from, and what it proves.
        half_width: they say ``value +- half_width``.
    """

    name: str
    value: float
    source: str
    half_width: float = 0.0


@dataclass(frozen=True)
class First:
    """The runs of a case in the first comparison; each must be within `CLOSE` of the reference.

    Where the coarsest mesh is too coarse for that, a case names another mesh or variant, or a
    bracket. The coarse meshes are run by ``lacore compare --all``.

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
        surfaces: whether strength depends on pressure (T39), in one variant at least. Comparisons
            leave out backends that do not take that.
        order: what refinement must show, from the parameters of a variant; None where no order is
            expected, or known.
        bracket: what is asked of a lower and an upper bound around it; None for none. Rigid bodies
            have none in any case.
        first: what the first comparison runs of the case, `lacore compare` without a case.
        path: how a variant is followed through large deformation, from its parameters, which are
            then to have those of `lacore_verification.case.following.STEPPING`; None: one limit
            problem. `reference` and `band` are those of the last load, the band of all others, too.
        beside: what others say of a variant, from its parameters; shown beside what is found.
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
    surfaces: bool = False
    order: Callable[..., Order | None] | None = None
    bracket: Bracketing | None = field(default_factory=Bracketing)
    first: First = field(default_factory=First)
    path: Callable[..., Following] | None = None
    beside: Callable[..., Sequence[Beside]] | None = None
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

    def beside_of(self, variant: Variant) -> Sequence[Beside]:
        """What others say of a variant."""
        return () if self.beside is None else self.beside(**variant.parameters)

    def order_of(self, variant: Variant) -> Order | None:
        """What refinement must show of a variant; None where nothing is expected."""
        return None if self.order is None else self.order(**variant.parameters)


def is_of_lacore(case: Case) -> bool:
    """Whether a case is known to be harmless; what others wrote may do anything."""
    build = case.build.func if isinstance(case.build, partial) else case.build
    return getattr(build, "__module__", "").startswith(_OURS)


@contextlib.contextmanager
def guarded() -> Iterator[None]:
    """What is printed goes to stderr, the working directory stays, and nothing ends the process.

    Raises:
        RuntimeError: in place of `SystemExit`.
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
