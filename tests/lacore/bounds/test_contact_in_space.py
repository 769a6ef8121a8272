"""Bodies of tetrahedra on rigid obstacles: friction of every kind, bounds, certificates."""

from dataclasses import replace
from math import asinh, cos, sin, sqrt

import numpy as np
import pytest
from skfem import MeshTet

import lacore as la
from tests.lacore.tetrahedra import CRITERION, SPACES, cube, tensors

CERTIFIED = 1e-6  # the bar of a certificate
FRICTIONS = (la.SMOOTH, la.Tresca(0.4), la.Coulomb(0.3, associated=True), la.STICK)


def pressed(friction, space, n=1, turn=None):
    """A block between a smooth platen and a floor with friction, its other two walls smooth."""
    mesh = la.meshes.box((0, 1), (0, 1), (0, 1), n, n, n)
    floor = la.RigidObstacle((0, 0, 0), (0, 0, 1))
    if turn is not None:
        sides = mesh.boundaries
        mesh = MeshTet(np.ascontiguousarray(turn @ mesh.p), mesh.t).with_boundaries(sides)
        floor = la.RigidObstacle((0, 0, 0), tuple(turn[:, 2]))
    return la.Problem(
        {"block": la.Body(mesh, CRITERION, kinematics="3d", space=space)},
        [la.Pressure("block", "top")],
        [la.Fix("block", side, "normal") for side in ("left", "front")],
        interfaces=[la.Interface(("block", "bottom"), floor, friction)],
    )


def flat(friction, azimuth=0.0, weight=0.2, space="p2-vertex"):
    """A flat block on a floor, pushed by a body force: it slips before it topples or yields."""
    mesh = la.meshes.box((-1, 1), (-1, 1), (0, 0.25), 2, 2, 1)
    return la.Problem(
        {"block": la.Body(mesh, CRITERION, kinematics="3d", space=space)},
        [la.BodyForce("block", (cos(azimuth), sin(azimuth), 0.0))],
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle(), friction)],
        dead_loads=[la.Pressure("block", "top", weight)],
    )


@pytest.mark.parametrize("azimuth", [0.0, 0.7, 2.5])
def test_a_block_slips_at_the_coulomb_force_in_every_direction(azimuth):
    """``alpha V = mu p A``: mu p/h; a cone of two tangents has no corners."""
    exact = 0.5 * 0.2 / 0.25
    state = la.solve(flat(0.5, azimuth), "clarabel")
    assert state.status is la.Status.SOLVED
    assert state.certificate.holds(CERTIFIED)
    assert state.load_factor == pytest.approx(exact, rel=1e-5)
    table = state.reactions
    pushed = table[["t_t_x", "t_t_y"]].to_numpy().T @ table["area"].to_numpy()
    # What the floor holds back is the load, opposite to it.
    np.testing.assert_allclose(pushed / -0.4, [cos(azimuth), sin(azimuth)], atol=1e-5)


@pytest.mark.parametrize("backend", ["auto", "interior_point"])
@pytest.mark.parametrize("space", SPACES)
def test_a_block_that_nothing_holds_is_free(space, backend):
    """Pulled off its floor; at a slight pressure it is held by friction, by ``mu p = 0.1``."""
    pushed = flat(0.5, weight=0.2, space=space)
    lifted = replace(pushed, reference_loads=[la.BodyForce("block", (0.3, 0, 1))], dead_loads=[])
    assert la.solve(lifted, backend).status is la.Status.FREE
    state = la.solve(pushed, backend)
    assert state.certificate.holds(CERTIFIED)
    assert state.load_factor == pytest.approx(0.5 * 0.2 / 0.25, rel=CERTIFIED)


@pytest.mark.parametrize("space", ["p2-vertex", "p1-disc"])
def test_a_block_slips_at_the_limit_of_tresca(space):
    """``alpha V = tau A``; a dead pressure keeps it on the floor.

    From below less: at its lower edges stresses that are linear in an element have no shear on a
    free side, and so none on the floor.
    """
    problem = flat(la.Tresca(0.05), 0.4, space=space)
    low, high = (bound(problem, "interior_point") for bound in (la.lower_bound, la.upper_bound))
    assert high.load_factor == pytest.approx(0.2, rel=CERTIFIED)
    assert low.rigor is la.Rigor.LOWER
    assert 0.1 < low.load_factor < 0.2


@pytest.mark.parametrize("friction", FRICTIONS, ids=str)
def test_bounds_enclose_and_their_gap_adds_up(friction):
    problem = pressed(friction, "p2-disc")
    low, high = (bound(problem, "interior_point") for bound in (la.lower_bound, la.upper_bound))
    assert low.rigor is la.Rigor.LOWER
    assert high.rigor is la.Rigor.UPPER
    assert sqrt(3) * (1 - CERTIFIED) <= low.load_factor <= high.load_factor * (1 + 1e-12)
    gap = la.gap_identity(high, low)
    assert gap.least >= -1e-8
    assert gap.total == pytest.approx(high.load_factor - low.load_factor, abs=1e-12)


