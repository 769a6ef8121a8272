"""Layers of soil as bodies that stick to each other: as one body, with water in them, and on clay.

Bars: 1e-6 is that of the certificate, of both values of a comparison.
"""

from dataclasses import replace
from itertools import pairwise
from math import cos, inf, radians, sin

import pytest

import lacore as la

SAND = la.MohrCoulomb(1.0, friction_angle=30)
CLAY = la.VonMises(10.0)
WEIGHT, WATER = 2.0, 1.0
BOTH = (la.lower_bound, la.upper_bound)


def mesh(low, high):
    """Cells of a quarter of the height of the footing's half width, the same in all layers."""
    cells = round(4 * (high - low))
    return la.meshes.rectangle((0, 6), (low, high), 12, cells, grade_x=(1.0, 4.0))


def ground(layers, friction=la.STICK, weight=WEIGHT, wet=False):
    """A rough footing on layers, the upper one first: names, criteria and lowest heights."""
    names = list(layers)
    bodies, high = {}, 0.0
    for name, (criterion, low) in layers.items():
        bodies[name] = la.Body(mesh(low, high), criterion)
        high = low
    pores = [la.PorePressure(name, la.WaterTable(0.0, WATER)) for name in names]
    return la.Problem(
        bodies=bodies,
        supports=[
            la.Fix(names[-1], "bottom"),
            *(la.Fix(name, side, "x") for name in names for side in ("left", "right")),
        ],
        interfaces=[
            la.Interface((upper, "bottom"), (lower, "top"), friction)
            for upper, lower in pairwise(names)
        ],
        reference_loads=[
            la.RigidFooting(names[0], lambda x: (x[1] == 0) & (x[0] <= 1), (0, -1)),
        ],
        dead_loads=[
            *(la.BodyForce(name, (0, -weight)) for name in names),
            *(pores if wet else []),
        ],
    )


@pytest.mark.parametrize("cohesion", [0.0, 1.0])
def test_sand_that_sticks_to_sand_is_one_body(cohesion):
    """What it carries grows with pressure: its cohesion is no limit of what holds it."""
    sand = la.MohrCoulomb(cohesion, friction_angle=30)
    whole = la.solve(ground({"sand": (sand, -2.0)}))
    layers = la.solve(ground({"sand": (sand, -0.5), "more": (sand, -2.0)}))
    assert layers.load_factor == pytest.approx(whole.load_factor, rel=1e-6)


@pytest.mark.parametrize("cohesion", [0.0, 1.0])
def test_sand_that_sticks_to_clay_slips_where_the_clay_yields(cohesion):
    sand = la.MohrCoulomb(cohesion, friction_angle=30)
    sticks, tresca = (
        la.solve(ground({"sand": (sand, -0.5), "clay": (CLAY, -2.0)}, friction))
        for friction in (la.STICK, la.Tresca(CLAY.strength))
    )
    assert sticks.load_factor == pytest.approx(tresca.load_factor, rel=1e-6)


# sigma_1 (1 + sin(phi)) = 2 c cos(phi) + sigma_3 (1 - sin(phi)) with sigma_3 = -2
TALL = (2 * cos(radians(20)) - 2 * (1 - sin(radians(20)))) / (1 + sin(radians(20)))


@pytest.mark.parametrize(
    ("criterion", "most"),
    [
        (la.MohrCoulomb(1.0, 20, crushing=2.0), (TALL + 2) / 2),
        (la.MohrCoulomb(1.0, 0, tension_cutoff=0.5), 1.0),
        (la.Rankine(0.5, 3.0), 3.5 / 2),
        (la.NoTension(2.0), 2 / 2),
        (la.NoTension(), inf),
        (SAND, inf),
        (la.DruckerPrager(1.0, 20), inf),
    ],
)
def test_the_largest_shear_is_that_of_the_largest_circle(criterion, most):
    """Mohr's, as far as pressure leaves one: from the least to the largest principal stress."""
    assert la.Body(mesh(-1, 0), criterion).largest_shear == pytest.approx(most, rel=1e-12)


@pytest.mark.parametrize("below", [SAND, CLAY], ids=["sand", "clay"])
def test_layers_with_water_are_those_of_buoyant_weight(below):
    """Archimedes, also where one of them touches the other, of the state and of both bounds."""
    layers = {"sand": (SAND, -0.5), "below": (below, -2.0)}
    wet, buoyant = ground(layers, wet=True), ground(layers, weight=WEIGHT - WATER)
    assert la.solve(wet).load_factor == pytest.approx(la.solve(buoyant).load_factor, rel=1e-6)
    bounds = [[find(one).load_factor for one in (wet, buoyant)] for find in BOTH]
    for one, other in bounds:
        assert one == pytest.approx(other, rel=1e-6)
    (lower, _), (upper, _) = bounds
    assert lower < upper


@pytest.mark.parametrize("friction", [0.3, la.Coulomb(0.3, associated=True)])
def test_friction_that_pressure_adds_to_is_refused_beside_water(friction):
    with pytest.raises(la.InputError, match=r"pressure adds to.*STICK"):
        ground({"sand": (SAND, -0.5), "clay": (CLAY, -2.0)}, friction, wet=True)


def test_pressed_sand_is_scaled_to_its_strength_in_floating_point():
    """Without dead loads stresses are scaled: round-off is of the pressure, 1e5 of the cohesion."""
    layers = {"sand": (la.MohrCoulomb(1e-5, friction_angle=30), -0.5), "clay": (CLAY, -2.0)}
    one = ground(layers)
    all_of_it = replace(one, reference_loads=[*one.reference_loads, *one.dead_loads], dead_loads=[])
    assert la.lower_bound(all_of_it).rigor is la.Rigor.LOWER
