"""Exported programs, read from their files and solved by solvers that the index does not use.

ECOS has no wheels for Python 3.13. Without it, QOCO and SCS solve the same files.
"""

import importlib
from dataclasses import dataclass
from importlib.util import find_spec

import highspy
import numpy as np
import qoco
import scs
from scipy.sparse import coo_array, csc_matrix

_TOLERANCES = (1e-9, 1e-8, 1e-7)  # the next where no solver reaches the one before
_FEW = 20_000  # entries of the matrix: first-order steps for more take hours
_REST = 1e-6  # of duals that prove a minimum: costs are of order 1
_ECOS = {0: "SOLVED", 1: "LOCKED", 2: "UNSAFE"}
_INACCURATE = 10
_CBF = {"L=": "zero", "L+": "nonnegative", "Q": "second-order"}


@dataclass(frozen=True)
class Answer:
    """What a solver says: a status of lacore by its name, or None, and the value.

    `gap` is relative, and that of an answer which the solver itself calls inaccurate.
    """

    solver: str
    status: str | None
    value: float
    gap: float = 0.0


@dataclass(frozen=True)
class ConeProgram:
    """Minimise ``q x`` with ``b - A x`` in cones; `zero` and `positive` rows come first."""

    q: np.ndarray
    matrix: csc_matrix
    b: np.ndarray
    zero: int
    positive: int
    second: list[int]


def cone_program(q, matrix, b, kinds, sizes):
    order = {"zero": 0, "nonnegative": 1, "second-order": 2}
    places = [order[kind] for kind in kinds]
    assert places == sorted(places)
    assert sum(sizes) == matrix.shape[0] == b.size
    assert q.size == matrix.shape[1]
    zero, positive, second = (
        [int(size) for place, size in zip(places, sizes, strict=True) if place == own]
        for own in range(3)
    )
    assert len(zero) == 1
    assert len(positive) <= 1
    return ConeProgram(q, csc_matrix(matrix), b, sum(zero), sum(positive), second)


def read_npz(path):
    kept = np.load(path)
    assert kept["P_data"].size == 0
    parts = [kept[f"A_{part}"] for part in ("data", "indices", "indptr")]
    matrix = csc_matrix(tuple(parts), tuple(kept["A_shape"]))
    return cone_program(
        kept["q"], matrix, kept["b"], kept["cones"].tolist(), kept["sizes"].tolist()
    )


def read_cbf(path):
    lines = path.read_text(encoding="ascii").splitlines()
    words = iter(" ".join(line for line in lines if not line.startswith("#")).split())
    found, cones = {}, []
    for word in words:
        if word == "VAR":
            columns, _ = int(next(words)), next(words)
            assert (next(words), int(next(words))) == ("F", columns)
        elif word == "CON":
            count, kinds = int(next(words)), int(next(words))
            cones = [(_CBF[next(words)], int(next(words))) for _ in range(kinds)]
        elif word.endswith("COORD"):
            places = 2 if word == "ACOORD" else 1
            entries = [
                [float(next(words)) for _ in range(places + 1)] for _ in range(int(next(words)))
            ]
            found[word] = np.array(entries).reshape(-1, places + 1)
        else:
            assert (word, next(words)) in (("VER", "3"), ("OBJSENSE", "MIN"))
    cost, offset = np.zeros(columns), np.zeros(count)
    cost[found["OBJACOORD"][:, 0].astype(int)] = found["OBJACOORD"][:, 1]
    offset[found["BCOORD"][:, 0].astype(int)] = found["BCOORD"][:, 1]
    row, column, value = found["ACOORD"].T
    rows = coo_array((value, (row.astype(int), column.astype(int))), shape=(count, columns))
    kinds, sizes = zip(*cones, strict=True)
    return cone_program(cost, -rows.tocsc(), offset, kinds, sizes)


