"""Body forces that vary from place to place: against closed forms, and against regions."""

import numpy as np
import pytest

import lacore as la
from lacore.assembly.discretise import discretise

LIGHT, HEAVY = 16e3, 21e3
WEIGHT = la.Linear(-18e3, (300.0, 2e3), at=(0.0, 1.0))  # N/m^3, heavier below
ROUND_OFF = 1e-12
PATHS = 1e-7  # two solves of the same program: each to the bar of the certificate, 1e-6, and closer


def clay(mesh, force=None, where=None, k=40e3, space="p2-vertex", **more):
    """A vertical cut: held below and at its back, free at its face and its top."""
    force = (0.0, WEIGHT) if force is None else force
    loads = force if isinstance(force, list) else [la.BodyForce("clay", force, where)]
    return la.Problem(
        {"clay": la.Body(mesh, la.VonMises(k), space=space, **more)},
        loads,
        [la.Fix("clay", "bottom"), la.Fix("clay", "right")],
    )


def layers(nx=4, ny=4):
    return la.meshes.layered((0, 2), {"low": (0, 0.5), "high": (0.5, 1)}, nx, ny)


def power(problem, velocity):
    """Of the reference load on a velocity, a function of places."""
    stated = discretise(problem)
    (dofs,) = stated.continua.values()
    nodes = np.zeros(stated.full.n)
    nodes[dofs.dofs] = velocity(dofs.nodes)
    return float(stated.full.reference_load @ nodes)


def moments(x, y, fx, fy):
    """Integrals of the linear WEIGHT times powers of x and y over a rectangle from 0, 0."""
    b, (p, q), (_, low) = WEIGHT.value, WEIGHT.gradient, WEIGHT.at

    def over(i, j):
        return x ** (i + 1) / (i + 1) * y ** (j + 1) / (j + 1)

    return (b - q * low) * over(fx, fy) + p * over(fx + 1, fy) + q * over(fx, fy + 1)


@pytest.mark.parametrize("space", ["p2-vertex", "p2-gauss", "p1-disc", "p2-disc", "q2"])
def test_power_of_a_linear_weight_is_exact(space):
    """On translations, rotations, and all of the quadratic velocities of a space."""
    make = la.meshes.quadrilaterals if space == "q2" else la.meshes.rectangle
    problem = clay(make((0, 2), (0, 1), 3, 2), space=space)
    for i, j in [(0, 0), (1, 0), (0, 1), *([(2, 0), (1, 1), (0, 2)] if "2" in space else [])]:

        def velocity(x, i=i, j=j):
            return np.stack([0 * x[0], x[0] ** i * x[1] ** j])

        exact = moments(2.0, 1.0, i, j)
        assert power(problem, velocity) == pytest.approx(exact, rel=ROUND_OFF)


@pytest.mark.parametrize("kinematics", ["plane_strain", "axisymmetric"])
def test_dead_weight_is_that_of_a_closed_form(kinematics):
    """A bowl of linear density, all around where it is one of revolution."""
    space = "p2-gauss" if kinematics == "axisymmetric" else "p2-vertex"
    mesh = la.meshes.rectangle((0, 2), (0, 1), 3, 2)
    supports = [la.Fix("clay", "bottom"), la.Fix("clay", "right"), la.Fix("clay", "left", "x")]
    body = la.Body(mesh, la.VonMises(1e3), space=space, kinematics=kinematics)
    problem = la.Problem({"clay": body}, [la.BodyForce("clay", (0, WEIGHT))], supports)
    found = power(problem, lambda x: np.stack([0 * x[0], 1 + 0 * x[0]]))
    around = kinematics == "axisymmetric"
    exact = 2 * np.pi * moments(2.0, 1.0, 1, 0) if around else moments(2.0, 1.0, 0, 0)
    assert found == pytest.approx(exact, rel=ROUND_OFF)


def by_regions():
    return [la.BodyForce("clay", (0, -HEAVY), "low"), la.BodyForce("clay", (0, -LIGHT), "high")]


