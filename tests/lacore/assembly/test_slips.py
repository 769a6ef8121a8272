"""Bodies slip past supports and rough footings where other conditions meet them (T23)."""

from dataclasses import replace
from math import asin, cos

import numpy as np
import pytest
from scipy.optimize import brentq
from skfem import MeshTri

import lacore as la
from lacore.bounds.bracket.marking import upper_shares
from tests.lacore.models import CRITERION, obstacle, punch
from tests.shares import one_in

SPACES = ("p2-vertex", "p2-gauss", "p2-disc", "p1-disc")
SOLVED = 1e-6  # tolerance of `solve`, of load factors of order one
ROUND_OFF = 1e-9  # of sums over some hundred elements, of bounds that are projected


def sheared(space="p2-vertex", n=6, kinematics="plane_strain", angle=0.0):
    """A square under a rough footing that pushes it against a smooth wall; held below. Exact: 1.

    The wall takes all of the load but what the footing can drag along: k on all its length. With
    less the stress is that of a shear along the top and a pressure against the wall.
    """
    mesh = la.meshes.rectangle((0, 1), (0, 1), n, n)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    mesh = MeshTri(turn @ mesh.p, mesh.t).with_boundaries(mesh.boundaries)
    return la.Problem(
        {"block": la.Body(mesh, CRITERION, space=space, kinematics=kinematics)},
        [la.RigidFooting("block", "top", tuple(turn[:, 0]))],
        [la.Fix("block", "bottom")],
        [obstacle("right", la.SMOOTH)],
    )


def passive(n=3, space="p2-vertex"):
    """A smooth wall, as a footing, pushes soil on a rough base. Exact: 2, by Rankine's wedge."""
    mesh = la.meshes.rectangle((0, 2), (0, 1), 2 * n, n)
    return la.Problem(
        {"soil": la.Body(mesh, CRITERION, space=space)},
        [la.RigidFooting("soil", "left", (1, 0), rough=False)],
        [la.Fix("soil", "bottom"), la.Fix("soil", "right")],
    )


def pushed(mu, n=3, space="p2-vertex"):
    """The same by a rigid wall that is guided, with associated friction."""
    mesh = la.meshes.rectangle((0, 3), (0, 1), 3 * n, n)
    wall = la.BlockAssembly({"wall": la.masonry.rectangle(-0.5, 0, 0, 1)}, friction=0.0)
    law = la.Coulomb(mu, associated=True)
    return la.Problem(
        {"soil": la.Body(mesh, CRITERION, space=space), "wall": wall},
        [la.PointForce("wall", "wall", (1, 0))],
        [la.Fix("soil", "bottom"), la.Fix("soil", "right"), la.Fix("wall", "wall", "y")],
        [la.Interface(("soil", "left"), ("wall", "wall"), law)],
    )


def passive_pressure(mu):
    """Of weightless soil on a wall with friction, per k, by slip lines: 1 + d + cos d.

    The fan below the free surface turns by d/2, with sin d the shear on the wall, mu times that.
    """
    if mu == 0:
        return 2.0
    return brentq(lambda p: 1 + asin(mu * p) + cos(asin(mu * p)) - p, 2.0, 1 / mu)


@pytest.mark.parametrize("space", one_in(2, SPACES))
def test_block_between_a_rough_footing_and_a_wall(space):
    """Locked on every mesh while the footing held the block at their corner."""
    state = la.solve(sheared(space), throw=True)
    assert state.load_factor == pytest.approx(1.0, abs=SOLVED)
    bound = la.upper_bound(state)
    assert bound.rigor is la.Rigor.UPPER
    assert bound.load_factor == pytest.approx(1.0, abs=SOLVED)
    assert bound.load_factor >= 1 - ROUND_OFF


def test_each_body_slips_past_its_own_footing():
    """Of two such squares apart from each other, under one load each, the weaker one yields."""
    one = sheared(n=2)
    weak, strong = one.bodies["block"], la.Body(one.bodies["block"].mesh, la.VonMises(5.0))
    both = la.Problem(
        {"strong": strong, "weak": weak},
        [la.RigidFooting(name, "top", (1, 0)) for name in ("strong", "weak")],
        [la.Fix(name, "bottom") for name in ("strong", "weak")],
        [
            la.Interface((name, "right"), la.RigidObstacle(), la.SMOOTH)
            for name in ("strong", "weak")
        ],
    )
    assert la.solve(both).load_factor == pytest.approx(1.0, abs=SOLVED)


