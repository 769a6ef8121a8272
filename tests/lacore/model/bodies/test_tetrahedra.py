"""Bodies of tetrahedra: exact states, sides, invariances, and what they refuse (T89, T90)."""

from math import pi, sqrt

import numpy as np
import pytest
from scipy.sparse.linalg import lsqr
from skfem import MeshTet

import lacore as la
from lacore.assembly.discretise import discretise
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.solid import memory
from lacore.model.bodies.continuum.solid.normal_flow import flowing
from lacore.model.materials.conic_form import KINEMATICS
from tests.lacore.models import punch
from tests.lacore.solid_checker import judged
from tests.lacore.tetrahedra import CRITERION, SPACES, cube, strip

COMPRESSION = sqrt(3)
# Of the load factor: the backend's tolerance, 1e-8 of the power, from either side of a value that
# every velocity field of these spaces reaches exactly.
SOLVED = 1e-7
DISCONTINUOUS = ("p1-disc", "p2-disc")


def test_dissipation_in_space_is_that_of_the_deviator():
    """sqrt(2) k ||dev eps||, of which engineering shear strains are twice the tensor's (T89)."""
    rng = np.random.default_rng(3)
    strain = rng.normal(size=(20, 6))
    tensor = np.einsum("ms,sij->mij", strain, _basis())
    deviator = tensor - np.trace(tensor, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    form = CRITERION.conic_form("3d")
    size = np.linalg.norm(strain @ form.rows.T, axis=1)
    np.testing.assert_allclose(size, sqrt(2) * np.linalg.norm(deviator, axis=(1, 2)), rtol=1e-12)
    np.testing.assert_allclose(strain @ form.volumetric, np.trace(tensor, axis1=1, axis2=2))


def _basis():
    basis = np.zeros((6, 3, 3))
    basis[range(3), range(3), range(3)] = 1
    for row, (i, j) in enumerate([(0, 1), (1, 2), (2, 0)], start=3):
        basis[row, i, j] = basis[row, j, i] = 1 / 2
    return basis


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("crossed", [False, True])
def test_homogeneous_compression_exactly(space, crossed):
    state = la.solve(cube(space, crossed=crossed))
    assert state.rigor is la.Rigor.UPPER
    assert state.load_factor == pytest.approx(COMPRESSION, rel=SOLVED)
    stress = state.stress["block"]
    assert stress.shape[2] == 6
    # Mean stresses are one of many where conditions of volume depend on each other.
    deviator = stress[..., :3] - stress[..., :3].mean(axis=2, keepdims=True)
    uniaxial = np.broadcast_to(np.array([1, 1, -2]) * COMPRESSION / 3, deviator.shape)
    np.testing.assert_allclose(deviator, uniaxial, atol=1e-4)
    np.testing.assert_allclose(stress[..., 3:], 0, atol=1e-4)


@pytest.mark.parametrize("space", SPACES)
def test_a_bar_in_tension_exactly(space):
    """By a traction on a free end, which deforms as it likes."""
    mesh = la.meshes.box((0, 1), (0, 1), (0, 2), 1, 1, 2)
    pulled = la.solve(cube(space, mesh=mesh, load=la.Traction("block", "top", (0, 0, 1))))
    assert pulled.load_factor == pytest.approx(COMPRESSION, rel=SOLVED)


def _turned(mesh, rng):
    """The mesh turned and renumbered, its boundaries by name."""
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.linalg.det(turn)
    order = rng.permutation(mesh.p.shape[1])
    number = np.argsort(order)
    elements = rng.permutation(mesh.nelements)
    t = rng.permuted(number[mesh.t[:, elements]], axis=0)
    moved = MeshTet(np.ascontiguousarray((turn @ mesh.p)[:, order]), np.ascontiguousarray(t))
    known = {tuple(sorted(own)): face for face, own in enumerate(moved.facets.T.tolist())}
    return moved.with_boundaries(
        {
            name: np.array([known[tuple(sorted(number[mesh.facets[:, f]].tolist()))] for f in own])
            for name, own in mesh.boundaries.items()
        }
    )


@pytest.mark.parametrize("space", SPACES)
def test_turned_and_renumbered_meshes_give_the_same(space):
    """Of a body pressed on two of its sides, where nothing is homogeneous."""
    mesh = la.meshes.box((0, 2), (0, 1), (0, 1), 2, 1, 1).with_boundaries(
        {"half": lambda x: (x[2] == 1) & (x[0] < 1)}
    )
    values = []
    for own in (mesh, _turned(mesh, np.random.default_rng(5))):
        problem = cube(space, mesh=own, load=la.Pressure("block", "half"))
        values.append((la.solve(problem).load_factor, la.lower_bound(problem).load_factor))
    np.testing.assert_allclose(values[0], values[1], rtol=SOLVED)


@pytest.mark.parametrize("space", DISCONTINUOUS)
def test_normal_velocities_do_not_jump_whatever_the_unknowns(space):
    rng = np.random.default_rng(1)
    mesh = _turned(la.meshes.box((0, 1), (0, 1), (0, 1), 1, 1, 1, True), rng)
    dofs = BodyDofs.at(la.Body(mesh, CRITERION, kinematics="3d", space=space), 0)
    held = np.zeros(mesh.nfacets, dtype=bool)
    held[mesh.boundary_facets()[:5]] = True
    basis, carried = flowing(dofs, held, np.zeros((mesh.nfacets, 3 * dofs.degree, 0)))
    assert carried.shape == (dofs.count, 0)
    # Three at each vertex of an element, or two at each middle of an edge and one along it, a half
    # of those across faces inside.
    nodes = 3 * dofs.degree
    own = 6 * mesh.nelements if dofs.degree == 2 else 0
    assert basis.shape[1] == nodes * (mesh.nfacets - 5) + own
    velocity = basis @ rng.normal(size=basis.shape[1])
    nodal = velocity[dofs.dofs][:, dofs.element_nodes].transpose(2, 1, 0)
    names = mesh.p[:, mesh.facets[:, held]].mean(axis=1)

    def walls(middle):
        return np.min(np.linalg.norm(middle[:, :, None] - names[:, None], axis=0), axis=1) < 1e-9

    own = judged(mesh.p, mesh.t, nodal, 1.0, 0.0, [(walls, "normal", np.zeros_like)], level=0)
    assert own.residuals["jumps"] <= 1e-11
    assert own.residuals["wall 0"] <= 1e-11


@pytest.mark.parametrize("space", DISCONTINUOUS)
def test_smooth_velocities_are_among_those_of_normal_flow(space):
    """All polynomials of the degree of the space: nothing is lost with the unknowns."""
    rng = np.random.default_rng(2)
    mesh = la.meshes.box((0, 1), (0, 2), (0, 1), 1, 1, 1)
    dofs = BodyDofs.at(la.Body(mesh, CRITERION, kinematics="3d", space=space), 0)
    x, y, z = dofs.nodes
    terms = [np.ones_like(x), x, y, z, *((x * y, y * z, z * z) if space == "p2-disc" else ())]
    velocity = np.zeros(dofs.count)
    velocity[dofs.dofs] = rng.normal(size=(3, len(terms))) @ terms
    held = np.zeros(mesh.nfacets, dtype=bool)
    basis, _ = flowing(dofs, held, np.zeros((mesh.nfacets, 3 * dofs.degree, 0)))
    found = lsqr(basis, velocity, atol=1e-14, btol=1e-14, iter_lim=5000)[0]
    np.testing.assert_allclose(basis @ found, velocity, atol=1e-9)


@pytest.mark.parametrize("rough", [False, True])
def test_a_slab_is_above_plane_strain_and_closest_where_velocities_jump(rough):
    values = {space: la.solve(strip(space, n=3, rough=rough), "interior_point") for space in SPACES}
    assert all(state.rigor is la.Rigor.UPPER for state in values.values())
    found = {space: state.load_factor for space, state in values.items()}
    assert 2 + pi < found["p2-disc"] < min(found["p1-disc"], found["p2-vertex"])


@pytest.mark.parametrize("space", SPACES)
def test_power_of_each_load_is_that_of_what_it_says(space):
    """A traction, a body force and a footing of one force on a block that slides as one."""
    mesh = la.meshes.box((0, 1), (0, 2), (0, 0.5), 1, 2, 1)
    body = la.Body(mesh, CRITERION, kinematics="3d", space=space)
    loads = [
        la.Traction("b", "top", (1, 2, 3)),
        la.BodyForce("b", (2, 4, 6)),
        la.BodyForce("b", (lambda x: 4 * x[0], 4.0, 6.0)),
    ]
    for load in loads:
        d = discretise(la.Problem({"b": body}, [load], [la.Fix("b", "bottom", "normal")]))
        own = d.continua["b"].dofs
        total = d.full.reference_load[own].sum(axis=1)
        np.testing.assert_allclose(total, [2, 4, 6], rtol=1e-12)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"criterion": la.MohrCoulomb(1.0, 30.0)}, "principal"),
        ({"space": "p2-gauss"}, "unknown"),
        ({"mesh": la.meshes.rectangle((0, 1), (0, 1), 1, 1)}, "tetrahedra"),
    ],
)
def test_what_is_not_there_in_space_is_refused(change, match):
    mesh = la.meshes.box((0, 1), (0, 1), (0, 1), 1, 1, 1)
    with pytest.raises(la.InputError, match=match):
        la.Body(**({"mesh": mesh, "criterion": CRITERION} | change), kinematics="3d")


