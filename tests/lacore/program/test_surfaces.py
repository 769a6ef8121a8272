"""Yield surfaces against linear programs, point by point (T39, T40)."""

from math import cos, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog
from scipy.sparse import csr_matrix

import lacore as la
from lacore.model.materials.conic_form import PLANE
from lacore.program.certificate import certify
from lacore.program.dissipation import DissipationGroup
from lacore.program.kinematic import ContactRows, KinematicProgram
from lacore.program.state import ProgramState
from lacore.program.surfaces import Surfaces

CRITERIA = {
    "soil": la.MohrCoulomb(1.3, 25),
    "soft soil": la.MohrCoulomb(1.0, 0.1),
    "sand": la.MohrCoulomb(0.0, 35),
    "cut off": la.MohrCoulomb(1.0, 30, tension_cutoff=0.3),
    "cut off and crushed": la.MohrCoulomb(1.0, 20, tension_cutoff=0.2, crushing=4.0),
    "masonry": la.Rankine(0.1, 2.0),
    "no tension": la.NoTension(),
    "shear": la.MaximumShear(0.7),
    "cone": la.DruckerPrager(1.0, 20, "extension"),
}
DRAWN = 15  # points, each of which takes a linear program


def surfaces(criterion, kinematics, points):
    return criterion.conic_form(kinematics).surfaces_of(np.zeros(points, dtype=int))


def known():
    for name, criterion in CRITERIA.items():
        for kinematics in PLANE:
            if criterion.conic_form(kinematics).surfaces:
                yield pytest.param(criterion, kinematics, id=f"{name} {kinematics}")


def least(own, length, volume):
    """Dissipation of one strain rate by its definition: multipliers of least cost; inf: none."""
    found = linprog(
        own.strength[0],
        A_eq=own.slope[0].T,
        b_eq=volume,
        A_ub=-own.normed[None],
        b_ub=[-length],
        bounds=[(0, None)] * own.count,
    )
    return found.fun if found.status == 0 else np.inf


@pytest.mark.parametrize(("criterion", "kinematics"), [*known()])
def test_the_dissipation_is_the_least_cost_of_multipliers(criterion, kinematics):
    rng = np.random.default_rng(1)
    own = surfaces(criterion, kinematics, DRAWN)
    some = rng.exponential(size=(DRAWN, own.count)) * rng.integers(0, 2, (DRAWN, own.count))
    length = some @ own.normed * rng.uniform(size=DRAWN)
    volume = np.einsum("mk,mkl->ml", some, own.slope)
    seen = own.dissipation(length, volume.ravel())
    wanted = [least(own, one, rate) for one, rate in zip(length, volume, strict=True)]
    # Slopes of 0.1 degrees divide round-off of theta by 0.0017, and H is 573 times the cohesion.
    assert seen == pytest.approx(wanted, rel=1e-9, abs=1e-11)
    assert own.impossible(length, volume.ravel()).max() <= 1e-12


@pytest.mark.parametrize(("criterion", "kinematics"), [*known()])
def test_flow_is_possible_where_there_are_multipliers(criterion, kinematics):
    rng = np.random.default_rng(2)
    own = surfaces(criterion, kinematics, DRAWN)
    length, volume = rng.exponential(size=DRAWN), rng.normal(size=(DRAWN, own.volumes))
    wanted = [least(own, one, rate) < np.inf for one, rate in zip(length, volume, strict=True)]
    assert ((own.impossible(length, volume.ravel()) <= 0) == wanted).all()


@pytest.mark.parametrize(("criterion", "kinematics"), [*known()])
@pytest.mark.parametrize("size", [0.1, 1.0, 1e3])
def test_the_closest_stress_is_within_and_what_is_left_flows_by_it(criterion, kinematics, size):
    """T65: all that the elastic share leaves is possible, and dissipates by the stress: normality.

    Both together are what makes a point the closest one of a convex set.
    """
    rng = np.random.default_rng(3)
    own, stiffness = surfaces(criterion, kinematics, 60), np.array([1.0, 10.0, 10.0])
    stiffness = stiffness[: 1 + own.volumes]
    rates = size * rng.normal(size=(60, stiffness.size))
    rates[:, 0] = abs(rates[:, 0])
    found = own.closest_point(rates, stiffness)
    stress = found.stress
    elastic = np.linalg.norm(stiffness * rates, axis=1)
    # Round-off of the elastic stresses, or of the apex, far away at 0.1 degrees.
    apex = abs(own._met[0]).max()
    called = (own.use(stress[:, 0], stress[:, 1:].ravel()) - own.strength).max(axis=1)
    assert np.all(called <= 1e-12 * (elastic + apex))
    left = rates - stress / stiffness
    round_off = 1e-12 * np.linalg.norm(rates, axis=1) + 1e-13 * apex
    assert np.all(left[:, 0] >= -round_off)
    assert np.all(own.impossible(left[:, 0], left[:, 1:].ravel()) <= round_off)
    power = np.sum(stress * left, axis=1)
    # Dissipation moves the rates that round-off makes impossible, and counts them by the apex.
    by_flow = own.dissipation(np.maximum(left[:, 0], 0), left[:, 1:].ravel())
    assert np.all(abs(power - by_flow) <= round_off * (elastic + apex))


