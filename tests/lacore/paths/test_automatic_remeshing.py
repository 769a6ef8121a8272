"""Automatic remeshing: quality and sizes of elements, outlines, and paths that continue."""

import re
from dataclasses import replace
from math import log

import numpy as np
import pytest
from skfem import MeshTri

import lacore as la
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.meshes.curved import edge_curves, jacobians
from lacore.paths.ending import Ending
from lacore.paths.renewal.mesher import mean_ratios
from lacore.paths.renewal.remeshing import described
from lacore.paths.renewal.transfer import transfer_errors, transferred
from lacore.reporting.errors import InputError
from tests.lacore.paths.path_billets import billet, pressed
from tests.lacore.paths.test_path_checkpoint import Stop, assert_same, stop_after
from tests.lacore.paths.test_path_remesh import require_gmsh

ROUND_OFF = 1e-12
SOLVER = 1e-6  # of a load
VELOCITY = 2e-5  # of strains: velocities are less accurate than loads

EQUILATERAL = MeshTri(np.array([[0, 1, 0.5], [0, 0, np.sqrt(3) / 2]]), np.array([[0], [1], [2]]))


def reported(path, what):
    """Numbers of the events of new meshes, by the text before them."""
    texts = path.events[path.events["kind"] == "remeshed"]["what"]
    return [float(re.search(rf"{what} ([-+.e\d]+)", text)[1]) for text in texts]


def strip(n=3, space="p2-gauss", law=None, **more):
    """A strip that is compressed uniformly: exact on each mesh."""
    made = la.meshes.quadrilaterals if space == "q2" else la.meshes.rectangle
    law = law or la.hardening.Linear(1.0, 1.0)
    body = la.Body(made(x=(0, 1), y=(0, 1), nx=n, ny=n), la.VonMises(hardening=law), space=space)
    return la.Problem(
        bodies={"strip": body},
        supports=[la.Fix("strip", "left", "x"), la.Fix("strip", "bottom", "y")],
        reference_loads=[la.RigidFooting("strip", "top", (0, -1), rough=False)],
        **more,
    )


def test_quality_of_elements():
    """1 of equal sides, less where they are drawn out, negative where inverted."""
    assert mean_ratios(EQUILATERAL) == pytest.approx(1)
    assert mean_ratios(la.meshes.isoparametric(EQUILATERAL)) == pytest.approx(1)
    assert mean_ratios(replace(EQUILATERAL, t=EQUILATERAL.t[::-1])) == pytest.approx(1)
    square, long = (la.meshes.quadrilaterals((0, x), (0, 1), 1, 1) for x in (1, 3))
    assert mean_ratios(square) == pytest.approx(1)
    assert mean_ratios(long) == pytest.approx(0.6)  # 2 * 3 / (1 + 9)
    bent = la.meshes.isoparametric(EQUILATERAL).doflocs.copy()
    bent[1, 3] = 0.5  # the midside node of the bottom, far inside
    inverted = replace(la.meshes.isoparametric(EQUILATERAL), doflocs=bent)
    assert mean_ratios(inverted)[0] < 0


def test_sizes_of_elements():
    """The side of the equilateral triangle, wherever; of a square that of half of it."""
    places = np.array([[0.5, 0.1], [0.2, 0.1]])
    np.testing.assert_allclose(la.meshes.element_sizes(EQUILATERAL)(places), 1, rtol=ROUND_OFF)
    squares = la.meshes.quadrilaterals((0, 1), (0, 1), 4, 4)
    side = 0.25 * np.sqrt(2 / np.sqrt(3))
    np.testing.assert_allclose(la.meshes.element_sizes(squares)(places), side, rtol=ROUND_OFF)


def test_new_meshes_have_sizes_and_areas_of_the_old():
    """Graded as the old mesh; boundaries that are kept, and vertices, stay."""
    require_gmsh()
    old = la.meshes.isoparametric(
        la.meshes.rectangle((0, 1), (0, 1), 8, 8), lambda x: x + 0.1 * np.sin(3 * x[::-1])
    )
    keep = [tuple(old.p[:, node].tolist()) for node in (0, 40)]
    sizes = la.meshes.element_sizes(old)
    new = la.meshes.remeshed(old, sizes, keep=keep, keep_edges=["left"])
    area = jacobians(old).mean(axis=1).sum()
    assert jacobians(new).mean(axis=1).sum() == pytest.approx(area, rel=ROUND_OFF)
    for place in keep:
        assert np.linalg.norm(new.p[:, : new.nvertices].T - place, axis=1).min() < ROUND_OFF
    one, two = (edge_curves(m, np.asarray(m.boundaries["left"])) for m in (old, new))
    for before, after in ((one.middle, two.middle), (one.start, two.start)):
        np.testing.assert_allclose(np.sort(after[1]), np.sort(before[1]), rtol=ROUND_OFF)
    assert mean_ratios(new).min() > 0.4
    with pytest.raises(InputError, match="keep_edges"):
        la.meshes.remeshed(old, sizes, keep_edges=["lft"])


