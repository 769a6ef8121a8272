"""Soils whose flow is not associated: Coulomb contact at each of their points (T49-T57)."""

from dataclasses import replace
from math import cos, radians, sin, sqrt, tan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from lacore.assembly.discretise import discretise
from lacore.coupling.freezing import davis
from lacore.coupling.run import OutOfTime
from lacore.program.kinematic import associated_contact, dimensionless
from lacore.solvers.backend import find_backend
from tests.lacore.models import sheared

EXACT = ["clarabel", "cvxpy", "ipopt-static"]
PHI, COHESION = 30.0, 1.0


def pressed(dilation, lateral=0.5):
    """A block between smooth platens, a pressure on its sides: the same stress everywhere."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2)
    soil = la.MohrCoulomb(COHESION, PHI, dilation_angle=dilation)
    return la.Problem(
        bodies={"block": la.Body(mesh, soil)},
        supports=[la.Fix("block", "bottom", "y")],
        reference_loads=[la.Traction("block", "top", (0, -1))],
        dead_loads=[la.Pressure("block", side, lateral) for side in ("left", "right")],
    )


@pytest.mark.parametrize("backend", EXACT)
@pytest.mark.parametrize("dilation", [0.0, 10.0, 30.0])
def test_a_homogeneous_state_does_not_feel_how_much_a_soil_dilates(backend, dilation):
    state = la.solve(pressed(dilation), backend, tolerance=1e-6)
    sine = sin(radians(PHI))
    exact = (2 * COHESION * cos(radians(PHI)) + 0.5 * (1 + sine)) / (1 - sine)
    assert state.status is la.Status.SOLVED
    # Exact backends solve to 1e-8 and better (verification/lacore_verification/cases/biaxial.py).
    assert state.load_factor == pytest.approx(exact, rel=1e-7)
    assert len(state.history) <= 3
    assert state.rigor is (la.Rigor.UPPER if dilation == PHI else la.Rigor.DISCRETE)


ANGLES = st.floats(1.0, 45.0)


@given(
    angle=ANGLES,
    less=st.floats(0.0, 0.99),
    spare=st.floats(0.0, 5.0),
    length=st.floats(0.0, 1.0),
    more=st.floats(0.0, 1.0),
)
def test_frozen_at_its_own_pressure_flow_costs_the_bipotential(angle, less, spare, length, more):
    """``H theta + (sin(phi) - sin(psi)) pi ||d||`` for ``theta >= sin(psi) ||d||`` (T50)."""
    soil = la.MohrCoulomb(COHESION, angle, dilation_angle=less * angle if less * angle > 0.1 else 0)
    own = soil.conic_form("plane_strain").surfaces_of(np.zeros(1, dtype=int))
    phi, psi, apex = radians(angle), radians(soil.dilation_angle), soil.apex
    theta = sin(psi) * length + more
    frozen = own.at_friction(own.friction(np.array([apex - spare])))
    power = frozen.dissipation(np.array([length]), np.array([theta]))[0]
    expected = apex * theta + (sin(phi) - sin(psi)) * spare * length
    # Corners of planes that meet at a slope of sin(1 degree) are exact to about 1e-12/0.017.
    assert power == pytest.approx(expected, rel=1e-9, abs=1e-9)
    # Rates next to possible ones are taken as such; how far they are off is told besides.
    assert frozen.impossible(np.array([length]), np.array([theta]))[0] <= 1e-12
    off = frozen.impossible(np.array([length + 1.0]), np.array([sin(psi) * length]))[0]
    assert off == pytest.approx(sin(psi), abs=1e-9)


def test_a_soil_that_dilates_by_its_friction_is_associated():
    for dilation in (PHI, None):
        form = la.MohrCoulomb(1.0, PHI, dilation_angle=dilation).conic_form("plane_strain")
        assert not form.frictional
    without, full = (la.solve(pressed(dilation)) for dilation in (None, PHI))
    assert without.load_factor == full.load_factor


def simple_shear(problem, cohesion=COHESION, confined=1.0):
    """The state of homogeneous shear without dilation, which no solver had a part in.

    Coaxial: sigma_xx = sigma_yy = -p, so ``tau = c cos(phi) + p sin(phi)``: Davis's strength.
    """
    stated = discretise(problem)
    (dofs,) = stated.continua.values()
    tau = cohesion * cos(radians(PHI)) + confined * sin(radians(PHI))
    state = la.solve(problem, max_iterations=1)
    # The load is a mean traction: on a top of length 2 it has power 1 at a speed of 1/2.
    speed = np.stack([dofs.nodes[1] / 2, np.zeros_like(dofs.nodes[1])])
    points = dofs.weights.shape
    stress = np.zeros((*points, 4))
    stress[..., [0, 1, 2]], stress[..., 3] = -confined, tau
    return state, {"velocity": {"layer": speed}, "stress": {"layer": stress}}, tau


def test_homogeneous_shear_is_a_state_with_the_strength_of_davis():
    state, parts, tau = simple_shear(sheared(0.0))
    proof = state.certify(load_factor=tau, **parts)
    # Sums of a few hundred terms in double precision.
    assert proof.worst[1] <= 1e-11
    reduced = la.solve(pressed(0.0), coupling="davis")
    assert reduced.rigor is la.Rigor.DISCRETE
    own = la.MohrCoulomb(COHESION, PHI, dilation_angle=10.0).conic_form("plane_strain")
    strength = own.surfaces_of(np.zeros(1, dtype=int)).davis()
    phi, psi = radians(PHI), radians(10.0)
    beta = cos(psi) * cos(phi) / (1 - sin(psi) * sin(phi))
    tangent = beta * tan(phi)
    assert strength.slope.item() == pytest.approx(tangent / sqrt(1 + tangent**2), rel=1e-14)
    assert strength.strength.item() == pytest.approx(
        beta * COHESION / sqrt(1 + tangent**2), rel=1e-14
    )


def test_planted_errors_are_refused():
    """Each of them is far above what the exact state leaves, 1e-12."""
    state, parts, tau = simple_shear(sheared(0.0))
    stress, speed = parts["stress"]["layer"], parts["velocity"]["layer"]
    turned = stress * np.array([1, 1, 1, -1])
    tensile = stress + 4 * np.array([1, 1, 1, 0])  # beyond the apex, c cot(phi) = 1.73
    rising = speed + np.stack([0 * speed[0], 0.1 * speed[0]])
    planted = {
        "load factor": {"load_factor": tau * (1 + 1e-4)},
        "sign of s": {"stress": {"layer": turned}},
        "beyond the apex": {"stress": {"layer": tensile}},
        "dilation": {"velocity": {"layer": rising}},
        "less friction": {"stress": {"layer": stress * np.array([1, 1, 1, 1 - 1e-4])}},
    }
    assert state.certify(load_factor=tau, **parts).holds(1e-9)
    for name, changed in planted.items():
        proof = state.certify(**{"load_factor": tau, **parts, **changed})
        assert not proof.holds(3e-5), name


@pytest.mark.parametrize("dilation", [0.0, 10.0])
def test_an_associated_state_is_refused(dilation):
    """What dilates by all of its friction is no state of a soil that dilates less."""
    problem = sheared(dilation)
    other = la.solve(problem, coupling="associated")
    assert other.certify().holds(1e-6)
    wrong = replace(other, coupling="certified")
    assert wrong.certify().worst[1] > 1e-2
    swapped = la.solve(sheared(None)).point
    assert not la.solve(problem).certify(point=swapped).holds(5e-5)


@pytest.mark.parametrize("dilation", [pytest.param(0.0, marks=pytest.mark.slow), 20.0])
def test_no_state_is_above_the_associated_one_of_its_mesh(dilation):
    problem = sheared(dilation)
    found = la.soil_range(problem, shares=(1.0, 0.3))
    above = la.solve(sheared(None)).load_factor
    assert found.status is la.Status.SOLVED
    assert found.low <= found.high <= above
    assert found.bracket[1] == pytest.approx(above, rel=1e-7)  # of two solves to 1e-8
    assert found.bracket[0] <= found.low
    for state in (found.lowest, found.highest):
        assert state.certify().holds(found.tolerance)
        # The static value is reported: stresses carry it to round-off, whatever the gap is.
        assert state.certify().equilibrium <= 1e-9
    if dilation == 20.0:
        # Where loads are unique searches differ by what their tolerance lets through.
        assert found.width <= 1e-3


def test_units_do_not_matter():
    plain = la.solve(sheared(10.0))
    kilo = la.solve(sheared(10.0, confined=1e3, cohesion=1e3 * COHESION))
    # Natural units make the same program of both, up to round-off, which many solves carry on.
    assert kilo.load_factor == pytest.approx(1e3 * plain.load_factor, rel=1e-5)


def test_friction_of_an_interface_and_of_a_soil_are_coupled_in_one_loop():
    """A homogeneous block on a floor with Coulomb friction, which its widening mobilises."""
    mesh = la.meshes.rectangle(x=(-1, 1), y=(0, 1), nx=4, ny=2)
    soil = la.MohrCoulomb(COHESION, PHI, dilation_angle=0.0)
    loads = {}
    for mu in (0.0, 0.2):
        law = la.Coulomb(mu)
        problem = la.Problem(
            bodies={"block": la.Body(mesh, soil)},
            interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle(), law)],
            reference_loads=[la.RigidFooting("block", "top", (0, -1), rough=False)],
        )
        state = la.solve(problem)
        assert state.status is la.Status.SOLVED
        assert state.certify().holds(state.tolerance)
        loads[mu] = state.load_factor
    assert loads[0.0] == pytest.approx(2 * sqrt(3), rel=1e-6)  # 2 c cos(phi)/(1 - sin(phi))
    assert loads[0.0] * (1 + 1e-3) < loads[0.2]


@pytest.mark.parametrize("dilation", [None, 10.0, 0.0])
def test_a_cone_dilates_by_its_own_angle_in_axisymmetry(dilation):
    """A cylinder between smooth platens: homogeneous, ``tr eps = b sqrt(2) ||e||`` (T41, T49)."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2)
    soil = la.DruckerPrager(1.0, 30, "compression", dilation_angle=dilation)
    problem = la.Problem(
        bodies={"sample": la.Body(mesh, soil, kinematics="axisymmetric", space="p2-gauss")},
        supports=[la.Fix("sample", "bottom", "y"), la.Fix("sample", "left", "x")],
        reference_loads=[la.RigidFooting("sample", "top", (0, -1), rough=False)],
    )
    state = la.solve(problem)
    assert state.status is la.Status.SOLVED
    assert state.certify(point=state.point).holds(state.tolerance)
    # Mohr-Coulomb in triaxial compression, which the cone is matched to: 2 c cos/(1 - sin).
    assert state.load_factor == pytest.approx(2 * sqrt(3), rel=1e-6)
    speed, nodes = state.velocity["sample"], state.discretisation.continua["sample"].nodes
    out = speed[0, nodes[0] > 0.99].mean()
    down = -speed[1, nodes[1] > 0.99].mean()
    sine = sin(radians(30 if dilation is None else dilation))
    slope = 6 * sine / (sqrt(3) * (3 - sine))
    # The rate of slippage near round-off of a load that is flat in it: its gap is 1e-6 at most.
    assert 2 * out - down == pytest.approx(slope * (out + down) * 2 / sqrt(3), abs=1e-3 * down)


