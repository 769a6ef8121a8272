"""Loads of soil and masonry whose stress is the same everywhere, and of cavities."""

from math import log, radians, sin, sqrt, tan

import numpy as np
import pytest

import lacore as la
from lacore.coupling.claims.locking_ray import locking_ray
from lacore.program.kinematic import associated_contact
from lacore.reporting.status import Status
from tests.lacore.limit.cavities import cavity

SURFACED = ("clarabel", "cvxpy", "ipopt-static")


def block(criterion, lateral=0.0, pull=False, kinematics="plane_strain", space="p2-vertex"):
    """A square pressed, or pulled, at its top, under a pressure from both sides."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2)
    sides = [la.Pressure("block", side, lateral) for side in ("left", "right") if lateral]
    return la.Problem(
        {"block": la.Body(mesh, criterion, kinematics, space)},
        [la.Traction("block", "top", (0, 1 if pull else -1))],
        supports=[la.Fix("block", "bottom", "y")],
        dead_loads=sides,
    )


SOIL = la.MohrCoulomb(1.0, 30)
STATES = {
    # 2 c cos(phi)/(1 -+ sin(phi)), and (1 + sin(phi))/(1 - sin(phi)) = 3 times the lateral pressure
    "biaxial": (block(SOIL, 0.5), 2 * sqrt(3) + 1.5),
    "sand": (block(la.MohrCoulomb(0.0, 30), 0.5), 1.5),
    "compression": (block(SOIL), 2 * sqrt(3)),
    "tension": (block(SOIL, pull=True), 2 / sqrt(3)),
    "cut off": (block(la.MohrCoulomb(1.0, 30, tension_cutoff=0.3), pull=True), 0.3),
    "crushing": (block(la.NoTension(2.0)), 2.0),
    "masonry in tension": (block(la.Rankine(0.2, 2.0), pull=True), 0.2),
    "one degree": (block(la.MohrCoulomb(1.0, 1)), 2 * tan(radians(45.5))),
    "0.1 degrees": (block(la.MohrCoulomb(1.0, 0.1)), 2 * tan(radians(45.05))),
    "no friction": (block(la.MohrCoulomb(1.0, 0)), 2.0),
    # In a plate the stress across it is zero: pressure from the sides does not help.
    "plate": (block(SOIL, 0.5, kinematics="plane_stress"), 2 * sqrt(3)),
    "plate in tension": (block(SOIL, pull=True, kinematics="plane_stress"), 2 / sqrt(3)),
    "plate of Tresca": (block(la.MaximumShear(1.0), kinematics="plane_stress"), 2.0),
    "interior points": (block(SOIL, 0.5, space="p2-gauss"), 2 * sqrt(3) + 1.5),
    "constant strain": (block(SOIL, 0.5, space="p1"), 2 * sqrt(3) + 1.5),
}


@pytest.mark.parametrize("backend", SURFACED)
@pytest.mark.parametrize(("problem", "exact"), STATES.values(), ids=STATES)
def test_homogeneous_states(problem, exact, backend):
    """To 1e-7, in one solve."""
    state = la.solve(problem, backend)
    assert state.status is Status.SOLVED
    assert state.load_factor == pytest.approx(exact, rel=1e-7)
    assert state.certificate.worst[1] <= 1e-6
    assert len(state.history) == 1


@pytest.mark.parametrize("space", ["p2-gauss", "q2"])
@pytest.mark.parametrize("sphere", [False, True], ids=["cylinder", "sphere"])
@pytest.mark.parametrize("angle", [0, 10, 30])
def test_cavities(angle, sphere, space):
    """Exact pressure of expansion, of radii 1 and 2.

    Errors seen on 144 triangles are at most 1.3e-4, on 36 quadrilaterals 1.1e-3, with order 2 and
    more: the tolerance is twice that.
    """
    power = 2 * (1 + sphere)
    if angle:
        phi = radians(angle)
        apex = 1 / tan(phi)
        exact = apex * (2 ** (power * sin(phi) / (1 + sin(phi))) - 1)
    else:
        exact = power * log(2)
    criterion = la.MohrCoulomb(1.0, angle)
    state = la.solve(cavity(criterion, sphere, space, 6))
    assert state.status is Status.SOLVED
    assert state.load_factor == pytest.approx(exact, rel=2.6e-4 if space == "p2-gauss" else 2.2e-3)


def test_a_ring_that_tension_bursts():
    """Its hoop stress is the tensile strength T everywhere: ``p a = T (b - a)``."""
    mesh = la.meshes.rectangle(x=(1, 2), y=(0, 0.5), nx=4, ny=2)
    body = la.Body(mesh, la.Rankine(0.5, 10.0), "axisymmetric", "p2-gauss")
    problem = la.Problem({"ring": body}, [la.Pressure("ring", "left")])
    state = la.solve(problem)
    assert state.status is Status.SOLVED
    # Velocities of such a ring are 1/r, which quadratic ones follow to the fourth order.
    assert state.load_factor == pytest.approx(0.5, rel=1e-3)


def test_a_bar_of_revolution_in_compression():
    """Triaxial compression under a pressure from around: that of plane strain, with c and phi."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2)
    body = la.Body(mesh, SOIL, "axisymmetric", "p2-gauss")
    problem = la.Problem(
        {"bar": body},
        [la.Pressure("bar", "top")],
        supports=[la.Fix("bar", "bottom", "y")],
        dead_loads=[la.Pressure("bar", "right", 0.5)],
    )
    state = la.solve(problem)
    assert state.status is Status.SOLVED
    assert state.load_factor == pytest.approx(2 * sqrt(3) + 1.5, rel=1e-7)