def test_the_number_of_elements_stays():
    require_gmsh()
    problem, remesh = strip(6), la.Remeshing()
    for _ in range(3):
        mesh = remesh(problem)["strip"]
        assert mesh.nelements == pytest.approx(strip(6).bodies["strip"].mesh.nelements, rel=0.2)
        body = replace(problem.bodies["strip"], mesh=mesh)
        problem = replace(problem, bodies={"strip": body})
    fine = la.Remeshing(size={"strip": 0.1})(problem)["strip"]
    assert fine.nelements > mesh.nelements
    edges = edge_curves(fine, np.asarray(fine.boundaries["top"]))
    assert np.linalg.norm(edges.end - edges.start, axis=0).max() <= 0.1 * (1 + ROUND_OFF)


@pytest.mark.parametrize("space", ["p2-gauss", "q2"])
def test_uniform_flow_does_not_notice(space):
    """Loads, volume and strains are those of one mesh, and exact."""
    require_gmsh()
    asked = {"travel": 0.3, "steps": 2, "scheme": "implicit-midpoint"}
    plain = la.sequential(strip(1, space), **asked)
    path = la.sequential(strip(1, space), **asked, remesh=la.Remeshing(quality=0.97))
    assert path.status is Ending.REACHED, path.message
    assert len(path.later) >= 1
    for name in ("load_factor", "force", "volume"):
        np.testing.assert_allclose(path.history[name], plain.history[name], rtol=SOLVER)
    exact = 2 / np.sqrt(3) * log(1 / 0.7)
    assert path.history["max_strain"].iloc[-1] == pytest.approx(exact, rel=VELOCITY)
    assert np.abs(reported(path, "volume jumps by")).max() < ROUND_OFF
    assert np.abs(reported(path, "load by")).max() < SOLVER
    assert np.abs(reported(path, "strain jumps by")).max() < VELOCITY
    assert np.abs(reported(path, "differ by up to")).max() < VELOCITY


def squeezed(current):
    """Four equal rectangles, in the outline of the strip."""
    x, y = current.bodies["strip"].mesh.p.max(axis=1).tolist()
    return {"strip": la.meshes.quadrilaterals(x=(0, x), y=(0, y), nx=2, ny=2)}


def test_meshes_of_a_function():
    """It is called when the quality falls, without Gmsh, and a checkpoint knows its name."""
    remesh = la.Remeshing(quality=0.99, mesher=squeezed)
    path = la.sequential(strip(1, "q2"), 0.3, 3, remesh=remesh)
    assert path.status is Ending.REACHED, path.message
    assert [first for first, _ in path.later] == [2, 3]
    assert (
        np.abs(reported(path, "volume jumps by")).max() < VELOCITY
    )  # sides are not quite straight
    quality, name = described(remesh)
    assert (quality, name.split(".")[-1]) == (0.99, "squeezed")
    with pytest.raises(InputError, match="leave out `size` or `mesher`"):
        la.Remeshing(size=0.1, mesher=squeezed)


def test_a_body_that_has_not_deformed():
    """A tube on a new mesh has the pressure of the old one, up to the error of both."""
    require_gmsh()
    ring = la.meshes.rectangle(x=(1, 2), y=(0, 0.5), nx=6, ny=3)
    steel = la.VonMises(shear_strength=1.0)
    tube = la.Problem(
        bodies={"tube": la.Body(ring, steel, kinematics="axisymmetric", space="p2-gauss")},
        supports=[la.Fix("tube", "bottom", "y"), la.Fix("tube", "top", "y")],
        reference_loads=[la.Pressure("tube", "left")],
    )
    body = replace(tube.bodies["tube"], mesh=la.Remeshing()(tube)["tube"])
    one, two = la.solve(tube), la.solve(replace(tube, bodies={"tube": body}))
    assert one.load_factor == pytest.approx(2 * log(2), rel=2e-3)
    assert two.load_factor == pytest.approx(one.load_factor, rel=2e-3)