def by_elements(mesh):
    values = np.full(mesh.nelements, -LIGHT)
    values[mesh.subdomains["low"]] = -HEAVY
    return (0, values)


def by_place(x):
    return np.where(x[1] < 0.5, -HEAVY, -LIGHT)


@pytest.mark.parametrize("space", ["p2-vertex", "p1-disc", "p2-disc"])
def test_one_weight_stated_in_four_ways_is_one(space):
    """By regions, by elements, by a function that jumps between elements, by a field."""
    mesh = layers()
    ways = [
        by_regions(),
        by_elements(mesh),
        (0, by_place),
        (0, -1 * la.Field(lambda x: -by_place(x))),
    ]
    loads = [discretise(clay(mesh, way, space=space)).full.reference_load for way in ways]
    for load in loads[1:]:
        assert np.abs(load - loads[0]).max() <= ROUND_OFF * np.abs(loads[0]).max()


def test_bounds_of_a_cut_in_two_layers_are_those_by_regions():
    """To what two solves of one program differ by; the gap is the sum of its shares."""
    mesh = layers()
    found = []
    for way in (by_regions(), by_elements(mesh), (0.0, by_place)):
        problem = clay(mesh, way)
        lower, upper = la.lower_bound(problem, throw=True), la.upper_bound(problem, throw=True)
        gap = la.gap_identity(upper, lower)
        assert gap.total == pytest.approx(upper.load_factor - lower.load_factor, rel=1e-6)
        assert gap.least >= -1e-7 * upper.load_factor
        found.append((lower.load_factor, upper.load_factor))
    assert found[1] == pytest.approx(found[0], rel=PATHS)
    assert found[2] == pytest.approx(found[0], rel=PATHS)


def test_values_of_elements_go_along_on_finer_meshes():
    """A bracket refines and keeps the load: it is that by regions, which meshes know."""
    mesh = layers(2, 2)
    stated = [clay(mesh, way) for way in (by_regions(), by_elements(mesh))]
    one, other = (la.bracket(p, target_width=0.2, max_elements=300) for p in stated)
    assert other.lower == pytest.approx(one.lower, rel=1e-5)  # solves are loose on the way
    assert other.upper == pytest.approx(one.upper, rel=1e-5)


def test_values_of_elements_go_along_where_meshes_are_made_to_match():
    """Two bonded halves whose edges do not match: elements are divided, their weights stay."""
    left = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    right = la.meshes.rectangle((1, 2), (0, 1), 3, 3)

    def bound(force):
        problem = la.Problem(
            {"left": la.Body(left, la.VonMises(40e3)), "right": la.Body(right, la.VonMises(40e3))},
            [la.BodyForce("left", (0, force)), la.BodyForce("right", (0, -LIGHT))],
            [la.Fix("left", "bottom"), la.Fix("right", "bottom"), la.Fix("right", "right")],
            [la.Interface(("left", "right"), ("right", "left"), la.BOND)],
        )
        return la.lower_bound(problem, throw=True).load_factor

    assert bound(np.full(left.nelements, -HEAVY)) == pytest.approx(bound(-HEAVY), rel=PATHS)


def test_what_bends_within_elements_has_no_bounds():
    bent = la.ByLevel([0.0, 0.6, 1.0], [-HEAVY, -LIGHT, -LIGHT])
    problem = clay(layers(), (0.0, bent))
    assert la.solve(problem).load_factor > 0
    with pytest.raises(la.InputError, match="not linear in each element"):
        la.upper_bound(problem)
    follows = la.meshes.layered((0, 2), {"low": (0, 0.6), "high": (0.6, 1)}, 4, 4)
    assert la.upper_bound(clay(follows, (0.0, bent))).load_factor > 0


