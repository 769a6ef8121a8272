"""Derivatives of load factors compared with finite differences of solves."""

from collections.abc import Iterator

import lacore as la
from lacore.analyses.envelope_theorem import Nearby, by_multipliers
from lacore.analyses.parameters import parameters_of
from lacore_verification.fuzz.checks.verdict import Wrong
from lacore_verification.fuzz.drawn.draw import Rng

_STEP = 1e-4  # Relative step of a number.
# Relative to the largest elasticity compared, or to 1: curvature, and kinks nearby.
_FORCE = 0.02


def wrong_derivatives(problem: la.Problem, state: la.LimitState, rng: Rng) -> Iterator[Wrong]:
    """Yield a failure if a random derivative differs from finite differences.

    Only where the solves on one side lie on a line: a kink may be near any number.
    """
    parameters = parameters_of(problem)
    if not parameters or not state.load_factor:
        return
    own = parameters[int(rng.integers(len(parameters)))]
    nearby = Nearby(state, {"backend": state.backend, "coupling": state.coupling})
    try:
        (row,) = by_multipliers(state, [own], nearby)
    except Exception as error:
        yield Wrong("exception", f"derivative by {own.name}: {type(error).__name__}: {error}")
        return
    if row["why"]:
        return
    scale = own.size / abs(state.load_factor)
    for side, sign in (("left", -1.0), ("right", 1.0)):
        slopes = []
        for share in (0.5, 1.0):
            step = sign * share * _STEP * own.size
            try:
                found = nearby.solved(own.at(problem, own.value + step))
            except la.InputError:
                return
            if found.status is not la.Status.SOLVED:
                return
            slopes.append((found.load_factor - state.load_factor) / step * scale)
        wanted, known = slopes[0], row[side] * scale
        room = _FORCE * max(1.0, abs(wanted), abs(known))
        if abs(slopes[1] - slopes[0]) <= room < abs(wanted - known):
            text = f"by {own.name}, {side}: elasticity {known:.6g}, of solves {wanted:.6g}"
            yield Wrong("derivative", text)


def is_smooth(problem: la.Problem) -> bool:
    """Return whether the problem is a linear program, with accurate solves."""
    return not any(isinstance(body, la.Body) for body in problem.bodies.values())
