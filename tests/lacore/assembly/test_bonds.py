"""Bonds: a body that is cut and bonded is the uncut one; what cannot be tied parts at a cost."""

import numpy as np
import pytest

import lacore as la
from tests.lacore.models import CRITERION

X, Y = (0.0, 2.0), (-1.0, 0.0)
SAME = 1e-8  # relative: two solves to 1e-9 of programs that differ in the order of unknowns
SPACES = ("p2-vertex", "p2-gauss", "p2-disc", "p1-disc", "p1", "q2")


def under(x):
    return (x[0] <= 0.5) & (x[1] > -1e-9)


def layer(x, y, nx, ny, space="p2-vertex", criterion=CRITERION):
    quadrilaterals = space == "q2"
    make = la.meshes.quadrilaterals if quadrilaterals else la.meshes.rectangle
    return la.Body(make(x, y, nx, ny), criterion, space=space)


def ground(bodies, interfaces=(), rough=True, footing=None):
    """Half of a strip footing of width 1 on ground 1 deep and 2 wide, in one part or more."""
    first = next(iter(bodies))
    held = [la.Fix(name, where) for name in bodies for where in ("right", "bottom", "left")]
    free = {(a, b) for one in interfaces for a, b in one.sides}
    return la.Problem(
        bodies,
        [footing or la.RigidFooting(first, under, (0, -1), rough=rough)],
        [
            la.Fix(own.body, own.where, "x" if own.where == "left" else "xy")
            for own in held
            if (own.body, own.where) not in free
        ],
        interfaces,
    )


def whole(space="p2-vertex", criterion=CRITERION, nx=8, ny=4):
    return ground({"clay": layer(X, Y, nx, ny, space, criterion)})


