"""Lower bounds of body forces that are linear in elements: quadratic stresses, looked at."""

from itertools import permutations

import numpy as np
import pytest
from skfem import MeshTri
from skfem.quadrature import get_quadrature

import lacore as la
from lacore.bounds.quadratic.bubbles import EDGES, Bubbles, _most, bubble_power, bubbles

WEIGHT = la.Linear(-18e3, (300.0, 2e3), at=(0.0, 1.0))  # N/m^3, heavier below
SOILS = {"clay": la.VonMises(40e3), "soil": la.MohrCoulomb(20e3, 20.0)}
COHESION = la.Linear(20e3, (1e3, -2e3), at=(0.0, 1.0))  # Pa, larger below
FIRM = la.MohrCoulomb(COHESION, 20.0)
VARYING = {
    "cut-off": la.MohrCoulomb(20e3, 20.0, tension_cutoff=la.Linear(8e3, (0.0, -1e3))),
    "Rankine": la.Rankine(la.Linear(20e3, (0.0, -1e3)), 200e3),
    "Drucker-Prager": la.DruckerPrager(COHESION, 20.0),
}
EXACT = 1e-9  # of the largest term: round-off of a projection, of meshes of some hundred elements


def cut(criterion, mesh, live, dead=()):
    return la.Problem(
        {"soil": la.Body(mesh, criterion)},
        live,
        [la.Fix("soil", "bottom"), la.Fix("soil", "right")],
        dead_loads=dead,
    )


def grid(n=3, crossed=True):
    return la.meshes.rectangle((0, 2), (0, 1), 2 * n, n, crossed=crossed)


def kneaded(mesh, seed=0):
    """With vertices inside moved at random: no angle of it is that of another."""
    rng = np.random.default_rng(seed)
    p = mesh.p.copy()
    inside = mesh.interior_nodes()
    p[:, inside] += rng.uniform(-0.03, 0.03, (2, inside.size))
    return type(mesh)(p, mesh.t).with_boundaries(
        {"bottom": lambda x: x[1] == 0, "right": lambda x: x[0] == 2}
    )


def field(bound, name="soil"):
    """Vertex stresses (e, 3, (xx, yy, xy)) and controls of bubbles (e, 3, 3) of a bound."""
    own = bound.model.bulging.at(name, bound.load_factor)
    return bound.stress[name][..., [0, 1, 3]], own.control


def at(stress, control, shares):
    """Stresses at barycentric places of all elements, shape (e, 3)."""
    own = np.einsum("i,eic->ec", shares, stress)
    return own + sum(shares[a] * shares[b] * control[:, f] for f, (a, b) in enumerate(EDGES))


def slopes(mesh):
    corner = mesh.p[:, mesh.t]
    edges = np.stack([corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]], axis=1)
    inverse = np.linalg.inv(edges.transpose(2, 0, 1))  # (e, local, xy)
    return np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)


@pytest.mark.parametrize("edges", [1, 2, 3])
def test_what_quadratic_stresses_use_is_the_most_of_them(edges):
    """Of clay: their deviators of one way, so that shares of edges add up without loss."""
    mesh, rng = grid(), np.random.default_rng(edges)
    (clay,) = la.Body(mesh, SOILS["clay"]).regions
    way = rng.normal(size=(mesh.nelements, 1, 2))
    control = np.zeros((mesh.nelements, 3, 3))
    control[:, :edges, 0] = rng.uniform(1, 2, (mesh.nelements, edges)) * way[..., 0]
    control[:, :edges, 1] = -control[:, :edges, 0]
    control[:, :edges, 2] = control[:, :edges, 0] / way[..., 0] * way[..., 1]
    used = Bubbles(control, np.zeros((2, mesh.nelements, 3))).uses(clay)[0]
    places = np.stack(np.meshgrid(*[np.linspace(0, 1, 101)] * 2), axis=-1).reshape(-1, 2)
    places = places[places.sum(axis=1) <= 1]
    most = np.zeros(mesh.nelements)
    for shares in np.column_stack([places, 1 - places.sum(axis=1)]):
        s = at(np.zeros((mesh.nelements, 3, 3)), control, shares)
        most = np.maximum(most, np.linalg.norm(s @ np.linalg.pinv(clay.form.rows), axis=1))
    assert np.all(most <= used * (1 + EXACT))
    # Places are .01 apart, where their quadratic is stationary: 1e-4 of its largest control.
    assert np.all(most >= used - 1e-4 * np.abs(control).max(axis=(1, 2)))


