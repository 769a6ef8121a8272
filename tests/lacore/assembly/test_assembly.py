"""Rows, weights and load vectors against exact integrals and derivatives.

P2 velocities hold every quadratic field exactly, so all that is asserted here is exact up to
round-off: 1e-12 of numbers of order one to ten, after sums of some hundred terms.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from lacore.program.state import ProgramState, internal_force
from tests.lacore.models import CRITERION, obstacle, polynomial, punch, square, under_footing

ROUND_OFF = 1e-12
SPACES = ["p2-vertex", "p2-gauss"]


def distorted(rng, n=3):
    """A square with its inner vertices moved by up to a tenth of a cell."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), n, n)
    points = mesh.p.copy()
    inner = np.all((points > 1e-9) & (points < 1 - 1e-9), axis=0)
    points[:, inner] += rng.uniform(-0.1, 0.1, (2, inner.sum())) / n
    return replace(mesh, doflocs=points)


def discretised(mesh, space="p2-vertex", reference=None, **more):
    body = la.Body(mesh, CRITERION, space=space)
    load = reference or la.Traction("block", "top", (1, 0))
    return la.discretise(la.Problem({"block": body}, [load], **more))


def interpolated(d, field, body="block"):
    """Unknowns of the velocity that follows a field at the nodes of a body."""
    u = np.zeros(d.full.n)
    u[d.continua[body].dofs] = field(d.continua[body].nodes)
    return u


@given(seed=st.integers(0, 10**6), space=st.sampled_from(SPACES))
def test_strain_rates_of_a_quadratic_field(seed, space):
    rng = np.random.default_rng(seed)
    mesh = distorted(rng)
    d = discretised(mesh, space)
    field, gradient = polynomial(rng)
    points = d.continua["block"].basis.global_coordinates()  # (2, elements, 3)
    g = gradient(np.asarray(points).reshape(2, -1))
    (group,) = d.full.groups
    u = interpolated(d, field)
    want = np.stack([g[0, 0] - g[1, 1], g[0, 1] + g[1, 0]], axis=1)
    # Rows are of size 1/h, about 20, so round-off is 20 times that of the field.
    assert np.allclose(group.cone_vectors(u), want, atol=20 * ROUND_OFF)
    assert np.allclose(group.volumetric @ u, g[0, 0] + g[1, 1], atol=20 * ROUND_OFF)


def test_strain_points_are_the_vertices_or_inside():
    mesh = distorted(np.random.default_rng(0))
    at = {}
    for space in SPACES:
        points = discretised(mesh, space).continua["block"].basis.global_coordinates()
        at[space] = np.moveaxis(np.asarray(points), 0, 2)  # (elements, 3, 2)
    corners = mesh.p[:, mesh.t].transpose(2, 1, 0)
    centre = corners.mean(axis=1, keepdims=True)
    assert np.allclose(at["p2-vertex"], corners, atol=ROUND_OFF)
    # The interior rule: halfway from the centre to the vertices.
    halfway = (centre + corners) / 2
    for element, points in enumerate(at["p2-gauss"]):
        distance = np.linalg.norm(points[:, None] - halfway[element][None], axis=2)
        assert np.allclose(distance.min(axis=0), 0, atol=ROUND_OFF)


@pytest.mark.parametrize("space", SPACES)
def test_weights_sum_to_the_area(space):
    mesh = la.meshes.rectangle((0, 2), (0, 3), 3, 2, grade_x=(2.0, 5.0))
    (group,) = discretised(mesh, space).full.groups
    assert group.weights.sum() == pytest.approx(6, rel=ROUND_OFF)
    assert np.allclose(group.weights.reshape(-1, 3).std(axis=1), 0, atol=ROUND_OFF)
    assert np.all(group.bound == 1)


@given(seed=st.integers(0, 10**6))
def test_vertex_rule_over_estimates(seed):
    """A convex function of a linear field (T22): its vertex sum is never below its integral.

    Hence it falls under refinement, and stays above any positive rule exact for linear functions.
    """
    rng = np.random.default_rng(seed)
    mesh = distorted(rng)
    field, _ = polynomial(rng)

    def dissipation(mesh, space):
        d = discretised(mesh, space)
        return d.full.plastic_dissipation(interpolated(d, field))

    coarse, fine = (dissipation(m, "p2-vertex") for m in (mesh, mesh.refined(1)))
    interior = dissipation(mesh, "p2-gauss")
    assert coarse >= fine * (1 - ROUND_OFF)
    assert coarse >= interior * (1 - ROUND_OFF)