def sticky():
    problem, approaching = billet(3)
    stick = [replace(own, friction=0.5) for own in (*problem.interfaces, *approaching)]
    return replace(problem, interfaces=stick[:1]), stick[1:]


@pytest.mark.slow
def test_a_path_that_ended_by_an_inverted_element_continues():
    """Before one turns over: none is predicted to."""
    require_gmsh()
    asked = {"billet": sticky, "steps": 12, "travel": 0.48}
    assert pressed(**asked).status is Ending.INVERSION
    path = pressed(**asked, remesh=la.Remeshing())
    assert path.status is Ending.REACHED, path.message
    assert "inversion predicted" not in set(path.events["kind"])
    assert len(path.later) >= 1
    assert np.abs(reported(path, "volume jumps by")).max() < 1e-6
    assert path.history["volume"].iloc[-1] == pytest.approx(1, abs=2e-3)  # of the steps
    assert path.history["overlap"].max() < 1e-3


@pytest.mark.slow
def test_a_punch_gets_deeper():
    """Four times as deep as on one mesh; half of its width."""
    require_gmsh()
    mesh = la.meshes.rectangle(x=(0, 4), y=(-2, 0), nx=8, ny=4)
    soil = la.Body(mesh, la.VonMises(hardening=la.hardening.Linear(1.0, 1.0)), space="p2-gauss")
    punch = la.Problem(
        bodies={"soil": soil},
        supports=[la.Fix("soil", "left", "x"), la.Fix("soil", "bottom"), la.Fix("soil", "right")],
        reference_loads=[
            la.RigidFooting("soil", lambda x: (x[1] > -1e-9) & (x[0] < 1), (0, -1), rough=True)
        ],
    )
    asked = {"travel": 0.5, "steps": 10}
    one = la.sequential(punch, **asked)
    assert one.status is Ending.INVERSION
    path = la.sequential(punch, **asked, remesh=la.Remeshing())
    assert path.status is Ending.REACHED, path.message
    assert path.history["volume"].iloc[-1] == pytest.approx(8, rel=1e-4)
    assert np.abs(reported(path, "volume jumps by")).max() < 1e-9
    assert (path.history["min_jacobian"] > 0).all()


def test_two_bodies_in_contact():
    """Each of them gets a new mesh, and the force of friction stays exact."""
    require_gmsh()
    metal = la.VonMises(hardening=la.hardening.Linear(1.0, slope=1.0))
    flat = la.meshes.rectangle(x=(0, 2), y=(0, 0.5), nx=4, ny=1)
    top = la.meshes.rectangle(x=(0, 2), y=(0.5, 1), nx=3, ny=1)
    stack = la.Problem(
        bodies={
            "low": la.Body(flat, metal, space="p2-gauss"),
            "high": la.Body(top, metal, space="p2-gauss"),
        },
        supports=[
            la.Fix("low", "left", "x"),
            la.Fix("high", "left", "x"),
            la.Fix("low", "bottom", "y"),
        ],
        interfaces=[la.Interface(("high", "bottom"), ("low", "top"), friction=0.3)],
        reference_loads=[la.RigidFooting("high", "top", (0, -1), rough=False)],
    )
    remesh = la.Remeshing(quality=0.95)
    path = la.sequential(stack, 0.3, 2, scheme="implicit-midpoint", remesh=remesh)
    assert path.status is Ending.REACHED, path.message
    made = [text for text in path.events["what"] if "elements; volume" in text]
    assert any("low has" in text and "high has" in text for text in made)
    exact = 2 / np.sqrt(3) * log(1 / 0.7)
    assert path.history["max_strain"].iloc[-1] == pytest.approx(exact, rel=VELOCITY)
    assert path.history["overlap"].max() < 1e-6
    assert np.abs(reported(path, "load by")).max() < 1e-5


