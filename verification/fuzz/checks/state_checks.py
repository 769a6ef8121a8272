"""All that is checked of one answer."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite

import numpy as np

import lacore as la
from verification.fuzz.checks.flow import (
    Motion,
    check_footing,
    check_volume,
    dissipation_inside,
    footing_power,
    load_power,
    motion_of,
)
from verification.fuzz.checks.frame_checks import check_frames, frame_powers, hinge_power
from verification.fuzz.checks.friction_checks import check_friction, dissipation
from verification.fuzz.checks.power import check_power, load_size, strain_points
from verification.fuzz.checks.rigid_checks import (
    Blocks,
    check_blocks,
    part_sizes,
    powers,
    rigid_blocks,
)
from verification.fuzz.checks.verdict import Wrong, beyond
from verification.fuzz.checks.yield_checks import check_yield
from verification.fuzz.drawn.recipe import Recipe
from verification.fuzz.drawn.touches import Touches, touches


@dataclass(frozen=True)
class Scale:
    """What a state turns over at ``F0.u = 1``, in units of load factors, and how fast it moves."""

    power: float
    speed: float


NO_SCALE = Scale(0.0, 0.0)


def scale_of(recipe: Recipe, problem: la.Problem, state: la.LimitState) -> Scale:
    """Dissipation and power of dead loads: what load factors are compared by."""
    lost = float(dissipation(touches(recipe, problem, state)).sum()) + table_power(recipe, state)
    assert state.point is not None
    moving = [part[:2] for part in state.velocity.values()]
    moving.append(state.point.velocity[state.discretisation.footings][None])
    speed = max(float(np.abs(part).max(initial=0.0)) for part in moving)
    return Scale(lost + abs(lost - state.load_factor), speed)


def table_power(recipe: Recipe, state: la.LimitState) -> float:
    """Plastic power of bodies and hinges as a state has it."""
    total = 0.0
    for name, density in state.dissipation.items():
        body = state.discretisation.continua[name].body
        total += float(density @ strain_points(body)[1].sum(axis=1))
    frames = (name for name, body in recipe["bodies"].items() if body["kind"] == "frame")
    return total + sum(hinge_power(name, state) for name in frames)


def load_powers(
    recipe: Recipe, name: str, motion: Motion, state: la.LimitState
) -> tuple[float, float]:
    """Power of the reference and of the dead loads on a continuum."""
    live, dead = (
        sum(
            (
                footing_power(motion, load, footing_speed(state))
                if load["load"] == "RigidFooting"
                else load_power(motion, load)
                for load in recipe[key]
                if load["body"] == name
            ),
            0.0,
        )
        for key in ("reference", "dead")
    )
    return live, dead


def footing_speed(state: la.LimitState) -> float:
    """Of the one footing of a problem, along its direction."""
    assert state.point is not None
    (speed,) = state.point.velocity[state.discretisation.footings]
    return float(speed)


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
    for name, body in problem.bodies.items():
        if isinstance(body, la.Body) and (name, "") in sizes:
            sizes[name, ""] += sum(
                abs(factor) * load_size(body, load)
                for factor, key in ((state.load_factor, "reference"), (1.0, "dead"))
                for load in recipe[key]
                if load["body"] == name
            )
    yield from check_blocks(recipe, blocks, points, state)
    yield from check_power(recipe, problem, points, state, rng)
    yield from check_yield(recipe, problem, state)
    yield from check_frames(recipe, points, state)
    yield from check_friction(points, sizes, scale.power, scale.speed)
    yield from _check_powers(recipe, blocks, points, state, scale)


def _check_powers(
    recipe: Recipe, blocks: Blocks, points: Touches, state: la.LimitState, scale: Scale
) -> Iterator[Wrong]:
    """That ``F0.u = 1`` and that loads take out what flow, hinges and friction use up."""
    live, dead = powers(blocks, state)
    used = float(dissipation(points).sum())
    jumps = False
    for name, data in recipe["bodies"].items():
        if data["kind"] == "continuum":
            motion = motion_of(state, name)
            yield from check_volume(motion, state.stress[name], name, scale.power)
            for load in recipe["reference"]:
                if load["load"] == "RigidFooting" and load["body"] == name:
                    yield from check_footing(motion, load, footing_speed(state), scale.speed)
            used += dissipation_inside(motion)
            jumps = True
            loads = load_powers(recipe, name, motion, state)
            live, dead = live + loads[0], dead + loads[1]
        elif data["kind"] == "frame":
            used += hinge_power(name, state)
            loads = frame_powers(recipe, name, data, state)
            live, dead = live + loads[0], dead + loads[1]
    yield from beyond("F0.u = 1", "off by", abs(live - 1), 1.0)
    lost = used - state.load_factor - dead
    # Jumps of velocities dissipate, too: what is used up inside elements is a part of it.
    yield from beyond("power balance", "off by", lost if jumps else abs(lost), scale.power)
    if jumps:
        table = table_power(recipe, state) + float(dissipation(points).sum())
        lost = table - state.load_factor - dead
        yield from beyond("power balance", "of the table off by", abs(lost), scale.power)
