r"""A wedge cuts on into a notch, to several times its depth, on meshes along its slip lines.

            |      /
         o  |     /  wedge, half angle beta, moves down
         o  |    /        _
         o  |   /  fan _ -  \  lip
    -----o..|../. _ -- .....\----------------------- first surface
            |  |//| \      /  right half,
      cut o |  /..|..\.- '    width 6, depth 4
    u_x=0o  |   slip line
         o--------------------------------------- u = 0

The body begins with the notch and the lip that the wedge leaves at a quarter of the last depth. It
gets a new mesh before each step: rays from the end of the contact, and rows along the line on which
the velocity jumps. Below the tip the section of symmetry is cut over the travel of a step, and both
sides of the cut are pressed together. A path begins at a depth of at least six steps: the elements
are as small as the depth, and a step that is longer in comparison inverts those at the tip or at
the foot of the lip. The material separates at the tip, as it does in the exact
solution, and the vertex at the tip moves along the face. The face of the wedge is a plane here,
since the other half of the body has the other face. New meshes keep the area: the edge at the end
of the contact is divided into a part of the face and a straight edge. Since the velocity jumps at
the foot of the lip, each step leaves a wall there, to which the flow would be drawn in the next
steps; a new mesh straightens the last part of the lip. With friction the force is larger, at most
that of a wedge to which the material sticks. Much friction keeps the cut closed: material at the
tip moves with the wedge.
"""

from math import cos, nan, radians, sin

import numpy as np

import lacore as la
from lacore.numerics.arrays import Floats
from lacore_verification.case import SOLVER, Band, Case, Reference, Variant
from lacore_verification.case.following import Following, Reading, last_load
from lacore_verification.cases.shared.wedge_fans import Fan
from lacore_verification.cases.shared.wedge_meshes import Hill, lip_error

START, TRAVEL = 0.25, 0.75  # depth of the notch, and how much deeper the wedge moves
_QUALITY = 0.99  # any distortion calls for a new mesh
# Relative error of the force: velocities turn across a row around the end of the contact.
_TURN = 0.005
_STICKS = {45.0: 1.6}  # more than the ratio of the forces of a wedge that sticks and a smooth one
_VOLUME = 0.064  # largest change of volume in a step, times steps^3: the scheme is of order 2


def build(half_angle: float, friction: float, cells: int, steps: int, scheme: str) -> la.Problem:
    """Return the problem: the right half with the notch and its lip."""
    mesh = _fan(half_angle, cells, steps).first(START)
    return la.Problem(
        bodies={"body": la.Body(mesh, la.VonMises(shear_strength=1.0), space="p2-gauss")},
        supports=[
            la.Fix("body", "left", "x"),
            la.Fix("body", "right", "x"),
            la.Fix("body", "bottom"),
        ],
        interfaces=[
            la.Interface(("body", "cut"), la.RigidObstacle((0.0, 0.0), (1.0, 0.0)), friction=0.0)
        ],
        reference_loads=[la.PointForce("body", (0.0, -START), (0.0, -1.0))],
    )


def path(half_angle: float, friction: float, cells: int, steps: int, scheme: str) -> Following:
    """Return the path: until the wedge is four times as deep as the notch."""
    beta = radians(half_angle)
    face = la.shapes.plane((0.0, -START), (cos(beta), -sin(beta)))
    return Following(
        TRAVEL,
        steps,
        scheme,
        la.ToolTravel({"wedge": (0.0, -1.0)}),
        exact=(lambda travel: _force(half_angle, travel)) if friction == 0 else None,
        load="force",
        # On these meshes the velocity becomes one of many, so that paths end as DRIFTED. Force, lip
        # and volume are compared with Hill's values.
        ending=None,
        volume=_VOLUME / steps**3,
        reading=_lip(half_angle, steps) if friction == 0 else _ratio(half_angle),
        tools={"wedge": la.Tool(face, ("body", "top"), (0, -1), friction=friction)},
        remesh=la.Remeshing(quality=_QUALITY, mesher=_fan(half_angle, cells, steps)),
    )


