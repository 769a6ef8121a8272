"""Rigid bodies that are bonded move as one, whatever acts on them."""

import numpy as np
import pytest

import lacore as la

SAME = 1e-8  # relative: solves to 1e-9 of programs in other unknowns
FLOOR = la.RigidObstacle((0, 0), (0, 1))


def at(height):
    return lambda x: np.abs(x[1] - height) < 1e-9


def block(low, high, width=1.0):
    return la.RigidBlock([(0, low), (width, low), (width, high), (0, high)])


def pushed(bodies, interfaces, supports=(), **options):
    """Under their own weight, pushed to the right in proportion."""
    return la.solve(
        la.Problem(
            bodies,
            [la.BodyForce(name, (1, 0)) for name in bodies],
            supports,
            interfaces,
            [la.BodyForce(name, (0, -1)) for name in bodies],
        ),
        **options,
    )


def bond(upper, lower, height):
    return la.Interface((upper, at(height)), (lower, at(height)), la.BOND)


@pytest.mark.parametrize("backend", ["highs", "clarabel"])
@pytest.mark.parametrize("names", [("a", "b", "c"), ("c", "a", "b")])
@pytest.mark.parametrize(("mu", "exact"), [(0.2, 0.2), (0.9, 1 / 3)])
def test_a_pier_of_bonded_blocks_is_one_block(mu, exact, names, backend):
    """Slides at mu, or topples at width/height."""
    levels = {"a": (0, 1), "b": (1, 2), "c": (2, 3)}
    bodies = {name: block(*levels[name]) for name in names}
    rests = la.Interface(("a", at(0)), FLOOR, mu)
    state = pushed(bodies, [rests, bond("b", "a", 1), bond("c", "b", 2)], backend=backend)
    assert state.load_factor == pytest.approx(exact, rel=SAME)
    turning = {float(np.round(own[2, 0], 7)) for own in state.velocity.values()}
    assert len(turning) == 1
    u, v, omega = state.velocity["a"][:, 0]
    moved = state.velocity["c"][:, 0]
    assert moved == pytest.approx([u - 2 * omega, v, omega], abs=1e-7)


def test_unbonded_blocks_are_weaker():
    bodies = {"a": block(0, 1), "b": block(1, 2)}
    rests = la.Interface(("a", at(0)), FLOOR, 0.9)
    rubs = la.Interface(("b", at(1)), ("a", at(1)), 0.1)
    assert pushed(bodies, [rests, rubs]).load_factor == pytest.approx(0.1, rel=SAME)


def test_a_bond_to_an_obstacle_holds_a_block():
    """Its support bears what stands on it: weight, push, and their moment about the centroid."""
    bodies = {"a": block(0, 1), "b": block(1, 2), "c": block(2, 3)}
    foot = la.Interface(("a", at(0)), FLOOR, la.BOND)
    rubs = la.Interface(("c", at(2)), ("b", at(2)), 0.3)
    state = pushed(bodies, [foot, bond("b", "a", 1), rubs])
    assert state.load_factor == pytest.approx(0.3, rel=SAME)
    (row,) = state.support_reactions.to_dict("records")
    assert row["body"] == "a"
    # Pushes of 0.3 at heights 0, 1, 2 over the centroid of the lowest one.
    expected = {"force_x": -0.9, "force_y": 3.0, "moment": 0.3 * (0 + 1 + 2)}
    assert {name: row[name] for name in expected} == pytest.approx(expected, rel=1e-6)
    fixed = pushed(bodies, [bond("b", "a", 1), rubs], [la.Fix("a", at(0))])
    assert fixed.support_reactions["force_y"].item() == pytest.approx(3.0, rel=1e-6)


def test_supports_of_both_sides_hold_both():
    """A ring of bonds and supports says some things twice: nothing moves but what may."""
    bodies = {"a": block(0, 1), "b": block(1, 2), "c": block(2, 3)}
    bonds = [bond("b", "a", 1), bond("c", "b", 2)]
    held = [la.Fix("a", at(0), "y"), la.Fix("c", at(3), "y")]
    wall = la.RigidObstacle((1, 0), (-1, 0))
    rubs = la.Interface(("b", lambda x: x[0] > 1 - 1e-9), wall, la.Tresca(0.5))
    for way, status in ((-1, la.Status.FREE), (1, la.Status.LOCKED)):
        push = [la.BodyForce("b", (way, 0))]
        assert la.solve(la.Problem(bodies, push, held, [*bonds, rubs])).status is status


@pytest.mark.parametrize("top", ["one", "two"])
def test_bounds_of_clay_under_bonded_blocks(top):
    """A footing in two parts that are bonded, on clay, is the footing in one."""
    clay = la.Body(la.meshes.rectangle((0, 2), (-1, 0), 8, 4), la.VonMises(shear_strength=1.0))

    def under(x):
        return (x[0] <= 0.5 + 1e-9) & (x[1] > -1e-9)

    bodies = {"foot": block(0, 0.2, 0.5), "stem": block(0.2, 0.4, 0.5)}
    bonds = [la.Interface(("clay", under), ("foot", at(0)), la.BOND), bond("stem", "foot", 0.2)]
    if top == "one":
        bodies, bonds = {"foot": block(0, 0.4, 0.5)}, bonds[:1]
    last = list(bodies)[-1]
    problem = la.Problem(
        {"clay": clay, **bodies},
        [la.Pressure(last, at(0.4), 1.0)],
        [
            la.Fix("clay", "right"),
            la.Fix("clay", "bottom"),
            la.Fix("clay", "left", "x"),
            la.Fix("foot", lambda x: x[0] < 1e-9, "x"),
        ],
        bonds,
    )
    lower, upper = la.lower_bound(problem), la.upper_bound(problem)
    assert (lower.rigor, upper.rigor) == (la.Rigor.LOWER, la.Rigor.UPPER)
    assert lower.load_factor == pytest.approx(4.9, abs=0.3)
    identity = la.gap_identity(upper, lower)
    gap = upper.load_factor - lower.load_factor
    assert identity.total == pytest.approx(gap, rel=1e-8)
