"""Yield surfaces of all criteria against formulas in principal stresses, written independently."""

from math import atan, cos, degrees, radians, sin, sqrt, tan

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import lacore as la
from lacore.model.materials.conic_form import PLANE, SPACE
from lacore.model.materials.fields import Field
from lacore.reporting.errors import InputError

DRAWN = 40  # stresses of each criterion


def tensors(stress):
    """Stresses of forms as matrices, shape (n, 3, 3)."""
    full = np.zeros((len(stress), 3, 3))
    full[:, [0, 1, 2], [0, 1, 2]] = stress[:, :3]
    for column, (i, j) in zip(stress.T[3:], ((0, 1), (1, 2), (2, 0)), strict=False):
        full[:, i, j] = full[:, j, i] = column
    return full


def root_of_j2(stress):
    tensor = tensors(stress)
    deviator = tensor - np.trace(tensor, axis1=1, axis2=2)[:, None, None] * np.eye(3) / 3
    return np.sqrt(np.sum(deviator**2, axis=(1, 2)) / 2)


def ends(stress):
    """Largest and least principal stress."""
    principal = np.linalg.eigvalsh(tensors(stress))
    return principal[:, 2], principal[:, 0]


def mises(k):
    return lambda stress: root_of_j2(stress) / k


def mohr(c, phi, tension=None, crushing=None):
    def use(stress):
        most, least = ends(stress)
        shear = (most - least) / 2 + (most + least) / 2 * sin(radians(phi))
        return np.max([shear / (c * cos(radians(phi))), *limits(stress, tension, crushing)], axis=0)

    return use


def limits(stress, tension, crushing):
    most, least = ends(stress)
    found = [] if tension is None else [most / tension]
    return found if crushing is None else [*found, -least / crushing]


def rankine(tension, crushing):
    return lambda stress: np.max(limits(stress, tension, crushing), axis=0)


def tresca(k):
    return lambda stress: (ends(stress)[0] - ends(stress)[1]) / 2 / k


def drucker(a, k):
    def use(stress):
        mean = np.trace(tensors(stress), axis1=1, axis2=2) / 3
        return (root_of_j2(stress) + a * mean) / k

    return use


def matched(c, phi, sign):
    """Slope and strength of the cone through Mohr-Coulomb's triaxial strengths, two of them."""
    # Side pressures 0 and 1 with the axial stress that yields: compression -, extension +.
    s, found = sin(radians(phi)), []
    for side in (0.0, -1.0):
        low = (-2 * c * cos(radians(phi)) + side * (1 + s)) / (1 - s)
        high = (2 * c * cos(radians(phi)) + side * (1 - s)) / (1 + s)
        axial = low if sign < 0 else high
        found.append(((axial + 2 * side) / 3, abs(axial - side) / sqrt(3)))
    (p, q), (other, shear) = found
    a = -(shear - q) / (other - p)
    return a, q + a * p


CRITERIA = [
    (la.VonMises(1.3), mises(1.3), (*PLANE, SPACE)),
    (la.VonMises(yield_stress=2.0), mises(2.0 / sqrt(3)), (*PLANE, SPACE)),
    (la.MohrCoulomb(1.2, 25), mohr(1.2, 25), PLANE),
    (la.MohrCoulomb(1.2, 25, 0.4, 3.0), mohr(1.2, 25, 0.4, 3.0), PLANE),
    (la.MohrCoulomb(1.2, 0, None, 1.5), mohr(1.2, 0, None, 1.5), PLANE),
    (la.Rankine(0.3, 2.0), rankine(0.3, 2.0), PLANE),
    (la.Rankine(0.3), rankine(0.3, None), PLANE),
    (la.MaximumShear(0.7), tresca(0.7), PLANE),
    (
        la.DruckerPrager(1.2, 25, "compression"),
        drucker(*matched(1.2, 25, -1)),
        ("axisymmetric", "plane_stress", SPACE),
    ),
    (
        la.DruckerPrager(1.2, 25, "extension"),
        drucker(*matched(1.2, 25, 1)),
        ("axisymmetric", "plane_stress", SPACE),
    ),
    (la.DruckerPrager(1.2, 25), mohr(1.2, 25), ("plane_strain",)),
]


def used(form, shear, mean):
    """Share of the strength that stresses use by a form."""
    size, none = np.linalg.norm(shear, axis=1), np.zeros(len(shear), dtype=int)
    own = form.surfaces_of(none)
    if own is None:
        return size / form.bounds(none)
    return np.max(own.use(size, mean.ravel()) / own.strength, axis=1)


def drawn(form):
    rng = np.random.default_rng(0)
    shear = rng.uniform(-1, 1, (DRAWN, len(form.rows)))
    return shear, rng.uniform(-2, 1, (DRAWN, len(form.volumes)))


