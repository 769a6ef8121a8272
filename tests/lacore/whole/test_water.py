"""Water in the pores of a soil and on its boundary, against what is known without water (T64)."""

from dataclasses import replace
from math import cos, radians, sin

import meshio
import numpy as np
import pytest
from skfem import Basis, InteriorFacetBasis, MeshTri, MeshTri2

import lacore as la
from lacore.assembly.water import effective_stress
from lacore.bounds.bracket.kept_water import Interpolated
from lacore.bounds.static_model import static_model
from lacore.model.meshes.refinement import bisected
from lacore.model.meshes.structured import quadrilaterals, rectangle
from lacore.reporting.status import Status

SOIL, CLAY = la.MohrCoulomb(1.0, 20), la.VonMises(1.0)
SPACES = ("p2-vertex", "p2-disc", "p1-disc", "p2-gauss", "q2")
WATER, SATURATED = 1.0, 2.5  # unit weights
SIDES = {
    "left": lambda x: x[0] == 0,
    "right": lambda x: x[0] == 2,
    "bottom": lambda x: x[1] == -1,
    "top": lambda x: x[1] == 0,
    "loaded": lambda x: (x[1] == 0) & (x[0] < 1),
}


def ground(space="p2-vertex", n=2):
    """[0, 2] x [-1, 0] with vertices inside off any pattern."""
    made = quadrilaterals if space == "q2" else rectangle
    mesh = made((0, 2), (-1, 0), 2 * n, n)
    inside = np.setdiff1d(np.arange(mesh.nvertices), mesh.facets[:, mesh.boundary_facets()])
    places = mesh.p.copy()
    places[:, inside] += np.random.default_rng(5).uniform(-0.15, 0.15, (2, inside.size)) / n
    return type(mesh)(places, mesh.t).with_boundaries(SIDES)


def loaded(dead, criterion=SOIL, space="p2-vertex", mesh=None, **body):
    """A strip load on the ground."""
    mesh = ground(space) if mesh is None else mesh
    return la.Problem(
        bodies={"soil": la.Body(mesh, criterion, space=space, **body)},
        supports=[
            la.Fix("soil", "bottom"),
            la.Fix("soil", "left", "x"),
            la.Fix("soil", "right", "x"),
        ],
        reference_loads=[la.Pressure("soil", "loaded")],
        dead_loads=dead,
    )


def pores(seed=2, n=2, space="p2-vertex"):
    """Pressures at vertices that follow no law."""
    return la.PorePressure(
        "soil", np.random.default_rng(seed).uniform(0, 0.3, ground(space, n).nvertices)
    )


def own_weight(weight):
    return la.BodyForce("soil", (0, -weight))


def submerged(level=0.7):
    table = la.WaterTable(level, WATER)
    return [
        own_weight(SATURATED),
        la.PorePressure("soil", table),
        la.StandingWater("soil", "top", table),
    ]


def power_of_water(discretisation, velocity, pressure):
    """``int u div(v) + int u [v_n]`` by quadrature of elements and edges, from scikit-fem alone."""
    dofs = discretisation.continua["soil"]
    mesh, element = dofs.body.mesh, dofs.basis.elem
    hat = {MeshTri: "ElementTriP1"}.get(type(mesh), "ElementQuad1")
    hat = getattr(__import__("skfem"), hat)()
    inside = Basis(mesh, element, intorder=8)
    flow = inside.interpolate(velocity)
    u = np.asarray(inside.with_element(hat).interpolate(pressure))
    total = np.sum(u * (flow.grad[0, 0] + flow.grad[1, 1]) * inside.dx)
    if dofs.space.jumps:
        one, two = (InteriorFacetBasis(mesh, element, intorder=8, side=k) for k in (0, 1))
        jump = np.asarray(two.interpolate(velocity)) - np.asarray(one.interpolate(velocity))
        along = np.asarray(one.with_element(hat).interpolate(pressure))
        total += np.sum(along * np.sum(jump * one.normals, axis=0) * one.dx)
    return float(total)


@pytest.mark.parametrize("space", SPACES)
def test_the_power_is_that_of_the_pressure_on_what_opens(space):
    """In elements and in jumps; of any velocity, exactly: polynomials of degree 3 at most."""
    load = pores(space=space)
    found = la.discretise(loaded([load], space=space))
    velocity = np.random.default_rng(3).normal(size=found.full.n)
    expected = power_of_water(found, velocity, np.array(load.pressure))
    size = float(np.abs(found.full.dead_load) @ np.abs(velocity))
    assert abs(found.full.dead_load @ velocity - expected) <= 1e-13 * size


