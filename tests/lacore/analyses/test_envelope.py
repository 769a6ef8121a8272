"""Yield surfaces in several loads: between closed forms, proven from inside and outside."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.analyses.yield_surface.components import Components
from lacore.analyses.yield_surface.hulls import hulls
from lacore.reporting.kinds import Kind
from tests.lacore.models import deformable_block, square
from tests.lacore.shown import portal, unsafe, wall

H = [la.PointForce("portal", "B", (1, 0))]
V = [la.PointForce("portal", (2, 3), (0, -1))]


def footing(bond=la.BOND, nx=12, ny=5):
    """A rigid block of width 1 on clay of k = 1, free to turn; what acts on it is asked."""
    mesh = la.meshes.rectangle((-3, 3), (-1.5, 0), nx, ny)
    block = la.RigidBlock([(-0.5, 0), (0.5, 0), (0.5, 0.25), (-0.5, 0.25)])
    return la.Problem(
        {"soil": la.Body(mesh, la.VonMises(1.0)), "footing": block},
        VERTICAL,
        [la.Fix("soil", side) for side in ("bottom", "left", "right")],
        [la.Interface(("footing", lambda x: x[1] == 0), ("soil", "top"), bond)],
    )


VERTICAL = [la.PointForce("footing", (0, 0), (0, -1))]
ASIDE = [la.PointForce("footing", (0, 0), (1, 0))]
TURNING = [
    la.PointForce("footing", (-0.5, 0.0), (0, 1)),
    la.PointForce("footing", (0.5, 0.0), (0, -1)),
]


def green(h):
    """Vertical load of a strip footing beside a horizontal one, both per width and k (Green 1954).

    ``1 + pi/2 + arccos(h) + sqrt(1 - h^2)``: 2 + pi without h, half of it where the base slides.
    """
    return 1 + np.pi / 2 + np.arccos(abs(h)) + np.sqrt(1 - h * h)


def test_portal_frame_is_its_polygon():
    """M_p = 10, h = 3, span 4: sway 4 M_p/h, beam 8 M_p/L, and both, 3 H + 2 V = 6 M_p."""
    found = la.envelope(portal(), {"H": H, "V": V}, n=16)
    assert found.bounded
    assert found.width <= 1e-6  # the residuals of its states
    corners = [(40 / 3, 10), (20 / 3, 20), (-20 / 3, 20), (-40 / 3, 10)]
    for corner in corners:
        for sign in (1, -1):
            wanted = sign * np.array(corner)
            assert np.abs(found.outer - wanted).max(axis=1).min() <= 1e-4
            assert found.contains(tuple(0.999 * wanted)) is True
            assert found.contains(tuple(1.001 * wanted)) is False
    assert found.contains((0, 0)) is True
    # Nothing tells a load from its opposite: one direction counts for both.
    assert len(found.table) <= 8
    # That it needed no more is said.
    assert found.stop.kind is Kind.CORNERS_SOLVED
    assert f"ended after {len(found.table)} directions" in found.message
    assert found.polyhedral_width <= 1e-6
    figure = found.plot()
    figure.draw_without_rendering()
    assert figure._suptitle.get_window_extent().x1 <= figure.bbox.x1  # the title is there in full


def test_a_dead_load_moves_the_surface_by_itself():
    """The polygon of the portal, 5 kN less to the one side; asked from its middle, not from 0."""
    dead = [la.PointForce("portal", "B", (5, 0))]
    found = la.envelope(portal().with_loads(dead_loads=dead), {"H": H, "V": V}, n=24)
    for corner in [(40 / 3, 10), (20 / 3, 20), (-20 / 3, 20), (-40 / 3, 10)]:
        for sign in (1, -1):
            wanted = sign * np.array(corner) - (5, 0)
            assert np.abs(found.outer - wanted).max(axis=1).min() <= 1e-4
            assert np.abs(found.inner - wanted).max(axis=1).min() <= 1e-4
    assert (found.table["lower"] <= found.table["upper"]).all()


def test_each_mechanism_bounds_every_combination():
    """Planes of outer hold for load factors in directions that were never asked."""
    found = la.envelope(portal(), {"H": H, "V": V}, n=5)
    rng = np.random.default_rng(1)
    for way in rng.normal(size=(6, 2)):
        loads = [la.PointForce("portal", "B", (way[0], 0))]
        loads.append(la.PointForce("portal", (2, 3), (0, -way[1])))
        alpha = la.solve(portal().with_loads(loads)).load_factor
        assert found.contains(tuple(0.9999 * alpha * way)) is not False
        assert found.contains(tuple(1.0001 * alpha * way)) is not True


@pytest.mark.slow
def test_a_footing_that_may_turn_contains_the_points_of_green():
    found = la.envelope(footing(), {"V": VERTICAL, "H": ASIDE}, n=24, target_width=0.012)
    assert len(found.table) == 24
    assert found.width <= 0.02
    assert "strict bounds of the continuum" in found.rigor
    for h in np.linspace(-1, 1, 41):
        for sign in (1, -1):
            point = np.array([sign * green(h), h])
            assert found.contains(tuple(point)) is not False
            assert found.contains(tuple(0.98 * point)) is True
            assert found.contains(tuple(1.02 * point)) is False


@pytest.mark.slow
def test_vertical_horizontal_moment():
    """The surface of a footing on clay in three components, of bounds on one coarse mesh."""
    loads = {"V": VERTICAL, "H": ASIDE, "M": TURNING}
    found = la.envelope(footing(nx=12, ny=4), loads, n=20)
    assert found.bounded
    assert found.inner.shape[1] == found.outer.shape[1] == 3
    for h in (0.0, 0.5, 1.0):
        assert found.contains((green(h), h, 0.0)) is not False
        assert found.contains((-green(h), h, 0.0)) is not False
    assert found.contains((1.0, 0.2, 0.1)) is True
    assert found.contains((0.0, 0.0, 2.0)) is False  # more than a footing on scoops carries


@pytest.mark.slow
def test_moment_and_horizontal_load_beside_a_weight():
    """A plane of the surface in three components: the third is a dead load."""
    weight = [la.PointForce("footing", (0, 0), (0, -2.5))]
    loads = {"H": ASIDE, "M": TURNING}
    found = la.envelope(footing().with_loads(ASIDE, weight), loads, n=24, target_width=0.012)
    assert len(found.table) == 24
    assert found.width <= 0.02
    assert "strict bounds of the continuum" in found.rigor
    assert found.contains((0.99, 0.0)) is not False  # Green: V = 2.5 is beside it with H = 1
    assert found.contains((1.001, 0.0)) is False


def test_the_width_is_that_of_bounds_and_that_of_corners():
    """Both as factors make up at least the whole, and neither is more than it."""
    loads = {"V": VERTICAL, "H": ASIDE}
    found = la.envelope(footing(nx=12, ny=2), loads, n=5)
    assert found.stop is None
    assert max(found.bound_width, found.polyhedral_width) <= found.width * (1 + 1e-9)
    both = (1 + found.bound_width) * (1 + found.polyhedral_width)
    assert 1 + found.width <= both * (1 + 1e-9)
    ratios = found.table["upper"] / found.table["lower"]
    assert 0 < found.bound_width <= (ratios.max() - 1) * (1 + 1e-9)


def test_two_directions_at_a_time_find_what_one_does():
    loads = {"V": VERTICAL, "H": ASIDE}
    one, two = (la.envelope(footing(nx=12, ny=1), loads, n=5, jobs=jobs) for jobs in (1, 2))
    assert np.array_equal(one.planes, two.planes)
    assert np.array_equal(one.inner, two.inner)


def senses(problem, loads):
    return Components(problem, loads).senses.tolist()


def test_mirrors_are_found_where_the_structure_is_its_image():
    """In an upright mirror H and M are their opposites, V is itself."""
    coarse = footing(nx=6, ny=2)
    loads = {"V": VERTICAL, "H": ASIDE, "M": TURNING}
    assert senses(coarse, loads) == [[1, 1, 1], [1, -1, -1], [-1, 1, 1], [-1, -1, -1]]
    beside = {"H": ASIDE, "M": TURNING}
    middle, aside = ([la.PointForce("footing", (x, 0), (0, -2.5))] for x in (0, 0.1))
    assert senses(coarse.with_loads(ASIDE, middle), beside) == [[1, 1], [-1, -1]]
    assert senses(coarse.with_loads(ASIDE, aside), beside) == [[1, 1]]


def test_images_are_carried_alike():
    """Bounds along a direction and its image, each solved: to the tolerance of the solver."""
    components = Components(footing(nx=6, ny=2), {"V": VERTICAL, "H": ASIDE, "M": TURNING})
    ways = components.senses * np.array([1.0, 0.4, 0.3])
    found = [la.upper_bound(components.problem_at(np.zeros(3), way)).load_factor for way in ways]
    assert found == pytest.approx([found[0]] * 4, rel=1e-5)


def on(problem, **changes):
    """With another clay."""
    clay = replace(problem.bodies["soil"], **changes)
    return replace(problem, bodies={**problem.bodies, "soil": clay})


def halves(own):
    """Clay that is stronger on the right: uniform in each region, and as its mesh on both sides."""
    clay = own.bodies["soil"]
    left = clay.mesh.p[0, clay.mesh.t].mean(axis=0) < 0
    mesh = clay.mesh.with_subdomains({"left": np.flatnonzero(left), "right": np.flatnonzero(~left)})
    strengths = {"left": la.VonMises(1.0), "right": la.VonMises(1.5)}
    return replace(own, bodies={**own.bodies, "soil": la.Body(mesh, strengths)})


def lying(own, *strengths):
    """The clay on a floor, to which it sticks left and right with strengths of their own."""
    floor = la.RigidObstacle((0.0, -1.5), (0.0, 1.0))
    sides = (lambda x: (x[1] == -1.5) & (x[0] < 0), lambda x: (x[1] == -1.5) & (x[0] > 0))
    held = [
        la.Interface(("soil", side), floor, la.Tresca(strength))
        for side, strength in zip(sides, strengths, strict=True)
    ]
    return replace(own, supports=own.supports[1:], interfaces=[*own.interfaces, *held])


def test_contact_is_its_image_if_its_laws_are():
    loads = {"V": VERTICAL, "H": ASIDE}
    assert senses(lying(footing(), 0.3, 0.3), loads) == [[1, 1], [1, -1]]
    assert senses(lying(footing(), 0.3, 0.6), loads) == [[1, 1]]


ONE_SIDED = {
    "regions": halves,
    "support": lambda own: replace(own, supports=own.supports[:2]),
    "strength that varies": lambda own: on(own, criterion=la.VonMises(lambda x: 1 + x[0] / 9)),
    "mesh": lambda own: on(own, mesh=la.meshes.rectangle((-3, 3.5), (-1.5, 0), 13, 2)),
    "footing": lambda own: replace(
        own, bodies={**own.bodies, "footing": la.RigidBlock(CORNERS + np.array([0.5, 0.0]))}
    ),
}
CORNERS = np.array([(-0.5, 0), (0.5, 0), (0.5, 0.25), (-0.5, 0.25)])


@pytest.mark.parametrize("changed", ONE_SIDED)
def test_what_is_no_image_of_itself_has_no_mirror(changed):
    loads = {"V": [la.PointForce("footing", (0.25, 0), (0, -1))], "H": ASIDE}
    if changed != "footing":
        loads["V"] = VERTICAL
    assert senses(ONE_SIDED[changed](footing(nx=12, ny=2)), loads) == [[1, 1], [-1, -1]]


def test_coulomb_friction_gives_points():
    """A stone wall: what lies between its certified states is not said."""
    stone = wall()
    loads = {"push": [la.BodyForce("wall", (1, 0))], "load": [la.BodyForce("wall", (0, -1))]}
    found = la.envelope(stone, loads, n=8)
    assert not found.convex
    assert found.contains((0, 0)) is None
    assert len(found.planes) == len(found.outer) == 0
    solved = found.table[found.table["status"] == "solved"]
    assert len(found.inner) == len(solved) > 4
    # Sliding: |push| <= mu (1 + load), mu = .65, wherever it does not topple.
    for push, load in found.inner:
        assert abs(push) <= 0.65 * (1 + load) * (1 + 1e-6) + 1e-6


def test_what_is_locked_is_unbounded():
    """A dilatant wall carries its own weight any number of times."""
    stone = wall(la.Coulomb(0.65, associated=True))
    loads = {"push": [la.BodyForce("wall", (1, 0))], "load": [la.BodyForce("wall", (0, -1))]}
    found = la.envelope(stone, loads, n=8)
    assert found.convex
    assert not found.bounded
    assert found.width == np.inf
    assert Kind.UNBOUNDED in [own.kind for own in found.findings]
    assert found.contains((0.6, 0.0)) is True
    assert found.contains((0.7, 0.0)) is False
    assert found.contains((0.0, -1.1)) is False  # more than lifts it


REFUSED = {
    "one component": ({"H": H}, "not two or three components"),
    "the same twice": ({"H": H, "2 H": [la.PointForce("portal", "B", (2, 0))]}, "combination"),
    "on a support": (
        {"H": H, "V": [la.PointForce("portal", "A", (0, -1))]},
        r"loads\['V'\]: reference_loads: they do no power",
    ),
    "nothing": ({"H": H, "V": []}, "there is none"),
    "no such node": ({"H": H, "V": [la.PointForce("portal", "X", (0, -1))]}, "known names"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_components_that_are_none_are_refused_before_any_solve(case, monkeypatch):
    monkeypatch.setattr("lacore.analyses.yield_surface.search.solve", None)
    loads, said = REFUSED[case]
    with pytest.raises(la.InputError, match=said):
        la.envelope(portal(), loads)


def test_pressure_that_an_incompressible_body_takes_does_no_power(monkeypatch):
    """All around a clay: its mean stress carries it, whatever moves."""
    monkeypatch.setattr("lacore.analyses.yield_surface.search.lower_bound", None)
    problem = la.Problem(
        {"block": square()},
        [la.Traction("block", "top", (1, 0))],
        [la.Fix("block", "bottom")],
    )
    around = [la.Pressure("block", side) for side in ("left", "right", "top")]
    shear = [la.Traction("block", "top", (1, 0))]
    with pytest.raises(la.InputError, match="keeps volumes"):
        la.envelope(problem, {"p": around, "t": shear})


def test_footings_that_cannot_turn_are_refused():
    under = [la.RigidFooting("block", "top", (0, -1))]
    push = [la.Traction("block", "left", (1, 0))]
    with pytest.raises(la.InputError, match="neither turns"):
        la.envelope(deformable_block(la.Tresca(0.3)), {"V": under, "H": push})


def test_dead_loads_that_fall_have_no_envelope():
    loads = {"push": [la.BodyForce("wall", (1, 0))], "load": [la.BodyForce("wall", (0, -1))]}
    with pytest.raises(la.InputError, match="alone collapse"):
        la.envelope(unsafe(), loads)


def test_a_mesh_too_coarse_for_its_dead_loads_does_not_make_them_fall():
    """These carry a weight of 3.15 of a cut with k = h = 1, which falls above 3.7."""
    cut = la.Body(la.meshes.rectangle((0, 3), (0, 1), 3, 1), la.VonMises(shear_strength=1.0))
    problem = la.Problem(
        {"cut": cut, "block": square()},
        PUSHED["V"],
        [la.Fix("cut", "left"), la.Fix("cut", "bottom"), la.Fix("block", "left")],
        dead_loads=[la.BodyForce("cut", (0, -3.5))],
    )
    assert la.lower_bound(problem).status is la.Status.UNSAFE
    assert la.stable(problem).stands is None
    found = la.envelope(problem, PUSHED, n=5)
    assert found.table["lower"].isna().all()
    assert found.table["upper"].notna().all()
    assert "strict bounds" not in found.rigor  # with none below
    assert found.contains((0, 0)) is None


PUSHED = {
    "V": [la.Traction("block", "right", (0, -1))],
    "H": [la.Traction("block", "right", (1, 0))],
}


def test_cells_of_joints_that_crush_have_points_and_no_outer_side():
    """One cell a corner carries 0.2 of the weight sideways, where pressures carry 0.32."""
    stone = {"block": (0.4, 0.2, 1.0), "crushing": la.Crushing(1e5, divisions=1)}
    problem = la.Problem(
        {"pier": la.masonry3d.wall([[1]], friction=la.Tresca(1e4), **stone)},
        [la.BodyForce("pier", (20e3, 0, 0))],
        [la.Fix("pier", "base")],
        dead_loads=[la.BodyForce("pier", (0, 0, -20e3))],
    )
    loads = {
        axis: [la.BodyForce("pier", 20e3 * way)]
        for axis, way in zip("xy", np.eye(2, 3), strict=True)
    }
    found = la.envelope(problem, loads, n=8)
    assert found.contains((0.3, 0.0)) is not False
    assert "exact" not in found.rigor


def test_the_width_is_where_both_are_farthest_apart():
    """A diamond in a square with one corner cut off: at the others twice as far from the middle."""
    diamond = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    normals = np.concatenate([diamond, [[1.0, 1.0]]])
    between = hulls(diamond, normals, np.ones(5), np.zeros(2))
    assert between.bounded
    assert len(between.outer) == 5
    assert sorted(between.gauge) == pytest.approx([1, 1, 2, 2, 2])
    assert between.width == pytest.approx(1.0)
