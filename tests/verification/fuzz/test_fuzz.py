"""Random problems as `lacore fuzz` draws, copies, cuts and counts them."""

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import lacore as la
from lacore_verification.commands.cli import main
from lacore_verification.fuzz.drawn.cases import (
    CLASSES,
    case_of,
    draw,
    random_of,
    recipe_of,
    run_of,
    runs_of,
)
from lacore_verification.fuzz.drawn.copies import COPIES, with_law
from lacore_verification.fuzz.drawn.recipe import as_text, build
from lacore_verification.fuzz.examine import examine
from lacore_verification.harness.campaigns import fuzzing
from lacore_verification.harness.campaigns.shrinking import candidates, shrunk
from lacore_verification.harness.verdicts.words import FAIL, PASS
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.row import Row
from tests.shares import one_in
from tests.verification.command_line import lacore

FEW, MANY = 2, 34  # of each class: fast ones, and with the slow ones
KINDS = list(CLASSES)
SEVERAL = ("pairs-on-paths", "tools-on-paths")  # they take some seconds each
PATHS = ("paths", *SEVERAL)
NOT_COPIED = (*PATHS, "sections")  # they are judged by linear programs of their own


def judged(kind, number):
    """What is wrong with a problem."""
    found = examine(draw(kind, 1, number), random_of(kind, 1, number, "examine"))
    return found.wrong and f"{kind} {number}: {found.wrong}"


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in SEVERAL])
def test_random_problems(kind):
    assert not [wrong for wrong in (judged(kind, number) for number in range(FEW)) if wrong]


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_more_random_problems(kind):
    begin = 0 if kind in SEVERAL else FEW
    assert not [wrong for wrong in (judged(kind, n) for n in range(begin, MANY)) if wrong]


@pytest.mark.parametrize(
    ("kind", "number"), [("axisymmetric", 1035), ("frames", 753), ("two-bodies", 360)]
)
def test_what_was_found_wrong_before_is_right(kind, number):
    """A row that nothing enters; feet whose limit is a force; stick that slips at a footing."""
    found = examine(draw(kind, 1, number), random_of(kind, 1, number, "examine"))
    assert found.wrong is None
    assert found.status in ("solved", "unsafe")


@pytest.mark.parametrize("kind", KINDS)
def test_a_recipe_is_plain_data_and_always_the_same(kind):
    for number in range(5):
        recipe = draw(kind, 3, number)
        assert json.loads(json.dumps(recipe)) == recipe
        assert as_text(draw(kind, 3, number)) == as_text(recipe)
    texts = {as_text(draw(kind, seed, number)) for seed in (1, 2) for number in range(5)}
    assert len(texts) == 10


@pytest.mark.parametrize("kind", one_in(3, [kind for kind in KINDS if kind not in NOT_COPIED]))
@pytest.mark.parametrize("name", COPIES)
def test_copies_have_the_load_factor_of_the_original(kind, name):
    """Of problems made associated, whose load factor is one number, to the bar of the solver."""
    for number in range(10):
        recipe = with_law(draw(kind, 5, number), "associated")
        try:
            state = la.solve(build(recipe))
        except la.InputError:
            continue
        if state.status is not la.Status.SOLVED or abs(state.load_factor) < 1e-3:
            continue
        other = la.solve(build(COPIES[name](recipe, np.random.default_rng(0))))
        assert other.load_factor == pytest.approx(state.load_factor, rel=1e-4)
        return
    pytest.fail("none of ten is solved")


def test_runs_are_shared_out_among_classes():
    runs = runs_of(KINDS, 100, seed=7)
    assert len(runs) == 100
    assert len({run.key for run in runs}) == 100
    assert {run.case.id for run in runs} == {f"fuzz-{kind}" for kind in KINDS}


class Planted:
    """An executor that finds a problem wrong as long as some block weighs something."""

    def __call__(self, runs, *, time_limit, on_start):
        for run in runs:
            recipe = recipe_of("weights", **run.parameters)
            heavy = any(load["vector"][1] < 0 for load in recipe["dead"])
            row = Row(*("",) * 5, status="solved", verdict=FAIL if heavy else PASS)
            yield Outcome(run, replace(row, why="planted: too heavy" if heavy else ""))


def test_a_wrong_problem_is_cut_down_and_kept(tmp_path):
    run = run_of(case_of("weights"), {"seed": 1, "number": 3})
    (outcome,) = Planted()([run], time_limit=1, on_start=None)
    small = shrunk(outcome, "weights", Planted(), 1.0)
    recipe = recipe_of("weights", **small.run.parameters)
    assert len(recipe["dead"]) == 1
    assert len(recipe["bodies"]["wall"]["polygons"]) <= 2
    (path,) = fuzzing.keep_wrong([outcome], tmp_path, Planted(), 1.0, lambda _: None)
    text = path.read_text(encoding="utf-8")
    assert "planted: too heavy" in text
    assert len(text.splitlines()) < 60
    scope = {"__name__": "kept"}
    exec(compile(text, path, "exec"), scope)
    assert as_text(scope["RECIPE"]) == as_text(recipe)


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_cut_is_smaller_or_rounder(kind):
    recipe = draw(kind, 1, 1)
    texts = [as_text(one) for one in candidates(recipe)]
    assert texts
    assert all(text != as_text(recipe) for text in texts)


def test_the_count_of_a_class():
    def outcome(number, **given):
        run = run_of(case_of("blocks"), {"seed": 1, "number": number})
        return Outcome(run, Row(*("",) * 5, **given))

    outcomes = [
        outcome(0, status="solved", expected="a load", verdict="pass"),
        outcome(1, status="not certified", expected="a load", verdict="no result"),
        outcome(2, status="locked", expected="no load", verdict="pass"),
        outcome(3, status="jam", expected="unknown", verdict="no result"),
        outcome(4, status="solved", expected="a load", verdict="FAIL", why="yield: beyond"),
        outcome(5, status="time limit", verdict="FAIL", why="stopped"),
        outcome(6, status="exception", verdict="FAIL", why="exception: KeyError"),
        outcome(7, status="refused", expected="unknown", verdict="skipped"),
    ]
    one, all_ = fuzzing.tallied(outcomes)
    assert (one.problems, one.refused, one.loads, one.certified) == (7, 1, 2, 1)
    assert (one.words, one.unknown, one.wrong, one.exceptions, one.hangs) == (1, 1, 1, 1, 1)
    assert one.missing == {"not certified": 1}
    assert replace(all_, kind="blocks") == one


def test_the_command_goes_on_where_it_was_and_says_what_it_counted(tmp_path):
    words = ["fuzz", "--count", "2", "--classes", "frames", "--json", "--out", tmp_path]
    first = lacore(*words)
    assert first.exit_code == 0, first.output
    again = lacore(*words)
    summary = json.loads(first.stdout)["summary"]
    assert json.loads(again.stdout)["summary"] == summary
    assert summary[-1]["problems"] + summary[-1]["refused"] == 2


def test_bad_input_of_the_command():
    for words in (["--classes", "bricks"], ["--dask", "--scheduler", "tcp://127.0.0.1:1"]):
        result = CliRunner().invoke(main, ["fuzz", "--count", "1", *words])
        assert result.exit_code == 2
