"""All that is checked of one answer."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite

import numpy as np

import lacore as la
from verification.fuzz.frame_checks import check_frames
from verification.fuzz.friction_checks import check_friction, dissipation
from verification.fuzz.power import check_power, strain_points
from verification.fuzz.recipe import Recipe
from verification.fuzz.rigid_checks import check_blocks, part_sizes, powers, rigid_blocks
from verification.fuzz.touches import touches
from verification.fuzz.verdict import Wrong, beyond
from verification.fuzz.yield_checks import check_yield


@dataclass(frozen=True)
class Scale:
    """What a state turns over at ``F0.u = 1``, in units of load factors, and how fast it moves."""

    power: float
    speed: float


NO_SCALE = Scale(0.0, 0.0)


def scale_of(recipe: Recipe, problem: la.Problem, state: la.LimitState) -> Scale:
    """Dissipation and power of dead loads: what load factors are compared by."""
    friction = dissipation(touches(recipe, problem, state)).sum()
    plastic = 0.0
    for name, density in state.dissipation.items():
        body = problem.bodies[name]
        assert isinstance(body, la.Body)
        plastic += float(density @ strain_points(body)[1].sum(axis=1))
    hinges = state.hinges
    if len(hinges):
        plastic += float((hinges["plastic_moment"] * hinges["rotation_rate"].abs()).sum())
    lost = float(friction + plastic)
    speed = max(float(np.abs(part[:2]).max(initial=0.0)) for part in state.velocity.values())
    return Scale(lost + abs(lost - state.load_factor), speed)


def check_state(
    recipe: Recipe, problem: la.Problem, state: la.LimitState, rng: np.random.Generator
) -> Iterator[Wrong]:
    """That a certified state is one: balance part by part, laws point by point, powers."""
    if not isfinite(state.load_factor):
        yield Wrong("number", f"solved, and the load factor is {state.load_factor}")
        return
    points, blocks = touches(recipe, problem, state), rigid_blocks(recipe)
    scale = scale_of(recipe, problem, state)
    sizes = part_sizes(recipe, blocks, points, state.load_factor)
    yield from check_blocks(recipe, blocks, points, state)
    yield from check_power(recipe, problem, points, state, rng)
    yield from check_yield(recipe, problem, state)
    yield from check_frames(recipe, points, state)
    yield from check_friction(points, sizes, scale.power, scale.speed)
    if all(body["kind"] == "blocks" for body in recipe["bodies"].values()):
        live, dead = powers(blocks, state)
        yield from beyond("F0.u = 1", "off by", abs(live - 1), 1.0)
        lost = state.load_factor + dead - dissipation(points).sum()
        yield from beyond("power balance", "off by", abs(lost), scale.power)
