"""Cohesion that is lent to bodies without any, as an argument of bounds and brackets."""

import pytest

import lacore as la

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