def test_what_is_carried_asks_for_no_flow():
    """Pressures on the sides alone are carried by friction, however little the soil dilates."""
    stable = la.solve(pressed(0.0)).stability()
    assert stable.standing.name == "STANDS"


def test_a_bar_that_is_asked_for_is_kept():
    """After few solves a gap is small enough to be told, and not what was asked for."""
    problem = sheared(0.0)
    told = la.solve(problem, max_iterations=7)
    assert told.status is la.Status.SOLVED
    assert told.certificate.worst[1] <= told.tolerance == 5e-5
    kept = la.solve(problem, tolerance=1e-6, max_iterations=7)
    assert kept.status is la.Status.NOT_CERTIFIED
    assert kept.tolerance == 1e-6


def test_backends_agree_on_a_flow_that_is_frozen():
    mesh = la.meshes.rectangle(x=(0, 4), y=(-2, 0), nx=4, ny=2)
    footing = la.Problem(
        bodies={"soil": la.Body(mesh, la.MohrCoulomb(1.0, 20, dilation_angle=5))},
        supports=[la.Fix("soil", "left", "x"), la.Fix("soil", "bottom"), la.Fix("soil", "right")],
        reference_loads=[
            la.RigidFooting("soil", lambda x: (x[1] == 0) & (x[0] <= 1), (0, -1), rough=False)
        ],
    )
    stated = discretise(footing)
    program = dimensionless(stated.program, stated.natural)

    def solved(name, own):
        """The velocity, and the value of the static problem: load factors alone need not agree."""
        engine = find_backend(name)
        answer = engine.prepare(own, engine.Options()).solve(associated_contact(own.contact))
        assert answer.status is la.Status.SOLVED
        (group,), (mean,) = own.groups, answer.point.mean_stress
        let_go = group.volume_weights @ (mean * group.surfaces.besides)
        return answer.point.velocity, answer.point.load_factor - float(let_go)

    velocity, full = solved("clarabel", program.associated())
    friction = program.friction((np.zeros(program.groups[0].weights.size),))
    frozen = program.at_flow(0.1 * velocity, friction)
    (_, exact), (_, other) = (solved(name, frozen) for name in ("clarabel", "cvxpy"))
    assert exact == pytest.approx(other, rel=1e-7)  # both solve to 1e-8 and better
    assert abs(exact - full) > 1e-2 * full


