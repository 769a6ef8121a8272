"""Small problems for the examples in docstrings: ``la.examples``."""

from __future__ import annotations

from lacore.model.bodies.blocks import masonry
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.frames.frame import Frame
from lacore.model.conditions.body_forces import BodyForce
from lacore.model.conditions.footings import RigidFooting
from lacore.model.conditions.loads import Fix, PointForce
from lacore.model.conditions.within import Within
from lacore.model.materials.friction import Friction
from lacore.model.materials.von_mises import VonMises
from lacore.model.meshes.structured import rectangle
from lacore.model.problem.problem import Problem

__all__ = ["beam", "column", "footing"]


def footing(strength: float = 1.0) -> Problem:
    """Return half of a rough rigid footing 2 m wide on soil in plane strain.

    The exact load factor is ``(2 + pi) strength``.

    Args:
        strength: shear strength, Pa; the load is the mean pressure of the footing, Pa.

    Example:
        >>> round(la.solve(la.examples.footing()).load_factor, 2)  # from above, on a coarse mesh
        5.93
    """
    mesh = rectangle(x=(0, 3), y=(-1.5, 0), nx=6, ny=3)
    return Problem(
        bodies={"soil": Body(mesh, VonMises(shear_strength=strength))},
        supports=[Fix("soil", "left", "x"), Fix("soil", "right"), Fix("soil", "bottom")],
        reference_loads=[RigidFooting("soil", Within(x=(0, 1), y=0), direction=(0, -1))],
    )


def column(friction: float | Friction = 0.3, width: float = 1.0) -> Problem:
    """Return a block 2 m high, pushed by a part of its weight: slides at mu, or tips at width/2.

    Args:
        friction: friction of its joint.
        width: m.

    Example:
        >>> round(la.solve(la.examples.column(friction=0.3)).load_factor, 3)
        0.3
    """
    blocks = masonry.stack([(width, 2.0)], friction)
    return Problem(
        bodies={"column": blocks},
        supports=[Fix("column", "base")],
        reference_loads=[BodyForce("column", (1, 0))],
        dead_loads=[BodyForce("column", (0, -1))],
    )


def beam(place: float = 2.0, moment: float = 1.0) -> Problem:
    """Return a beam 4 m long, fixed at both ends, under 1 N; for a central load exact ``8 M/L``.

    Args:
        place: place of the force, m from the left end.
        moment: plastic moment, N m.

    Example:
        >>> round(la.solve(la.examples.beam(moment=3.0)).load_factor, 3)
        6.0
    """
    member = Frame({"A": (0, 0), "B": (4, 0)}, [("A", "B")], plastic_moment=moment)
    return Problem(
        bodies={"beam": member},
        supports=[Fix("beam", ("A", "B"), "clamped")],
        reference_loads=[PointForce("beam", (place, 0), (0, -1))],
    )
