r"""A thick hollow sphere, radii a = 1 and b = 2, bursts under internal pressure: tetrahedra.

        z
        |
        | - _
        |     ` .        an eighth of it, three planes of symmetry
        |         `.
        | - _       `
        |     ` .    \    a = 1, b = 2
        | alpha  `.   \
        |  -->     \   |
        |           |  |
        +-----------o--o---- x

Flat faces stand for its surfaces: their bore is wider, its skin nearer than those of the sphere,
and no value bounds that of the sphere.
"""

import lacore as la
from lacore_verification.case import Band, Case, Convergence, First, Reference, Variant
from lacore_verification.cases.shared.cavities import INNER, OUTER, SPHERE, SPHERE_BURSTS
from lacore_verification.cases.shared.tetrahedra import hollow_octant

_ERROR = Convergence(
    0.887, 0.714, "24, 81, 192, 540 tetrahedra: 9.18, 3.79, 2.12, 0.995 %, all above"
)


def build(across: int, through: int) -> "la.Problem":
    """Return the problem: an eighth; yield stress 1, so the load factor is in units of s0."""
    mesh = hollow_octant(INNER, OUTER, across, through)
    sphere = la.Body(mesh, la.VonMises(yield_stress=1.0), kinematics="3d")
    return la.Problem(
        bodies={"sphere": sphere},
        supports=[la.Fix("sphere", axis, "normal") for axis in "xyz"],
        reference_loads=[la.Pressure("sphere", "start")],
    )


def reference() -> Reference:
    """Return the reference: the fully plastic sphere."""
    return SPHERE


def band(elements: int) -> Band:
    """Return the band: of second order in the size of flat faces and of elements alike."""
    return _ERROR.two_sided(elements, "flat faces in place of two spheres.")


CASE = Case(
    id="thick-sphere-solid",
    title="Thick hollow sphere of tetrahedra",
    tags=("continuum", "space", "curved boundary", "closed form"),
    unit="pressure / s0",
    explanation=__doc__,
    hand_calculation=SPHERE_BURSTS,
    meshes={
        "coarse": {"across": 2, "through": 2},
        "moderate": {"across": 3, "through": 3},
        "medium": {"across": 6, "through": 5},
        "fine": {"across": 8, "through": 7},
    },
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    first=First(meshes=("moderate",)),
    variants=(Variant("burst", {}, meshes=("coarse",)),),
)