@pytest.mark.parametrize(
    "edges", [(1.0, 1.2, 1.4), (1.0, 1.0, 1.0), (1.0, 1.0, 3.0), (0.0, 1.0, 2.0), (5.0, 0.0, 0.0)]
)
def test_bubbles_of_any_edges_are_largest_on_an_edge_or_inside(edges):
    """By search over the triangle, in every order of the edges, and in any unit."""
    places = np.stack(np.meshgrid(*[np.linspace(0, 1, 301)] * 2), axis=-1).reshape(-1, 2)
    places = np.column_stack([places, 1 - places.sum(axis=1)])[places.sum(axis=1) <= 1]
    for order in permutations(edges):
        bubble = sum(
            f * places[:, a] * places[:, b] for f, (a, b) in zip(order, EDGES, strict=True)
        )
        found = _most(np.array([order, 1e3 * np.array(order)]))
        assert found == pytest.approx(bubble.max() * np.array([1, 1e3]), rel=1e-4)


LOADS = {
    "live": ([la.BodyForce("soil", (0.0, WEIGHT))], []),
    "dead": (
        [la.Pressure("soil", lambda x: (x[1] == 1) & (x[0] <= 1), 1e3)],
        [la.BodyForce("soil", (0.0, WEIGHT))],
    ),
    "both, and sideways": (
        [la.BodyForce("soil", (la.Linear(3e3, (0.0, 2e3)), 0.0))],
        [la.BodyForce("soil", (0.0, la.Linear(-9e3, (-500.0, 1e3))))],
    ),
}


@pytest.mark.parametrize("loads", LOADS)
@pytest.mark.parametrize("soil", [*SOILS, "firm"])
def test_stresses_of_a_lower_bound_are_admissible_everywhere(soil, loads):
    """Equilibrium and yield at random places of each element, tractions along each edge."""
    live, dead = LOADS[loads]
    mesh = kneaded(grid())
    bound = la.lower_bound(cut({**SOILS, "firm": FIRM}[soil], mesh, live, dead), throw=True)
    stress, control = field(bound)
    gradient, rng = slopes(mesh), np.random.default_rng(0)
    corner = mesh.p[:, mesh.t]
    size = np.abs(stress).max()
    for shares in rng.dirichlet(np.ones(3), 40):
        s = at(stress, control, shares)
        deviator = np.hypot((s[:, 0] - s[:, 1]) / 2, s[:, 2])
        if soil == "clay":
            assert deviator.max() <= 40e3
        else:
            mean, phi = (s[:, 0] + s[:, 1]) / 2, np.radians(20.0)
            cohesion = 20e3 if soil == "soil" else COHESION(np.einsum("i,xie->xe", shares, corner))
            assert np.all(deviator <= cohesion * np.cos(phi) - np.sin(phi) * mean)
        slope = np.einsum("eix,eic->ecx", gradient, stress)
        for f, (a, b) in enumerate(EDGES):
            along = shares[a] * gradient[:, b] + shares[b] * gradient[:, a]
            slope += control[:, f, :, None] * along[:, None, :]
        x = np.einsum("i,xie->xe", shares, corner)
        total = np.stack([slope[:, 0, 0] + slope[:, 2, 1], slope[:, 2, 0] + slope[:, 1, 1]])
        for loads_of_kind, factor in ((live, bound.load_factor), (dead, 1.0)):
            for load in loads_of_kind:
                if isinstance(load, la.BodyForce):
                    own = [c(x) if callable(c) else c + 0 * x[0] for c in load.vector]
                    total += factor * np.stack(own)
        assert np.abs(total).max() <= EXACT * size * np.abs(gradient).max()
    free = np.setdiff1d(mesh.boundary_facets(), mesh.boundaries["bottom"])
    free = np.setdiff1d(free, mesh.boundaries["right"])
    for share in rng.uniform(size=5):
        found = np.zeros((2, 2, mesh.nfacets))  # sides, components
        for local, (a, b) in enumerate(EDGES):
            facets = mesh.t2f[local]
            start = np.where(mesh.t[a] == mesh.facets[0, facets], 1 - share, share)
            shares = np.zeros((3, mesh.nelements))
            shares[a], shares[b] = start, 1 - start
            s = np.einsum("ie,eic->ec", shares, stress)
            s += (start * (1 - start))[:, None] * control[:, local]
            along = mesh.p[:, mesh.facets[1, facets]] - mesh.p[:, mesh.facets[0, facets]]
            n = np.stack([along[1], -along[0]]) / np.linalg.norm(along, axis=0)
            side = np.where(mesh.f2t[0, facets] == np.arange(mesh.nelements), 0, 1)
            found[side, 0, facets] = s[:, 0] * n[0] + s[:, 2] * n[1]
            found[side, 1, facets] = s[:, 2] * n[0] + s[:, 1] * n[1]
        inner = mesh.f2t[1] >= 0
        assert np.abs(found[0] - found[1])[:, inner].max() <= EXACT * size
        if loads == "live":
            assert np.abs(found[0][:, free]).max() <= EXACT * size