@pytest.mark.parametrize(
    ("friction", "limit", "slope"),
    [(la.Tresca(0.4), 0.4, 0.0), (la.Coulomb(0.3, associated=True), 0.0, 0.3)],
)
def test_stresses_alone_prove_what_acts_on_the_floor(friction, limit, slope):
    """Tractions from the stresses: compression, friction within its law, at all corners."""
    bound = la.lower_bound(pressed(friction, "p2-disc", n=2), "interior_point")
    mesh = bound.model.problem.bodies["block"].mesh
    sigma = tensors(bound.stress["block"])
    facets = mesh.boundaries["bottom"]
    elements = mesh.f2t[0, facets]
    at = np.argmax(mesh.t[:, elements][None] == mesh.facets[:, facets][:, None], axis=1)
    traction = -sigma[elements, at][..., 2]  # of the body on n = -z, (corners, faces, xyz)
    pressure, rubbing = traction[..., 2], np.linalg.norm(traction[..., :2], axis=-1)
    assert pressure.min() >= -1e-12
    assert np.max(rubbing - limit - slope * pressure) <= 1e-12
    table = bound.reactions
    force = table["t_n"].to_numpy() @ table["area"].to_numpy()
    assert force == pytest.approx(bound.load_factor, rel=1e-10)  # pressure 1 on an area of 1


@pytest.mark.parametrize("space", SPACES)
def test_a_smooth_obstacle_is_a_smooth_support(space):
    """Where all of it is pressed; friction carries more, the more the more."""
    factors = [
        la.solve(pressed(friction, space), "interior_point").load_factor
        for friction in (la.SMOOTH, la.Tresca(0.2), la.Tresca(0.5), la.STICK)
    ]
    assert factors[0] == pytest.approx(sqrt(3), rel=CERTIFIED)
    assert np.all(np.diff(factors) > 1e-3)
    held = la.solve(cube(space), "interior_point").load_factor
    assert factors[0] == pytest.approx(held, rel=CERTIFIED)


def test_certified_coulomb_lies_between_its_bounds():
    """Without friction and with associated friction (T14)."""
    inner = la.solve(pressed(0.3, "p2-vertex"), "interior_point")
    assert inner.certificate.holds(CERTIFIED)
    low = la.lower_bound(pressed(la.SMOOTH, "p2-vertex"), "interior_point")
    high = la.solve(pressed(la.Coulomb(0.3, associated=True), "p2-vertex"), "interior_point")
    assert low.load_factor < inner.load_factor < high.load_factor * (1 + CERTIFIED)


def test_friction_does_not_know_axes():
    turn = np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3
    for friction in (0.3, la.Tresca(0.3)):
        one, other = (
            la.solve(pressed(friction, "p2-vertex", turn=own), "interior_point").load_factor
            for own in (None, turn)
        )
        # Certified Coulomb states of a deformable block need not be unique, T14b; these are.
        assert other == pytest.approx(one, rel=1e-4)


def test_a_plate_turned_on_a_floor_feels_the_distance_of_each_place():
    """Tresca: ``tau`` times the integral of r, ``a^3 (sqrt(2) + asinh(1))/6`` of a square."""
    exact = 0.1 * 8 * (sqrt(2) + asinh(1)) / 6
    above, below = [], []
    for n in (2, 4):
        mesh = la.meshes.box((-1, 1), (-1, 1), (0, 0.5), n, n, 1)
        problem = la.Problem(
            {"plate": la.Body(mesh, CRITERION, kinematics="3d", space="p1-disc")},
            [la.Twist("plate", "top", (0, 0, 1))],
            interfaces=[la.Interface(("plate", "bottom"), la.RigidObstacle(), la.Tresca(0.1))],
            dead_loads=[la.Pressure("plate", "top", 0.2)],
        )
        above.append(la.solve(problem, "interior_point").load_factor / exact - 1)
        below.append(1 - la.lower_bound(problem, "interior_point").load_factor / exact)
    assert min(above + below) > 0
    assert above[1] < above[0] / 2.5  # the vertex rule of a convex function: order 2
    assert below[1] < below[0] / 1.8


@pytest.mark.parametrize(
    ("master", "friction", "match"),
    [
        (la.RigidObstacle((0, 0, -0.1), (0, 0, 1)), 0.3, "off the plane"),
        (la.RigidObstacle((0, 0, 0), (0, 0, -1)), 0.3, "behind the plane"),
        (la.RigidObstacle((0, 0), (0, 1)), 0.3, "3|three|body is one of"),
        (la.RigidObstacle(), la.BOND, "BOND"),
    ],
)
def test_obstacles_that_cannot_be_are_refused(master, friction, match):
    mesh = la.meshes.box((0, 1), (0, 1), (0, 1), 1, 1, 1)
    with pytest.raises(la.InputError, match=match):
        la.Problem(
            {"block": la.Body(mesh, CRITERION, kinematics="3d")},
            [la.Pressure("block", "top")],
            interfaces=[la.Interface(("block", "bottom"), master, friction)],
        )


def test_two_bodies_of_tetrahedra_touch_nothing_yet():
    low, high = (
        la.Body(la.meshes.box((0, 1), (0, 1), z, 1, 1, 1), CRITERION, kinematics="3d")
        for z in ((0, 1), (1, 2))
    )
    with pytest.raises(la.InputError, match="touch rigid obstacles, and no other body"):
        la.Problem(
            {"low": low, "high": high},
            [la.Pressure("high", "top")],
            [la.Fix("low", "bottom", "xyz")],
            [la.Interface(("high", "bottom"), ("low", "top"), 0.3)],
        )


def test_a_bracket_with_friction_of_either_kind():
    """Of Coulomb friction one problem without, one with associated friction."""
    for friction in (la.Tresca(0.4), 0.1):
        found = la.bracket(
            pressed(friction, "p2-disc"), 0.12, time_limit=60.0, backend="interior_point", jobs=1
        )
        assert found.lower_bound.rigor is la.Rigor.LOWER
        assert found.upper_bound.rigor is la.Rigor.UPPER
        assert found.lower < found.upper
        assert found.width <= 0.12
