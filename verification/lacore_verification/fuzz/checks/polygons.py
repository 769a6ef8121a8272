"""Frames of rectangular sections, with polygons inside and around their yield curves.

Linear programs of equilibrium with many more sides enclose the load factor of the curves, which the
inscribed polygons bound from below and the circumscribed ones from above.
"""

from collections.abc import Iterator, Mapping
from math import inf

import numpy as np
from scipy.optimize import linprog

import lacore as la
from lacore.numerics.arrays import Floats
from lacore_verification.fuzz.checks.verdict import BAR, Judgement, Wrong
from lacore_verification.fuzz.drawn.recipe import Recipe, build, copied

_SIDES = 64  # Sides of the enclosing polygons, between no axial force and the largest.
_HELD = {"clamped": (0, 1, 2), "xy": (0, 1), "y": (1,)}


def examine_polygons(recipe: Recipe) -> Judgement:
    """Solve a frame with both polygons, and check both load factors and their rigour."""
    (name,) = recipe["bodies"]
    states = {}
    for polygon in ("inner", "outer"):
        own = copied(recipe)
        own["bodies"][name]["polygon"] = polygon
        try:
            states[polygon] = la.solve(build(own))
        except la.InputError as error:
            return Judgement("refused", float("nan"), "", str(error), None)
    low, high = (enclosing(recipe, inscribed) for inscribed in (True, False))
    inner = states["inner"]
    return Judgement(
        inner.status.label,
        inner.load_factor,
        inner.rigor.label,
        inner.message,
        low > -inf,
        low,
        high,
        next(_wrong(states, low, high), None),
    )


def _wrong(states: Mapping[str, la.LimitState], low: float, high: float) -> Iterator[Wrong]:
    """Yield the failures of a frame whose load factor lies between low and high."""
    for polygon, rigor in (("inner", la.Rigor.LOWER), ("outer", la.Rigor.UPPER)):
        state = states[polygon]
        value, room = state.load_factor, BAR * (1 + abs(state.load_factor))
        if state.status is la.Status.UNSAFE:
            value = -inf
        elif state.status is la.Status.LOCKED:
            value = inf
        elif state.status is not la.Status.SOLVED:
            continue
        elif state.rigor is not rigor:
            yield Wrong("claim", f"the {polygon} polygon claims {state.rigor.label}")
        if polygon == "inner" and value > high + room:
            yield Wrong("bounds", f"the inner polygon carries {value:.9g}, the curve {high:.9g}")
        if polygon == "outer" and value < low - room:
            yield Wrong("bounds", f"the outer polygon carries {value:.9g}, the curve {low:.9g}")


def enclosing(recipe: Recipe, inscribed: bool) -> float:
    """Return the load factor of a fine polygon; -inf if it does not carry the dead loads."""
    (frame,) = recipe["bodies"].values()
    nodes = list(frame["nodes"])
    place = {node: np.array(at, dtype=float) for node, at in frame["nodes"].items()}
    count = 3 * len(frame["members"])
    # Forces and moment on each node, then the load factor.
    rows = np.zeros((3 * len(nodes), count + 1))
    limits: list[Floats] = []
    bounds: list[Floats] = []
    for member, (one, other) in enumerate(frame["members"].values()):
        along = place[other] - place[one]
        length = float(np.hypot(*along))
        along /= length
        across = np.array([-along[1], along[0]])
        for node, sign in ((one, 1.0), (other, -1.0)):
            first = 3 * nodes.index(node)
            rows[first : first + 2, 3 * member] = sign * along
            for end in (1, 2):  # moments of both ends on the member, anticlockwise
                rows[first : first + 2, 3 * member + end] = -sign * across / length
            rows[first + 2, 3 * member + (1 if node == one else 2)] = -1.0
        width, height, stress = frame["sections"][list(frame["members"])[member]]
        for end in (1, 2):
            sides, most = _sides(width * height * stress, width * height**2 * stress / 4, inscribed)
            block = np.zeros((len(sides), count + 1))
            block[:, [3 * member, 3 * member + end]] = sides
            limits.append(block)
            bounds.append(most)
    right = np.zeros(3 * len(nodes))
    for key in ("reference", "dead"):
        for load in recipe[key]:
            first = 3 * nodes.index(load["at"])
            if key == "reference":
                rows[first : first + 2, count] += load["vector"]
            else:
                right[first : first + 2] -= load["vector"]
    free = np.ones(3 * len(nodes), dtype=bool)
    for support in recipe["supports"]:
        first = 3 * nodes.index(support["where"])
        free[[first + axis for axis in _HELD[support["components"]]]] = False
    cost = np.zeros(count + 1)
    cost[-1] = -1.0
    found = linprog(
        cost,
        np.concatenate(limits),
        np.concatenate(bounds),
        rows[free],
        right[free],
        bounds=(None, None),
    )
    if found.status == 3:  # The program is unbounded.
        return inf
    return -inf if found.x is None else float(found.x[-1])


def _sides(squash: float, moment: float, inscribed: bool) -> tuple[Floats, Floats]:
    """Return the sides of ``|m| = 1 - n^2`` in N and M, shape (k, 2), and their limits."""
    n = np.linspace(0.0, 1.0, _SIDES + 1)
    slope, most = (n[1:] + n[:-1], 1 + n[1:] * n[:-1]) if inscribed else (2 * n, 1 + n**2)
    signs = [(a, b) for a in (-1.0, 1.0) for b in (-1.0, 1.0)]
    sides = [np.stack([a * slope / squash, np.full_like(slope, b / moment)], 1) for a, b in signs]
    return np.concatenate(sides), np.tile(most, len(signs))
