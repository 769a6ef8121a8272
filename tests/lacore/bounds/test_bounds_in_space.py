"""Strict bounds of bodies of tetrahedra, checked from mesh and fields alone (T89-T92)."""

from math import pi, sqrt

import numpy as np
import pytest

import lacore as la
from lacore.model.bodies.continuum.regions.lattices import lattice
from lacore.model.bodies.continuum.solid.faces import EDGES
from lacore.model.bodies.continuum.solid.lattice import divided
from tests.lacore.solid_statements import lower_proof, upper_proof
from tests.lacore.tetrahedra import CRITERION, SPACES, cube, gradients, strip, tensors, torsion

SOLVED = 1e-7  # of the load factor, as in `tests.lacore.model.bodies.test_tetrahedra`
STRIP = 2 + pi


@pytest.mark.parametrize("crossed", [False, True])
def test_homogeneous_compression_exactly_from_below(crossed):
    bound = la.lower_bound(cube(crossed=crossed))
    assert bound.rigor is la.Rigor.LOWER
    assert bound.load_factor == pytest.approx(sqrt(3), rel=SOLVED)
    assert bound.load_factor <= sqrt(3) * (1 + 1e-12)


@pytest.mark.parametrize("backend", ["clarabel", "interior_point"])
def test_stresses_alone_prove_a_lower_bound(backend):
    bound = la.lower_bound(strip(n=3), backend)
    assert bound.rigor is la.Rigor.LOWER
    assert bound.load_factor < STRIP
    left, carried = lower_proof(bound)
    # Stresses are of order one per length of order one, sums of a few terms.
    assert max(left.residuals.values()) <= 1e-12, left
    assert carried == pytest.approx(bound.load_factor, rel=1e-12)


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("rough", [False, True])
def test_a_velocity_alone_proves_an_upper_bound(space, rough):
    bound = la.upper_bound(strip(space, n=3, rough=rough), "interior_point")
    assert bound.rigor is la.Rigor.UPPER
    assert bound.load_factor > STRIP
    above, power = upper_proof(bound)
    assert max(above.residuals.values()) <= 1e-11 * np.abs(bound.velocity).max(), above
    assert power == 1
    # Edges are halved once more than in the bound, whose rule is above by less than a hundredth.
    assert 0.99 * bound.load_factor <= above.dissipation <= bound.load_factor * (1 + 1e-12)


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("rough", [False, True])
def test_shares_of_the_gap_are_positive_and_add_up(space, rough):
    problem = strip(space, n=2, rough=rough)
    upper, lower = (bound(problem, "interior_point") for bound in (la.upper_bound, la.lower_bound))
    gap = la.gap_identity(upper, lower)
    assert gap.total == pytest.approx(upper.load_factor - lower.load_factor, abs=1e-12)
    assert gap.least >= -1e-8  # the backend's tolerance


def test_brackets_narrow_as_meshes_get_finer():
    widths = []
    for n in (2, 4):
        problem = strip("p2-disc", n=n)
        low, high = (f(problem, "interior_point") for f in (la.lower_bound, la.upper_bound))
        assert low.load_factor < STRIP < high.load_factor
        widths.append(high.load_factor - low.load_factor)
    assert widths[1] < 0.7 * widths[0]


@pytest.mark.parametrize("corners", [3, 4])
@pytest.mark.parametrize("parts", [1, 2, 3])
def test_parts_of_a_simplex_fill_it(corners, parts):
    places, simplices = divided(parts, corners)
    assert len(simplices) == parts ** (corners - 1)
    size = np.abs(np.linalg.det(places[simplices]))
    np.testing.assert_allclose(size, parts ** (1.0 - corners), rtol=1e-12)
    np.testing.assert_allclose(places.sum(axis=1), 1.0)
    own, share = lattice(parts, corners)
    np.testing.assert_allclose(share @ own, 1 / corners, rtol=1e-12)


def test_dead_loads_are_proven_too():
    """A pressure on all free sides moves the mean stress alone: von Mises does not feel it."""
    problem = cube(n=1)
    dead = [la.Pressure("block", side, 0.5) for side in ("right", "back", "top")]
    loaded = problem.with_loads(dead_loads=dead)
    low, high = la.lower_bound(loaded), la.solve(loaded)
    # The margin off all strengths that dead loads cost is 1e-7 of them.
    assert low.load_factor == pytest.approx(sqrt(3), rel=1e-6)
    assert high.load_factor == pytest.approx(sqrt(3), rel=1e-6)


