"""Isoparametric meshes: curved edges in geometry, loads, supports and contact."""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from skfem import MeshQuad
from skfem.mesh import MeshQuad2, MeshTri2

import lacore as la
from lacore.model.meshes.curved import (
    EdgeCurves,
    OnFacets,
    edge_curves,
    edge_lines,
    jacobians,
    outlines,
    subdivided,
)

K = la.VonMises(shear_strength=1.0)
SPACES = {"p2-gauss": MeshTri2, "q2": MeshQuad2}


def isoparametric(mesh, move=None):
    """The same mesh with midside nodes, `move` of shape (2, nodes) added to all nodes."""
    kind = MeshTri2 if len(mesh.t) == 3 else MeshQuad2
    curved = replace(kind.from_mesh(mesh), _boundaries=mesh.boundaries)
    return curved if move is None else replace(curved, doflocs=curved.p + move(curved))


def shaken(size, inside=False, seed=0):
    """Midside nodes moved at random, by `size` of the edge: along it, and off it inside."""

    def move(mesh):
        rng = np.random.default_rng(seed)
        change = np.zeros_like(mesh.p)
        edges = slice(mesh.nvertices, mesh.nvertices + mesh.nfacets)
        chord = mesh.p[:, mesh.facets[1]] - mesh.p[:, mesh.facets[0]]
        change[:, edges] = size * rng.uniform(-1, 1, mesh.nfacets) * chord
        if inside:
            bulge = size * rng.uniform(-1, 1, mesh.nfacets) * (mesh.f2t[1] >= 0)
            change[:, edges] += bulge * np.stack([-chord[1], chord[0]])
        return change

    return move


def rectangle(space, nx=3, ny=2, x=(0, 1), y=(0, 1)):
    if space == "p2-gauss":
        return la.meshes.rectangle(x, y, nx, ny)
    mesh = MeshQuad.init_tensor(np.linspace(*x, nx + 1), np.linspace(*y, ny + 1))
    near = 1e-9
    return mesh.with_boundaries(
        {
            "left": lambda p: p[0] < x[0] + near,
            "right": lambda p: p[0] > x[1] - near,
            "bottom": lambda p: p[1] < y[0] + near,
            "top": lambda p: p[1] > y[1] - near,
        }
    )


def round_ring(n, inner=1.0, outer=2.0):
    """A quarter of a ring with circular midside nodes."""
    mesh = la.meshes.quarter_ring(inner, outer, n, 2 * n)

    def move(mesh):
        change = np.zeros_like(mesh.p)
        arcs = np.concatenate([mesh.boundaries["bore"], mesh.boundaries["outside"]])
        middle = mesh.p[:, mesh.nvertices + arcs]
        radius = np.linalg.norm(mesh.p[:, mesh.facets[0, arcs]], axis=0)
        change[:, mesh.nvertices + arcs] = (radius / np.linalg.norm(middle, axis=0) - 1) * middle
        return change

    return isoparametric(mesh, move)


places = st.tuples(*[st.floats(-0.2, 0.2)] * 2)


@given(places, st.floats(0, 1), st.floats(-3, 3))
def test_parameters_of_places_on_curves(bulge, s, turn):
    # Middles within 1/4 of the chord from its middle: the edge is not folded.
    direction = np.array([np.cos(turn), np.sin(turn)])
    start = np.array([[1.0], [2.0]])
    end = start + direction[:, None]
    curve = EdgeCurves(start, (start + end) / 2 + np.reshape(bulge, (2, 1)), end)
    # Near a fold the root of a quadratic loses half the digits at most; here 4 |bulge| <= 0.8 (1+).
    np.testing.assert_allclose(curve.parameter(curve.at(s)), s, atol=1e-12)
    normal, tangent = curve.normal(s, np.stack([-direction[1:], direction[:1]])), curve.tangent(s)
    assert abs(float(np.sum(normal * tangent))) < 1e-14
    step = 1e-6  # of a quadratic the central difference is exact, but for round-off: 1e-16/1e-6
    slope = (curve.at(s + step) - curve.at(s - step)) / (2 * step)
    np.testing.assert_allclose(tangent, slope, atol=1e-8)


