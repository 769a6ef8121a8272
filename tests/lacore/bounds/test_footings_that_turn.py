"""Footings that turn under a force beside their middle, and plates that twist bars."""

from dataclasses import replace
from math import sqrt

import numpy as np
import pytest
from skfem import MeshTet

import lacore as la
from lacore_verification.cases.shared.solids import box
from tests.lacore.tetrahedra import CRITERION, SPACES, strip, torsion

SOLVED = 1e-6  # of the load factor: a certificate's bar
TORSION = 8 / 3  # k a^3/3, a = 2 (Nadai)


def leaning(space, turning="y", through=(7 / 8, 0, 1), **footing):
    """Half of a bar 1 x 1 x 1 on a smooth floor under a smooth plate, a vertical cut at x = 1/4."""
    mesh = la.meshes.box((0, 1), (0, 0.5), (0, 1), 4, 1, 1)
    return la.Problem(
        {"bar": la.Body(mesh, CRITERION, kinematics="3d", space=space)},
        [
            la.RigidFooting(
                "bar", "top", (0, 0, -1), rough=False, turning=turning, through=through, **footing
            )
        ],
        [la.Fix("bar", side, "normal") for side in ("bottom", "front")],
    )


@pytest.mark.parametrize(
    ("space", "backend"),
    [("p2-vertex", "clarabel"), ("p2-vertex", "interior_point"), ("p2-disc", "interior_point")],
)
def test_a_force_beside_the_middle_tears_one_side_and_crushes_the_other(space, backend):
    """Uniaxial: tension over t, N = s0 (1 - 2 t), M = s0 t (1 - t), so e = M/N; t = 1/4: e = 3/8.

    The bar bends about x = t: quadratic velocities, which are in both spaces.
    """
    problem = leaning(space)
    low, high = (bound(problem, backend) for bound in (la.lower_bound, la.upper_bound))
    exact = sqrt(3) / 2
    assert low.rigor is la.Rigor.LOWER
    assert high.rigor is la.Rigor.UPPER
    assert exact * (1 - SOLVED) <= low.load_factor <= exact * (1 + 1e-12)
    assert exact * (1 - 1e-12) <= high.load_factor <= exact * (1 + SOLVED)
    gap = la.gap_identity(high, low)
    assert gap.least >= -1e-8
    assert gap.total == pytest.approx(high.load_factor - low.load_factor, abs=1e-12)
    forces = high.state.support_reactions
    across = forces["force_z"].to_numpy()
    under = forces["z"].to_numpy() == 1
    arm = across[under] @ forces["x"].to_numpy()[under] / across[under].sum()
    assert arm == pytest.approx(7 / 8, abs=1e-5)  # where the force acts


@pytest.mark.parametrize("space", SPACES)
def test_what_is_loaded_in_the_middle_does_not_turn(space):
    centred = leaning(space, through=(0.5, 0, 3.0))
    still = leaning(space, turning=None, through=None)
    for problem in (centred, still):
        factor = la.solve(problem, "interior_point").load_factor
        assert factor == pytest.approx(sqrt(3), rel=SOLVED)


def test_a_footing_that_may_turn_carries_no_more():
    """More freedom, less load, from above and below; rough, too."""
    problem = strip("p2-vertex", n=2, rough=True)
    (footing,) = problem.reference_loads
    turning = problem.with_loads([replace(footing, turning="y", through=(0.8, 0, 0))])
    for bound in (la.lower_bound, la.upper_bound):
        held, free = (bound(one, "interior_point").load_factor for one in (problem, turning))
        assert free < held * (1 - 1e-3)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_torsion_does_not_know_units(scale):
    """Torques grow as lengths cubed; rotations are in rad/s whatever the size is."""
    problem = torsion("p2-vertex", 1)
    body = problem.bodies["bar"]
    mesh = MeshTet(scale * body.mesh.p, body.mesh.t).with_boundaries(body.mesh.boundaries)
    large = replace(problem, bodies={"bar": replace(body, mesh=mesh)})
    one, other = (la.solve(own, "interior_point").load_factor for own in (problem, large))
    assert other == pytest.approx(scale**3 * one, rel=SOLVED)


def test_torsion_about_any_axis_from_any_place():
    """Turned by a rotation, away from the origin; a torque of another size, the other way."""
    turn = np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3
    shift = np.array([3.0, -1.0, 2.0])
    problem = torsion("p2-vertex", 1)
    body = problem.bodies["bar"]
    mesh = MeshTet(turn @ body.mesh.p + shift[:, None], body.mesh.t)
    mesh = mesh.with_boundaries(body.mesh.boundaries)
    bar = la.Body(mesh, CRITERION, kinematics="3d")
    plates = [
        la.Twist("bar", side, sign * turn[:, 2], shift, torque=2.0)
        for side, sign in (("top", -1), ("bottom", 1))
    ]
    turned = la.Problem({"bar": bar}, plates)
    # Both ends turn by as much as the one does: half the power each, of twice the torque.
    factors = [la.solve(own, "interior_point").load_factor for own in (problem, turned)]
    assert factors[1] == pytest.approx(factors[0] / 2, rel=SOLVED)


def test_a_plate_that_keeps_the_end_plane_carries_more():
    problem = torsion("p2-vertex", 1)
    (twist,) = problem.reference_loads
    stuck = problem.with_loads([replace(twist, warping=False)])
    free, held = (la.lower_bound(own, "interior_point").load_factor for own in (problem, stuck))
    assert free < held
    assert free < TORSION < la.solve(stuck, "interior_point").load_factor


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: la.Twist("bar", "top", (0, 0)), "Twist.axis"),
        (lambda: la.Twist("bar", "top", (0, 0, 0)), "Twist.axis.*nothing would turn"),
        (lambda: la.Twist("bar", "top", (0, 0, 1), torque=0), "Twist.torque"),
        (lambda: la.Twist("bar", "top", (0, 0, 1), (0, np.nan, 1)), "Twist.through"),
        (lambda: la.RigidFooting("a", "b", (0, 0, 1), turning="yx", through=(0, 0, 0)), "turning"),
        (lambda: la.RigidFooting("a", "b", (0, 0, 1), turning="x"), "through.*both"),
        (lambda: la.RigidFooting("a", "b", (0, 1), turning="x", through=(0, 0, 0)), "RigidBlock"),
    ],
)
def test_wrong_plates_are_refused(make, match):
    with pytest.raises(la.InputError, match=match):
        make()


def test_plates_twist_bodies_in_space_only():
    plane = la.Body(la.meshes.rectangle((0, 1), (0, 1), 1, 1), CRITERION)
    with pytest.raises(la.InputError, match="an axis in three dimensions, and the body is plane"):
        la.Problem({"a": plane}, [la.Twist("a", "top", (0, 0, 1))])
    blocks = la.BlockAssembly3D({"b": box((0, 0, 0), (1, 1, 1))}, 0.5)
    with pytest.raises(la.InputError, match="rigid already"):
        la.Problem({"b": blocks}, [la.Twist("b", "b", (0, 0, 1))])
