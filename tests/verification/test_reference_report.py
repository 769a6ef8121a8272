"""The committed report is what this code finds and draws: `make reference` writes it afresh."""

import re
from functools import partial
from importlib import util

import pandas as pd
import pytest

from tests.conftest import ROOT
from verification.compare import run_all
from verification.execution import execute
from verification.provenance import describe
from verification.results import load_results
from verification.store import NAME, sessions

REPORT = ROOT / "reports" / "reference"
SAME = ["case", "variant", "backend", "coupling", "mesh", "n_elements", "n_dofs", "expected"]
SAME += ["rigor", "status", "verdict", "claimed"]


@pytest.fixture(scope="module")
def script():
    place = ROOT / "docs" / "reference_report.py"
    found = util.spec_from_file_location("reference_report", place)
    module = util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def test_its_numbers_are_found_again(script, tmp_path):
    run_all(script.runs(), tmp_path / NAME, executor=partial(execute, jobs=2))
    new, old = (load_results(place).set_index("run").sort_index() for place in (tmp_path, REPORT))
    assert list(new.index) == list(old.index), "make reference"
    pd.testing.assert_frame_equal(new[SAME], old[SAME])
    # What a certificate lets through, 1e-6, relative to the value or to the dead loads.
    for name in ("load_factor", "alpha_reg", "lambda", "P"):
        pd.testing.assert_series_equal(new[name], old[name], rtol=1e-6, atol=1e-6)


def test_it_is_drawn_again(script, tmp_path):
    """But for pictures in pixels, which may differ from processor to processor."""
    (written,) = sessions(REPORT / NAME).values()
    here = describe()
    if (here["packages"], here["python"]) != (written["packages"], written["python"]):
        pytest.skip("it was drawn with other versions of packages")
    page = script.draw(REPORT / NAME, tmp_path)
    assert without_pixels(page) == without_pixels(REPORT / "index.html"), "make reference"
    names = sorted(path.name for path in (REPORT / "tables").iterdir())
    assert names == sorted(path.name for path in (tmp_path / "tables").iterdir())
    for name in names:
        assert (tmp_path / "tables" / name).read_text() == (REPORT / "tables" / name).read_text()


def without_pixels(page):
    return re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]*", "", page.read_text(encoding="utf-8"))
