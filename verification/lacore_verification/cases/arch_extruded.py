r"""A semicircular arch, as a three-dimensional structure, one or several voussoirs deep.

                .--+--.            |y
             .-'\  |  /`-.         |  slices, one behind
           .'\   \_|_/   /'.       |  the other
          /   \.'     `./   \      +----- x
         /`-. /         \ .-'\
        |    |           |    |     alpha W sideways, along x
        +----+           +----+
        ///////         ///////

An extruded structure has the load factor of the plane one, with Coulomb friction and with
associated friction, for any number of slices (T78): slices may slide along each other, which does
not change it.

The reactions of an arch are hyperstatic, and it is not proven that its load is unique. Short
searches by `lacore.coulomb_range` found no load of these plane arches other than the associated
one, which proves nothing.
"""

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid
from lacore_verification.cases.shared.solids import HYPERSTATIC, named, shaken

# By plane programs, 7 digits: voussoirs, inner and outer radius, friction.
PLANE = {
    (9, 0.85, 1.15, 0.6): 0.3729062,
    (9, 0.85, 1.15, 0.35): 0.0730988,
    (15, 0.9, 1.1, 0.5): 0.2023837,
}


def build(voussoirs: int, inner: float, outer: float, mu: float, slices: int) -> "la.Problem":
    """Return the problem: voussoirs and springings, which are held."""
    arch = la.masonry3d.arch(voussoirs, inner, outer - inner, 1.0, mu, slices=slices)
    return shaken(arch, (*named(arch, "left"), *named(arch, "right")))


def reference(voussoirs: int, inner: float, outer: float, mu: float, slices: int) -> Reference:
    """Return the reference: that of the plane arch."""
    return Reference(
        PLANE[voussoirs, inner, outer, mu],
        "the load of the same arch in the plane",
        "plane programs, certified to 1e-8",
        "exact, numerical",
        half_width=5e-8,
    )


def band(elements: int, voussoirs: int, inner: float, outer: float, mu: float, slices: int) -> Band:
    """Return the band: rigid; alpha is in weights."""
    return rigid(1.0)


def _variant(name: str, voussoirs: int, radii: tuple[float, float], mu: float, n: int) -> Variant:
    inner, outer = radii
    given = {"voussoirs": voussoirs, "inner": inner, "outer": outer, "mu": mu, "slices": n}
    return Variant(name, given, unfit=HYPERSTATIC)


CASE = Case(
    id="arch-extruded",
    title="Semicircular arch in three dimensions",
    tags=("blocks", "space", "contact", "Coulomb", "masonry", "relation"),
    unit="W",
    explanation=__doc__,
    hand_calculation="""\
The same arch in the plane, 9 voussoirs,
radii 0.85 and 1.15, mu = 0.6:   0.3729062
                     mu = 0.35:  0.0730988
15 voussoirs, 0.9 and 1.1, 0.5:  0.2023837
""",
    build=build,
    reference=reference,
    band=band,
    variants=(
        _variant("whole", 9, (0.85, 1.15), 0.6, 1),
        _variant("three-slices", 9, (0.85, 1.15), 0.6, 3),
        _variant("slides", 9, (0.85, 1.15), 0.35, 1),
        _variant("thin", 15, (0.9, 1.1), 0.5, 1),
    ),
)
