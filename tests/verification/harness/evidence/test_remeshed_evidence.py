"""The last step of a path on new meshes, with a tool, as bytes and back."""

from typing import Any

import pytest

import lacore as la
from lacore.paths.flow import limit_problem
from lacore_verification.case.following import Following
from lacore_verification.cases import wedge_indentation
from lacore_verification.harness.evidence.path import (
    _arrays,
    _unpacked,
    packed_step,
    restored_stage,
)


@pytest.mark.slow
def test_a_step_on_new_meshes_is_restored() -> None:
    given: dict[str, Any] = {
        "half_angle": 45.0,
        "friction": 0.1,
        "cells": 4,
        "steps": 16,
        "scheme": "leapfrog",
    }
    problem, case = wedge_indentation.build(**given), wedge_indentation.path(**given)
    stated = Following(0.25, 4, "leapfrog", case.control, tools=case.tools, remesh=case.remesh)
    path = la.sequential(
        stated.problem(problem),
        stated.travel,
        stated.steps,
        stated.scheme,
        stated.control,
        tools=stated.tools,
        remesh=stated.remesh,
    )
    assert path.later
    assert path.last is not None
    data = packed_step(path.last, path.snapshots[-1], path.later)
    stage = restored_stage(stated, problem, _arrays(data))
    moment, _ = _unpacked(data, list(stage.start.nodes))
    found, known = limit_problem(stage, moment), path.last.discretisation
    assert found.full.n == known.full.n
    assert found.points.gap == pytest.approx(known.points.gap, abs=1e-12)
    assert abs(found.full.contact.normal - known.full.contact.normal).nnz == 0
    assert found.full.reference_load == pytest.approx(known.full.reference_load, abs=1e-12)
