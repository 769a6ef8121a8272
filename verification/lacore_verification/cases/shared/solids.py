"""Three-dimensional blocks for cases: boxes, and structures under horizontal acceleration."""

import numpy as np

import lacore as la
from lacore_verification.case import Reference

Point = tuple[float, float, float]
_SIDES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def box(low: Point, high: Point) -> "la.Polyhedron":
    """Return a box by two of its corners."""
    (a, b, c), (d, e, f) = low, high
    ground = ((a, b), (d, b), (d, e), (a, e))
    return la.Polyhedron(np.array([(x, y, z) for z in (c, f) for x, y in ground]), _SIDES)


def on_floor(b: float, h: float) -> "dict[str, la.Polyhedron]":
    """Return a block b x b x h on a larger one, ``floor``, its axis that of z."""
    return {
        "floor": box((-b, -b, -h), (b, b, 0.0)),
        "block": box((-b / 2, -b / 2, 0.0), (b / 2, b / 2, h)),
    }


def shaken(
    blocks: "la.BlockAssembly3D", held: tuple[str, ...], direction: Point = (1.0, 0.0, 0.0)
) -> "la.Problem":
    """Return own weight as dead load, alpha times it along a unit vector; some blocks are fixed."""
    own = tuple(name for name in blocks.names if name not in held)
    return la.Problem(
        bodies={"blocks": blocks},
        supports=[la.Fix("blocks", held, "xyz")],
        reference_loads=[la.BodyForce("blocks", direction, own)],
        dead_loads=[la.BodyForce("blocks", (0.0, 0.0, -1.0), own)],
    )


def named(blocks: "la.BlockAssembly3D", start: str) -> tuple[str, ...]:
    """Return names of blocks with this prefix."""
    return tuple(name for name in blocks.names if name.startswith(start))


HYPERSTATIC = {
    "regularised": "undetermined clamping forces: penalties take the reaction loop tens of solves"
}


def certified(value: float, associated: float, up_to: float | None = None) -> Reference:
    """Return the reference to a certified load, or to all loads of its mechanism."""
    return Reference(
        value,
        "a Coulomb state whose ten residuals are below 1e-6",
        "certified, and judged by an independent checker; no other source is known",
        "interval of one mechanism",
        up_to=value if up_to is None else up_to,
        associated=associated,
        complete=False,
    )