@pytest.mark.parametrize("soil", VARYING)
def test_soils_whose_strength_and_weight_vary_have_both_bounds(soil):
    live, dead = LOADS["dead"]
    problem = cut(VARYING[soil], grid(), live, dead)
    lower, upper = la.lower_bound(problem, throw=True), la.upper_bound(problem, throw=True)
    assert 0 < lower.load_factor < upper.load_factor
    gap = la.gap_identity(upper, lower)
    assert gap.total == pytest.approx(upper.load_factor - lower.load_factor, rel=1e-9)
    assert gap.least >= -1e-7 * upper.load_factor


@pytest.mark.parametrize("space", ["p2-vertex", "p1-disc", "p2-disc"])
@pytest.mark.parametrize("loads", LOADS)
def test_the_gap_is_the_sum_of_shares_that_are_none_below_zero(loads, space):
    live, dead = LOADS[loads]
    for criterion in SOILS.values():
        problem = cut(criterion, grid(2, crossed=False), live, dead)
        body = la.Body(problem.bodies["soil"].mesh, criterion, space=space)
        upper = la.upper_bound(la.Problem({"soil": body}, live, problem.supports, dead_loads=dead))
        lower = la.lower_bound(problem, throw=True)
        gap = la.gap_identity(upper, lower)
        assert gap.total == pytest.approx(upper.load_factor - lower.load_factor, rel=1e-9)
        assert gap.least >= -1e-7 * upper.load_factor  # residuals of two solves


