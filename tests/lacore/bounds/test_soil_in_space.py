"""Drucker and Prager's cone in bodies of tetrahedra, in every space (T41, T94)."""

import numpy as np
import pytest

import lacore as la
from lacore_verification.cases.shared.tetrahedra import hollow_octant
from tests.lacore.solid_statements import lower_proof, upper_proof
from tests.lacore.tetrahedra import CRITERION, SPACES, cube, strip

SOLVED = 1e-7  # of the load factor, as in `tests.lacore.model.bodies.test_tetrahedra`
ANGLE = 20.0
JUMPING = ("p1-disc", "p2-disc")


def bearing_capacity(degrees):
    """Prandtl's strip on weightless soil of cohesion 1, plane strain."""
    angle = np.radians(degrees)
    passive = np.tan(np.pi / 4 + angle / 2) ** 2
    return (np.exp(np.pi * np.tan(angle)) * passive - 1) / np.tan(angle)


def soil_strip(space="p2-disc", n=2, rough=False, criterion=None):
    """A slab whose box holds the mechanism at 20 degrees: ``1 + tan(45 + phi/2) e^..`` is 3.53."""
    problem = strip(space, n, rough, criterion=criterion or la.DruckerPrager(1.0, ANGLE))
    soil = problem.bodies["soil"]
    wider = soil.mesh.p * np.array([[1.0], [1.0], [1.3]])
    wider[0] = np.where(wider[0] > 1, 1 + 2 * (wider[0] - 1), wider[0])
    mesh = type(soil.mesh)(wider, soil.mesh.t).with_boundaries(soil.mesh.boundaries)
    return la.Problem(
        {"soil": la.Body(mesh, soil.criterion, kinematics="3d", space=space)},
        problem.reference_loads,
        problem.supports,
    )


