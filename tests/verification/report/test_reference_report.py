"""The committed report is what this code finds and draws: `make reference` writes it afresh."""

import re
from contextlib import nullcontext
from importlib import util

import pandas as pd
import pytest

from lacore_verification.harness.campaigns.run_all import run_all
from lacore_verification.harness.store.provenance import describe
from lacore_verification.harness.store.results import load_results
from lacore_verification.harness.store.store import NAME, sessions
from lacore_verification.report.blocks import Picture
from lacore_verification.report.files import file_names, write
from tests.conftest import ROOT
from tests.verification.command_line import run_in_order

REPORT = ROOT / "reports" / "reference"
SAME = ["case", "variant", "backend", "coupling", "mesh", "n_elements", "n_dofs", "expected"]
# Residuals decide these; what a solver claims of itself, at its limit, differs by processor.
SAME += ["rigor", "status", "verdict"]
NUMBER = re.compile(r"[-+\N{MINUS SIGN}]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


@pytest.fixture(scope="module")
def script():
    place = ROOT / "docs" / "reference_report.py"
    found = util.spec_from_file_location("reference_report", place)
    module = util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


@pytest.mark.parametrize("every", [pytest.param(1, marks=pytest.mark.slow), 8])
def test_its_numbers_are_found_again(script, tmp_path, every):
    """Of all runs, or of one in so many."""
    runs = script.runs()
    run_all(runs[::every], tmp_path / NAME, executor=run_in_order)
    new, old = (load_results(place).set_index("run").sort_index() for place in (tmp_path, REPORT))
    assert set(old.index) == {run.key for run in runs}, "make reference"
    old = old.loc[new.index]
    pd.testing.assert_frame_equal(new[SAME], old[SAME])
    # What certificates let through, 1e-6 each, relative to the value or to the dead loads.
    for name in ("load_factor", "alpha_reg", "lambda", "P"):
        pd.testing.assert_series_equal(new[name], old[name], rtol=2e-6, atol=2e-6)


def test_it_is_small():
    files = [path for path in REPORT.rglob("*") if path.is_file()]
    assert sum(path.stat().st_size for path in files) <= 1_700_000


def test_it_is_drawn_again(script, tmp_path):
    """The same pages of the same parts, with numbers that round-off alone changes.

    Fits and means are computed from what is stored, with least squares of the processor.
    """
    (written,) = sessions(REPORT / NAME).values()
    here = describe(run.backend for run in script.runs())
    known = set(written["packages"].split(", "))
    if here["python"] != written["python"] or not set(here["packages"].split(", ")) <= known:
        pytest.skip("it was drawn with other versions of packages")
    write(script.report(REPORT / NAME, lambda own: nullcontext(painted(own))), tmp_path)
    old, new = (names(place) for place in (REPORT, tmp_path))
    assert new == old - {NAME}, "make reference"
    for name in new:
        if name.endswith(".html"):
            found, kept = ((place / name).read_text("utf-8") for place in (tmp_path, REPORT))
            assert NUMBER.sub("#", found) == NUMBER.sub("#", kept), "make reference"
        elif name.endswith(".csv"):
            # Laws of at most ten points over four decades: least squares lose three digits of 16;
            # floors and uncertainties are differences of such values, with errors of their size.
            same = {"rtol": 1e-9, "atol": 1e-12}
            pd.testing.assert_frame_equal(
                pd.read_csv(tmp_path / name), pd.read_csv(REPORT / name), **same
            )


def painted(subjects):
    """The pictures that are kept: pixels may differ from processor to processor."""
    kept = REPORT / "pictures"
    files = file_names(subject.name for subject in subjects)
    found = {}
    for one, file in zip(subjects, files, strict=True):
        data, small = ((kept / f"{file}{end}.png").read_bytes() for end in ("", "-thumbnail"))
        thumbnail = Picture(f"{one.name}-thumbnail", one.caption, small, shown_at=0.5)
        found[one.name] = Picture(one.name, one.caption, data, thumbnail)
    return found


def names(folder):
    """Files of a report."""
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