def test_a_bracket_closes_on_it():
    found = la.bracket(sheared(n=4), 0.01)
    assert found.status is la.Ending.REACHED
    assert found.strict
    assert found.lower - ROUND_OFF <= 1 <= found.upper + ROUND_OFF
    assert not found.failure


def test_a_body_shears_off_its_support():
    """A rough footing presses down a square that is held at one side: k on all of that side."""
    pressed = replace(
        sheared(),
        reference_loads=[la.RigidFooting("block", "top", (0, -1))],
        supports=[la.Fix("block", "left")],
        interfaces=[],
    )
    assert la.upper_bound(pressed).load_factor == pytest.approx(1.0, abs=SOLVED)
    assert la.lower_bound(pressed).load_factor == pytest.approx(1.0, abs=SOLVED)


def test_two_footings_that_share_a_corner():
    """One pushes, the other is a press at rest: the pusher slides along it, at k."""
    two = replace(
        sheared(),
        reference_loads=[la.RigidFooting("block", "left", (1, 0), rough=False)],
        dead_loads=[la.RigidFooting("block", "top", (0, -1), 0.3)],
    )
    upper, lower = la.upper_bound(two), la.lower_bound(two)
    assert upper.status is la.Status.SOLVED
    assert lower.load_factor <= upper.load_factor + ROUND_OFF


@pytest.mark.parametrize("space", ["p2-disc", "p1-disc"])
def test_passive_wall_on_an_aligned_mesh(space):
    """The slip line at 45 degrees from the corner of wall and base lies on element edges."""
    assert la.solve(passive(2, space)).load_factor == pytest.approx(2.0, abs=SOLVED)


def test_bracket_of_a_passive_wall():
    found = la.bracket(passive(), 0.04)
    assert found.status is la.Ending.REACHED
    assert found.strict
    assert found.lower <= 2 <= found.upper


@pytest.mark.parametrize("mu", [0.0, 0.2])
def test_passive_wall_with_friction(mu):
    """From above, and closer on finer meshes: N^-0.4 and better, as of all uniform ones (T26)."""
    exact = passive_pressure(mu)
    errors = [la.upper_bound(pushed(mu, n)).load_factor / exact - 1 for n in (2, 4)]
    assert 0 < errors[1] < 2**-0.4 * errors[0]
    assert errors[1] < 0.05


@pytest.mark.parametrize("mu", one_in(2, [0.0, 0.2]))
def test_brackets_of_a_passive_wall_with_friction(mu):
    found = la.bracket(pushed(mu), 0.025)
    assert found.status is la.Ending.REACHED
    assert found.strict
    assert found.lower <= passive_pressure(mu) <= found.upper
    gaps = found.gaps()
    assert gaps.total == pytest.approx(gaps.upper - gaps.lower, abs=ROUND_OFF)


def test_the_passive_pressure_by_slip_lines():
    """To the digits that are given: 2.375 for a friction of 0.2."""
    assert passive_pressure(0.2) == pytest.approx(2.375, abs=5e-4)


def on_a_base_that_sticks(space="p2-vertex", n=3):
    """The passive wall on STICK in place of a support."""
    stated = passive(n, space)
    base = la.Interface(("soil", "bottom"), la.RigidObstacle(), la.STICK)
    return replace(stated, supports=stated.supports[1:], interfaces=[base])


@pytest.mark.parametrize("space", one_in(2, SPACES))
def test_passive_wall_on_a_base_that_sticks(space):
    """The same in the continuum, but that the soil may lift off the base: nothing lifts it."""
    stated = on_a_base_that_sticks(space)
    upper, lower = la.upper_bound(stated), la.lower_bound(stated)
    held = la.upper_bound(passive(3, space))
    assert upper.load_factor >= 2 - ROUND_OFF
    assert upper.state.load_factor <= held.state.load_factor + SOLVED  # it holds all velocities
    assert lower.load_factor == pytest.approx(2.0, abs=SOLVED)
    identity = la.gap_identity(upper, lower)
    assert identity.total == pytest.approx(identity.upper - identity.lower, abs=ROUND_OFF)
    assert identity.least >= -ROUND_OFF


def test_what_sticks_beside_things_at_rest_sticks():
    """Supports and obstacles at rest leave all velocities that vanish at the corner."""
    stated = replace(on_a_base_that_sticks(), reference_loads=[la.BodyForce("soil", (1, 0))])
    assert np.isinf(la.discretise(stated).full.contact.limit).all()
    assert not np.isinf(la.discretise(on_a_base_that_sticks()).full.contact.limit).any()
    quadrilaterals = la.Body(la.meshes.quadrilaterals((0, 2), (0, 1), 4, 2), CRITERION, space="q2")
    kept = la.discretise(replace(on_a_base_that_sticks(), bodies={"soil": quadrilaterals}))
    assert np.isinf(kept.full.contact.limit).all()


