"""Forms of criteria: deviators, layers, surfaces of points; and limits of what may be given."""

from math import atan, degrees, radians, sin, sqrt, tan

import numpy as np
import pytest

import lacore as la
from lacore.model.materials.conic_form import PLANE, SPACE
from lacore.model.materials.fields import Field, Ranged, called, taken, varying, with_fields
from lacore.model.materials.friction import friction_law, in_degrees
from lacore.model.materials.hardening import Linear, Perfect

RNG = np.random.default_rng(5)


def deviator(kinematics, rate):
    """Norm of the three-dimensional strain rate deviator, with engineering shears, 1/s."""
    if kinematics == "plane_strain":
        diagonal, shear = np.array([rate[0], rate[1], 0.0]), rate[2:]
    else:
        diagonal, shear = rate[:3], rate[3:]
    diagonal = diagonal - diagonal.mean()
    return sqrt(diagonal @ diagonal + shear @ shear / 2)


@pytest.mark.parametrize("kinematics", ["plane_strain", "axisymmetric", SPACE])
@pytest.mark.parametrize("criterion", [la.VonMises(2.0), la.DruckerPrager(2.0, 0.0, "extension")])
def test_a_regularised_norm_is_that_of_the_deviator_also_where_volume_changes(
    criterion, kinematics
):
    """The share of theta makes up for what the rows of a plane do not see."""
    form = criterion.conic_form(kinematics)
    for rate in RNG.uniform(-1, 1, (20, form.rows.shape[1])):
        theta = form.volumetric @ rate
        size = np.hypot(np.linalg.norm(form.rows @ rate), form.volumetric_factor * theta)
        assert size == pytest.approx(sqrt(2) * deviator(kinematics, rate))


@pytest.mark.parametrize("kinematics", ["plane_strain", "plane_stress", SPACE])
def test_a_velocity_jump_costs_what_the_strain_rate_in_a_layer_does(kinematics):
    """Of a rate normal to the layer and of shear along it, regularised or not."""
    form = la.VonMises(2.0).conic_form(kinematics)
    layer = form.across()
    assert layer.bound == form.bound == 2.0
    axes = [0, 3, 5] if kinematics == SPACE else [0, 2]
    for jump in RNG.uniform(-1, 1, (10, len(axes))):
        rate = np.zeros(form.rows.shape[1])
        rate[axes] = jump
        full = np.hypot(
            np.linalg.norm(form.rows @ rate), form.volumetric_factor * (form.volumetric @ rate)
        )
        found = np.hypot(
            np.linalg.norm(layer.rows @ jump), layer.volumetric_factor * (layer.volumetric @ jump)
        )
        assert found == pytest.approx(full)
        assert layer.volumetric @ jump == pytest.approx(form.volumetric @ rate)


def test_a_layer_of_a_sheet_of_plane_stress_opens_without_a_change_of_volume():
    assert la.VonMises(1.0).conic_form("plane_stress").compressible
    assert la.MohrCoulomb(1.0, 30.0).conic_form("plane_strain").compressible
    assert not la.VonMises(1.0).conic_form("plane_strain").compressible
    for kinematics in ("axisymmetric", "plane_stress"):
        tresca = la.MaximumShear(1.0).conic_form(kinematics)
        assert tresca.compressible == (kinematics == "plane_stress")


def test_the_stress_out_of_the_plane_of_flow_that_is_not_associated():
    """Conjugates of a stress tensor give the tensor, whatever it is out of the plane (T88)."""
    form = la.DruckerPrager(1.0, 30.0, dilation_angle=10.0).conic_form("plane_strain")
    for xx, yy, zz, xy in RNG.uniform(-1, 1, (5, 4)):
        mean = (xx + yy + zz) / 3
        # sqrt(J2) is the norm of the conjugates.
        deviators = np.array([xx, yy, zz]) - mean
        third = (xx + yy - 2 * mean) * sqrt(3) / 2
        conjugate = np.array([[(xx - yy) / 2, xy, third]])
        assert np.linalg.norm(conjugate) == pytest.approx(sqrt(deviators @ deviators / 2 + xy**2))
        found = form.stress(conjugate, np.array([mean]))[0]
        assert found == pytest.approx([xx, yy, zz, xy])