def test_a_face_is_held_along_or_across_itself():
    """A side that leans is held by none of the axes."""
    mesh = la.meshes.box((0, 1), (0, 1), (0, 1), 1, 1, 1)
    leaning = MeshTet(mesh.p + np.outer([0.5, 0, 0], mesh.p[2]), mesh.t)
    body = la.Body(leaning, CRITERION, kinematics="3d", space="p2-disc")
    side = lambda x: np.abs(x[0] - x[2] / 2) < 1e-9  # noqa: E731
    problem = la.Problem(
        {"b": body}, [la.Traction("b", lambda x: x[2] == 1, (1, 0, 0))], [la.Fix("b", side, "x")]
    )
    with pytest.raises(la.InputError, match="neither along nor across"):
        la.solve(problem)


def test_predicates_end_where_faces_do():
    with pytest.raises(la.InputError, match="ends inside the face"):
        cube(n=2, load=la.Pressure("block", lambda x: (x[2] == 1) & (x[0] <= 0.4)))


GROUND = la.meshes.box((0, 1), (0, 1), (0, 1), 1, 1, 2)


def _ground(criterion):
    return la.Body(GROUND, criterion, kinematics="3d")


def _deepened(values, steepest=None):
    """Bounds of a footing on soil that gets stronger with depth."""
    soil = _ground(la.VonMises(la.Field(values, steepest)))
    held = [la.Fix("soil", name) for name in ("bottom", "left", "right", "front", "back")]
    problem = la.Problem({"soil": soil}, [la.Traction("soil", "top", (1.0, 0.0, -1.0))], held)
    return la.discretise(problem).program.groups[0].bound