def cut_flat(space="p2-vertex", criterion=CRITERION, friction=la.BOND, nx=8, below=None):
    """In two at half the depth; below the mesh of `whole`, or another one."""
    nx_below, ny_below = below or (nx, nx // 4)
    bodies = {
        "top": layer(X, (-0.5, 0.0), nx, nx // 4, space, criterion),
        "low": layer(X, (-1.0, -0.5), nx_below, ny_below, space, criterion),
    }
    return ground(bodies, [la.Interface(("top", "bottom"), ("low", "top"), friction)])


def cut_upright(space="p2-vertex", criterion=CRITERION):
    """In two beside the footing, which then ends at a bond."""
    bodies = {
        "under": layer((0.0, 0.5), Y, 2, 4, space, criterion),
        "beside": layer((0.5, 2.0), Y, 6, 4, space, criterion),
    }
    return ground(bodies, [la.Interface(("beside", "left"), ("under", "right"), la.BOND)])


@pytest.mark.parametrize("cut", [cut_flat, cut_upright])
@pytest.mark.parametrize("space", SPACES)
def test_a_body_cut_by_a_bond_is_the_uncut_one(space, cut):
    uncut = la.solve(whole(space))
    parts = la.solve(cut(space))
    assert uncut.status is la.Status.SOLVED
    assert parts.load_factor == pytest.approx(uncut.load_factor, rel=SAME)
    assert parts.rigor is uncut.rigor


@pytest.mark.parametrize("criterion", [CRITERION, la.MohrCoulomb(1.0, 20.0)])
def test_a_bond_may_lie_anywhere(criterion):
    """At each row, and at each column that does not end below the footing."""
    uncut = la.solve(whole(criterion=criterion)).load_factor

    def part(x, y):
        return layer(x, y, round(4 * (x[1] - x[0])), round(4 * (y[1] - y[0])), criterion=criterion)

    for y in (-0.75, -0.5, -0.25):
        bodies = {"top": part(X, (y, 0.0)), "low": part(X, (-1.0, y))}
        bond = la.Interface(("top", "bottom"), ("low", "top"), la.BOND)
        assert la.solve(ground(bodies, [bond])).load_factor == pytest.approx(uncut, rel=SAME)
    for x in (0.5, 0.75, 1.0, 1.25, 1.5, 1.75):
        bodies = {"under": part((0.0, x), Y), "beside": part((x, 2.0), Y)}
        bond = la.Interface(("beside", "left"), ("under", "right"), la.BOND)
        assert la.solve(ground(bodies, [bond])).load_factor == pytest.approx(uncut, rel=SAME)


def test_four_parts_that_meet_in_one_point_are_one():
    """Where three bonds tie the four nodes at a point, the fourth says nothing new."""
    places = {"a": (0.0, 0.5), "b": (0.5, 2.0)}
    depths = {"top": (-0.5, 0.0), "low": (-1.0, -0.5)}
    bodies = {
        f"{level} {side}": layer(x, y, round(4 * (x[1] - x[0])), 2)
        for level, y in depths.items()
        for side, x in places.items()
    }
    pairs = [
        *((f"{level} b", "left", f"{level} a", "right") for level in depths),
        *((f"top {side}", "bottom", f"low {side}", "top") for side in places),
    ]
    bonds = [la.Interface((a, at), (b, to), la.BOND) for a, at, b, to in pairs]
    parts, uncut = la.solve(ground(bodies, bonds)), la.solve(whole())
    assert parts.load_factor == pytest.approx(uncut.load_factor, rel=SAME)


@pytest.mark.parametrize("criterion", [CRITERION, la.MohrCoulomb(1.0, 20.0)])
def test_edges_that_do_not_match_part_at_a_cost(criterion):
    """Finer edges on one side: a strict bound, in line with those of one mesh."""
    parts = la.solve(cut_flat(criterion=criterion, below=(11, 3)))
    below = la.lower_bound(whole(criterion=criterion)).load_factor
    above = la.solve(whole(criterion=criterion)).load_factor
    assert parts.rigor is la.Rigor.UPPER
    # Nodes of the one side that fall between those of the other stiffen a mesh, here of few
    # elements: its error stays that of the uncut mesh, twice over.
    assert below <= parts.load_factor <= above + (above - below)


def test_sticking_opens_and_bonds_do_not():
    """A bar in tension, cut across: 2 k of plane strain, or nothing."""
    halves = {"left": layer((0, 1), (0, 1), 2, 2), "right": layer((1, 2), (0, 1), 2, 2)}

    def pulled(friction):
        return la.solve(
            la.Problem(
                halves,
                [la.Traction("right", "right", (1, 0))],
                [la.Fix("left", "left")],
                [la.Interface(("right", "left"), ("left", "right"), friction)],
            )
        )

    bonded, stuck = pulled(la.BOND), pulled(la.STICK)
    assert bonded.load_factor == pytest.approx(2.0, rel=1e-6)
    assert stuck.status is la.Status.FREE
    assert "lacore.BOND" in stuck.message


def test_a_bond_to_an_obstacle_is_a_support():
    held = whole()
    (bottom,) = (own for own in held.supports if own.where == "bottom")
    rest = [own for own in held.supports if own is not bottom]
    bond = la.Interface(("clay", "bottom"), la.RigidObstacle(), la.BOND)
    bonded = la.Problem(held.bodies, held.reference_loads, rest, [bond])
    one, other = la.solve(held), la.solve(bonded)
    assert other.load_factor == pytest.approx(one.load_factor, rel=SAME)
    forces = other.support_reactions[["force_x", "force_y"]].sum()
    assert forces["force_y"] == pytest.approx(0.0, abs=1e-6)  # the footing is held, too


def bonded_block(direction, criterion=CRITERION, nx=8):
    """A block of the size of the footing, bonded to the ground, that does not turn."""
    block = la.BlockAssembly({"foot": [(0, 0), (0.5, 0), (0.5, 0.2), (0, 0.2)]}, friction=la.SMOOTH)
    clay = layer(X, Y, nx, nx // 2, criterion=criterion)
    side = la.Interface(("clay", under), ("foot", lambda x: x[1] < 1e-9), la.BOND)
    load = la.BodyForce("foot", (0, direction / (0.5 * 0.2)))
    held = [la.Fix("clay", "right"), la.Fix("clay", "bottom"), la.Fix("clay", "left", "x")]
    held.append(la.Fix("foot", lambda x: x[0] < 1e-9, "x"))
    return la.Problem({"clay": clay, "foot": block}, [load], held, [side])


def test_a_bonded_block_pulls_as_hard_as_it_presses():
    down, up = (la.solve(bonded_block(direction)) for direction in (-1, 1))
    assert up.load_factor == pytest.approx(down.load_factor, rel=1e-6)
    footing = la.solve(whole())  # of mean pressure; velocities that may jump cost no more
    assert down.load_factor <= 0.5 * footing.load_factor * (1 + SAME)
    assert down.load_factor == pytest.approx(0.5 * footing.load_factor, rel=0.01)


def test_a_bond_to_soil_breaks_by_its_tension():
    """Pulled up, a soil with friction carries next to its cohesion only; pressed down, far more."""
    soil = la.MohrCoulomb(1.0, 20.0)
    down, up = (la.solve(bonded_block(direction, soil)) for direction in (-1, 1))
    lower = la.lower_bound(bonded_block(1, soil))
    assert lower.load_factor <= up.load_factor < 0.5 * down.load_factor


@pytest.mark.parametrize("below", [2, 3])
def test_the_weaker_side_yields(below):
    """A strong body on a weak one, whose edges match or do not: the seam shears at the weaker k."""
    bodies = {
        "top": layer((0, 1), (0, 1), 2, 2, criterion=la.VonMises(shear_strength=5.0)),
        "low": layer((0, 1), (-1, 0), below, below),
    }
    pushed = [la.Traction("top", side, (1, 0)) for side in ("left", "right")]
    bond = la.Interface(("top", "bottom"), ("low", "top"), la.BOND)
    weight = [la.Pressure("top", "top", 2.0)]
    problem = la.Problem(bodies, pushed, [la.Fix("low", "bottom")], [bond], weight)
    # Shear k = 1 over a length of 1 against tractions on two sides of length 1, unless the low
    # body turns over before.
    assert la.solve(problem).load_factor <= 0.5 + 1e-6


@pytest.mark.parametrize("space", ["p2-vertex", "p2-disc", "p1-disc"])
def test_lower_bounds_and_gaps_of_cut_bodies_are_those_of_the_uncut_one(space):
    below, uncut = la.lower_bound(cut_flat()), la.lower_bound(whole())
    assert below.load_factor == pytest.approx(uncut.load_factor, rel=SAME)
    identity = la.gap_identity(la.upper_bound(cut_flat(space)), below)
    gap = identity.upper - identity.lower
    assert identity.total == pytest.approx(gap, abs=1e-9 * identity.upper)
    assert identity.least >= -1e-9 * identity.upper


@pytest.mark.parametrize("direction", [-1, 1])
def test_gaps_of_bonded_blocks(direction):
    problem = bonded_block(direction)
    above, below = la.upper_bound(problem), la.lower_bound(problem)
    identity = la.gap_identity(above, below)
    assert below.load_factor <= above.load_factor
    assert identity.total == pytest.approx(above.load_factor - below.load_factor, rel=1e-9)
    assert identity.least >= -1e-9 * above.load_factor


def test_a_velocity_that_tears_a_bond_is_refused():
    state = la.solve(cut_flat())
    moved = {name: own.copy() for name, own in state.velocity.items()}
    seam = state.discretisation.continua["low"].nodes[1] > -0.5 - 1e-9
    moved["low"][:, seam] *= 1.001
    assert state.certify().worst[1] <= 1e-6
    assert state.certify(velocity=moved).worst[1] > 1e-6


def test_what_cannot_be_bonded_is_refused():
    apart = {"a": layer((0, 1), (0, 1), 1, 1), "b": layer((3, 4), (0, 1), 1, 1)}
    bond = la.Interface(("a", "right"), ("b", "left"), la.BOND)
    load = [la.Traction("b", "right", (1, 0))]
    with pytest.raises(la.InputError, match="in contact with itself"):
        la.Problem(apart, load, interfaces=[la.Interface(("a", "left"), ("a", "right"), la.BOND)])
    with pytest.raises(la.InputError, match="does not touch"):
        la.Problem(apart, load, [la.Fix("a", "left")], [bond])
    with pytest.raises(la.InputError, match="no strength at which a bond"):
        la.BlockAssembly({"foot": [(0, 0), (1, 0), (1, 1), (0, 1)]}, friction=la.BOND)


def test_a_layer_without_a_strength_is_refused():
    """A soil that dilates less than its friction has no jumps: tied edges only."""
    soil = la.MohrCoulomb(1.0, 20.0, dilation_angle=5.0)
    with pytest.raises(la.InputError, match="the same vertices"):
        la.solve(cut_flat(criterion=soil, below=(11, 3)))
    held = cut_flat("p2-gauss", soil)
    assert la.solve(held, coupling="associated").load_factor == pytest.approx(
        la.solve(whole("p2-gauss", soil), coupling="associated").load_factor, rel=SAME
    )


def test_nodes_follow_what_holds_the_other_side():
    """A support of one side of a bond holds the other side's nodes there, as of one body."""
    problem = cut_flat()
    state = la.solve(problem)
    held = state.support_reactions
    total = held[["force_x", "force_y"]].sum().to_numpy()
    assert np.abs(total).max() < 1e-6 * np.abs(held[["force_x", "force_y"]]).to_numpy().sum()


@pytest.mark.parametrize("space", ["p2-vertex", "p1-disc"])
def test_what_slips_past_a_support_slips_past_all_of_it(space):
    """A held base that meets a smooth wall slips along all of its length, cut or not."""
    wall = la.RigidObstacle()

    def pushed(bodies, bonds=()):
        return la.solve(
            la.Problem(
                bodies,
                [la.Traction("left", "left", (0.3, -1))],
                [la.Fix(name, "bottom") for name in bodies],
                [*bonds, la.Interface((list(bodies)[-1], "right"), wall, la.SMOOTH)],
            )
        )

    uncut = pushed({"left": layer(X, (0, 1), 8, 4, space)})
    parts = {"left": layer((0, 1), (0, 1), 4, 4, space), "last": layer((1, 2), (0, 1), 4, 4, space)}
    cut = pushed(parts, [la.Interface(("left", "right"), ("last", "left"), la.BOND)])
    slipping = [
        sum(own.facets.size for own in state.discretisation.slips.values())
        for state in (uncut, cut)
    ]
    assert slipping == [8, 8]
    assert cut.load_factor == pytest.approx(uncut.load_factor, rel=SAME)


def test_what_is_bonded_is_in_equilibrium_as_one():
    """Programs are scaled by the parts that have an equilibrium of their own."""
    bonded, stuck = (la.solve(cut_flat(friction=law)) for law in (la.BOND, la.STICK))
    counts = [np.unique(state.discretisation.full.parts).size for state in (bonded, stuck)]
    assert counts == [1, 2]


def test_each_part_of_a_seam_costs_the_strength_of_its_weaker_side():
    """Strengths that cross in the middle: one side is weaker on the left, the other on the right.

    A relative speed of 1 along the seam costs the integral of the smaller strength (T23).
    """
    grows = la.Linear(1.5, (1.0, 0.0), at=(1.0, 0.0))
    falls = la.Linear(1.5, (-1.0, 0.0), at=(1.0, 0.0))
    bodies = {
        "top": layer(X, (0.0, 1.0), 4, 1, criterion=la.VonMises(grows)),
        "low": layer(X, (-1.0, 0.0), 2, 1, criterion=la.VonMises(falls)),
    }
    problem = la.Problem(
        bodies,
        [la.Traction("top", "left", (1, 0))],
        [la.Fix("low", "bottom")],
        [la.Interface(("top", "bottom"), ("low", "top"), la.BOND)],
    )
    d = la.discretise(problem)
    speed = np.zeros(d.full.n)
    speed[d.continua["top"].dofs[0]] = 1.0
    assert len(d.seams) == 2
    cost = sum(own.group.dissipation(speed).sum() for own in d.seams.values())
    assert cost == pytest.approx(2.0)  # twice the integral of 0.5 + x from 0 to 1
