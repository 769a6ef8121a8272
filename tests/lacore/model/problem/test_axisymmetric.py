"""Bodies of revolution (T27): closed forms, forces of the whole circumference, what is refused."""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from skfem import MeshTri
from skfem.mesh import MeshQuad2, MeshTri2

import lacore as la
from lacore.model.bodies.continuum.body import on_axis
from tests.shares import one_in

S0 = la.VonMises(yield_stress=1.0)
CERTIFIED = 2e-6  # relative: twice the bar, as the gap is that of a whole loop
NEAR = 1e-9


def diagonal(x, y, nx, ny):
    """Each rectangle cut along one diagonal: no crossings."""
    mesh = MeshTri.init_tensor(np.linspace(*x, nx + 1), np.linspace(*y, ny + 1))
    return mesh.with_boundaries(
        {
            "left": lambda p: p[0] < x[0] + NEAR,
            "right": lambda p: p[0] > x[1] - NEAR,
            "bottom": lambda p: p[1] < y[0] + NEAR,
            "top": lambda p: p[1] > y[1] - NEAR,
        }
    )


MESHES = {
    "crossed": (la.meshes.rectangle, "p2-gauss"),
    "diagonal": (diagonal, "p2-gauss"),
    "quadrilaterals": (la.meshes.quadrilaterals, "q2"),
}


def section(kind, x, y, nx, ny, curved=False, criterion=S0):
    """An axisymmetric body with a rectangular section."""
    make, space = MESHES[kind]
    mesh = make(x, y, nx, ny)
    if curved:
        mesh = with_moved_middles(mesh)
    return la.Body(mesh, criterion, kinematics="axisymmetric", space=space)


def with_moved_middles(mesh, size=0.05, seed=3):
    """Midside nodes moved at random: inner ones in any direction, others along their edge."""
    kind = MeshTri2 if len(mesh.t) == 3 else MeshQuad2
    curved = replace(kind.from_mesh(mesh), _boundaries=mesh.boundaries)
    rng = np.random.default_rng(seed)
    points = curved.p.copy()
    chord = np.diff(curved.p[:, curved.facets], axis=1)[:, 0]
    across = np.stack([-chord[1], chord[0]]) * (curved.f2t[1] >= 0)
    along, beside = size * rng.uniform(-1, 1, (2, curved.nfacets))
    edges = slice(curved.nvertices, curved.nvertices + curved.nfacets)
    points[:, edges] += along * chord + beside * across
    return replace(curved, doflocs=points)


def cylinder(kind, n, inner=1.0, stress=1.0, load=1.0, curved=False):
    """A slice of a thick tube of ratio 2 whose height stays, under internal pressure."""
    body = section(
        kind,
        (inner, 2 * inner),
        (0, inner / 2),
        2 * n,
        n,
        curved,
        la.VonMises(yield_stress=stress),
    )
    return la.Problem(
        {"tube": body},
        [la.Pressure("tube", "left", load)],
        supports=[la.Fix("tube", "bottom", "y"), la.Fix("tube", "top", "y")],
    )


EXACT = 2 / np.sqrt(3) * np.log(2)


@pytest.mark.parametrize(
    ("kind", "order"), [("crossed", 4), ("diagonal", 2), ("quadrilaterals", 4)]
)
def test_cylinder(kind, order):
    """From above, at the order of the elements; the stress is that of the exact solution."""
    states = [la.solve(cylinder(kind, n), throw=True) for n in (2, 4)]
    errors = [state.load_factor / EXACT - 1 for state in states]
    assert 0 < errors[1] < 1e-5
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.3)
    assert states[1].rigor is la.Rigor.DISCRETE
    stress = states[1].stress["tube"]
    radius = states[1].discretisation.continua["tube"].basis.global_coordinates()[0]
    exact = -2 / np.sqrt(3) * np.log(2 / np.asarray(radius))  # sigma_rr, 0 outside
    hoop = stress[..., 2] - stress[..., 0]
    # sigma_tt - sigma_rr = 2 k and sigma_zz their mean, where eps_zz = 0.
    np.testing.assert_allclose(hoop, 2 / np.sqrt(3), atol=2e-3)
    np.testing.assert_allclose(stress[..., 1], (stress[..., 0] + stress[..., 2]) / 2, atol=2e-2)
    volumes = states[1].discretisation.continua["tube"].weights
    # Single pressures of crossed triangles oscillate; their mean does not.
    mean = float(np.sum(volumes * (stress[..., 0] - exact)) / volumes.sum())
    assert mean == pytest.approx(0.0, abs=2e-3)


