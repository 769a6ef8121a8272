"""Cone programs as files for other solvers: npz and CBF. Not a backend.

``minimise x.P x/2 + q.x  subject to  b - A x in cones``, as in `lacore_backends._conic_form`, with
the ``F0.U = POWER`` of the program, so that the optimal value is the same in all formats.
"""

from pathlib import Path
from typing import Any, TextIO

import clarabel
import numpy as np
from scipy.sparse import csc_matrix

from lacore.numerics.arrays import Floats
from lacore.program import POWER, FrozenContact, KinematicProgram
from lacore.reporting.errors import InputError
from lacore_backends._conic_form import ConicForm, Pattern

_ZERO, _NONNEGATIVE, _SECOND_ORDER = "zero", "nonnegative", "second-order"
_KINDS = {
    clarabel.ZeroConeT: _ZERO,
    clarabel.NonnegativeConeT: _NONNEGATIVE,
    clarabel.SecondOrderConeT: _SECOND_ORDER,
}
_IN_CBF = {_ZERO: "L=", _NONNEGATIVE: "L+", _SECOND_ORDER: "Q"}


def write_npz(program: KinematicProgram, contact: FrozenContact, path: Path) -> None:
    """Write NumPy arrays, as listed in docs/guide/programs-as-files.md."""
    form = _form(program, contact)
    kinds = np.array([_KINDS[type(cone)] for cone in form.cones])
    arrays = {
        **_by_columns("P", form.quadratic),
        **_by_columns("A", form.matrix),
        "q": form.cost(contact),
        "b": form.offset(contact) / form.speed,
        "cones": kinds,
        "sizes": np.array([cone.dim for cone in form.cones]),
        "n": np.array(program.n),
        "power": np.array(POWER),
        "load_factor_unit": np.array(program.scales.load_factor),
    }
    np.savez_compressed(path, **arrays)


def write_cbf(program: KinematicProgram, contact: FrozenContact, path: Path) -> None:
    """Write the Conic Benchmark Format of Friberg (2016), version 3.

    Raises:
        InputError: the program hardens, and the format has no quadratic costs.
    """
    form = _form(program, contact)
    if form.quadratic.nnz:
        why = "the program hardens, and CBF has no quadratic costs"
        raise InputError("path", str(path), why, "write .npz")
    rows, columns = form.matrix.shape
    cones = [f"{_IN_CBF[_KINDS[type(cone)]]} {cone.dim}" for cone in form.cones]
    cost, offset = form.cost(contact), form.offset(contact) / form.speed
    matrix = csc_matrix(-form.matrix).tocoo()
    with path.open("w", encoding="ascii") as file:
        file.write(heading("#", program))
        file.write("VER\n3\n\nOBJSENSE\nMIN\n\n")
        file.write(f"VAR\n{columns} 1\nF {columns}\n\n")
        file.write("\n".join([f"CON\n{rows} {len(cones)}", *cones, "", ""]))
        _entries(file, "OBJACOORD", [np.flatnonzero(cost)], cost[cost != 0])
        _entries(file, "ACOORD", [matrix.row, matrix.col], matrix.data)
        _entries(file, "BCOORD", [np.flatnonzero(offset)], offset[offset != 0])


def heading(mark: str, program: KinematicProgram) -> str:
    """Return comment lines that describe the contents of a text file, each after a mark."""
    lines = (
        "Limit analysis: minimise the dissipation of a collapse mechanism.",
        f"Columns: {program.n} velocities U come first.",
        f"Row 1: F0.U = {POWER:g}, where F0 is the reference load.",
        f"Load factor = minimum value times {program.scales.load_factor!r}.",
    )
    return "".join(f"{mark} {line}\n" for line in lines)


def _form(program: KinematicProgram, contact: FrozenContact) -> ConicForm:
    return ConicForm(program, contact, Pattern.of(contact), None)


def _by_columns(name: str, matrix: Any) -> dict[str, Any]:
    ordered = csc_matrix(matrix)
    ordered.sort_indices()
    parts = ("data", "indices", "indptr", "shape")
    return {f"{name}_{part}": np.asarray(getattr(ordered, part)) for part in parts}


def _entries(file: TextIO, keyword: str, places: list[Any], values: Floats) -> None:
    """Write a block of coordinates; each value keeps all its digits."""
    columns = [*(place.tolist() for place in places), map(repr, values.tolist())]
    file.write(f"{keyword}\n{values.size}\n")
    file.writelines(f"{' '.join(map(str, row))}\n" for row in zip(*columns, strict=True))
    file.write("\n")
