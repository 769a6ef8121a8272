"""The example package is installed as a third party would install its own, and compared.

That it is listed is in tests/test_docs.py, with the other commands of the page.
"""

import csv
import re

import pytest

from tests.conftest import ROOT


@pytest.mark.slow
def test_it_is_compared(with_example, tmp_path):
    case, backends = "shear-patch", "ecos,clarabel"
    options = ["--backends", backends, "--meshes", "coarse", "--out", str(tmp_path)]
    compared = with_example("lacore_verification", "compare", case, *options)
    assert compared.returncode == 0, compared.stdout + compared.stderr
    with (tmp_path / "results.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["backend"] for row in rows] == ["ecos", "clarabel"] * 2
    assert {row["verdict"] for row in rows} == {"pass"}
    for ecos, clarabel in (rows[:2], rows[2:]):
        assert float(ecos["load_factor"]) == pytest.approx(float(clarabel["load_factor"]), rel=1e-7)


def test_it_conforms(with_example):
    """By its own test, one call."""
    tested = with_example("pytest", "-q", "-p", "no:cacheprovider", "source/tests")
    assert tested.returncode == 0, tested.stdout + tested.stderr


def test_it_needs_no_backend_of_ours():
    text = (ROOT / "examples" / "lacore-ecos" / "lacore_ecos.py").read_text(encoding="utf-8")
    assert not re.search(r"^\s*(from|import) (backends|verification)", text, re.MULTILINE)