def test_what_a_bound_or_another_loop_needs_is_refused():
    problem = sheared(0.0)
    for ask in (la.lower_bound, la.upper_bound, la.bracket):
        with pytest.raises(la.InputError, match=r"bound theorems do not hold.*T54"):
            ask(problem)
    with pytest.raises(la.InputError, match="bound theorems do not hold"):
        la.gap_identity(la.solve(problem, coupling="associated"), la.lower_bound(sheared(None)))
    with pytest.raises(la.InputError, match="soil_range"):
        la.coulomb_range(problem)
    with pytest.raises(la.InputError, match="soil_range"):
        _ = la.solve(problem).interval()
    for coupling in ("reaction", "shift"):
        with pytest.raises(la.InputError, match="take 'certified'"):
            la.solve(problem, coupling=coupling)
    with pytest.raises(la.InputError, match="needs no reduction"):
        la.solve(sheared(None), coupling="davis")
    with pytest.raises(la.InputError, match="flow of all bodies is associated"):
        la.soil_range(sheared(None))
    with pytest.raises(la.InputError, match="shares"):
        la.soil_range(problem, shares=(0.0,))
    with pytest.raises(la.InputError, match="time_limit"):
        la.soil_range(problem, time_limit=0.0)
    jumping = replace(problem.bodies["layer"], space="p2-disc")
    with pytest.raises(la.InputError, match="take 'p2-gauss'"):
        la.solve(replace(problem, bodies={"layer": jumping}))