@pytest.mark.parametrize(
    ("values", "steepest"),
    [
        (la.Linear(1.0, (0.0, 0.0, -2.0), at=(0.0, 0.0, 1.0)), None),
        (la.ByLevel([0.0, 0.5, 1.0], [3.0, 2.0, 1.0]), None),
        (la.ByLevel([0.0, 0.5, 1.0], [3.0, 2.0, 1.0]), 2.0),  # it bends where elements end
    ],
)
def test_functions_by_numbers_are_those_of_height(values, steepest):
    own = _deepened(lambda x: 3 - 2 * x[2])
    np.testing.assert_allclose(_deepened(values, steepest), own, rtol=1e-12)  # round-off


def test_a_level_within_elements_still_needs_its_slope():
    bent = la.ByLevel([0.0, 0.25, 1.0], [3.0, 2.0, 1.0])
    problem = la.Problem(
        {"soil": _ground(la.VonMises(la.Field(bent)))},
        [la.Traction("soil", "top", (0.0, 0.0, -1.0))],
        [la.Fix("soil", "bottom")],
    )
    with pytest.raises(la.InputError, match=r"not linear in each element.*steepest="):
        la.lower_bound(problem)
    assert _deepened(bent, bent.steepest).max() > _deepened(lambda x: 3 - 2 * x[2]).max()


def test_a_level_between_the_places_that_are_looked_at_is_bounded_by_its_slope():
    """A peak 2e-4 m high that no place sees: the function says that it bends there."""
    peak = la.ByLevel([0.0, 0.2999, 0.3, 0.3001, 1.0], [103.0, 102.4002, 102.41, 102.3998, 101.0])
    straight = _deepened(lambda x: 103 - 2 * x[2])
    assert _deepened(peak, peak.steepest).max() > 1.1 * straight.max()


def test_friction_angles_vary_in_space():
    soil = _ground(la.DruckerPrager(1.0, la.Field(lambda x: 20 + 5 * x[2])))
    assert "20 to 25" in str(soil)


@pytest.mark.parametrize(
    ("criterion", "match"),
    [
        (la.VonMises(la.Field(lambda x: x[2] - 0.5)), r"at \(.*, .*, .*\): negative"),
        (la.VonMises(la.Field(lambda x: np.log(x[2] - 0.5))), r"coordinates \(3, n\)|not a finite"),
        (la.VonMises(la.Field(la.Linear(1.0, (0.0, 1.0)))), "2 numbers, where places have 3"),
        (la.DruckerPrager(1.0, la.Field(lambda x: 95 * x[2])), r"near \(.*, .*, .*\)"),
    ],
)
@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning")
def test_what_is_wrong_of_a_function_is_told_with_its_place_in_space(criterion, match):
    with pytest.raises(la.InputError, match=match):
        _ground(criterion)


