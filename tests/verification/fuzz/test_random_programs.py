"""Random programs of all classes, and what answers of backends to them are worth."""

from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from lacore.program.certificate import certify
from lacore.program.kinematic import require_finite
from lacore.program.power import largest_power
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution, find_backend
from lacore_verification.commands.cli import main
from lacore_verification.fuzz.programs.drawn import DRAWN, draw_program
from lacore_verification.fuzz.programs.judge import (
    BAR,
    NOTHING,
    RIGHT,
    WRONG,
    ProgramRun,
    ask,
    proven,
    recomputed,
    verdict,
)
from lacore_verification.fuzz.programs.sweep import (
    LARGE,
    drawn_programs,
    in_turn,
    rows_of,
    sizes,
    tallied,
)

SMALL = 60


@pytest.fixture(scope="module")
def drawn():
    return draw_program("plane strain", 1, 0, SMALL)


@pytest.fixture(scope="module")
def solved(drawn):
    return ask(find_backend("clarabel"), drawn, {})


def given(asked, **changes):
    """The answer with another point or status."""
    return replace(asked, answer=replace(asked.answer, **changes))


def judged_again(drawn, asked):
    return replace(asked, residual=recomputed(drawn, asked.answer))


@pytest.mark.parametrize("family", DRAWN)
def test_every_family_draws_the_same_programs_again(family):
    one, other = (draw_program(family, 3, 0, SMALL) for _ in range(2))
    require_finite(one.program)
    assert np.array_equal(one.program.reference_load, other.program.reference_load)
    assert np.array_equal(one.contact.bound, other.contact.bound)
    assert one.contact.bound.size == one.program.contact.count


def test_meshes_are_as_fine_as_asked_for():
    for family in ("plane strain", "from below", "soil", "walls", "chains"):
        found = draw_program(family, 3, 1, 800).program.n
        assert 0.5 * 800 <= found <= 2 * 800, family


def test_half_of_all_programs_are_large():
    asked = sizes(200, 1, 4000)
    assert sum(size >= LARGE for size in asked) == 100
    assert max(asked) <= 4000
    names = [name for name, _, _ in drawn_programs(["walls", "chains"], 8, 1, 2000)]
    assert {name: names.count(name) for name in names} == {"walls": 4, "chains": 4}


def test_a_number_is_judged_by_residuals_whatever_is_said_of_it(drawn, solved):
    assert solved.solved
    assert verdict(solved, drawn, []) == RIGHT
    point = solved.answer.point
    moved = replace(point, load_factor=point.load_factor * (1 + 1e-4))
    assert verdict(judged_again(drawn, given(solved, point=moved)), drawn, []) == WRONG
    doubted = given(solved, status=Status.ALMOST_SOLVED)
    assert verdict(doubted, drawn, []) == RIGHT
    stalled = given(solved, status=Status.STALLED)
    assert verdict(stalled, drawn, []) == NOTHING
    assert verdict(replace(solved, residual=np.nan), drawn, []) == WRONG


def test_a_word_is_wrong_beside_a_number_and_else_needs_a_proof(drawn, solved):
    answer = InnerSolution(Status.LOCKED, "locked", 1, 0.0, None)
    word = ProgramRun("other", answer, float("nan"), 0.0)
    assert verdict(word, drawn, [solved]) == WRONG
    assert verdict(word, drawn, [replace(word, backend="third")]) == RIGHT
    assert verdict(word, drawn, []) == NOTHING


def test_without_dead_loads_a_free_motion_has_the_load_zero():
    """Nothing is turned over: no residual is small per power, and zero is between both bounds."""
    free = draw_program("plane strain", 9, 9, SMALL)
    found = ask(find_backend("clarabel"), free, {})
    assert not np.any(free.program.dead_load)
    assert certify(free.program, found.answer.point, free.contact).worst[1] > BAR
    assert found.holds
    # A velocity that strains is none of these, whatever is said of its load factor.
    rng = np.random.default_rng(1)
    strained = found.answer.point.velocity + 0.1 * rng.normal(size=free.program.n)
    point = replace(found.answer.point, velocity=strained)
    assert recomputed(free, replace(found.answer, point=point)) > BAR


@pytest.mark.slow
@pytest.mark.parametrize("family", DRAWN)
def test_the_interior_point_calls_nothing_solved_that_is_not(family):
    backends = [find_backend(name) for name in ("interior_point", "clarabel")]
    for place, size in enumerate((30, 200, 1600)):
        rows = rows_of(family, place, draw_program(family, 4, place, size), backends, {})
        assert rows[0].verdict != WRONG, rows[0]


def test_asked_in_turn_the_first_that_is_sure_counts(drawn):
    backends = [find_backend(name) for name in ("interior_point", "clarabel")]
    first, second = rows_of("plane strain", 0, drawn, backends, {})
    assert in_turn([first, second]) == replace(first, backend="interior_point, then clarabel")
    stuck = replace(first, status=Status.STALLED.label, verdict=NOTHING)
    both = in_turn([stuck, second])
    assert both.verdict == second.verdict
    assert both.seconds == pytest.approx(first.seconds + second.seconds)


def test_a_soil_that_carries_nothing_is_measured_by_its_strength():
    """Its strength is that of its surfaces: by that of cones, zero, no load of zero was right."""
    every = (draw_program("soil", 5, place, SMALL).program for place in range(20))
    alone = (one for one in every if not any(g.bound.any() for g in one.groups))
    strong = next(one for one in alone if all(g.surfaces.strength.max() > 0 for g in one.groups))
    velocity = np.random.default_rng(0).normal(size=strong.n)
    assert largest_power(strong, velocity) > 0


def test_counts_add_up():
    backends = [find_backend("clarabel")]
    rows = rows_of("chains", 0, draw_program("chains", 1, 0, SMALL), backends, {})
    last = tallied(rows)[-1]
    assert (last.family, last.programs) == ("all", 1)
    assert last.right + last.wrong + last.nothing + last.refused == 1


def test_the_command_says_what_is_right():
    asked = ["programs", "clarabel", "--count", "2", "--families", "portals", "--json"]
    found = CliRunner().invoke(main, asked)
    assert found.exit_code == 0, found.output
    assert '"right": 2' in found.output


def test_a_program_lost_next_to_its_answer_is_not_called_unsafe():
    """At gaps of 1e-9 tau falls to round-off, and what is left of the way points anywhere."""
    lost = draw_program("two bodies", 6, 3, 2333)
    answered = ask(find_backend("interior_point"), lost, {})
    assert answered.word is None


@pytest.mark.parametrize("name", ["clarabel", "interior_point"])
def test_blocks_that_slide_freely_have_the_load_zero_whatever_units_they_are_asked_in(name):
    """Two slide together, loads across: powers per nothing had refused what was right already."""
    sliding = draw_program("body and blocks", 31, 7, 3329)
    assert ask(find_backend(name), sliding, {}).holds


def test_a_collapse_that_one_solver_finds_no_digits_of_is_proven_by_the_other():
    """Clarabel ends at a divergence of 3e-6 in the mechanism that proves its own word."""
    assert proven(Status.UNSAFE, draw_program("unsafe", 31, 17, 2557))
