"""What others write into a table is no formula when a spreadsheet opens it."""

import csv

import numpy as np
import pandas as pd
import pytest

from lacore_verification.harness.store.results import export
from lacore_verification.harness.store.spreadsheets import as_text, as_written, quoted, unquoted
from lacore_verification.report.blocks import Table
from lacore_verification.report.columns import Column
from lacore_verification.report.files import markdown

FORMULAS = [
    "=HYPERLINK(1)", "+HYPERLINK(1)", "-HYPERLINK(1)", "@SUM(1)", "\t=1", "\n=1", "=2", "=",
    "-1+1", "-2-cmd|' /C calc'!A0", "+1-1", "＝1", "'=1", "''@x",  # noqa: RUF001
]  # fmt: skip
PLAIN = ["-1", "-0.5", "+3", "-1e-5", "-inf", "nan", "a=b", "x-y", "-", "", "'text", " =1", "1"]


@pytest.mark.parametrize("text", FORMULAS)
def test_a_formula_is_text(text):
    assert as_text(text) == "'" + text
    assert as_written(as_text(text)) == text


@pytest.mark.parametrize("value", [*PLAIN, -1, -2.5, np.float64(-1e-9), True, None, pd.NA])
def test_numbers_and_plain_text_stay_as_they_are(value):
    assert as_text(value) is value
    assert as_written(value) is value


def test_a_table_comes_back_as_it_was(tmp_path):
    frame = pd.DataFrame(
        {
            "=case": pd.array(FORMULAS, dtype="string"),
            "value": -1.5 * np.arange(len(FORMULAS)),
            "count": pd.array([-1, None] * (len(FORMULAS) // 2), dtype="Int64"),
            "mixed": [-1, "=1"] * (len(FORMULAS) // 2),
        }
    )
    pd.testing.assert_frame_equal(unquoted(quoted(frame)), frame)
    export(frame, tmp_path / "t.csv")
    with (tmp_path / "t.csv").open(newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    assert head[0] == "'=case"
    for row, text in zip(rows, FORMULAS, strict=True):
        assert row[0] == "'" + text
        assert row[3] in ("-1", "'=1")
    assert [float(row[1]) for row in rows] == frame["value"].tolist()


def test_a_carriage_return_ends_no_row(tmp_path):
    export(pd.DataFrame({"name": ["\r=1", "a\r=1"], "n": [1, 2]}), tmp_path / "t.csv")
    with (tmp_path / "t.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    assert [len(row) for row in rows] == [2, 2, 2]
    assert rows[1][0] == "'\n=1"


def test_tables_that_people_read_show_text_as_it_is():
    """What is allowed begins with a sign: a mark before it would be read as a part of it."""
    table = Table(
        (Column("allowed"), Column("value", form=".2f")),
        pd.DataFrame({"allowed": ["-1e-06 ... +0.03", "plain"], "value": [-1.0, 2.0]}),
    )
    lines = markdown(table).splitlines()
    assert lines[2:] == ["| -1e-06 ... +0.03 | -1.00 |", "| plain | 2.00 |"]
