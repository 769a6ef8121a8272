"""Short paths: that they end, and that their loads are those of limit problems."""

from dataclasses import dataclass
from math import nan

import lacore as la
from lacore.errors import LacoreError
from lacore.paths.ending import Ending
from verification.fuzz.checks.verdict import BAR, Wrong
from verification.fuzz.drawn.copies import has_coulomb
from verification.fuzz.drawn.recipe import Recipe, build
from verification.fuzz.solving import told

_GROWTH = 0.05  # of the volume in a few steps of some hundredths: more is no flow of this kind


@dataclass(frozen=True)
class PathAnswer:
    """How a path ended, and what is wrong with it."""

    status: str
    load_factor: float
    message: str
    wrong: Wrong | None = None


def examine_path(recipe: Recipe) -> PathAnswer:
    """Follow a recipe along its path and judge each load."""
    try:
        problem = build(recipe)
        path = la.sequential(problem, **recipe["path"])
        begin = la.solve(problem)
    except LacoreError as error:
        return PathAnswer("refused", nan, str(error))
    except Exception as error:  # anything else is a find
        return PathAnswer("exception", nan, told(error), Wrong("exception", told(error)))
    reached = path.status is Ending.REACHED
    status = la.Status.SOLVED.label if reached else path.status.label
    history = path.history
    load = float(history["load_factor"].iloc[-1]) if reached else nan
    return PathAnswer(status, load, path.message, _wrong(recipe, path, begin))


def _wrong(recipe: Recipe, path: la.Path, begin: la.LimitState) -> Wrong | None:
    history = path.history
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
