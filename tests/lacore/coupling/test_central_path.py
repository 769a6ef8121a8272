"""The Coulomb problem of walls as complementarity problem, and the path to its solutions."""

from contextlib import contextmanager

import numpy as np
import pytest

import lacore as la
from lacore.backend import find_backend, read_options
from lacore.coupling.certified import averaged
from lacore.coupling.freezing import associated
from lacore.coupling.in_plane.central_path import central_path, follow
from lacore.coupling.in_plane.complementarity import Complementarity, Newton, _parity, poses
from lacore.coupling.run import CouplingOptions, Run
from lacore.inner.preparing import preparing
from lacore.program import dimensionless
from tests.coulomb_checker import accepts, residuals
from tests.rigid_problems import incline
from tests.statements import stated

BAR = 1e-6


def wall(wide, courses, every, mu=0.65):
    rows = la.masonry.regular_bond(wide, courses, la.masonry.windows(wide, courses, every))
    return la.Problem(
        {"blocks": la.masonry.running_bond(rows, friction=mu)},
        [la.BodyForce("blocks", (1, 0))],
        [la.Fix("blocks", "base")],
        dead_loads=[la.BodyForce("blocks", (0, -1))],
    )


@contextmanager
def started(problem):
    """A loop that has solved the associated problem."""
    stated = la.discretise(problem)
    program = dimensionless(stated.program, stated.natural)
    engine = find_backend("clarabel")
    with preparing(engine, read_options(engine, {})) as prepare:
        solver = prepare(program)
        run = Run(program, solver, False, CouplingOptions(), lambda _: None, prepare)
        run.solve("associated", associated(program).contact)
        yield run
        solver.close()


@pytest.fixture(scope="module")
def run():
    with started(wall(4, 10, 3)) as own:
        yield own


def inside(run, product=0.01):
    problem = Complementarity(run.program)
    return problem, problem.start(run.iterates[0].inner.point, product)


def test_the_start_is_inside_and_all_its_powers_are_equal(run):
    problem, z = inside(run)
    assert (problem.positive(z) > 0).all()
    # Friction is within 1e-12 of what bisection looks for, 1e-3 or more from its bound.
    assert problem.products(z) == pytest.approx(0.01, rel=1e-9)


def test_newton_solves_the_linearised_equations(run):
    """What a step leaves of equations that are linear but for products is its own products."""
    problem, z = inside(run)
    right = np.random.default_rng(0).standard_normal(problem.residual(z).size)
    step = Newton(problem, z).solve(right)
    force, speed = np.split(problem.rates(step), 2)
    left = problem.residual(z + step) - problem.residual(z) - right
    left[-force.size :] -= force * speed
    size = max(np.abs(problem.residual(z + step)).max(), np.abs(right).max())
    assert np.abs(left).max() <= 1e-9 * size  # round-off, of a condition of some 1e5


def test_orientation_is_the_sign_of_the_determinant(run):
    """Against dense ones, at places whose matrices differ: both signs change alike."""
    problem, z = inside(run)
    n, m = problem.program.n, problem.program.contact.count
    rng, signs = np.random.default_rng(1), []
    for _ in range(6):
        factors = np.exp(3 * rng.standard_normal(3 * m))
        place = z.copy()
        place[2 * m : 5 * m] *= factors  # speeds may be any
        newton = Newton(problem, place)
        velocities = newton._matrix.toarray()  # ones on its diagonal, but for scales
        load = newton._scale * problem.program.reference_load
        bordered = np.block([[velocities, load[:, None]], [-load[None, :], np.zeros((1, 1))]])
        assert bordered.shape == (n + 1, n + 1)
        signs.append(np.linalg.slogdet(bordered)[0] * newton.orientation())
    assert set(signs) == {signs[0]}


def test_parity():
    rng = np.random.default_rng(0)
    for size in (1, 2, 5, 8):
        order = rng.permutation(size)
        assert _parity(order) == round(np.linalg.det(np.eye(size)[order]))


@pytest.mark.parametrize(("mu", "slope"), [(0.5, 0.6), (0.3, 1.0), (0.8, 0.3)])
def test_the_path_ends_at_the_closed_form(mu, slope):
    """C2c: a block pushed up an incline."""
    with started(incline(mu, slope)) as run:
        found = central_path(run, run.iterates[0].inner.point)
    assert found is not None
    factor = found.inner.point.load_factor * run.program.scales.load_factor
    power = mu * np.tan(slope)  # the error of alpha is 1/(1 - lambda) times that of the gap (T15)
    assert factor == pytest.approx(np.tan(slope + np.arctan(mu)), rel=10 * BAR / (1 - power))


@pytest.mark.slow
def test_the_path_certifies_a_wall_whose_alternation_stalls():
    with started(wall(8, 40, 3)) as run:
        start = run.iterates[0].inner.point
        run.options = CouplingOptions(max_iterations=12)
        assert averaged(run, start) is None
        run.options = CouplingOptions()
        found = central_path(run, start)
        assert found is not None
        assert run.proven(found)
        assert run.iterates[-1].kind == "path"
        assert found.inner.point.load_factor <= start.load_factor * (1 + BAR)


def test_the_same_path_each_time(run):
    problem, z = inside(run)
    first, again = (follow(problem, z, BAR) for _ in range(2))
    assert first[2] == ""
    assert first[1] == again[1]
    assert (first[0] == again[0]).all()


def test_only_coulomb_blocks_in_the_plane_are_taken(run):
    assert poses(run.program)
    smooth = la.discretise(
        la.Problem(
            {"blocks": la.BlockAssembly(BOXES, 0.0)},
            [la.BodyForce("blocks", (1, 0))],
            [la.Fix("blocks", "base")],
            dead_loads=[la.BodyForce("blocks", (0, -1))],
        )
    )
    assert not poses(smooth.program)
    dome = la.masonry3d.dome(6, 3, 1.0, 0.15, 0.3, 0.5)
    base = tuple(name for name in dome.names if name.startswith("base"))
    weight = [la.BodyForce("b", (0, 0, -1))]
    pushed = [la.BodyForce("b", (1, 0, 0))]
    space = la.Problem({"b": dome}, pushed, [la.Fix("b", base, "xyz")], dead_loads=weight)
    assert not poses(la.discretise(space).program)


BOXES = {
    "base": np.array([(-1, -1), (3, -1), (3, 0), (-1, 0)], dtype=float),
    "block": np.array([(0, 0), (2, 0), (2, 1), (0, 1)], dtype=float),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wide", "courses", "every", "mu"), [(12, 30, 3, 0.65), (12, 30, 4, 0.65), (16, 60, 5, 0.45)]
)
def test_tall_walls_pass_the_independent_check(wide, courses, every, mu):
    problem = wall(wide, courses, every, mu)
    state = la.solve(problem, coupling="certified")
    assert state.status is la.Status.SOLVED, state.message
    s = stated(problem, state, mu)
    assert accepts(s), residuals(s)