def cone(match):
    """c = 1 Pa, phi = 20 degrees."""
    return la.DruckerPrager(1.0, 20, match)


def test_a_cone_is_mohr_coulomb_where_it_is_matched():
    """In plane strain, and in a sphere, whose hoop stresses are equal: triaxial compression."""
    soil = la.MohrCoulomb(1.0, 20)
    for pull in (False, True):
        one, other = (block(own, 0.3, pull) for own in (cone("plane_strain"), soil))
        assert la.solve(one).load_factor == pytest.approx(la.solve(other).load_factor, rel=1e-7)
    states = [la.solve(cavity(own, True, "p2-gauss", 6)) for own in (cone("compression"), soil)]
    exact = (2 ** (4 * sin(radians(20)) / (1 + sin(radians(20)))) - 1) / tan(radians(20))
    # The tolerance of `test_cavities`.
    assert [state.load_factor for state in states] == pytest.approx([exact] * 2, rel=2.6e-4)


@pytest.mark.parametrize("pull", [False, True])
@pytest.mark.parametrize("match", ["plane_strain", "compression", "extension"])
def test_a_plate_of_the_cone(match, pull):
    """Uniaxial: ``|sigma|/sqrt(3) = k - a sigma/3``."""
    own = cone(match)
    exact = own.strength / (1 / sqrt(3) + (1 if pull else -1) * own.slope / 3)
    state = la.solve(block(own, pull=pull, kinematics="plane_stress"))
    assert state.load_factor == pytest.approx(exact, rel=1e-7)


@pytest.mark.parametrize("backend", ["slsqp", "highs"])
def test_backends_without_surfaces_refuse(backend):
    with pytest.raises(la.CapabilityError, match=r"clarabel|linear programs"):
        la.solve(block(SOIL), backend)


def test_stresses_and_dissipation_of_a_state():
    """By the stresses that it shows: in balance on the whole, within strength at every point."""
    state = la.solve(block(SOIL, 0.5))
    # All triangles are of one size.
    xx, yy, zz, xy = np.moveaxis(state.stress["block"], -1, 0)
    assert xx.mean() == pytest.approx(-0.5, abs=1e-7)
    assert yy.mean() == pytest.approx(-state.load_factor, rel=1e-7)
    assert xy.mean() == pytest.approx(0.0, abs=1e-7)
    assert zz == pytest.approx((xx + yy) / 2)
    beyond = np.hypot((xx - yy) / 2, xy) - sqrt(3) / 2 + (xx + yy) / 4
    assert beyond.max() <= 1e-6  # of the certificate
    power = state.load_factor - 0.5 * 3  # the sides go out three times as fast, as psi = phi
    assert state.dissipation["block"].mean() == pytest.approx(power, rel=1e-6)


def test_what_is_confined_is_locked():
    """Soil in a rigid box: it cannot flow without growing (T48)."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2)
    problem = la.Problem(
        {"soil": la.Body(mesh, SOIL)},
        [la.BodyForce("soil", (0, -1))],
        supports=[la.Fix("soil", side) for side in ("left", "right", "bottom", "top")],
    )
    assert la.solve(problem).status is Status.LOCKED


@pytest.mark.parametrize("pull", [False, True])
def test_only_what_presses_is_a_proof_of_locking(pull):
    """Confined at its sides, soil carries any pressure by itself, but only so much tension."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2)
    problem = la.Problem(
        {"soil": la.Body(mesh, SOIL)},
        [la.Traction("soil", "top", (0, 1 if pull else -1))],
        supports=[
            la.Fix("soil", "bottom", "y"),
            *(la.Fix("soil", side, "x") for side in ("left", "right")),
        ],
    )
    program = la.discretise(problem).program
    assert locking_ray(program, associated_contact(program.contact)).proves != pull
    assert (la.solve(problem).status is Status.LOCKED) != pull


