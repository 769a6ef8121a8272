"""Adaptive brackets: sides, targets and limits, what they are made of, and what is refused."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from skfem import MeshTri

import lacore as la
from lacore.bounds.bracket import asking
from lacore.bounds.bracket.bracket import crossing
from lacore.bounds.bracket.marking import lower_shares, upper_shares
from lacore.bounds.bracket.same_domain import difference
from lacore.bounds.bracket.singular_points import singular_points
from lacore.model.meshes.checks import quality
from lacore.model.meshes.fans import fanned
from lacore.model.meshes.refinement import bisected, doerfler, grown
from tests.lacore.models import CRITERION, cantilever, deformable_block, punch
from tests.lacore.random_continua import delaunay_square
from tests.shares import one_in

PRANDTL = 2 + pi
CUT = (3.77, 3.78)  # gamma H/k of a vertical cut (Pastor, Thai & Francescato 2000)


def cut(nx=6, ny=4):
    """A vertical cut of height 1 above a stratum of depth 1, under its weight."""
    mesh = la.meshes.rectangle((0, 3), (-2, 0), nx, ny)
    x, y = mesh.p[:, mesh.t].mean(axis=1)
    soil = MeshTri(*_kept(mesh, ~((x < 1) & (y > -1)))).with_boundaries(
        {
            "left": lambda x: x[0] == 0,
            "right": lambda x: x[0] == 3,
            "bottom": lambda x: x[1] == -2,
        }
    )
    return la.Problem(
        {"soil": la.Body(soil, CRITERION)},
        [la.BodyForce("soil", (0, -1))],
        [la.Fix("soil", "bottom"), la.Fix("soil", "right"), la.Fix("soil", "left", "x")],
    )


def _kept(mesh, elements):
    kept = mesh.restrict(np.flatnonzero(elements))
    return kept.p, kept.t


def even_punch():
    """Unlike `punch` without grading: refinement has to find the edge of the footing."""
    mesh = la.meshes.rectangle((0, 4), (-2, 0), 8, 4)
    stated = punch(rough=False)
    return la.Problem({"soil": la.Body(mesh, CRITERION)}, stated.reference_loads, stated.supports)


def on(problem, mesh):
    """The same problem on another mesh."""
    return la.Problem(
        {name: la.Body(mesh, CRITERION) for name in problem.bodies},
        problem.reference_loads,
        problem.supports,
    )


def proven(found):
    """The bracket as it must be, whatever its width; returns it."""
    history = found.history
    assert found.lower <= found.upper
    assert found.strict
    assert found.lower_bound.certificate.equilibrium <= 1e-12
    assert found.upper_bound.divergence <= 1e-12
    assert found.lower == np.nanmax(history.solved[history.bound == "lower"])
    assert found.upper == np.nanmin(history.solved[history.bound == "upper"])
    assert history.lower.is_monotonic_increasing
    assert history.upper.is_monotonic_decreasing
    assert history.seconds.is_monotonic_increasing
    assert found.width == pytest.approx(history.width.iloc[-1])
    identity = found.gaps()
    # Round-off of a sum of a thousand terms; the mesh of the gaps is that of the upper bound.
    assert identity.total == pytest.approx(identity.upper - identity.lower, rel=1e-5)
    assert identity.least >= -1e-9
    assert identity.upper == found.upper
    return found


def test_punch_with_a_fan_by_itself():
    steps = []
    found = proven(la.bracket(even_punch(), 0.03, on_step=steps.append))
    assert found.status is la.Ending.REACHED
    assert found.width <= 0.03
    assert found.lower <= PRANDTL <= found.upper
    assert len(steps) == len(found.history)
    assert [step.elements for step in steps] == found.history.elements.tolist()
    assert found.history.elements.max() < 700  # half of what even meshes of order 0.4 would need


def test_punch_from_a_fan_by_hand():
    fan = la.meshes.fan((0, 4), (-2, 0), (1, 0), 24, 4, crossed=False)
    found = proven(la.bracket(even_punch(), 0.02, lower_mesh=fan))
    assert found.status is la.Ending.REACHED
    assert found.history.elements.max() < 500


@pytest.mark.parametrize("meshes", one_in(2, ["separate", "shared"]))
def test_cut(meshes):
    found = proven(la.bracket(cut(), 0.05, meshes=meshes))
    assert found.status is la.Ending.REACHED
    assert found.lower < CUT[1]
    assert found.upper > CUT[0]
    assert found.history.elements.max() < 1000


def test_one_mesh_has_its_gap_already():
    """A lower bound that comes last may find the target reached before the upper one starts."""
    found = la.bracket(even_punch(), 0.1, meshes="shared")
    assert found.one_mesh == (found.history.bound.iloc[-1] == "upper")
    one, other = found.history.elements.iloc[-2:]
    assert (one == other) == found.one_mesh


def test_corners_that_stresses_cannot_fill_are_split():
    """Tractions on both sides of a corner that one element fills."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2, crossed=False)
    stated = la.Problem(
        {"block": la.Body(mesh, CRITERION)},
        [la.Traction("block", "right", (1, 0.5)), la.Traction("block", "top", (0, 1))],
        [la.Fix("block", "left"), la.Fix("block", "bottom")],
    )
    with pytest.raises(la.InputError, match="two shear stresses in one place"):
        la.lower_bound(stated)
    found = proven(la.bracket(stated, 0.2))
    assert found.status is la.Ending.REACHED


