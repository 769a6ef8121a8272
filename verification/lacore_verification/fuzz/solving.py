"""Solving recipes so that whatever happens is an answer, or a thing that is wrong."""

import traceback
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import lacore as la
from lacore.reporting.errors import LacoreError
from lacore_verification.fuzz.checks.state_checks import NO_SCALE, Scale, check_state, scale_of
from lacore_verification.fuzz.checks.verdict import Wrong, first
from lacore_verification.fuzz.drawn.recipe import Recipe, build

SOLVED, FREE = la.Status.SOLVED, la.Status.FREE
WORDS = (la.Status.LOCKED, la.Status.UNSAFE, FREE)
"""Statuses that say something of the problem; the others say that nothing was found."""


@dataclass(frozen=True)
class RecipeResult:
    """What became of a recipe.

    Attributes:
        status: label, or ``refused`` or ``exception``.
        state, problem: None where there are none.
        scale: of a solved state.
        wrong: what the checks of the state say.
        text: message.
    """

    status: str
    state: la.LimitState | None = None
    problem: la.Problem | None = None
    scale: Scale = NO_SCALE
    wrong: Wrong | None = None
    text: str = ""

    @property
    def solved(self) -> bool:
        """Whether a number is claimed."""
        return self.status == SOLVED.label

    @property
    def word(self) -> bool:
        """Whether it is claimed that there is none."""
        return self.status in [word.label for word in WORDS]

    @property
    def load_factor(self) -> float:
        """NaN unless solved."""
        return self.state.load_factor if self.solved and self.state is not None else float("nan")


@dataclass(frozen=True)
class SolveSettings:
    """How a recipe is to be solved: as `la.solve` takes it, but for the problem."""

    backend: str = "clarabel"
    settings: Mapping[str, Any] = field(default_factory=dict)


def answer(
    recipe: Recipe, rng: Any, asked: SolveSettings | None = None, checked: bool = True
) -> RecipeResult:
    """Build, solve and check a recipe."""
    asked = asked or SolveSettings()
    try:
        problem = build(recipe)
        state = la.solve(problem, asked.backend, **asked.settings)
    except LacoreError as error:
        return RecipeResult("refused", text=str(error))
    except Exception as error:  # anything else is a find
        return RecipeResult("exception", wrong=Wrong("exception", told(error)), text=told(error))
    if state.status is not SOLVED:
        return RecipeResult(state.status.label, state, problem, text=state.message)
    try:
        scale = scale_of(recipe, problem, state)
        wrong = first(check_state(recipe, problem, state, rng)) if checked else None
    except Exception as error:  # tables that cannot be read are a find, too
        return RecipeResult("exception", state, problem, wrong=Wrong("exception", told(error)))
    return RecipeResult(state.status.label, state, problem, scale, wrong, state.message)


def told(error: Exception) -> str:
    """An exception and where it comes from."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    place = last.filename.rsplit("/", 2)[-2:]
    return f"{type(error).__name__}: {error} ({'/'.join(place)}:{last.lineno})"