def test_the_power_on_a_body_of_revolution_is_that_of_the_whole_ring():
    """``int u (u_r,r + u_z,z + u_r/r) 2 pi r``, at a quadrature of its own."""
    mesh = ground()
    load = pores()
    problem = la.Problem(
        bodies={"soil": la.Body(mesh, SOIL, "axisymmetric", "p2-gauss")},
        supports=[la.Fix("soil", "bottom")],
        reference_loads=[la.Pressure("soil", "loaded")],
        dead_loads=[load],
    )
    found = la.discretise(problem)
    velocity = np.random.default_rng(3).normal(size=found.full.n)
    basis = Basis(mesh, found.continua["soil"].basis.elem, intorder=8)
    flow, radius = basis.interpolate(velocity), basis.global_coordinates()[0]
    hats = basis.with_element(__import__("skfem").ElementTriP1())
    u = np.asarray(hats.interpolate(np.array(load.pressure)))
    rate = radius * (flow.grad[0, 0] + flow.grad[1, 1]) + np.asarray(flow)[0]
    expected = 2 * np.pi * np.sum(u * rate * basis.dx)
    size = float(np.abs(found.full.dead_load) @ np.abs(velocity))
    assert abs(found.full.dead_load @ velocity - expected) <= 1e-13 * size