@pytest.mark.parametrize("backend", ["cvxpy"])
def test_other_backends(backend):
    one, other = (la.bracket(cut(3, 2), 0.3, backend=b) for b in ("clarabel", backend))
    assert other.status is la.Ending.REACHED
    # Each from its own side; shares differ by what tolerances leave, and with them meshes.
    assert other.lower < one.upper
    assert one.lower < other.upper


@pytest.mark.parametrize(
    ("limits", "ending"),
    [
        ({"max_elements": 450}, la.Ending.MAX_ELEMENTS),
        ({"time_limit": 1e-6}, la.Ending.TIME_LIMIT),
    ],
)
def test_a_target_that_is_not_reached_is_not_hidden(limits, ending):
    found = la.bracket(even_punch(), 1e-3, **limits)
    assert found.status is ending
    assert "not reached" in found.status.value
    assert found.width > 1e-3
    assert found.lower <= PRANDTL <= found.upper
    if "max_elements" in limits:
        assert found.history.elements.max() <= limits["max_elements"]


@pytest.mark.parametrize("meshes", ["separate", "shared"])
@pytest.mark.parametrize("factor", one_in(3, [0.5, 0.999, -1.0]))
def test_bounds_that_cross_prove_nothing(monkeypatch, meshes, factor):
    """Whatever the cause, such as an upper bound that is too low, here planted."""

    def too_low(state):
        found = la.upper_bound(state)
        return replace(found, load_factor=factor * la.lower_bound(even_punch()).load_factor)

    monkeypatch.setattr(asking, "upper_bound", too_low)
    found = la.bracket(even_punch(), 0.03, meshes=meshes)
    assert found.status is la.Ending.CROSSED
    assert not found.strict
    assert found.lower > found.upper
    assert "lower bound" in found.failure
    assert "width" in found.failure
    assert f"above upper bound {found.upper:.9g}" in found.failure
    assert len(found.history) == 2
    if meshes == "shared":
        assert "crossed" in found.plot().get_suptitle()


def test_bounds_that_touch_within_round_off_do_not_cross():
    """Both exact: they may lie either way by the round-off of their sums."""
    stated = deformable_block(la.Tresca(0.4), n=2)
    lower, upper = la.lower_bound(stated), la.upper_bound(stated)
    assert not crossing(lower, upper)
    for share, crosses in ((1e-12, False), (1e-8, True)):
        above = replace(lower, load_factor=upper.load_factor * (1 + share))
        assert bool(crossing(above, upper)) is crosses
    unsolved = replace(upper, status=la.Status.NOT_CERTIFIED)
    assert not crossing(lower, unsolved)


def test_picture_of_gaps():
    found = la.bracket(even_punch(), 0.1)
    figure = found.plot()
    upper, lower = (axes.collections[0] for axes in figure.axes if axes.get_xlabel() == "x [m]")
    assert "reached" in figure.get_suptitle()
    assert len(upper.get_paths()) == found.gaps().elements["soil"].size
    assert len(lower.get_paths()) == found.lower_bound.model.n_elements


def test_exact_at_once():
    """A block that slides: both bounds are exact but for the margin off strengths."""
    found = la.bracket(deformable_block(la.Tresca(0.4), n=2), 1e-3)
    assert found.status is la.Ending.REACHED
    assert found.lower <= 1.6 <= found.upper
    assert found.width < 1e-3
    assert len(found.history) == 2


