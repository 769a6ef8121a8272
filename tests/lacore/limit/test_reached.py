"""The mechanism of a soil that comes to where it is held is told, with the name of the boundary."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.limit import advice
from lacore.limit.advice import with_ground_beyond
from lacore.limit.solve import solve
from lacore.model.bodies.continuum.forces import force
from lacore_verification.catalogue.catalogue import catalogue, find


def told(problem):
    """The message of a state, with the advice on more ground."""
    state = la.solve(problem)
    return "; ".join([state.message, *map(str, la.advice(state))])


def strip(width, depth, nx=16, ny=9, angle=20.0, bottom="xy"):
    """Half of a smooth footing, 2 m wide; Hill's mechanism at 20 degrees is 3.6 m by 1.2 m."""
    mesh = la.meshes.rectangle(
        x=(0, width), y=(-depth, 0), nx=nx, ny=ny, grade_x=(1.0, 5.0), grade_y=(0.0, 2.5)
    ).with_boundaries({"under": lambda x: (x[1] > -1e-9) & (x[0] < 1)})
    return la.Problem(
        {"soil": la.Body(mesh, la.MohrCoulomb(1.0, angle))},
        [la.RigidFooting("soil", "under", (0, -1), rough=False)],
        supports=[
            la.Fix("soil", "left", "x"),
            la.Fix("soil", "right"),
            la.Fix("soil", "bottom", bottom),
        ],
    )


@pytest.mark.parametrize(
    ("box", "names"),
    [
        ((4.0, 1.4), []),  # a tenth to spare
        ((4.0, 0.7), ["soil.bottom"]),
        ((2.5, 1.4), ["soil.right"]),
    ],
)
def test_a_box_that_is_too_small_is_named(box, names):
    message = told(strip(*box))
    assert ("the mechanism reaches" in message) == bool(names)
    for side in ("soil.left", "soil.right", "soil.bottom"):
        assert (side in message) == (side in names)


@pytest.mark.parametrize("depth", [0.5, 3.0])
def test_bounds_and_factors_of_safety_name_it_too(depth):
    """Both ends of a factor are those of the box: in deeper ground the footing stands by less."""
    problem = strip(5.0, depth, nx=10, ny=4)
    told = "the mechanism reaches soil.bottom" * (depth < 1)
    assert told in la.upper_bound(problem).message
    factor = la.safety_factor(problem, tolerance=0.3)
    assert factor.note.startswith(told)
    assert ("note" in repr(factor)) == bool(told)


def test_a_solve_asks_for_no_advice(monkeypatch):
    def refuse(problem):
        raise AssertionError("a larger problem is solved")

    monkeypatch.setattr(advice, "_associated", refuse)
    state = la.solve(strip(4.0, 1.4, nx=8, ny=5))
    with pytest.raises(AssertionError, match="a larger problem is solved"):
        la.advice(state)


def test_more_ground_is_all_that_is_solved_besides(monkeypatch):
    """Of an associated problem the load is known, and only the larger one is not."""
    asked = []

    def counted(problem):
        asked.append(problem)
        return solve(problem, coupling="associated").load_factor

    monkeypatch.setattr(advice, "_associated", counted)
    problem = strip(4.0, 1.4, nx=8, ny=5)
    assert "reaches" not in told(problem)
    (larger,) = asked
    assert larger.bodies["soil"].mesh.nelements > problem.bodies["soil"].mesh.nelements


def test_coarse_elements_beside_a_support_say_little():
    """Any motion ends in the last of them."""
    assert "reaches" not in told(strip(4.0, 1.4, nx=5, ny=2))


@pytest.mark.parametrize("cells", [(3, 2), (5, 2), (8, 5)])  # (3, 2): finer ones acquit
@pytest.mark.parametrize(
    ("box", "names"),
    [((4.0, 1.4), []), ((2.5, 1.4), ["soil.right"]), ((4.0, 0.7), ["soil.bottom"])],
)
def test_more_ground_tells_of_a_box_on_coarse_meshes_too(box, names, cells):
    message = told(strip(*box, *cells))
    for side in ("soil.right", "soil.bottom"):
        assert (f"the mechanism reaches {side}" in message) == (side in names)


def test_more_ground_on_the_same_mesh_carries_no_more():
    """Its velocities are among those of the larger one, with weight, water and a surcharge, too."""
    soil = strip(2.5, 1.4, 5, 2)
    beside = la.Pressure("soil", lambda x: (x[1] > -1e-9) & (x[0] > 1), 0.5)
    water = la.PorePressure("soil", la.WaterTable(-1.4, 1.0))
    wet = soil.with_loads(dead_loads=[beside, water, la.BodyForce("soil", (0, -1))])
    _, right, _ = wet.supports
    larger = with_ground_beyond(wet, right, np.array([0.5, 0.0]))
    body = larger.bodies["soil"]
    assert body.box[1][0] == 3.0
    far = la.discretise(larger).continua["soil"]
    surcharge = force(larger.dead_loads[0], far.velocity).sum()
    assert surcharge == pytest.approx(-0.5 * 2.0)  # 1 m to 3 m
    assert la.solve(larger).load_factor < la.solve(wet).load_factor


