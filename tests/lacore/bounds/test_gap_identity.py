"""The gap identity (T26): a self-test of both bounds, and what it refuses."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.assembly.discretise import discretise
from lacore.bounds.gap_identity import restriction
from lacore.bounds.solid.restriction import solid_restriction
from lacore.bounds.static_model import static_model
from lacore.model.bodies.continuum.solid.faces import EDGES
from tests.lacore.models import CRITERION, cantilever, deformable_block, punch
from tests.lacore.random_continua import delaunay_square

ROUND_OFF = 1e-12  # of sums of a hundred terms of order one


def heavy(mesh):
    return la.Problem(
        {"block": la.Body(mesh, CRITERION)},
        [la.Traction("block", "right", (0.3, -1)), la.Pressure("block", "top", 0.2)],
        [la.Fix("block", "left")],
        dead_loads=[la.BodyForce("block", (0.1, -0.5))],
    )


def wet(mesh):
    def pressure(x):
        return 1.7 + 0.4 * x[0] - 0.9 * x[1]

    return la.Problem(
        {"block": la.Body(mesh, CRITERION)},
        [la.StandingWater("block", "right", pressure)],
        [la.Fix("block", "left")],
        dead_loads=[la.PorePressure("block", pressure)],
    )


@pytest.mark.parametrize("loaded", [heavy, wet])
def test_restricted_velocities_do_the_same_power(loaded):
    """On every load, and on every stress that is linear in a triangle."""
    rng = np.random.default_rng(0)
    stated = loaded(delaunay_square(rng))
    kinematic, static = discretise(stated), static_model(stated)
    velocity = rng.normal(size=kinematic.full.n)
    restricted = np.zeros(static.full.n)
    nodes, values = restriction(
        kinematic.continua["block"], static.continua["block"], velocity, None
    )
    restricted[2 * nodes], restricted[2 * nodes + 1] = values
    for mine, its in (
        (static.full.reference_load, kinematic.full.reference_load),
        (static.full.dead_load, kinematic.full.dead_load),
    ):
        assert mine @ restricted == pytest.approx(its @ velocity, rel=ROUND_OFF)
    group, other = static.full.groups[0], kinematic.full.groups[0]
    stress = rng.normal(size=(group.weights.size // 3, 3, 2))
    power = np.sum(
        group.weights * np.sum(stress.reshape(-1, 2) * group.cone_vectors(restricted), 1)
    )
    rates, area = other.cone_vectors(velocity).reshape(-1, 3, 2), group.weights[::3] * 3
    exact = np.sum(stress * rates, axis=(1, 2)) + np.sum(stress.sum(1) * rates.sum(1), axis=1)
    assert power == pytest.approx(area @ exact / 12, rel=ROUND_OFF)


@pytest.mark.parametrize("space", ["p1-disc", "p2-vertex", "p2-disc"])
def test_restricted_velocities_in_space_do_the_same_power(space):
    """Of a quadratic velocity on forces in the volume and on the surface."""
    mesh = la.meshes.box((0, 1), (0, 1), (0, 1), 1, 1, 1)
    stated = la.Problem(
        {"block": la.Body(mesh, CRITERION, kinematics="3d", space=space)},
        [la.BodyForce("block", (1.0, -2.0, 0.5))],
        dead_loads=[la.Traction("block", "right", (0.3, -1.0, 0.7))],
    )
    kinematic, static = discretise(stated), static_model(stated)
    dofs, velocity = kinematic.continua["block"], np.zeros(kinematic.full.n)
    x, y, z = places(dofs)
    degree = 1 if space == "p1-disc" else 2
    for own, value in zip(dofs.dofs, (x**degree, y**degree + 0.5 * z, z**degree), strict=True):
        velocity[own] = value
    nodes, values = solid_restriction(
        "block", dofs, static.continua["block"], velocity, stated, np.zeros(0)
    )
    restricted = np.zeros(static.full.n)
    for axis, own in enumerate(values):
        restricted[3 * nodes + axis] = own
    share = 1 / (1 + degree)  # of the integral of x^degree over the cube
    assert static.full.reference_load @ restricted == pytest.approx(
        share - 2 * (share + 0.25) + 0.5 * share, rel=ROUND_OFF
    )
    assert static.full.dead_load @ restricted == pytest.approx(
        0.3 - (share + 0.25) + 0.7 * share, rel=ROUND_OFF
    )


def places(dofs):
    """Coordinates of the nodes of tetrahedra: vertices, then the middles of edges."""
    mesh = dofs.body.mesh
    corners = mesh.p[:, mesh.t]
    first, last = EDGES
    sides = (corners[:, first] + corners[:, last]) / 2
    own = np.concatenate([corners, sides], axis=1)[:, : dofs.element_nodes.shape[0]]
    found = np.zeros((3, dofs.dofs.shape[1]))
    found[:, dofs.element_nodes] = own
    return found


def test_constant_stress_is_in_equilibrium_with_its_tractions():
    """A uniform stress loads nothing but the boundary."""
    mesh = delaunay_square(np.random.default_rng(1))
    stated = la.Problem(
        {"block": la.Body(mesh, CRITERION)},
        [
            la.Traction("block", "left", (-3, -1)),
            la.Traction("block", "right", (3, 1)),
            la.Traction("block", "bottom", (-1, -2)),
            la.Traction("block", "top", (1, 2)),
        ],
    )
    program = static_model(stated).full
    (group,) = program.groups
    # sigma = (3, 2, 1): mean 2.5, half difference 0.5.
    force = group.rows.T @ np.ravel(group.weights[:, None] * [0.5, 1.0])
    force += group.volumetric.T @ (group.weights * 2.5)
    assert np.allclose(force, program.reference_load, atol=ROUND_OFF)


@pytest.mark.parametrize(
    "stated",
    [
        punch(rough=True),
        punch(rough=False),
        punch(dead=[la.BodyForce("soil", (0.1, -1.0))]),
        cantilever(),
        deformable_block(la.Coulomb(0.3, associated=True), n=2),
        deformable_block(la.Tresca(0.4), n=2),
        deformable_block(la.STICK, n=2),
    ],
)
def test_identity(stated):
    upper, lower = la.solve(stated), la.lower_bound(stated)
    identity = la.gap_identity(upper, lower)
    gap = upper.load_factor - lower.load_factor
    # Round-off of both load factors counts where the gap is the margin off strengths, 1e-7, alone.
    assert identity.total == pytest.approx(gap, rel=1e-5, abs=1e-11)
    assert identity.least >= -1e-9
    assert gap > 0
    for name, body in stated.bodies.items():
        assert identity.elements[name].shape == (body.mesh.nelements,)
    assert set(identity.interfaces) == {interface.name for interface in stated.interfaces}


@pytest.mark.parametrize("space", ["p2-vertex", "p2-disc", "p1-disc"])
@pytest.mark.parametrize("seed", range(3))
def test_identity_of_every_space_of_bounds(space, seed):
    """On random meshes; jumps of velocities have a share of their own in it."""
    stated = heavy(delaunay_square(np.random.default_rng(seed), inner=20))
    (name,) = stated.bodies
    finer = la.meshes.split(stated.bodies[name].mesh, corners(stated.bodies[name].mesh))
    stated = replace(heavy(finer), bodies={name: la.Body(finer, CRITERION, space=space)})
    lower, upper = la.lower_bound(stated), la.upper_bound(stated)
    identity = la.gap_identity(upper, lower)
    assert upper.rigor is la.Rigor.UPPER
    assert identity.total == pytest.approx(upper.load_factor - lower.load_factor, rel=1e-5)
    assert identity.least >= -1e-9
    assert upper.load_factor <= upper.state.load_factor + 1e-9


def corners(mesh):
    """Elements that fill a corner alone."""
    vertices, count = np.unique(mesh.t, return_counts=True)
    return np.flatnonzero(np.isin(mesh.t, vertices[count == 1]).any(axis=0))


def test_it_sees_a_wrong_bound():
    stated = punch()
    upper, lower = la.solve(stated), la.lower_bound(stated)
    forged = replace(lower, load_factor=lower.load_factor + 1e-4)
    identity = la.gap_identity(upper, forged)
    assert identity.total - (identity.upper - identity.lower) == pytest.approx(1e-4, rel=1e-3)


@pytest.mark.parametrize(
    ("upper", "words"),
    [
        (lambda: la.solve(punch(space="p2-gauss")), "not a bound, so that shares"),
        (lambda: la.solve(punch(nx=5)), "not that of the upper bound"),
        (lambda: la.solve(deformable_block(0.3)), "Coulomb"),
        (lambda: la.solve(cantilever()), "other bodies"),
        (lambda: la.solve(punch(), options={"max_iterations": 1}), "no bound"),
    ],
)
def test_what_does_not_fit_is_refused(upper, words):
    with pytest.raises(la.InputError, match=words):
        la.gap_identity(upper(), la.lower_bound(punch()))


@pytest.mark.parametrize(
    ("arguments", "field", "words"),
    [
        (lambda upper, lower, _: (lower, upper), "upper", "<LowerBound>: .* and then"),
        (lambda upper, lower, state: (upper, state), "lower", "<LimitState>: .* and then"),
        (
            lambda upper, lower, _: (upper.load_factor, lower),
            "upper",
            "no UpperBound or L",
        ),
        (lambda upper, lower, _: (upper, lower.load_factor), "lower", "no LowerBound"),
    ],
)
def test_what_is_no_bound_is_named(arguments, field, words):
    stated = cantilever()
    state = la.solve(stated)
    upper, lower = la.upper_bound(state), la.lower_bound(stated)
    with pytest.raises(la.InputError, match=words) as refused:
        la.gap_identity(*arguments(upper, lower, state))
    assert refused.value.field == field
    assert len(str(refused.value)) < 200


def test_a_lower_bound_takes_problems_not_states():
    with pytest.raises(la.InputError, match=r"problem = <LimitState>: .*discretisation\.problem"):
        la.lower_bound(la.solve(cantilever()))


def test_it_is_told_in_two_lines():
    stated = deformable_block(la.Tresca(0.4), n=2)
    identity = la.gap_identity(la.solve(stated), la.lower_bound(stated))
    told = str(identity).splitlines()
    assert len(told) == 2
    assert told[0].startswith(f"gap {identity.upper - identity.lower:.6g} = upper ")
    (body,) = stated.bodies.values()
    interfaces = len(stated.interfaces)
    assert f"{body.mesh.nelements} elements and {interfaces} interface" in told[1]
    assert f"least {identity.least:.1e}" in told[1]