def test_too_heavy_to_stand():
    stated = cantilever()
    heavy = la.Problem(
        stated.bodies,
        stated.reference_loads,
        stated.supports,
        dead_loads=[la.BodyForce("block", (0, -10.0))],
    )
    found = la.bracket(heavy)
    assert found.status is la.Ending.NO_BOUND
    assert "upper bound: unsafe" in found.failure
    assert found.lower == -np.inf
    assert found.upper == np.inf
    assert found.width == np.inf
    with pytest.raises(ValueError, match="no gap to look at"):
        found.plot()


@pytest.mark.parametrize(
    ("stated", "arguments", "words"),
    [
        (punch, {"target_width": 0.0}, "target_width = 0.0"),
        (punch, {"target_width": np.nan}, "target_width"),
        (punch, {"target_width": 5}, "target_width = 5: .*give 0.05 for 5 %"),
        (punch, {"time_limit": -1.0}, "time_limit"),
        (punch, {"max_elements": 20}, "the mesh of both bounds starts with 96 elements"),
        (
            punch,
            {"max_elements": 20, "meshes": "separate"},
            "the mesh of the upper bound starts with 96 elements",
        ),
        (punch, {"meshes": "one"}, "meshes = 'one'"),
        (
            punch,
            {"meshes": "shared", "lower_mesh": la.meshes.rectangle((0, 4), (-2, 0), 2, 2)},
            "one mesh only",
        ),
        (lambda: "punch", {}, "give a lacore.Problem"),
        (lambda: deformable_block(0.3), {"meshes": "shared"}, "two problems"),
    ],
)
def test_what_is_refused(stated, arguments, words):
    with pytest.raises(la.InputError, match=words):
        la.bracket(stated(), **arguments)


SQUARE = la.meshes.rectangle((0, 1), (0, 1), 4, 4)


def hanging(mesh):
    """A block that its weight pulls off a plate, along a smooth wall."""
    return la.Problem(
        {"b": la.Body(mesh, CRITERION)},
        [la.BodyForce("b", (0, 1))],
        [la.Fix("b", "left", "x"), la.Fix("b", "bottom", "y")],
    )


def renamed(mesh, **names):
    """The mesh with some of its boundaries under names of others."""
    known = mesh.boundaries
    return mesh.with_boundaries({name: known[names.get(name, name)] for name in known})


def slit(mesh):
    """The mesh, cut open along y = 1/2 from the right to the middle."""
    p, t = mesh.p, mesh.t.copy()
    cut = np.flatnonzero((p[1] == 0.5) & (p[0] > 0.5))
    above = np.flatnonzero(p[1, t].mean(axis=0) > 0.5)
    for number, vertex in enumerate(cut.tolist()):
        t[:, above] = np.where(t[:, above] == vertex, p.shape[1] + number, t[:, above])
    sides = {
        "left": lambda x: x[0] == 0,
        "right": lambda x: x[0] == 1,
        "bottom": lambda x: x[1] == 0,
        "top": lambda x: x[1] == 1,
    }
    return MeshTri(np.concatenate([p, p[:, cut]], axis=1), t).with_boundaries(sides)