def test_slopes_of_flow_are_those_of_the_elements_of_points():
    soil = la.MohrCoulomb(1.0, 30.0, crushing=9.0, dilation_angle=10.0)
    angles = np.array([20.0, 40.0, 30.0])
    form = soil.form_of("plane_strain", angles, np.ones(3), np.array([5.0, 15.0, 10.0]))
    assert form.frictional
    assert not form.uniform
    points = np.array([2, 0, 1, 1])
    expected = np.sin(np.radians([[30, 20, 40, 40], [10, 5, 15, 15]]))
    own = form.at_points(points, lambda field: np.full(4, np.nan))
    for surfaces in (form.surfaces_of(points), own.surfaces_of(np.arange(4))):
        assert surfaces.slope[:, 0, 0] == pytest.approx(expected[0])
        assert surfaces.flow[:, 0, 0] == pytest.approx(expected[1])
        assert surfaces.strength[:, 1] == pytest.approx(9.0)
        assert surfaces.flow[:, 1] == pytest.approx(surfaces.slope[:, 1])  # of the cut-off


def test_a_form_is_uniform_where_no_element_differs():
    soil = la.MohrCoulomb(1.0, 30.0, crushing=9.0)
    assert soil.conic_form("plane_strain").uniform
    assert not soil.form_of("plane_strain", np.array([30.0, 31.0]), np.ones(2), None).uniform
    assert not la.Rankine(Field(np.ones(2))).conic_form("plane_strain").uniform
    assert la.Rankine(Field(np.ones(2))).conic_form("plane_strain").varies
    assert not la.Rankine(1.0, 2.0).conic_form("plane_strain").varies


@pytest.mark.parametrize("kinematics", PLANE)
def test_two_limits_are_scaled_by_the_lesser_one(kinematics):
    """What is carried without pressure: a number of two numbers, of elements the least of each."""
    assert la.Rankine(0.3, 2.0).conic_form(kinematics).bound == 0.3
    assert la.Rankine(2.0, 0.3).conic_form(kinematics).bound == 0.3
    soil = la.MohrCoulomb(1.0, 30.0, crushing=0.5)
    form = soil.form_of(kinematics, np.full(2, 60.0), np.array([0.2, 3.0]), None)
    assert form.bound == pytest.approx([0.1, 0.5])
    varying_one = la.MohrCoulomb(Field(np.ones(2)), 30.0, crushing=0.5).conic_form(kinematics)
    assert isinstance(varying_one.bound, Field)


def test_fields_of_a_criterion_change_and_numbers_stay():
    soil = la.MohrCoulomb(Field(np.array([1.0, 3.0])), 30.0, crushing=[8.0, 9.0])
    assert set(varying(soil)) == {"cohesion", "crushing"}
    halved = with_fields(soil, lambda field: field / 2)
    assert halved.cohesion.factor == halved.crushing.factor == 0.5
    assert halved.friction_angle == 30.0
    clay = la.VonMises(2.0)
    assert with_fields(clay, lambda field: field / 2) is clay
    unknown = object()
    assert with_fields(unknown, lambda field: field / 2) is unknown


def test_what_stands_for_a_strength_is_a_number_or_a_field():
    for number in (2, 2.0, np.float64(2.0), None, "2"):
        assert taken("x", number) is number
    for given in ([1.0, 2.0], (1.0, 2.0), np.array([1.0, 2.0])):
        assert taken("x", given).values.tolist() == [1.0, 2.0]
    function = np.sum
    assert taken("x", function).values is function
    field = Field(function)
    assert taken("x", field) is field


@pytest.mark.parametrize(
    ("values", "why"),
    [
        ([1.0, -2.0], "element 1: negative"),
        ([np.nan, 2.0], "element 0: negative, or no number"),
        ([[1.0, 2.0], [3.0, np.inf]], "element 1: negative, or no number"),
        ([], "neither a number nor a function"),
        (["a"], "neither a number nor a function"),
        (np.ones((2, 2, 2)), "neither a number nor a function"),
    ],
)
def test_values_of_elements_that_are_no_strengths_are_rejected(values, why):
    with pytest.raises(la.InputError, match=why):
        Field(values)


