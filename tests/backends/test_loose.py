"""Bodies that nothing holds along some way: the loads alone say what is carried."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.numerics.linear_algebra import SuperLU
from lacore.numerics.symmetric import symmetric_solver
from lacore.program.kinematic import associated_contact
from lacore.program.residuals import scaled_residual
from lacore.reporting.status import Status
from lacore_backends._embedding.arrays import Translation
from lacore_backends._embedding.follow import follow
from lacore_backends._embedding.loops.best import best_loops
from lacore_backends._embedding.loose import loosened
from lacore_backends._embedding.start import start, unresisted
from lacore_backends._embedding.stiffness import Stiffness
from lacore_backends._embedding.system import System
from lacore_backends._goal import Goal
from lacore_backends.interior_point import InteriorPoint, InteriorPointOptions
from lacore_verification.fuzz.programs.drawn import draw_program
from lacore_verification.fuzz.programs.judge import ask
from tests.backends import hand_made

TOLERANCE = InteriorPointOptions().tolerance
BAR = 1e-6  # of certificates
CELLS = 8
WEIGHT, ACROSS = 0.3, 0.05


def sliding(supports, dead, material=None):
    """A square on rails along y, pushed along them, and its contact; loads per area are forces."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), CELLS, CELLS)
    law = material or la.VonMises(shear_strength=1.0)
    problem = la.Problem(
        bodies={"block": la.Body(mesh, law, space="p2-gauss")},
        supports=[la.Fix("block", *support) for support in supports],
        reference_loads=[la.BodyForce("block", (0.0, 1.0))],
        dead_loads=[la.BodyForce("block", dead)] if any(dead) else [],
    )
    program = la.discretise(problem).program
    return program, associated_contact(program.contact)


RAILS = [("left", "x")]


def solved(program, contact):
    return InteriorPoint().prepare(program, InteriorPointOptions()).solve(contact)


def conic(program, contact):
    return Translation(program, contact, best_loops()).conic


def begun(found):
    return start(found, System(found, Stiffness(found.kinds, best_loops()), SuperLU()))[0]


@pytest.mark.parametrize("hardens", [False, True])
def test_the_load_is_what_balances_the_weight(hardens):
    """Pushed to the rails as well, so that there is a stress to be found: it stalled at 1e-4."""
    program, contact = sliding(RAILS, (ACROSS, -WEIGHT))
    if hardens:
        groups = [replace(g, modulus=np.ones(g.weights.size)) for g in program.groups]
        program = replace(program, groups=tuple(groups))
    found = solved(program, contact)
    assert found.status is Status.SOLVED
    # Power of both loads is in balance to the tolerance of powers, those of the same velocity.
    assert found.point.load_factor == pytest.approx(WEIGHT, rel=TOLERANCE)
    assert scaled_residual(program, found.point, contact)[1] <= BAR


@pytest.mark.parametrize("material", [la.VonMises(shear_strength=1.0), la.NoTension(5.0)])
@pytest.mark.parametrize("weight", [0.0, WEIGHT])
def test_loads_that_carry_each_other_leave_no_stress(weight, material):
    """Of a soil without tension any stress of round-off exceeds its strength."""
    program, contact = sliding(RAILS, (0.0, -weight), material)
    found = solved(program, contact)
    assert found.native_status == "in balance"
    assert found.point.load_factor == pytest.approx(weight, rel=1e-9, abs=1e-9)
    assert not any(stress.any() for stress in found.point.stress)
    assert scaled_residual(program, found.point, contact)[1] <= BAR


def test_little_weight_along_the_rails_is_what_the_load_balances():
    """A thousandth of what presses to them: no round-off, which is left out below 1e-8 of it."""
    little = 1e-3 * ACROSS
    found = solved(*sliding(RAILS, (ACROSS, -little)))
    assert found.status is Status.SOLVED
    # Judged per power, of which this is all, and to a hundred tolerances.
    assert found.point.load_factor == pytest.approx(little, rel=BAR)


@pytest.mark.parametrize("touching", [0, 1])
def test_more_ways_to_move_than_rows_are_found(touching):
    """A rigid block (x, y, turn) in the air, or on one smooth point, drawn along against 0.3."""
    arm = 0.2
    rows = hand_made.contact([[0, 1, arm]], [[1, 0, 0]], [1.0]) if touching else None
    dead = [-0.3, -touching, -arm * touching]
    program = hand_made.program([1.0, 0.0, 0.0], rows=rows, dead=dead)
    contact = hand_made.frozen(touching * [0.0])
    found = solved(program, contact)
    assert found.status is Status.SOLVED
    assert found.point.load_factor == pytest.approx(0.3, rel=BAR)
    assert scaled_residual(program, found.point, contact)[1] <= BAR


def test_two_loads_along_two_free_ways_are_not_carried():
    program, contact = sliding([], (ACROSS, -WEIGHT))
    found = solved(program, contact)
    assert found.status is Status.UNSAFE


def test_a_weight_that_the_body_does_not_bear_is_unsafe():
    """Torn off the rails, of the area of one, by five times what it bears in tension."""
    program, contact = sliding(RAILS, (10.0, -WEIGHT))
    assert solved(program, contact).status is Status.UNSAFE


def test_rows_know_no_motion_and_loads_stay():
    program, contact = sliding(RAILS, (ACROSS, -WEIGHT))
    given = conic(program, contact)
    found = loosened(given, SuperLU())
    assert found.conic.loose.size == 1
    q = np.random.default_rng(1).normal(size=program.n)
    u = found.basis @ q
    for stated, own in zip(found.conic.kinds, given.kinds, strict=True):
        assert not stated.matrix[:, found.conic.loose].count_nonzero()
        # Motions are found to 1e-10 per row and speed.
        assert stated.at(q) == pytest.approx(own.at(u), abs=1e-9 * np.abs(own.matrix.data).max())
    assert found.conic.load @ q == pytest.approx(given.load @ u, rel=1e-12)
    assert found.conic.dead @ q == pytest.approx(given.dead @ u, rel=1e-12)


@pytest.mark.parametrize("size", [800, 1909])
def test_of_many_blocks_that_slide_no_two_run_off_against_each_other(size):
    """Weights of blocks that slide along smooth joints work on that by what round-off lifts them.

    The load drives many such motions: at 1e17 times its speed 1e-13 was a ray, and called unsafe.
    """
    drawn = draw_program("blocks in space", 13, 9, size)
    given = conic(drawn.program, drawn.contact)
    loose = loosened(given, symmetric_solver(refined=False))
    found = loose.conic
    assert np.any(found.load[found.loose])
    assert not np.any(found.dead[found.loose])
    system = System(found, Stiffness(found.kinds, best_loops()), symmetric_solver(refined=False))
    ended = follow(system, Goal(TOLERANCE, 100, np.inf), *start(found, system))
    assert ended.native != "unsafe"
    assert ask(InteriorPoint(), drawn, {}).holds


def test_a_body_that_is_held_has_no_such_motion():
    held, contact = sliding([("bottom", "xy")], (ACROSS, -WEIGHT))
    given = conic(held, contact)
    assert not unresisted(begun(given))
    assert loosened(given, SuperLU()) is None
    program, contact = sliding(RAILS, (ACROSS, -WEIGHT))
    assert unresisted(begun(conic(program, contact)))
