"""Hardening laws (T29): each is what its formula says, rises, and refuses what would soften."""

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from lacore.model.materials.hardening import HardeningLaw, Linear, Perfect, Swift, Table, Voce
from tests.lacore.models import square

SIZES = st.floats(1e-3, 1e3)


@st.composite
def tables(draw):
    gaps = draw(st.lists(st.floats(1e-3, 1.0), min_size=1, max_size=6))
    rises = draw(st.lists(st.floats(0.0, 10.0), min_size=len(gaps), max_size=len(gaps)))
    first = draw(SIZES)
    return Table(np.cumsum([0.0, *gaps]), first + np.cumsum([0.0, *rises]))


LAWS = st.one_of(
    st.builds(Perfect, SIZES),
    st.builds(Linear, SIZES, st.floats(0.0, 1e3)),
    st.builds(lambda s, rise, rate: Voce(s, s + rise, rate), SIZES, SIZES, st.floats(0.01, 30.0)),
    st.builds(Swift, SIZES, st.floats(1e-3, 1.0), st.floats(0.0, 1.0)),
    tables(),
)


@given(LAWS, st.lists(st.floats(0.0, 5.0), min_size=2, max_size=20))
def test_a_law_is_positive_and_rises(law, strains):
    """To a few units in the last place."""
    strains = np.sort(strains)
    stress, modulus = law.stress(strains), law.modulus(strains)
    assert stress.shape == modulus.shape == strains.shape
    assert np.all(stress > 0)
    assert np.all(modulus >= 0)
    assert np.all(np.diff(stress) >= -1e-15 * stress[1:])


@given(LAWS, st.floats(0.0, 5.0))
def test_the_modulus_is_the_derivative_of_the_stress(law, strain):
    """Integrated with the rule of Gauss over a step: a slope without cancellation.

    Its error for 5 points, (h/offset)^11/1e6 of the stress, is round-off also for the law with the
    sharpest start, Swift with offset 1e-3. A step ends at the next knot of a table.
    """
    knots = np.array(law.strains if isinstance(law, Table) else ())
    end = min([strain + 1e-4, *knots[knots > strain]])
    points, weights = np.polynomial.legendre.leggauss(5)
    half = (end - strain) / 2
    area = half * weights @ law.modulus(strain + half * (1 + points))
    rise = np.diff(law.stress(np.array([strain, end])))[0]
    assert rise == pytest.approx(area, abs=1e-14 * law.stress(np.array([end]))[0], rel=1e-12)


def test_initial_yield_stresses_are_exact():
    start = np.zeros((2, 3))
    for law, value in [
        (Perfect(2.5), 2.5),
        (Linear(2.5, 0.3), 2.5),
        (Voce(2.5, 3.7, 12.3), 2.5),
        (Table([0, 0.1], [2.5, 3.0]), 2.5),
        (Swift(5.0, 0.25, 0.5), 2.5),
    ]:
        assert np.array_equal(law.stress(start), np.full((2, 3), value))


def test_values_by_hand():
    at = np.array([0.5])
    assert Linear(1.0, 3.0).stress(at) == pytest.approx(2.5)
    assert Voce(1.0, 3.0, 2 * np.log(2)).stress(at) == pytest.approx(2.0)
    assert Voce(1.0, 3.0, 2 * np.log(2)).modulus(at) == pytest.approx(2 * np.log(2))
    assert Swift(6.0, 0.5, 0.5).modulus(at) == pytest.approx(3.0)
    assert Table([0, 1], [1, 3]).stress(at) == pytest.approx(2.0)


def test_a_table_passes_through_its_points_and_then_stays():
    strains, stresses = (0.0, 0.01, 0.1, 0.3), (200.0, 250.0, 250.0, 310.0)
    law = Table(strains, stresses)
    assert law.stress(np.array(strains)) == pytest.approx(stresses, rel=1e-15)
    assert law.stress(np.array([0.3000001, 7.0])) == pytest.approx([310.0, 310.0], rel=1e-15)
    assert np.all(law.modulus(np.array([0.3000001, 7.0])) <= 0)
    assert law.modulus(np.array([0.3])) > 0  # of the curve before it
    between = np.linspace(0.01, 0.1, 50)
    assert law.stress(between) == pytest.approx(np.full(50, 250.0), rel=1e-14)


@pytest.mark.parametrize(
    "law",
    [Perfect(1), Linear(1, 2), Voce(1, 2, 3), Swift(1, 0.1, 0.2), Table([0, 1], np.array([1, 2]))],
)
def test_a_law_is_a_value(law):
    law.stress(np.zeros(1))
    criterion = la.VonMises(hardening=law)
    copy = pickle.loads(pickle.dumps(criterion))
    assert isinstance(law, HardeningLaw)
    assert copy == criterion
    assert hash(copy) == hash(criterion)
    assert repr(copy) == repr(criterion)


