"""Sweeps: which runs a grid is, and what its command leaves."""

import json

import pandas as pd
import pytest
from click.testing import CliRunner

import lacore as la
from lacore_verification.case import Case, Variant
from lacore_verification.catalogue.catalogue import Catalogue, find
from lacore_verification.commands.cli import main
from lacore_verification.harness.campaigns.comparison import plan as compare
from lacore_verification.harness.campaigns.sweep import plan
from lacore_verification.harness.store.results import load_results
from lacore_verification.harness.store.store import NAME
from tests.verification.command_line import lacore, run_in_order

BLOCK = "deformable-block"


def command(*arguments):
    """Where runs are performed as a test says."""
    return CliRunner().invoke(main, ["sweep", *arguments])


def test_variants_from_a_parameter_and_their_reference():
    """All variants of the block differ in mu only, so they are one."""
    runs = plan([BLOCK], ["mu=0.1:0.9:5"], ["clarabel"], ["coarse"])
    assert [run.variant.name for run in runs] == ["mu-0.1", "mu-0.3", "mu-0.5", "mu-0.7", "mu-0.9"]
    assert [run.parameters for run in runs] == [{"mu": mu} for mu in (0.1, 0.3, 0.5, 0.7, 0.9)]
    values = [run.case.reference_of(run.variant).high for run in runs]
    assert values == pytest.approx([0.4, 1.2, 2.0, 2.8, 3.0])


def test_variants_that_differ_otherwise_keep_their_names():
    case, variants = find("block-incline")
    runs = plan([case.id], ["mu=0.2,0.3"], ["clarabel"])
    names = {run.variant.name for run in runs}
    assert len(runs) == len({run.key for run in runs})
    assert all(name.endswith(("-mu-0.2", "-mu-0.3")) for name in names)
    assert {name.rsplit("-mu-", 1)[0] for name in names} <= {one.name for one in variants}


def test_exact_backends_run_once_for_all_regularisations():
    runs = plan(["prandtl-punch:smooth"], ["r=1e-1:1e-5:9:log"], ["newton", "clarabel"], ["coarse"])
    assert sum(run.backend == "newton" for run in runs) == 9
    (exact,) = [run for run in runs if run.backend == "clarabel"]
    assert not exact.options


def test_grid_of_several_axes():
    runs = plan(
        [f"{BLOCK}:sliding"],
        ["n=1:3:3", "damping=0.5,1", "K_n=1e3,1e4", "K_t=1e3"],
        ["newton"],
    )
    assert len(runs) == 3 * 2 * 2
    assert {run.mesh for run in runs} == {"coarse"}  # one level gives the other keywords
    last = runs[-1]
    assert last.size == {"n": 3}
    assert last.settings == {"damping": 1.0}
    assert last.options == {"normal": 1e4, "tangential": 1e3}
    order = [run.problem_key for run in runs]
    assert order == sorted(order, key=order.index)  # neighbours share their problem


def test_verdicts_are_those_of_a_comparison():
    """A run that a comparison has, too, must end with a result in both, or in neither."""
    names, levels = ["clarabel", "newton"], ["coarse"]
    compared = {run.backend: run.insist for run in compare([f"{BLOCK}:sliding"], names, levels)}
    swept = plan([BLOCK], ["mu=0.2,0.5"], names, levels)
    assert len(swept) == 4
    assert all(run.insist == compared[run.backend] for run in swept)
    assert compared == {"clarabel": True, "newton": False}


@pytest.mark.parametrize("vary", ["damping=0.5,1", "option.max_iterations=3,5"])
def test_no_result_is_no_failure_with_changed_settings_or_options(vary):
    assert not any(run.insist for run in plan([BLOCK], [vary], ["clarabel"], ["coarse"]))


def test_outside_the_closed_form_is_skipped():
    case, (variant, *_) = find("block-slide")
    runs = plan([f"{case.id}:{variant.name}"], ["y=0.1,5"], ["clarabel"])  # above the block
    assert [bool(run.skip) for run in runs] == [False, True]
    assert "closed form" in runs[1].skip


@pytest.mark.parametrize(
    ("vary", "message"),
    [
        ([], "the grid is empty"),
        (["mue=1"], "did you mean 'mu'?"),
        (["param.r=1"], "--vary param.r: unknown name"),
        (["tolerance=1e-6"], "write setting.tolerance or option.tolerance"),
        (["mu=0.1", "param.mu=0.2"], "is there twice"),
        (["K_n=1", "normal=2"], "is there twice"),
        (["mu=0.1,0.10"], "0.1: is there twice"),
        (["n=2.5"], "not a whole number"),
        (["damping=0"], "outside (0, 1]"),
        (["start=nowhere"], "start = 'nowhere'"),
        (["r=2"], "r = 2.0: outside"),
        (["K_t=-1"], "tangential = -1.0"),
        (["option.max_iterations=0"], "max_iterations = 0"),
        (["mu=0:1:1000", "damping=0.1:1:1000"], "points are too many"),
    ],
)
def test_bad_input_is_known_before_anything_is_touched(tmp_path, vary, message):
    words = [word for one in vary for word in ("--vary", one)]
    result = command(BLOCK, *words, "--out", str(tmp_path / "out"), "--backends", "newton")
    assert result.exit_code == 2, result.output
    assert message in result.output
    assert result.output.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["prandtl-punh", "--vary", "r=0.1"], "did you mean 'prandtl-punch'?"),
        (["prandtl-punch", BLOCK, "--vary", "mu=0.1"], "'prandtl-punch' has no such parameter"),
        ([BLOCK, "--vary", "mu=0.1", "--backends", "clarable"], "did you mean 'clarabel'?"),
        ([BLOCK, "--vary", "mu=0.1", "--meshes", "corse"], "did you mean 'coarse'?"),
        ([BLOCK, "--vary", "mu=0.1", "--couplings", "reacton"], "did you mean 'reaction'?"),
    ],
)
def test_unknown_names(tmp_path, words, message):
    result = command(*words, "--out", str(tmp_path / "out"))
    assert result.exit_code == 2, result.output
    assert message in result.output
    assert not (tmp_path / "out").exists()