@pytest.mark.parametrize("kind", MESHES)
def test_cylinder_of_curved_elements(kind):
    state = la.solve(cylinder(kind, 4, curved=True), throw=True)
    assert state.load_factor == pytest.approx(EXACT, rel=5e-4)  # 1e-5 on straight ones


@given(st.floats(-6, 6), st.floats(-3, 9), st.floats(-3, 9))
def test_rescaled(length, stress, load):
    """The load factor is times stress over load, whatever the units."""
    problem = cylinder("quadrilaterals", 1, 10**length, 10**stress, 10**load)
    state = la.solve(problem, throw=True)
    value = state.load_factor * 10 ** (load - stress)
    assert value == pytest.approx(_unscaled(), rel=1e-7)
    scales = state.discretisation.natural
    assert scales.thickness == pytest.approx(3 * np.pi * 10**length)  # 2 pi times the mean radius


def _unscaled():
    return la.solve(cylinder("quadrilaterals", 1)).load_factor


@given(arrays(np.float64, 4, elements=st.floats(-1, 1)))
def test_dissipation_is_that_of_the_deviator(eps):
    rr, zz, tt, gamma = eps
    tensor = np.array([[rr, 0, gamma / 2], [0, tt, 0], [gamma / 2, 0, zz]])
    deviator = tensor - np.trace(tensor) / 3 * np.eye(3)
    form = S0.conic_form("axisymmetric")
    own = form.bound * np.linalg.norm(form.rows @ eps)
    # k_s ||e||; the square root takes round-off 1e-16 of squares to 1e-8.
    assert own == pytest.approx(np.sqrt(2 / 3) * np.linalg.norm(deviator), abs=1e-8, rel=1e-12)
    assert float(form.volumetric @ eps) == pytest.approx(np.trace(tensor), abs=1e-15)
    conjugate, mean = form.rows @ eps, np.array([0.7])
    s_rr, s_zz, s_tt, s_rz = form.stress(conjugate[None], mean)[0]
    assert s_rr + s_zz + s_tt == pytest.approx(3 * 0.7, abs=1e-12)
    # Power of the stress on the strain rate: conjugate . rows eps + mean theta.
    power = s_rr * rr + s_zz * zz + s_tt * tt + s_rz * gamma
    assert power == pytest.approx(conjugate @ conjugate + 0.7 * np.trace(tensor), abs=1e-12)


def disc(kind, mu, curved=False, rough=False):
    """A disc of radius 1 and half height 0.4 between platens; its lower half plane moves up."""
    body = section(kind, (0, 1), (0, 0.4), 4, 2, curved)
    return la.Problem(
        {"disc": body},
        [la.RigidFooting("disc", "bottom", (0, 1), rough=rough)],
        interfaces=[la.Interface(("disc", "top"), la.RigidObstacle((0, 0.4), (0, -1)), mu)],
    )


@pytest.mark.parametrize("curved", [False, True], ids=["straight", "curved"])
@pytest.mark.parametrize("kind", MESHES)
def test_upsetting_without_friction(kind, curved):
    """Exactly the yield stress: u_r = r/2, u_z = -z lies in every space. No support needed."""
    state = la.solve(disc(kind, 0.0, curved), throw=True)
    volume = state.discretisation.continua["disc"].volumes.sum() / (0.4 * np.pi)
    # On curved elements r det J is of higher degree than the rule of strain points is exact for.
    assert volume == pytest.approx(1.0, rel=1e-3 if curved else 1e-12)
    assert state.load_factor == pytest.approx(1.0, rel=1e-3 if curved else CERTIFIED)
    table = state.reactions
    assert table["length"].sum() == pytest.approx(np.pi, rel=1e-12)  # the area of the platen
    force = np.pi * state.load_factor
    assert (table["length"] * table["t_n"]).sum() == pytest.approx(force, rel=CERTIFIED)
    assert (table["length"] > 0).all()
    # The axis is no support: what holds the disc is the footing.
    reactions = state.support_reactions
    assert set(reactions["y"]) == {0.0}
    assert reactions["force_y"].sum() == pytest.approx(force, rel=CERTIFIED)
    if not curved:
        stress = state.stress["disc"]
        np.testing.assert_allclose(stress[..., 1] - stress[..., 0], -1.0, atol=1e-3)
        np.testing.assert_allclose(stress[..., 2] - stress[..., 0], 0.0, atol=1e-3)


