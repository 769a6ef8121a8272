"""Reduction of a failing problem to smaller recipes that fail the same check.

Candidates are runs like all others, in processes and with time limits; in each round the first with
the same failure is taken.
"""

from collections.abc import Iterator
from contextlib import closing
from typing import Any

from lacore_verification.fuzz.drawn.cases import recipe_of, run_of
from lacore_verification.fuzz.drawn.recipe import LISTS, Recipe, as_text, copied
from lacore_verification.harness.perform.processes import Executor
from lacore_verification.harness.verdicts.words import FAIL
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.row import Row
from lacore_verification.runs.run import Run

_ROUNDS = 30
_DIGITS = (1, 2)


def shrunk(outcome: Outcome, kind: str, executor: Executor, time_limit: float) -> Outcome:
    """Return the smallest problem found that fails the same check as an outcome."""
    check = outcome.row.check
    for _ in range(_ROUNDS):
        recipe = recipe_of(kind, **outcome.run.parameters)
        smaller = _first(outcome.run, list(candidates(recipe)), check, executor, time_limit)
        if smaller is None:
            break
        outcome = smaller
    return outcome


def _first(
    run: Run, recipes: list[Recipe], check: str, executor: Executor, time_limit: float
) -> Outcome | None:
    """Return the first of some recipes that fails a check, in the order in which they end."""
    parameters = {name: run.parameters[name] for name in ("seed", "number")}
    runs = [run_of(run.case, {**parameters, "recipe": recipe}) for recipe in recipes]
    if not runs:
        return None
    with closing(executor(runs, time_limit=time_limit, on_start=lambda _: None)) as outcomes:
        return next((one for one in outcomes if _fails(one.row, check)), None)


def _fails(row: Row, check: str) -> bool:
    return row.verdict == FAIL and row.check == check


def candidates(recipe: Recipe) -> Iterator[Recipe]:
    """Yield smaller recipes, the most reduced first; a recipe with a fact keeps it on any mesh."""
    if "fact" in recipe:
        for body, data in recipe["bodies"].items():
            if data["kind"] == "continuum":
                yield from _coarser(recipe, body)
        return
    for name in LISTS:
        for place in range(len(recipe[name])):
            if name == "reference" and len(recipe[name]) == 1:
                continue
            made = copied(recipe)
            del made[name][place]
            yield made
    for body, data in recipe["bodies"].items():
        if data["kind"] == "blocks":
            yield from _without_blocks(recipe, body)
        elif data["kind"] == "continuum":
            yield from _coarser(recipe, body)
    yield from _rounder(recipe)


def _without_blocks(recipe: Recipe, body: str) -> Iterator[Recipe]:
    for name in recipe["bodies"][body]["polygons"]:
        made = copied(recipe)
        data = made["bodies"][body]
        if len(data["polygons"]) == 1:
            return
        del data["polygons"][name]
        data["joints"] = [joint for joint in data["joints"] if name not in joint[:2]]
        for key in LISTS[:3]:
            made[key] = [
                part
                for part in made[key]
                if part["body"] != body or name not in (part.get("where"), part.get("at"))
            ]
        if made["reference"]:
            yield made
    if recipe["bodies"][body]["joints"]:
        made = copied(recipe)
        made["bodies"][body]["joints"] = []
        yield made


def _coarser(recipe: Recipe, body: str) -> Iterator[Recipe]:
    mesh = recipe["bodies"][body]["mesh"]
    for name in ("nx", "ny"):
        if mesh[name] > 1:
            made = copied(recipe)
            made["bodies"][body]["mesh"][name] = mesh[name] - 1
            yield made


def _rounder(recipe: Recipe) -> Iterator[Recipe]:
    """Yield recipes with fewer digits, except for coordinates of blocks, which must fit."""
    for digits in _DIGITS:
        made = copied(recipe)
        for key in ("reference", "dead"):
            made[key] = [_rounded(part, digits) for part in made[key]]
        for body in made["bodies"].values():
            for name in ("strength", "friction"):
                if name in body:
                    body[name] = _rounded(body[name], digits)
        for pair in made["interfaces"]:
            pair["friction"] = _rounded(pair["friction"], digits)
        if as_text(made) != as_text(recipe):
            yield made
            return


def _rounded(part: Any, digits: int) -> Any:
    if isinstance(part, dict):
        keep = ("where", "at")
        return {k: v if k in keep else _rounded(v, digits) for k, v in part.items()}
    if isinstance(part, list):
        return [_rounded(item, digits) for item in part]
    return float(f"{part:.{digits}g}") if isinstance(part, float) else part