@pytest.mark.parametrize("match", ["plane_strain", "compression"])
def test_a_layer_carries_what_stresses_within_the_cone_do(match):
    """By random stresses on the cone: tractions are within it, and the closest come near (T94)."""
    soil = la.DruckerPrager(2.0, ANGLE, match)
    form = soil.conic_form("3d").across()
    (plane,) = form.surfaces
    rng = np.random.default_rng(1)
    deviator = rng.normal(size=(200_000, 3, 3))
    deviator = deviator + deviator.swapaxes(1, 2)
    deviator -= np.trace(deviator, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    deviator /= np.sqrt((deviator**2).sum(axis=(1, 2)) / 2)[:, None, None]
    mean = -3.0
    traction = (soil.k - soil.slope * mean) * deviator[:, 0] + mean * np.eye(3)[0]
    use = np.linalg.norm(traction[:, 1:], axis=1) + plane.slope[0] * traction[:, 0]
    assert use.max() <= plane.strength * (1 + 1e-12)
    # The best of so many: within a per cent of what is allowed.
    assert use.max() >= 0.99 * plane.strength
    if match == "plane_strain":
        assert plane.slope[0] == pytest.approx(np.tan(np.radians(ANGLE)), rel=1e-12)
        assert plane.strength == pytest.approx(2.0, rel=1e-12)


@pytest.mark.parametrize(("space", "n"), [("p2-vertex", 1), ("p1-disc", 2), ("p2-disc", 1)])
def test_compression_exactly_from_both_sides(space, n):
    """A cone that meets Mohr-Coulomb there: 2 c cos(phi)/(1 - sin(phi)); velocities alone prove."""
    angle = np.radians(ANGLE)
    exact = 2 * np.cos(angle) / (1 - np.sin(angle))
    problem = cube(space, n, criterion=la.DruckerPrager(1.0, ANGLE, "compression"))
    low, high = la.lower_bound(problem), la.upper_bound(problem)
    assert low.rigor is la.Rigor.LOWER
    assert high.rigor is la.Rigor.UPPER
    assert low.load_factor == pytest.approx(exact, rel=SOLVED)
    assert high.load_factor == pytest.approx(exact, rel=SOLVED)
    assert low.load_factor <= exact * (1 + 1e-12)
    assert high.load_factor >= exact * (1 - 1e-12)


@pytest.mark.parametrize("rough", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_a_slab_contains_the_strip_of_plane_strain(rough):
    """Matched there the cone is Mohr-Coulomb: N_c between bounds, fields alone prove both."""
    exact = bearing_capacity(ANGLE)
    low = la.lower_bound(soil_strip(rough=rough))
    left, carried = lower_proof(low)
    assert max(left.residuals.values()) <= 1e-12 * carried, left
    assert carried == pytest.approx(low.load_factor, rel=1e-12)
    assert low.load_factor < exact
    found = {}
    for space in SPACES:
        high = la.upper_bound(soil_strip(space, rough=rough))
        assert high.rigor is la.Rigor.UPPER
        above, power = upper_proof(high)
        # What moves as soil does in floating point; supports and footings to round-off.
        assert max(above.residuals.values()) <= 1e-13 * np.abs(high.velocity).max(), above
        assert power == 1
        # Linear dissipation is integrated exactly.
        assert above.dissipation == pytest.approx(high.load_factor, rel=1e-11)
        gap = la.gap_identity(high, low)
        assert gap.least >= -1e-7 * exact  # the backend's tolerance
        assert gap.total == pytest.approx(high.load_factor - low.load_factor, rel=1e-10)
        found[space] = high.load_factor
    assert exact < found["p2-disc"] < min(found["p1-disc"], found["p2-vertex"])


@pytest.mark.parametrize("space", JUMPING)
def test_without_friction_it_is_von_mises(space):
    """Loads come close as the angle falls: by a few angles, in radians, as N_c does."""
    flat = la.solve(soil_strip(space, 1, criterion=CRITERION)).load_factor
    for degrees in (2.0, 0.5):
        steep = la.solve(soil_strip(space, 1, criterion=la.DruckerPrager(1.0, degrees)))
        assert abs(steep.load_factor / flat - 1) <= 6 * np.radians(degrees)


@pytest.mark.parametrize("space", JUMPING)
def test_supports_and_the_footing_carry_the_load(space):
    state = la.solve(soil_strip(space, rough=True))
    table = state.support_reactions
    force = table[["force_x", "force_y", "force_z"]].to_numpy()
    load = state.load_factor * 0.5  # on 1 m by 0.5 m
    np.testing.assert_allclose(force.sum(axis=0), 0, atol=1e-6 * load)
    under = (table.z == 0) & (table.x <= 1)
    assert force[~under, 2].sum() == pytest.approx(load, rel=1e-6)


@pytest.mark.slow
def test_two_soils_and_a_clay_beside_each_other():
    """A jump between them costs what both carry: bounds stay in order, between those of one."""
    mesh = (
        soil_strip()
        .bodies["soil"]
        .mesh.with_subdomains({"soft": lambda x: x[0] < 1, "stiff": lambda x: x[0] > 1})
    )
    strong, weak = la.DruckerPrager(1.0, ANGLE), la.DruckerPrager(0.8, 10.0)
    values = {}
    for name, soft in (("strong", strong), ("weak", weak), ("clay", CRITERION)):
        problem = soil_strip()
        body = la.Body(mesh, {"soft": soft, "stiff": strong}, kinematics="3d", space="p2-disc")
        problem = la.Problem({"soil": body}, problem.reference_loads, problem.supports)
        low, high = la.lower_bound(problem), la.upper_bound(problem)
        assert high.rigor is la.Rigor.UPPER
        assert low.load_factor < high.load_factor
        assert la.gap_identity(high, low).least >= -1e-7 * high.load_factor
        values[name] = high.load_factor
    assert max(values["weak"], values["clay"]) < values["strong"]


def test_steep_cones_do_not_jump():
    """Above sqrt(3)/2 nothing opens fast enough to slip: no velocity would be left to jump."""
    steep = la.DruckerPrager(1.0, 40.0, "compression")
    assert steep.slope > np.sqrt(3) / 2
    with pytest.raises(la.InputError, match="too much friction"):
        la.solve(cube("p2-disc", criterion=steep))
    assert la.solve(cube("p2-vertex", criterion=steep)).load_factor > 0
    bracket = la.bracket(cube("p2-disc", criterion=steep), 0.01, time_limit=60.0, jobs=1)
    assert bracket.upper_bound.discretisation.continua["block"].body.space == "p2-vertex"


def test_brackets_do_not_jump_where_soil_is_held_along_a_face_alone():
    """No velocity is strictly possible there; a twist, or a floor that it sticks to."""
    soil = la.DruckerPrager(1.0, ANGLE)
    mesh = la.meshes.box((0, 1), (0, 1), (0, 1), 1, 1, 1)
    body = la.Body(mesh, soil, kinematics="3d", space="p2-disc")
    held = [la.Fix("block", "bottom")]
    twist = la.Twist("block", "top", (0, 0, 1), through=(0.5, 0.5, 1.0))
    twisted = la.Problem({"block": body}, [twist], held)
    floor = la.Interface(("block", "bottom"), la.RigidObstacle(), la.STICK)
    standing = la.Problem({"block": body}, [la.Pressure("block", "top")], interfaces=[floor])
    upright = la.Problem({"block": body}, [la.Pressure("block", "top")], held)
    for problem, space in (
        (twisted, "p2-vertex"),
        (standing, "p2-vertex"),
        (upright, "p2-disc"),
    ):
        found = la.bracket(problem, 0.99, max_elements=12, jobs=1)
        assert found.upper_bound.rigor is la.Rigor.UPPER
        assert found.upper_bound.discretisation.continua["block"].body.space == space


def test_a_hollow_sphere_bursts_at_its_closed_form():
    """Two equal hoops: triaxial compression, ``c cot(phi) ((b/a)^m - 1)``, m = 4 sin/(1 + sin).

    Flat faces for its surfaces are off by the square of their size, like the elements.
    """
    sine = np.sin(np.radians(30.0))
    exact = (2 ** (4 * sine / (1 + sine)) - 1) / np.tan(np.radians(30.0))
    soil = la.DruckerPrager(1.0, 30.0, "compression")
    error = {}
    for space, n in (("p2-vertex", 2), ("p2-vertex", 3), ("p2-disc", 2)):
        body = la.Body(hollow_octant(1.0, 2.0, n, n), soil, kinematics="3d", space=space)
        supports = [la.Fix("s", axis, "normal") for axis in "xyz"]
        state = la.solve(la.Problem({"s": body}, [la.Pressure("s", "start")], supports))
        assert state.rigor is la.Rigor.DISCRETE
        error[space, n] = abs(state.load_factor / exact - 1)
    assert error["p2-vertex", 2] <= 0.1
    assert error["p2-disc", 2] <= error["p2-vertex", 2]
    # Of order 2, 1.7 at least: sizes are as 3 to 2.
    assert error["p2-vertex", 3] <= error["p2-vertex", 2] / 1.5**1.7