@pytest.mark.parametrize("kind", MESHES)
def test_upsetting_with_friction(kind):
    """More with more friction, until it sticks; for little of it the slab method."""
    loads = [la.solve(disc(kind, mu), throw=True).load_factor for mu in (0.02, 0.1, 0.3, 1.0)]
    assert np.all(np.diff([1.0, *loads]) > -CERTIFIED)
    # p = s0 (1 + 2 mu (R - r)/h) on h = 0.8, mean 1 + 2 mu R/(3 h), to order mu.
    assert loads[0] == pytest.approx(1 + 2 * 0.02 / (3 * 0.8), abs=0.02**2)
    # Sticking: u_r = r/0.8 with slip at the platen costs k 2/3 R/0.8 per area more, an upper bound.
    assert loads[3] < 1 + 2 / (3 * 0.8 * np.sqrt(3))


@pytest.mark.parametrize(
    ("load", "power"),
    [
        # Works of rigid motion along z, and of u_r = r: exact integrals over 1 <= r <= 2.
        (la.Traction("b", "top", (1, 2)), (2 * np.pi * 7 / 3, 6 * np.pi)),
        (la.Pressure("b", "right", 3.0), (-3 * 2 * np.pi * 4 * 0.5, 0.0)),
        (la.BodyForce("b", (1, -1)), (np.pi * 7 / 3, -1.5 * np.pi)),
        (la.PointForce("b", (2, 0.5), (5, 7)), (10.0, 7.0)),
    ],
    ids=lambda value: type(value).__name__,
)
@pytest.mark.parametrize("curved", [False, True], ids=["straight", "curved"])
@pytest.mark.parametrize("kind", MESHES)
def test_forces_of_the_whole_circumference(kind, curved, load, power):
    problem = la.Problem(
        {"b": section(kind, (1, 2), (0, 0.5), 2, 2, curved)},
        [load],
        supports=[la.Fix("b", "bottom", "y")],
    )
    d = la.discretise(problem)
    dofs, force = d.continua["b"], d.full.reference_load
    found = force[dofs.dofs[0]] @ dofs.nodes[0], force[dofs.dofs[1]].sum()
    np.testing.assert_allclose(found, power, rtol=1e-12, atol=1e-12)
    if not curved:  # there the rule at the strain points is not exact
        assert dofs.volumes.sum() == pytest.approx(1.5 * np.pi, rel=1e-12)


@pytest.mark.parametrize("kind", MESHES)
def test_weights_of_contact_points(kind):
    """2 pi int B_i r ds on straight edges, from the formula of T28."""
    problem = la.Problem(
        {"b": section(kind, (0, 2), (0, 1), 2, 1)},
        [la.BodyForce("b", (0, -1))],
        interfaces=[la.Interface(("b", "bottom"), la.RigidObstacle(), 0.3)],
    )
    d = la.discretise(problem)
    radius, weights = d.points.position[:, 0], d.program.contact.weights
    ends = {0.0: 1 / 12, 1.0: 3 / 12 + (3 * 1 + 2) / 12, 2.0: (1 + 3 * 2) / 12}
    wanted = ends | {0.5: 1 / 6, 1.5: 3 / 6}
    for r, w in zip(radius, weights, strict=True):
        assert w == pytest.approx(2 * np.pi * wanted[round(float(r), 1)], rel=1e-12)


def test_two_bodies_and_a_sleeve():
    """A tube in a tube without friction is one tube; shear on the sleeve is limited by it."""
    inner = section("quadrilaterals", (1, 1.5), (0, 0.5), 4, 2)
    outer = section("quadrilaterals", (1.5, 2), (0, 0.5), 4, 3)
    problem = la.Problem(
        {"inner": inner, "outer": outer},
        [la.Pressure("inner", "left")],
        supports=[
            la.Fix(name, side, "y") for name in ("inner", "outer") for side in ("bottom", "top")
        ],
        interfaces=[la.Interface(("inner", "right"), ("outer", "left"), 0.2)],
    )
    assert la.solve(problem, throw=True).load_factor == pytest.approx(EXACT, rel=1e-4)


