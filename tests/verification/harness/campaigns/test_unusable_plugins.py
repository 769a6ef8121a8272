"""Plug-ins that cannot be used are one row each, and not among the default backends."""

from contextlib import nullcontext

import pandas as pd
import pytest

from lacore_verification.catalogue.catalogue import find
from lacore_verification.harness.campaigns import comparison, overview
from lacore_verification.harness.campaigns.comparison import unusable_backends, with_unusable
from lacore_verification.report import reporting
from tests.verification.command_line import lacore

FAULTS = {
    "absent": "No module named 'tests.nowhere'",
    "clarabel (unusable 1)": "lacore has a backend 'clarabel' of its own: register another name",
    "other": "unavailable() raised RuntimeError: no licence server",
}
TARGETS = {
    "absent": "tests.nowhere:Missing",
    "other": "tests.lying_backends:UnavailableRaises",
    "clarabel": "tests.lying_backends:Honest",
}


@pytest.fixture(scope="module")
def registered(tmp_path_factory):
    folder = tmp_path_factory.mktemp("unusable")
    info = folder / "unusable-1.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: unusable\nVersion: 1\n")
    lines = [f"{name} = {target}" for name, target in TARGETS.items()]
    (info / "entry_points.txt").write_text("\n".join(["[lacore.backends]", *lines, ""]))
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(folder))
        yield folder


def test_they_are_named_with_reason_and_file(registered):
    found = unusable_backends()
    assert set(found) == {*FAULTS}
    for name, why in found.items():
        assert str(registered) in why
        assert "unusable 1" in why
        assert FAULTS[name] in why


def test_they_are_no_default_backends(registered):
    case, (variant,) = find("shear-patch:sliding")
    names = comparison.default_backends(case, variant)
    assert not {"absent", "other"} & {*names}
    assert not {"absent", "other"} & {run.backend for run in overview.overview()}


@pytest.mark.parametrize("backends", [[], ["all"]])
def test_each_has_one_run(registered, backends):
    plan = comparison.plan(["shear-patch"], backends, ["coarse"])
    runs = with_unusable(plan, backends)
    skipped = [run for run in runs if run.backend in FAULTS]
    assert [run.backend for run in skipped] == sorted(FAULTS)
    assert [run.skip for run in skipped] == [unusable_backends()[name] for name in sorted(FAULTS)]
    usable = [run for run in plan if run.backend not in FAULTS]
    assert runs[: len(usable)] == usable
    assert len(runs) == len(usable) + len(FAULTS)


def test_backends_that_are_not_named_have_no_run(registered):
    plan = comparison.plan(["shear-patch"], ["clarabel"], ["coarse"])
    assert with_unusable(plan, ["clarabel"]) == plan


def test_a_comparison_runs_the_others(registered, tmp_path, monkeypatch):
    monkeypatch.setattr(reporting, "pictures_of", lambda subjects: nullcontext({}))
    words = ("shear-patch:sliding", "shear-patch:yielding", "--meshes", "coarse")
    found = lacore("compare", *words, "--backends", "clarabel,absent", "--out", tmp_path)
    assert found.exit_code == 0, found.output
    table = pd.read_csv(tmp_path / "results.csv")
    *others, last = table["backend"]
    assert ({*others}, last) == ({"clarabel"}, "absent")
    assert [*table["verdict"]] == ["pass"] * len(others) + ["skipped"]
    assert str(registered) in table["message"].iloc[-1]