def test_equilibrium_elements_take_the_same_water():
    """It is what a stress ``-u I`` at the vertices does on any multipliers."""
    load = pores()
    full = static_model(loaded([load])).full
    group, mesh = full.groups[0], ground()
    u = np.array(load.pressure)[mesh.t.T].ravel()  # the vertices of an element, one by one
    expected = group.volumetric.T @ (group.weights * u)
    assert np.allclose(full.dead_load, expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize("space", SPACES)
def test_a_submerged_soil_is_one_of_buoyant_weight(space):
    """Archimedes: whatever moves, wherever it may."""
    wet = la.discretise(loaded(submerged(), space=space)).program
    dry = la.discretise(loaded([own_weight(SATURATED - WATER)], space=space)).program
    assert np.allclose(wet.dead_load, dry.dead_load, rtol=0, atol=1e-13)


def test_a_submerged_ring_is_one_of_buoyant_weight():
    """Around the whole circumference."""
    wet, dry = (
        la.discretise(loaded(dead, space="p2-gauss", kinematics="axisymmetric")).program
        for dead in (submerged(), [own_weight(SATURATED - WATER)])
    )
    size = float(np.abs(dry.dead_load).max())
    assert np.allclose(wet.dead_load, dry.dead_load, rtol=0, atol=1e-12 * size)


def test_bounds_of_a_submerged_soil_are_those_of_buoyant_weight():
    """To the tolerance of two solves, 1e-8."""
    wet, dry = loaded(submerged()), loaded([own_weight(SATURATED - WATER)])
    assert la.lower_bound(wet).load_factor == pytest.approx(la.lower_bound(dry).load_factor, 1e-6)
    assert la.upper_bound(wet).load_factor == pytest.approx(la.upper_bound(dry).load_factor, 1e-6)


def pressed(pressure, criterion, space="p2-vertex"):
    """A square pressed at its top, under 0.5 from its side, with water in it."""
    made = quadrilaterals if space == "q2" else rectangle
    mesh = made((0, 1), (0, 1), 1, 1)
    return la.Problem(
        bodies={"soil": la.Body(mesh, criterion, space=space)},
        supports=[la.Fix("soil", "left", "x"), la.Fix("soil", "bottom", "y")],
        reference_loads=[la.Pressure("soil", "top")],
        dead_loads=[la.Pressure("soil", "right", 0.5), la.PorePressure("soil", pressure)],
    )


def strength(pressure, c, phi):
    """Total vertical pressure: that of Mohr-Coulomb under the effective lateral one, and u."""
    s = sin(radians(phi))
    effective = (2 * c * cos(radians(phi)) + (0.5 - pressure) * (1 + s)) / (1 - s)
    return effective + pressure


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("pressure", [0.3, 0.8])
def test_a_square_under_two_pressures(space, pressure):
    """In closed form, also where the water presses more than the side: cohesion holds it."""
    state = la.solve(pressed(pressure, la.MohrCoulomb(1.0, 30), space))
    assert state.load_factor == pytest.approx(strength(pressure, 1.0, 30), rel=1e-6)


def plane_means(stress):
    return stress["soil"][..., :2].mean(axis=(0, 1))


@pytest.mark.parametrize("dilation", [0, 10])
def test_a_square_of_soil_that_is_not_associated(dilation):
    """The frozen pressures of its loop are effective ones: the same strength, certified."""
    soil = la.MohrCoulomb(1.0, 30, dilation_angle=dilation)
    state = la.solve(pressed(0.3, soil, "p2-gauss"))
    assert state.status is Status.SOLVED
    assert state.load_factor == pytest.approx(strength(0.3, 1.0, 30), rel=1e-6)


def test_total_and_effective_stresses_are_shown():
    """Where both are known: the side is pressed by 0.5, of which the water carries 0.3."""
    problem = pressed(0.3, la.MohrCoulomb(1.0, 30))
    exact = strength(0.3, 1.0, 30)
    for found in (la.solve(problem), la.lower_bound(problem)):
        assert np.allclose(found.pore_pressure["soil"], 0.3)
        # Means, as strain rates that are uniform feel these alone; of elements of one size.
        assert np.allclose(plane_means(found.stress), [-0.5, -exact], atol=1e-5)
        assert np.allclose(plane_means(found.effective_stress), [-0.2, 0.3 - exact], atol=1e-5)


def test_water_that_grows_with_the_load_is_shown_at_its_size():
    problem = pressed(0.3, la.MohrCoulomb(1.0, 30))
    water = problem.dead_loads[1]
    growing = replace(
        problem,
        reference_loads=[*problem.reference_loads, water],
        dead_loads=[problem.dead_loads[0]],
    )
    state = la.solve(growing)
    # alpha = (2 c cos + (0.5 - 0.3 alpha)(1 + s))/(1 - s) + 0.3 alpha with s = 1/2
    assert state.load_factor == pytest.approx((2 * 3**0.5 + 1.5) / 1.6, rel=1e-6)
    assert np.allclose(state.pore_pressure["soil"], 0.3 * state.load_factor)
    assert plane_means(state.stress)[0] == pytest.approx(-0.5, abs=1e-5)


def test_a_state_is_judged_by_its_effective_stress():
    """As it is shown it holds; with its effective stresses as total ones it does not."""
    state = la.solve(pressed(0.3, la.MohrCoulomb(1.0, 30)))
    assert state.certify(stress=state.stress).worst[1] <= 1e-6
    planted = state.certify(stress=state.effective_stress)
    assert max(planted.equilibrium, planted.yield_violation) > 1e-2
    total = state.stress["soil"]
    back = effective_stress(total, state.pore_pressure["soil"])
    assert np.allclose(back, state.effective_stress["soil"], rtol=0, atol=1e-15)


@pytest.mark.parametrize("criterion", [CLAY, la.MohrCoulomb(1.0, 0)])
@pytest.mark.parametrize("space", ["p2-vertex", "p2-disc", "q2"])
def test_what_has_no_friction_feels_no_water(criterion, space):
    """However it is distributed: its flow keeps volumes, so that bounds are the same."""
    wet, dry = (loaded(dead, criterion, space) for dead in ([pores(space=space)], []))
    expected = la.solve(dry).load_factor
    assert la.solve(wet).load_factor == pytest.approx(expected, rel=1e-6)


def test_a_smooth_wall_is_pushed_into_wet_soil():
    """Rankine: ``K_p (gamma - gamma_w) H/2 + 2 c sqrt(K_p)``, and the water; from both sides.

    The soil is compressed alike everywhere, so that both are exact but for margins of 1e-5.
    """
    mesh = rectangle((0, 2), (-1, 0), 2, 1)
    problem = la.Problem(
        bodies={"soil": la.Body(mesh, la.MohrCoulomb(1.0, 30))},
        supports=[la.Fix("soil", "right", "x"), la.Fix("soil", "bottom", "y")],
        reference_loads=[la.RigidFooting("soil", "left", (1, 0), rough=False)],
        dead_loads=[own_weight(SATURATED), la.PorePressure("soil", la.WaterTable(0.0, WATER))],
    )
    exact = 3 * (SATURATED - WATER) / 2 + 2 * 3**0.5 + WATER / 2
    assert la.lower_bound(problem).load_factor == pytest.approx(exact, rel=2e-5)
    assert la.upper_bound(problem).load_factor == pytest.approx(exact, rel=2e-5)


def pushed(pressure, law, criterion=CLAY):
    """A block of 4 by 1 under 1 Pa, on a rigid floor, pushed at its left."""
    mesh = rectangle((0, 4), (0, 1), 4, 1)
    return la.Problem(
        bodies={"soil": la.Body(mesh, criterion)},
        interfaces=[la.Interface(("soil", "bottom"), la.RigidObstacle(), friction=law)],
        reference_loads=[la.Traction("soil", "left", (1, 0))],
        dead_loads=[la.Pressure("soil", "top", 1.0), la.PorePressure("soil", pressure)],
    )


@pytest.mark.parametrize("law", [0.3, la.Coulomb(0.3, associated=True)])
def test_friction_on_a_floor_is_that_of_the_effective_pressure(law):
    """Whatever the values at vertices, their mean: 0.3 (1 - 0.4) 4 m, and not what a clay of 1 Pa
    is crushed by; of Coulomb's law certified, and shown as what the skeleton presses."""
    mesh = rectangle((0, 4), (0, 1), 4, 1)
    values = 0.4 + 0.1 * np.cos(np.pi / 4 * mesh.p[0])  # antisymmetric about the middle
    state = la.solve(pushed(values, law))
    assert state.load_factor == pytest.approx(0.3 * 0.6 * 4, rel=1e-6)
    carried = state.reactions
    assert carried.t_n @ carried.length == pytest.approx(0.6 * 4, rel=1e-6)


def test_bounds_on_a_floor_take_its_water():
    """Both, and their gap: nothing but sliding, exact to round-off of the projections."""
    problem = pushed(0.4, la.Coulomb(0.3, associated=True))
    lower, upper = la.lower_bound(problem), la.upper_bound(problem)
    for bound in (lower, upper):
        assert bound.load_factor == pytest.approx(0.3 * 0.6 * 4, rel=1e-6)
    assert la.gap_identity(upper, lower).total == pytest.approx(
        upper.load_factor - lower.load_factor, abs=1e-9
    )


def test_water_below_a_block_may_lift_it():
    """More than its weight: there is no contact that could carry anything."""
    assert la.solve(pushed(1.2, 0.3)).status is Status.UNSAFE


def test_bounds_with_water_enclose_and_their_gap_is_the_sum_of_its_shares():
    """On any mesh with any pressures, also of velocities that jump."""
    dead = [own_weight(1.0), pores(n=3)]
    stated = loaded(dead, mesh=ground(n=3))
    lower = la.lower_bound(stated)
    for space in ("p2-vertex", "p2-disc"):
        upper = la.upper_bound(loaded(dead, mesh=ground(n=3), space=space))
        gap = upper.load_factor - lower.load_factor
        shares = la.gap_identity(upper, lower)
        assert gap > 0
        assert shares.total == pytest.approx(gap, rel=1e-6)
        assert shares.least >= -1e-9 * gap


def test_water_lowers_what_friction_carries():
    """The more of it the lower, and by both bounds."""
    more = la.PorePressure("soil", 0.4)
    dead = [own_weight(1.0)]
    for bound in (la.lower_bound, la.upper_bound):
        dry, wet = (bound(loaded(own)).load_factor for own in (dead, [*dead, more]))
        assert wet < 0.95 * dry


def test_stresses_of_a_lower_bound_meet_the_water_that_stands_on_the_ground():
    """Beside the load, where nothing else presses: total stresses are the pressure of the water."""
    bound = la.lower_bound(loaded(submerged()))
    mesh = ground()
    facets = mesh.facets_satisfying(lambda x: (x[1] == 0) & (x[0] > 1), boundaries_only=True)
    for facet in facets:
        (element,) = mesh.f2t[:1, facet]
        own = np.isin(mesh.t[:, element], mesh.facets[:, facet])
        stress = bound.stress["soil"][element, own]
        assert np.allclose(stress[:, 1], -0.7 * WATER, atol=1e-9)
        assert np.allclose(stress[:, 3], 0, atol=1e-9)


def test_a_factor_of_safety_with_water():
    """Under 9/10 of its load a square has the factor by which c and tan(phi) must fall."""
    load = 0.9 * strength(0.3, 1.0, 30)
    problem = pressed(0.3, la.MohrCoulomb(1.0, 30))
    given = replace(problem, reference_loads=[la.Pressure("soil", "top", load)])
    found = la.safety_factor(given)
    phi = lambda factor: np.degrees(np.arctan(np.tan(np.radians(30)) / factor))  # noqa: E731
    left = lambda factor: strength(0.3, 1 / factor, phi(factor)) - load  # noqa: E731
    assert found.lower <= found.upper
    assert left(found.lower) >= -1e-6
    assert left(found.upper) <= 1e-6
    assert found.upper - found.lower <= 3e-3


def test_a_bracket_keeps_the_water_of_its_first_mesh():
    """A function is taken as it is on the mesh of the problem: so both ends bound one problem."""

    def bulge(x):
        return 0.6 * (x[0] * (2 - x[0])) * (1 + x[1]) ** 2

    mesh = ground()
    by_function = loaded([own_weight(1.0), la.PorePressure("soil", bulge)])
    by_values = loaded([own_weight(1.0), la.PorePressure("soil", bulge(mesh.p))])
    found = la.bracket(by_function, 0.6)
    assert found.status.name == "REACHED"
    assert found.lower >= la.lower_bound(by_values).load_factor - 1e-6
    finer, _ = bisected(bisected(mesh, np.arange(mesh.nelements))[0], np.arange(7))
    kept = found.upper_bound.discretisation.problem.dead_loads[1].pressure
    assert isinstance(kept, Interpolated)
    middle = (finer.p[:, finer.facets[0]] + finer.p[:, finer.facets[1]]) / 2
    at_ends = kept(finer.p)[finer.facets].mean(axis=0)
    assert np.allclose(kept(middle), at_ends, rtol=0, atol=1e-12)
    assert np.allclose(kept(mesh.p), bulge(mesh.p), rtol=0, atol=1e-15)
    with pytest.raises(la.InputError, match="other water between its vertices"):
        la.bracket(by_function, lower_mesh=ground(n=3))


def test_a_body_with_curved_edges_takes_water():
    """Of vertices that lie as they did nothing changes."""
    straight = ground()
    curved = MeshTri2.from_mesh(straight).with_boundaries(SIDES)
    wet = [la.discretise(loaded(submerged(), space="p2-gauss", mesh=m)) for m in (straight, curved)]
    one, other = (float(np.abs(own.program.dead_load).sum()) for own in wet)
    assert one == pytest.approx(other, rel=1e-9)


def test_dead_water_alone_may_lift_the_ground():
    """Artesian: water under a light soil without cohesion to speak of; it is told as unsafe.

    With the question whether the water of a river was forgotten, as long as none stands on it.
    """
    light = loaded(
        [own_weight(0.5), la.PorePressure("soil", lambda x: 4 * (-x[1]))], la.MohrCoulomb(0.01, 30)
    )
    state = la.solve(light)
    assert state.status is Status.UNSAFE
    assert "state a StandingWater" in state.message


def test_files_show_both_parts_of_the_stress(tmp_path):
    """Cell by cell: total less effective is the pressure, along all three axes."""
    state = la.solve(pressed(0.3, la.MohrCoulomb(1.0, 30)))
    state.to_vtu(tmp_path / "wet.vtu")
    cells = {
        key: np.concatenate(own) for key, own in meshio.read(tmp_path / "wet.vtu").cell_data.items()
    }
    assert np.allclose(cells["pore_pressure"], 0.3)
    water = cells["effective_stress"] - cells["stress"]
    assert np.allclose(water, [0.3, 0.3, 0.3, 0, 0, 0])


@pytest.mark.parametrize("space", SPACES)
def test_pressures_are_shown_where_stresses_are(space):
    """Of a linear function those of the strain points, on whatever elements."""

    def rising(x):
        return 0.1 * (1 + x[0] + 2 * (1 + x[1]))

    state = la.solve(loaded([la.PorePressure("soil", rising)], space=space))
    places = np.asarray(state.discretisation.continua["soil"].basis.global_coordinates())
    assert np.allclose(state.pore_pressure["soil"], rising(places), rtol=1e-12)
