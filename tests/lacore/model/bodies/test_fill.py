"""Fill on arches and behind walls: resultants against integrals, and walls that it pushes over."""

import numpy as np
import pytest
import shapely

import lacore as la
from lacore.reporting.errors import InputError

GAMMA, K, CROWN = 18e3, 0.4, 2.3
ARCH = la.masonry.arch(20, inner_radius=2.0, thickness=0.3, friction=0.6)
SUMS = 1e-12  # relative: of 20 terms of order one, in double precision


def outer():
    """The outline of the extrados down to the springings."""
    angle = np.linspace(np.pi, 0, 21)
    return shapely.Polygon(CROWN * np.stack([np.cos(angle), np.sin(angle)], axis=1))


@pytest.mark.parametrize("surcharge", [0.0, 5e3])
@pytest.mark.parametrize("level", [1.1, CROWN, 3.0])
def test_the_fill_weighs_what_lies_above_the_extrados_and_presses_against_it(level, surcharge):
    loads = la.masonry.fill("arch", ARCH, GAMMA, level, K, surcharge)
    force = np.array([load.vector for load in loads])
    place = np.array([load.at for load in loads])
    above = shapely.box(-CROWN, 0, CROWN, level) - outer()
    surface = shapely.LineString([(-CROWN, level), (CROWN, level)]) - outer()
    weight = GAMMA * above.area + surcharge * surface.length
    assert -force[:, 1].sum() == pytest.approx(weight, rel=SUMS)
    centroid = GAMMA * above.area * above.centroid.x
    assert force[:, 1] @ place[:, 0] == pytest.approx(-centroid, abs=SUMS * weight * CROWN)

    left, high = place[:, 0] < 0, min(level, CROWN)
    pressed = K * ((GAMMA * level + surcharge) * high - GAMMA * high**2 / 2)
    turned = K * ((GAMMA * level + surcharge) * high**2 / 2 - GAMMA * high**3 / 3)
    assert force[left, 0].sum() == pytest.approx(pressed, rel=SUMS)
    assert force[left, 0] @ place[left, 1] == pytest.approx(turned, rel=SUMS)
    assert force[:, 0].sum() == pytest.approx(0.0, abs=SUMS * pressed)


@pytest.mark.parametrize(("friction", "wide"), [(0.9, 0.5), (0.2, 1.5)])
def test_a_wall_that_fill_pushes_over_or_away(friction, wide):
    """Against the foot: alpha K gamma h^3/6 = W b/2; along it: alpha K gamma h^2/2 = mu W."""
    high, stone = 2.0, 24e3
    wall = la.RigidBlock(la.masonry.rectangle(0, wide, 0, high))
    push = la.masonry.fill("wall", wall, GAMMA, high, K, where=lambda x: x[0] == 0)
    problem = la.Problem(
        bodies={"wall": wall},
        interfaces=[la.Interface(("wall", lambda x: x[1] == 0), la.RigidObstacle(), friction)],
        dead_loads=[la.BodyForce("wall", (0, -stone))],
        reference_loads=push,
    )
    weight = stone * wide * high
    over = weight * wide / 2 / (K * GAMMA * high**3 / 6)
    away = friction * weight / (K * GAMMA * high**2 / 2)
    assert la.solve(problem).load_factor == pytest.approx(min(over, away), rel=1e-6)


def test_a_fluid_presses_along_the_normal():
    """So that forces on a circle pass through its centre, up to where chords differ from it."""
    for load in la.masonry.fill("arch", ARCH, 1e4, 3.0, lateral=1.0):
        name = load.where
        edge = np.flatnonzero(ARCH.edges.block == ARCH.names.index(name))
        cross = np.abs(np.array([-load.vector[1], load.vector[0]]) @ ARCH.edges.normal[:, edge])
        assert cross.min() < SUMS * np.linalg.norm(load.vector)


def test_edges_with_a_joint_bear_no_fill():
    """Of a wall the top: the beds of its courses are joints."""
    wall = la.masonry.running_bond([[1, 1], [0.5, 1, 0.5]], 0.6, block=(1.0, 0.5), base=False)
    loads = la.masonry.fill("wall", wall, GAMMA, level=2.0)
    assert {load.where for load in loads} == {"c2b1", "c2b2", "c2b3"}
    assert sum(load.vector[1] for load in loads) == pytest.approx(-GAMMA * 2.0 * 1.0)


WRONG = {
    "level": ({"level": -1.0}, r"level = -1.0: the fill covers no edge; the lowest .* y = 0 m"),
    "weight": ({"unit_weight": 0.0}, "unit_weight"),
    "lateral": ({"lateral": -0.3}, "lateral"),
    "surcharge": ({"surcharge": np.nan}, "surcharge"),
    "where": ({"where": "21"}, "where = '21': unknown name"),
}


@pytest.mark.parametrize(("given", "told"), WRONG.values(), ids=WRONG)
def test_bad_input(given, told):
    with pytest.raises(InputError, match=told):
        la.masonry.fill(**{"body": "arch", "blocks": ARCH, "unit_weight": 1.0, "level": 3} | given)
