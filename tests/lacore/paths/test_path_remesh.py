"""New meshes on the way: outlines, strains that go over, paths that go on."""

import re
import subprocess
import sys
from dataclasses import fields, replace

import numpy as np
import pytest

import lacore as la
from lacore.model.bodies.any_body import numbered
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.meshes.curved import edge_curves
from lacore.paths.configuration import Configuration
from lacore.paths.ending import Ending
from lacore.paths.logbook import Log, peak
from lacore.paths.path import PathStep
from lacore.paths.renewal.remeshing import NewMeshes, control_on_new_mesh, restaged
from lacore.paths.renewal.transfer import transferred
from lacore.paths.stage import staged
from lacore.reporting.errors import InputError
from tests.lacore.paths.path_billets import billet, pressed, quad_billet
from tests.lacore.paths.test_path_checkpoint import Stop, assert_same, stop_after
from tests.lacore.pictures.readings import drawn, words

ROUND_OFF = 1e-12  # of sums of tens of terms of order one


def require_gmsh():
    try:
        import gmsh  # noqa: F401
    except (ImportError, OSError) as error:
        pytest.skip(f"gmsh cannot be loaded: {error}")


def square(n, y=(0.0, 1.0), made=la.meshes.rectangle):
    return la.meshes.isoparametric(made(x=(0, 1), y=y, nx=n, ny=n), lambda x: x)


def dofs_of(mesh, space="p2-gauss"):
    body = la.Body(mesh, la.VonMises(yield_stress=1.0), space=space)
    return numbered({"b": body}, BodyDofs.at)["b"]


def anew(size):
    return lambda now: {"billet": la.meshes.remeshed(now.bodies["billet"].mesh, size)}


_PIPE = """
import os
import lacore as la
la.meshes.remeshed(la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2), 0.4)
read, write = os.pipe()
os.close(read)
try:
    os.write(write, b"to nobody")
except BrokenPipeError:
    print("an exception")
"""


@pytest.mark.skipif(sys.platform == "win32", reason="there is no such signal")
def test_gmsh_leaves_broken_pipes_exceptions():
    """It lets them end the process; a solver's that is killed, then takes its caller with it."""
    require_gmsh()
    ran = subprocess.run([sys.executable, "-c", _PIPE], capture_output=True, text=True)
    assert (ran.returncode, ran.stdout) == (0, "an exception\n"), ran.stderr


@pytest.mark.parametrize(
    ("made", "space"),
    [(la.meshes.rectangle, "p2-gauss"), (la.meshes.quadrilaterals, "q2")],
    ids=["triangles", "quads"],
)
def test_strains_go_over(made, space):
    """Uniform ones as they are, others within their bounds, smooth ones the better the finer."""
    new = dofs_of(la.meshes.quadrilaterals(x=(0, 1), y=(0, 1), nx=7, ny=5), "q2")
    errors = []
    for n in (4, 8, 16):
        old = dofs_of(square(n, made=made), space)
        uniform = transferred(old, np.full(old.weights.shape, 0.7), new)
        np.testing.assert_allclose(uniform, 0.7, rtol=ROUND_OFF)
        rough = np.random.default_rng(n).uniform(0, 1, old.weights.shape)
        over = transferred(old, rough, new)
        assert over.shape == new.weights.shape
        assert rough.min() <= over.min() <= over.max() <= rough.max()

        def field(dofs):
            x, y = np.asarray(dofs.basis.global_coordinates())
            return 1 + x * np.sin(y)

        difference = transferred(old, field(old), new) - field(new)
        errors.append(np.sqrt(np.sum(new.weights * difference**2)))
    # At the boundary means are taken from one side: first order there, on a strip that gets
    # thinner; order 3/2 in this norm, less on coarse meshes.
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders.min() > 1.0


def test_beyond_the_boundary_strains_are_those_of_the_nearest_place():
    old = dofs_of(square(2))
    x, y = np.asarray(old.basis.global_coordinates())
    near, far = (dofs_of(square(2, y=own)) for own in ((1.5, 2.0), (3.0, 3.5)))
    one, two = (transferred(old, x**2 + y, new) for new in (near, far))
    np.testing.assert_allclose(one, two, rtol=ROUND_OFF)