def test_bonded_bodies_keep_their_common_edges():
    require_gmsh()
    metal = la.VonMises(hardening=la.hardening.Linear(1.0, slope=1.0))
    low, high = (la.meshes.rectangle((0, 1), y, 3, 2) for y in ((0, 0.5), (0.5, 1)))
    bonded = la.Problem(
        bodies={"low": la.Body(low, metal), "high": la.Body(high, metal)},
        supports=[
            la.Fix("low", "left", "x"),
            la.Fix("high", "left", "x"),
            la.Fix("low", "bottom", "y"),
        ],
        interfaces=[la.Interface(("low", "top"), ("high", "bottom"), la.BOND)],
        reference_loads=[la.RigidFooting("high", "top", (0, -1), rough=False)],
    )
    path = la.sequential(bonded, 0.1, 2, remesh=la.Remeshing(quality=0.95))
    assert path.status is Ending.REACHED, path.message
    assert len(path.later) >= 1
    assert np.abs(reported(path, "load by")).max() < 1e-5


def test_points_of_forces_and_of_the_control_stay():
    require_gmsh()
    problem = strip(2, dead_loads=[la.PointForce("strip", (0.5, 0.5), (0.0, 1e-3))])
    control = la.PointTravel("strip", at=(1, 0.5), direction=(1, 0))
    path = la.sequential(problem, 0.1, 2, control=control, remesh=la.Remeshing(quality=0.99))
    assert path.status is Ending.REACHED, path.message
    assert len(path.later) >= 1


def test_a_mesher_that_fails_ends_the_path(monkeypatch):
    """By name; all steps are kept."""
    require_gmsh()

    def fails(*_):
        raise InputError("remeshed", "self-intersecting", "gmsh failed", "give another size")

    monkeypatch.setattr("lacore.paths.renewal.mesher.remeshed", fails)
    path = la.sequential(strip(2), 0.3, 3, remesh=la.Remeshing(quality=0.9))
    assert path.status is Ending.NOT_REMESHED
    assert "remesh fails: InputError" in path.message
    assert len(path.history) >= 1
    assert path.last is not None


def test_a_checkpoint_knows_it(tmp_path):
    """Stopped after new meshes, the path is the same; with another quality it is another one."""
    require_gmsh()
    asked = {"travel": 0.3, "steps": 3, "remesh": la.Remeshing(quality=0.9)}
    whole = la.sequential(strip(2), **asked)
    with pytest.raises(Stop):
        la.sequential(strip(2), **asked, checkpoint=tmp_path / "p", on_step=stop_after(2))
    assert_same(la.sequential(strip(2), **asked, checkpoint=tmp_path / "p"), whole)
    other = {**asked, "remesh": la.Remeshing(quality=0.8)}
    with pytest.raises(InputError, match="is of another path: other remesh"):
        la.sequential(strip(2), **other, checkpoint=tmp_path / "p")


@pytest.mark.parametrize(
    ("given", "what"),
    [
        ({"quality": 1.0}, r"Remeshing.quality = 1.0: not between 0 and 1"),
        ({"quality": float("nan")}, r"Remeshing.quality"),
        ({"size": 0.0}, r"Remeshing.size"),
        ({"size": {"strip": -1.0}}, r"Remeshing.size\['strip'\]"),
    ],
)
def test_what_it_cannot_be(given, what):
    with pytest.raises(InputError, match=what):
        la.Remeshing(**given)


def test_bodies_that_it_cannot_mesh():
    """Refused before the first step."""
    with pytest.raises(InputError, match=r"Remeshing\.size"):
        la.sequential(strip(2), 0.1, 1, remesh=la.Remeshing(size={"stripe": 0.1}))


def inclusion():
    """A core inside of layers; edges are curved."""
    mesh = la.meshes.rectangle((0, 3), (0, 2), 9, 6)
    x, y = mesh.p[:, mesh.t].mean(axis=1)
    core = (x > 1) & (x < 2) & (y > 1) & (y < 5 / 3)
    parts = {"core": core, "low": y < 2 / 3, "up": (y > 2 / 3) & ~core}
    bent = la.meshes.isoparametric(mesh, lambda x: x + 0.05 * np.sin(2 * x[::-1]))
    return bent.with_subdomains({name: np.flatnonzero(own) for name, own in parts.items()})