def test_forces_that_vary_within_elements_have_upper_bounds_where_they_are_linear():
    """Their power is exact; no stresses of these elements balance them."""
    problem = cube(n=2).with_loads([la.BodyForce("block", (0.0, 0.0, lambda x: -x[2]))])
    for ask in (la.lower_bound, la.bracket):
        with pytest.raises(la.InputError, match="uniform in each"):
            ask(problem)
    high = la.upper_bound(problem)
    assert high.rigor is la.Rigor.UPPER
    dofs = high.discretisation.continua["block"]
    mesh, velocity = dofs.body.mesh, high.velocity[dofs.dofs][:, dofs.element_nodes]
    # Uniform compression is one of its velocities: the power of z downwards is alpha/3.
    assert high.load_factor <= 3 * sqrt(3) * (1 + SOLVED)
    # Cubic in each element: the rule of degree 3 with five points is exact (Stroud).
    share = np.full((5, 4), 1 / 6)
    share[0], share[range(1, 5), range(4)] = 1 / 4, 1 / 2
    quadratic = [share * (2 * share - 1)]
    quadratic += [4 * share[:, i, None] * share[:, j, None] for i, j in EDGES.T]
    down = np.einsum("pn,ne->pe", np.concatenate(quadratic, axis=1), velocity[2])
    _, volume = gradients(mesh.p, mesh.t)
    force = -share @ mesh.p[2][mesh.t]
    power = np.array([-0.8, *(4 * [0.45])]) @ (down * force) @ volume
    assert power == pytest.approx(1, rel=1e-10)


@pytest.mark.parametrize("space", SPACES)
def test_a_force_that_no_rule_integrates_has_no_bound(space):
    problem = cube(space).with_loads(
        [la.BodyForce("block", (0.0, 0.0, lambda x: -np.exp(9 * x[2])))]
    )
    with pytest.raises(la.InputError, match="not linear in each"):
        la.upper_bound(problem)
    assert la.solve(problem).rigor is la.Rigor.DISCRETE


def test_a_bracket_refines_where_the_mechanism_is():
    """Each bound on a mesh of its own, marked by its own dissipation."""
    problem = strip("p1-disc", n=2)
    bracket = la.bracket(problem, 0.13, time_limit=60.0, backend="interior_point", jobs=1)
    assert bracket.status.label == "reached"
    assert bracket.lower < STRIP < bracket.upper
    assert bracket.lower_bound.rigor is la.Rigor.LOWER
    assert bracket.upper_bound.rigor is la.Rigor.UPPER
    assert bracket.upper_bound.discretisation.continua["soil"].body.space == "p2-disc"
    elements = bracket.history.groupby("bound")["elements"].max()
    assert elements.min() > problem.bodies["soil"].mesh.nelements
    assert elements.max() < 2000


@pytest.mark.slow
def test_a_smooth_square_footing_within_six_percent():
    """Strict bounds of others on the same domain: [5.1295, 5.3310] k (REFERENCES_3D)."""
    mesh = la.meshes.box((0, 2.6), (0, 2.6), (-1.3, 0), 4, 4, 2, False, (1.0, 1.0), (1.0, 1.0))
    x, y, _ = mesh.p[:, mesh.t].mean(axis=1)
    clay = la.Body(mesh.restrict(np.flatnonzero(y < x)), CRITERION, kinematics="3d")
    problem = la.Problem(
        {"clay": clay},
        [la.RigidFooting("clay", lambda x: (x[2] == 0) & (x[0] <= 1), (0, 0, -1), rough=False)],
        [
            la.Fix("clay", "front", "normal"),
            la.Fix("clay", lambda x: np.abs(x[0] - x[1]) < 1e-9, "normal"),
            la.Fix("clay", "right", "xyz"),
            la.Fix("clay", "bottom", "xyz"),
        ],
    )
    bracket = la.bracket(problem, 0.06, time_limit=300.0, backend="interior_point")
    assert bracket.width <= 0.06
    assert bracket.lower < 5.3310
    assert bracket.upper > 5.1295


TORSION = 8 / 3  # k a^3/3, twice the volume of the heap of sand (Nadai)


def test_torsion_of_a_square_bar_exactly_where_ridges_of_the_heap_are_faces():
    """Cells cut along both diagonals: bounds from both sides meet."""
    problem = torsion("p2-disc", 1, crossed=True)
    low, high = (bound(problem, "interior_point") for bound in (la.lower_bound, la.upper_bound))
    assert low.load_factor <= TORSION * (1 + 1e-12)
    assert high.load_factor >= TORSION * (1 - 1e-12)
    assert high.load_factor - low.load_factor <= 1e-6 * TORSION  # the backend's tolerance, twice