@pytest.mark.parametrize("size", [0.5, 0.13])
def test_outline_of_a_curved_body(size):
    """Names, corners and the area stay; edges have the length asked for."""
    require_gmsh()
    ring = la.meshes.isoparametric(
        la.meshes.quarter_ring(1.0, 2.0, 4, 8), lambda x: _onto_circles(x)
    )
    new = la.meshes.remeshed(ring, size)
    old, now = dofs_of(ring), dofs_of(new)
    # Quadratic edges on an arc of radius 1: an error of (size/r)^4 / 720 a radian, or so; and
    # chords of the eighths of old edges.
    assert now.areas.sum() == pytest.approx(old.areas.sum(), abs=5e-4)
    assert new.boundaries.keys() == ring.boundaries.keys()
    for name in ("bore", "outside", "x_axis", "y_axis"):
        before, after = (
            edge_curves(mesh, np.asarray(mesh.boundaries[name])) for mesh in (ring, new)
        )
        long = [np.linalg.norm(own.end - own.start, axis=0).sum() for own in (before, after)]
        assert long[1] == pytest.approx(long[0], rel=size**2 / 10)
        assert np.linalg.norm(after.end - after.start, axis=0).max() <= size * 1.0001
    all_named = np.concatenate([np.asarray(own) for own in new.boundaries.values()])
    assert sorted(all_named) == sorted(new.boundary_facets())
    radii = np.linalg.norm(edge_curves(new, np.asarray(new.boundaries["bore"])).middle, axis=0)
    np.testing.assert_allclose(radii, 1.0, atol=2e-3)
    for corner in ((1, 0), (2, 0), (0, 1), (0, 2)):
        assert np.abs(new.p.T - corner).sum(axis=1).min() < 1e-12


def _onto_circles(x):
    """Midside nodes of the two arcs onto them."""
    r = np.linalg.norm(x, axis=0)
    near = [np.abs(r - own) < 0.012 for own in (1.0, 2.0)]
    target = np.select(near, [1.0, 2.0], r)
    on_axes = (np.abs(x) < 1e-12).any(axis=0)
    return np.where(on_axes, x, x * target / r)


def test_outline_with_a_hole():
    require_gmsh()
    mesh = la.meshes.rectangle(x=(0, 3), y=(0, 3), nx=3, ny=3)
    centre = mesh.p[:, mesh.t].mean(axis=1)
    inside = np.flatnonzero(np.all(np.abs(centre - 1.5) < 0.5, axis=0))
    holed = mesh.remove_elements(inside).with_boundaries(
        {"hole": lambda x: np.abs(x - 1.5).max(axis=0) < 0.6}
    )
    new = la.meshes.remeshed(holed, 0.3, keep=[(0.0, 1.0)])
    assert dofs_of(new).areas.sum() == pytest.approx(8, rel=ROUND_OFF)
    hole = new.p[:, new.facets[:, new.boundaries["hole"]]]
    assert np.abs(np.abs(hole - 1.5).max(axis=0) - 0.5).max() < ROUND_OFF
    assert np.linalg.norm(new.p.T - (0.0, 1.0), axis=1).min() < ROUND_OFF


def test_outlines_that_cannot_be():
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2)
    with pytest.raises(InputError, match="size"):
        la.meshes.remeshed(mesh, 0.0)
    with pytest.raises(InputError, match=r"keep = .*no vertex is there"):
        la.meshes.remeshed(mesh, 0.3, keep=[(0.3, 0.2)])