@pytest.mark.parametrize("space", SPACES)
def test_coefficients_enclose_the_jacobian(space):
    mesh = isoparametric(rectangle(space), shaken(0.15, inside=True))
    coefficients = jacobians(mesh)
    s = np.linspace(0, 1, 21)
    points = np.stack([axis.ravel() for axis in np.meshgrid(s, s)])
    if space == "p2-gauss":
        points = points[:, points.sum(axis=0) <= 1]
    values = np.abs(mesh.mapping().detDF(points))
    assert np.all(values.min(axis=1) >= coefficients.min(axis=1) - 1e-14)
    assert np.all(values.max(axis=1) <= coefficients.max(axis=1) + 1e-14)
    # Sides stay straight: the area is that of the square, and the mean of the coefficients.
    area = 0.5 if space == "p2-gauss" else 1.0
    assert area * coefficients.mean(axis=1).sum() == pytest.approx(1.0, abs=1e-13)
    parts = np.abs(subdivided(mesh).mapping().detDF(np.zeros((2, 1)))) / 2
    assert parts.sum() == pytest.approx(1.0, abs=1e-13)


def refused(*parts):
    return pytest.raises(la.InputError, match="(?s)" + ".*".join(parts))


@pytest.mark.parametrize("space", SPACES)
def test_inverted_elements_are_refused(space):
    def fold(mesh):
        change = np.zeros_like(mesh.p)
        change[0, mesh.nvertices] = 0.3  # of edges of length 1/3 and 1/2: past the middle
        return change

    with refused("Body.mesh", "inverted", "midside nodes"):
        la.Body(isoparametric(rectangle(space), fold), K, space=space)


def test_overlapping_sides_are_refused():
    """A ring all the way round, its ends bent over each other."""
    mesh = rectangle("q2", 12, 1)
    angle, radius = 1.05 * 2 * np.pi, 2.0

    def bend(mesh):
        x, y = mesh.p
        turned = np.stack([(radius + y) * np.cos(angle * x), (radius + y) * np.sin(angle * x)])
        return turned - mesh.p

    with refused("Body.mesh", "overlap"):
        la.Body(isoparametric(mesh, bend), K, space="q2")


@pytest.mark.parametrize("space", ["p2-vertex", "p2-disc", "p1-disc"])
def test_spaces_for_straight_edges_say_so(space):
    with refused("Body.mesh", "MeshTri2", "straight-edged", "p2-gauss"):
        la.Body(isoparametric(rectangle("p2-gauss")), K, space=space)