def by_ecos(program, tolerance, statuses=_ECOS):
    ecos = importlib.import_module("ecos")
    rows = program.matrix.tocsr()
    equal, b = rows[: program.zero], program.b[: program.zero]
    # ECOS does not take rows without entries.
    filled = np.diff(equal.indptr) > 0
    assert not b[~filled].any()
    found = ecos.solve(
        program.q,
        rows[program.zero :].tocsc(),
        program.b[program.zero :],
        {"l": program.positive, "q": program.second},
        equal[filled].tocsc(),
        b[filled],
        verbose=False,
        max_iters=200,
        **dict.fromkeys(("abstol", "reltol", "feastol"), tolerance),
    )["info"]
    flag = found["exitFlag"]
    gap = found["relgap"] if flag == _INACCURATE else 0.0
    return Answer("ECOS", statuses.get(flag), found["pcost"], gap)


def by_qoco(program, tolerance, least=_REST, statuses=("QOCO_SOLVED",)):
    solver, rows, first = qoco.QOCO(), program.matrix.tocsr(), program.zero
    solver.setup(
        program.q.size,
        program.b.size - first,
        first,
        None,
        program.q,
        rows[:first].tocsc(),
        program.b[:first],
        rows[first:].tocsc(),
        program.b[first:],
        program.positive,
        len(program.second),
        np.array(program.second, dtype=int),
        abstol=tolerance,
        reltol=tolerance,
    )
    found = solver.solve()
    # Without a minimum it goes along a ray, and calls what is small per point solved.
    rest = program.q + program.matrix.T @ np.concatenate([found.y, found.z])
    solved = found.status in statuses and np.abs(rest).max() <= least
    return Answer("QOCO", "SOLVED" if solved else None, found.obj)


def by_scs(program, tolerance):
    found = scs.SCS(
        {"A": program.matrix, "b": program.b, "c": program.q},
        {"z": program.zero, "l": program.positive, "q": program.second},
        eps_abs=tolerance,
        eps_rel=tolerance,
        max_iters=1_000_000,
        verbose=False,
    ).solve()["info"]
    status = {"solved": "SOLVED", "infeasible": "LOCKED", "unbounded": "UNSAFE"}
    return Answer("SCS", status.get(found["status"]), found["pobj"])


def by_highs(path):
    model = highspy.Highs()
    model.setOptionValue("output_flag", False)
    model.setOptionValue("presolve", "off")  # else it does not say which of both
    model.setOptionValue("small_matrix_value", 1e-12)
    model.readModel(str(path))
    model.run()
    status = {"kOptimal": "SOLVED", "kInfeasible": "LOCKED", "kUnbounded": "UNSAFE"}
    return Answer(
        "HiGHS",
        status.get(model.getModelStatus().name),
        model.getInfo().objective_function_value,
    )


def cone_solvers():
    """Those that are installed, the most accurate one first."""
    return [by_ecos, by_qoco] if find_spec("ecos") else [by_qoco]


def solve_file(path):
    """The answer of the first solver that is sure of it; None where none is."""
    if path.suffix == ".mps":
        return by_highs(path)
    program = {".npz": read_npz, ".cbf": read_cbf}[path.suffix](path)
    tries = [(solve, tolerance) for tolerance in _TOLERANCES for solve in cone_solvers()]
    tries += [(by_scs, 1e-9)] if program.matrix.nnz <= _FEW else [(nearly_solved, 1e-7)]
    answers = (solve(program, tolerance) for solve, tolerance in tries)
    return next((answer for answer in answers if answer.status), None)


def nearly_solved(program, tolerance):
    """By a solver that may call it inaccurate: whether it is, the comparison of values tells.

    ECOS comes first: on meshes of thin triangles QOCO leaves 1e-5 of the value.
    """
    if find_spec("ecos"):
        answer = by_ecos(program, tolerance, {**_ECOS, _INACCURATE: "SOLVED"})
        if answer.status:
            return answer
    return by_qoco(program, tolerance, 10 * _REST, ("QOCO_SOLVED", "QOCO_SOLVED_INACCURATE"))
