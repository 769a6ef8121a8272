"""Solving of recipes, with any event as a result or a failure."""

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
"""Statuses that describe the problem; the others mean that nothing was found."""


@dataclass(frozen=True)
class RecipeResult:
    """Result of a recipe.

    Attributes:
        status: label, or ``refused`` or ``exception``.
        state, problem: None if there are none.
        scale: of a solved state.
        wrong: failure of the checks of the state.
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
        """Return whether it claims that there is no load factor."""
        return self.status in [word.label for word in WORDS]

    @property
    def load_factor(self) -> float:
        """NaN unless solved."""
        return self.state.load_factor if self.solved and self.state is not None else float("nan")


@dataclass(frozen=True)
class SolveSettings:
    """Arguments of `la.solve`, except the problem."""

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
    except Exception as error:  # Any other error is a failure.
        return RecipeResult("exception", wrong=Wrong("exception", told(error)), text=told(error))
    if state.status is not SOLVED:
        return RecipeResult(state.status.label, state, problem, text=state.message)
    try:
        scale = scale_of(recipe, problem, state)
        wrong = first(check_state(recipe, problem, state, rng)) if checked else None
    except Exception as error:  # Unreadable tables are failures, too.
        return RecipeResult("exception", state, problem, wrong=Wrong("exception", told(error)))
    return RecipeResult(state.status.label, state, problem, scale, wrong, state.message)


def told(error: Exception) -> str:
    """Return an exception and its origin."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    place = last.filename.rsplit("/", 2)[-2:]
    return f"{type(error).__name__}: {error} ({'/'.join(place)}:{last.lineno})"