def test_push_out():
    """A plug under radial dead pressure p is pushed out of a rigid sleeve: mu p times its area."""
    plug = section("quadrilaterals", (0.5, 1), (0, 0.5), 2, 2)
    problem = la.Problem(
        {"plug": plug},
        [la.RigidFooting("plug", "bottom", (0, 1), rough=False)],
        interfaces=[la.Interface(("plug", "right"), la.RigidObstacle(), 0.25)],
        dead_loads=[la.Pressure("plug", "left", 0.2)],
    )
    state = la.solve(problem, throw=True)
    # The wall takes p times 2 pi 0.5 h: forces on the two sides differ, hoop stress carries the
    # rest. Rigid plug: any normal force between, as the hoop stress may be anything below yield.
    total = float((state.reactions["length"] * state.reactions["t_n"]).sum())
    assert state.load_factor * np.pi * 0.75 == pytest.approx(0.25 * total, rel=1e-5)


@pytest.mark.parametrize("backend", ["cvxpy", "ipopt-static"])
@pytest.mark.parametrize("kind", one_in(2, ["crossed", "quadrilaterals"]))
def test_exact_backends_agree(backend, kind):
    pytest.importorskip({"cvxpy": "cvxpy", "ipopt-static": "casadi"}[backend])
    problem = disc(kind, 0.1)
    one, two = (la.solve(problem, name, throw=True) for name in ("clarabel", backend))
    assert two.load_factor == pytest.approx(one.load_factor, rel=CERTIFIED)


@pytest.mark.parametrize("backend", ["newton", "clarabel-regularised", "ipopt"])
def test_regularised_backends_agree(backend):
    if backend == "ipopt":
        pytest.importorskip("casadi")
    problem = disc("quadrilaterals", 0.0)
    values = la.solve(problem, backend, throw=True, options={"r": 1e-3}).regularised
    # P <= alpha_reg <= lambda <= alpha* (T19), and lambda to order r^2, or so.
    assert values.plastic <= values.alpha_reg <= values.load_factor <= 1 + 1e-6
    assert values.load_factor == pytest.approx(1.0, rel=0.01)


def refused(*parts):
    return pytest.raises(la.InputError, match="(?s)" + ".*".join(parts))


@pytest.mark.parametrize("space", ["p2-vertex", "p2-disc", "p1-disc", "p1"])
def test_strict_spaces_are_refused(space):
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    with refused("Body.space", "axisymmetric", "'p2-gauss', or 'q2'"):
        la.Body(mesh, S0, kinematics="axisymmetric", space=space)


def test_negative_radii_are_refused():
    with refused("Body.mesh = -0.5", "radius below 0", "x >= 0"):
        section("crossed", (-0.5, 1), (0, 1), 2, 2)


def problem_with(**changes):
    given = {
        "bodies": {"b": section("crossed", (0, 1), (0, 1), 2, 2)},
        "reference_loads": [la.Pressure("b", "top")],
        "supports": [la.Fix("b", "bottom")],
    }
    return la.Problem(**(given | changes))


@pytest.mark.parametrize(
    ("changes", "parts"),
    [
        ({"reference_loads": [la.Pressure("b", "left")]}, ("where", "on the axis", "no boundary")),
        ({"reference_loads": [la.Traction("b", "left", (0, 1))]}, ("on the axis",)),
        ({"supports": [la.Fix("b", "left", "xy")]}, ("supports\\[0\\]", "on the axis")),
        ({"supports": [la.Fix("b", "left", "y")]}, ("on the axis", "by itself")),
        (
            {"interfaces": [la.Interface(("b", "left"), la.RigidObstacle(), 0.1)]},
            ("interfaces\\[0\\].slave", "on the axis"),
        ),
        (
            {"reference_loads": [la.RigidFooting("b", "right", (-1, 0))]},
            ("direction", "cannot move along r", "\\(0, -1\\)"),
        ),
        (
            {"reference_loads": [la.PointForce("b", (0, 1), (1, 0))]},
            ("vector", "across the axis", "along z"),
        ),
        (
            {
                "bodies": {
                    "b": section("crossed", (0, 1), (0, 1), 2, 2),
                    "plane": la.Body(la.meshes.rectangle((0, 1), (1, 2), 2, 2), S0),
                },
                "supports": [la.Fix("b", "bottom"), la.Fix("plane", "top")],
            },
            ("bodies\\['plane'\\] = 'plane_strain'", "axisymmetric"),
        ),
    ],
)
def test_what_has_no_meaning_is_refused(changes, parts):
    with refused(*parts):
        problem_with(**changes)


