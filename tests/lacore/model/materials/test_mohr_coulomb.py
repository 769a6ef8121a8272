"""Criteria of soil, rock and masonry: what they refuse, what they say of themselves."""

import re
from math import inf, pi, radians, sqrt

import numpy as np
import pytest

import lacore as la
from lacore.model.materials.conic_form import PLANE

WRONG = {
    "negative cohesion": (lambda: la.MohrCoulomb(-1.0, 30), "cohesion", "give a strength >= 0"),
    "no number": (lambda: la.MohrCoulomb(np.nan, 30), "cohesion", "give a strength >= 0"),
    "an angle of 90": (lambda: la.MohrCoulomb(1.0, 90), "friction_angle", "give degrees"),
    "a negative angle": (lambda: la.MohrCoulomb(1.0, -5), "friction_angle", "give degrees"),
    "an angle without a number": (lambda: la.MohrCoulomb(1.0, np.nan), "friction_angle", "degrees"),
    "all but level": (lambda: la.MohrCoulomb(1.0, 0.05), "friction_angle", "take 0"),
    "radians": (lambda: la.MohrCoulomb(1.0, pi / 6), "friction_angle", "give degrees: 30"),
    "rounded radians": (lambda: la.MohrCoulomb(1.0, 0.6109), "friction_angle", "degrees: 35"),
    "radians of three digits": (
        lambda: la.MohrCoulomb(1.0, 0.524),
        "friction_angle",
        "give degrees: 30",
    ),
    "nothing at all": (lambda: la.MohrCoulomb(0.0, 0.0), "cohesion", "give a cohesion > 0"),
    "beyond the apex": (
        lambda: la.MohrCoulomb(1.0, 45, tension_cutoff=1.01),
        "tension_cutoff",
        "give at most 1",
    ),
    "a tension that is none": (
        lambda: la.MohrCoulomb(1.0, 30, tension_cutoff=-0.1),
        "tension_cutoff",
        ">= 0",
    ),
    "crushed by nothing": (lambda: la.MohrCoulomb(1.0, 30, crushing=0.0), "crushing", "> 0"),
    "no shear": (lambda: la.MaximumShear(0.0), "MaximumShear.shear_strength", "> 0"),
    "a cone of nothing": (lambda: la.DruckerPrager(0.0, 0.0), "cohesion", "give a cohesion > 0"),
    "an unknown match": (lambda: la.DruckerPrager(1.0, 30, "tension"), "match", "extension"),
    "a sheet without an end": (
        lambda: la.DruckerPrager(1.0, 60, "compression").conic_form("plane_stress"),
        "friction_angle",
        "give a smaller angle",
    ),
    "masonry without strength": (lambda: la.NoTension(0.0), "compressive_strength", "> 0"),
    "tension of Rankine": (lambda: la.Rankine(-1.0), "Rankine.tensile_strength", ">= 0"),
}


@pytest.mark.parametrize("made, field, fix", WRONG.values(), ids=WRONG)  # noqa: PT006
def test_what_is_refused(made, field, fix):
    with pytest.raises(la.InputError) as error:
        made()
    assert field in str(error.value)
    assert fix in str(error.value)


@pytest.mark.parametrize("angle", [0, 0.1, 0.14, 0.5, 1, 1.1, 1.5, 30, 89])
def test_angles_that_are_degrees(angle):
    assert la.MohrCoulomb(1.0, angle).angle == radians(angle)


@pytest.mark.parametrize(
    "made",
    [
        lambda most: la.MohrCoulomb(1.0, 20, tension_cutoff=most),  # apex 2.7474774
        lambda most: la.MohrCoulomb(1.0, 26.56505118, dilation_angle=most),
        lambda most: la.Coulomb(0.3, adhesion=0.2, tension=most),  # 2/3
    ],
)
def test_what_may_be_given_at_most_is_taken(made):
    """A limit that is told in six digits is not rounded up: it would be refused once more."""
    with pytest.raises(la.InputError) as error:
        made(29.0)
    made(float(re.search(r"give at most (\S+?)(?: Pa)?, or", error.value.fix)[1]))


def test_the_apex():
    assert la.MohrCoulomb(1.0, 45).apex == pytest.approx(1.0)
    assert la.MohrCoulomb(1.0, 0).apex == inf
    la.MohrCoulomb(1.0, 0, tension_cutoff=100.0)  # no apex to be beyond


