"""The problems whose bounds enclose every Coulomb load factor, and what has none."""

import pytest

import lacore as la
from lacore.bounds.enclosing import (
    associated,
    frictionless,
    has_coulomb,
    require_associated_flow,
    with_associated_flow,
)
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from tests.lacore.models import deformable_block, square

ROUGH = la.Coulomb(0.3, adhesion=0.2, tension=0.1)


def standing(*laws):
    """A square on a floor and beside a wall, with a law of each."""
    places = {"bottom": ((0, 0), (0, 1)), "left": ((0, 0), (1, 0))}
    return la.Problem(
        {"b": square()},
        [la.Traction("b", "top", (1, 0))],
        interfaces=[
            la.Interface(("b", where), la.RigidObstacle(*place), law)
            for (where, place), law in zip(places.items(), laws, strict=True)
        ],
        dead_loads=[la.Pressure("b", "top", 1.0)],
    )


@pytest.mark.parametrize(
    ("laws", "coulomb"),
    [
        ((la.SMOOTH, la.Tresca(0.3)), False),
        ((la.SMOOTH, ROUGH), True),
        ((ROUGH, la.SMOOTH), True),
        ((ROUGH, ROUGH), True),
        ((la.Coulomb(0.3, associated=True), la.SMOOTH), False),
        ((la.Coulomb(0.0), la.SMOOTH), False),
    ],
)
def test_one_interface_with_coulomb_friction_is_enough(laws, coulomb):
    problem = standing(*laws)
    assert has_coulomb(problem) == coulomb
    assert (frictionless(problem) is problem) == (not coulomb)
    assert (associated(problem) is problem) == (not coulomb)
    for other in (frictionless(problem), associated(problem)):
        assert not has_coulomb(other)


def test_joints_of_blocks_count_as_well():
    stones = {"a": la.masonry.rectangle(0, 1, 0, 1), "b": la.masonry.rectangle(0, 1, 1, 2)}
    for law, coulomb in ((la.Tresca(0.3), False), (0.3, True)):
        problem = la.Problem(
            {"b": la.BlockAssembly(stones, law)},
            [la.BodyForce("b", (1, 0))],
            [la.Fix("b", "a")],
            dead_loads=[la.BodyForce("b", (0, -1))],
        )
        assert has_coulomb(problem) == coulomb


def test_what_is_left_of_a_law_lies_within_it_and_the_law_within_what_it_becomes():
    """Shear stresses that are carried, at any pressure: below, and with dilation as much."""
    problem = standing(ROUGH, la.Tresca(0.4))
    (below, kept), (above, same) = (
        [pair.law for pair in other.interfaces]
        for other in (frictionless(problem), associated(problem))
    )
    assert kept == same == la.Tresca(0.4)
    assert below.terms().within(ROUGH.terms())
    assert below.terms().limit == pytest.approx(0.2 - 0.3 * 0.1)
    assert above == la.Coulomb(0.3, associated=True, adhesion=0.2, tension=0.1)


def test_load_factors_of_both_enclose_that_of_the_problem():
    """A block of 4 m slides at (0.3 p + 0.1) 4, with p = 1; without friction at 0.1 x 4."""
    problem = deformable_block(la.Coulomb(0.3, adhesion=0.1))
    low, high = (la.solve(make(problem)).load_factor for make in (frictionless, associated))
    assert (low, high) == pytest.approx((0.4, 1.6), rel=1e-5)
    assert la.solve(problem).load_factor == pytest.approx(1.6, rel=1e-5)


@pytest.mark.parametrize("regions", [False, True])
def test_flow_is_made_associated_and_strength_stays(regions):
    soil, clay = la.MohrCoulomb(1.0, 30, dilation_angle=5), la.VonMises(1.0)
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2).with_subdomains(
        {"low": lambda x: x[1] < 0.5, "high": lambda x: x[1] > 0.5}
    )
    given = {"low": soil, "high": clay} if regions else soil
    problem = la.Problem(
        {"b": la.Body(mesh, given)}, [la.Traction("b", "top", (1, 0))], [la.Fix("b", "bottom")]
    )
    with pytest.raises(la.InputError, match="not associated"):
        require_associated_flow(of_kind(problem.bodies, Body))
    other = with_associated_flow(problem)
    require_associated_flow(of_kind(other.bodies, Body))
    normal = la.MohrCoulomb(1.0, 30)
    expected = {"low": normal, "high": clay} if regions else normal
    assert other.bodies["b"].criterion == expected
    for bound in (la.lower_bound, la.upper_bound):
        with pytest.raises(la.InputError, match="not associated"):
            bound(problem)