def test_supports_across_the_axis_are_harmless():
    one, two = (
        la.solve(problem_with(supports=[la.Fix("b", "bottom"), *more])).load_factor
        for more in ([], [la.Fix("b", "left", "x")])
    )
    assert one == pytest.approx(two, rel=1e-9)


def test_bounds_are_refused():
    problem = problem_with()
    for function in (la.lower_bound, la.bracket):
        with refused("kinematics = 'axisymmetric'", "bound"):
            function(problem)


def test_the_axis_is_found_in_any_unit():
    body = section("crossed", (0, 1e-6), (0, 1e-6), 2, 2)
    assert on_axis(body, np.array([[0.0, 1e-7], [0.0, 0.0]])).tolist() == [True, False]
    plane = la.Body(body.mesh, S0)
    assert not on_axis(plane, np.zeros((2, 1))).any()


@pytest.mark.parametrize("kind", one_in(2, ["crossed", "quadrilaterals"]))
def test_pictures(kind):
    state = la.solve(disc(kind, 0.1))
    for figure in (state.plot(), state.discretisation.problem.plot()):
        figure.canvas.draw()
        plt.close(figure)


def test_pictures_name_the_axis_and_forces_of_the_whole_ring():
    force = la.PointForce("b", (0.0, 1.0), (0, -2.0))
    figure = problem_with(reference_loads=[force, la.BodyForce("b", (0, -3.0))]).plot()
    (axes,) = figure.axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("r [m]", "z [m]")
    texts = [text.get_text() for text in axes.texts]
    assert any("2$ N" in text and "N/m" not in text for text in texts)
    assert any(f"{3 * np.pi:.4g}$ N" in text for text in texts)  # times the volume, pi
    assert "axis" in [text.get_text() for text in axes.get_legend().get_texts()]
    plt.close(figure)
    far = cylinder("crossed", 1, 1.0)
    body = far.bodies["tube"]
    moved = replace(body, mesh=replace(body.mesh, doflocs=body.mesh.p + np.array([[1e3], [0.0]])))
    figure = replace(far, bodies={"tube": moved}).plot()
    names = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert "axis" not in names
    assert "$u_z = 0$" in names
    plt.close(figure)


@pytest.mark.parametrize("friction", [0.0, 0.3, la.STICK], ids=["smooth", "Coulomb", "stick"])
def test_two_discs_on_each_other(friction):
    """Meshes that do not match; both spread alike, so that what is between them does not matter."""
    lower = section("crossed", (0, 1), (0, 0.4), 3, 2)
    upper = section("quadrilaterals", (0, 1), (0.4, 1.0), 4, 2)
    sides = [("lower", "top"), ("upper", "bottom")]
    values = []
    for slave, master in (sides, sides[::-1]):
        problem = la.Problem(
            {"lower": lower, "upper": upper},
            [la.RigidFooting("upper", "top", (0, -1), rough=False)],
            supports=[la.Fix("lower", "bottom", "y")],
            interfaces=[la.Interface(slave, master, friction)],
        )
        state = la.solve(problem, throw=True)
        values.append(state.load_factor)
        table = state.reactions
        # The common refinement of thirds and quarters covers the area of the disc.
        assert table["length"].sum() == pytest.approx(np.pi, rel=1e-12)
        assert (table["length"] * table["t_n"]).sum() == pytest.approx(np.pi, rel=CERTIFIED)
    assert values == pytest.approx([1.0, 1.0], rel=CERTIFIED)


def test_friction_between_two_discs():
    """A weak disc between strong ones of friction mu is the disc between platens."""
    half = disc("crossed", 0.2)
    strong = section("crossed", (0, 2), (0.4, 1.4), 8, 3, criterion=la.VonMises(yield_stress=100.0))
    problem = replace(
        half,
        bodies={**half.bodies, "anvil": strong},
        supports=[la.Fix("anvil", "top")],
        interfaces=[la.Interface(("disc", "top"), ("anvil", "bottom"), 0.2)],
    )
    state = la.solve(problem, throw=True)
    # Control values stand on the common refinement here, on whole edges there: some 1e-4.
    rigid = la.solve(half, throw=True).load_factor
    assert state.load_factor == pytest.approx(rigid, rel=1e-3)
    slipping = state.reactions[state.reactions["state"] == "slip"]
    assert not slipping.empty
    # Where it slips friction is that of the pressure, against the slip.
    np.testing.assert_allclose(
        slipping["t_t"], -0.2 * slipping["t_n"] * np.sign(slipping["u_t"]), atol=1e-3
    )