@pytest.mark.parametrize(
    ("criterion", "use", "kinematics"),
    [
        pytest.param(criterion, use, one, id=f"{criterion.label} {one}")
        for criterion, use, every in CRITERIA
        for one in every
    ],
)
def test_strength_is_that_of_principal_stresses(criterion, use, kinematics):
    """The share of strength that a stress uses, positive or not, of any random one."""
    form = criterion.conic_form(kinematics)
    shear, mean = drawn(form)
    if kinematics == "plane_strain" or not form.surfaces:
        mean = mean if form.surfaces else 0 * mean
    stress = form.stress(shear, mean)
    expected = use(stress)
    plastic = expected > 0
    assert plastic.sum() > DRAWN / 4
    found = np.array([least(form, *own) for own in zip(shear, mean, strict=True)])
    assert found[plastic] == pytest.approx(expected[plastic], rel=1e-7)


def least(form, shear, mean):
    """Least share of all conjugates of one stress; a sheet has more of them than components."""
    own = np.append(shear, mean)
    rows = np.vstack([form.rows, form.volumes])
    _, sizes, directions = np.linalg.svd(rows.T)
    free = directions[int((sizes > 1e-12).sum()) :]
    along = free[0] if len(free) and len(shear) == 3 else 0 * own

    def share(t):
        moved = own + t * along
        return used(form, moved[None, : len(shear)], moved[None, len(shear) :])[0]

    return minimize_scalar(share, bracket=(-1, 1), tol=1e-12).fun if along.any() else share(0.0)


@pytest.mark.parametrize("factor", [0.8, 1.5])
def test_a_weakened_criterion_has_its_strengths_divided(factor):
    flat = degrees(atan(tan(radians(25)) / factor))
    for criterion, use in (
        (la.VonMises(1.3), mises(1.3 / factor)),
        (la.MohrCoulomb(1.2, 25, 0.4, 3.0), mohr(1.2 / factor, flat, 0.4 / factor, 3.0 / factor)),
        (la.Rankine(0.3, 2.0), rankine(0.3 / factor, 2.0 / factor)),
        (la.MaximumShear(0.7), tresca(0.7 / factor)),
    ):
        form = criterion.weakened(factor).conic_form("plane_stress")
        shear, mean = drawn(form)
        expected = use(form.stress(shear, mean))
        plastic = expected > 0
        assert used(form, shear, mean)[plastic] == pytest.approx(expected[plastic], rel=1e-9)
    found = la.DruckerPrager(1.2, 25, "compression", 20).weakened(factor)
    assert (found.cohesion, found.friction_angle) == pytest.approx((1.2 / factor, flat))
    assert found.dilation_angle == pytest.approx(min(20, flat))
    assert la.NoTension(2.0).weakened(factor).compressive_strength == 2.0 / factor


def test_the_shear_strength_without_pressure():
    cases = {
        la.MohrCoulomb(1.2, 25): 1.2 * cos(radians(25)),
        la.MohrCoulomb(1.2, 25, tension_cutoff=0.4): 0.4,
        la.MohrCoulomb(1.2, 25, crushing=0.9): 0.9,
        la.Rankine(0.3, 0.2): 0.2,
        la.NoTension(2.0): 0.0,
        la.MaximumShear(0.7): 0.7,
        la.DruckerPrager(1.2, 25, "extension"): matched(1.2, 25, 1)[1],
    }
    for criterion, strength in cases.items():
        assert criterion.strength == pytest.approx(strength)
    assert la.MohrCoulomb(1.2, 25).apex == pytest.approx(1.2 / tan(radians(25)))
    assert la.DruckerPrager(1.2, 25, "compression").slope == pytest.approx(matched(1.2, 25, -1)[0])


LAWS = [
    la.SMOOTH,
    la.Tresca(0.4),
    la.Coulomb(0.5),
    la.Coulomb(0.3, associated=True),
    la.Coulomb(0.5, adhesion=0.4, tension=0.2),
    la.Coulomb(0.5, adhesion=0.4, tension=0.8),
    la.Coulomb(0.2, adhesion=0.6, tension=0.1, associated=True),
]


def carried(law, pressure):
    """Shear stress that a law carries at a pressure; NaN where it opens."""
    if isinstance(law, la.Tresca):
        return law.limit if pressure >= 0 else np.nan
    own = law.adhesion + law.mu * pressure
    return own if pressure >= -law.tension else np.nan


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_terms_of_friction_carry_what_the_law_does(law):
    terms = law.terms()
    for pressure in (-1.0, -0.5, -0.15, 0.0, 0.7, 3.0):
        shifted = pressure + terms.tension
        own = terms.limit + terms.slope * shifted if shifted >= 0 else np.nan
        assert own == pytest.approx(carried(law, pressure), nan_ok=True)
    if isinstance(law, la.Coulomb):
        assert (terms.dilatancy > 0) == law.associated
        bare = law.frictionless()
        least = law.adhesion - law.mu * law.tension  # at the apex of the cone or its cut
        assert bare.terms().slope == 0
        assert bare.terms().limit == pytest.approx(least)
        assert bare.terms().tension == law.tension
        half = law.divided(2.0)
        for pressure in (0.0, 0.7, 3.0):
            assert carried(half, pressure) == pytest.approx(carried(law, pressure) / 2)
        assert half.tension == pytest.approx(law.tension / 2)


