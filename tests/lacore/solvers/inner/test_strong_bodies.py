"""Bodies whose strength is far above what limits the load: steel on a floor, walls of k = 1e12."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix

import lacore as la
import lacore.solvers.inner.strong_bodies as strong_bodies
from lacore.solvers.inner.rigid_motions import kernel, motions_without_strain, weighted_rows
from lacore.solvers.inner.strong_bodies import StrongBodySolver
from tests.shares import one_in

WEIGHT, MU = 77e3, 0.3  # N/m^3


def steel_block(cells, strength=144e6, friction=MU, space="p2-vertex", side=0.1):
    """It slides at mu times its weight: statics, whatever its strength."""
    mesh = la.meshes.rectangle((0, side), (0, side), cells, cells)
    return la.Problem(
        {"block": la.Body(mesh, la.VonMises(shear_strength=strength), space=space)},
        [la.BodyForce("block", (1.0, 0))],
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle((0, 0), (0, 1)), friction)],
        dead_loads=[la.BodyForce("block", (0, -WEIGHT))],
    )


@pytest.mark.parametrize("strength", [1e5, 144e6, 1e12])
@pytest.mark.parametrize("cells", [2, 4, 8])
def test_a_steel_block_slides_at_its_friction(cells, strength):
    """Strength/(weight x height) up to 1e8; certified, so exact to the bar of 1e-6."""
    state = la.solve(steel_block(cells, strength))
    assert state.status is la.Status.SOLVED
    assert state.load_factor == pytest.approx(MU * WEIGHT, rel=2e-6)
    assert state.certify().holds(1e-6)


@pytest.mark.parametrize("space", ["p1-disc", "p2-disc", "p2-gauss"])
def test_in_other_spaces_too(space):
    state = la.solve(steel_block(3, space=space))
    assert state.status is la.Status.SOLVED
    assert state.load_factor == pytest.approx(MU * WEIGHT, rel=2e-6)


@pytest.mark.parametrize("strength", one_in(2, [1e5, 144e6, 1e12]))
@pytest.mark.parametrize("cells", one_in(2, [4, 8]))
def test_bounds_of_a_strong_body_are_close(cells, strength):
    """Its stresses are projected onto equilibrium: tractions are not soft beside the body."""
    problem = steel_block(cells, strength, friction=la.Coulomb(MU, associated=True))
    lower = la.lower_bound(problem)
    upper = la.upper_bound(la.solve(problem))
    assert lower.status is upper.status is la.Status.SOLVED
    assert lower.load_factor <= MU * WEIGHT * (1 + 1e-12)
    assert upper.load_factor >= MU * WEIGHT * (1 - 1e-12)
    # Which margin off the friction a bound needs, 1e-7 or 1e-5, differs by processor; with it the
    # bar of the velocity's residuals.
    assert upper.load_factor - lower.load_factor <= (1e-5 + 1e-5) * MU * WEIGHT


@pytest.mark.parametrize("backend", ["clarabel", "interior_point"])
def test_a_strong_body_that_is_held_has_no_rigid_motion(backend):
    """Nothing of it moves before it yields, and its weight is nothing beside its strength."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)

    def load(weight):
        problem = la.Problem(
            {"block": la.Body(mesh, la.VonMises(shear_strength=1e3))},
            [la.Traction("block", "top", (1.0, 0))],
            [la.Fix("block", "bottom")],
            dead_loads=[la.BodyForce("block", (0, -weight))] if weight else [],
        )
        return la.solve(problem, backend=backend).load_factor

    assert load(1e-3) == pytest.approx(load(0), rel=1e-5)


def test_stresses_are_those_of_an_elastic_body_within_the_strength():
    """In equilibrium with the reactions: their divergence is the weight, tested by the residual."""
    state = la.solve(steel_block(4))
    form = la.VonMises(shear_strength=144e6).conic_form("plane_strain")
    assert state.certificate.equilibrium <= 1e-6
    largest = max(np.abs(stress).max() for stress in state.stress.values())
    assert 0 < largest < 1e-2 * form.bound


def test_a_body_that_yields_is_none():
    """Crushing under its own strength: loads of the size of the strength are left to the solver."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 4, 4)
    problem = la.Problem(
        {"block": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        [la.Traction("block", "top", (0, -1.0))],
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle((0, 0), (0, 1)), MU)],
        dead_loads=[la.BodyForce("block", (0, -1e-5))],
    )
    state = la.solve(problem)
    assert state.status is la.Status.SOLVED
    assert state.load_factor == pytest.approx(2.0, rel=0.1)  # 2 k, on a coarse mesh


def test_a_body_that_yields_before_it_slides_is_none():
    """Squeezed 1e6 times as much as pushed: at mu W it would slide at 3, and is crushed at 2 k."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    problem = la.Problem(
        {"block": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        [la.Traction("block", "left", (1.0, 0)), la.Traction("block", "right", (-1 + 1e-6, 0))],
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle((0, 0), (0, 1)), MU)],
        dead_loads=[la.BodyForce("block", (0, -1e-5))],
    )
    state = la.solve(problem)
    assert state.status is la.Status.SOLVED
    # Friction and weight take part by 1e-5 of it.
    assert state.load_factor == pytest.approx(2.0, rel=1e-4)


def test_a_weak_floor_under_a_strong_guided_block():
    """Exact: the limit of friction; it was called free, beside a strength of 1e12."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 4, 4)
    problem = la.Problem(
        {"block": la.Body(mesh, la.VonMises(shear_strength=1e12))},
        [la.Traction("block", "left", (1.0, 0))],
        [la.Fix("block", "top", "y")],
        [la.Interface(("block", "bottom"), la.RigidObstacle((0, 0), (0, 1)), la.Tresca(1e4))],
    )
    state = la.solve(problem)
    assert state.status is la.Status.SOLVED
    assert state.load_factor == pytest.approx(1e4, rel=2e-6)


def test_rigid_motions_of_a_free_body_are_three():
    """Translations and a turn, and unit vectors of what no row touches."""
    program = la.discretise(steel_block(2)).program
    basis = motions_without_strain(program.groups)
    assert basis.shape == (program.n, 3)
    left = weighted_rows(program.groups[0]) @ basis
    assert np.abs(left.toarray()).max() <= 1e-10 * abs(program.groups[0].rows).max()
    alone = kernel(csr_matrix(([1.0, -1.0], ([0, 0], [0, 1])), (1, 3)))
    assert alone.shape == (3, 2)


def test_the_whole_program_is_solved_where_the_rigid_one_proves_nothing(monkeypatch):
    """Stresses that are not in equilibrium are found out, and the body is solved as it is."""
    asked = []
    plain = StrongBodySolver._plain
    monkeypatch.setattr(
        StrongBodySolver, "_plain", lambda self, contact: asked.append(1) or plain(self, contact)
    )
    monkeypatch.setattr(strong_bodies._Stiff, "_bent", lambda self, force: np.zeros(force.size))
    la.solve(steel_block(2), max_iterations=2)
    assert asked