@pytest.mark.parametrize("space", ["p2-vertex", "p2-disc"])
def test_torsion_from_above_and_below_is_of_second_order(space):
    """On other meshes; strain rates are smooth but at the ridges: order 2, 1.7 at least."""
    above, below = [], []
    for n in (1, 2):
        problem = torsion(space, n)
        above.append(la.solve(problem, "interior_point").load_factor / TORSION - 1)
        below.append(1 - la.lower_bound(problem, "interior_point").load_factor / TORSION)
    assert min(above + below) > 0
    assert np.log2(above[0] / above[1]) >= 1.7
    assert np.log2(below[0] / below[1]) >= 1.5


@pytest.mark.parametrize("space", SPACES)
def test_strengths_that_vary_are_bounded_from_both_sides(space):
    """Linear with height, steeper than linear, and by regions: the weakest place yields first."""
    mesh = la.meshes.box((0, 1), (0, 1), (0, 2), 1, 1, 2).with_subdomains(
        {"weak": lambda x: x[2] < 1, "strong": lambda x: x[2] > 1}
    )
    for criterion in (
        la.VonMises(shear_strength=la.Field(lambda x: 1 + x[2])),
        la.VonMises(shear_strength=la.Field(lambda x: 1 + x[2] ** 2 / 20, steepest=0.2)),
        {"weak": la.VonMises(1.0), "strong": la.VonMises(2.0)},
    ):
        problem = cube(space, mesh=mesh, criterion=criterion)
        low, high = (f(problem, "interior_point") for f in (la.lower_bound, la.upper_bound))
        assert low.load_factor <= sqrt(3) * (1 + SOLVED) or not isinstance(criterion, dict)
        assert high.rigor is la.Rigor.UPPER
        assert low.load_factor < high.load_factor
        assert la.gap_identity(high, low).least >= -1e-8


def test_a_column_under_its_own_weight_and_a_surcharge():
    """Stresses balance both; uniaxial ones carry ``sqrt(3) k - gamma h - p``, others no less."""
    dead = [la.BodyForce("block", (0.0, 0.0, -0.5)), la.Pressure("block", "top", 0.3)]
    loaded = cube(n=2).with_loads(dead_loads=dead)
    low, high = (ask(loaded, "interior_point") for ask in (la.lower_bound, la.solve))
    assert low.rigor is la.Rigor.LOWER
    assert (sqrt(3) - 0.5 - 0.3) * (1 - 1e-6) < low.load_factor < high.load_factor
    mesh, sigma = loaded.bodies["block"].mesh, tensors(low.stress["block"])
    gradient, _ = gradients(mesh.p, mesh.t)
    # Residuals of equilibrium are at round-off of stresses of order one.
    balance = np.einsum("eaij,eaj->ei", sigma, gradient) - np.array([0.0, 0.0, 0.5])
    assert np.abs(balance).max() <= 1e-12
    high_up = mesh.p[2][mesh.t].T == 1.0  # (elements, vertices)
    under_top = high_up & (high_up.sum(axis=1, keepdims=True) == 3)
    pulled = sigma[under_top][:, :, 2]
    np.testing.assert_allclose(pulled[:, 2], -(low.load_factor + 0.3), rtol=1e-12)
    assert np.abs(pulled[:, :2]).max() <= 1e-12
    deviator = sigma - np.trace(sigma, axis1=2, axis2=3)[..., None, None] / 3 * np.eye(3)
    assert np.sqrt((deviator**2).sum(axis=(2, 3)) / 2).max() <= 1.0


def test_a_soil_under_pressure_from_all_sides():
    """Triaxial: ``alpha + p = K p + 2 c sqrt(K)``, ``K = (1 + sin)/(1 - sin)``; from both sides."""
    angle, cell = np.radians(20.0), 0.7
    passive = (1 + np.sin(angle)) / (1 - np.sin(angle))
    exact = passive * cell + 2 * np.sqrt(passive) - cell
    soil = la.DruckerPrager(1.0, 20.0, "compression")
    dead = [la.Pressure("block", side, cell) for side in ("right", "back", "top")]
    problem = cube("p2-vertex", criterion=soil).with_loads(dead_loads=dead)
    low, high = la.lower_bound(problem), la.upper_bound(problem)
    assert low.rigor is la.Rigor.LOWER
    # Dead loads cost a margin of 1e-7 of cohesion and slope, which pressures multiply by tens.
    assert exact * (1 - 1e-5) <= low.load_factor <= exact
    assert high.load_factor == pytest.approx(exact, rel=1e-6)