def test_a_bad_row_does_not_stop_the_rest(tmp_path):
    """A negative friction coefficient: only the problem itself refuses it."""
    result = lacore(
        "sweep", BLOCK, "--vary", "mu=-1,0.5", "--backends", "clarabel", "--meshes", "coarse",
        "--out", str(tmp_path),
    )  # fmt: skip
    assert result.exit_code == 1, result.output
    table = load_results(tmp_path).set_index("param_mu")
    assert table.loc[-1.0, "status"] == "failed"
    assert "InputError" in table.loc[-1.0, "message"]
    assert table.loc[0.5, "verdict"] == "pass"


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    out = tmp_path_factory.mktemp("sweep")
    words = [
        "prandtl-punch:smooth", "--vary", "r=1e-1:1e-4:7:log", "--backends", "newton,clarabel",
        "--meshes", "coarse", "--out", str(out),
    ]  # fmt: skip
    return lacore("sweep", *words), words, out


def test_sweep_leaves_a_store_a_table_and_slopes(swept):
    result, _, out = swept
    assert result.exit_code == 0, result.output
    assert len(load_results(out)) == 8
    assert len(pd.read_csv(out / "results.csv")) == 8
    assert "7 solved" in result.stdout
    assert "error_alpha_reg" in result.stdout
    assert str(out / NAME) in result.stdout


def test_resume_is_the_default(swept, monkeypatch):
    """Nothing is run again, and the rows stay as they are."""
    _, words, out = swept
    before = load_results(out)

    def nobody(runs, jobs, **_):
        assert not runs
        yield from ()

    monkeypatch.setattr("lacore_verification.harness.perform.processes.run_in_processes", nobody)
    result = command(*words, "--json")
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert document["summary"]["runs"] == 8
    (alpha_reg,) = [s for s in document["slopes"] if s["error"] == "error_alpha_reg"]
    assert alpha_reg["slope"] == pytest.approx(1, abs=0.1)
    pd.testing.assert_frame_equal(load_results(out), before)


def test_ctrl_c_keeps_what_is_finished(tmp_path, monkeypatch):
    def interrupted(runs, jobs, **more):
        yield from run_in_order(runs[:2], **more)
        raise KeyboardInterrupt

    monkeypatch.setattr(
        "lacore_verification.harness.perform.processes.run_in_processes", interrupted
    )
    words = [BLOCK, "--vary", "mu=0.1:0.9:5", "--backends", "clarabel", "--meshes", "coarse"]
    result = command(*words, "--out", str(tmp_path))
    assert result.exit_code == 130
    assert "repeat the command to continue" in result.output
    kept = load_results(tmp_path)
    assert len(kept) == 2
    assert lacore("sweep", *words, "--out", tmp_path).exit_code == 0
    whole = load_results(tmp_path)
    assert len(whole) == 5
    pd.testing.assert_frame_equal(whole[whole["run"].isin(kept["run"])], kept)


def test_a_case_with_surprises_costs_its_rows_only():
    """Reference, validity and parameters of others: what they raise is a row's matter."""
    case, _ = find(BLOCK)
    parts = {name: getattr(case, name) for name in ("build", "band", "meshes", "unit", "title")}

    def reference(mu):
        raise ZeroDivisionError

    mine = Case(
        id="mine",
        tags=("contact",),
        explanation="",
        hand_calculation="",
        reference=reference,
        valid=reference,
        variants=(Variant("plain", {"mu": 0.5}),),
        **parts,
    )
    known = Catalogue({"mine": mine}, {"mine": "a test"})
    runs = plan(["mine"], ["mu=0.5,0.6"], ["clarabel"], ["coarse"], ["associated"], known)
    assert len(runs) == 2
    assert all(not run.skip for run in runs)


def test_missing_backends_are_rows(monkeypatch):
    def missing(name):
        raise la.CapabilityError("not here")

    monkeypatch.setattr("lacore_verification.harness.campaigns.varied.load_backend", missing)
    runs = plan([BLOCK], ["mu=0.5"], ["newton"], ["coarse"])
    assert [run.backend for run in runs] == ["newton"]