def test_the_first_place_where_a_function_is_no_strength_is_reported():
    places = np.array([[0.0, 1.0, 2.0], [0.0, 5.0, 6.0]])
    with pytest.raises(la.InputError, match=r"-1\.0: at \(1, 5\): negative"):
        called("x", lambda x: np.where(x[0] > 0.5, -x[0], 1.0), places, (3,))
    with pytest.raises(la.InputError, match="not a finite number"):
        called("x", lambda x: np.where(x[0] > 0.5, np.inf, 1.0), places, (3,))
    with pytest.raises(la.InputError, match="coordinates of shape"):
        called("x", lambda x: x[0][:2], places, (3,))
    wrong = [[1.0, 1.0, 1.0], [1.0, 1.0, np.nan]]
    with pytest.raises(la.InputError, match=r"at \(2, 6\): not a finite number"):
        called("x", lambda x: wrong, places, (2, 3), least=-np.inf)
    vectors = called("x", lambda x: [1.0, -2.0], places, (2, 3), least=-np.inf)
    assert vectors.tolist() == [[1.0] * 3, [-2.0] * 3]


def test_the_values_of_a_range_are_reported_with_its_factor():
    soil = Ranged(lambda x: 8 - x[1], ends=(16.0, 8.0))
    assert str(soil.told_in("Pa")) == "8 to 16 Pa"
    assert str((soil / 2).told_in("Pa")) == "4 to 8 Pa"


def test_numbers_that_are_an_angle_in_radians_only_beyond_ninety_degrees_are_degrees():
    """1.745 is 100 degrees in radians, and no angle of friction: degrees are meant."""
    for angle in (round(radians(100), 3), radians(100), 1.2, 0.52, 88.9):
        assert la.MohrCoulomb(1.0, angle).friction_angle == angle
    for angle in (radians(6), radians(89), round(radians(45), 3), radians(20) + 2e-5):
        with pytest.raises(la.InputError, match="degrees in radians"):
            la.MohrCoulomb(1.0, angle)
    la.MohrCoulomb(1.0, radians(20) + 1e-4)


def test_a_dilation_angle_is_an_angle_whether_friction_varies_or_not():
    for friction in (30.0, [30.0, 31.0]):
        for wrong in (90.0, -1.0, 0.05):
            with pytest.raises(la.InputError, match="dilation_angle"):
                la.MohrCoulomb(1.0, friction, dilation_angle=wrong)
        la.MohrCoulomb(1.0, friction, dilation_angle=[5.0, 6.0])
        la.MohrCoulomb(1.0, friction, dilation_angle=0.0)
    with pytest.raises(la.InputError, match=r"MohrCoulomb\.friction_angle"):
        la.MohrCoulomb(1.0, 91.0, dilation_angle=[5.0, 6.0])


def test_flow_with_the_dilation_angle_of_friction_is_associated():
    for kind in (la.MohrCoulomb, la.DruckerPrager):
        assert not kind(1.0, 30.0, dilation_angle=30.0).conic_form("plane_strain").frictional
        assert kind(1.0, 30.0, dilation_angle=29.0).conic_form("plane_strain").frictional
    soil = la.DruckerPrager(1.0, 30.0, dilation_angle=10.0)
    assert soil.flow == pytest.approx(la.DruckerPrager(1.0, 10.0).slope)
    for own in (la.DruckerPrager(1.0, 30.0), la.DruckerPrager(1.0, 30.0, dilation_angle=30.0)):
        assert own.flow is None
    for varies in ({"friction_angle": [30.0, 31.0]}, {"friction_angle": 30.0}):
        assert np.isnan(la.DruckerPrager(1.0, **varies, dilation_angle=[5.0, 6.0]).flow)
        assert la.DruckerPrager(1.0, [30.0, 31.0]).flow is None


def test_angles_of_elements_keep_their_factor_where_they_are_weakened():
    soil = la.MohrCoulomb(1.0, 2.0 * Field(np.array([10.0, 20.0])), dilation_angle=30.0)
    found = soil.weakened(2.0)
    expected = [degrees(atan(tan(radians(own)) / 2)) for own in (20.0, 40.0)]
    assert found.friction_angle.values == pytest.approx(expected)
    assert found.dilation_angle.values == pytest.approx(expected)
    plane = la.MohrCoulomb(1.0, 40.0, dilation_angle=[5.0, 30.0]).weakened(2.0)
    assert plane.dilation_angle.values == pytest.approx([5.0, expected[1]])