@given(seed=st.integers(0, 10**6))
def test_interior_rule_is_exact_for_the_square_of_a_linear_field(seed):
    rng = np.random.default_rng(seed)
    mesh = distorted(rng)
    field, _ = polynomial(rng)
    squares = []
    for m in (mesh, mesh.refined(1)):
        d = discretised(m, "p2-gauss")
        (group,) = d.full.groups
        cone = group.cone_vectors(interpolated(d, field))
        squares.append(group.weights @ np.sum(cone**2, axis=1))
    assert squares[0] == pytest.approx(squares[1], rel=100 * ROUND_OFF)


@given(seed=st.integers(0, 10**6))
def test_rigid_motions_strain_nothing(seed):
    rng = np.random.default_rng(seed)
    a, b, w = rng.uniform(-1, 1, 3)
    d = discretised(distorted(rng))
    u = interpolated(d, lambda x: np.stack([a - w * x[1], b + w * x[0]]))
    (group,) = d.full.groups
    assert np.abs(group.rows @ u).max() < 1e-12 * 20  # strain rows are of size 1/h, about 20
    assert np.abs(group.volumetric @ u).max() < 1e-12 * 20


# Exact integrals over [0, 2] x [0, 1] of the quadratic fields (1, x, y, x^2, x y, y^2).
MONOMIALS = [
    lambda x: np.ones_like(x[0]),
    lambda x: x[0],
    lambda x: x[1],
    lambda x: x[0] ** 2,
    lambda x: x[0] * x[1],
    lambda x: x[1] ** 2,
]
LOADS = {
    "body force": (lambda v: la.BodyForce("block", v), (2, 2, 1, 8 / 3, 1, 2 / 3)),
    "top": (lambda v: la.Traction("block", "top", v), (2, 2, 2, 8 / 3, 2, 2)),
    "right": (lambda v: la.Traction("block", "right", v), (1, 2, 1 / 2, 4, 1, 1 / 3)),
    "point": (lambda v: la.PointForce("block", (1.0, 0.5), v), (1, 1, 0.5, 1, 0.5, 0.25)),
}


@pytest.mark.parametrize("name", LOADS)
@pytest.mark.parametrize("vector", [(1.0, 0.0), (0.0, 1.0), (-0.3, 2.0)])
def test_power_of_loads_on_quadratic_fields(name, vector):
    build, integrals = LOADS[name]
    mesh = la.meshes.rectangle((0, 2), (0, 1), 4, 2)
    d = discretised(mesh, reference=build(vector))
    for monomial, integral in zip(MONOMIALS, integrals, strict=True):
        for axis in (0, 1):

            def field(x, axis=axis, monomial=monomial):
                return np.stack([monomial(x) * (axis == 0), monomial(x) * (axis == 1)])

            power = d.full.reference_load @ interpolated(d, field)
            assert power == pytest.approx(vector[axis] * integral, abs=ROUND_OFF * 10)


@given(seed=st.integers(0, 10**6))
def test_uniform_pressure_is_the_divergence(seed):
    """Gauss: the power of p all around is -p int div u."""
    rng = np.random.default_rng(seed)
    d = discretised(
        distorted(rng),
        reference=la.BodyForce("block", (1, 0)),
        dead_loads=[la.Pressure("block", side, 3.0) for side in ("left", "right", "top", "bottom")],
    )
    field, _ = polynomial(rng)
    u = interpolated(d, field)
    (group,) = d.full.groups
    power = -3.0 * (group.weights @ (group.volumetric @ u))
    assert d.full.dead_load @ u == pytest.approx(power, abs=1e-12 * 50)


def test_loads_add_and_reference_and_dead_stay_apart():
    a, b = la.Traction("block", "top", (1, 2)), la.Pressure("block", "left", 0.5)
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    one = la.discretise(la.Problem({"block": la.Body(mesh, CRITERION)}, [a], dead_loads=[b]))
    both = la.discretise(la.Problem({"block": la.Body(mesh, CRITERION)}, [a, b]))
    assert np.allclose(
        both.full.reference_load, one.full.reference_load + one.full.dead_load, atol=ROUND_OFF
    )


