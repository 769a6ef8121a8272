"""The table of couplings agrees with the load factors of a block that slides before it topples."""

import pytest

import lacore as la
from lacore.coupling.kinds import COUPLINGS
from lacore.coupling.options import CouplingOptions

CERTIFIED = 0.4  # friction 0.3, and a tenth of the weight against the push


def sliding_block():
    """A block twice as high as wide, pushed by its weight times the load factor."""
    base, top = [(0, 0), (3, 0), (3, 1), (0, 1)], [(1, 1), (2, 1), (2, 3), (1, 3)]
    return la.Problem(
        bodies={"wall": la.BlockAssembly({"base": base, "top": top}, friction=0.3)},
        supports=[la.Fix("wall", "base")],
        reference_loads=[la.BodyForce("wall", (1, 0), where="top")],
        dead_loads=[la.BodyForce("wall", (-0.1, -1), where="top")],
    )


@pytest.mark.parametrize(
    ("name", "exact", "side"),
    [("certified", CERTIFIED, ""), ("stick", 0.6, "upper"), ("frictionless", 0.1, "lower")],
)
def test_single_solves_bound_the_coulomb_load_factor_on_their_side(name, exact, side):
    state = la.solve(sliding_block(), coupling=name)
    assert state.load_factor == pytest.approx(exact, abs=1e-8)
    assert COUPLINGS[name].bounds == side
    assert (state.rigor is la.Rigor.UPPER) == (side == "upper")
    assert {"": 0, "upper": 1, "lower": -1}[side] * (exact - CERTIFIED) >= 0


@pytest.mark.parametrize(
    ("name", "dilates", "stronger", "weaker"),
    [
        ("certified", False, False, False),  # the given friction: no model
        ("reaction", False, False, False),
        ("shift", False, False, False),
        ("associated", True, True, False),  # T14: above all Coulomb load factors
        ("frictionless", False, False, True),  # below all of them
        ("stick", False, True, False),
        ("davis", True, True, True),  # bounds nothing
    ],
)
def test_a_model_errs_on_the_sides_that_it_does_not_bound(name, dilates, stronger, weaker):
    kind = COUPLINGS[name]
    assert (kind.dilates, kind.may_be_stronger, kind.may_be_weaker) == (dilates, stronger, weaker)


@pytest.mark.parametrize("damping", [0.0, 1.1, -0.5, float("nan"), "0.5", None, True])
def test_a_damping_is_a_share(damping):
    with pytest.raises(la.InputError, match="damping"):
        CouplingOptions(damping=damping)
    assert CouplingOptions(damping=1).damping == 1