def test_regions_keep_outline_and_area():
    require_gmsh()
    old = inclusion()
    new = la.meshes.remeshed(old, 0.21, keep_regions=["core", "low", "up"])
    for name in ("core", "low", "up"):
        was, now = (jacobians(m).mean(axis=1)[np.asarray(m.subdomains[name])] for m in (old, new))
        assert now.sum() == pytest.approx(was.sum(), rel=ROUND_OFF)
    assert sorted(new.boundaries) == sorted(old.boundaries)
    assert mean_ratios(new).min() > 0.2
    assert sum(np.asarray(own).size for own in new.subdomains.values()) == new.nelements
    la.Body(new, la.VonMises(1.0), space="p2-gauss")  # one mesh, without gaps or overlaps
    with pytest.raises(InputError, match="keep_regions"):
        la.meshes.remeshed(old, 0.2, keep_regions=["cor"])


def test_regions_keep_their_strains():
    """Each has its own, up to the line between them."""
    require_gmsh()
    metals = dict.fromkeys(("core", "low", "up"), la.VonMises(1.0))
    old = la.Body(inclusion(), metals, space="p2-gauss")
    new = replace(old, mesh=la.meshes.remeshed(old.mesh, 0.21, keep_regions=list(metals)))
    was, now = (BodyDofs.at(body, 0) for body in (old, new))
    strains = {"core": 0.3, "low": 0.1, "up": 0.7}
    given, expected = (np.zeros(dofs.weights.shape) for dofs in (was, now))
    for values, body in ((given, old), (expected, new)):
        for region in body.regions:
            values[region.elements] = strains[region.name]
    found = transferred(was, given, now)
    np.testing.assert_allclose(found, expected, rtol=ROUND_OFF)
    assert transfer_errors(was, given, now, found) == pytest.approx((0, 0), abs=1e-9)


def test_uniform_flow_of_two_regions_does_not_notice():
    require_gmsh()
    problem = strip(2)
    body = problem.bodies["strip"]
    mesh = body.mesh.with_subdomains({"low": lambda x: x[1] < 0.5, "up": lambda x: x[1] > 0.5})
    parts = replace(body, mesh=mesh, criterion=dict.fromkeys(("low", "up"), body.criterion))
    regional = replace(problem, bodies={"strip": parts})
    asked = {"travel": 0.3, "steps": 2, "scheme": "implicit-midpoint"}
    plain = la.sequential(problem, **asked)
    renewed = la.sequential(regional, **asked, remesh=la.Remeshing(quality=0.999))
    assert "remeshed" in set(renewed.events["kind"])
    loads = (path.history.load_factor.to_numpy() for path in (plain, renewed))
    np.testing.assert_allclose(*loads, rtol=1e-7)


def test_parts_of_a_curved_edge_are_that_edge():
    """Of a parabola in unequal parameters too: vertices and midside nodes stay on it."""
    require_gmsh()
    square = la.meshes.isoparametric(la.meshes.rectangle((0, 1), (0, 1), 1, 1))
    (top,) = np.asarray(square.boundaries["top"])
    places = square.doflocs.copy()
    places[:, square.nvertices + top] = (0.45, 1.1)
    old = replace(square, doflocs=places)
    new = la.meshes.remeshed(old, 0.3)
    curve, parts = (edge_curves(mesh, np.asarray(mesh.boundaries["top"])) for mesh in (old, new))
    for x, y in np.hstack([parts.start, parts.middle, parts.end]).T:
        # x(s) = s + 4 s (1 - s) (-0.05)
        s = np.roots([0.2, 0.8, -x])
        s = s[(s > -1e-9) & (s < 1 + 1e-9)]
        assert curve.at(s)[1] == pytest.approx(y, abs=1e-9)


@pytest.mark.slow
def test_a_wedge_with_new_meshes():
    """Its contact is kept: load and volume hardly jump."""
    require_gmsh()
    mesh = la.meshes.rectangle(x=(0, 3), y=(-2, 0), nx=12, ny=8)
    body = la.Body(mesh, la.VonMises(shear_strength=1.0), space="p2-gauss")
    problem = la.Problem(
        bodies={"body": body},
        supports=[la.Fix("body", "left", "x"), la.Fix("body", "bottom"), la.Fix("body", "right")],
    )
    wedge = la.Tool(la.shapes.wedge((0, 0), 45), touches=("body", "top"), velocity=(0, -1))
    path = la.sequential(problem, 0.24, 12, tools={"wedge": wedge}, remesh=la.Remeshing())
    assert path.status is Ending.REACHED, path.message
    assert len(path.later) >= 1
    assert np.abs(reported(path, "volume jumps by")).max() < 1e-3
    assert np.abs(reported(path, "load by")).max() < 0.05