@pytest.mark.parametrize(
    ("given", "match"),
    [
        ({"dilation_angle": 31}, "more than the friction angle 30"),
        ({"dilation_angle": -1}, "not an angle from 0 to 89"),
        ({"dilation_angle": float("nan")}, "not an angle"),
        ({"dilation_angle": 0.05}, "take 0"),
        ({"dilation_angle": radians(10)}, "10 degrees in radians"),
    ],
)
def test_dilation_angles_that_mean_nothing(given, match):
    with pytest.raises(la.InputError, match=match):
        la.MohrCoulomb(1.0, 30, **given)


def boxed(dilation):
    """All sides are held but a part of the top, which is pushed: nothing can flow out (T48)."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=4, ny=4)
    pushed = {"pushed": lambda x: (x[1] > 1 - 1e-9) & (x[0] < 0.5)}
    mesh = mesh.with_boundaries(pushed | {"lid": lambda x: (x[1] > 1 - 1e-9) & (x[0] > 0.5)})
    return la.Problem(
        bodies={"soil": la.Body(mesh, la.MohrCoulomb(1.0, 30, dilation_angle=dilation))},
        supports=[la.Fix("soil", side, "normal") for side in ("left", "right", "bottom", "lid")],
        reference_loads=[la.Traction("soil", "pushed", (0, -1))],
    )


def test_searches_that_run_out_of_time_keep_what_they_have_found(monkeypatch):
    """No time at all: no state, and bounds that hold; enough for the first search: its state."""
    problem = sheared(20.0, cells=2)
    none = la.soil_range(problem, time_limit=1e-9)
    assert none.status is la.Status.TIME_LIMIT
    assert none.lowest is None
    assert np.isnan(none.low)
    assert none.stopped == "by its time limit of 1e-09 s, after 0 of 6 searches"
    assert "stopped by its time limit" in none.facts().title
    whole = la.soil_range(problem, shares=(1.0,))
    assert not whole.stopped
    left = [1 + int(whole.states["solves"][0])]  # its start, and its own

    def check(_):
        left[0] -= 1
        if left[0] < 0:
            raise OutOfTime

    monkeypatch.setattr("lacore.analyses.ranges.soil.until", lambda _: check)
    one = la.soil_range(problem, shares=(1.0,))
    assert one.stopped.endswith("after 2 of 2 searches")
    assert one.status is la.Status.SOLVED
    assert one.lowest.certify().holds(one.tolerance)
    assert one.states["load_factor"][0] == pytest.approx(whole.states["load_factor"][0], rel=1e-9)
    assert one.states["solves"][1] == 1
    assert one.bracket == pytest.approx(none.bracket, rel=1e-9)


@pytest.mark.parametrize("dilation", [pytest.param(10.0, marks=pytest.mark.slow), 0.0])
def test_what_cannot_flow_out_is_locked(dilation):
    problem = boxed(dilation)
    assert la.solve(problem).status is la.Status.LOCKED
    found = la.soil_range(problem, shares=(1.0,))
    assert found.status is la.Status.LOCKED
    assert found.low == np.inf


def test_what_only_dilatancy_locks_is_not_where_it_is_less():
    """The layer on its coarsest mesh: associated, it could only lift the plate (T13, T48)."""
    assert la.solve(sheared(None, cells=1)).status is la.Status.LOCKED
    free = la.solve(sheared(0.0, cells=1))
    assert free.status is la.Status.SOLVED
    assert free.certify().holds(free.tolerance)


def test_what_falls_with_all_of_its_friction_falls():
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=3, ny=3)
    steep = la.Problem(
        bodies={"soil": la.Body(mesh, la.MohrCoulomb(0.1, 30, dilation_angle=0))},
        supports=[la.Fix("soil", "left"), la.Fix("soil", "bottom")],
        reference_loads=[la.Traction("soil", "top", (0, -1))],
        dead_loads=[la.BodyForce("soil", (0, -10.0))],
    )
    state = la.solve(steep)
    assert state.status is la.Status.UNSAFE
    assert state.stability().standing.name == "FALLS"
    assert la.soil_range(steep, shares=(1.0,)).status is la.Status.UNSAFE


def test_the_power_of_the_state_is_that_of_its_own_laws():
    """Dissipation by element sums to the power of the loads."""
    for coupling in ("certified", "associated", "davis"):
        state = la.solve(sheared(10.0), coupling=coupling)
        (dofs,) = state.discretisation.continua.values()
        plastic = float(dofs.volumes @ state.dissipation["layer"])
        dead = float(state.discretisation.full.dead_load @ state.point.velocity)
        assert plastic - dead == pytest.approx(state.load_factor, rel=2 * state.tolerance)


def test_davis_of_a_program_is_that_of_its_groups():
    stated = discretise(sheared(10.0))
    program = dimensionless(stated.program, stated.natural)
    assert not davis(program).frictional
    assert davis(program).groups[0].surfaces.slope.max() < program.groups[0].surfaces.slope.max()