# What the jump is.


@pytest.mark.parametrize("space", SPACES)
def test_slip_costs_the_strength_of_the_body(space):
    """A square that moves as a whole along its support: k times length times speed."""
    d = la.discretise(sheared(space))
    u, dofs = np.zeros(d.full.n), d.continua["block"]
    u[dofs.dofs[0]] = -2.0
    (power,) = (part.group.dissipation(u).sum() for part in d.jumps.values())
    assert power == pytest.approx(4.0, rel=ROUND_OFF)  # along base and footing
    u[d.footings] = -2.0
    (power,) = (part.group.dissipation(u).sum() for part in d.jumps.values())
    assert power == pytest.approx(2.0, rel=ROUND_OFF)


@pytest.mark.parametrize("space", SPACES)
def test_nothing_leaves_what_holds_it(space):
    """Only the slip is free: normal velocities are those of the base and of the footing."""
    d = la.discretise(sheared(space))
    u = d.free_basis @ np.random.default_rng(0).normal(size=d.program.n)
    dofs = d.continua["block"]
    flat = np.unique(dofs.facet_nodes(dofs.body.mesh.boundaries["bottom"]))
    top = np.unique(dofs.facet_nodes(dofs.body.mesh.boundaries["top"]))
    assert not u[dofs.dofs[1, flat]].any()
    assert not u[dofs.dofs[1, top]].any()
    assert np.abs(u[dofs.dofs[0, flat]]).min() > 0
    assert d.held_nodes.sum() == flat.size + top.size


@pytest.mark.parametrize("kinematics", ["plane_strain", "plane_stress"])
@pytest.mark.parametrize("space", one_in(2, SPACES))
@pytest.mark.parametrize("make", [sheared, passive])
def test_gap_identity(make, space, kinematics):
    """Slip has its whole share: virtual power with the velocity of what holds the boundary."""
    stated = make(space=space)
    bodies = {n: replace(b, kinematics=kinematics) for n, b in stated.bodies.items()}
    upper = la.upper_bound(replace(stated, bodies=bodies))
    identity = la.gap_identity(upper, la.lower_bound(replace(stated, bodies=bodies)))
    assert identity.total == pytest.approx(identity.upper - identity.lower, abs=ROUND_OFF)
    assert identity.least >= -ROUND_OFF


def test_slip_that_one_stress_explains_is_not_refined():
    """All power of the block is slip, and none of it is an error; of the wall's corner it is."""
    block = la.upper_bound(sheared())
    assert block.dissipation["block"].sum() == pytest.approx(1.0, abs=SOLVED)
    assert np.abs(upper_shares(block, "block")).max() < SOLVED
    wall = la.upper_bound(passive())
    shares, gap = upper_shares(wall, "soil"), wall.load_factor - 2.0
    assert shares.min() >= -ROUND_OFF
    assert 0.1 * gap < shares.sum() <= gap + ROUND_OFF


def test_layers_of_slip_are_strain():
    """From a base at rest to a footing at speed 3 all shear makes 3, wherever it is."""
    d = la.discretise(sheared())
    dofs, slip, u = d.continua["block"], d.slips["block"], np.zeros(d.full.n)
    u[dofs.dofs[0]] = 1 + dofs.nodes[1]  # a shear of 1 in the body
    u[d.footings] = 3.0
    assert np.allclose(slip.layer(dofs, u).sum(axis=0), [0, 0, 2], atol=ROUND_OFF)


@pytest.mark.parametrize("space", SPACES)
def test_reactions_hold_the_balance(space):
    """Supports and footing pull by shear too: with the wall's pressure all forces cancel."""
    state = la.solve(sheared(space), throw=True)
    held, contact = state.support_reactions, state.reactions
    pressure = float((contact["length"] * contact["t_n"]).sum())
    assert held["force_x"].sum() == pytest.approx(pressure, abs=SOLVED)
    assert held["force_y"].sum() == pytest.approx(0.0, abs=SOLVED)
    x, y = held["x"], held["y"]
    moment = float((x * held["force_y"] - y * held["force_x"]).sum())
    pressed = float((contact["y"] * contact["length"] * contact["t_n"]).sum())
    assert moment + pressed == pytest.approx(0.0, abs=SOLVED)
    top = held[held["y"] == 1.0]
    assert top["force_x"].sum() == pytest.approx(state.load_factor, abs=SOLVED)


