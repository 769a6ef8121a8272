"""Pages that several files of tests open."""

import pandas as pd
import pytest

from lacore_verification.report import files
from lacore_verification.report.blocks import Page, Report, Section, Table
from lacore_verification.report.columns import Column
from tests.verification.command_line import lacore


@pytest.fixture(scope="session")
def compared(tmp_path_factory):
    """The page of a comparison: numbers, an interval, a skipped run, a sweep, pictures."""
    out = tmp_path_factory.mktemp("report")
    block = [f"deformable-block:{variant}" for variant in ("sliding", "crushing", "mu-0.7")]
    options = ["--meshes", "coarse", "--backends", "clarabel,newton", "--out", out]
    result = lacore("compare", "wall-1:mu-0.65", *block, *options)
    assert result.exit_code == 0, result.output
    return out / "index.html"


@pytest.fixture(scope="session")
def page_of_case(compared):
    """One of its pages of cases."""
    return compared.parent / "cases" / "deformable-block.html"


@pytest.fixture
def alone(tmp_path):
    """Writes a report of one page; gives its path."""
    return lambda page: files.write(Report({"index.html": page}), tmp_path)


MIXED = pd.DataFrame(
    {
        "name": ["b", "a10", "", "a9", "B"],
        "value": [-1.0, 100.0, float("nan"), float("inf"), 9.0],
        "mesh": ["fine", "coarse", "medium", "coarse", "finest"],
        "n_elements": [300, 20, 100, 20, 1000],
    }
)


@pytest.fixture
def sorted_page(visit, alone):
    columns = (Column("name"), Column("value", form="g"), Column("mesh", order="n_elements"))
    table = Section("one", "One", [Table(columns, MIXED)])
    return visit(alone(Page("Sorting", "", [table])))
