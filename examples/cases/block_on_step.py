r"""A heavy block stands against a step and is pushed over it by a force at its top.

          alpha -->+---------+
                   |         |
                 h |    W    |___
                   |         |   | step, smooth
          /////////+---------+////////
                      floor, smooth

Nothing has friction. The block cannot slide: it topples about the edge of the step, and its lower
right corner slips backwards.
"""

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid

WIDTH, WEIGHT, STEP = 1.0, 2.0, 0.2  # m, N/m, m


def build(h: float) -> la.Problem:
    """The block, of height h."""
    outline = [(0, 0), (WIDTH, 0), (WIDTH, STEP), (WIDTH, h), (0, h)]
    return la.Problem(
        bodies={"block": la.RigidBlock(outline)},
        interfaces=[
            la.Interface(("block", lambda x: x[1] == 0), la.RigidObstacle(), la.SMOOTH),
            la.Interface(("block", _at_step), la.RigidObstacle(), la.SMOOTH),
        ],
        reference_loads=[la.PointForce("block", (0, h), (1, 0))],
        dead_loads=[la.BodyForce("block", (0, -WEIGHT / (WIDTH * h)))],
    )


def _at_step(x):
    return (x[0] == WIDTH) & (x[1] <= STEP)


def reference(h: float) -> Reference:
    """Moments about the edge of the step."""
    value = WEIGHT * WIDTH / 2 / (h - STEP)
    return Reference(value, "W b / (2 (h - s))", "moments by hand", "exact")


def band(elements: int, h: float) -> Band:
    """Rigid blocks have no discretisation error."""
    return rigid(dead=WEIGHT)


CASE = Case(
    id="block-on-step",
    title="A block is pushed over a step",
    tags=("blocks", "contact", "closed form"),
    unit="N/m",
    explanation=__doc__,
    hand_calculation="alpha (h - s) = W b/2   ->   alpha = W b / (2 (h - s))\n",
    build=build,
    reference=reference,
    band=band,
    variants=(Variant("square", {"h": 1.0}), Variant("tall", {"h": 2.0})),
)
