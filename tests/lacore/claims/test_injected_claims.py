"""Claims that are wrong in exactly one way are refused."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.claims.dead_collapse import DeadCollapse
from lacore.claims.free_motion import without_dissipation
from lacore.program import associated_contact
from tests.lacore.planted import MU, P0, on_free_unknowns, sliding

TOLERANCE = 1e-6
FALLING = DeadCollapse(power=1.0, carried=0.5, felt=0.0, impossible=0.0, point=sliding()[1])


def test_a_mechanism_that_the_dead_load_drives_proves_a_collapse():
    assert FALLING.proves(TOLERANCE)


@pytest.mark.parametrize(
    "wrong",
    [
        {"carried": 1.0},  # as much is dissipated: the structure stands, just
        {"carried": 1.0 - TOLERANCE / 2},
        {"power": 1.0 + 2 * TOLERANCE},
        {"power": 1.0 - 2 * TOLERANCE},
        {"felt": 2 * TOLERANCE},
        {"impossible": 2 * TOLERANCE},
    ],
    ids=str,
)
def test_one_wrong_number_proves_no_collapse(wrong):
    assert not replace(FALLING, **wrong).proves(TOLERANCE)


def rising(opening):
    """A square pushed by mu times its weight: at load factor 0 it slides, and may rise."""
    d, state = sliding()
    problem = d.problem
    push = la.Traction("block", "top", (MU * P0, 0))
    program = la.discretise(replace(problem, dead_loads=[*problem.dead_loads, push])).program

    def field(x):
        return np.stack([np.ones_like(x[0]), np.full_like(x[0], opening)])

    return program, replace(state, velocity=on_free_unknowns(d, field), load_factor=0.0)


def test_sliding_that_lifts_a_weight_is_no_free_motion():
    """With associated friction it rises by mu: the push does all of the power of the weight.

    Nothing dissipates and the loads do no power together, but the square presses on its base.
    """
    program, state = rising(MU)
    contact = associated_contact(program.contact)
    assert abs(program.dead_load @ state.velocity) <= 1e-12
    assert not without_dissipation(program, state, contact, TOLERANCE)
    loose = replace(state, normal_reaction=0 * state.normal_reaction)
    assert without_dissipation(program, loose, contact, TOLERANCE)
