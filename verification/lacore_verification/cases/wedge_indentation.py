r"""A smooth wedge is pressed into a half space, from the first touch on: a tool of exact shape.

            |      /
         o  |     /  wedge, half angle beta, moves down
         o  |    /        _
         o  |   /     _ -  \  lip
    -----o..|../. _ -- .....\----------------------- first surface
         o  | / contact h     |
    u_x=0o  |/                |   right half,
         o                    |   width 6, depth 4
         o--------------------------------------- u = 0

The flow is similar at every depth c of the tip, so the force is proportional to c, and the lip is
straight. Material is drawn along the face, and elements next to the tip would soon be inverted: the
body gets new meshes on the way, in columns below its surface, which keep its area but for the edge
at the end of the contact. The length of the contact is known to an element. With friction the force
is larger, at most that of a wedge to which the material sticks.
"""

from math import nan

import lacore as la
from lacore_verification.case import Band, Case, First, Reference, Variant
from lacore_verification.case.following import Following, Reading, last_load
from lacore_verification.cases.shared.wedge_meshes import Columns, Hill, lip_error

TRAVEL = 1.0
_CELL = 3.0  # smallest cell, in steps: a step moves no vertex past a cell
_LIP = 0.1  # largest distance of the lip from the exact one, per depth: half of a cell at its end
_ROUGH = 1.5  # largest force on the way of a wedge that sticks, per that of a smooth one
_VOLUME = 0.12  # a step, times steps^2: a new mesh straightens the edge at the end of the contact
_CELLS = 0.45  # largest relative error of the force times the number of cells along the face


def build(
    start: float, half_angle: float, friction: float, cells: int, steps: int, scheme: str
) -> "la.Problem":
    """Return the problem.

    The right half before it is touched, with cells of `start` steps where it will be.
    """
    mesh = Columns(half_angle, cells, start * TRAVEL / steps).first()
    return la.Problem(
        bodies={"body": la.Body(mesh, la.VonMises(shear_strength=1.0), space="q2")},
        supports=[
            la.Fix("body", "left", "x"),
            la.Fix("body", "right", "x"),
            la.Fix("body", "bottom"),
        ],
        reference_loads=[la.PointForce("body", (0.0, 0.0), (0.0, -1.0))],
    )


def path(half_angle: float, friction: float, cells: int, steps: int, scheme: str) -> Following:
    """Return the path: as deep as a sixth of the width of the half."""
    wedge = la.shapes.wedge((0.0, 0.0), half_angle)
    smooth = friction == 0
    return Following(
        TRAVEL,
        steps,
        scheme,
        la.ToolTravel({"wedge": (0.0, -1.0)}),
        exact=(lambda travel: _force(half_angle, travel)) if smooth else None,
        load="force",
        volume=_VOLUME / steps**2,
        reading=_lip(half_angle) if smooth else _ratio(half_angle),
        tools={"wedge": la.Tool(wedge, ("body", "top"), (0, -1), friction=friction)},
        remesh=Columns(half_angle, cells, _CELL * TRAVEL / steps),
    )


def _force(half_angle: float, travel: float) -> float:
    """Return the exact force on the half per k.

    Not judged before half of the travel, where cells are few.
    """
    return nan if travel < TRAVEL / 2 else Hill(half_angle).force / 2 * travel


def _lip(half_angle: float) -> Reading:
    return Reading(
        "largest distance of the lip from the exact one, of the depth,",
        lambda path: lip_error(path, half_angle),
        0.0,
        _LIP,
    )


def _ratio(half_angle: float) -> Reading:
    return Reading(
        "last force, of that of the smooth wedge,",
        lambda path: _last(path) / (Hill(half_angle).force / 2),
        1.0,
        _ROUGH,
    )


def _last(path: "la.Path") -> float:
    last = path.history.iloc[-1]
    return float(last["force"] / last["travel"])


def reference(half_angle: float, friction: float, cells: int, steps: int, scheme: str) -> Reference:
    """Return the reference: exact without friction."""
    if friction == 0:
        return Reference(
            _force(half_angle, last_load(TRAVEL, steps, scheme)),
            "p h sin(beta), p = 2k (1 + theta), h = c/(cos(beta) - sin(beta - theta))",
            "Hill, Lee & Tupper, Proc. R. Soc. A 188 (1947) 273",
            "exact",
        )
    return Reference(
        nan,
        "not known; more than without friction, less than if the material sticks",
        "limit theorems: sticking dissipates no less than friction",
        "none",
        complete=False,
    )


def band(
    elements: int, half_angle: float, friction: float, cells: int, steps: int, scheme: str
) -> Band:
    """Return the band: errors of the cells, without friction."""
    if friction > 0:
        return Band(0.0, 0.0, "The load at the end is not known.")
    allowed = _CELLS / cells
    return Band(
        allowed / 2,
        allowed,
        "Largest error over the second half of the path: flow that jumps along lines spreads over a"
        " cell, from above; the contact ends at a vertex, up to a cell too early, from below.",
    )


_SMOOTH = Hill(45).force

CASE = Case(
    id="wedge-indentation",
    title="Wedge pressed into a half space from the first touch on",
    tags=("continuum", "contact", "path", "closed form", "singular point", "Coulomb"),
    unit="force on the half / (k m)",
    explanation=__doc__,
    hand_calculation=f"""\
fan angle:  cos(2 beta - theta) = cos(theta)/(1 + sin(theta))
pressure:   p = 2k (1 + theta)
contact:    h = c/(cos(beta) - sin(beta - theta)), length of the lip
force:      F = 2 p h sin(beta) on the whole wedge
beta = 30:  F = {Hill(30).force:.6f} k c
beta = 45:  F = {_SMOOTH:.6f} k c
""",
    meshes={"coarse": {"start": _CELL}, "medium": {"start": 2.0}, "fine": {"start": 1.5}},
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    path=path,
    variants=tuple(
        Variant(
            name,
            {
                "half_angle": angle,
                "friction": friction,
                "cells": 6,
                "steps": steps,
                "scheme": "leapfrog",
            },
            meshes=("coarse",),
            unfit={"regularised": "penalised contact lets the tip sink into the first cells"},
        )
        for name, angle, friction, steps in (
            ("smooth-45", 45.0, 0.0, 20),
            ("smooth-30", 30.0, 0.0, 20),
            ("mu-0.1-45", 45.0, 0.1, 20),
            ("mu-0.3-45", 45.0, 0.3, 20),
            ("10-steps", 45.0, 0.0, 10),
        )
    ),
    first=First(variant="10-steps"),
)