def test_divided_tension_is_never_beyond_the_apex():
    """A law that is strengthened keeps its apex, adhesion/mu, and one without friction has none."""
    stronger = la.Coulomb(0.5, adhesion=0.4, tension=0.6).divided(0.5)
    assert (stronger.mu, stronger.adhesion) == (1.0, 0.8)
    assert stronger.tension == pytest.approx(0.8)
    bonded = la.Coulomb(0.0, adhesion=0.4, tension=0.6).divided(0.5)
    assert bonded.tension == pytest.approx(1.2)


def test_a_tension_at_the_apex_is_taken_with_its_round_off():
    la.Coulomb(0.3, adhesion=0.2, tension=0.2 / 0.3 * (1 + 1e-13))
    with pytest.raises(la.InputError, match="beyond the apex"):
        la.Coulomb(0.3, adhesion=0.2, tension=0.2 / 0.3 * (1 + 1e-10))


@pytest.mark.parametrize("name", ["adhesion", "tension"])
@pytest.mark.parametrize("wrong", [-1.0, np.nan, np.inf, "1"])
def test_strengths_of_joints_that_are_none_are_rejected(name, wrong):
    with pytest.raises(la.InputError, match=rf"Coulomb\.{name}"):
        la.Coulomb(0.3, **{"adhesion": 1.0, name: wrong})


@pytest.mark.parametrize("wrong", [-1.0, np.nan, "1", None])
def test_limits_of_friction_that_are_none_are_rejected(wrong):
    with pytest.raises(la.InputError, match=r"Tresca\.limit"):
        la.Tresca(wrong)
    with pytest.raises(la.InputError, match="friction"):
        friction_law(wrong, "friction")


def test_coefficients_from_the_tangent_of_79_degrees_up_to_a_right_angle_look_like_degrees():
    found = [in_degrees(own) for own in (0.0, 4.99, 5.0, 30.0, 89.9, 90.0)]
    assert found == [False, False, True, True, True, False]


def test_a_law_that_hardens_by_little_is_a_law():
    """Its slope is lost in the round-off of its stress where strains are small."""

    class Same(Linear):
        """A law that is sampled as one from outside."""

    for law in (Perfect(1e9), Linear(1e9, 1.0), Same(3e8, 0.1)):
        assert la.VonMises(hardening=law).k == pytest.approx(law.yield_stress / sqrt(3))


@pytest.mark.parametrize("share", [0.9, 0.97, 1.03, 1.1])
def test_a_modulus_a_few_percent_off_is_not_the_slope(share):
    class Wrong(Linear):
        """A law of another modulus."""

        def modulus(self, strain):
            return share * super().modulus(strain)

    with pytest.raises(la.InputError, match="not the slope"):
        la.VonMises(hardening=Wrong(1.0, 5.0))


def test_corners_of_a_law_at_samples_are_no_wrong_slopes():
    """A law of a few straight pieces has a modulus everywhere but at its corners."""

    class Pieces:
        """Two slopes, with a corner at 1e-6, the first of the samples."""

        def stress(self, strain):
            return 1.0 + np.minimum(strain, 1e-6) * 1e3 + 2.0 * np.maximum(strain - 1e-6, 0)

        def modulus(self, strain):
            return np.where(strain <= 1e-6, 1e3, 2.0)

    assert la.VonMises(hardening=Pieces()).k == pytest.approx(1 / sqrt(3))