@pytest.mark.parametrize(
    ("other", "words"),
    [
        (la.meshes.rectangle((0, 1), (0, 0.5), 4, 4), "area of 0.5 against 1 "),
        (la.meshes.rectangle((0, 1), (0, 0.99), 4, 4), "area of 0.99 against 1 "),
        (la.meshes.rectangle((0, 1), (0, 1 - 1e-9), 4, 4), "1e-09 not in both"),
        (la.meshes.rectangle((0, 2), (0, 1), 4, 4), "area of 2 against 1 "),
        (la.meshes.rectangle((0.25, 1.25), (0, 1), 4, 4), "area of 1 against 1 "),
        (slit(SQUARE), "its boundary lies elsewhere"),
        (renamed(SQUARE, left="right", right="left"), "boundary 'left' lies elsewhere"),
        (renamed(SQUARE, bottom="top"), "boundary 'bottom' lies elsewhere"),
        (
            la.meshes.quadrilaterals((0, 1), (0, 1), 4, 4),
            "lower_mesh = <MeshQuad1>: no.*fan",
        ),
        (4, "lower_mesh = 4: no MeshTri"),
    ],
)
def test_a_mesh_of_another_domain_is_refused(other, words):
    """Its lower bound would be one of another problem, and lay above the upper one at times."""
    with pytest.raises(la.InputError, match=words) as refused:
        la.bracket(hanging(SQUARE), 0.02, lower_mesh=other)
    assert refused.value.field == "lower_mesh"
    assert len(str(refused.value)) < 400


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("offset", [0.0, 1e3, 1e6])  # sizes away from the origin
@pytest.mark.parametrize("seed", one_in(3, range(3)))
def test_domains_are_the_same_to_the_precision_of_coordinates(size, offset, seed):
    """Outlines turned about, and sides divided anew by fans and by halves: oblique, with holes."""

    def body(mesh, by=0.0):
        turned = np.array([[np.cos(seed), -np.sin(seed)], [np.sin(seed), np.cos(seed)]]) @ mesh.p
        moved = replace(mesh, doflocs=np.ascontiguousarray(size * (turned + offset + by)))
        return la.Body(moved, CRITERION)

    full = la.meshes.rectangle((0, 3), (0, 3), 9, 9)
    x, y = full.p[:, full.t].mean(axis=1)
    ring = MeshTri(*_kept(full, (abs(x - 1.5) > 0.5) | (abs(y - 1.5) > 0.5)))
    first = ring.with_boundaries({"outer": lambda x: np.any((x == 0) | (x == 3), axis=0)})
    corners = np.flatnonzero(np.all(np.isin(first.p, [1, 2]), axis=0)).tolist()
    one, chosen = body(first), np.random.default_rng(seed).choice(first.nelements, 40)
    for finer in (fanned(first, corners, 16), bisected(first, chosen)[0]):
        assert finer.nelements > first.nelements
        assert not difference(one, body(finer))
        assert not difference(body(finer), one)
        assert "not in both" in difference(one, body(finer, by=1e-8))
    fans = fanned(one.mesh, corners, 16)  # vertices that are computed where the body is
    assert not difference(one, la.Body(fans, CRITERION))
    filled = la.Body(replace(body(full).mesh, _boundaries=None), CRITERION)
    assert "area" in difference(filled, one)


def test_slivers_are_refused():
    flat = la.meshes.rectangle((0, 4), (-2, 0), 4, 400, crossed=False)
    stated = on(punch(), flat)
    with pytest.raises(la.InputError, match=r"^mesh of both bounds: .* sliver of shape"):
        la.bracket(stated)


def test_doerfler():
    shares = np.array([0.1, 0.4, -0.2, 0.3, 0.2])
    assert doerfler(shares, 0.5).tolist() == [1, 3]
    assert doerfler(shares, 0.3).tolist() == [1]
    assert doerfler(np.zeros(3), 0.5).tolist() == [0, 1, 2]


def test_shares_are_no_less_than_zero_and_below_their_bound():
    stated = even_punch()
    upper, lower = la.upper_bound(stated), la.lower_bound(stated)
    above, below = upper_shares(upper, "soil"), lower_shares(lower, "soil")
    assert above.min() >= -1e-12
    assert 0 < above.sum() < upper.load_factor
    assert below.min() >= 0
    assert 0 < below.sum() < lower.load_factor * (1 + 1e-6)