@pytest.mark.parametrize("one", LAWS, ids=str)
@pytest.mark.parametrize("other", LAWS, ids=str)
def test_a_law_is_within_one_that_carries_no_less_anywhere(one, other):
    pressures = np.linspace(-0.8, 50, 2541)
    own = np.array([carried(one, pressure) for pressure in pressures])
    most = np.array([carried(other, pressure) for pressure in pressures])
    inside = np.all(np.isnan(own) | (own <= most + 1e-12))
    assert one.terms().within(other.terms()) == inside


@pytest.mark.parametrize("wrong", [-1.0, 4.9, 5.0, 89.9, 90.0, float("nan")])
def test_numbers_that_look_like_angles_are_no_coefficients(wrong):
    from lacore.model.materials.friction import friction_law

    if wrong in (4.9, 90.0):
        assert friction_law(wrong, "friction") == la.Coulomb(wrong)
    else:
        with pytest.raises(InputError):
            friction_law(wrong, "friction")


def test_fields_are_multiplied_and_subtracted():
    deeper = Field(lambda x: 3.0 + 2.0 * x[1])
    places = np.array([[0.0, 1.0], [0.5, 2.0]])
    for found, factor in (
        (deeper * 4.0, 4.0),
        (4.0 * deeper, 4.0),
        (deeper / 4.0, 0.25),
        (deeper * 5.0 - deeper * 2.0, 3.0),
    ):
        assert found.factor == pytest.approx(factor)
        assert found.at(places, "x") == pytest.approx([4.0, 7.0])
    with pytest.raises(ValueError, match="no multiple"):
        deeper - Field(lambda x: x[0])


@pytest.mark.parametrize(
    "function",
    [
        lambda x: -1.0 + 0 * x[0],
        lambda x: np.where(x[0] > 0.5, np.nan, 1.0),
        lambda x: np.ones(7),
        lambda x: x[2],
    ],
)
def test_functions_that_are_no_strength_are_refused(function):
    with pytest.raises(InputError):
        Field(function).at(np.array([[0.0, 1.0], [0.5, 2.0]]), "x")


def test_a_cut_off_is_beyond_the_apex_by_their_difference():
    """T tan(phi) - c, of each place."""
    soil = la.MohrCoulomb(Field(np.array([1.0, 3.0])), 45.0, tension_cutoff=2.0)
    found = soil.beyond_apex(lambda own: np.asarray(getattr(own, "values", own)))
    assert found == pytest.approx([1.0, -1.0])
    assert la.MohrCoulomb(1.0, 30).beyond_apex(np.asarray) is None


def layered(criterion, normal, shear, kinematics="plane_strain"):
    """Share of its strength that a layer uses, by its normal stress and shear."""
    form = criterion.conic_form(kinematics).across()
    tractions = np.stack([normal, shear], axis=1)
    conjugate = tractions[:, form.rows.any(axis=0)] if not form.surfaces else tractions[:, 1:]
    return used(form, conjugate, tractions[:, :1])


def test_a_layer_of_soil_is_a_joint_with_its_cohesion_and_friction():
    """``|tau| <= c - sigma_n tan(phi)`` (T43), and of von Mises the shear strength."""
    rng = np.random.default_rng(0)
    normal, shear = rng.uniform(-3, 0.5, 30), rng.uniform(-2, 2, 30)
    expected = (np.abs(shear) + normal * tan(radians(25))) / 1.2
    plastic = expected > 0
    for criterion in (la.MohrCoulomb(1.2, 25), la.DruckerPrager(1.2, 25)):
        own = layered(criterion, normal, shear)
        assert own[plastic] == pytest.approx(expected[plastic])
    assert layered(la.VonMises(1.3), normal, shear) == pytest.approx(np.abs(shear) / 1.3)


@pytest.mark.parametrize(
    ("criterion", "kinematics", "why"),
    [
        (la.MohrCoulomb(1.2, 25, tension_cutoff=0.1), "plane_strain", "cut-offs"),
        (la.Rankine(0.1, 2.0), "plane_strain", "cut-offs"),
        (la.Rankine(0.1), "plane_strain", "too much friction"),
        (la.MohrCoulomb(1.2, 25), "axisymmetric", "cut-offs"),
        (la.MohrCoulomb(1.2, 25, dilation_angle=5), "plane_strain", "not associated"),
        (la.DruckerPrager(1.2, 60, "compression"), SPACE, "too much friction"),
    ],
)
def test_what_has_no_layer_says_so(criterion, kinematics, why):
    form = criterion.conic_form(kinematics)
    assert not form.opens
    with pytest.raises(InputError, match=why):
        form.across()