def test_a_layer_that_is_pushed_sideways_shears_off_at_its_base():
    """``alpha int b dy = k`` there. The bound falls short by what quadratic stresses take, h^2."""
    push, k = la.Linear(3.0, (0.0, -2.0)), 5.0
    exact = k / (3.0 - 1.0)
    short = []
    for n in (4, 8):
        mesh = la.meshes.rectangle((0, 0.5), (0, 1), n // 2, n)
        problem = la.Problem(
            {"layer": la.Body(mesh, la.VonMises(k))},
            [la.BodyForce("layer", (push, 0.0))],
            [
                la.Fix("layer", "bottom"),
                la.Fix("layer", "left", "y"),
                la.Fix("layer", "right", "y"),
            ],
        )
        short.append(1 - la.lower_bound(problem, throw=True).load_factor / exact)
    assert 0 < short[1] < short[0] / 3
    assert short[1] < 1e-3


def test_a_bracket_of_a_weight_that_rises_with_depth_closes():
    """On meshes that are refined, from both sides, and with that of uniform weights around it."""

    def bracket(weight):
        problem = cut(la.VonMises(40e3), grid(2), [la.BodyForce("soil", (0.0, weight))])
        return la.bracket(problem, target_width=0.06, max_elements=1500)

    own = bracket(la.Linear(-18e3, (0.0, 4e3), at=(0.0, 1.0)))
    light, heavy = bracket(-18e3), bracket(-22e3)
    assert own.width <= 0.06
    assert heavy.lower <= own.upper
    assert own.lower <= light.upper


def test_forces_in_one_region_alone_are_carried():
    """Of a region, and of nothing beside it, on a mesh whose edges follow it."""
    mesh = la.meshes.layered((0, 2), {"low": (0, 0.5), "high": (0.5, 1)}, 4, 4)
    load = [la.BodyForce("soil", (0.0, WEIGHT), where="high")]
    problem = cut(la.VonMises(40e3), mesh, load)
    lower, upper = la.lower_bound(problem, throw=True), la.upper_bound(problem, throw=True)
    gap = la.gap_identity(upper, lower)
    assert gap.total == pytest.approx(upper.load_factor - lower.load_factor, rel=1e-9)
    assert gap.least >= -1e-7 * upper.load_factor


def test_bubbles_do_their_power():
    """Of a quadratic velocity in each element, as a quadrature of ``tau : eps`` finds it."""
    mesh = grid()
    body = la.Body(mesh, la.VonMises(1.0))
    x, y = mesh.p[:, mesh.t]
    carried = bubbles(body, np.stack([x - 0.3 * y, 0.5 * x + y]).swapaxes(1, 2), "load")
    problem = cut(la.VonMises(1.0), mesh, [la.BodyForce("soil", (0.0, -1.0))])
    discretisation = la.discretise(problem)
    dofs = discretisation.continua["soil"]
    velocity = np.zeros(discretisation.full.n)
    corners = mesh.p[:, mesh.t]
    sides = (corners[:, [0, 1, 0]] + corners[:, [1, 2, 2]]) / 2
    px, py = np.concatenate([corners, sides], axis=1)
    own = dofs.dofs[:, dofs.element_nodes]
    velocity[own[0]], velocity[own[1]] = px**2 - px * py, 0.5 * py**2 + px
    # In barycentric coordinates tau = sum c_f l_i l_j, and eps is linear.
    points, weights = get_quadrature(MeshTri.elem, 3)
    share = np.stack([1 - points.sum(axis=0), *points])
    at_x, at_y = np.einsum("dve,vq->deq", corners, share)
    rate = np.stack([2 * at_x - at_y, at_y, 1 - at_x])  # eps_xx, eps_yy, 2 eps_xy
    products = np.stack([share[0] * share[1], share[1] * share[2], share[0] * share[2]])
    stress = np.einsum("efc,fq->ceq", carried.control, products)
    exact = np.abs(2 * areas(mesh))[:, None] * np.sum(rate * stress, axis=0) @ weights[:, None]
    assert np.abs(exact).max() > 1e-4
    np.testing.assert_allclose(
        bubble_power(carried, dofs, velocity),
        exact[:, 0],
        rtol=EXACT,
        atol=EXACT * np.abs(exact).max(),
    )


def areas(mesh):
    a, b, c = mesh.p[:, mesh.t].transpose(1, 0, 2)
    return ((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]) / 2


def test_a_mesh_of_one_element_carries_no_moment():
    mesh = type(grid())(np.array([[0.0, 1, 0], [0, 0, 1]]), np.array([[0], [1], [2]]))
    body = la.Body(mesh, la.VonMises(1.0))
    forces = np.zeros((2, 1, 3))
    forces[1, 0] = [0.0, 1.0, 0.0]
    with pytest.raises(la.InputError, match="cannot carry the moments"):
        bubbles(body, forces, "Problem.dead_loads")


def test_a_weight_that_uses_up_all_strength_is_refused():
    problem = cut(la.VonMises(40.0), grid(1), LOADS["dead"][0], LOADS["dead"][1])
    with pytest.raises(la.InputError, match="may use up all strength"):
        la.lower_bound(problem)