@pytest.mark.parametrize("seed", range(5))
def test_refinement_keeps_area_names_and_quality(seed):
    rng = np.random.default_rng(seed)
    first = mesh = delaunay_square(rng)
    assert mesh.boundaries
    for _ in range(6):
        chosen = rng.choice(mesh.nelements, size=max(mesh.nelements // 5, 1), replace=False)
        finer, parents = bisected(mesh, chosen)
        parts = np.bincount(parents, minlength=mesh.nelements)
        assert parts.min() == 1
        assert parts.max() <= 4
        assert np.all(parts[chosen] > 1)
        assert np.allclose(np.bincount(parents, _areas(finer)), _areas(mesh), rtol=1e-12, atol=0)
        mesh = finer
    la.Body(mesh, CRITERION)  # no hanging nodes, nothing inverted
    assert _area(mesh) == pytest.approx(_area(first), rel=1e-12)
    assert set(mesh.boundaries) == set(first.boundaries)
    for name, facets in first.boundaries.items():
        finer = mesh.boundaries[name]
        assert _length(mesh, finer) == pytest.approx(_length(first, facets), rel=1e-12)
        assert np.all(mesh.f2t[1, finer] < 0)
    # Halves of angles at worst.
    assert quality(mesh).min() > quality(first).min() / 4


def test_growth_is_kept_to():
    mesh, rng = la.meshes.rectangle((0, 1), (0, 1), 8, 8), np.random.default_rng(5)
    shares = rng.random(mesh.nelements) ** 8
    finer = grown(mesh, shares, 2.0, 10_000)
    # A fiftieth is let pass, and one element divides some of its neighbours.
    assert 1.9 * mesh.nelements <= finer.nelements <= 2.1 * mesh.nelements
    most = int(1.5 * mesh.nelements)
    assert mesh.nelements < grown(mesh, shares, 2.0, most).nelements <= most
    assert grown(mesh, shares, 2.0, mesh.nelements + 2) is None
    # One element that holds all the error is divided evenly, not to nothing.
    alone = np.zeros(mesh.nelements)
    alone[0] = 1.0
    parts = _areas(mesh)[0] / _areas(grown(mesh, alone, 2.0, 10_000)).min()
    assert mesh.nelements / 2 < parts < 2 * mesh.nelements


@pytest.mark.parametrize("at", [(1, 0), (0, 0), (2, -1)])
def test_fans_keep_area_and_names(at):
    first = la.meshes.rectangle((0, 4), (-2, 0), 8, 4)
    vertex = int(np.argmin(np.linalg.norm(first.p - np.reshape(at, (2, 1)), axis=0)))
    mesh = fanned(first, [vertex], 24)
    la.Body(mesh, CRITERION)
    assert _area(mesh) == pytest.approx(_area(first), rel=1e-12)
    for name, facets in first.boundaries.items():
        assert _length(mesh, mesh.boundaries[name]) == pytest.approx(_length(first, facets))
    around = np.flatnonzero(np.any(mesh.t == vertex, axis=0))
    turn = {(1, 0): 180, (0, 0): 90, (2, -1): 360}[at]
    assert around.size >= 24 * turn / 180
    assert np.array_equal(fanned(mesh, [vertex], 24).t, mesh.t)
    assert quality(mesh).min() > 0.1


def test_singular_points_are_found():
    def places(problem):
        (name,) = problem.bodies
        return problem.bodies[name].mesh.p[:, singular_points(problem, name)].T.tolist()

    assert places(even_punch()) == [[1, 0]]
    assert places(cut()) == [[1, -1]]


def _area(mesh):
    return float(_areas(mesh).sum())


def _areas(mesh):
    a, b, c = (mesh.p[:, corner] for corner in mesh.t)
    u, v = b - a, c - a
    return np.abs(u[0] * v[1] - u[1] * v[0]) / 2


def _length(mesh, facets):
    ends = mesh.p[:, mesh.facets[:, facets]]
    return float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=0).sum())


def hung(share, sides=("bottom", "left")):
    """A square pulled by so much of 2 k, its strength in plane strain, and up by the load."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    return la.Problem(
        bodies={"square": la.Body(mesh, la.VonMises(1.0))},
        supports=[la.Fix("square", side, axis) for side, axis in zip(sides, "yx", strict=False)],
        reference_loads=[la.Traction("square", "top", (0, 1))],
        dead_loads=[la.Traction("square", "top", (0, 2 * share))],
    )


def test_a_load_of_zero_ends_as_such_and_soon():
    """Dead loads take all the strength: no width per load factor is ever reached."""
    found = la.bracket(hung(1.0), 0.01)
    assert found.status is la.Ending.ZERO
    # A thousandth of 1 % of the natural load factor, strength sqrt(3) k over a load of 1.
    assert max(abs(found.lower), abs(found.upper)) <= 1e-5 * np.sqrt(3)
    assert found.lower < found.upper
    assert found.strict
    assert "zero" in found.message


def test_a_body_that_slides_under_its_load_ends_as_zero():
    """Its strains are round-off, and bounds that differ by that do not cross."""
    pushed = replace(
        hung(-0.5, sides=("bottom",)), reference_loads=[la.Traction("square", "top", (1, 0))]
    )
    assert la.bracket(pushed).status is la.Ending.ZERO


def test_what_dead_loads_leave_is_enclosed_as_any_load_is():
    """Solvers are asked for digits of what is left, a thousandth of what they measure by."""
    found = la.bracket(hung(0.999), 0.02)
    assert found.status is la.Ending.REACHED
    assert found.lower <= 0.002 <= found.upper
