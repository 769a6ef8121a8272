"""What velocities alone do not solve, factorised with the multipliers of what is stiff."""

from dataclasses import replace

import numpy as np
import pytest

from lacore.numerics.linear_algebra import SuperLU
from lacore.numerics.symmetric import symmetric_solver
from lacore.program.certificate import certify
from lacore.reporting.status import Status
from lacore_backends import interior_point
from lacore_backends._embedding import follow as way
from lacore_backends._embedding.arrays import Translation
from lacore_backends._embedding.directions import Directions
from lacore_backends._embedding.least import least_program
from lacore_backends._embedding.loops import plain
from lacore_backends._embedding.place import Place
from lacore_backends._embedding.start import start
from lacore_backends._embedding.stiffness import Stiffness
from lacore_backends._embedding.system import System, _pair
from lacore_backends._embedding.vectors import Vector
from lacore_backends._embedding.whole import Whole
from tests.backends.test_interior_point import BAR, KINDS, ROUND, answer, stated


@pytest.mark.parametrize("kind", KINDS[:4])
def test_what_velocities_do_not_solve_is_solved_with_more_unknowns(kind, monkeypatch):
    def stuck(system, *rest):
        found = way.follow(system, *rest)
        return found if isinstance(system, Whole) else replace(found, native="no progress")

    program, contact = stated(kind, 3)
    own = answer("interior_point", program, contact)
    monkeypatch.setattr(interior_point, "follow", stuck)
    other = answer("interior_point", program, contact)
    assert other.status is own.status
    if own.status is Status.SOLVED:
        assert other.iterations > own.iterations
        assert other.point.load_factor == pytest.approx(own.point.load_factor, rel=ROUND)
        assert certify(program, other.point, contact).holds(BAR)


@pytest.mark.parametrize("solver", [symmetric_solver, lambda **_: SuperLU()])
def test_both_ways_to_factorise_solve_the_same_equations(solver):
    """Refined, as what they keep from being singular differs."""
    program, contact = least_program()
    own = Translation(program, contact, plain)
    parts = own.conic, Stiffness(own.conic.kinds, plain), solver(refined=False)
    whole = Whole(*parts, solver(refined=False, definite=False))
    found = []
    for system in (System(*parts), whole):
        at, _ = start(own.conic, system)
        directions = Directions(Place(own.conic, at), system)
        found.append(directions.exactly(directions.to_edges(), 1e-8))
    for one, other in zip(found[0].cones, found[1].cones, strict=True):
        for first, second in zip(one, other, strict=True):
            # `exactly` leaves a share of EXACT of the right-hand side; conditioned like mu = 0.2.
            assert np.allclose(first, second, atol=1e-4)


@pytest.mark.parametrize("small", [1e-17, 1.0, 1e17])
def test_the_border_is_solved_whichever_of_its_entries_is_small(small):
    """Its determinant is far from zero; by a pivot of 1e-17 the other unknown was lost."""
    matrix, x = np.array([[small, 1.0], [1.0, 1.0 - small]]), np.array([2.0, 3.0])
    # Round-off of a solution by the larger pivot is that of the right-hand side.
    assert _pair(matrix, *(matrix @ x)) == pytest.approx(x, rel=1e-14)


@pytest.mark.parametrize("kind", ["velocities", "more"])
def test_what_a_solve_is_known_to_leave_is_what_it_leaves(kind):
    """Of rates; forces are left what round-off makes of their stiffness.

    Of right-hand sides that have a solution: of volumes that are given twice there is none else.
    """
    program, contact = least_program()
    own = Translation(program, contact, plain)
    parts = own.conic, Stiffness(own.conic.kinds, plain), symmetric_solver(refined=False)
    more = (symmetric_solver(refined=False, definite=False),)
    system = System(*parts) if kind == "velocities" else Whole(*parts, *more)
    at, _ = start(own.conic, system)
    Directions(Place(own.conic, at), system)  # factorises
    layout = system.layout
    rates = slice(layout.force.stop, layout.size - 2)

    def agree(one, other):
        near = 1e-3 * np.abs(one.data[rates]).max()
        assert np.allclose(one.data[rates], other.data[rates], rtol=0.0, atol=near)

    right = system.times(Vector(layout, np.random.default_rng(3).normal(size=layout.size)))
    x = system.once(right)
    known = system.leaves(right, x)
    assert np.abs(known.data[rates]).max() > 0
    agree(known, system.left(right, x))
    # One more solve of that mends it, and knows what is left.
    begun = Vector(layout, 0.5 * x.data)
    y, rest = system.improved(right, begun, system.left(right, begun))
    assert np.abs(rest.data).max() < 1e-3 * np.abs(right.data).max()
    agree(rest, system.left(right, y))
