"""Points with pressure-dependent strength (T39, T40) with analytical solutions.

Stresses q = ||s|| and P are within ``q + a_i P <= b_i``, flow is ``||d|| <= sum lam_i`` and ``theta
= sum a_i lam_i`` at the cost ``w sum b_i lam_i``. The friction angle is that of the 3-4-5 triangle:
sin(phi) = 0.6. Duals of the rows of d and theta are the stresses s and P.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_matrix

from lacore.program.kinematic import DissipationGroup
from lacore.program.surfaces import Surfaces
from lacore_verification.conformance.worked import Worked, cones, frozen, nowhere, program

_SINE = 0.6
_WEIGHT = 0.5


def soil(
    rows: npt.ArrayLike, volumetric: npt.ArrayLike, planes: Sequence[tuple[Sequence[float], float]]
) -> DissipationGroup:
    """Return one point of weight 1/2; rows (dim, n), volumetric (L, n), planes ``(a_i, b_i)``."""
    plain = cones(
        np.asarray(rows, dtype=float)[None], [_WEIGHT], [min(strength for _, strength in planes)]
    )
    surfaces = Surfaces(
        slope=np.array([[slope for slope, _ in planes]], dtype=float),
        strength=np.array([[strength for _, strength in planes]], dtype=float),
        normed=np.ones(len(planes)),
    )
    volumes = csr_matrix(np.asarray(volumetric, dtype=float))
    return replace(plain, volumetric=volumes, volumetric_factor=0.0, surfaces=surfaces)


def mohr_coulomb() -> Worked:
    """Return one point with one surface."""
    return Worked(
        "Mohr-Coulomb",
        "q + 0.6 P <= 2, F0 = (0.6, 0.8, 1): d = lam (0.6, 0.8), theta = 0.6 lam, F0.U = 1.6 lam ="
        " 1: alpha = w 2 lam = 0.625; w (s, P) = alpha F0",
        program([soil(np.eye(2, 3), [[0, 0, 1]], [([_SINE], 2.0)])], nowhere(3), [0.6, 0.8, 1.0]),
        frozen(),
        load_factor=0.625,
        velocity=[0.375, 0.5, 0.375],
        stress=([[0.75, 1.0]],),
        mean_stress=([1.25],),
    )


def _cut_off() -> list[Worked]:
    planes = [([_SINE], 2.0), ([1.0], 2.4)]
    return [
        Worked(
            "tension cut-off",
            "q + 0.6 P <= 2 and q + P <= 2.4, F0 = (0.3, 0.4, 1.9): the second flows alone, theta ="
            " ||d|| = lam, 2.4 lam = 1: alpha = w 2.4 lam = 0.5; w (s, P) = alpha F0",
            program([soil(np.eye(2, 3), [[0, 0, 1]], planes)], nowhere(3), [0.3, 0.4, 1.9]),
            frozen(),
            load_factor=0.5,
            velocity=[0.25, 1 / 3, 5 / 12],
            stress=([[0.3, 0.4]],),
            mean_stress=([1.9],),
        ),
        Worked(
            "cone and cut-off meet",
            "one unknown, d = (0.6, 0.8) U, theta = 0.8 U: both flow by half, alpha = w (1 + 1.2) ="
            " 1.1, at the corner q = 1.4, P = 1",
            program([soil([[0.6], [0.8]], [[0.8]], planes)], nowhere(1), [1]),
            frozen(),
            load_factor=1.1,
            velocity=[1],
            stress=([[0.84, 1.12]],),
            mean_stress=([1.0],),
        ),
    ]


def _around() -> Worked:
    """Return two volumetric rates (of the sum, of the third direction) with stresses P, t - P."""
    return Worked(
        "Mohr-Coulomb around an axis",
        "b = 2.2, the third stress t is the least: of three planes q + P - t/4 <= 2.75 flows alone,"
        " (theta, eps_tt) = (0.75, -0.25) lam; F0 = (0.6, 0.8, 1.5, -2.5), 2.75 lam = 1: alpha ="
        " w 2.75 lam = 0.5, q = 1, P = 1.5, t = -1",
        program(
            [
                soil(
                    np.eye(2, 4),
                    np.eye(2, 4, 2),
                    [([_SINE, 0.0], 2.2), ([0.75, -0.25], 2.75), ([3.0, 4.0], 11.0)],
                )
            ],
            nowhere(4),
            [0.6, 0.8, 1.5, -2.5],
        ),
        frozen(),
        load_factor=0.5,
        velocity=np.array([0.6, 0.8, 0.75, -0.25]) / 2.75,
        stress=([[0.6, 0.8]],),
        mean_stress=([1.5, -2.5],),
    )


def _hardens() -> Worked:
    """Return the program of `mohr_coulomb` with the choice of velocities along paths (T32)."""
    plain = mohr_coulomb().program
    (group,) = plain.groups
    return Worked(
        "Mohr-Coulomb that hardens",
        "'Mohr-Coulomb', lam = 0.625: q + 0.6 P <= 2 + 1.6 lam = 3, alpha = w 3 lam = 0.9375",
        replace(plain, groups=(replace(group, modulus=np.array([1.6])),)),
        frozen(),
        load_factor=0.9375,
        velocity=[0.375, 0.5, 0.375],
        stress=([[1.125, 1.5]],),
        mean_stress=([1.875],),
        unsoftened="next to surfaces a modulus chooses, as viscosity does already",
    )


SOIL = (mohr_coulomb(), *_cut_off(), _around(), _hardens())
