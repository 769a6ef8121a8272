"""Frames: overall balance, moments within M_p, and powers, from the tables of a state."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

import lacore as la
from lacore.numerics.arrays import Floats
from lacore_verification.fuzz.checks.verdict import Wrong, beyond
from lacore_verification.fuzz.drawn.recipe import Recipe
from lacore_verification.fuzz.drawn.touches import Touches


def check_frames(recipe: Recipe, points: Touches, state: la.LimitState) -> Iterator[Wrong]:
    """Yield violations of the balance of each frame and of the laws of its hinges."""
    for name, data in recipe["bodies"].items():
        if data["kind"] == "frame":
            yield from _check(recipe, name, data, points, state)


def _check(
    recipe: Recipe, name: str, data: Mapping[str, Any], points: Touches, state: la.LimitState
) -> Iterator[Wrong]:
    parts = [
        (factor * force, at)
        for factor, key in ((state.load_factor, "reference"), (1.0, "dead"))
        for load in recipe[key]
        if load["body"] == name
        for force, at in _forces(data, load)
    ]
    sign = points.of((name, ""))
    parts += list(zip(sign[:, None] * points.force, points.place, strict=True))
    table = state.support_reactions
    own = table[table["body"] == name]
    parts += list(
        zip(own[["force_x", "force_y"]].to_numpy(), own[["x", "y"]].to_numpy(), strict=True)
    )
    force, at = np.array([f for f, _ in parts]), np.array([a for _, a in parts])
    span = float(np.ptp(np.array(list(data["nodes"].values())), axis=0).max())
    arm = at - at.mean(axis=0)
    moment = arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
    couples = own["moment"].to_numpy()
    size = np.hypot(*force.T).sum() + np.abs(couples).sum() / span
    off = np.hypot(*force.sum(axis=0)) + abs(moment.sum() + couples.sum()) / span
    yield from beyond("balance of a frame", f"{name!r} off by", off, size)
    hinges = state.hinges
    hinges = hinges[hinges["frame"] == name]
    plastic, turn = hinges["plastic_moment"].to_numpy(), hinges["rotation_rate"].to_numpy()
    bending = hinges["moment"].to_numpy()
    yield from beyond("plastic moment", "beyond it", np.abs(bending) - plastic, plastic)
    lost = plastic * np.abs(turn)
    size = (
        lost.sum() + np.abs(state.load_factor) + np.abs(frame_powers(recipe, name, data, state)[1])
    )
    yield from beyond("law of a hinge", "power off by", np.abs(lost - bending * turn), size)


def hinge_power(name: str, state: la.LimitState) -> float:
    """Return the plastic power of all hinges of a frame."""
    hinges = state.hinges
    if not len(hinges):
        return 0.0
    own = hinges[hinges["frame"] == name]
    return float((own["plastic_moment"] * own["rotation_rate"].abs()).sum())


def _forces(data: Mapping[str, Any], load: Mapping[str, Any]) -> list[tuple[Floats, Floats]]:
    """Return the force and place of a load on a frame."""
    nodes = data["nodes"]
    force = np.array(load["vector"], dtype=float)
    if load["load"] == "PointForce":
        at = nodes[load["at"]] if isinstance(load["at"], str) else load["at"]
        return [(force, np.array(at, dtype=float))]
    one, other = (np.array(nodes[end], dtype=float) for end in data["members"][load["where"]])
    return [(np.linalg.norm(other - one) * force, (one + other) / 2)]


def frame_powers(
    recipe: Recipe, name: str, data: Mapping[str, Any], state: la.LimitState
) -> tuple[float, float]:
    """Return the power of the reference and dead loads at the velocities of the nodes."""
    frame = state.discretisation.frames[name].body
    place, motion = frame.position.T, state.velocity[name][:2].T
    result = []
    for key in ("reference", "dead"):
        total = 0.0
        for load in recipe[key]:
            if load["body"] != name:
                continue
            if load["load"] == "PointForce":
                at = _forces(data, load)[0][1]
                node = int(np.argmin(np.linalg.norm(place - at, axis=1)))
                total += float(np.array(load["vector"]) @ motion[node])
            else:
                total += _along(data, load, place, motion)
        result.append(total)
    return result[0], result[1]


def _along(
    data: Mapping[str, Any], load: Mapping[str, Any], place: Floats, motion: Floats
) -> float:
    """Return the power of a traction along a member, which is straight between its nodes."""
    one, other = (
        np.array(data["nodes"][end], dtype=float) for end in data["members"][load["where"]]
    )
    length = np.linalg.norm(other - one)
    along = (other - one) / length
    away = place - one
    share = away @ along
    across = np.abs(along[0] * away[:, 1] - along[1] * away[:, 0])
    on = np.flatnonzero((across < 1e-9 * length) & (share > -1e-9) & (share < length * (1 + 1e-9)))
    on = on[np.argsort(share[on])]
    speed = motion[on] @ np.array(load["vector"], dtype=float)
    return float(np.sum(np.diff(share[on]) * (speed[1:] + speed[:-1]) / 2))
