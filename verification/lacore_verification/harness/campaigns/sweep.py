"""Sweeps: runs over a grid of parameters of cases, meshes, loops and backends."""

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from math import prod
from typing import Any

import lacore as la
from lacore.coupling.options import CouplingOptions
from lacore.reporting.errors import InputError
from lacore.solvers.backend import load_backend
from lacore_verification.case import Case, Variant
from lacore_verification.catalogue.catalogue import Catalogue, catalogue
from lacore_verification.harness.campaigns import varied
from lacore_verification.harness.campaigns.axis import KINDS, Axis, read_axis
from lacore_verification.harness.campaigns.comparison import (
    check_names,
    default_backends,
    pick,
    planned,
)
from lacore_verification.runs.run import Run, canonical

_MOST = 100_000  # Largest number of points of a grid, for which planning takes minutes.


@dataclass(frozen=True)
class _Grid:
    """The axes of a sweep, by kind."""

    axes: Mapping[str, Sequence[Axis]]

    def points(self, kind: str, types: Mapping[str, type]) -> list[dict[str, Any]]:
        """Return the combinations of the axes with these names."""
        return varied.grid(self.axes[kind], types)


def plan(
    names: Sequence[str],
    vary: Sequence[str],
    backends: Sequence[str] = (),
    meshes: Sequence[str] = (),
    couplings: Sequence[str] = (),
    known: Catalogue | None = None,
) -> list[Run]:
    """Return runs of a grid.

    A run that does not depend on an axis, such as exact on r, is run once.

    Args:
        names: of cases, ``id`` or ``id:variant``; at least one.
        vary: axes as in `lacore_verification.harness.campaigns.axis`.
        backends: none: those of a comparison; ``all`` is every one.
        meshes: levels; none: the default ones of each variant, for a varied mesh the first.
        couplings: none: the default of each backend.
        known: cases to search; None: those of lacore itself.

    Raises:
        InputError: an unknown or ambiguous name, an axis that is empty or given twice, or an
            invalid
            value; before anything is solved.
    """
    known = catalogue() if known is None else known
    backends = la.backend_names() if list(backends) == ["all"] else backends
    check_names(backends, couplings, meshes, known)
    picked = pick(names, known)
    chosen = {
        case.id: list(
            backends or dict.fromkeys(n for one in variants for n in default_backends(case, one))
        )
        for case, variants in picked
    }
    grid = _grid(
        vary, picked, list(dict.fromkeys(name for all_ in chosen.values() for name in all_))
    )
    runs: dict[str, Run] = {}
    for case, variants in picked:
        for variant in _variants(case, variants, grid):
            _check_steps(case, variant)
            skip = _outside(case, variant)
            for run in _runs(case, variant, chosen[case.id], meshes, couplings or (None,), grid):
                run = replace(run, skip=run.skip or skip)
                runs.setdefault(run.key, run)
    return list(runs.values())


def _grid(
    vary: Sequence[str], picked: Sequence[tuple[Case, Sequence[Variant]]], backends: Sequence[str]
) -> _Grid:
    """Return the axes, with all possible checks done."""
    if not vary:
        raise InputError(
            "--vary",
            None,
            "there is none, so the grid is empty",
            "give one, as in r=1e-1:1e-5:9:log",
        )
    options = {name: varied.options(name) for name in backends}
    known: dict[str, varied.Names] = {
        "param": {case.id: varied.parameters(case, variants) for case, variants in picked},
        "size": {case.id: varied.sizes(case) for case, _ in picked},
        "setting": {"": varied.settings()},
        "option": options,
    }
    axes: list[Axis] = []
    for axis in (varied.resolved(read_axis(text), known) for text in vary):
        if any((axis.kind, axis.name) == (one.kind, one.name) for one in axes):
            raise InputError(axis.field, None, "is there twice", "give all its values in one")
        axes.append(axis)
    points = prod(len(axis.values) for axis in axes)
    if points > _MOST:
        raise InputError("--vary", points, "points are too many", f"take at most {_MOST}")
    grid = _Grid({kind: [axis for axis in axes if axis.kind == kind] for kind in KINDS})
    for kind, owners in known.items():
        for types in owners.values():
            grid.points(kind, types)
    _check_values(grid, options)
    return grid


def _check_values(grid: _Grid, options: varied.Names) -> None:
    """Raise an error for invalid values of loops and backends."""
    for point in grid.points("setting", varied.settings()):
        CouplingOptions(**point)
    for backend, types in options.items():
        for point in grid.points("option", types):
            if point:
                load_backend(backend).Options(**point)


def _check_steps(case: Case, variant: Variant) -> None:
    """Raise an error for an invalid number of steps or an unknown scheme."""
    if case.path is None:
        return
    try:
        case.following_of(variant)
    except InputError:
        raise
    except Exception:  # A case of a user may raise; its row reports the error.
        return


def _variants(case: Case, bases: Sequence[Variant], grid: _Grid) -> Iterator[Variant]:
    """Yield variants with varied parameters; otherwise equal bases count once."""
    points = grid.points("param", varied.parameters(case, bases))
    if not points[0]:
        yield from bases
        return
    among = {_rest(variant, points[0]) for variant in case.variants}
    seen = set()
    for base in bases:
        if _rest(base, points[0]) not in seen:
            seen.add(_rest(base, points[0]))
            for point in points:
                name = "-".join(f"{name}-{_short(value)}" for name, value in point.items())
                yield Variant(
                    name if len(among) == 1 else f"{base.name}-{name}",
                    {**base.parameters, **point},
                    base.meshes,
                )


def _rest(variant: Variant, point: Mapping[str, Any]) -> str:
    """Return the parameters that are not varied."""
    return canonical({k: value for k, value in variant.parameters.items() if k not in point})


def _short(value: object) -> str:
    text = f"{value:.12g}" if isinstance(value, float) else str(value)
    return re.sub(r"[^A-Za-z0-9._-]+", "", text)


def _outside(case: Case, variant: Variant) -> str:
    """Return why a variant is not run; empty if it is."""
    # A case of a user may raise; its row reports the error of its reference.
    with suppress(Exception):
        if case.valid is not None and not case.valid(**variant.parameters):
            return "the closed form of the case does not hold at these parameters"
    return ""


def _runs(
    case: Case,
    variant: Variant,
    backends: Sequence[str],
    meshes: Sequence[str],
    couplings: Sequence[str | None],
    grid: _Grid,
) -> Iterator[Run]:
    """Yield all runs of a variant, with those of one problem in sequence."""
    sizes = grid.points("size", varied.sizes(case))
    levels = case.levels(variant, meshes)
    if sizes[0] and not meshes:
        levels = tuple(case.meshes)[:1]
    for mesh in levels:
        for size in sizes:
            for backend in dict.fromkeys(backends):
                options = grid.points("option", varied.options(backend))
                for coupling in dict.fromkeys(couplings):
                    run = planned(case, variant, mesh, backend, coupling)
                    for setting in grid.points("setting", varied.settings()):
                        for option in options:
                            yield _varied(run, size, setting, option)


def _varied(
    run: Run, size: dict[str, Any], settings: dict[str, Any], options: dict[str, Any]
) -> Run:
    """Return a run of a comparison with other values.

    The verdict is that of the comparison. With other settings of the loop or options of the backend
    a run may end without a result, which is then no failure.
    """
    insist = run.insist and not settings and not options
    return replace(run, size=size, settings=settings, options=options, insist=insist)