def test_a_path_goes_on():
    """It would end by an inverted element; with new meshes it gets to its end, and says so."""
    require_gmsh()
    seen = []

    def remesh(now):
        seen.append(now)
        return anew(0.25)(now)

    stuck = {"billet": lambda: _sticky(3), "steps": 12, "travel": 0.48}
    before = pressed(**stuck)
    assert before.status is Ending.INVERSION
    path = pressed(**stuck, remesh=remesh)
    assert path.status is Ending.REACHED, path.message
    kinds = list(path.events["kind"])
    assert kinds.count("remeshed") == len(seen) == len(path.later) >= 1
    what = path.events["what"][kinds.index("remeshed")]
    assert "elements; volume jumps by " in what
    # All that came before is as it was.
    count = len(before.history)
    columns = ["travel", "load_factor", "max_strain"]
    assert path.history[columns][:count].equals(before.history[columns])
    # Volumes jump by what an outline of quadratic edges of this size misses.
    assert path.history["volume"].iloc[-1] == pytest.approx(1, abs=0.01)
    assert path.history["min_jacobian"].iloc[-1] > 0
    first = path.later[0][0]
    assert path.stage_of(path.snapshot(first - 1)) is path.stage
    assert path.stage_of(path.snapshot(first)) is path.later[0][1]
    assert path.problem(-1).bodies["billet"].mesh.nelements != 18
    assert path.problem(0).bodies["billet"].mesh.nelements == 18
    assert "remeshed" in words(drawn(path.plot()))


def _sticky(n):
    problem, approaching = billet(n)
    stick = [replace(own, friction=0.5) for own in (*problem.interfaces, *approaching)]
    return replace(problem, interfaces=stick[:1]), stick[1:]


def test_a_jump_from_mesh_to_mesh_is_no_peak():
    """Of a load that rises all the way, and is less on finer meshes; a true peak is seen again."""
    stage = staged(billet()[0], [])
    log = Log(stage, lambda _d, _u: 1.0, 1)
    still = dict.fromkeys([own.name for own in fields(PathStep)], 0.0)

    def seen(loads):
        """Steps at which a peak was found, while these loads came."""
        for load in loads:
            step = len(log.rows) + 1
            log.rows.append(
                PathStep(**{**still, "step": step, "travel": step, "load_factor": load})
            )
            yield peak(log.on_these_meshes, "load_factor")

    assert not any(seen([1.0, 1.1, 1.2, 1.3]))
    log.enter(stage, log.gauge, NewMeshes(5, {}, {}))
    assert not any(seen([1.25, 1.35, 1.45]))
    (found,) = filter(None, seen([1.5, 1.45]))
    assert found[0] == 8
    assert found[2] == pytest.approx(1.5, abs=0.01)  # of a cubic through four points


@pytest.mark.slow
def test_files_of_a_path_with_new_meshes(tmp_path):
    require_gmsh()
    meshio = pytest.importorskip("meshio")
    path = pressed(12, travel=0.48, billet=lambda: _sticky(3), remesh=anew(0.25))
    path.to_vtu(tmp_path)
    counts = {
        len(meshio.read(file).cells[0].data) for file in tmp_path.iterdir() if file.suffix == ".vtu"
    }
    assert len(counts) > 1
    path.animate(tmp_path / "a.gif", dpi=30)


@pytest.mark.slow
def test_meshes_that_cannot_be_taken():
    """The path ends by name, and what it has is kept."""
    asked = {"steps": 2, "travel": 0.9}
    plain = la.meshes.rectangle(x=(0, 1), y=(0.7, 1), nx=2, ny=2, crossed=False)
    nameless = type(plain)(plain.p, plain.t)
    for meshes, why in (
        ({}, "returned no meshes"),
        ({"other": plain}, "unknown name; known names: billet"),
        ({"billet": 3}, "not a mesh of 'billet'"),
        ({"billet": nameless}, "names of boundaries that the new mesh of 'billet' lacks"),
        (
            {"billet": la.meshes.rectangle(x=(0, 1), y=(0.7, 1.1), nx=2, ny=2)},
            "behind its obstacle",
        ),
    ):
        path = pressed(**asked, remesh=lambda now, meshes=meshes: meshes)
        assert path.status is Ending.NOT_REMESHED
        assert why in path.message
        assert len(path.history) == 1
        assert path.last is not None


