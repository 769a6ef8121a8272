"""What a lower bound loses where the least elements pay for what a solver leaves (T26c)."""

from dataclasses import replace

import numpy as np
import pytest
from skfem import MeshTri

import lacore as la
from lacore.bounds.static_model import static_model
from lacore.bounds.stresses.admissible import weaker
from lacore.bounds.stresses.attempt import attempt
from lacore.bounds.stresses.within_strength import beyond, within_strength
from lacore.model.meshes.refinement import bisected
from lacore.program.kinematic import associated_contact, dimensionless
from lacore.program.projection import alike, onto_equilibrium
from lacore.program.state import out_of_balance
from lacore.solvers.backend import find_backend

EXACT = 1e-12  # of forces, as certificates ask for
TIGHT = 1e-9  # tolerance of a solve beside which the noise below is large
NOISE = 1e-9  # of stresses times the share of their element in the body


def cut(times):
    """A vertical cut, elements at its toe halved so often; areas fall by about 2^times."""
    mesh = la.meshes.rectangle((0, 3), (-2, 0), 6, 4)
    x, y = mesh.p[:, mesh.t].mean(axis=1)
    soil = mesh.restrict(np.flatnonzero((x > 1) | (y < -1)))
    mesh = MeshTri(soil.p, soil.t)
    for _ in range(times):
        toe = np.flatnonzero(np.all(mesh.p.T == (1, -1), axis=1))
        mesh, _ = bisected(mesh, np.flatnonzero(np.isin(mesh.t, toe).any(axis=0)))
    names = {
        "left": np.flatnonzero((mesh.p[0, mesh.facets] == 0).all(axis=0)),
        "right": np.flatnonzero((mesh.p[0, mesh.facets] == 3).all(axis=0)),
        "bottom": np.flatnonzero((mesh.p[1, mesh.facets] == -2).all(axis=0)),
    }
    return la.Problem(
        bodies={"soil": la.Body(mesh.with_boundaries(names), la.VonMises(1.0))},
        supports=[la.Fix("soil", "bottom"), la.Fix("soil", "right"), la.Fix("soil", "left", "x")],
        reference_loads=[la.BodyForce("soil", (0, -1))],
    )


@pytest.fixture(scope="module")
def solved():
    """Program, dimensionless, and its answer."""
    model = static_model(cut(16))
    program = dimensionless(model.program, model.natural)
    backend = find_backend("clarabel")
    solver = backend.prepare(program, backend.Options(tolerance=TIGHT))
    answer = solver.solve(associated_contact(program.contact))
    solver.close()
    return program, answer


def noisy(program, state):
    """Stresses off by as much force on every element: by the more the smaller it is."""
    rng = np.random.default_rng(1)
    whole = sum(group.weights.sum() for group in program.groups)
    stresses = [
        stress + (NOISE * whole / group.weights)[:, None] * rng.uniform(-1, 1, stress.shape)
        for group, stress in zip(program.groups, state.stress, strict=True)
    ]
    return replace(state, stress=tuple(stresses))


@pytest.mark.parametrize(("backend", "tolerance"), [("interior_point", 1e-4), ("clarabel", 1e-6)])
def test_a_loose_solve_loses_no_more_than_it_is_away(backend, tolerance):
    """Less than its gap, or than the millionth at which stresses are no longer moved."""
    bound = la.lower_bound(cut(16), backend, options={"tolerance": tolerance}, throw=True)
    away = max(bound.history["gap_solved"].iloc[-1], 2e-6)
    assert bound.lost <= away * bound.load_factor


def test_noise_in_small_elements_hardly_costs_anything(solved):
    """Projection leaves the worst point beyond its strength by what scaling would take off."""
    program, answer = solved
    point = noisy(program, answer.point)
    with onto_equilibrium(program, point, alike) as nearest:
        over = beyond(program, nearest(point))
    assert over > 1e-3
    found = attempt(program, program, 0.0, replace(answer, point=point), EXACT)
    assert found.proves
    # Without noise the state is within strengths: steps lead there, with the inverse square of
    # their number, forty of them to a tenth by far.
    assert 1 - found.state.load_factor / point.load_factor < 0.1 * over


def test_stresses_come_within_strengths_that_leave_room(solved):
    """As under dead loads, without scaling; half of the room is margin, as that of solves."""
    program, answer = solved
    room = 1e-3
    state = answer.point
    state = replace(
        state,
        load_factor=(1 - room) * state.load_factor,
        stress=tuple((1 - room) * stress for stress in state.stress),
        mean_stress=tuple((1 - room) * mean for mean in state.mean_stress),
    )
    state = noisy(program, state)
    with onto_equilibrium(program, state, alike) as nearest:
        projected = nearest(state)
        assert beyond(program, projected) > room
        moved = within_strength(program, weaker(program, room / 2), projected, nearest, 0.0, 0.0)
    assert beyond(program, moved) <= 0
    assert np.abs(out_of_balance(program, moved)).max() <= EXACT
    assert moved.load_factor == pytest.approx(
        state.load_factor, rel=1e-6
    )  # as stiff as _STIFF_LOAD


@pytest.mark.parametrize("times", [0.5, 1.5])
def test_stresses_within_strengths_or_far_beyond_stay(solved, times):
    """Far beyond them a solver has found nothing."""
    program, answer = solved
    state = replace(answer.point, stress=tuple(times * stress for stress in answer.point.stress))
    with onto_equilibrium(program, state, alike) as nearest:
        assert within_strength(program, program, state, nearest, 0.0, 0.0) is state