REFUSED = [
    (lambda: Perfect(0), r"Perfect.yield_stress = 0: not a positive number; give"),
    (lambda: Linear(-1, 1), r"Linear.yield_stress = -1: not a positive number; give"),
    (lambda: Linear(1, -0.1), r"Linear.slope = -0.1: softens.*non-convex.*; give a slope >= 0"),
    (lambda: Linear(1, np.nan), r"Linear.slope = nan: not a finite number; give"),
    (lambda: Voce(2, 1, 1), r"Voce.saturation = 1: softens.*; give at least the yield_stress, 2"),
    (lambda: Voce(1, 2, 0), r"Voce.rate = 0: not a positive number; give"),
    (lambda: Voce(1, np.inf, 1), r"Voce.saturation = inf: not a positive number; give"),
    (lambda: Voce("1", 2, 1), r"Voce.yield_stress = '1': not a positive number; give"),
    (lambda: Swift(1, 0, 0.5), r"Swift.offset = 0: not a positive number; give"),
    (lambda: Swift(1, 0.1, 1.5), r"Swift.exponent = 1.5: .*at most 1; give an exponent from 0"),
    (lambda: Swift(1, 0.1, -0.5), r"Swift.exponent = -0.5: softens.*; give an exponent from 0"),
    (lambda: Table([0, 1, 1], [1, 2, 3]), r"Table.strains\[2\] = 1.0: not above .* 1.0; give"),
    (lambda: Table([0, 2, 1], [1, 2, 3]), r"Table.strains\[2\] = 1.0: not above .* 2.0; give"),
    (lambda: Table([0.1, 1], [1, 2]), r"Table.strains\[0\] = 0.1: not 0; start with the yield"),
    (lambda: Table([0, 1, 2], [1, 3, 2]), r"Table.stresses\[2\] = 2.0: softens.*one before it, 3"),
    (lambda: Table([0, 1], [0, 1]), r"Table.stresses\[0\] = 0.0: not a positive number; give"),
    (lambda: Table([0, 1], [1, np.nan]), r"Table.stresses\[1\] = nan: not a finite number; give"),
    (lambda: Table([0, 1], [1, 2, 3]), r"Table.stresses: 3 stresses at 2 strains; give as many"),
    (lambda: Table([0], [1]), r"Table.strains = \(0.0,\): fewer than two points; give more"),
    (lambda: Table(0, 1), r"Table.strains = 0: not a sequence; give a sequence"),
    (lambda: Table("01", "12"), r"Table.strains = '01': not a sequence; give a sequence"),
]


@pytest.mark.parametrize(("build", "message"), REFUSED, ids=[m for _, m in REFUSED])
def test_bad_input(build, message):
    with pytest.raises(la.InputError, match=message):
        build()


class Own:
    """A law from outside."""

    def __init__(self, stress, modulus):
        self.stress, self.modulus = stress, modulus


@pytest.mark.parametrize(
    ("law", "message"),
    [
        (1.0, "not a hardening law; give"),
        (Voce, "not a hardening law; give"),
        (Own(lambda e: 1 - e / 20, lambda e: 0 * e), "softens"),
        (Own(lambda e: 1 + e, lambda e: 0 * e - 1), "softens"),
        (Own(lambda e: 1 + e, lambda e: 0 * e), "not the slope of the stress: 0 against 1 at a"),
        (Own(lambda e: 1 + e, lambda e: 0 * e + 100), "not the slope of the stress: 100 against 1"),
        (Own(lambda e: e, lambda e: 0 * e + 1), "not positive everywhere"),
        (Own(lambda e: 1.0, lambda e: 0 * e), r"stress: returns shape \(\)"),
        (Own(lambda e: 1 + e, lambda e: 1 / e), "modulus .*not finite at a strain of 0"),
        (Linear(1.0, 1e308), "stress .*not finite at a strain of"),
    ],
)
def test_what_is_no_law(law, message):
    with pytest.raises(la.InputError, match=rf"VonMises.hardening.*{message}"):
        la.VonMises(hardening=law)


def test_a_criterion_has_one_strength():
    for strengths in ({}, {"yield_stress": 1.0, "hardening": Perfect(1.0)}):
        with pytest.raises(la.InputError, match=r"exactly one of .* and hardening; give"):
            la.VonMises(**strengths)


def test_the_law_of_each_strength():
    """Tension is sqrt(3) times shear, to round-off."""
    assert la.VonMises(yield_stress=2.0).law == Perfect(2.0)
    assert la.VonMises(shear_strength=2.0).law.yield_stress == pytest.approx(12**0.5, rel=1e-15)
    law = Voce(3.0, 4.0, 5.0)
    assert la.VonMises(hardening=law).law is law
    assert la.VonMises(hardening=law).k == pytest.approx(3**0.5, rel=1e-15)
    assert la.VonMises(hardening=Own(lambda e: 3 + e, lambda e: 0 * e + 1)).k == pytest.approx(
        3**0.5, rel=1e-15
    )


def test_a_limit_load_takes_the_initial_yield_stress():
    """The same program, so the same number."""

    def pressed(criterion):
        return la.solve(
            la.Problem(
                bodies={"block": la.Body(square().mesh, criterion)},
                supports=[la.Fix("block", "bottom", "y"), la.Fix("block", "left", "x")],
                reference_loads=[la.Traction("block", "top", (0, -1))],
            )
        ).load_factor

    plain = pressed(la.VonMises(yield_stress=2.0))
    assert plain == pytest.approx(4 / 3**0.5, rel=1e-6)
    assert pressed(la.VonMises(hardening=Voce(2.0, 9.0, 5.0))) == pytest.approx(plain, rel=1e-12)
