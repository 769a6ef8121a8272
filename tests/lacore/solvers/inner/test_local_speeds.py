"""Soil that outruns its load, or hardly rubs: solved as sharply as any other, and bounded."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.program.certificate import certify
from lacore.program.kinematic import associated_contact, dimensionless
from lacore.solvers.backend import find_backend, read_options
from lacore.solvers.inner.local_speeds import LocalSpeedSolver, LocalUnits, local_speeds
from lacore.solvers.inner.rescaling import GOOD, largest_residual
from lacore_verification.cases.no_tension_cut import CASE as NO_TENSION_CUT
from lacore_verification.cases.strip_footing import CASE as STRIP_FOOTING
from lacore_verification.cases.strip_footing_gamma import CASE as SAND


def sand(nx, ny, ratio):
    """A smooth footing on sand of 30 degrees that its own weight alone strengthens."""
    return SAND.build(nx, ny, ratio, angle=30.0, rough=False)


def program_of(problem):
    """The program of a problem, without dimensions."""
    discretisation = la.discretise(problem)
    return dimensionless(discretisation.program, discretisation.natural)


def test_units_change_no_residual_of_powers():
    """What is solved in local units is the same state: its gap, flow and slip stay."""
    program = program_of(sand(5, 2, 4.0))
    random = np.random.default_rng(1)
    units = replace(
        LocalUnits.of(program, random.standard_normal(program.n)),
        unknowns=np.exp(random.uniform(-3, 3, program.n)),
    )
    inside = units.program(program)
    laws = associated_contact(program.contact)
    state = la.solve(sand(5, 2, 4.0), coupling="associated")
    point = replace(
        state.point,
        velocity=random.standard_normal(program.n),
        stress=tuple(random.standard_normal((g.weights.size, g.dim)) for g in program.groups),
        mean_stress=tuple(random.standard_normal(g.volumetric.shape[0]) for g in program.groups),
        load_factor=1.3,
    )
    there = certify(inside, point, laws)
    here = certify(program, units.back(point), laws)
    # Products of the same numbers in another order: round-off, 1e-16 of sums over 1e3 terms.
    for name in ("flow", "gap", "normalisation", "slip"):
        assert getattr(here, name) == pytest.approx(getattr(there, name), rel=1e-9), name


def test_a_footing_is_as_fast_as_its_load_and_soil_beside_it_outruns_it():
    """F0.u = 1 of a unit load is its speed; where nothing presses the mechanism is faster."""
    problem = sand(8, 4, 6.0)
    state = la.solve(problem, coupling="associated", throw=True)
    program = state.discretisation.program
    velocity = np.linalg.lstsq(
        state.discretisation.free_basis.toarray(), state.point.velocity, rcond=None
    )[0]
    speeds = local_speeds(program, velocity)
    assert speeds.min() == 1.0
    assert speeds.max() > 10.0


def test_a_solve_in_units_of_local_speeds_leaves_less():
    """On the mesh of a footing that one backend, asked once, does not certify."""
    program, backend = program_of(sand(28, 12, 8.0)), find_backend("clarabel")
    contact, options = associated_contact(program.contact), read_options(backend, {})
    left = []
    for good in (np.inf, GOOD):  # with the first it is asked once
        solver = LocalSpeedSolver(program, lambda own: backend.prepare(own, options), good)
        left.append(largest_residual(program, solver.solve(contact), contact))
        solver.close()
    assert left[1] < 0.5 * left[0]


def test_sand_has_a_lower_bound_on_meshes_where_it_outruns_its_load():
    """Stresses vanish at the surface: what is left out of balance there must be next to none."""
    bound = la.lower_bound(sand(20, 9, 8.0))
    assert bound.status is la.Status.SOLVED, bound.message
    assert bound.rigor is la.Rigor.LOWER
    # Of 720 elements, of N_gamma = 7.6530: no more than it, and of use.
    assert 5.5 < bound.load_factor < 7.6530


@pytest.mark.parametrize("angle", [0.1, 1.0])
def test_friction_that_is_next_to_none_is_certified(angle):
    """The apex is 573 and 57 cohesions away, and mean stresses may come near it."""
    state = la.solve(
        STRIP_FOOTING.build(8, 5, 6.0, angle=angle, surcharge=0.0, weight=0.0),
        coupling="associated",
    )
    phi = np.radians(angle)
    bearing = np.exp(np.pi * np.tan(phi)) * np.tan(np.pi / 4 + phi / 2) ** 2 - 1
    assert state.status is la.Status.SOLVED, state.message
    assert state.load_factor > bearing / np.tan(phi)
    # Once 1e-5 and more; a hundredth of that says that rows are in good units.
    assert state.certificate.worst[1] <= 1e-7


def test_a_cut_without_tension_is_certified_where_it_runs_hundreds_of_times_as_fast():
    """Soil behind the crest weighs next to nothing and is held by nothing."""
    variant = next(v for v in NO_TENSION_CUT.variants if v.name == "phi-20")
    mesh = NO_TENSION_CUT.meshes["medium"]
    state = la.solve(NO_TENSION_CUT.build(**mesh, **variant.parameters), coupling="associated")
    assert state.status is la.Status.SOLVED, state.message
    assert state.load_factor > 2.8563  # the closed form
