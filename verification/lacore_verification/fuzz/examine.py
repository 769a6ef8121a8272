"""Examination of one random problem: its result, related problems, and linear programs."""

from collections.abc import Iterator
from dataclasses import replace
from math import inf, isfinite, isnan, nan
from typing import Any

import lacore as la
from lacore_verification.fuzz.checks.block_program import Known, known_of
from lacore_verification.fuzz.checks.bounds import wrong_bounds, wrong_safety
from lacore_verification.fuzz.checks.derivatives import is_smooth, wrong_derivatives
from lacore_verification.fuzz.checks.existence import carries
from lacore_verification.fuzz.checks.polygons import examine_polygons
from lacore_verification.fuzz.checks.rigid_motions import refuted_words
from lacore_verification.fuzz.checks.verdict import BAR, Judgement, Wrong
from lacore_verification.fuzz.drawn.copies import COPIES, has_coulomb, strengthened, with_law
from lacore_verification.fuzz.drawn.draw import Rng
from lacore_verification.fuzz.drawn.paths import examine_path
from lacore_verification.fuzz.drawn.recipe import Recipe, copied
from lacore_verification.fuzz.solving import FREE, RecipeResult, SolveSettings, answer, told

_LINEAR = ("blocks", "frame")
_LINEAR_SOLVER, _CONIC_SOLVER = "highs", "ipopt-static"
"""Names of alternative solvers, fixed so that results are reproducible elsewhere."""
_EXTRAS = 2
"""Comparisons drawn for each problem, in addition to those that all have."""


def examine(recipe: Recipe, rng: Rng) -> Judgement:
    """Solve a recipe and check it; `rng` draws the comparisons."""
    if "path" in recipe:
        made = examine_path(recipe, rng)
        return Judgement(made.status, made.load_factor, "", made.message, True, wrong=made.wrong)
    if any("sections" in body for body in recipe["bodies"].values()):
        return examine_polygons(recipe)
    base = answer(recipe, rng)
    if base.status == "refused":
        return Judgement(base.status, nan, "", base.text, None)
    known = known_of(recipe)
    found = Examination(recipe, base, known, rng)
    wrong = next(found.wrong(), None)
    return Judgement(
        base.status,
        base.load_factor,
        base.state.rigor.label if base.state else "",
        base.text,
        found.has_load,
        *found.bounds,
        wrong=wrong,
    )


