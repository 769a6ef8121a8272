"""Exported programs: other solvers find the values of the index, and the guide lists all keys."""

import hashlib
import re

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

from lacore_verification.commands.cli import main
from lacore_verification.harness.campaigns.instances import Instance
from tests.conftest import ROOT
from tests.program_files import solve_file

GUIDE = ROOT / "docs" / "guide" / "programs-as-files.md"
CASES = [
    "shear-patch:sliding",
    "portal-sway:sways",
    "propped-beam:propped",
    "wall-1",
    "biaxial:cut-off",
    "strip-footing:phi-30",
    "vertical-cut-phi:phi-20",
    "torque-four:unit",
    "symmetric-wedge:jam",
    "symmetric-wedge:plug",
    "block-incline-vertical:slippery-pulled",
]


def export(out, *words):
    command = ["export", *words, "--formats", "npz,cbf,mps", "--out", str(out)]
    answer = CliRunner().invoke(main, command)
    assert answer.exit_code == 0, answer.output
    return out, pd.read_csv(out / "index.csv")


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    return export(tmp_path_factory.mktemp("instances"), *CASES, "--meshes", "coarse")


def agree(out, index):
    """Every file has the checksum, the status and the value that the index states."""
    there = index[index.file.notna()]
    for row in there.itertuples():
        path = out / row.file
        assert hashlib.sha256(path.read_bytes()).hexdigest() == row.sha256
        if row.status == "ALMOST_SOLVED":
            assert np.isnan(row.value)
            assert row.residual > 1e-7
            continue
        answer = solve_file(path)
        assert answer is not None, row.file
        assert answer.status == row.status, row.file
        # A load factor of zero is known to what a solver leaves of forces of order 1.
        if row.status == "SOLVED":
            rel = max(1e-6, answer.gap)  # the other solver knows its own value no better
            assert answer.value == pytest.approx(row.value, rel=rel, abs=1e-9), row.file
            assert row.residual <= 1e-7
        else:
            assert np.isnan(row.value)
    return there


def test_other_solvers_find_the_values_and_statuses_of_the_index(written):
    there = agree(*written)
    assert set(there.status) == {"SOLVED", "LOCKED", "UNSAFE"}
    ends = there.file.str.rpartition(".")[2]
    assert (ends == "npz").sum() == (ends == "cbf").sum() > (ends == "mps").sum() >= 5


@pytest.mark.slow
def test_other_solvers_find_the_values_of_all_cases(tmp_path):
    there = agree(*export(tmp_path))
    assert len(there) > 500
    assert (there.status == "ALMOST_SOLVED").mean() < 0.01


def test_units_turn_values_into_load_factors(written):
    _, index = written
    solved = index[index.status == "SOLVED"]
    assert (solved.power == 1).all()
    np.testing.assert_allclose(solved.value * solved.load_factor_unit, solved.load_factor)
    # Of bodies of unit thickness a load factor is that of a power: force times velocity.
    plane = solved[solved.case == "vertical-cut-phi"]
    unit = plane.stress_unit * plane.length_unit * plane.velocity_unit
    np.testing.assert_allclose(unit, plane.load_factor_unit)


def table(heading):
    """First cells of the table below a heading of the guide, without their marks."""
    section = GUIDE.read_text(encoding="utf-8").split(f"## {heading}\n")[1]
    rows = section.split("\n|---")[1].split("\n\n")[0].splitlines()[1:]
    return [re.match(r"\| `([^`]+)` \|(?: `([^`]+)` \|)?", row).groups() for row in rows]


def test_the_guide_lists_the_arrays_with_their_shapes(written):
    out, index = written
    for name in index.file[index.file.str.endswith(".npz", na=False)]:
        kept = np.load(out / name)
        listed = dict(table("The arrays of an npz file"))
        assert list(kept) == list(listed)
        rows, columns = kept["A_shape"]
        sizes = {"N": columns, "M": rows, "K": kept["cones"].size}
        for key, text in listed.items():
            nnz = kept[f"{key[0]}_data"].size if "nnz" in text else 0
            assert kept[key].shape == eval(text, {"nnz": nnz, **sizes}), key
        assert kept["sizes"].sum() == rows
        assert kept["P_shape"].tolist() == [columns, columns]
        assert kept["b"][0] == kept["power"] == 1
        (row,) = index[index.file == name].itertuples()
        assert kept["n"] == row.unknowns
        assert kept["load_factor_unit"] == pytest.approx(row.load_factor_unit, rel=1e-12)


def test_the_guide_lists_the_kinds_of_cones(written):
    out, index = written
    names = index.file[index.file.str.endswith(".npz", na=False)]
    found = {kind for name in names for kind in np.load(out / name)["cones"].tolist()}
    text = GUIDE.read_text(encoding="utf-8").split("| name | rows")[1].split("\n\n")[0]
    assert found == set(re.findall(r"^\| `([a-z-]+)` \|", text, re.MULTILINE))


def test_the_guide_lists_the_columns_of_the_index(written):
    _, index = written
    listed = [name for name, _ in table("The columns of index.csv")]
    assert listed == list(Instance.__annotations__) == list(index.columns)


def test_text_files_state_their_normalisation(written):
    out, index = written
    texts = index[index.file.str.endswith((".cbf", ".mps"), na=False)]
    for row in texts.itertuples():
        head = (out / row.file).read_text(encoding="ascii")[:400]
        assert f"{row.unknowns} velocities" in head
        assert "F0.U = 1," in head


def test_what_is_no_linear_program_is_left_out_with_the_reason(written):
    _, index = written
    left = index[index.file.isna()]
    assert len(left) >= 3
    assert left.left_out.str.contains("linear programs").all()


def test_a_wrong_name_is_told_before_anything_is_written(tmp_path):
    for words in (["export", "shear-pach"], ["export", "shear-patch", "--formats", "cfb"]):
        answer = CliRunner().invoke(main, [*words, "--out", str(tmp_path / "none")])
        assert answer.exit_code == 2
        assert "did you mean" in answer.output
        assert not (tmp_path / "none").exists()