@given(seed=st.integers(0, 10**6), angle=st.floats(0, 6.28))
def test_contact_rows_are_bernstein_control_values(seed, angle):
    """On each edge u_n(s) = b0 (1-s)^2 + 2 b1 s (1-s) + b2 s^2 (T28)."""
    rng = np.random.default_rng(seed)
    n = np.array([np.cos(angle), np.sin(angle)])
    rotation = np.array([[n[1], n[0]], [-n[0], n[1]]])  # turns (0, 1) into n
    mesh = la.meshes.rectangle((0, 1), (0, 1), 3, 2)
    d = discretised(replace(mesh, doflocs=rotation @ mesh.p), interfaces=[obstacle()])
    field, _ = polynomial(rng)
    u = interpolated(d, field)
    rows, points = d.full.contact, d.points
    assert np.allclose(points.normal, n, atol=1e-12)
    assert rows.weights.sum() == pytest.approx(1, rel=ROUND_OFF)
    along = rotation[:, 0]  # direction of the edge; the tangent is n turned by +90 degrees
    tangent = np.array([-n[1], n[0]])
    s = points.position @ along
    order = np.argsort(s)
    assert np.allclose(s[order], np.linspace(0, 1, 7), atol=1e-12)
    # L/3 at each control value, and twice that where two edges meet.
    assert np.allclose(rows.weights[order] * 9, [1, 1, 2, 1, 2, 1, 1], atol=1e-11)
    inside = np.linspace(0, 1, 11)
    for values, axis in ((rows.opening(u), n), (rows.slip(u)[:, 0], tangent)):
        b = values[order]
        for edge in range(3):
            b0, b1, b2 = b[2 * edge : 2 * edge + 3]
            curve = b0 * (1 - inside) ** 2 + 2 * b1 * inside * (1 - inside) + b2 * inside**2
            x = np.outer(along, (edge + inside) / 3)
            assert np.allclose(curve, axis @ field(x), atol=1e-11)


@given(seed=st.integers(0, 10**6))
def test_contact_weights_integrate_quadratic_fields_on_graded_edges(seed):
    """The integral of a quadratic is L/3 times the sum of its Bernstein coefficients."""
    rng = np.random.default_rng(seed)
    mesh = la.meshes.rectangle((0, 1), (0, 1), 4, 1, grade_x=(0.3, 8.0))
    d = discretised(mesh, interfaces=[obstacle()])
    c = rng.uniform(-1, 1, (2, 3))
    u = interpolated(d, lambda x: c @ np.stack([np.ones_like(x[0]), x[0], x[0] ** 2]))
    along, across = c @ [1, 1 / 2, 1 / 3]
    rows = d.full.contact
    assert rows.weights @ rows.slip(u)[:, 0] == pytest.approx(-along, abs=ROUND_OFF)
    assert rows.weights @ rows.opening(u) == pytest.approx(across, abs=ROUND_OFF)


@given(seed=st.integers(0, 10**6))
def test_no_penetration_at_control_values_is_none_along_the_edge(seed):
    """And the frozen friction dissipation is over-estimated, never under-estimated."""
    rng = np.random.default_rng(seed)
    d = discretised(la.meshes.rectangle((0, 1), (0, 1), 1, 1), interfaces=[obstacle()])
    rows, dofs = d.full.contact, d.continua["block"]
    u = rng.uniform(-1, 1, d.full.n)
    on_edge = dofs.nodes[1] == 0
    lift = max(0.0, -rows.opening(u).min())
    u[dofs.dofs[1]] += lift  # a rigid lift that makes all control values >= 0
    assert rows.opening(u).min() >= -ROUND_OFF
    order = np.argsort(dofs.nodes[0, on_edge])
    u_x, u_y = u[dofs.dofs[:, on_edge]][:, order]  # at s = 0, 1/2, 1
    s = np.linspace(0, 1, 401)
    shape = np.stack([(1 - s) * (1 - 2 * s), 4 * s * (1 - s), s * (2 * s - 1)])
    assert (u_y @ shape).min() >= -ROUND_OFF
    slip = np.abs(u_x @ shape)
    integral = np.sum((slip[1:] + slip[:-1]) / 2) / 400
    # The trapezoidal sum errs by h^2/12 max|slip''| < (1/400)^2/12 * 16 = 1e-5.
    assert rows.weights @ np.abs(rows.slip(u)[:, 0]) >= integral - 1e-5


def test_contact_laws_become_coefficients():
    laws = {
        "left": 0.4,
        "right": la.STICK,  # not beside the Coulomb side: refused there
        "bottom": la.Tresca(3.0),
        "top": la.Coulomb(0.2, associated=True),
    }
    d = discretised(
        la.meshes.rectangle((0, 1), (0, 1), 1, 1),
        reference=la.BodyForce("block", (1, 0)),
        interfaces=[obstacle(side, law) for side, law in laws.items()],
    )
    rows = d.full.contact
    got = {
        side: {
            (c, limit, dil)
            for c, limit, dil in zip(
                rows.coefficient[rows.interface == index],
                rows.limit[rows.interface == index],
                rows.dilatancy[rows.interface == index],
                strict=True,
            )
        }
        for index, side in enumerate(laws)
    }
    assert got == {
        "left": {(0.4, 0.0, 0.0)},
        "right": {(0.0, np.inf, 0.0)},
        "bottom": {(0.0, 3.0, 0.0)},
        "top": {(0.0, 0.0, 0.2)},
    }
    # A corner belongs to two interfaces with two normals: two points.
    assert rows.count == 12


