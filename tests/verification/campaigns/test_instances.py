"""Programs as files: read by others, they have the values that the index says."""

import hashlib

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner
from scipy.sparse import coo_array, csc_array

from verification.commands.cli import main

CASES = [
    "shear-patch:sliding",
    "portal-sway:sways",
    "wall-1",
    "biaxial:cut-off",
    "torque-four:unit",
]


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    out = tmp_path_factory.mktemp("instances")
    command = ["export", *CASES, "--meshes", "coarse", "--formats", "npz,cbf,mps"]
    answer = CliRunner().invoke(main, [*command, "--out", str(out)])
    assert answer.exit_code == 0, answer.output
    return out, pd.read_csv(out / "index.csv")


def least(columns, cost, rows, offset, cones):
    """The least value of ``cost.x`` with ``offset + rows x`` in cones, by another modelling."""
    import cvxpy as cp  # here: it takes a second to load

    x = cp.Variable(columns)
    given, first = [], 0
    for kind, size in cones:
        part = rows[first : first + size] @ x + offset[first : first + size]
        first += size
        if kind in ("L=", "zero"):
            given.append(part == 0)
        elif kind in ("L+", "nonnegative"):
            given.append(part >= 0)
        else:
            assert kind in ("Q", "second-order")
            given.append(cp.SOC(part[0], part[1:]))
    assert first == rows.shape[0]
    problem = cp.Problem(cp.Minimize(cost @ x), given)
    return problem.solve(solver=cp.CLARABEL)


def of_npz(file):
    kept = np.load(file)
    matrix = csc_array((kept["A_data"], kept["A_indices"], kept["A_indptr"]))
    assert kept["P_data"].size == 0
    assert 0 < kept["n"] <= kept["q"].size
    cones = zip(kept["cones"].tolist(), kept["sizes"].tolist(), strict=True)
    return least(kept["q"].size, kept["q"], -matrix, kept["b"], cones)


def of_cbf(file):
    words = iter(file.read_text(encoding="ascii").split())
    found, cones = {}, []
    for word in words:
        if word == "VAR":
            columns, _ = int(next(words)), next(words)
            assert (next(words), int(next(words))) == ("F", columns)
        elif word == "CON":
            count, kinds = int(next(words)), int(next(words))
            cones = [(next(words), int(next(words))) for _ in range(kinds)]
            assert sum(size for _, size in cones) == count
        elif word.endswith("COORD"):
            places = 2 if word == "ACOORD" else 1
            size = int(next(words))
            found[word] = np.array(
                [[float(next(words)) for _ in range(places + 1)] for _ in range(size)]
            ).reshape(size, places + 1)
        else:
            assert (word, next(words)) in (("VER", "3"), ("OBJSENSE", "MIN"))
    cost, offset = np.zeros(columns), np.zeros(count)
    cost[found["OBJACOORD"][:, 0].astype(int)] = found["OBJACOORD"][:, 1]
    offset[found["BCOORD"][:, 0].astype(int)] = found["BCOORD"][:, 1]
    row, column, value = found["ACOORD"].T
    rows = coo_array((value, (row.astype(int), column.astype(int))), shape=(count, columns))
    return least(columns, cost, rows.tocsr(), offset, cones)


def of_mps(file):
    import highspy

    model = highspy.Highs()
    model.setOptionValue("output_flag", False)
    model.readModel(str(file))
    model.run()
    assert model.getModelStatus() == highspy.HighsModelStatus.kOptimal
    return model.getInfo().objective_function_value


READERS = {"npz": of_npz, "cbf": of_cbf, "mps": of_mps}


def test_others_find_the_value_of_the_index(written):
    out, index = written
    there = index[index.file.notna()]
    assert len(there) == 2 * len(CASES) + 2  # two of the five are linear programs
    for row in there.itertuples():
        assert row.status == "SOLVED"
        assert row.residual <= 1e-6
        value = READERS[row.file.rpartition(".")[2]](out / row.file)
        # Both are solved to 1e-8 or better; a certificate holds to 1e-6.
        assert value == pytest.approx(row.value, rel=1e-6)
        assert hashlib.sha256((out / row.file).read_bytes()).hexdigest() == row.sha256


def test_what_is_no_linear_program_is_left_out_with_the_reason(written):
    _, index = written
    left = index[index.file.isna()]
    assert len(left) == 3
    assert left.left_out.str.contains("linear programs").all()


def test_a_wrong_name_is_told_before_anything_is_written(tmp_path):
    for words in (["export", "shear-pach"], ["export", "shear-patch", "--formats", "cfb"]):
        answer = CliRunner().invoke(main, [*words, "--out", str(tmp_path / "none")])
        assert answer.exit_code == 2
        assert "did you mean" in answer.output
        assert not (tmp_path / "none").exists()