def platens(mesh, space, mu):
    top = float(mesh.p[1].max())
    return la.Problem(
        bodies={"block": la.Body(mesh, K, space=space)},
        supports=[la.Fix("block", "left", "x")],
        interfaces=[la.Interface(("block", "top"), la.RigidObstacle((0, top), (0, -1)), mu)],
        reference_loads=[la.RigidFooting("block", "bottom", (0, 1), rough=False)],
    )


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("mu", [0.1, 0.3])
def test_straight_curves_change_nothing(space, mu):
    mesh = rectangle(space, 4, 2, y=(0, 0.5))
    straight, curved = (la.solve(platens(m, space, mu)) for m in (mesh, isoparametric(mesh)))
    # Both within the bar of the certificate, whose gap bounds what solves of one program differ by.
    assert curved.load_factor == pytest.approx(straight.load_factor, rel=2e-6)
    assert curved.rigor is la.Rigor.DISCRETE
    one, other = (s.reactions[["x", "y", "n_x", "n_y", "length"]] for s in (straight, curved))
    np.testing.assert_allclose(one, other, atol=1e-14)


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("mu", [0.0, 0.2])
def test_homogeneous_states_on_any_curves(space, mu):
    """Upsetting without friction: the velocity is linear, whatever the shape of elements."""
    mesh = isoparametric(rectangle(space), shaken(0.1, inside=True))
    state = la.solve(platens(mesh, space, mu))
    assert state.status is la.Status.SOLVED
    table = state.reactions
    # Weights of control values are those of the whole edge, and forces those of the footing.
    assert table["length"].sum() == pytest.approx(1.0, abs=1e-13)
    force = float((table["length"] * table["t_n"]).sum())
    assert force == pytest.approx(state.load_factor, rel=2e-6)
    if mu == 0.0:
        assert state.load_factor == pytest.approx(2.0, rel=1e-6)  # the bar of the certificate
        stress = state.stress["block"]
        np.testing.assert_allclose(stress[..., 1] - stress[..., 0], -2.0, atol=1e-4)


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize(
    "load",
    [la.Traction("b", "top", (0.3, 1)), la.Pressure("b", "top", -1), la.BodyForce("b", (0, 1))],
    ids=lambda load: type(load).__name__,
)
def test_loads_on_curves(space, load):
    """Their work on rigid translations: length, chord and area of a body with an arched top."""

    def arch(mesh):
        x, y = mesh.p
        return np.stack([0 * x, 0.2 * y * x * (1 - x) * 4])

    mesh = isoparametric(rectangle(space, 1, 1), arch)
    problem = la.Problem(
        bodies={"b": la.Body(mesh, K, space=space)},
        reference_loads=[load],
        supports=[la.Fix("b", "bottom")],
    )
    full = la.discretise(problem).full
    dofs = la.discretise(problem).continua["b"].dofs
    power = [float(full.reference_load[dofs[axis]].sum()) for axis in (0, 1)]
    slope = 4 * 0.2
    # Length of y = slope x (1 - x): its derivative runs from slope to -slope.
    length = 0.5 * (np.sqrt(1 + slope**2) + np.arcsinh(slope) / slope)
    wanted = {
        la.Traction: (0.3 * length, length),
        la.Pressure: (0.0, 1.0),
        la.BodyForce: (0.0, 1 + slope / 6),
    }[type(load)]
    # Integrals of the length alone are not exact: Gauss with 4 points, error below 1e-5 here.
    np.testing.assert_allclose(power, wanted, atol=1e-4 if isinstance(load, la.Traction) else 1e-13)


def tube(mesh, criterion=None, **problem):
    body = la.Body(mesh, criterion or la.VonMises(yield_stress=1.0), space="p2-gauss")
    return la.Problem(
        bodies={"tube": body},
        supports=[la.Fix("tube", "x_axis", "y"), la.Fix("tube", "y_axis", "x")],
        reference_loads=[la.Pressure("tube", "bore")],
        **problem,
    )


def test_thick_cylinder_on_curves():
    exact = 2 / np.sqrt(3) * np.log(2)
    errors = [la.solve(tube(round_ring(n))).load_factor / exact - 1 for n in (2, 4)]
    assert abs(errors[1]) < 1e-3
    # Fourth order in the size: a third of 16 at least, where straight edges would have 4 to lose.
    assert abs(errors[0] / errors[1]) > 5


def test_a_round_obstacle_takes_the_shape_of_the_edge():
    """A tube in a rigid bore cannot grow: locked, whatever the friction."""
    wall = la.Interface(("tube", "outside"), la.RigidObstacle(), 0.2)
    problem = tube(round_ring(2), interfaces=[wall])
    points = la.discretise(problem).points
    np.testing.assert_allclose(np.linalg.norm(points.position, axis=1), 2.0, rtol=2e-4)
    # Of a quadratic arc of 22.5 degrees the normals are off by theta^3/24 or so.
    np.testing.assert_allclose(points.normal, -points.position / 2, atol=5e-3)
    assert la.solve(problem).status is la.Status.LOCKED