def test_the_angle_of_soil_is_in_radians_and_its_apex_unknown_where_it_varies():
    assert la.MohrCoulomb(1.0, 30.0).angle == pytest.approx(np.pi / 6)
    assert np.isnan(la.MohrCoulomb(1.0, [30.0, 31.0]).angle)
    assert np.isnan(la.MohrCoulomb([1.0, 2.0], 30.0).apex)
    for own in (
        la.MohrCoulomb([1.0, 2.0], 30.0),
        la.MohrCoulomb(1.0, [30.0, 31.0]),
        la.MohrCoulomb(1.0, 30.0, crushing=[8.0, 9.0]),
        la.Rankine(1.0, [8.0, 9.0]),
        la.MaximumShear([1.0, 2.0]),
        la.VonMises(yield_stress=[1.0, 2.0]),
        la.DruckerPrager([1.0, 2.0], 30.0),
        la.DruckerPrager(1.0, [30.0, 31.0]),
    ):
        assert np.isnan(own.strength)
        assert own.law is None
    assert sin(la.MohrCoulomb(1.0, 30.0).angle) == pytest.approx(0.5)


def test_a_yield_stress_that_varies_is_sqrt_3_times_that_in_shear():
    steel = la.VonMises(yield_stress=[3.0, 6.0])
    assert steel.k.factor == pytest.approx(1 / sqrt(3))
    assert steel.weakened(2.0).k.factor == pytest.approx(1 / sqrt(12))


def test_a_law_is_sampled_at_strains_from_a_millionth_to_10():
    """A dip below a strain of 1e-4 is seen, and what a law does beyond 10 is not asked."""

    class Dip:
        """A law that softens between two strains."""

        def __init__(self, low, high):
            self.low, self.high = low, high

        def stress(self, strain):
            return 1.0 - 0.5 * np.clip((strain - self.low) / (self.high - self.low), 0, 1)

        def modulus(self, strain):
            return 0 * strain

    with pytest.raises(la.InputError, match="softens"):
        la.VonMises(hardening=Dip(1e-5, 1e-4))
    with pytest.raises(la.InputError, match="softens"):
        la.VonMises(hardening=Dip(5.0, 9.9))
    assert la.VonMises(hardening=Dip(11.0, 20.0)).k == pytest.approx(1 / sqrt(3))


def test_what_is_bonded_has_no_coefficient_and_no_dilatancy():
    terms = la.BOND.terms()
    assert (terms.coefficient, terms.limit, terms.dilatancy, terms.tension) == (0, np.inf, 0, 0)
    assert la.STICK.terms() == terms


def test_cones_of_a_sheet_have_one_angle_of_friction_and_associated_flow():
    """Strength and flow of Drucker and Prager turn around axes of their own in plane stress."""
    soil = la.DruckerPrager(1.0, 30.0)
    angles = np.array([20.0, 30.0])
    for kinematics in ("plane_strain", "axisymmetric", SPACE):
        assert not soil.form_of(kinematics, angles, np.ones(2), None).frictional
        assert soil.form_of(kinematics, angles, np.ones(2), angles / 2).frictional
        assert la.DruckerPrager(1.0, 30.0, dilation_angle=5.0).conic_form(kinematics).frictional
    with pytest.raises(la.InputError, match="turn with their angle"):
        soil.form_of("plane_stress", angles, np.ones(2), None)
    with pytest.raises(la.InputError, match="axes of their own"):
        la.DruckerPrager(1.0, 30.0, dilation_angle=5.0).conic_form("plane_stress")
    assert not soil.conic_form("plane_stress").frictional


def test_criteria_of_planes_have_no_form_in_space_and_no_criterion_an_unknown_one():
    for criterion in (la.MohrCoulomb(1.0, 30.0), la.Rankine(1.0), la.MaximumShear(1.0)):
        with pytest.raises(la.InputError, match="in three dimensions"):
            criterion.conic_form(SPACE)
    for criterion in (la.VonMises(1.0), la.MohrCoulomb(1.0, 30.0), la.DruckerPrager(1.0, 30.0)):
        with pytest.raises(la.InputError, match=r"Body\.kinematics"):
            criterion.conic_form("plane")


def test_strengths_of_functions_have_no_value_in_an_element():
    form = la.Rankine(lambda x: x[1], 2.0).conic_form("plane_strain")
    with pytest.raises(ValueError, match="at_points"):
        form.surfaces_of(np.arange(2))
    with pytest.raises(ValueError, match="at_points"):
        form.bounds(np.arange(2))
    assert la.VonMises(1.5).conic_form("plane_strain").bounds(np.zeros((2, 3), dtype=int)).tolist()
