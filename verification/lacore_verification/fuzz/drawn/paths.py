"""Short paths: they must end, and their loads must be those of limit problems."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import nan

import numpy as np

import lacore as la
from lacore.paths.ending import Ending
from lacore.reporting.errors import LacoreError
from lacore_verification.fuzz.checks.path_copies import same_load
from lacore_verification.fuzz.checks.path_facts import check_facts
from lacore_verification.fuzz.checks.verdict import BAR, Wrong, beyond, first
from lacore_verification.fuzz.drawn.copies import COPIES, has_coulomb
from lacore_verification.fuzz.drawn.draw import Rng, chosen
from lacore_verification.fuzz.drawn.recipe import Recipe, build
from lacore_verification.fuzz.solving import told

# Copies with the same forces; reordering also exchanges slaves.
_SAME = ("turned", "mirrored", "reordered")
# Relative to the volume, in a few steps of some hundredths: larger changes are errors.
_GROWTH = 0.05


@dataclass(frozen=True)
class PathAnswer:
    """Status of a path, and its failure, if any."""

    status: str
    load_factor: float
    message: str
    wrong: Wrong | None = None


def examine_path(recipe: Recipe, rng: Rng) -> PathAnswer:
    """Follow a recipe along its path and check each load; `rng` draws a copy of it."""
    try:
        path = follow(recipe)
        begin = la.solve(build(recipe))
    except LacoreError as error:
        return PathAnswer("refused", nan, str(error))
    except Exception as error:  # Any other error is a failure.
        return PathAnswer("exception", nan, told(error), Wrong("exception", told(error)))
    reached = path.status is Ending.REACHED
    # The end of a path is no status of a load: one that ends early has no proven load there.
    status = (la.Status.SOLVED if reached else la.Status.NOT_CERTIFIED).label
    history = path.history
    load = float(history["load_factor"].iloc[-1]) if reached else nan
    wrong = _wrong(recipe, path, begin)
    if wrong is None and reached and _of_several(recipe):
        wrong = first([*check_facts(recipe, path), *_copy(recipe, path, rng)])
    return PathAnswer(status, load, path.message, wrong)


def follow(recipe: Recipe) -> la.Path:
    """Return the path of a recipe.

    Raises:
        InputError: lacore rejects the recipe.
    """
    settings = {name: value for name, value in recipe["path"].items() if name != "tools"}
    if tools := recipe["path"].get("tools"):
        settings["control"] = la.ToolTravel({name: tuple(own) for name, own in tools.items()})
    return la.sequential(build(recipe), **settings)


def _of_several(recipe: Recipe) -> bool:
    """Return whether bodies may touch each other."""
    return any(isinstance(pair["master"], list) for pair in recipe["interfaces"])


def _copy(recipe: Recipe, path: la.Path, rng: Rng) -> Iterator[Wrong]:
    """Yield a failure if a copy, moved or with slaves as masters, takes other forces.

    With Coulomb friction the last limit problem of the copy is compared instead: its load is that
    of the problem as drawn on the bodies of the copy. The iteration of an implicit step ends there
    with displacements that are uncertain by 1e-5 of the size of the body, and forces differ by a
    multiple of that.
    """
    name = chosen(rng, _SAME)
    coulomb = has_coulomb(recipe)
    try:
        other = follow(COPIES[name](recipe, rng))
    except LacoreError as error:
        yield Wrong(f"{name}, refused", str(error))
        return
    if len(other.history) != len(path.history):
        if not coulomb:
            yield Wrong(f"{name}, path", f"ends otherwise: {other.message}")
        return
    yield from same_load(name, path, other)
    if not coulomb:
        forces, same = (own.history["force"].to_numpy() for own in (path, other))
        yield from beyond(f"{name}, force", "differs by", np.abs(same - forces), np.abs(forces))


def _wrong(recipe: Recipe, path: la.Path, begin: la.LimitState) -> Wrong | None:
    history = path.history
    if history.empty and _of_several(recipe):
        return None  # Nothing is required here; with one body there must be a first step.
    if history.empty:
        solved = begin.status is la.Status.SOLVED
        return Wrong("first step", "none, of a problem that is solved") if solved else None
    powers = history["plastic"] + history["friction"] - history["dead"]
    size = history["plastic"] + history["friction"] + history["dead"].abs()
    if not ((powers - history["load_factor"]).abs() <= BAR * size).all():
        return Wrong("power balance of a path", "load factors are not the powers of their steps")
    unique = not has_coulomb(recipe) and begin.status is la.Status.SOLVED
    if unique and recipe["path"]["scheme"] == "explicit":
        first = float(history["load_factor"].iloc[0])
        if not abs(first - begin.load_factor) <= BAR * abs(begin.load_factor):
            return Wrong("first step", f"{first:.9g}, and the problem {begin.load_factor:.9g}")
    volume = history["volume"]
    if not ((volume / volume.iloc[0] - 1).abs() <= _GROWTH).all():
        return Wrong("volume of a path", "grows or shrinks by more than a twentieth")
    return None
