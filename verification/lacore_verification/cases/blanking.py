r"""A sheet is sheared between a punch that moves and a die at rest.

                 punch, moves down        blank holder, at rest
               |/////////////////|     |//////////////////////////|
    u_x = 0   o+-----------------+-----+--------------------------+o
   (symmetry) o|                  .   .                           |o  u_x = 0
              o|     sheet         . .                            |o  t = 1 thick
              o+-----------------+-----+--------------------------+o
                                       |//////////////////////////|
                                       die, at rest
                                 |<- 0.1 ->|  clearance

The punch, the die and the holder are tools. Rigid blocks of their shapes stand for them in the
bounds of the load with which the path begins. If the sheet in the clearance shears between vertical
lines, it dissipates k t per travel, and no point slips on a tool. So the force on an edge is at
most k t, with and without friction, and that is the load without clearance. As the sheet is cut,
shear across the remaining thickness would take k (t - stroke). Elements that stay together spread
the shear over the clearance and do not find this mechanism: the path covers a twentieth of the
thickness.
"""

import numpy as np
from skfem import MeshQuad

import lacore as la
from lacore.numerics.arrays import Ints
from lacore_verification.case import SOLVER, Band, Case, Reference, Variant
from lacore_verification.case.following import Following, Reading
from lacore_verification.cases.shared.hardening_laws import LAWS

THICK, PUNCH, WIDTH, TRAVEL = 1.0, 1.0, 2.1, 0.05  # m: of sheet and punch, to the far end
CLEARANCE = 0.1  # m
_STRENGTH = float(LAWS["perfect"].stress(np.zeros(1))[0] / np.sqrt(3))  # k
_HIGH = 0.5  # m, of the tools
_BELOW = 0.02


def _tool(left: float, right: float, low: float) -> "list[tuple[float, float]]":
    high = low + _HIGH
    return [(left, low), (right, low), (right, high), (left, high)]


_TOOLS = {  # outline, and the side of the sheet that it touches
    "punch": (_tool(-PUNCH, PUNCH, THICK), "under punch"),
    "holder": (_tool(PUNCH + CLEARANCE, 2 * WIDTH, THICK), "held"),
    "die": (_tool(PUNCH + CLEARANCE, 2 * WIDTH, -_HIGH), "on die"),
}
_MOTION = (0.0, -1.0)  # of the punch, m per m of travel


def build(nx: int, ny: int, mu: float, steps: int, scheme: str) -> "la.Problem":
    """Return the problem.

    Half of the sheet; nx columns under the punch and on the die, one in the clearance.
    """
    edge = PUNCH + CLEARANCE
    columns = np.unique(np.r_[np.linspace(0, PUNCH, nx + 1), np.linspace(edge, WIDTH, nx + 1)])
    cells = MeshQuad.init_tensor(columns, np.linspace(0, THICK, ny + 1))
    mesh = cells.to_meshtri(style="x")

    def along(height: float, low: float, high: float) -> Ints:
        x, y = mesh.p[:, mesh.facets].mean(axis=1)
        found = (np.abs(y - height) < SOLVER) & (x > low) & (x < high)
        return np.asarray(np.flatnonzero(found))

    def end(place: float) -> Ints:
        x = mesh.p[0, mesh.facets].mean(axis=0)
        return np.asarray(np.flatnonzero(np.abs(x - place) < SOLVER))

    sheet = mesh.with_boundaries(
        {
            "left": end(0.0),
            "right": end(WIDTH),
            "under punch": along(THICK, 0, PUNCH),
            "held": along(THICK, edge, WIDTH),
            "on die": along(0.0, edge, WIDTH),
        }
    )
    return la.Problem(
        bodies={
            "sheet": la.Body(sheet, la.VonMises(hardening=LAWS["perfect"]), space="p2-gauss"),
            **{name: la.RigidBlock(shape) for name, (shape, _) in _TOOLS.items()},
        },
        supports=[
            la.Fix("sheet", "left", "x"),
            la.Fix("sheet", "right", "x"),
            la.Fix("punch", "block", "x"),  # nor does it turn
            la.Fix("holder", "block"),
            la.Fix("die", "block"),
        ],
        interfaces=[
            la.Interface(("sheet", side), (tool, "block"), mu) for tool, (_, side) in _TOOLS.items()
        ],
        reference_loads=[la.PointForce("punch", "block", _MOTION)],
    )


def largest(path: "la.Path") -> float:
    """Return the largest of the forces on the way, over k t."""
    return float(path.history["force"].max()) / (_STRENGTH * THICK)


def path(mu: float, steps: int, scheme: str) -> Following:
    """Return the path: the punch moves down by a twentieth of the thickness."""
    return Following(
        TRAVEL,
        steps,
        scheme,
        la.ToolTravel({"punch": _MOTION}),
        load="force",
        volume=SOLVER,
        reading=Reading("largest force over k t", largest, 1 - _BELOW, 1 + SOLVER),
        tools={
            name: la.Tool(
                la.shapes.outline(shape),
                ("sheet", side),
                _MOTION if name == "punch" else (0.0, 0.0),
                friction=mu,
            )
            for name, (shape, side) in _TOOLS.items()
        },
        bounded=True,
    )


def reference(mu: float, steps: int, scheme: str) -> Reference:
    """Return the reference: shear between vertical lines."""
    return Reference(
        _STRENGTH * THICK,
        "k t, exact for zero clearance",
        "analytical: shear between vertical lines, an upper bound; exact without clearance",
        "exact",
    )


def band(elements: int, mu: float, steps: int, scheme: str) -> Band:
    """Return the band.

    From above strict at the beginning; from below what the clearance takes away.
    """
    return Band(
        _BELOW,
        SOLVER,
        f"k t bounds the load from above. A clearance of {CLEARANCE:g} t lets the sheet bend as it"
        f" shears: measured 0.37 to 1.5 % below on 60 to 416 elements, allowed {_BELOW:g}.",
    )


CASE = Case(
    id="blanking",
    title="Sheet sheared between punch and die",
    tags=("continuum", "blocks", "contact", "Coulomb", "path", "upper bound"),
    unit="force on an edge / (1 m s0)",
    explanation=__doc__,
    hand_calculation=f"""\
velocity:  v_y from v at the punch to 0 at the die, linear
           across the clearance c; no slip on the tools
power:     F v = k (v/c) c t = k t v
so         F <= k t = s0 t/sqrt3 = {_STRENGTH * THICK:.6f}
c -> 0:    the shear stress in the cut is at most k: F = k t
""",
    meshes={
        "coarse": {"nx": 2, "ny": 3},
        "medium": {"nx": 4, "ny": 4},
        "fine": {"nx": 6, "ny": 8},
    },
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    path=path,
    variants=tuple(
        Variant(
            f"mu-{mu:g}",
            {"mu": mu, "steps": 4, "scheme": "implicit-midpoint"},
            meshes=("coarse",),
        )
        for mu in (0.0, 0.3)
    ),
)
