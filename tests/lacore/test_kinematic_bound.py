"""Strict upper bounds from projected velocities (T26c), integrated closely (T22)."""

from math import pi

import numpy as np
import pytest

import lacore as la
from lacore.assembly import discretise
from lacore.certificate import certify
from lacore.conversion import point_in_program
from lacore.kinematic_bound import lattice
from lacore.program import associated_contact, dimensionless
from lacore.velocity_projection import admissible_velocity
from tests.lacore.models import deformable_block, punch, square
from tests.lacore.random_continua import problem as random_problem

LAWS = [la.SMOOTH, la.STICK, la.Tresca(0.4), la.Coulomb(0.3, associated=True)]


@pytest.mark.parametrize("space", ["p2-vertex", "p2-disc", "p1-disc"])
def test_below_the_program_and_above_the_exact_load(space):
    """The vertex rule of the program over-estimates; its lattice does so less."""
    state = la.solve(punch(space=space))
    bound = la.upper_bound(state)
    assert bound.rigor is la.Rigor.UPPER
    assert bound.divergence <= 1e-12
    assert bound.penetration <= 1e-12
    # Where strain rates are constant in elements nothing is gained but the solver's round-off.
    assert 2 + pi < bound.load_factor <= state.load_factor * (1 + 1e-8)
    if space != "p1-disc":
        assert bound.load_factor < state.load_factor * (1 - 1e-3)


@pytest.mark.parametrize("friction", LAWS[1:])
def test_exact_mechanisms_stay_exact(friction):
    stated = deformable_block(friction, n=2)
    expected = {la.STICK: 3.0, LAWS[2]: 1.6, LAWS[3]: 1.2}[friction]  # CLOSED_FORMS C14
    bound = la.upper_bound(stated)
    assert bound.load_factor == pytest.approx(expected, rel=1e-8)
    assert bound.load_factor >= expected * (1 - 1e-12)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
@pytest.mark.parametrize("friction", LAWS[1:])
def test_loose_solves_are_bounds_too(tolerance, friction):
    """Residuals that a loose solve leaves are projected away, those of contact with them."""
    discretisation = discretise(deformable_block(friction, n=2))
    state = la.solve(discretisation, options={"tolerance": tolerance}, tolerance=1e-3)
    program = dimensionless(discretisation.program, discretisation.natural)
    point = point_in_program(discretisation, state.point)
    velocity = admissible_velocity(program, point.velocity)
    seen = certify(program, type(point)(**(vars(point) | {"velocity": velocity})), laws(program))
    assert max(seen.divergence, seen.penetration, seen.normalisation) <= 1e-12


def laws(program):
    return associated_contact(program.contact)


def test_lattice_is_above_the_integral():
    """|x| over the triangle (-1, 0), (1, 0), (0, 1) of area 1: 1/3 from above, at order 2."""
    corner, excess = np.array([-1.0, 1.0, 0.0]), []
    for parts in (1, 3, 9, 27):
        places, share = lattice(parts)
        assert share.sum() == pytest.approx(1.0, rel=1e-12)
        assert places @ [1, 1, 1] == pytest.approx(np.ones(share.size), rel=1e-12)
        excess.append(share @ np.abs(places @ corner) - 1 / 3)
    assert excess[0] == pytest.approx(1 / 3)  # the vertex rule: 2/3
    assert np.allclose(np.array(excess[1:]) / excess[:-1], 1 / 9, rtol=0.1)


def test_random_problems():
    """Every state with friction that has bounds becomes a proven one."""
    proven = 0
    for seed in range(40):
        try:
            state = la.solve(random_problem(seed))
        except la.InputError:
            continue  # a footing on a support
        bound = la.upper_bound(state)
        assert bound.status is state.status
        if state.status is la.Status.SOLVED:
            proven += 1
            scale = max(abs(state.load_factor), 1e-3)
            assert bound.load_factor <= state.load_factor + 1e-8 * scale, seed
    assert proven >= 15


def test_an_unfinished_solve_proves_a_worse_bound():
    best = la.upper_bound(punch()).load_factor
    early = la.upper_bound(punch(), options={"max_iterations": 8})
    assert early.state.status is not la.Status.SOLVED
    assert early.rigor is la.Rigor.UPPER
    assert best < early.load_factor


def test_what_has_no_bound():
    with pytest.raises(la.InputError, match="not associated"):
        la.upper_bound(deformable_block(0.3))
    pressed = la.Problem(
        {"block": square()},
        [la.Pressure("block", "top")],
        [la.Fix("block", side, "normal") for side in ("left", "right", "bottom")],
    )
    locked = la.upper_bound(pressed)
    assert locked.status is la.Status.LOCKED
    assert locked.load_factor == np.inf
    assert locked.rigor is la.Rigor.NOT_CERTIFIED
    with pytest.raises(la.SolveError):
        la.upper_bound(pressed, throw=True)
    discrete = la.upper_bound(punch(space="p2-gauss"))
    assert discrete.rigor is la.Rigor.DISCRETE
