"""All checks of a state."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np

import lacore as la
from lacore.numerics.arrays import Floats
from lacore_verification.fuzz.checks.frame_checks import check_frames, frame_powers, hinge_power
from lacore_verification.fuzz.checks.rigid_checks import (
    Blocks,
    check_blocks,
    part_sizes,
    powers,
    rigid_blocks,
)
from lacore_verification.fuzz.checks.verdict import Wrong, beyond
from lacore_verification.fuzz.continua.flow import (
    Motion,
    check_footing,
    check_volume,
    dissipation_inside,
    footing_power,
    load_power,
    motion_of,
    power_on_footing,
)
from lacore_verification.fuzz.continua.power import (
    check_power,
    corners_of,
    edges_of,
    load_size,
    strain_points,
)
from lacore_verification.fuzz.continua.soils import check_soil, sides
from lacore_verification.fuzz.drawn.recipe import Recipe, Soil
from lacore_verification.fuzz.drawn.touches import Part, Touches, touches


@dataclass(frozen=True)
class Scale:
    """Dissipation of a state at ``F0.u = 1``, in load factors, and its largest velocity."""

    power: float
    speed: float


NO_SCALE = Scale(0.0, 0.0)


def scale_of(recipe: Recipe, problem: la.Problem, state: la.LimitState) -> Scale:
    """Return the dissipation and power of dead loads, which is the scale of load factors."""
    lost = float(dissipation(touches(recipe, problem, state)).sum()) + table_power(recipe, state)
    assert state.point is not None
    moving = [part[:2] for part in state.velocity.values()]
    moving.append(state.point.velocity[state.discretisation.footings][None])
    speed = max(float(np.abs(part).max(initial=0.0)) for part in moving)
    return Scale(lost + abs(lost - state.load_factor), speed)


def table_power(recipe: Recipe, state: la.LimitState) -> float:
    """Return the plastic power of bodies and hinges of a state."""
    total = 0.0
    for name, density in state.dissipation.items():
        body = state.discretisation.continua[name].body
        total += float(density @ strain_points(body)[1].sum(axis=1))
    frames = (name for name, body in recipe["bodies"].items() if body["kind"] == "frame")
    return total + sum(hinge_power(name, state) for name in frames)


def load_powers(
    recipe: Recipe, name: str, motion: Motion, state: la.LimitState
) -> tuple[float, float]:
    """Power of the reference and of the dead loads on a continuum, and on its footing."""
    own = [load for load in recipe["reference"] if load["load"] == "RigidFooting"]
    live, dead = (
        sum(
            (
                footing_power(motion, load, footing_speed(state))
                if load["load"] == "RigidFooting"
                else load_power(motion, load)
                + sum(footing_speed(state) * power_on_footing(motion, one, load) for one in own)
                for load in recipe[key]
                if load["body"] == name
            ),
            0.0,
        )
        for key in ("reference", "dead")
    )
    return live, dead


def footing_speed(state: la.LimitState) -> float:
    """Return the speed of the one footing of a problem, along its direction."""
    assert state.point is not None
    (speed,) = state.point.velocity[state.discretisation.footings]
    return float(speed)


def check_state(
    recipe: Recipe, problem: la.Problem, state: la.LimitState, rng: np.random.Generator
) -> Iterator[Wrong]:
    """Yield violations of a certified state: balance by part, laws by point, and powers."""
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
    yield from _check_yield(recipe, problem, state)
    yield from check_frames(recipe, points, state)
    yield from _check_friction(points, sizes, scale.power, scale.speed)
    yield from _check_powers(recipe, blocks, points, state, scale)


def _check_powers(
    recipe: Recipe, blocks: Blocks, points: Touches, state: la.LimitState, scale: Scale
) -> Iterator[Wrong]:
    """Yield violations of ``F0.u = 1`` and of the balance of load power and dissipation."""
    live, dead = powers(blocks, state)
    used = float(dissipation(points).sum())
    jumps = False
    for name, data in recipe["bodies"].items():
        if data["kind"] == "continuum":
            motion = motion_of(state, name)
            if "soil" not in data:
                yield from check_volume(motion, state.stress[name], name, scale.power)
            for load in recipe["reference"]:
                if load["load"] == "RigidFooting" and load["body"] == name and _flush(load, data):
                    yield from check_footing(motion, load, footing_speed(state), scale.speed)
            used += dissipation_inside(motion, data)
            jumps = True
            loads = load_powers(recipe, name, motion, state)
            live, dead = live + loads[0], dead + loads[1]
        elif data["kind"] == "frame":
            used += hinge_power(name, state)
            loads = frame_powers(recipe, name, data, state)
            live, dead = live + loads[0], dead + loads[1]
    yield from beyond("F0.u = 1", "off by", abs(live - 1), 1.0)
    lost = used - state.load_factor - dead
    # Jumps of velocities dissipate, too: the dissipation inside elements is a part of it.
    yield from beyond("power balance", "off by", lost if jumps else abs(lost), scale.power)
    if jumps:
        table = table_power(recipe, state) + float(dissipation(points).sum())
        lost = table - state.load_factor - dead
        yield from beyond("power balance", "of the table off by", abs(lost), scale.power)


def _flush(load: Mapping[str, Any], data: Mapping[str, Any]) -> bool:
    """Return whether the edges of a body stay on its footing.

    Continuous velocities slide along a smooth arc, which the edges replace; they bound nothing.
    """
    return load["rough"] or not data["mesh"].get("polar") or data["space"].endswith("disc")


def _check_friction(
    points: Touches, sizes: Mapping[Part, float], power: float, speed: float
) -> Iterator[Wrong]:
    """Yield violations of the friction law at contact points.

    Args:
        points: of contact.
        sizes: forces on each free part, N/m; the tolerance of a point is by the smaller of its two.
        power: total power of the state, N/m m/s.
        speed: largest velocity, m/s.
    """
    own = np.array(
        [
            min(sizes.get(slave, np.inf), sizes.get(master, np.inf))
            for slave, master in zip(points.slave, points.master, strict=True)
        ]
    )
    own = np.where(np.isfinite(own), own, np.abs(points.force).sum())
    yield from beyond("tension", "normal force", -points.force_n, own)
    shear = np.abs(points.force_t)
    bound = points.mu * points.force_n + points.limit
    yield from beyond("friction cone", "shear beyond it", (shear - bound)[points.limit < np.inf],
                      (own + np.where(np.isfinite(points.limit), points.limit, 0.0))[
                          points.limit < np.inf])  # fmt: skip
    yield from beyond("penetration", "u_n below 0", -points.opening, speed)
    dilated = points.dilatancy > 0
    shortfall = points.dilatancy * np.abs(points.slip) - points.opening
    yield from beyond("dilatancy", "u_n below mu |u_t|", shortfall[dilated], speed)
    stuck = np.isinf(points.limit)
    yield from beyond("no slip", "slip", np.abs(points.slip[stuck]), speed)
    lost = dissipation(points) + points.force_n * points.opening + points.force_t * points.slip
    yield from beyond("law of a contact", "power off by", np.abs(lost), power)


def dissipation(points: Touches) -> Floats:
    """Return the power of friction at each point, N/m m/s."""
    bound = np.where(points.dilatancy > 0, 0.0, points.mu * points.force_n)
    limit = np.where(np.isfinite(points.limit), points.limit, 0.0)
    return np.asarray((bound + limit) * np.abs(points.slip))


def _check_yield(recipe: Recipe, problem: la.Problem, state: la.LimitState) -> Iterator[Wrong]:
    """Yield stresses beyond the strength, by the formula of each kinematics."""
    for name, stress in state.stress.items():
        data = recipe["bodies"][name]
        if "soil" in data:
            corners = corners_of(state.discretisation.continua[name].body)
            yield from check_soil(sides(Soil(data), corners, np.max), name, stress)
            continue
        shear = _shear_stress(stress, data["kinematics"])
        yield from beyond("yield", f"stress of {name!r} beyond", shear - data["strength"],
                          data["strength"])  # fmt: skip
    if len(recipe["reference"]) == 1 and recipe["reference"][0]["load"] == "RigidFooting":
        yield from _check_footing(recipe, problem, state)


def _shear_stress(stress: Floats, kinematics: str) -> Floats:
    """Return the equivalent shear stress of von Mises; stress (..., 4)."""
    xx, yy, zz, xy = np.moveaxis(stress, -1, 0)
    if kinematics == "plane_strain":
        return np.asarray(np.hypot((xx - yy) / 2, xy))
    squares = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.asarray(np.sqrt(squares / 6 + xy**2))


def _check_footing(recipe: Recipe, problem: la.Problem, state: la.LimitState) -> Iterator[Wrong]:
    """Yield a failure if forces under a footing differ from its load.

    Its nodes are free otherwise. They are net of tractions that act on the footing.
    """
    load = recipe["reference"][0]
    body = problem.bodies[load["body"]]
    assert isinstance(body, la.Body)
    start, end, _ = edges_of(body, load["where"])
    held = [s for s in recipe["supports"] if s["body"] == load["body"]]
    dead = [d for d in recipe["dead"] if d["load"] == "RigidFooting"]
    if held or dead:
        return
    table = state.support_reactions
    own = table[table["body"] == load["body"]]
    length = np.linalg.norm(end - start, axis=0)
    if body.axisymmetric:
        length = length * np.pi * (start[0] + end[0])
    direction = np.array(load["direction"]) / np.hypot(*load["direction"])
    force = own[["force_x", "force_y"]].to_numpy()
    asked = state.load_factor * load.get("pressure", 1.0) * length.sum()
    size = np.hypot(*force.T).sum() + abs(asked)
    yield from beyond("load of a footing", "off by", abs((force @ direction).sum() - asked), size)
