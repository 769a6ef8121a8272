"""The dense minimiser of scipy: its statuses, and what is rechecked of them."""

import ast
import inspect
import textwrap

import numpy as np
import pytest
from scipy.optimize import _slsqp_py
from scipy.sparse import csr_matrix

from lacore.program.reduction import reduced
from lacore.reporting.errors import CapabilityError
from lacore.reporting.status import Status
from lacore.solvers.backend import find_backend
from lacore_backends import slsqp_nlp
from lacore_backends.slsqp_nlp import AWAY, LATE, Minimum
from lacore_verification.conformance.programs import WORKED

PLASTIC = next(worked for worked in WORKED if worked.name == "several cones")


def exit_modes():
    """The keys of a dictionary inside SLSQP's own function."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(_slsqp_py._minimize_slsqp)))
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "exit_modes":
            return set(ast.literal_eval(node.value))
    raise AssertionError("SLSQP keeps its exit modes elsewhere now")


def test_every_native_status_is_mapped():
    assert set(slsqp_nlp.STATUS_MAP) == exit_modes() | {LATE, AWAY}


def reporting(native, displaced):
    """SLSQP with another status and a displaced solution."""
    original = slsqp_nlp._minimise

    def minimise(objective, start, load, options, watch):
        end = original(objective, start, load, options, watch)
        away = np.linspace(-1, 1, start.size)
        away -= (away @ load) / (load @ load) * load
        y = end.y + displaced * away
        return Minimum(y, native, "its word", end.iterations, end.multiplier)

    return minimise


@pytest.mark.parametrize(
    ("native", "displaced", "status"),
    [
        (0, 0.0, Status.SOLVED),
        (0, 0.3, Status.STALLED),  # a success that the forces refute
        (8, 0.0, Status.ALMOST_SOLVED),  # a failure at round-off
        (8, 0.3, Status.STALLED),
        (9, 0.0, Status.ITERATION_LIMIT),
    ],
)
def test_its_word_is_rechecked_by_the_forces(native, displaced, status, monkeypatch):
    monkeypatch.setattr(slsqp_nlp, "_minimise", reporting(native, displaced))
    backend = slsqp_nlp.Slsqp()
    solver = backend.prepare(PLASTIC.program, backend.Options())
    assert solver.solve(PLASTIC.contact).status is status


def test_a_failed_solve_is_no_start_for_the_next():
    backend = slsqp_nlp.Slsqp()
    solver = backend.prepare(PLASTIC.program, backend.Options(max_iterations=1))
    assert solver.solve(PLASTIC.contact).status is Status.ITERATION_LIMIT
    assert solver._start is None


def test_one_unknown_is_refused():
    """SLSQP with as many equalities as unknowns has corrupted the heap of old scipys."""
    lonely = next(worked for worked in WORKED if worked.name == "one cone").program
    basis = lonely.reference_load[:, None] / np.linalg.norm(lonely.reference_load)
    backend = find_backend("slsqp")
    with pytest.raises(CapabilityError, match="take an exact backend"):
        backend.prepare(reduced(lonely, csr_matrix(basis)), backend.Options())
