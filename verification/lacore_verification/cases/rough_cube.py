r"""A cube is pressed between two rough rigid platens.

               alpha (mean pressure)
            +-----------------------+   platen, rough
           /|                      /|
          / |        free sides   / |
         +-----------------------+  |
         |  |                    |  |   b = 1
         |  + - - - - - - - - - -|- +
         | /                     | /
         +-----------------------+      platen, rough

An eighth of the upper half is modelled, y <= x and z >= 0 from its centre: three planes of
symmetry. Platens hold the material at their faces, so that it carries more than between smooth
ones. No closed form is known: the reference is an interval of two strict bounds.
"""

import lacore as la
from lacore_verification.case import Band, Case, Convergence, First, Reference, Variant
from lacore_verification.case.band import Bracketing
from lacore_verification.cases.shared.tetrahedra import bounded, eighth, on_diagonal

LOW, HIGH = 1.0401, 1.0517
_ERRORS = {
    "p2-vertex": Convergence(0.272, 0.509, "24, 81, 192 tetrahedra: 5.43, 2.88, 1.88 % above"),
    "p2-disc": Convergence(0.121, 0.467, "24, 81, 192 tetrahedra: 2.75, 1.58, 1.04 % above"),
}


def build(n: int, space: str) -> "la.Problem":
    """Return the problem: a sixteenth of a unit cube; yield stress 1."""
    mesh = eighth(la.meshes.box((0, 0.5), (0, 0.5), (0, 0.5), n, n, n))
    cube = la.Body(mesh, la.VonMises(yield_stress=1.0), kinematics="3d", space=space)
    return la.Problem(
        bodies={"cube": cube},
        supports=[la.Fix("cube", where, "normal") for where in ("front", "bottom", on_diagonal)],
        reference_loads=[la.RigidFooting("cube", "top", (0, 0, -1))],
    )


def reference(space: str) -> Reference:
    """Return the reference: the interval of strict bounds."""
    return bounded(
        LOW,
        HIGH,
        "s0",
        "strict bounds of our own: below on 928 tetrahedra that were adapted, above on 1296",
    )


def band(elements: int, space: str) -> Band:
    """Return the band: strict; errors are those from the middle of the interval."""
    return _ERRORS[space].strict(elements)


CASE = Case(
    id="rough-cube",
    title="Cube between rough platens",
    tags=("continuum", "space", "upper bound"),
    unit="mean pressure / s0",
    explanation=__doc__,
    hand_calculation="""\
below:   uniform compression, alpha >= s0
bounds:  1.0401 s0 on 928 tetrahedra, 1.0517 s0 on 1296
""",
    meshes={"coarse": {"n": 2}, "medium": {"n": 4}, "fine": {"n": 6}},
    build=build,
    reference=reference,
    band=band,
    bracket=Bracketing(target_width=0.1),
    first=First(variant="p2-disc"),
    variants=tuple(
        Variant(space, {"space": space}, meshes=("coarse",)) for space in ("p2-vertex", "p2-disc")
    ),
)