@pytest.mark.parametrize(("criterion", "kinematics"), [*known()])
def test_the_tangent_is_the_derivative_of_the_closest_stress(criterion, kinematics):
    """Where the step does not cross the edge of a face: in all but a few of the points."""
    rng = np.random.default_rng(4)
    own, stiffness = surfaces(criterion, kinematics, 200), np.array([1.0, 10.0, 10.0])
    stiffness = stiffness[: 1 + own.volumes]
    rates = rng.normal(size=(200, stiffness.size))
    rates[:, 0] = abs(rates[:, 0]) + 1e-3
    step = 1e-6 * rng.normal(size=rates.shape)
    up, down = (own.closest_point(rates + sign * step, stiffness).stress for sign in (1, -1))
    tangent = own.closest_point(rates, stiffness).tangent
    off = np.linalg.norm((up - down) / 2 - np.einsum("mij,mj->mi", tangent, step), axis=1)
    # Stiffness times the step, or twice that of round-off where the law is linear.
    assert np.mean(off > 1e-12) <= 0.02
    assert off.max() <= 2 * 10 * np.linalg.norm(step, axis=1).max()
    assert np.all(np.linalg.eigvalsh(tangent) >= -1e-12)


@given(
    angle=st.floats(0.2, 60),
    stress=st.tuples(*[st.floats(-5, 5)] * 3),
    hoop=st.floats(-5, 5),
)
def test_planes_are_those_of_principal_stresses(angle, stress, hoop):
    """Mohr-Coulomb by the largest and the least principal stress, in every kinematics."""
    xx, yy, xy = stress
    phi = radians(angle)
    mean, size = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
    for kinematics, third in (
        ("plane_strain", None),
        ("plane_stress", 0.0),
        ("axisymmetric", hoop),
    ):
        own = surfaces(la.MohrCoulomb(1.0, angle), kinematics, 1)
        given_means = [mean, third - mean] if kinematics == "axisymmetric" else [mean]
        every = [mean + size, mean - size] + ([] if third is None else [third])
        most, least_one = max(every), min(every)
        shear = (most - least_one) / 2 + sin(phi) * (most + least_one) / 2 - cos(phi)
        beyond = own.beyond(np.array([size]), np.array(given_means))[0]
        if abs(shear) > 1e-9:
            assert (beyond > 0) == (shear > 0)


def test_a_number_that_is_none_is_no_proof():
    own = surfaces(CRITERIA["soil"], "plane_strain", 2)
    bad = np.array([0.1, np.nan])
    assert np.isnan(own.beyond(bad, np.zeros(2))[1])
    assert not np.all(own.beyond(np.zeros(2), bad) <= 0)
    assert not np.all(own.impossible(np.zeros(2), bad) <= 0)


def test_surfaces_of_no_point():
    none = Surfaces(np.zeros((0, 1, 1)), np.zeros((0, 1)), np.ones(1))
    assert none.dissipation(np.zeros(0), np.zeros(0)).size == 0
    assert none.impossible(np.zeros(0), np.zeros(0)).size == 0


@pytest.mark.parametrize("kinematics", PLANE)
def test_the_cone_of_no_friction_is_that_of_tresca(kinematics):
    """Also as the limit of small angles: 0.1 degrees differ by about tan(0.1 degrees)."""
    shear = la.MaximumShear(1.0).conic_form(kinematics)
    level = la.MohrCoulomb(1.0, 0.0).conic_form(kinematics)
    assert len(shear.surfaces) == len(level.surfaces)
    for one, other in zip(shear.surfaces, level.surfaces, strict=True):
        assert one.slope == other.slope
        assert one.strength == other.strength
    assert shear.preserved.any() == (kinematics != "plane_stress")