def test_kinematics_of_the_plane_stay_three():
    assert KINEMATICS == ("plane_strain", "plane_stress", "axisymmetric", "3d")


def test_what_problems_of_the_plane_have_and_these_not_is_refused_with_a_mend():
    problem = cube("p1-disc")
    for ask in (
        lambda: la.sequential(problem, 0.1),
        lambda: la.Problem(
            dict(problem.bodies),
            [la.Pressure("block", "top")],
            interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle(), la.BOND)],
        ),
    ):
        with pytest.raises(la.InputError):
            ask()
    with pytest.raises(la.InputError, match=r"no single force .*; give a lacore.Traction"):
        problem.with_loads([la.PointForce("block", (0, 0, 1), (0, 0, -1))])


def test_pictures_show_the_faces_that_one_sees():
    """Coloured by names, by what is dissipated, used and missing in the elements behind them."""
    problem = cube("p2-disc", n=2)
    state = la.solve(problem, "interior_point")
    bound = la.lower_bound(problem, "interior_point")
    body = problem.bodies["block"]
    for shown in (body, problem, state, bound, la.gap_identity(state, bound)):
        figure = shown.plot()
        (faces,) = [own for own in figure.axes[0].collections if own.get_facecolor().size]
        # Three sides of a cube of 2 by 2 faces of two triangles each look at any eye.
        assert len(faces.get_facecolor()) == 3 * 2 * 2 * 2
        assert np.all(np.isfinite(faces.get_facecolor()))
    assert body.plot().axes[0].get_legend() is not None
    told = [text.get_text() for text in problem.plot().axes[0].get_legend().get_texts()]
    assert told[-1] == "pressure 1 Pa on block.top"
    assert len(told) == 4
    assert state.plot().get_suptitle().startswith(f"load factor {state.load_factor:.6g}")


@pytest.mark.parametrize("space", SPACES)
def test_supports_carry_the_load(space):
    """Of a rough strip: forces of supports and of the footing add to none, alone to the load."""
    state = la.solve(strip(space, n=2, rough=True), "interior_point")
    table = state.support_reactions
    force = table[["force_x", "force_y", "force_z"]].to_numpy()
    np.testing.assert_allclose(force.sum(axis=0), 0, atol=1e-6)
    under = (table.z == 0) & (table.x <= 1)
    load = state.load_factor * 0.5  # on 1 m by 0.5 m
    assert force[~under, 2].sum() == pytest.approx(load, rel=1e-6)


@pytest.mark.parametrize("space", SPACES)
def test_a_file_has_the_mechanism_and_the_stresses(space, tmp_path):
    meshio = pytest.importorskip("meshio")
    state = la.solve(strip(space, n=1), "interior_point")
    state.to_vtu(tmp_path / "state.vtu")
    read = meshio.read(tmp_path / "state.vtu")
    kind = "tetra" if space == "p1-disc" else "tetra10"
    elements = state.discretisation.continua["soil"].body.mesh.nelements
    assert len(read.cells_dict[kind]) == elements
    np.testing.assert_allclose(read.point_data["velocity"].T, state.velocity["soil"])
    assert read.cell_data["stress"][0].shape == (elements, 6)


def test_a_state_that_is_changed_is_judged_anew():
    state = la.solve(cube(), "interior_point")
    same = state.certify(velocity=state.velocity, stress=state.stress)
    assert same.holds(1e-6)
    assert not state.certify(load_factor=1.01 * state.load_factor).holds(1e-3)


def test_memory_is_told_before_a_solve_and_refused_above_what_there_is(monkeypatch):
    """Of factors: 57.8 million entries with 10 692 tetrahedra below, 19.2 with 2 100 above."""
    meshes = {
        10_692: la.meshes.box((0, 1), (0, 1), (0, 1), 11, 18, 9),
        2_058: la.meshes.box((0, 1), (0, 1), (0, 1), 7, 7, 7),
    }
    large, small = (
        {"block": la.Body(mesh, CRITERION, kinematics="3d", space="p2-disc")}
        for mesh in meshes.values()
    )
    assert 0.5 < memory.stress_memory(large) / (20 * 57.8e6) < 2
    assert 0.5 < memory.velocity_memory(small) / (20 * 19.2e6) < 2
    problem = cube()
    assert "GB for factors" in str(la.discretise(problem))
    assert memory.velocity_memory({"plane": punch(2, 2).bodies["soil"]}) == 0
    monkeypatch.setattr(memory, "physical_memory", lambda: 1e3)
    for ask in (la.solve, la.lower_bound, la.upper_bound):
        with pytest.raises(la.InputError, match="6 tetrahedra': factors would take"):
            ask(problem)