def test_what_pulls_at_confined_soil_is_not_locked():
    """Held at its sides, pulled apart: tension has an end, where flow keeps no volume, too."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2)
    problem = la.Problem(
        {"soil": la.Body(mesh, SOIL)},
        [la.Traction("soil", "top", (0, 1)), la.Traction("soil", "bottom", (0, -1))],
        supports=[la.Fix("soil", side, "x") for side in ("left", "right")],
    )
    # Plane strain without lateral strain: theta = eps_yy >= sin(phi) eps_yy, up to the apex.
    assert la.solve(problem).load_factor == pytest.approx(sqrt(3), rel=1e-6)


def test_a_slope_steeper_than_its_friction_is_unsafe():
    """Sand at 45 degrees with 30: its weight alone takes it down, whatever pushes."""
    mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2)
    mesh = mesh.with_boundaries({"crest": lambda x: (x[1] > 1 - 1e-9) & (x[0] > 1)})
    shape = mesh.p.copy()
    shape[0] = shape[0] + (1 - shape[0] / 2) * shape[1]  # the left side leans by 45 degrees
    problem = la.Problem(
        {
            "sand": la.Body(
                type(mesh)(shape, mesh.t, _boundaries=mesh.boundaries), la.MohrCoulomb(0.0, 30)
            )
        },
        [la.Pressure("sand", "crest")],
        supports=[la.Fix("sand", "bottom"), la.Fix("sand", "right")],
        dead_loads=[la.BodyForce("sand", (0, -1))],
    )
    assert la.solve(problem).status is Status.UNSAFE


@pytest.mark.parametrize("turn", [0.3, 1.2])
def test_it_is_the_same_turned_and_in_other_units(turn):
    """Of a block that is turned, and one of kilometres and gigapascals."""
    problem, exact = STATES["biaxial"]
    body = problem.bodies["block"]
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    mesh = body.mesh
    size, stress = 1e3, 1e9
    moved = type(mesh)(size * rotation @ mesh.p, mesh.t, _boundaries=mesh.boundaries)
    other = la.Problem(
        {"block": la.Body(moved, la.MohrCoulomb(stress, 30))},
        [la.Pressure("block", "top", stress)],
        supports=[la.Fix("block", "bottom", "normal")],
        dead_loads=[la.Pressure("block", side, 0.5 * stress) for side in ("left", "right")],
    )
    assert la.solve(other).load_factor == pytest.approx(exact, rel=1e-7)


def shaken(values):
    rng = np.random.default_rng(3)
    return {"block": values["block"] * (1 + 1e-4 * rng.standard_normal(values["block"].shape))}


PLANTED = {
    "load factor": lambda s: {"load_factor": s.load_factor * 1.0001},
    "stress": lambda s: {"stress": shaken(s.stress)},
    "stress beyond strength": lambda s: {"stress": {"block": 1.001 * s.stress["block"]}},
    "tension for compression": lambda s: {"stress": {"block": -s.stress["block"]}},
    "velocity": lambda s: {"velocity": shaken(s.velocity)},
    "flow that keeps its volume": lambda s: {
        "velocity": {"block": s.velocity["block"] * np.array([[1 / 3], [1.0]])}
    },
    "no number": lambda s: {"stress": {"block": np.nan * s.stress["block"]}},
}


def test_flow_that_keeps_its_volume_is_seen_by_its_divergence():
    """The power of the mean stress, -5.46/2 of a power of 3.46, on what is missing of theta."""
    state = la.solve(block(SOIL, 0.5))
    found = state.certify(**PLANTED["flow that keeps its volume"](state))
    # sin(phi) ||d|| = 1 at a unit of settlement, and theta = 0; powers of that flow are of order 1.
    assert 0.1 < found.divergence < 10
    assert state.certificate.divergence < 1e-6


@pytest.mark.parametrize("planted", PLANTED.values(), ids=PLANTED)
def test_planted_errors_are_refused(planted):
    state = la.solve(block(SOIL, 0.5))
    assert state.certify().holds(1e-6)
    assert not state.certify(**planted(state)).holds(1e-6)