def test_each_surface_is_judged_by_its_own_strength():
    """Beside a strength of 1e8 in crushing, a tenth too much for a cohesion of 1 is a tenth."""
    form = la.MohrCoulomb(1.0, 30, crushing=1e8).conic_form("plane_strain")
    own = form.surfaces_of(np.zeros(1, dtype=int))
    most = own.strength_at(np.zeros(1))
    assert own.beyond(1.1 * most, np.zeros(1)) == pytest.approx(0.1)


@pytest.mark.parametrize("points", [1, 2])
def test_a_mechanism_that_cannot_be_is_refused_where_nothing_presses(points):
    """Shear without growth, with yield met and no mean stress: the truth is locked.

    All forces are in balance and no power is missing; only the flow rule is broken.
    """
    shear = csr_matrix(np.array([[0.0], [1.0]] * points))
    flat = la.MohrCoulomb(1.0, 30).conic_form("plane_strain")
    strong = flat.surfaces_of(np.zeros(points, dtype=int))
    group = DissipationGroup(
        "soil",
        shear,
        2,
        np.ones(points),
        flat.bounds(np.zeros(points, dtype=int)),
        csr_matrix((points, 1)),
        0.0,
        surfaces=strong,
    )
    none = csr_matrix((0, 1))
    empty = np.zeros(0)
    contact = ContactRows(none, none, 1, empty, empty, empty, empty, np.zeros(0, dtype=int))
    load = points * float(flat.bound)
    program = KinematicProgram((group,), contact, np.array([1.0]), np.zeros(1))
    stress = np.column_stack([np.zeros(points), np.full(points, float(flat.bound))])
    state = ProgramState(np.ones(1), load, (stress,), (np.zeros(points),), empty, np.zeros((0, 1)))
    found = certify(program, state)
    assert max(found.equilibrium, found.yield_violation, found.gap, found.flow) <= 1e-12
    # sin(phi) of the shear rate is missing of theta, times the strength, per power.
    assert found.divergence == pytest.approx(0.5)
    assert not found.holds(1e-6)


def test_a_large_strength_elsewhere_hides_no_violation():
    """A tenth beyond a cohesion of 1 is a tenth, whatever the strength of the other surface."""
    slope = np.zeros((2, 2, 1))
    slope[:, 1, 0] = -1.0
    own = Surfaces(slope, np.array([[1.0, 1e9], [1.0, 1e9]]), np.array([1.0, 0.0]))
    assert own.beyond(np.array([1.1, 0.0]), np.zeros(2))[0] == pytest.approx(0.1)


def test_strain_rates_beyond_two_edges_cost_what_their_possible_part_does():
    """A material that no stress p_1 or p_2 can pull: each volumetric rate may not be negative.

    Both are, so that both have to be moved; then 3 of shear at a strength of 1 costs 3.
    """
    slope = np.array([[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]])
    own = Surfaces(slope, np.ones((1, 3)), np.array([1.0, 0.0, 0.0]))
    length, volume = np.array([3.0]), np.array([-0.2, -0.5])
    assert own.impossible(length, volume) == pytest.approx(0.5)
    possible = own._possible(np.array([[3.0, -0.2, -0.5]]))
    assert possible == pytest.approx(np.array([[3.0, 0.0, 0.0]]))
    assert own.dissipation(length, volume) == pytest.approx(3.0)


def test_flow_that_is_not_possible_counts_where_no_stress_acts():
    """Two cones of sand: one pressed by 1, one by nothing, which flows against its rule.

    Where stress vanishes the mean over all cones stands in for it: (1 + carried)/2 here.
    """
    form = la.MohrCoulomb(0.0, 30).conic_form("plane_strain")
    sand = form.surfaces_of(np.zeros(2, dtype=int))
    rows = csr_matrix(np.array([[0.0], [0.0], [0.0], [1.0]]))  # only the second cone shears
    group = DissipationGroup(
        "sand", rows, 2, np.ones(2), np.zeros(2), csr_matrix((2, 1)), 0.0, surfaces=sand
    )
    mean = np.array([-1.0, 0.0])
    pressed = 1.0 + group.strength_at(mean)[0]
    assert group.impossible(np.ones(1)) == pytest.approx([0.0, 0.5])
    assert group.taken(np.ones(1), mean) == pytest.approx(pressed / 2 * 0.5)
