"""No command lets a lie pass, and honest backends in the same run do not notice."""

import json
from math import isfinite

import numpy as np
import pytest
from click.testing import CliRunner

import lacore as la
from lacore_verification import conformance
from lacore_verification.case.band import BRACKET, PROVEN
from lacore_verification.commands import cli
from lacore_verification.fuzz.programs.drawn import draw_program
from lacore_verification.fuzz.programs.judge import RIGHT, WRONG
from lacore_verification.fuzz.programs.sweep import rows_of
from lacore_verification.harness.store.results import load_results
from lacore_verification.harness.verdicts.words import FAIL, PASS, SKIPPED
from lacore_verification.runs.row import STRICT
from tests.lacore.models import punch
from tests.lacore.paths.path_billets import billet
from tests.lying_backends import LIES, Undescribed, Untidy, register

SOME = (
    *("ForcesReferenceLoad", "DoublesTheLoadFactor", "ZeroVelocity", "ClaimsLocked"),
    *("NoStress", "PatchesHolds"),
)
"""One of each kind that answers wrongly."""
CASE = "shear-patch:sliding"
BRACKETED = "prandtl-punch:smooth"
EXACT = 2 + np.pi
"""Load factor of `BRACKETED`, and of the punch that is bracketed without a command."""
HARMLESS = {
    "Talks": "its output is discarded, and its answers are right",
    "ChangesTheInterpreter": "only its own process is changed, and its answers are right",
    "FalseTime": "lacore measures times itself, and its answers are right",
}
"""Lies that neither the conformance suite nor `lacore programs` shows, with the reason."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lies")
    register(folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(folder))
        patch.setenv("LACORE_TEST_TRACE", str(folder / "trace"))
        yield folder


def rows(folder, name, *words, backends):
    """Result of a command, and the rows that it stored, always in the same order."""
    place = folder / name
    more = ("--meshes", "coarse", "--jobs", "2", "--out", place, "--backends", ",".join(backends))
    found = CliRunner().invoke(cli.main, [*map(str, (*words, *more)), "--json"])
    return found, load_results(place).sort_values("run")


@pytest.mark.slow
@pytest.mark.parametrize(
    "words", [("verify", CASE), ("sweep", CASE, "--vary", "mu=0.2,0.3")], ids=lambda own: own[0]
)
def test_a_command_passes_no_lie_and_honest_backends_do_not_notice(folder, words):
    _, alone = rows(folder, f"{words[0]}-alone", *words, backends=["clarabel"])
    liars = (*SOME, "LeavesThreads", "UnavailableRaises")
    found, together = rows(folder, f"{words[0]}-all", *words, backends=["clarabel", *liars])
    assert found.exit_code == 1
    honest = together[together.backend == "clarabel"]
    for column in ("load_factor", "lowest", "highest", "upper", "lower"):
        if column in alone:
            assert np.array_equal(honest[column], alone[column], equal_nan=True), column
    assert set(honest.verdict) <= {PASS, SKIPPED}
    for name in SOME:
        own = together[together.backend == name]
        assert set(own.verdict) == {FAIL}, name
        assert not np.isfinite(own.load_factor).any(), name
    assert set(together[together.backend == "UnavailableRaises"].verdict) == {SKIPPED}
    threads = together[together.backend == "LeavesThreads"]
    assert set(threads.load_factor.dropna()) == set(honest.load_factor.dropna())


@pytest.mark.slow
@pytest.mark.parametrize("name", SOME)
def test_a_bracket_of_verify_passes_no_lie(folder, name):
    """A bound that is proven is right whoever found it; what is not proven fails with the name."""
    words = ("verify", BRACKETED, "--time-limit", "30")
    _, found = rows(folder, f"bracket-{name}", *words, backends=[name])
    (row,) = found[found.coupling == BRACKET].to_dict("records")
    exact = row["reference"]
    assert exact == pytest.approx(EXACT)
    assert not row["lower"] > exact * (1 + PROVEN)
    assert not row["upper"] < exact * (1 - PROVEN)
    if row["verdict"] != PASS:
        assert row["verdict"] == FAIL
        assert name in row["message"] or row["rigor"] == STRICT, row["message"]
    else:
        assert row["rigor"] == STRICT


def bracketed(name):
    try:
        return la.bracket(punch(4, 3), 0.3, backend=name, time_limit=10.0)
    except la.LacoreError as error:
        return error


def followed(name):
    problem, approaching = billet()
    try:
        return la.sequential(problem, 0.1, 2, approaching=approaching, backend=name)
    except la.LacoreError as error:
        return error


def test_brackets_and_paths_name_the_backend_that_has_no_answer(folder):
    """Their messages are shown without the name of the backend elsewhere."""
    named = "backend 'NoStress' has no certified answer: failed"
    bracket, path = bracketed("NoStress"), followed("NoStress")
    assert f"lower bound: {named}" in bracket.message
    assert f"upper bound: {named}" in bracket.message
    assert path.message.startswith(f"not solved: {named}")


@pytest.mark.slow
def test_a_bracket_encloses_the_exact_value_whatever_is_answered(folder):
    honest = bracketed("clarabel")
    for name in SOME:
        found = bracketed(name)
        if isinstance(found, la.Bracket):
            assert not found.lower > EXACT, name
            assert not found.upper < EXACT, name
            assert f"backend {name!r}" in found.message or found.strict, found.message
        else:
            assert name in str(found)
    again = bracketed("clarabel")
    assert (again.lower, again.upper) == (honest.lower, honest.upper)


@pytest.mark.slow
def test_a_path_keeps_no_wrong_load_factor(folder):
    honest = followed("clarabel")
    right = honest.history.load_factor.to_numpy()
    for name in SOME:
        found = followed(name)
        if isinstance(found, Exception):
            assert name in str(found)
            continue
        assert found.status is not honest.status, name
        assert f"backend {name!r}" in found.message, found.message
        wrong = found.history.load_factor.to_numpy(float)
        kept = np.isfinite(wrong)
        assert wrong[kept] == pytest.approx(right[: wrong.size][kept], rel=1e-5), name
    assert np.array_equal(followed("clarabel").history.load_factor, right, equal_nan=True)


def programs():
    """One random program of each kind of array, small, whose load factors are not zero."""
    return [draw_program(*own) for own in (("two bodies", 0, 0, 60), ("walls", 1, 0, 40))]


def detected_by_conformance(name):
    few = ["one cone", "friction", "volumetric row", "friction limit", "left running"]
    known = [own for own in few if own in conformance.EXERCISES]
    try:
        findings = conformance.run(name, programs=known, on_start=lambda _: None)
    except la.CapabilityError:
        return True  # the command ends with its message
    return bool(conformance.failures(findings))


def detected_by_programs(name):
    try:
        backends = [la.find_backend(name), la.find_backend("clarabel")]
    except la.CapabilityError:
        return True  # the command ends with its message
    verdicts = [rows_of("drawn", 0, drawn, backends, {})[0].verdict for drawn in programs()]
    return WRONG in verdicts


def test_random_programs_have_load_factors_about_which_to_lie():
    clarabel = la.find_backend("clarabel")
    for drawn in programs():
        (row,) = rows_of("drawn", 0, drawn, [clarabel], {})
        assert row.verdict == RIGHT
        assert isfinite(row.load_factor)
        assert abs(row.load_factor) > 1e-3


@pytest.mark.slow
def test_conformance_and_random_programs_detect_the_same_defects(folder):
    by_both = {name: (detected_by_conformance(name), detected_by_programs(name)) for name in LIES}
    assert {name for name, found in by_both.items() if found != (True, True)} == set(HARMLESS)
    assert all(by_both[name] == (False, False) for name in HARMLESS)
    assert all(issubclass(LIES[name].kind, Untidy) for name in HARMLESS)


@pytest.mark.slow
def test_an_honest_backend_passes_all_programs_of_the_conformance_suite(folder):
    assert not conformance.failures(conformance.run("Honest", on_start=lambda _: None))
    assert not detected_by_programs("Honest")


@pytest.mark.slow
def test_the_command_on_random_programs_names_each_fault(folder):
    words = ["programs", *SOME, "Raises", "clarabel", "--count", "2", "--families", "chains"]
    found = CliRunner().invoke(cli.main, [*words, "--json"])
    assert found.exit_code == 1
    shown = json.loads(found.stdout)["rows"]
    for name in (*SOME, "Raises"):
        own = [row for row in shown if row["backend"] == name]
        assert {row["verdict"] for row in own} == {WRONG}, name
    assert {row["verdict"] for row in shown if row["backend"] == "clarabel"} == {RIGHT}
    texts = {row["backend"]: row["message"] for row in shown}
    assert "backend 'Raises' raised ZeroDivisionError: made for tests" in texts["Raises"]
    assert "F0.U = 0" in texts["ZeroVelocity"]
    assert "point.stress" in texts["NoStress"]


def test_a_backend_that_describes_itself_wrongly_ends_both_commands(folder):
    name = next(name for name, own in LIES.items() if issubclass(own.kind, Undescribed))
    for words in (["conformance", name], ["programs", name]):
        found = CliRunner().invoke(cli.main, words)
        assert (found.exit_code, "describes itself wrongly" in found.stderr) == (2, True)
