"""Short paths: that they end, and that their loads are those of limit problems."""

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

_SAME = ("turned", "mirrored", "reordered")  # copies of the same forces; reordered: slaves, too
_GROWTH = 0.05  # of the volume in a few steps of some hundredths: more is no flow of this kind


@dataclass(frozen=True)
class PathAnswer:
    """How a path ended, and what is wrong with it."""

    status: str
    load_factor: float
    message: str
    wrong: Wrong | None = None


def examine_path(recipe: Recipe, rng: Rng) -> PathAnswer:
    """Follow a recipe along its path and judge each load; `rng` draws a copy of it."""
    try:
        path = follow(recipe)
        begin = la.solve(build(recipe))
    except LacoreError as error:
        return PathAnswer("refused", nan, str(error))
    except Exception as error:  # anything else is a find
        return PathAnswer("exception", nan, told(error), Wrong("exception", told(error)))
    reached = path.status is Ending.REACHED
    # How a path ends is no status of a load: of one that ends early none is proven for its travel.
    status = (la.Status.SOLVED if reached else la.Status.NOT_CERTIFIED).label
    history = path.history
    load = float(history["load_factor"].iloc[-1]) if reached else nan
    wrong = _wrong(recipe, path, begin)
    if wrong is None and reached and _of_several(recipe):
        wrong = first([*check_facts(recipe, path), *_copy(recipe, path, rng)])
    return PathAnswer(status, load, path.message, wrong)


def follow(recipe: Recipe) -> la.Path:
    """The path of a recipe.

    Raises:
        InputError: what lacore refuses.
    """
    settings = {name: value for name, value in recipe["path"].items() if name != "tools"}
    if tools := recipe["path"].get("tools"):
        settings["control"] = la.ToolTravel({name: tuple(own) for name, own in tools.items()})
    return la.sequential(build(recipe), **settings)


def _of_several(recipe: Recipe) -> bool:
    """Whether bodies may touch each other."""
    return any(isinstance(pair["master"], list) for pair in recipe["interfaces"])


def _copy(recipe: Recipe, path: la.Path, rng: Rng) -> Iterator[Wrong]:
    """Moved, or with the sides of its interfaces exchanged, it takes the same forces.

    With Coulomb friction the last limit problem of the copy is compared instead: its load is that
    of the problem as drawn on the bodies of the copy. The iteration of an implicit step ends there
    with displacements that are uncertain by a hundred thousandth of the body, and forces differ by
    some times as much.
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
        return None  # nothing is claimed; of one body there must be a first step
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