def test_turned_problems_have_the_same_value():
    for make in (sheared, lambda angle: replace(sheared(angle=angle), interfaces=[])):
        straight, turned = (la.solve(make(angle=a), throw=True) for a in (0.0, 0.7))
        assert turned.load_factor == pytest.approx(straight.load_factor, abs=SOLVED)


# Where it is.


@pytest.mark.parametrize("space", SPACES)
def test_what_nothing_meets_does_not_slip(space):
    """A footing beside a plane of symmetry, supports beside supports: nothing contradicts."""
    d = la.discretise(punch(space=space))
    assert not d.slips
    assert bool(d.jumps) == space.endswith("disc")


def test_it_ends_where_contact_goes_on_straight():
    """There friction needs the normal reaction, which the support would take."""
    mesh = la.meshes.rectangle((0, 2), (0, 1), 4, 2)
    stated = la.Problem(
        {"block": la.Body(mesh, CRITERION)},
        [la.RigidFooting("block", "left", (1, 0), rough=False)],
        [la.Fix("block", lambda x: (x[1] == 0) & (x[0] <= 1))],
        [obstacle(lambda x: (x[1] == 0) & (x[0] >= 1), 0.3)],
        dead_loads=[la.Pressure("block", "top", 0.1)],
    )
    d = la.discretise(stated)
    slip = d.slips["block"]
    ends = d.continua["block"].body.mesh.p[:, d.continua["block"].body.mesh.facets[:, slip.facets]]
    assert np.array_equal(slip.stuck, ends[0] == 1.0)
    assert la.solve(d).status is la.Status.SOLVED


def test_supports_of_one_component_slip_where_it_is_the_tangential_one():
    stated = replace(
        sheared(),
        supports=[la.Fix("block", "bottom", "x"), la.Fix("block", "bottom", "y")],
    )
    whole, parts = la.solve(sheared()), la.solve(stated)
    assert parts.load_factor == pytest.approx(whole.load_factor, abs=SOLVED)
    d = la.discretise(replace(stated, supports=stated.supports[:1]))
    base = d.slips["block"].normal[1] == -1.0
    assert base.any()
    assert not d.slips["block"].holds_normal[base].any()
    d = la.discretise(replace(stated, supports=stated.supports[1:]))
    assert not (d.slips["block"].normal[1] == -1.0).any()


def test_curved_and_quadrilateral_bodies_say_of_what_they_are_locked():
    """They have discrete values only, and stick as before: the word is about the mesh."""
    mesh = la.meshes.quadrilaterals((0, 1), (0, 1), 2, 2)
    stated = replace(sheared(), bodies={"block": la.Body(mesh, CRITERION, space="q2")})
    state = la.solve(stated)
    assert state.status is la.Status.LOCKED
    assert "of the discrete problem" in state.message
    assert la.lower_bound(sheared()).load_factor == pytest.approx(1.0, abs=SOLVED)


def test_a_bracket_says_that_its_upper_side_is_locked():
    """One triangle, held at two sides and dragged along the third: too few to flow."""
    mesh = MeshTri(np.array([[0.0, 1.0, 0.5], [0.0, 0.0, -1.0]]), np.array([[0], [1], [2]]))
    mesh = mesh.with_boundaries(
        {"top": lambda x: x[1] == 0, "sides": lambda x: x[1] < 0}, boundaries_only=True
    )
    stated = la.Problem(
        {"block": la.Body(mesh, CRITERION)},
        [la.Traction("block", "top", (1, 0))],
        [la.Fix("block", "sides")],
    )
    found = la.bracket(stated, 0.01, max_elements=1)
    assert found.upper == np.inf
    assert "upper bound: locked" in found.failure
    assert "of the discrete problem" in found.failure


def test_files_and_pictures_take_it(tmp_path):
    state = la.solve(sheared(), throw=True)
    state.to_vtu(tmp_path / "block.vtu")
    assert state.dissipation["block"].max() > 0
    state.plot()


def test_soil_that_dilates_does_not_slip_past_what_holds_it():
    """Slip without opening costs less than any flow of soil: no bound would be left of it."""
    clay = sheared(n=2)
    assert la.discretise(clay).slips
    soil = replace(clay.bodies["block"], criterion=la.MohrCoulomb(1.0, 30))
    assert not la.discretise(replace(clay, bodies={"block": soil})).slips
