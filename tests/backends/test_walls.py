"""All kinds of backends on a wall of rigid blocks, in each step of the certified loop (T12).

No group, cones of one row, open joints without any stiffness, degenerate vertices.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

import lacore as la
from lacore.program.certificate import certify
from lacore.program.kinematic import (
    FrozenContact,
    KinematicProgram,
    associated_contact,
    dimensionless,
    reaction_contact,
    shift_contact,
)
from lacore.reporting.status import Status
from lacore.solvers.backend import find_backend
from tests.shares import one_in

MU = 0.65
STEPS = ("associated", "K", "S")
# Vertices are exact; interior points stop at 1e-10 of the largest number, IPOPT at 1e-9.
EXACT = [("clarabel", 1e-8), ("highs", 1e-12), ("cvxpy", 1e-7), ("ipopt-static", 1e-7)]
REGULARISED = ["newton", "ipopt", pytest.param("slsqp", marks=pytest.mark.slow)]
R = 1e-3


@dataclass(frozen=True)
class Wall:
    """A program, the three contacts, and the exact values."""

    program: KinematicProgram
    contacts: dict[str, FrozenContact]
    values: dict[str, float]


@cache
def wall():
    """Six courses of five blocks and a half, pushed sideways by a share of their weight."""
    courses = [[0.5, 1, 1, 1, 1, 0.5], [1, 1, 1, 1, 1]] * 3
    assembly = la.masonry.running_bond(courses, MU)
    problem = la.Problem(
        {"wall": assembly},
        [la.BodyForce("wall", (1.0, 0.0))],
        [la.Fix("wall", where="base")],
        dead_loads=[la.BodyForce("wall", (0.0, -1.0))],
    )
    d = la.discretise(problem)
    program = dimensionless(d.program, d.natural)
    rows, solver = program.contact, prepared("highs", program)
    contacts = {"associated": associated_contact(rows)}
    first = solver.solve(contacts["associated"]).point
    # A vertex leaves many joints without any reaction.
    assert (first.normal_reaction == 0).any()
    contacts["K"] = reaction_contact(rows, np.maximum(first.normal_reaction, 0))
    slip = np.linalg.norm(rows.slip(solver.solve(contacts["K"]).point.velocity), axis=1)
    contacts["S"] = shift_contact(rows, slip)
    values = {
        step: value(program, held, solver.solve(held).point) for step, held in contacts.items()
    }
    return Wall(program, contacts, values)


def prepared(name, program, **options):
    backend = find_backend(name)
    return backend.prepare(program, backend.Options(**options))


def value(program, held, point):
    """What is unique of a solution: under a shift the load factor is not (T14b)."""
    shifted = float(program.contact.weights @ (held.shift * point.normal_reaction))
    return point.load_factor - shifted


@pytest.mark.parametrize(("name", "allowed"), EXACT)
def test_one_value(name, allowed):
    """By one solver that is asked in turn, as the loop asks."""
    given = wall()
    solver = prepared(name, given.program)
    for step in (*STEPS, "K", "S"):
        held = given.contacts[step]
        answer = solver.solve(held)
        assert answer.status is Status.SOLVED, step
        found = value(given.program, held, answer.point)
        assert found == pytest.approx(given.values[step], rel=allowed), step
        assert certify(given.program, answer.point, held).holds(10 * allowed), step


@pytest.mark.parametrize("step", one_in(2, STEPS))
@pytest.mark.parametrize("name", REGULARISED)
def test_one_triple(name, step):
    """That of Clarabel on the same regularised program, and below the exact value (T19)."""
    given = wall()
    held = given.contacts[step]
    found, wanted = (
        prepared(each, given.program, r=R).solve(held) for each in (name, "clarabel-regularised")
    )
    assert found.status is wanted.status is Status.SOLVED
    for entry in ("plastic", "alpha_reg", "load_factor"):
        expected = getattr(wanted.regularised, entry)
        assert getattr(found.regularised, entry) == pytest.approx(expected, rel=1e-6), entry
    assert found.regularised.alpha_reg <= given.values[step]
