"""A block twice as wide as high is pressed between two rigid platens with Coulomb friction mu.

           alpha                        platen, at rest
        v  v  v  v  v                ///////// mu /////////
      +---------------+              +--------------------+
      |       :       |        u_x=0 o                    |  free
      | - - - : - - - |              o   quarter model    |
      |       :       |              +--------------------+
      +---------------+                ^  ^  ^  ^  ^  ^  ^
        ^  ^  ^  ^  ^                smooth footing, moves up

By symmetry a quarter is modelled, and seen by an observer on the platen: the platen is the rigid
obstacle at rest and the mid-plane is pushed up against it, flat and smooth. Without friction the
block would need 2 k; friction confines it. From mu of about 0.3 on the block sticks to the platens
and the load grows no more. The edge of the platen is a singular point.

It is not proven that the Coulomb loads are unique, because the pressure on the platens depends on
the state. Proven for all of them is 2 k from below, by uniform stress without friction, and the
associated load from above. Short searches by `lacore.coulomb_range` on 128 elements for mu = 0.1,
0.2 and 0.3 found no clearly lower Coulomb load, which proves nothing.
"""

import lacore as la
from lacore_verification.case import Band, Beside, Case, Convergence, Order, Reference, Variant
from lacore_verification.case.band import Bracketing

WIDTH, HEIGHT = 1.0, 0.5  # of the quarter

_PUBLISHED = {0.05: 2.100, 0.1: 2.197, 0.2: 2.365}
_PUBLISHED_TO = 0.003
_ASSOCIATED = (2.35961, 2.36134)  # mu = 0.2, proven by `lacore.bracket`, 0.07 % wide
_STICKING = 2.427658
_SLIDING = Convergence(
    0.0587,
    0.62,
    "mu = 0.2, the worst; 32 to 2048 elements: 0.69, 0.34, 0.17, 0.089, 0.052 % above the limit"
    " 2.3613 that they and the interior rule tend to",
)
_STICK = Convergence(
    0.172, 0.52, "mu = 0.3; 32 to 4800 elements: 2.84, 1.42, 0.76, 0.46, 0.32, 0.21 % above"
)


def build(nx: int, ny: int, ratio: float, mu: float) -> "la.Problem":
    """Return the problem: the quarter, graded towards the edge of the platen."""
    mesh = la.meshes.rectangle(
        x=(0, WIDTH), y=(0, HEIGHT), nx=nx, ny=ny, grade_x=(WIDTH, ratio), grade_y=(HEIGHT, ratio)
    )
    return la.Problem(
        bodies={"block": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        supports=[la.Fix("block", "left", "x")],
        interfaces=[la.Interface(("block", "top"), la.RigidObstacle((0, HEIGHT), (0, -1)), mu)],
        reference_loads=[la.RigidFooting("block", "bottom", (0, 1), rough=False)],
    )


def reference(mu: float) -> Reference:
    """Return the reference.

    Numerical solutions of the slip-line problem; with much friction that of sticking platens.
    """
    if mu >= 0.3:
        return Reference(
            _STICKING,
            "slip-line net of sticking platens",
            "net integrated to 6 digits; bracket [2.4152, 2.4569] by independent bounds;"
            " after Salencon",
            "exact, numerical",
            half_width=0.003,
        )
    if mu >= 0.2:
        low, high = _ASSOCIATED
        return Reference(
            (low + high) / 2,
            "refined finite elements, below a proven bound",
            f"associated friction, which carries no less, is proven to lie in [{low}, {high}];"
            " refinement here tends to 2.3613",
            "bracket",
            half_width=(high - low) / 2,
        )
    return Reference(
        _PUBLISHED[mu],
        "extrapolated from refined finite elements",
        "independent computation, to the half width; refinement here tends to 2.0996 and 2.1962"
        " for mu = 0.05, 0.1",
        "bracket",
        half_width=_PUBLISHED_TO,
    )


def beside(mu: float) -> tuple[Beside, ...]:
    """Return further values.

    What is no reference, as associated friction is proven to carry less.
    """
    if mu != 0.2:
        return ()
    source = f"refined finite elements, extrapolated, to +- {_PUBLISHED_TO}"
    return (Beside("independent computation", _PUBLISHED[mu], source, _PUBLISHED_TO),)


def band(elements: int, mu: float) -> Band:
    """Return the band: converges from above, but frozen Coulomb friction makes no bounds."""
    error = _STICK if mu >= 0.3 else _SLIDING
    return error.two_sided(elements, "frozen Coulomb friction is not associated.")


def order(mu: float) -> Order | None:
    """Return the order of convergence.

    With sticking platens alone; where they slide, references are no better than the errors.

    From 288 elements on these are smaller than the half width of the reference, 0.13 %.
    """
    if mu < 0.3:
        return None
    return Order(
        tuple({"nx": 2 * n, "ny": n, "ratio": 2.0 * n} for n in (2, 4, 6, 8, 12)),
        0.53,
        0.1,
        "Measured: 0.530 +- 0.022 (95 %) over 32 to 1152 elements, 0.52 up to 4800: that of a"
        " singular edge which the grading does not resolve. A reference off by its half width would"
        " make it 0.47 or 0.61.",
    )


CASE = Case(
    id="platens-coulomb",
    title="Block pressed between platens with friction, w/h = 2",
    tags=("continuum", "contact", "Coulomb", "singular point"),
    unit="F/(w k)",
    explanation=__doc__,
    hand_calculation="""\
no friction:  alpha = 2 k (uniform compression)
sticking:     slip-line net of the block: alpha = 2.427658 k
in between:   slab method, an estimate for little friction:
              dp/dx = 2 mu p/h from p = 2 k at the free side
              alpha = 2 k (e^c - 1)/c, c = mu w/h, w = 2 h
              mu = 0.05: 2.103, mu = 0.1: 2.214
              (a little high: the shear that friction brings
              weakens the block, which the slab ignores)
""",
    meshes={
        "coarse": {"nx": 4, "ny": 2, "ratio": 4.0},
        "medium": {"nx": 18, "ny": 8, "ratio": 16.0},
        "fine": {"nx": 48, "ny": 25, "ratio": 60.0},
    },
    build=build,
    reference=reference,
    beside=beside,
    band=band,
    order=order,
    bracket=Bracketing(target_width=0.0015),
    variants=(
        *(Variant(f"mu-{mu:g}", {"mu": mu}) for mu in (0.2, 0.1, 0.3)),
        Variant("mu-0.05", {"mu": 0.05}, meshes=("coarse",)),
    ),
    sweep="mu",
)