class Examination:
    """Results about a recipe, by one comparison after the other."""

    def __init__(self, recipe: Recipe, base: RecipeResult, known: Known, rng: Rng) -> None:
        self._recipe, self._base, self._known, self._rng = recipe, base, known, rng
        self._coulomb = has_coulomb(recipe)
        self._scale = base.scale.power
        self._low, self._high = known.lowest, known.highest
        self._solvable = base.solved and base.wrong is None

    @property
    def has_load(self) -> bool | None:
        """Return whether there is a load factor, by programs of blocks or by a state."""
        if self._known.has_load is not None:
            return self._known.has_load
        if self._solvable:
            return True
        return False if self._base.word else carries(self._recipe, self._rng)

    @property
    def bounds(self) -> tuple[float, float]:
        """Return bounds of every Coulomb load factor."""
        return self._low, self._high

    def wrong(self) -> Iterator[Wrong]:
        """Yield failures, the simplest first."""
        if self._base.wrong is not None:
            yield self._base.wrong
        yield from self._against_programs()
        if self._base.word and self._base.problem is not None and self._base.state is not None:
            yield from refuted_words(self._recipe, self._base.problem, self._base.state.status)
        yield from self._against_associated()
        if any(
            "soil" in b or "polar" in b.get("mesh", {}) for b in self._recipe["bodies"].values()
        ):
            yield from self._bounds()
        further = [
            *(self._copy, self._frictionless, self._other_backend, self._bounds),
            *(self._monotony, self._interval, self._derivatives, self._safety, self._footing),
        ]
        for place in self._rng.permutation(len(further))[:_EXTRAS]:
            yield from further[int(place)]()

    def _against_programs(self) -> Iterator[Wrong]:
        """Yield results that contradict the independent linear programs."""
        known, base = self._known, self._base
        if isnan(known.highest):
            return
        if base.solved:
            yield from self._between(
                base.load_factor, known.lowest, known.highest, "linear program"
            )
        if base.status == la.Status.LOCKED.label and known.locked is False:
            yield Wrong("word locked", f"a linear program finds at most {known.highest:.6g}")
        if base.status == la.Status.UNSAFE.label and known.highest > -inf:
            yield Wrong("word unsafe", f"a linear program finds {known.highest:.6g}")
        if base.status == FREE.label and known.lowest > BAR * abs(known.highest):
            yield Wrong("word free", f"without friction it carries {known.lowest:.6g}")

    def _between(self, value: float, low: float, high: float, who: str) -> Iterator[Wrong]:
        room = BAR * (self._scale + abs(value))
        if value > high + room:
            yield Wrong(f"above: {who}", f"{value:.9g} is above {high:.9g}")
        if value < low - room:
            yield Wrong(f"below: {who}", f"{value:.9g} is below {low:.9g}")

    def _against_associated(self) -> Iterator[Wrong]:
        """Yield a failure if associated friction gives a smaller load factor."""
        if not self._coulomb:
            return
        other = answer(with_law(self._recipe, "associated"), self._rng)
        if other.wrong is not None:
            yield replace(other.wrong, check=f"associated, {other.wrong.check}")
            return
        if other.solved:
            self._solvable = True
            self._scale = max(self._scale, other.scale.power)
            if isnan(self._high):
                self._high = other.load_factor
            if self._base.solved:
                yield from self._between(
                    self._base.load_factor, -inf, other.load_factor, "associated"
                )
            if self._base.status == la.Status.LOCKED.label:
                yield Wrong("word locked", f"associated it carries {other.load_factor:.6g} at most")
            if self._base.status == la.Status.UNSAFE.label:
                yield Wrong("word unsafe", f"associated it carries {other.load_factor:.6g}")
        if other.status == la.Status.UNSAFE.label and self._base.solved:
            yield Wrong(
                "word unsafe",
                f"reported of it made associated; it carries {self._base.load_factor:.6g}",
            )

    def _frictionless(self) -> Iterator[Wrong]:
        """Yield a failure if the load factor is larger without friction, or smaller with more.

        For blocks this includes stick. A body where stick meets a footing slips at its strength,
        and there only (`lacore.assembly.sticking`): its discrete value may be below that of
        friction, not its bounds.
        """
        if not self._coulomb:
            return
        rigid = all(body["kind"] == "blocks" for body in self._recipe["bodies"].values())
        rough = "stick" if rigid else "rougher"
        kind = "smooth" if self._rng.random() < 0.7 else rough
        other = answer(with_law(self._recipe, kind), self._rng)
        if other.wrong is not None:
            yield replace(other.wrong, check=f"{kind}, {other.wrong.check}")
        elif other.solved and self._base.solved:
            low, high = (other.load_factor, inf) if kind == "smooth" else (-inf, other.load_factor)
            self._scale = max(self._scale, other.scale.power)
            yield from self._between(self._base.load_factor, low, high, kind)
        elif kind == "smooth" and self._base.solved and other.status == la.Status.LOCKED.label:
            yield Wrong(
                "word locked",
                f"reported of it without friction; it carries {self._base.load_factor:.6g}",
            )

    def _copy(self) -> Iterator[Wrong]:
        """Yield a failure if a moved, rescaled or renamed copy has another load factor."""
        name = list(COPIES)[int(self._rng.integers(len(COPIES)))]
        other = answer(COPIES[name](self._recipe, self._rng), self._rng)
        if other.status == "refused":
            yield Wrong(f"{name}, refused", other.text)
        yield from self._same(other, name)

    def _other_backend(self) -> Iterator[Wrong]:
        """Yield a failure if another solver finds another result, and no other Coulomb state."""
        kinds = [body["kind"] for body in self._recipe["bodies"].values()]
        if all(kind in _LINEAR for kind in kinds):
            other = answer(self._recipe, self._rng, SolveSettings(_LINEAR_SOLVER))
            if other.status != "refused":
                yield from self._same(other, _LINEAR_SOLVER)
            return
        # For continua the associated value, which is unique, and the stresses of its state.
        wanted = self._high if self._coulomb else self._base.load_factor
        other = answer(
            with_law(self._recipe, "associated"), self._rng, SolveSettings(_CONIC_SOLVER)
        )
        if other.wrong is not None:
            yield replace(other.wrong, check=f"{_CONIC_SOLVER}, {other.wrong.check}")
        elif isfinite(wanted) and other.solved:
            self._scale = max(self._scale, other.scale.power)
            yield from self._between(other.load_factor, wanted, wanted, _CONIC_SOLVER)
        elif isfinite(wanted) and other.word and abs(wanted) > BAR * self._scale:
            yield Wrong(f"word {other.status}", f"reported by {_CONIC_SOLVER}: {wanted:.6g}")

    def _interval(self) -> Iterator[Wrong]:
        """Yield a failure if the load factor is outside the interval of its own mechanism."""
        state = self._base.state
        if not self._base.solved or state is None:
            return
        try:
            found = state.interval()
        except Exception as error:  # A certified state must have one.
            yield Wrong("exception", told(error))
            return
        if not found.low <= self._base.load_factor <= found.high:
            text = f"{self._base.load_factor:.12g} is not in [{found.low:.12g}, {found.high:.12g}]"
            yield Wrong("interval", text)

    def _same(self, other: RecipeResult, name: str) -> Iterator[Wrong]:
        """Yield a failure if two results of the same problem differ."""
        base = self._base
        if other.wrong is not None:
            yield replace(other.wrong, check=f"{name}, {other.wrong.check}")
            return
        if other.solved:
            self._solvable = True
        if base.solved and other.solved:
            value = other.load_factor
            self._scale = max(self._scale, other.scale.power)
            if not self._coulomb:
                yield from self._between(value, base.load_factor, base.load_factor, name)
            else:
                yield from self._between(value, self._low_or(-inf), self._high_or(inf), name)
            return
        if base.word and other.word and base.status != other.status:
            yield Wrong("two words", f"{base.status}; {name}: {other.status}")
        for one, two, who in ((base, other, name), (other, base, f"it is reported by {name}")):
            if one.word and two.solved and not self._is_nothing(one, two):
                yield Wrong(f"word {one.status}", f"{who}: {two.load_factor:.6g}")

    def _is_nothing(self, word: RecipeResult, solved: RecipeResult) -> bool:
        """Return whether FREE agrees with a load factor of zero."""
        return word.status == FREE.label and abs(solved.load_factor) <= BAR * self._scale

    def _low_or(self, other: float) -> float:
        return other if isnan(self._low) else self._low

    def _high_or(self, other: float) -> float:
        return other if isnan(self._high) else self._high

    def _bounds(self) -> Iterator[Wrong]:
        """Yield a failure if equilibrium elements carry more than velocities allow."""
        if not self._coulomb and self._deformable:
            yield from wrong_bounds(self._base, self._scale)

    def _safety(self) -> Iterator[Wrong]:
        """Yield a failure if problems weakened by a safety factor are not at collapse."""
        if self._deformable and (self._base.solved or self._base.word):
            yield from wrong_safety(self._recipe, self._rng)

    @property
    def _deformable(self) -> bool:
        """Whether a body of the recipe is a continuum."""
        return any(body["kind"] == "continuum" for body in self._recipe["bodies"].values())

    def _footing(self) -> Iterator[Wrong]:
        """Yield a failure if a rough footing carries less than a smooth one."""
        other = copied(self._recipe)
        footings = [load for load in other["reference"] if load["load"] == "RigidFooting"]
        if self._coulomb or not footings or not self._base.solved:
            return
        rough = footings[0]["rough"]
        footings[0]["rough"] = not rough
        found = answer(other, self._rng)
        if found.wrong is not None:
            yield replace(found.wrong, check=f"footing, {found.wrong.check}")
        elif found.solved:
            low, high = (found.load_factor, inf) if rough else (-inf, found.load_factor)
            self._scale = max(self._scale, found.scale.power)
            yield from self._between(self._base.load_factor, low, high, "footing")

    def _derivatives(self) -> Iterator[Wrong]:
        """Yield a failure if derivatives differ from solves at neighbouring values."""
        problem, state = self._base.problem, self._base.state
        if self._coulomb or not self._base.solved or problem is None or state is None:
            return
        if is_smooth(problem):
            yield from wrong_derivatives(problem, state, self._rng)

    def _monotony(self) -> Iterator[Wrong]:
        """Yield a failure if stronger bodies carry less."""
        bodies: Any = self._recipe["bodies"].values()
        if self._coulomb or not self._base.solved or all(b["kind"] == "blocks" for b in bodies):
            return
        other = answer(strengthened(self._recipe), self._rng)
        if other.wrong is not None:
            yield replace(other.wrong, check=f"stronger, {other.wrong.check}")
        elif other.solved:
            self._scale = max(self._scale, other.scale.power)
            yield from self._between(self._base.load_factor, -inf, other.load_factor, "stronger")
        elif other.status == la.Status.UNSAFE.label:
            yield Wrong("word unsafe", "reported of it with all strengths half as much again")