def test_two_curved_bodies_that_match():
    """Two tubes in each other without friction carry what one of their whole thickness does."""
    inner, outer = round_ring(2, 1.0, 1.5), round_ring(2, 1.5, 2.0)
    criterion = la.VonMises(yield_stress=1.0)
    bodies = {
        name: la.Body(mesh, criterion, space="p2-gauss")
        for name, mesh in (("inner", inner), ("outer", outer))
    }
    problem = la.Problem(
        bodies=bodies,
        supports=[
            la.Fix(name, side, component)
            for name in bodies
            for side, component in (("x_axis", "y"), ("y_axis", "x"))
        ],
        interfaces=[la.Interface(("inner", "outside"), ("outer", "bore"), 0.0)],
        reference_loads=[la.Pressure("inner", "bore")],
    )
    value = la.solve(problem).load_factor
    assert value == pytest.approx(2 / np.sqrt(3) * np.log(2), rel=2e-3)  # 1e-3 is that of one tube


def test_curved_sides_that_do_not_match_are_refused():
    inner = la.Body(round_ring(2, 1.0, 1.5), K, space="p2-gauss")
    polygon = la.Body(la.meshes.quarter_ring(1.5, 2.0, 2, 4), K, space="p2-gauss")
    with refused("curved", "apart", "midside nodes"):
        la.Problem(
            bodies={"inner": inner, "outer": polygon},
            interfaces=[la.Interface(("inner", "outside"), ("outer", "bore"), 0.1)],
            reference_loads=[la.Pressure("inner", "bore")],
            supports=[la.Fix("outer", "outside")],
        )


def test_an_edge_that_bulges_off_its_obstacle_is_refused():
    def arch(mesh):
        x, y = mesh.p
        return np.stack([0 * x, 0.1 * y * x * (1 - x)])

    mesh = isoparametric(rectangle("p2-gauss", 1, 1), arch)
    with refused("does not touch its obstacle", "a node lies 0.025 m inside"):
        la.Problem(
            bodies={"b": la.Body(mesh, K, space="p2-gauss")},
            interfaces=[la.Interface(("b", "top"), la.RigidObstacle((0, 1), (0, -1)), 0.1)],
            reference_loads=[la.BodyForce("b", (0, 1))],
        )


def test_predicates_follow_the_curve():
    mesh = round_ring(2)
    body = la.Body(mesh, K, space="p2-gauss")
    problem = replace(tube(mesh), bodies={"tube": body})
    # The chord of an arc of 22.5 degrees sags by 1 - cos(11.25 deg) = 1.9 %.
    load = la.Pressure("tube", lambda x: np.abs(np.linalg.norm(x, axis=0) - 1) < 3e-4)
    named, selected = (
        la.discretise(replace(problem, reference_loads=[p])).full.reference_load
        for p in (la.Pressure("tube", "bore"), load)
    )
    np.testing.assert_allclose(named, selected, atol=1e-14)
    curves = edge_curves(mesh, mesh.boundaries["bore"])
    assert np.abs(np.linalg.norm(curves.at(0.25), axis=0) - 1).max() < 1e-3


def test_points_are_vertices_not_midside_nodes():
    mesh = isoparametric(rectangle("p2-gauss", 1, 1))
    with refused("PointForce|reference_loads", "no vertex"):
        la.Problem(
            bodies={"b": la.Body(mesh, K, space="p2-gauss")},
            reference_loads=[la.PointForce("b", (0.5, 1.0), (0, 1))],
            supports=[la.Fix("b", "bottom")],
        )


def test_pictures():
    state = la.solve(tube(round_ring(2)))
    for figure in (state.plot(), state.discretisation.problem.plot()):
        figure.canvas.draw()
        plt.close(figure)


def q2_tube(n, curved):
    """A quarter of a thick tube under internal pressure, which only its stiffness spreads."""
    flat = la.meshes.quadrilaterals((1, 2), (0, np.pi / 2), n, 2 * n, grade_x=(1.0, 2.0))

    def bend(mesh):
        radius, angle = mesh.p
        turned = np.stack([radius * np.cos(angle), radius * np.sin(angle)])
        turned[0, angle == np.pi / 2] = 0.0
        return turned - mesh.p

    mesh = isoparametric(flat, bend) if curved else replace(flat, doflocs=flat.p + bend(flat))
    return la.Problem(
        bodies={"tube": la.Body(mesh, la.VonMises(yield_stress=1.0), space="q2")},
        supports=[la.Fix("tube", "bottom", "y"), la.Fix("tube", "top", "x")],
        reference_loads=[la.Pressure("tube", "left")],
    )


