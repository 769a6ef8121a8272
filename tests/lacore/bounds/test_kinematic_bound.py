"""Strict upper bounds from projected velocities (T26c), integrated closely (T22)."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lacore as la
from lacore.assembly.discretise import discretise
from lacore.bounds.velocity_projection import admissible_velocity
from lacore.limit.conversion import point_in_program
from lacore.model.bodies.continuum.dofs import edge_shapes
from lacore.model.bodies.continuum.regions.lattices import lattice
from lacore.program.certificate import certify
from lacore.program.kinematic import associated_contact, dimensionless
from tests.lacore.model.bodies.test_spaces import block, half_space
from tests.lacore.model.bodies.test_spaces import punch as uniform_punch
from tests.lacore.models import CRITERION, deformable_block, punch, square
from tests.lacore.random_continua import problem as random_problem

LAWS = [la.SMOOTH, la.STICK, la.Tresca(0.4), la.Coulomb(0.3, associated=True)]


@pytest.mark.parametrize("space", ["p2-vertex", "p2-disc", "p1-disc"])
def test_below_the_program_and_above_the_exact_load(space):
    """The vertex rule of the program over-estimates; its lattice does so less."""
    state = la.solve(punch(space=space))
    bound = la.upper_bound(state)
    assert bound.rigor is la.Rigor.UPPER
    assert bound.divergence <= 1e-12
    assert bound.penetration <= 1e-12
    # Where strain rates are constant in elements nothing is gained but the solver's round-off.
    assert 2 + pi < bound.load_factor <= state.load_factor * (1 + 1e-8)
    if space != "p1-disc":
        assert bound.load_factor < state.load_factor * (1 - 1e-3)


@pytest.mark.parametrize("friction", LAWS[1:])
def test_exact_mechanisms_stay_exact(friction):
    stated = deformable_block(friction, n=2)
    expected = {la.STICK: 3.0, LAWS[2]: 1.6, LAWS[3]: 1.2}[friction]  # CLOSED_FORMS C14
    bound = la.upper_bound(stated)
    assert bound.load_factor == pytest.approx(expected, rel=1e-8)
    assert bound.load_factor >= expected * (1 - 1e-12)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
@pytest.mark.parametrize("friction", LAWS[1:])
def test_loose_solves_are_bounds_too(tolerance, friction):
    """Residuals that a loose solve leaves are projected away, those of contact with them."""
    discretisation = discretise(deformable_block(friction, n=2))
    state = la.solve(discretisation, options={"tolerance": tolerance}, tolerance=1e-3)
    program = dimensionless(discretisation.program, discretisation.natural)
    point = point_in_program(discretisation, state.point)
    velocity = admissible_velocity(program, point.velocity)
    seen = certify(program, type(point)(**(vars(point) | {"velocity": velocity})), laws(program))
    assert max(seen.divergence, seen.penetration, seen.normalisation) <= 1e-12


def laws(program):
    return associated_contact(program.contact)


def test_lattice_is_above_the_integral():
    """|x| over the triangle (-1, 0), (1, 0), (0, 1) of area 1: 1/3 from above, at order 2."""
    corner, excess = np.array([-1.0, 1.0, 0.0]), []
    for parts in (1, 3, 9, 27):
        places, share = lattice(parts)
        assert share.sum() == pytest.approx(1.0, rel=1e-12)
        assert places @ [1, 1, 1] == pytest.approx(np.ones(share.size), rel=1e-12)
        excess.append(share @ np.abs(places @ corner) - 1 / 3)
    assert excess[0] == pytest.approx(1 / 3)  # the vertex rule: 2/3
    assert np.allclose(np.array(excess[1:]) / excess[:-1], 1 / 9, rtol=0.1)


def test_random_problems():
    """Every state with friction that has bounds becomes a proven one."""
    proven = 0
    for seed in range(40):
        try:
            state = la.solve(random_problem(seed))
        except la.InputError:
            continue  # a footing on a support
        bound = la.upper_bound(state)
        assert bound.status is state.status
        if state.status is la.Status.SOLVED:
            proven += 1
            scale = max(abs(state.load_factor), 1e-3)
            assert bound.load_factor <= state.load_factor + 1e-8 * scale, seed
    assert proven >= 15


def test_an_unfinished_solve_proves_a_worse_bound():
    best = la.upper_bound(punch()).load_factor
    early = la.upper_bound(punch(), "clarabel", options={"max_iterations": 8})
    assert early.state.status is not la.Status.SOLVED
    assert early.rigor is la.Rigor.UPPER
    assert best < early.load_factor


def test_what_has_no_bound():
    with pytest.raises(la.InputError, match="not associated"):
        la.upper_bound(deformable_block(0.3))
    pressed = la.Problem(
        {"block": square()},
        [la.Pressure("block", "top")],
        [la.Fix("block", side, "normal") for side in ("left", "right", "bottom")],
    )
    locked = la.upper_bound(pressed)
    assert locked.status is la.Status.LOCKED
    assert locked.load_factor == np.inf
    assert locked.rigor is la.Rigor.NOT_CERTIFIED
    with pytest.raises(la.SolveError):
        la.upper_bound(pressed, throw=True)
    mesh = la.meshes.quadrilaterals((0, 1), (0, 1), 2, 2)
    quadrilaterals = la.Problem(
        {"block": la.Body(mesh, CRITERION, space="q2")},
        [la.Traction("block", "right", (0, -1))],
        [la.Fix("block", "left")],
    )
    assert la.upper_bound(quadrilaterals).rigor is la.Rigor.DISCRETE


@pytest.mark.parametrize("rough", [False, True])
def test_interior_points_prove_more(rough):
    """Linear theta that vanishes at three points vanishes everywhere: p2-gauss has strict bounds.

    Closer ones than p2-vertex, whose velocity minimises more than there is.
    """
    excess = {}
    for space in ("p2-vertex", "p2-gauss"):
        stated = uniform_punch(space, half_space(space, 12, 6), rough)
        bound = la.upper_bound(stated)
        assert bound.rigor is la.Rigor.UPPER
        excess[space] = bound.load_factor - (2 + pi)
        gaps = la.gap_identity(bound, la.lower_bound(stated))
        assert gaps.total == pytest.approx(gaps.upper - gaps.lower, rel=1e-5)
        assert gaps.least >= -1e-9
    assert 0 < excess["p2-gauss"] < 0.85 * excess["p2-vertex"]  # measured 0.70 and 0.77


@pytest.mark.parametrize("space", ["p1-disc", "p2-disc"])
@settings(max_examples=5)
@given(seed=st.integers(0, 10**6))
def test_jumps_are_integrated_from_above(space, seed):
    """Random velocities: at least the integral along the edges, and above it by little."""
    d = block(space)
    dofs, u = d.continua["block"], np.random.default_rng(seed).normal(size=d.full.n)
    mesh = dofs.body.mesh
    inner = np.flatnonzero(mesh.f2t[1] >= 0)
    along = mesh.p[:, mesh.facets[1, inner]] - mesh.p[:, mesh.facets[0, inner]]
    first, second = (u[dofs.dofs[:, dofs.facet_nodes(inner, side)]] for side in (0, 1))
    # In plane strain rows see the tangential jump only.
    nodal = np.einsum("xe,xve->ev", along, second - first)
    shape = edge_shapes((np.arange(2000) + 0.5) / 2000, dofs.degree)
    exact = np.abs(nodal @ shape.T).mean(axis=1)
    elements, seen = d.jumps["block"].power(u, 16)
    assert np.array_equal(elements, mesh.f2t[:, inner])
    assert np.all(seen >= exact * (1 - 1e-3))  # of the midpoint rule where the slip turns round
    assert seen.sum() <= exact.sum() * 1.005  # parts cost 1/16^2
    _, whole = d.jumps["block"].power(u, 1)
    assert whole.sum() == pytest.approx(d.jumps["block"].group.dissipation(u).sum(), rel=1e-12)