def test_what_they_say():
    assert (
        la.MohrCoulomb(5e3, 20, crushing=1e6).label
        == "c = 5000 Pa, φ = 20°, compression ≤ 1e+06 Pa"
    )
    assert la.DruckerPrager(1.0, 30).label == "c = 1 Pa, φ = 30°, matched in plane strain"
    assert la.NoTension().label == "no tension"
    assert la.Rankine(1.0).label == "tension ≤ 1 Pa"
    assert la.MaximumShear(2.0).label == "largest shear 2 Pa"


def test_no_friction_in_plane_strain_is_von_mises():
    """The same cone, with volume kept: nothing of a solve differs."""
    cone = la.VonMises(shear_strength=2.0).conic_form("plane_strain")
    for criterion in (la.MaximumShear(2.0), la.MohrCoulomb(2.0, 0)):
        form = criterion.conic_form("plane_strain")
        assert form.surfaces == ()
        assert form.bound == cone.bound
        assert (form.rows == cone.rows).all()


@pytest.mark.parametrize("kinematics", PLANE)
def test_stresses_come_back(kinematics):
    """Those of the rows and means that they are shown as."""
    form = la.MohrCoulomb(1.0, 30).conic_form(kinematics)
    conjugate, mean = np.array([[0.3, -0.2]]), np.array([-1.0, 0.4][: len(form.volumes)])
    xx, yy, zz, xy = form.stress(conjugate, mean)[0]
    if kinematics == "axisymmetric":
        zz, yy = yy, zz  # shown as (rr, zz, tt, rz)
        assert (xx + zz) / 2 == pytest.approx(-1.0)
        assert yy == pytest.approx(-1.0 + 0.4)
        assert (xx - zz) / 2 == pytest.approx(0.3)
    else:
        assert (xx + yy) / 2 == pytest.approx(-1.0)
        assert (xx - yy) / 2 == pytest.approx(0.3)
        assert zz == (0.0 if kinematics == "plane_stress" else pytest.approx(-1.0))
    assert xy == pytest.approx(-0.2)


def test_a_cut_off_limits_what_is_carried_without_pressure():
    """In pure shear one principal stress is a tension as large as the shear stress."""
    assert la.MohrCoulomb(1.0, 30.0).strength == pytest.approx(sqrt(3) / 2)
    assert la.MohrCoulomb(1.0, 30.0, tension_cutoff=0.1).strength == 0.1


def test_another_strength_in_each_element():
    form = la.MohrCoulomb(1.0, 30).conic_form("plane_strain")
    (plane,) = form.surfaces
    assert plane.slope == (pytest.approx(0.5),)
    assert plane.strength == pytest.approx(sqrt(3) / 2)


def layer(most, cohesion=lambda x: 1.0 - x[1], angle=45):
    """Soil of 45 degrees, whose apex is its cohesion: 1 Pa at the ground, 2 Pa below."""
    mesh = la.meshes.rectangle((0, 1), (-1, 0), 2, 2)
    return la.Body(mesh, la.MohrCoulomb(cohesion, angle, tension_cutoff=most))


@pytest.mark.parametrize(
    "given",
    [
        (lambda x: 3.0 - x[1], lambda x: 1.0 - x[1]),
        (3.0, lambda x: 1.0 - x[1]),
        (lambda x: 3.0 - x[1], 1.0),
        (np.full(16, 1.1), 1.0),
        (2.1, lambda x: 1.0 - x[1], lambda x: 45.0 + 0 * x[0]),
    ],
)
def test_a_cut_off_that_is_beyond_the_apex_everywhere_is_refused(given):
    """As a number beside numbers is, whatever of it varies."""
    with pytest.raises(la.InputError, match=r"^Body\.criterion\.tension_cutoff .* everywhere"):
        layer(*given)


def test_a_cut_off_that_is_beyond_the_apex_in_part_says_so():
    """1.5 Pa: beyond where cohesion is less, in the upper half; at the apex itself it is not."""
    assert "tension_cutoff, beyond the apex in 50% of its elements" in repr(layer(1.5))
    for most in (0.5, lambda x: 1.0 - x[1], None):
        assert "apex" not in repr(layer(most))
    names = {"clay": (-1, -0.5), "fill": (-0.5, 0)}
    mesh = la.meshes.layered((0, 1), names, 1, 2)
    soil = la.MohrCoulomb(lambda x: 1.0 - x[1], 45, tension_cutoff=1.5)
    with pytest.raises(la.InputError, match=r"^Body\.criterion\['fill'\]\.tension_cutoff"):
        la.Body(mesh, dict.fromkeys(names, soil))
