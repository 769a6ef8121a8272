"""Cohesion that is lent to bodies without any, as an argument of bounds and brackets."""

import pytest

import lacore as la
from lacore.analyses.ranges.continuum import continuum_range

HEIGHT, WIDTH, CRUSHING = 2.0, 1.0, 50.0
PUSHED = {"dead_loads": (0.0, -1.0), "reference_loads": (1.0, 0.0)}
HEAVY = {"reference_loads": (0.0, -1.0)}  # soils cannot stand upright before their load grows


def panel(criterion, loads=PUSHED):
    """A panel on a rough floor: heavy and pushed sideways by its own weight, or only heavy."""
    mesh = la.meshes.rectangle((0, WIDTH), (0, HEIGHT), 2, 4)
    return la.Problem(
        bodies={"panel": la.Body(mesh, criterion, kinematics="plane_stress")},
        supports=[la.Fix("panel", "bottom")],
        **{kind: [la.BodyForce("panel", force)] for kind, force in loads.items()},
    )


@pytest.mark.parametrize(
    ("stated", "given", "loads"),
    [
        (la.NoTension(CRUSHING), la.Rankine(1e-3, CRUSHING), PUSHED),
        (la.Rankine(0.0, CRUSHING), la.Rankine(1e-3, CRUSHING), PUSHED),
        (la.MohrCoulomb(0.0, 30.0), la.MohrCoulomb(1e-3, 30.0), HEAVY),
        (
            la.MohrCoulomb(1.0, 30.0, tension_cutoff=0.0),
            la.MohrCoulomb(1.0, 30.0, tension_cutoff=1e-3),
            PUSHED,
        ),
        (la.DruckerPrager(0.0, 20.0), la.DruckerPrager(1e-3, 20.0), HEAVY),
    ],
    ids=lambda one: type(one).__name__,
)
def test_a_lower_bound_with_lent_cohesion_is_that_of_the_stronger_body(stated, given, loads):
    with pytest.raises(la.InputError, match=r"lent_cohesion=\d"):
        la.lower_bound(panel(stated, loads))
    lent = la.lower_bound(panel(stated, loads), lent_cohesion=1e-3)
    own = la.lower_bound(panel(given, loads))
    assert own.rigor is la.Rigor.LOWER
    assert lent.load_factor == pytest.approx(own.load_factor, rel=1e-9)
    assert "a lent cohesion or tensile strength of 0.001 Pa" in lent.message
    assert "strict lower bound with a lent cohesion" in str(lent)
    assert "lent" not in own.message + str(own)


def test_a_bracket_with_lent_cohesion():
    found = la.bracket(panel(la.NoTension(CRUSHING)), 0.2, 400, lent_cohesion=1e-3)
    assert 0 < found.lower < found.upper < WIDTH / HEIGHT * 1.1
    assert not found.strict
    assert "with a lent cohesion" in found.heading
    assert "a lent cohesion or tensile strength of 0.001 Pa" in found.message


def test_an_upper_bound_needs_no_lent_cohesion():
    """It is strict for the body as given, and a strength that is lent to it only raises it."""
    own, lent = (
        la.upper_bound(panel(criterion))
        for criterion in (la.NoTension(CRUSHING), la.Rankine(1e-3, CRUSHING))
    )
    assert own.rigor is la.Rigor.UPPER
    assert 0 < own.load_factor < lent.load_factor


def test_what_cohesion_cannot_be_lent_to():
    with pytest.raises(la.InputError, match=r"^lent_cohesion = 0"):
        la.lower_bound(panel(la.NoTension(CRUSHING)), lent_cohesion=0.0)
    with pytest.raises(la.InputError, match="no body without cohesion or tension needs it"):
        la.bracket(panel(la.VonMises(1.0)), lent_cohesion=1e-3)
    varying = la.MohrCoulomb(lambda x: x[1], 30.0)
    with pytest.raises(la.InputError, match="varies from place to place"):
        la.lower_bound(panel(varying), lent_cohesion=1e-3)
    model = la.lower_bound(panel(la.Rankine(1.0, CRUSHING))).model
    with pytest.raises(la.InputError, match="already assembled"):
        la.lower_bound(model, lent_cohesion=1e-3)


def sand_footing(cohesion=0.0, weight=1.0):
    """Half of a smooth strip footing on sand, 2 m wide: N_gamma at a weight of 1."""
    mesh = la.meshes.rectangle((0, 4), (-2, 0), 4, 2)
    mesh = mesh.with_boundaries({"under": lambda x: (x[1] > -1e-9) & (x[0] < 1)})
    return la.Problem(
        {"sand": la.Body(mesh, la.MohrCoulomb(cohesion, 20.0))},
        [la.RigidFooting("sand", "under", (0, -1), rough=False)],
        supports=[la.Fix("sand", "left", "x"), la.Fix("sand", "right"), la.Fix("sand", "bottom")],
        dead_loads=[la.BodyForce("sand", (0, -weight))],
    )


def test_a_bracket_lends_heavy_sand_a_share_of_its_target_width():
    """N_gamma = 1.57863 by characteristics."""
    found = la.bracket(sand_footing(), target_width=0.5, max_elements=400)
    assert found.lower < 1.57863 < found.upper
    assert found.width <= 0.5
    assert not found.strict
    assert found.lent
    assert "lower bound with a lent cohesion" in found.heading
    (finer,) = la.bracket(sand_footing(), target_width=0.25, max_elements=128).lent
    (coarser,) = found.lent
    assert coarser.values["lent"].numbers == pytest.approx(2 * finer.values["lent"].numbers)


@pytest.mark.parametrize("unit", [1e-6, 1e6])
def test_the_lent_cohesion_scales_with_the_weight(unit):
    small, large = (
        la.bracket(sand_footing(weight=own), target_width=0.5, max_elements=400)
        for own in (1.0, unit)
    )
    assert large.lower == pytest.approx(unit * small.lower, rel=1e-3)
    assert large.upper == pytest.approx(unit * small.upper, rel=1e-3)


def test_a_range_of_sand_claims_no_lower_end_of_a_stronger_soil():
    assert not la.bracket(sand_footing(1e-2), target_width=0.9, max_elements=400).lent
    lent = continuum_range(la.discretise(sand_footing()), "clarabel", {}, 0.9)
    own = continuum_range(la.discretise(sand_footing(1e-2)), "clarabel", {}, 0.9)
    assert lent.lower == -float("inf")
    assert [one.kind.name for one in lent.missing] == ["LENT_COHESION"]
    assert 0 < own.lower < lent.upper < float("inf")


def test_load_cases_of_sand_are_not_sure():
    """Their lower bounds are of a stronger soil."""
    cases = {"one": [la.RigidFooting("sand", "under", (0, -1), rough=False)]}
    for cohesion, sure in ((0.0, False), (1e-2, True)):
        found = la.load_cases(sand_footing(cohesion), cases, target_width=0.9)
        assert found.sure is sure
