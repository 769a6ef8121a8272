r"""A stack of n equal blocks; alpha times its weight acts sideways on each of them.

              +-----+
              |  n  | --> alpha W
              +-----+ mu_n
              |     | --> alpha W
              +-----+  :
              |     | --> alpha W
              +-----+ mu_2
              |  1  | --> alpha W
              +-----+ mu_1
         /////////////////

What stands above a joint slides on it, or topples about its leading end. Friction may change from
the floor upwards, linearly from mu_1 to mu_n; toppling comes first at the floor, sliding where
friction is least. The load is unique, as the normal reactions of each joint follow from the
equilibrium of the blocks above it.
"""

from itertools import pairwise

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid


def _frictions(n: int, mu_1: float, mu_n: float) -> list[float]:
    """Return the friction coefficients of the joints, from the floor upwards."""
    return [mu_1 + (mu_n - mu_1) * i / max(n - 1, 1) for i in range(n)]


def build(n: int, mu_1: float, mu_n: float, b: float, h: float) -> "la.Problem":
    """Return the problem: blocks of unit weight per area."""
    names = ["base", *(str(i + 1) for i in range(n))]
    frictions = _frictions(n, mu_1, mu_n)
    blocks = la.masonry.stack(
        [(b, h)] * n, mu_1, dict(zip(pairwise(names), frictions, strict=True))
    )
    own = tuple(names[1:])
    return la.Problem(
        bodies={"blocks": blocks},
        supports=[la.Fix("blocks", "base")],
        reference_loads=[la.BodyForce("blocks", (1, 0), own)],
        dead_loads=[la.BodyForce("blocks", (0, -1), own)],
    )


def reference(n: int, mu_1: float, mu_n: float, b: float, h: float) -> Reference:
    """Return the reference: the smallest resistance of all joints."""
    value = min(min(_frictions(n, mu_1, mu_n)), b / (n * h))
    return Reference(
        value,
        "min(mu_i, b/(n h)) over joints i",
        "equilibrium, analytically",
        "exact",
        associated=value,
    )


def band(elements: int, n: int, mu_1: float, mu_n: float, b: float, h: float) -> Band:
    """Return the band: rigid; alpha is in weights."""
    return rigid(1.0)


CASE = Case(
    id="stack-n",
    title="Stack of n rigid blocks",
    tags=("blocks", "contact", "Coulomb", "closed form"),
    unit="W",
    explanation=__doc__,
    hand_calculation="""\
above joint i:  m = n - i + 1 blocks
sliding:        alpha m W = mu_i m W
toppling:       alpha m W (m h/2) = m W b/2
together:       alpha = min over i of min(mu_i, b/(m h))
                b/(m h) is least at the floor, m = n
n = 4, b = 1, h = 0.5: mu = 0.2: 0.2,  mu = 0.6: 0.5
""",
    build=build,
    reference=reference,
    band=band,
    variants=(
        Variant("slides", {"n": 4, "mu_1": 0.2, "mu_n": 0.2, "b": 1.0, "h": 0.5}),
        Variant("topples", {"n": 4, "mu_1": 0.6, "mu_n": 0.6, "b": 1.0, "h": 0.5}),
        Variant("slides-at-the-top", {"n": 4, "mu_1": 0.6, "mu_n": 0.3, "b": 1.0, "h": 0.5}),
    ),
)
