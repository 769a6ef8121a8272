r"""A hollow sphere inside another one is blown up: the two are one thick sphere.

        z
        | axis
        o - _
        o -_  ` .
        o   `.   `.     inner shell: r from 1 to 1.5
        o _   `.   \    outer shell: r from 1.5 to 2
          ` .  <-\  \
          p    `. |  |  Coulomb contact between the two
          -->   \ |  |
    ------------ o o o --- r
                  u_z = 0

Axisymmetric, a quarter of a meridian section. All particles move along rays, so that nothing slips
between the shells whatever the friction, and the closed form is that of one thick sphere. The
contact surface is curved: where the elements of the two shells do not match, their edges are
different parabolas through the same circle, up to 2e-5 m apart. Without friction each shell could
change its shape at nearly the same pressure (T32); friction holds the shells together.
"""

from dataclasses import replace
from math import pi

import lacore as la
from lacore_verification.case import SOLVER, Band, Case, First, Reference, Variant
from lacore_verification.case.following import Following
from lacore_verification.cases import hardening_sphere, thick_sphere
from lacore_verification.cases.shared.cavities import INNER, OUTER, on_rays
from lacore_verification.cases.shared.exact_paths import pressure, sphere
from lacore_verification.cases.shared.hardening_laws import LAWS

JOINT = 1.5  # m, the radius at which the two shells touch
_FRICTION = 0.2
_STEPS, _SAFETY = 0.036, 1.1


def build(
    n_radial: int, n_angular: int, law: str, outer: int, slave: str, steps: int, scheme: str
) -> "la.Problem":
    """Return the problem.

    Half of n_radial elements across each shell, `outer` of 8 along the outer one.
    """

    def shell(low: float, high: float, along: int) -> "la.Body":
        cells = la.meshes.quadrilaterals(
            (low, high), (0, pi / 2), n_radial // 2, along, grade_x=(low, high / low)
        )
        mesh = la.meshes.isoparametric(cells, on_rays)
        metal = la.VonMises(hardening=LAWS[law])
        return la.Body(mesh, metal, kinematics="axisymmetric", space="q2")

    along = n_angular * outer // 8
    bodies = {"inner": shell(INNER, JOINT, n_angular), "outer": shell(JOINT, OUTER, along)}
    return la.Problem(
        bodies=bodies,
        supports=[la.Fix(name, "bottom", "y") for name in bodies],
        reference_loads=[la.Pressure("inner", "left")],
    )


def path(law: str, outer: int, slave: str, steps: int, scheme: str) -> Following:
    """Return the path: the bore of the inner shell moves as that of one thick sphere."""
    sides = [("inner", "right"), ("outer", "left")]
    one, other = sides if slave == "inner" else sides[::-1]
    return replace(
        hardening_sphere.path(law, steps, scheme),
        control=la.PointTravel("inner", (INNER, 0.0), (1.0, 0.0)),
        approaching=[la.Interface(one, other, _FRICTION)],
        ladder=(),
    )


def reference(law: str, outer: int, slave: str, steps: int, scheme: str) -> Reference:
    """Return the reference: the pressure on one thick sphere at the last load."""
    return hardening_sphere.reference(law, steps, scheme)


def band(elements: int, law: str, outer: int, slave: str, steps: int, scheme: str) -> Band:
    """Return the band.

    Steps take away from the load, elements add to it: those of the coarser shell.
    """
    coarser = elements * 2 * min(outer, 8) // (8 + outer)
    mesh = thick_sphere.band(coarser, "q2").above
    return Band(
        _SAFETY * _STEPS * steps**-2 + SOLVER,
        mesh,
        f"Leapfrog steps: below by at most {_STEPS:g} steps^-2 on 4 x 8 and 8 x 16 elements, 10 to"
        f" 40 steps; allowed {_SAFETY:g} times that. Elements: above, by at most {mesh:.1g}, which"
        " the case thick-sphere allows for elements as wide as those of the coarser shell."
        " Contact adds no error.",
    )


_WHOLE = sphere(LAWS["linear-3"], INNER, OUTER)

CASE = Case(
    id="shells-in-shells",
    title="Two hardening spherical shells in contact, blown up",
    tags=("hardening", "continuum", "contact", "Coulomb", "axisymmetric", "path", "closed form"),
    unit="pressure / s0",
    explanation=__doc__,
    hand_calculation=f"""\
joint:        pressure only, q = 2 int_c^b sigma_Y dr/r > 0; no slip
volumes:      r^3 - R^3 = a^3 - A^3, in both shells
strain:       eb = 2 ln(r/R)
equilibrium:  dp/dr = 2 sigma_Y(eb)/r, p continuous at the joint
              p = 2 int_a^b sigma_Y dr/r: that of one sphere
linear-3:     a = 1: {pressure(_WHOLE, 1.0):.6f}, a = 1.5: {pressure(_WHOLE, 1.5):.6f}
""",
    meshes={
        "coarse": {"n_radial": 4, "n_angular": 8},
        "medium": {"n_radial": 8, "n_angular": 16},
        "fine": {"n_radial": 16, "n_angular": 32},
    },
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    path=path,
    variants=tuple(
        Variant(
            name,
            {"law": "linear-3", "outer": outer, "slave": slave, "steps": n, "scheme": "leapfrog"},
            meshes=("coarse",),
        )
        for name, outer, slave, n in (
            ("linear-3-matching-inner", 8, "inner", 20),
            ("linear-3-non-matching-inner", 6, "inner", 20),
            ("linear-3-non-matching-outer", 6, "outer", 20),
            ("10-steps", 6, "inner", 10),
        )
    ),
    first=First(variant="10-steps"),
)