def test_more_ground_is_of_the_region_beside_it():
    soil = strip(2.5, 1.4, 5, 2)
    mesh = soil.bodies["soil"].mesh
    upper = mesh.p[1, mesh.t].mean(axis=0) > -0.5
    named = mesh.with_subdomains({"sand": np.flatnonzero(upper), "clay": np.flatnonzero(~upper)})
    layered = la.Body(named, {"sand": la.MohrCoulomb(1.0, 20.0), "clay": la.VonMises(2.0)})
    problem = replace(soil, bodies={"soil": layered})
    larger = with_ground_beyond(problem, problem.supports[1], np.array([0.5, 0.0]))
    mesh = larger.bodies["soil"].mesh
    upper = mesh.p[1, mesh.t].mean(axis=0) > -0.5
    assert set(mesh.subdomains["sand"]) == set(np.flatnonzero(upper))


def test_no_ground_is_put_where_a_load_ends_or_a_body_goes_on():
    soil = strip(2.5, 1.4, 5, 2)
    left, *_ = soil.supports
    step = np.array([0.5, 0.0])
    assert with_ground_beyond(soil, left, -step) is None  # the footing begins there
    assert with_ground_beyond(soil, la.Fix("soil", "bottom"), np.array([0.0, 0.3])) is None


@pytest.mark.parametrize("cells", [(5, 2), (16, 9)])
@pytest.mark.parametrize(("width", "reached"), [(4.0, False), (3.0, True)])
def test_rollers_at_the_end_of_a_box_are_named_on_any_mesh(cells, width, reached):
    """Nothing holds the soil back along them, so that coarse elements show it moving, too."""
    problem = strip(width, 1.4, *cells)
    left, _, bottom = problem.supports
    rolling = replace(problem, supports=[left, la.Fix("soil", "right", "x"), bottom])
    message = la.solve(rolling).message
    assert ("soil.right: unless this is a plane of symmetry" in message) == reached
    assert "soil.left" not in message  # where the footing begins


def test_a_smooth_base_of_a_box_is_named():
    message = la.solve(strip(4.0, 0.7, bottom="y")).message
    assert "reaches soil.bottom: unless this is a plane of symmetry" in message


def test_planes_of_symmetry_of_a_block_are_no_box():
    """They do not face each other, and soil slides along both."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 0.5), nx=4, ny=2)
    quarter = la.Problem(
        {"block": la.Body(mesh, la.MohrCoulomb(1.0, 30.0))},
        [la.RigidFooting("block", "top", (0, -1))],
        supports=[la.Fix("block", "left", "x"), la.Fix("block", "bottom", "y")],
    )
    assert "reaches" not in la.solve(quarter).message


def test_sides_that_hold_no_motion_across_them_are_no_box():
    """A layer in simple shear grows at its sides, which are held along themselves."""
    case, (variant, *_) = find("simple-shear-layer:phi-20")
    message = la.solve(case.problem(variant, "medium"), coupling="associated").message
    assert "reaches layer.bottom: if the material continues" in message
    assert "layer.left" not in message


_SOILS = [
    (name, variant.name)
    for name, case in catalogue().items()
    if case.surfaces
    for variant in case.variants
    if (name, variant.name[:3]) != ("simple-shear-layer", "phi")  # it shears on its base
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "variant"), _SOILS)
def test_no_case_of_the_catalogue_is_told_that_it_is_too_small(name, variant):
    case, (found,) = find(f"{name}:{variant}")
    problem = case.problem(found, next(iter(case.meshes)))
    assert "reaches" not in la.solve(problem, coupling="associated").message


@pytest.mark.parametrize(
    ("box", "names"),
    [
        ((4.0, 1.4), []),  # Hill's mechanism in clay is 2 m by 0.7 m
        ((4.0, 0.4), ["soil.bottom"]),
        ((1.3, 1.4), ["soil.right"]),
    ],
)
def test_clay_is_told_of_its_box_too(box, names):
    message = la.solve(strip(*box, nx=10, ny=6, angle=0.0)).message
    for side in ("soil.left", "soil.right", "soil.bottom"):
        assert (f"the mechanism reaches {side}" in message) == (side in names)


def test_a_plate_ends_at_its_supports():
    mesh = la.meshes.rectangle((0, 2), (0, 1), 8, 4)
    plate = la.Problem(
        {"plate": la.Body(mesh, la.VonMises(1.0), kinematics="plane_stress")},
        [la.Traction("plate", "right", (0, -1))],
        [la.Fix("plate", "left")],
    )
    assert "reaches" not in la.solve(plate).message


def test_contact_that_begins_at_rollers_makes_them_a_plane_of_symmetry():
    """Half of a block pressed onto clay, between two sides that hold it across."""
    clay = strip(2.0, 1.4, nx=8, ny=5, angle=0.0).bodies["soil"]
    block = la.RigidBlock([(0, 0), (1, 0), (1, 1), (0, 1)])
    problem = la.Problem(
        {"soil": clay, "block": block},
        [la.PointForce("block", (0.5, 0.5), (0, -1))],
        [
            *(la.Fix("soil", side, "x") for side in ("left", "right")),
            la.Fix("soil", "bottom"),
            la.Fix("block", lambda x: x[0] == 0, "x"),
        ],
        interfaces=[la.Interface(("soil", "under"), ("block", lambda x: x[1] == 0), la.SMOOTH)],
    )
    assert "soil.left" not in la.solve(problem).message


def test_a_bracket_tells_it_too():
    tight = la.bracket(strip(4.0, 0.7, nx=8, ny=4), target_width=0.3)
    assert "the mechanism reaches soil.bottom" in tight.message