@pytest.mark.parametrize("curved", [False, True], ids=["straight", "curved"])
def test_no_mode_of_quadrilaterals_is_free(curved):
    """With 2 x 2 strain points 3 and 1.4 % below the exact value: a mode without energy (T24)."""
    exact = 2 / np.sqrt(3) * np.log(2)
    states = [la.solve(q2_tube(n, curved), throw=True) for n in (2, 4)]
    errors = [abs(state.load_factor / exact - 1) for state in states]
    assert errors[1] < 2e-5
    assert np.log2(errors[0] / errors[1]) > 3.5  # fourth order
    # Mean stresses are projected with theta: sigma_rr at the strain points, a row along a radius.
    stress = states[1].stress["tube"]
    place = np.asarray(states[1].discretisation.continua["tube"].basis.global_coordinates())
    radius = np.linalg.norm(place, axis=0)
    mean = stress[..., :2].sum(axis=2) / 2
    # Half of sigma_rr + sigma_tt, with sigma_tt - sigma_rr = 2 k.
    wanted = -2 / np.sqrt(3) * np.log(2 / radius) + 1 / np.sqrt(3)
    np.testing.assert_allclose(mean, wanted, atol=0.01)  # bilinear in cells of size 1/8 and 1/5


def test_isoparametric_keeps_names_and_moves_all_nodes():
    mesh = la.meshes.isoparametric(rectangle("q2", 2, 2), lambda x: x + 1)
    assert type(mesh) is MeshQuad2
    assert mesh.boundaries.keys() == {"left", "right", "bottom", "top"}
    assert mesh.p.min() == 1.0
    with refused("onto", "one place for each node"):
        la.meshes.isoparametric(rectangle("q2", 2, 2), lambda x: x[0])
    with refused("mesh = 'MeshQuad2'", "MeshTri or MeshQuad"):
        la.meshes.isoparametric(mesh)


def test_outlines_follow_curves():
    """Polygons of elements fill the area, to the sag of the chords that curves are drawn by."""
    mesh = round_ring(2)
    polygons = shapely.polygons(outlines(mesh))
    # Six chords an edge of 22.5 degrees: 1 - sinc of 3.75 degrees, 7e-4, at most.
    assert shapely.area(polygons).sum() == pytest.approx(3 * np.pi / 4, rel=1e-3)
    assert shapely.area(shapely.union_all(polygons)) == pytest.approx(3 * np.pi / 4, rel=1e-3)
    lines = edge_lines(mesh, mesh.boundaries["bore"])
    assert {line.shape for line in lines} == {(7, 2)}
    np.testing.assert_allclose([np.hypot(*line.T) for line in lines], 1.0, atol=2e-4)
    straight = la.meshes.quadrilaterals((0, 1), (0, 1), 2, 1)
    assert outlines(straight).shape == (2, 4, 2)
    assert shapely.area(shapely.polygons(outlines(straight))) == pytest.approx([0.5, 0.5])


def test_places_on_facets_of_distorted_elements_are_known():
    """A triangle that is drawn out, a ring, and quadrilaterals: as the map of elements has them."""
    corners = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.4]]
    middles = [[0.5, -0.3], [0.6, 0.3], [0.4, 0.3]]
    sag = MeshTri2(np.array([*corners, *middles]).T, np.array([[0], [1], [2]]))
    along = np.linspace(0, 1, 7)[None]
    for mesh in (sag, round_ring(2), la.meshes.quadrilaterals((0, 1), (0, 1), 2, 1)):
        facets = mesh.boundary_facets()
        mapping = OnFacets(mesh, facets, along)
        element, wanted = mesh.f2t[0, facets], mapping.G(along, find=facets)
        found = mapping.invF(wanted, tind=element)
        np.testing.assert_allclose(
            mapping.F(found, element), wanted, atol=1e-14
        )  # round-off of lengths of 1
        assert found.min() == 0
        assert found.max() == 1
