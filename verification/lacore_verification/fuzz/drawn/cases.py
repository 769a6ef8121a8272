"""Classes of random problems as cases, so that the code for runs also runs and resumes sweeps.

A variant is one problem: by seed and number, or by its recipe if it was reduced.
"""

import zlib
from collections.abc import Callable, Mapping
from functools import partial
from math import nan

import numpy as np

import lacore as la
from lacore.reporting.errors import require_known
from lacore_verification.case import Band, Case, Reference, Variant
from lacore_verification.fuzz.drawn import draw_blocks, draw_continua, draw_frames, draw_paths
from lacore_verification.fuzz.drawn.draw import Rng
from lacore_verification.fuzz.drawn.recipe import Recipe, build
from lacore_verification.runs.run import FUZZ, Run

CLASSES: Mapping[str, Callable[[Rng], Recipe]] = {
    "blocks": draw_blocks.blocks,
    "weights": draw_blocks.weights,
    "plane-strain": draw_continua.plane_strain,
    "plane-stress": draw_continua.plane_stress,
    "axisymmetric": draw_continua.axisymmetric,
    "soils": draw_continua.soils,
    "arcs": draw_continua.arcs,
    "two-bodies": draw_continua.two_bodies,
    "mixtures": draw_continua.mixtures,
    "frames": draw_frames.frames,
    "sections": draw_frames.sections,
    "paths": draw_continua.paths,
    "pairs-on-paths": draw_paths.pairs,
    "tools-on-paths": draw_paths.tools,
}

BACKEND = "clarabel"


def recipe_of(kind: str, seed: int, number: int, recipe: Recipe | None = None) -> Recipe:
    """Return the recipe of a variant."""
    return draw(kind, seed, number) if recipe is None else recipe


def problem_of(kind: str, seed: int, number: int, recipe: Recipe | None = None) -> "la.Problem":
    """Return the problem of a variant."""
    return build(recipe_of(kind, seed, number, recipe))


def random_numbers(kind: str, seed: int, number: int, recipe: Recipe | None = None) -> Rng:
    """Return the random numbers of the checks; a reduced problem has those of its original."""
    return random_of(kind, seed, number, "examine")


def case_of(kind: str) -> Case:
    """Return the case of a class."""
    return Case(
        id=f"fuzz-{kind}",
        title=f"random problems: {kind}",
        tags=("fuzz",),
        unit="-",
        explanation="Random problems, judged by checks that share no code with the solver.",
        hand_calculation="",
        build=partial(problem_of, kind),
        reference=_unknown,
        band=_band,
        variants=(),
        bracket=None,
        on_demand=True,
    )


def _unknown(**given: object) -> Reference:
    return Reference(nan, "random: unknown", "", "none", complete=False)


def _band(elements: int, **given: object) -> Band:
    return Band(0.0, 0.0, "random: none")


def runs_of(kinds: list[str], count: int, seed: int) -> list[Run]:
    """Return runs of `count` problems, in equal shares of all classes."""
    cases = {kind: case_of(kind) for kind in kinds}
    shares = [count // len(kinds) + (n < count % len(kinds)) for n in range(len(kinds))]
    return [
        run_of(cases[kind], {"seed": seed, "number": number})
        for kind, share in zip(kinds, shares, strict=True)
        for number in range(share)
    ]


def run_of(case: Case, parameters: dict[str, object]) -> Run:
    """Return the run of one problem."""
    name = f"{parameters['seed']}-{parameters['number']}"
    if "recipe" in parameters:
        name += "-cut"
    return Run(case, Variant(name, parameters), "blocks", BACKEND, FUZZ)  # type: ignore[arg-type]


def kind_of(run: Run) -> str:
    """Return the class of a run."""
    return run.case.id.removeprefix("fuzz-")


def known_kinds() -> list[str]:
    """Return all classes."""
    return list(CLASSES)


def random_of(kind: str, seed: int, number: int, use: str = "") -> Rng:
    """Return random numbers for one problem of a class; each `use` has its own."""
    return np.random.default_rng([seed, number, zlib.crc32(f"{kind}/{use}".encode())])


def draw(kind: str, seed: int, number: int) -> Recipe:
    """Return the recipe of problem `number` of a class.

    Raises:
        InputError: the class is unknown.
    """
    require_known("class", kind, CLASSES)
    return CLASSES[kind](random_of(kind, seed, number))