def _lip(half_angle: float, steps: int) -> Reading:
    return Reading(
        "largest distance of the lip from the exact one, of the depth,",
        lambda path: lip_error(path, half_angle),
        0.0,
        # A step lifts the material by sin(beta) of its length, up to a vertex of the old lip.
        2 * sin(radians(half_angle)) * TRAVEL / steps / (START + TRAVEL),
    )


def _ratio(half_angle: float) -> Reading:
    """Return the ratio between a smooth wedge and one to which the material sticks."""
    return Reading(
        "largest force per depth over the whole travel, of that of the smooth wedge,",
        lambda path: _largest(path) / (Hill(half_angle).force / 2),
        1.0,
        _STICKS[half_angle],
    )


def _largest(path: la.Path) -> float:
    """Return the force per depth; NaN if the path ends early."""
    covered = float(path.history["end"].iloc[-1]) >= TRAVEL * (1 - SOLVER)
    return float(per_depth(path).max()) if covered else nan


def per_depth(path: la.Path) -> Floats:
    """Return the forces of all steps, N/m per m."""
    return np.asarray(path.history["force"] / (START + path.history["travel"]))


def _fan(half_angle: float, cells: int, steps: int) -> Fan:
    return Fan(half_angle, cells, TRAVEL / steps)


def _force(half_angle: float, travel: float) -> float:
    """Return the exact force on the half per k; judged over the second half of the travel."""
    return nan if travel < TRAVEL / 2 else Hill(half_angle).force / 2 * (START + travel)


def reference(half_angle: float, friction: float, cells: int, steps: int, scheme: str) -> Reference:
    """Return the reference: exact without friction."""
    if friction > 0:
        return Reference(
            nan,
            "not known; more than without friction, less than if the material sticks",
            "limit theorems: sticking dissipates no less than friction",
            "none",
            complete=False,
        )
    return Reference(
        _force(half_angle, last_load(TRAVEL, steps, scheme)),
        "p h sin(beta), p = 2k (1 + theta), h = c/(cos(beta) - sin(beta - theta))",
        "Hill, Lee & Tupper, Proc. R. Soc. A 188 (1947) 273",
        "exact",
    )


def band(
    elements: int, half_angle: float, friction: float, cells: int, steps: int, scheme: str
) -> Band:
    """Return the band: of half a step of the depth at half of the travel, without friction."""
    if friction > 0:
        return Band(0.0, 0.0, "The load at the end is not known.")
    allowed = TRAVEL / steps / 2 / (START + TRAVEL / 2) + _TURN
    return Band(
        allowed,
        allowed,
        "Largest error over the second half of the path: in the middle of a step the material is"
        " separated half a step below the tip; velocities change their direction within a row of"
        " triangles.",
    )


CASE = Case(
    id="wedge-notch",
    title="Wedge pressed into a notch, on meshes along its slip lines",
    tags=("continuum", "contact", "path", "closed form", "singular point", "Coulomb"),
    unit="force on the half / (k m)",
    explanation=__doc__,
    hand_calculation=f"""\
fan angle:  cos(2 beta - theta) = cos(theta)/(1 + sin(theta))
pressure:   p = 2k (1 + theta)
contact:    h = c/(cos(beta) - sin(beta - theta)), length of the lip
force:      F = 2 p h sin(beta) on the whole wedge
beta = 15:  F = {Hill(15).force:.6f} k c
beta = 30:  F = {Hill(30).force:.6f} k c
beta = 45:  F = {Hill(45).force:.6f} k c
""",
    meshes={"fine": {}},
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    path=path,
    variants=tuple(
        Variant(
            f"smooth-{angle:g}" if friction == 0 else f"mu-{friction:g}-{angle:g}",
            {
                "half_angle": angle,
                "friction": friction,
                "cells": 4,
                "steps": 40,
                "scheme": "leapfrog",
            },
            unfit={"regularised": "penalised contact lets the tip sink into the first cells"},
        )
        for friction, angles in ((0.0, (15.0, 30.0, 45.0)), (0.1, (45.0,)), (0.3, (45.0,)))
        for angle in angles
    ),
    on_demand=True,
)
