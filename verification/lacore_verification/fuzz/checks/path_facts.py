"""Facts about random paths without a solver: exact forces, friction, the power of tools."""

from collections.abc import Iterator
from math import log, sqrt
from typing import Any

import numpy as np

import lacore as la
from lacore_verification.fuzz.checks.verdict import BAR, Wrong, beyond
from lacore_verification.fuzz.drawn.recipe import Recipe
from lacore_verification.fuzz.drawn.touches import law_terms

_SLIPS = 1e-4  # Relative to the largest velocity: below it a point may stick.
_TOUCH = 1e-5  # m, for bodies about 1 m in size.
_VOLUME = 1e-6  # Error of the implicit midpoint, per step.
# Relative to the largest traction: residuals of certificates are summed and scaled otherwise.
_STATE = 1e-4


def exact_force(recipe: Recipe, travel: float) -> float:
    """Return the force at a travel, or the power of the tools per travel, from the fact."""
    bodies, fact = recipe["bodies"], recipe["fact"]
    if fact == "sled":
        (pair,), (load,) = recipe["interfaces"], recipe["dead"]
        left, right = bodies["upper"]["mesh"]["x"]
        return float(pair["friction"] * load["value"] * (right - left))
    flowing = {"stack": ("lower", "upper"), "narrow": ("upper",), "platens": ("block",)}[fact]
    closing = 1.0
    if fact == "platens":
        up, low = (np.array(recipe["path"]["tools"][name]) for name in ("up", "low"))
        closing = float(np.linalg.norm(low - up))
    height = sum(float(np.ptp(bodies[name]["mesh"]["y"])) for name in flowing)
    return closing * _upsetting(bodies[flowing[0]], 1 - closing * travel / height)


def _upsetting(body: dict[str, Any], length: float) -> float:
    """Return the force of uniform compression in plane strain from length 1 to `length`."""
    factor = 2 / sqrt(3)
    stress = sqrt(3) * body["strength"] + body["hardening"] * factor * -log(length)
    return float(factor * stress * np.ptp(body["mesh"]["x"]) / length)


def check_facts(recipe: Recipe, path: la.Path) -> Iterator[Wrong]:
    """Yield the failures of a path that has reached its end."""
    history = path.history
    if "fact" in recipe:
        exact = np.array([exact_force(recipe, float(at)) for at in history["travel"]])
        away = np.abs(history["force"].to_numpy() - exact)
        yield from beyond("exact force of a path", "off by", away, exact)
    if recipe["path"]["scheme"] == "implicit-midpoint":
        volume = history["volume"].to_numpy()
        yield from beyond("volume of a path", "changes by", np.abs(np.diff(volume)), volume[1:],
                          _VOLUME)  # fmt: skip
    for step in history["step"]:
        yield from _coulomb(recipe, path, path.state(int(step)))
    if "tools" in recipe["path"]:
        yield from _power(recipe, path)


def _coulomb(recipe: Recipe, path: la.Path, state: la.LimitState) -> Iterator[Wrong]:
    """Yield violations of pressure and friction at contact points."""
    table = state.reactions
    names = [own.name for own in path.stage.interfaces]
    laws = {
        name: law_terms(data["friction"])
        for name, data in zip(names, recipe["interfaces"], strict=True)
    }
    known = np.array([laws[str(name).split("#")[0]] for name in table["interface"]])
    mu, limit = known.reshape(-1, 3)[:, :2].T
    normal, shear, slip, gap = (table[name].to_numpy() for name in ("t_n", "t_t", "u_t", "gap"))
    # A point that closes its gap within the step sticks from the next one; mu t_n acts at once.
    limit = np.where(gap <= _TOUCH, limit, 0.0)
    scale = max(float(np.abs(normal).max(initial=0.0)), float(np.abs(shear).max(initial=0.0)))
    yield from beyond("tension on a path", "of", -normal, scale, _STATE)
    most = mu * np.maximum(normal, 0.0) + limit
    yield from beyond("friction on a path", "beyond its law by", np.abs(shear) - most, scale,
                      _STATE)  # fmt: skip
    speed = max(float(np.abs(own).max()) for own in state.velocity.values())
    slips = (np.abs(slip) > _SLIPS * speed) & np.isfinite(most) & (normal > _STATE * scale)
    short = np.where(slips, most + shear * np.sign(slip), 0.0)
    yield from beyond("slip on a path", "with too little friction, by", short, scale, _STATE)


def _power(recipe: Recipe, path: la.Path) -> Iterator[Wrong]:
    """Yield a failure if the power of contact forces on the tools is not the driving power."""
    forces = path.tool_forces().set_index("body")
    motions = recipe["path"]["tools"]
    terms = np.array(
        [
            -motion[axis] * forces[name][body]
            for body, motion in motions.items()
            for axis, name in enumerate(("f_x", "f_y"))
        ]
    )
    force = float(path.history["force"].iloc[-1])
    size = np.abs(terms).sum() + abs(force)
    yield from beyond("power of tools", "differs by", abs(terms.sum() - force), size, 10 * BAR)