@pytest.mark.parametrize("error", [InputError("size", -1, "not positive", "give 1"), KeyError("b")])
def test_a_remesh_that_fails_ends_the_path(error):
    """And does not lose it."""

    def fails(now):
        raise error

    path = pressed(2, travel=0.9, remesh=fails)
    assert path.status is Ending.NOT_REMESHED
    assert f"remesh fails: {type(error).__name__}: {error}" in path.message
    assert len(path.history) == 1


@pytest.mark.slow
def test_a_mesh_that_is_no_better_ends_the_path():
    calls = []

    def same(now):
        calls.append(now)
        return {"billet": now.bodies["billet"].mesh}

    path = pressed(3, travel=0.9, remesh=same)
    assert path.status is Ending.INVERSION
    assert len(calls) == 1
    remeshed = path.events[path.events["kind"] == "remeshed"]
    # The same mesh, its strains smoothed: the volume stays, to round-off of straight contact edges.
    (jump,) = re.findall(r"volume jumps by ([^ ,]*)", remeshed["what"].iloc[0])
    assert abs(float(jump)) < 1e-9


@pytest.mark.parametrize("made", [billet, quad_billet], ids=["triangles", "quads"])
def test_the_stage_on_new_meshes(made):
    """Loads, supports and planes by their names; uniform strains, and nodes put onto planes."""
    stage = staged(*made())
    moved = {"billet": 0.9 * (stage.start.nodes["billet"] - [[0], [1]]) + [[0], [1]]}
    now = Configuration(moved, {"billet": np.full_like(stage.start.strain["billet"], 0.3)})
    mesh = la.meshes.quadrilaterals(x=(0, 0.9), y=(0.1, 1 + 1e-8), nx=3, ny=3)
    new, configuration = restaged(stage, now, {"billet": mesh})
    body = new.bodies["billet"]
    assert body.space == "q2"
    np.testing.assert_allclose(configuration.strain["billet"], 0.3, rtol=ROUND_OFF)
    assert [own.name for own in new.obstacles] == [own.name for own in stage.obstacles]
    top = configuration.nodes["billet"][1].max()
    assert top == pytest.approx(1.0, abs=1e-15)
    d = la.discretise(new.at(configuration))
    assert d.full.n == 2 * 49 + 1  # the footing


def test_a_control_point_goes_along():
    stage = staged(*billet())
    moved = {"billet": stage.start.nodes["billet"] * [[1.1], [0.9]]}
    control = la.PointTravel("billet", (1, 0.5), (1, 0))
    after = control_on_new_mesh(control, stage, Configuration(moved, stage.start.strain))
    assert after.at == pytest.approx((1.1, 0.45))
    assert control_on_new_mesh(la.Time(), stage, stage.start) == la.Time()


@pytest.mark.slow
def test_checkpoints_keep_new_meshes(tmp_path):
    """Stopped before, at and after new meshes, the path is the same bit for bit."""
    require_gmsh()
    remesh = anew(0.25)
    asked = {"steps": 12, "travel": 0.48, "billet": lambda: _sticky(3), "remesh": remesh}
    whole = pressed(**asked)
    first = whole.later[0][0]
    for step in (first - 1, first, first + 1):
        with pytest.raises(Stop):
            pressed(**asked, checkpoint=tmp_path / "p", on_step=stop_after(step))
    again = pressed(**asked, checkpoint=tmp_path / "p")
    assert_same(again, whole)
    assert_same(pressed(**asked, checkpoint=tmp_path / "p", on_step=stop_after(0)), whole)
    assert [step for step, _ in again.later] == [step for step, _ in whole.later]
    for (_, one), (_, two) in zip(again.later, whole.later, strict=True):
        np.testing.assert_array_equal(
            one.bodies["billet"].mesh.doflocs, two.bodies["billet"].mesh.doflocs
        )
    with pytest.raises(InputError, match="is of another path: other remesh"):
        pressed(**{**asked, "remesh": lambda now: remesh(now)}, checkpoint=tmp_path / "p")