@pytest.mark.parametrize("rough", [True, False])
def test_footing_carries_its_nodes(rough):
    d = la.discretise(punch(rough=rough))
    rng = np.random.default_rng(1)
    q = rng.uniform(-1, 1, d.program.n)
    u = d.free_basis @ q
    dofs, speed = d.continua["soil"], u[-1]
    under = under_footing(dofs.nodes)
    assert np.allclose(u[dofs.dofs[1, under]], -speed, atol=ROUND_OFF)
    if rough:
        assert np.allclose(u[dofs.dofs[0, under]], 0, atol=ROUND_OFF)
    else:
        assert np.abs(u[dofs.dofs[0, under & (dofs.nodes[0] > 0)]]).min() > 1e-6
    # Force is mean pressure times width.
    assert d.full.reference_load @ u == pytest.approx(speed, rel=ROUND_OFF)


def test_one_footing_may_carry_a_dead_and_a_reference_load():
    d = la.discretise(punch(dead=[la.RigidFooting("soil", under_footing, (0, -1), 0.25)]))
    assert d.full.n == 2 * d.continua["soil"].nodes.shape[1] + 1
    assert d.full.dead_load[-1] == 0.25
    assert d.full.reference_load[-1] == 1.0


def test_two_bodies_do_not_see_each_other():
    d = la.discretise(
        la.Problem(
            {"a": square(1), "b": square(2)},
            [la.Traction("b", "top", (1, 0))],
            supports=[la.Fix("a", "bottom"), la.Fix("b", "bottom")],
        )
    )
    u = interpolated(d, lambda x: np.stack([x[1], x[0] ** 2]), body="b")
    first, second = d.full.groups
    assert np.all(first.dissipation(u) == 0)
    assert second.dissipation(u).sum() > 0
    assert d.held_nodes.sum() == 3 + 5


def test_internal_force_of_a_uniform_stress_is_its_boundary_traction():
    """int sigma : grad v = int (sigma n).v for constant sigma: loads and rows fit together."""
    s, p = np.array([0.7, -0.2]), 0.4
    stress = np.array([[p + s[0], s[1]], [s[1], p - s[0]]])
    normals = {"left": (-1, 0), "right": (1, 0), "bottom": (0, -1), "top": (0, 1)}
    d = discretised(
        distorted(np.random.default_rng(3)),
        reference=la.BodyForce("block", (1, 0)),
        dead_loads=[
            la.Traction("block", side, tuple(stress @ np.array(n))) for side, n in normals.items()
        ],
    )
    count = d.full.groups[0].weights.size
    state = ProgramState(
        velocity=np.zeros(d.full.n),
        load_factor=0.0,
        stress=(np.tile(s, (count, 1)),),
        mean_stress=(np.full(count, p),),
        normal_reaction=np.zeros(0),
        tangential_reaction=np.zeros((0, 1)),
    )
    assert np.allclose(internal_force(d.full, state), d.full.dead_load, atol=ROUND_OFF)


def test_a_footing_is_a_part_of_the_body_under_it():
    """Residuals are judged part by part: its force belongs to that body, whichever comes first."""
    bodies = {
        "left": la.Body(la.meshes.rectangle((0, 1), (0, 1), 1, 1), CRITERION),
        "right": la.Body(la.meshes.rectangle((2, 3), (0, 1), 1, 1), CRITERION),
        "block": la.RigidBlock([[4, 0], [5, 0], [5, 1], [4, 1]]),
    }
    problem = la.Problem(
        bodies,
        [la.RigidFooting("right", "top", (0, -1)), la.Traction("left", "top", (0, -1))],
        [la.Fix(name, "bottom") for name in ("left", "right")],
        [la.Interface(("block", lambda x: x[1] < 1e-9), la.RigidObstacle(), 0.3)],
        dead_loads=[la.BodyForce("block", (0, -1))],
    )
    d = la.discretise(problem)
    parts = d.full.parts
    assert parts[d.footings].tolist() == [parts[d.continua["right"].offset]]
    assert len(set(parts.tolist())) == 3