@pytest.mark.parametrize("kinematics", ["plane_strain", "axisymmetric"])
@pytest.mark.parametrize("dilation", [None, 10.0])
def test_angles_of_elements_make_the_form_of_each(kinematics, dilation):
    """Elements of 20 and 35 degrees have the surfaces, and the flow, of soils of these angles."""
    angles, cohesion = np.array([20.0, 35.0]), np.array([1.0, 0.4])
    flow = None if dilation is None else np.full(2, dilation)
    for kind in (la.MohrCoulomb, lambda *given, **more: la.DruckerPrager(*given, **more)):
        varied = kind(1.0, 30.0).form_of(kinematics, angles, cohesion, flow)
        own = varied.surfaces_of(np.arange(2))
        for element in range(2):
            single = kind(cohesion[element], angles[element], dilation_angle=dilation)
            one = single.conic_form(kinematics).surfaces_of(np.zeros(1, dtype=int))
            assert own.slope[element] == pytest.approx(one.slope[0])
            assert own.strength[element] == pytest.approx(one.strength[0])
            if dilation is not None:
                assert own.flow[element] == pytest.approx(one.flow[0])
            else:
                assert own.flow is one.flow is None


@pytest.mark.parametrize("factor", [0.8, 1.5])
def test_angles_of_elements_are_weakened_one_by_one(factor):
    soil = la.MohrCoulomb(1.0, [20.0, 35.0], dilation_angle=[5.0, 34.0]).weakened(factor)
    tangents = np.tan(np.radians(soil.friction_angle.values))
    assert tangents == pytest.approx(np.tan(np.radians([20.0, 35.0])) / factor)
    most = np.minimum([5.0, 34.0], soil.friction_angle.values)
    assert soil.dilation_angle.values == pytest.approx(most)
    with pytest.raises(InputError, match="a function of place"):
        la.MohrCoulomb(1.0, lambda x: 30 + x[1]).weakened(factor)


def test_strengths_that_vary_are_those_of_the_points():
    """A cohesion of y, times cos(phi), at heights 1 and 3 of two elements."""
    soil = la.MohrCoulomb(lambda x: x[1], 30.0, crushing=8.0)
    form = soil.conic_form("plane_strain")
    assert form.varies
    assert not form.uniform
    places = np.array([[0.0, 0.0], [1.0, 3.0]])
    own = form.at_points(np.array([0, 1]), lambda field: field.at(places, "cohesion"))
    assert not own.varies
    surfaces = own.surfaces_of(np.arange(2))
    assert surfaces.strength[:, 0] == pytest.approx(np.array([1.0, 3.0]) * cos(radians(30)))
    assert surfaces.strength[:, 1] == pytest.approx(8.0)
    assert surfaces.slope[:, 0, 0] == pytest.approx(0.5)


def test_friction_is_divided_by_a_factor_of_safety():
    assert la.Tresca(0.6).divided(2.0) == la.Tresca(0.3)
    assert la.SMOOTH.divided(2.0) == la.SMOOTH
    assert la.BOND.divided(2.0) is la.BOND
    assert la.BOND.terms().limit == np.inf
    assert la.Coulomb(0.5, adhesion=0.4, tension=0.8).divided(2.0).tension == pytest.approx(0.4)


def test_a_body_opens_in_layers_where_all_of_its_elements_do():
    """Elements of 30 and 75 degrees in space: a cone so steep never opens fast enough to slip."""
    soil = la.DruckerPrager(1.0, 30.0, "compression")
    cohesion = np.ones(2)
    for angles, opens in (((30.0, 20.0), True), ((30.0, 75.0), False), ((75.0, 30.0), False)):
        form = soil.form_of(SPACE, np.array(angles), cohesion, None)
        assert form.opens == opens


@pytest.mark.parametrize("kind", [la.MohrCoulomb, la.DruckerPrager])
@pytest.mark.parametrize("varies", [{"friction_angle": 30.0}, {"dilation_angle": 5.0}])
def test_angles_that_vary_have_no_form_of_one_angle(kind, varies):
    given = {"friction_angle": 40.0, "dilation_angle": 10.0}
    fields = {name: [value, value - 1] for name, value in varies.items()}
    kind(1.0, **given).conic_form("plane_strain")
    with pytest.raises(ValueError, match="form_of"):
        kind(1.0, **(given | fields)).conic_form("plane_strain")
