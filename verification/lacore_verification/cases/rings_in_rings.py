r"""A tube shrunk into another one without friction is blown up: the two are one thick tube.

      r = 1        r = 1.5        r = 2
        +------------++------------+  u_z = 0
    p ->|   inner    ||   outer    |
    p ->|            ||            |  free
        +------------++------------+  u_z = 0
        |               smooth contact   z
        |--> bore: a from 1 to 1.5       |__ r

A slice of the axisymmetric bodies (r, z), without axial motion; each has its own mesh, and contact
carries the pressure between them. It is never in tension, so the two tubes stay together, and no
shear acts there in the whole tube either: the closed form is that of one thick tube, also where
the elements of the two do not match, and whichever of the two is the slave.

As both tubes flow, the pressure between them is that which the outer one carries alone. Below the
limit pressure it is not determined: both tubes carry different pressures at the joint. The friction
there, and the force that would pull one tube out of the other, are not determined either.
"""

from dataclasses import replace

import lacore as la
from lacore_verification.case import Band, Case, First, Reference, Variant
from lacore_verification.case.following import Following
from lacore_verification.cases import hardening_cylinder
from lacore_verification.cases.hardening_cylinder import HEIGHT, INNER, OUTER
from lacore_verification.cases.shared.exact_paths import cylinder, pressure
from lacore_verification.cases.shared.hardening_laws import LAWS

JOINT = 1.5  # m, the radius at which the two tubes touch


def build(n: int, law: str, rows: int, slave: str, steps: int, scheme: str) -> "la.Problem":
    """Return the problem.

    Half of n columns for each tube; the outer one has its own number of rows.
    """

    def tube(inner: float, outer: float, ny: int) -> "la.Body":
        mesh = la.meshes.quadrilaterals(
            (inner, outer), (0, HEIGHT), n // 2, ny, grade_x=(inner, outer / inner)
        )
        metal = la.VonMises(hardening=LAWS[law])
        return la.Body(mesh, metal, kinematics="axisymmetric", space="q2")

    bodies = {"inner": tube(INNER, JOINT, 1), "outer": tube(JOINT, OUTER, rows)}
    sides = [("inner", "right"), ("outer", "left")]
    one, other = sides if slave == "inner" else sides[::-1]
    return la.Problem(
        bodies=bodies,
        supports=[la.Fix(name, side, "y") for name in bodies for side in ("bottom", "top")],
        interfaces=[la.Interface(one, other, la.SMOOTH)],
        reference_loads=[la.Pressure("inner", "left")],
    )


def path(law: str, rows: int, slave: str, steps: int, scheme: str) -> Following:
    """Return the path: the bore of the inner tube moves as that of one thick tube."""
    bore = la.PointTravel("inner", (INNER, 0.0), (1.0, 0.0))
    return replace(hardening_cylinder.path(law, steps, scheme), control=bore, ladder=())


def reference(law: str, rows: int, slave: str, steps: int, scheme: str) -> Reference:
    """Return the reference: the pressure on one thick tube at the last load."""
    return hardening_cylinder.reference(law, steps, scheme)


def band(elements: int, law: str, rows: int, slave: str, steps: int, scheme: str) -> Band:
    """Return the band: that of one tube of as many columns: contact adds nothing."""
    columns = 2 * elements // (1 + rows)
    whole = hardening_cylinder.band(columns, law, steps, scheme)
    return Band(
        whole.below,
        whole.above,
        "That of the case hardening-cylinder with as many columns of elements. Contact adds no"
        f" error: {whole.reason}",
    )


CASE = Case(
    id="rings-in-rings",
    title="Two hardening tubes in contact, blown up",
    tags=("hardening", "continuum", "contact", "axisymmetric", "path", "closed form"),
    unit="pressure / s0",
    explanation=__doc__,
    hand_calculation=f"""\
joint:        pressure only, q = (2/sqrt3) int_c^b sigma_Y dr/r > 0
volumes:      r^2 - R^2 = a^2 - A^2       (u_z = 0), in both tubes
strain:       eb = (2/sqrt3) ln(r/R)
equilibrium:  dp/dr = (2/sqrt3) sigma_Y(eb)/r, p continuous at the joint
              p = (2/sqrt3) int_a^b sigma_Y dr/r: that of one tube
linear-3:     a = 1: {pressure(cylinder(LAWS["linear-3"], INNER, OUTER), 1.0):.6f}
              a = 1.5: {pressure(cylinder(LAWS["linear-3"], INNER, OUTER), 1.5):.6f}
""",
    meshes={"coarse": {"n": 8}, "medium": {"n": 16}, "fine": {"n": 32}},
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    path=path,
    variants=(
        *(
            Variant(
                f"{law}-{'matching' if rows == 1 else 'non-matching'}-{slave}",
                {"law": law, "rows": rows, "slave": slave, "steps": 20, "scheme": "leapfrog"},
                meshes=("coarse",),
            )
            for law, rows, slave in (
                ("linear-3", 1, "inner"),
                ("linear-3", 2, "inner"),
                ("linear-3", 2, "outer"),
                ("voce", 2, "inner"),
            )
        ),
        Variant(
            "5-steps",
            {"law": "linear-3", "rows": 2, "slave": "inner", "steps": 5, "scheme": "leapfrog"},
            meshes=("coarse",),
        ),
    ),
    first=First(variant="5-steps"),
)