def test_what_bends_is_stated_by_elements_as_its_message_says():
    """Off by the second order of an element: h^2/8 b'' of a weight b, here 1/128 of it at most."""

    def bent(x):
        return -HEAVY * np.exp(x[1])

    mesh = layers()
    with pytest.raises(la.InputError, match=r"force\(mesh.p\[:, mesh.t\].mean\(axis=1\)\)"):
        la.lower_bound(clay(mesh, (0.0, bent)))
    nearly = clay(mesh, (0.0, bent(mesh.p[:, mesh.t].mean(axis=1))))
    nearest = la.solve(clay(mesh, (0.0, bent))).load_factor
    assert la.solve(nearly).load_factor == pytest.approx(nearest, rel=1 / 128)
    below, above = la.lower_bound(nearly, throw=True), la.upper_bound(nearly, throw=True)
    assert below.load_factor <= above.load_factor


BLOCKS = {
    "low": [(0, 0), (2, 0), (2, 1), (0, 1)],
    "high": [(0, 1), (1, 1), (1, 2), (0.5, 2.5), (0, 2)],
}


def sliding(dead, push=(1.0, 0.0)):
    """Blocks on a rough plane, pushed at the lower one."""
    return la.Problem(
        {"wall": la.BlockAssembly(BLOCKS, friction=0.5)},
        [la.PointForce("wall", (2, 0.1), push)],
        interfaces=[
            la.Interface(("wall", lambda x: x[1] == 0), la.RigidObstacle((0, 0), (0, 1)), 0.4)
        ],
        dead_loads=[la.BodyForce("wall", dead)],
    )


def test_blocks_of_linear_density_slide_at_friction_times_weight():
    """Weights of rectangle, and of a gable that is cut into triangles, to the bar of a solve."""
    linear = la.Linear(-10.0, (1.0, 2.0))
    centroids = {"low": (1.0, 0.5, 2.0), "square": (0.5, 1.5, 1.0), "gable": (0.5, 2 + 1 / 6, 0.25)}
    weight = sum(area * (10.0 - x - 2 * y) for x, y, area in centroids.values())
    state = la.solve(sliding((0.0, linear)))
    assert state.load_factor == pytest.approx(0.4 * weight, rel=1e-6)


def test_blocks_take_a_value_each_as_loads_of_their_own():
    both = la.solve(sliding((0.0, [-3.0, -5.0])))
    assert both.load_factor == pytest.approx(0.4 * (3.0 * 2.0 + 5.0 * 1.25), rel=1e-6)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: la.BodyForce("clay", 3.0), "not a vector"),
        (lambda: la.BodyForce("clay", (0, 1e-70)), "BodyForce.vector = 1e-70: outside of"),
        (lambda: la.BodyForce("clay", (1.0, [1e-70, -1e70])), "BodyForce.vector = 1e.70: outside"),
        (lambda: la.BodyForce("clay", (0, "heavy")), "neither a number nor a function"),
        (lambda: la.BodyForce("clay", (0, [1.0, np.nan])), "of element 1"),
        (lambda: la.BodyForce("clay", (0, la.Field(WEIGHT, steepest=1.0))), "has to be linear"),
        (lambda: clay(layers(), (0, [1.0, 2.0])), "there are 64 elements"),
        (lambda: clay(layers(), (0, lambda x: x)), "does not return"),
        (lambda: clay(layers(), (0, lambda x: x[7])), "fails"),
        (lambda: clay(layers(), (0, lambda x: x[1] / 0)), "not a finite number"),
        (lambda: clay(layers(), (0, np.zeros(64))), "is zero"),
        (lambda: sliding((0, lambda x: x[1] ** 2)), "not linear in each block"),
    ],
)
def test_what_is_no_body_force_is_refused(make, said):
    with pytest.raises(la.InputError, match=said), np.errstate(divide="ignore", invalid="ignore"):
        make()


def test_what_turning_a_frame_leaves_of_a_zero_is_no_force_of_its_own():
    assert la.BodyForce("clay", (1.0, 1e-127, [0.0, 1e-70])).vector[1] == 1e-127
