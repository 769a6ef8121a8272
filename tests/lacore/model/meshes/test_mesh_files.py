"""Meshes from files: names of groups, what is mended on the way, what is refused; strict bounds."""

from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import Delaunay
from skfem import MeshTri

import lacore as la
from lacore.model.meshes.reading import read
from tests.conftest import ROOT
from tests.lacore.models import CRITERION

MESHES = Path(__file__).parent
EXAMPLE = ROOT / "examples" / "gmsh"
UNIT = [(0, 0), (1, 0), (1, 1), (0, 1)]
HALVES = [(0, 1, 2), (0, 2, 3)]
EXACT = 2 + np.pi


def write(path, points, lines=(), triangles=(), surfaces=None, **more):
    """A .msh file, version 2.2; `lines` by name, `surfaces` the name of each triangle."""
    points = np.asarray(points, dtype=float)
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    lines, surfaces = dict(lines), surfaces or ["all"] * len(triangles)
    names = {name: [k + 1, 1] for k, name in enumerate(lines)}
    number = {name: k + 101 for k, name in enumerate(dict.fromkeys(surfaces))}
    names |= {name: [k, 2] for name, k in number.items()}
    cells, tags = [], []
    for name, ends in lines.items():
        cells.append(("line", np.array(ends)))
        tags.append(np.full(len(ends), names[name][0]))
    if len(triangles):
        cells.append(("triangle6" if len(triangles[0]) == 6 else "triangle", np.array(triangles)))
        tags.append(np.array([number[name] for name in surfaces]))
    for kind, nodes in more.items():
        cells.append((kind, np.array(nodes)))
        tags.append(np.ones(len(nodes), dtype=int))
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    field_data = {name: np.array(tag) for name, tag in names.items()}
    # 17 digits are what gives a double back.
    meshio.gmsh.write(
        path,
        meshio.Mesh(points, cells, cell_data=data, field_data=field_data),
        fmt_version="2.2",
        binary=False,
        float_fmt=".17g",
    )
    return path


def saved(path, mesh):
    """A mesh of scikit-fem with its names, as a file."""
    lines = {name: mesh.facets[:, facets].T for name, facets in mesh.boundaries.items()}
    return write(path, mesh.p.T, lines, mesh.t.T)


def punch(mesh, **body):
    return la.Problem(
        {"soil": la.Body(mesh, CRITERION, **body)},
        [la.RigidFooting("soil", "footing", (0, -1))],
        [
            la.Fix("soil", "bottom"),
            la.Fix("soil", "right"),
            la.Fix("soil", "left", components="x"),
        ],
    )


def refused(*parts):
    return pytest.raises(la.InputError, match="(?s)" + ".*".join(parts))


def test_names_of_the_example():
    mesh = read(EXAMPLE / "slope.msh", surface="clay")
    assert sorted(mesh.boundaries) == ["base", "crest", "left", "right", "slope", "toe"]
    named = np.concatenate(list(mesh.boundaries.values()))
    assert np.array_equal(np.sort(named), mesh.boundary_facets())
    ends = mesh.p[:, mesh.facets[:, mesh.boundaries["slope"]]]
    # Along the straight line y = x, to the 16 digits of the file.
    assert np.allclose(ends[0], ends[1], atol=1e-15)
    assert 0.5 < la.meshes.quality(mesh).min() <= 1


def test_surfaces_are_subdomains_or_a_choice():
    whole = read(MESHES / "layers.msh")
    assert sorted(whole.subdomains) == ["layer", "upper block"]
    assert sorted(whole.boundaries) == ["base", "joint", "top"], "the nameless group is left out"
    block = read(MESHES / "layers.msh", surface="upper block")
    layer = read(str(MESHES / "layers.msh"), "layer")
    assert block.nelements + layer.nelements == whole.nelements
    assert sorted(block.boundaries) == ["joint", "top"]
    assert sorted(layer.boundaries) == ["base", "joint"]
    stated = la.Problem(
        {"block": la.Body(block, CRITERION), "layer": la.Body(layer, CRITERION)},
        [la.Pressure("block", "top", 1.0)],
        [la.Fix("layer", "base")],
        [la.Interface(("block", "joint"), ("layer", "joint"), la.STICK)],
    )
    # Uniform uniaxial stress in the block and below it carries 2 k.
    assert la.solve(stated).load_factor > 2
    with refused("no such boundary", "known names: base, joint"):
        replace(stated, supports=[la.Fix("layer", "top")])


def test_a_joint_inside_the_body_is_no_boundary():
    body = la.Body(read(MESHES / "layers.msh"), CRITERION)
    with refused("joint", "inside the body"):
        la.Problem({"all": body}, [la.Pressure("all", "joint", 1.0)], [la.Fix("all", "base")])


def test_unknown_groups_are_told_the_known_ones():
    with refused("surface = 'layr'", "did you mean 'layer'", "known names: layer, upper block"):
        read(MESHES / "layers.msh", surface="layr")
    mesh = read(MESHES / "punch.msh")
    with refused("footin'", "did you mean 'footing'", "bottom, footing, free, left, right"):
        la.Problem({"soil": la.Body(mesh, CRITERION)}, [la.Pressure("soil", "footin", 1.0)])


@pytest.mark.parametrize("space", ["p2-vertex", "p2-disc", "p1-disc"])
def test_bounds_of_the_punch_are_strict(space):
    stated = punch(read(MESHES / "punch.msh"), space=space)
    upper, lower = la.solve(stated), la.lower_bound(stated)
    assert upper.rigor is la.Rigor.UPPER
    assert lower.rigor is la.Rigor.LOWER
    assert lower.load_factor < EXACT < upper.load_factor
    if space == "p2-vertex":
        identity = la.gap_identity(upper, lower)
        gap = upper.load_factor - lower.load_factor
        assert identity.total == pytest.approx(gap, rel=1e-5)
        assert identity.least >= -1e-9


def test_refined_from_a_file_they_stay_strict():
    """Names and strictness survive refinement and the fan that the lower bound gets."""
    found = la.bracket(punch(read(MESHES / "punch.msh", surface="soil")), target_width=0.06)
    assert found.lower < EXACT < found.upper
    assert found.upper - found.lower <= 0.06 * (found.upper + found.lower) / 2


def test_round_trip(tmp_path):
    """Seventeen digits are the same mesh, and the same mesh is the same program."""
    mesh = read(MESHES / "punch.msh")
    again = read(saved(tmp_path / "again.msh", mesh))
    assert np.array_equal(again.p, mesh.p)
    assert np.array_equal(again.t, mesh.t)
    assert sorted(again.boundaries) == sorted(mesh.boundaries)
    one, two = (la.solve(punch(each)).load_factor for each in (mesh, again))
    assert two == pytest.approx(one, rel=1e-9)


def test_round_trip_of_a_mesh_in_disorder(tmp_path):
    """Nodes doubled and shuffled, triangles turned round: another numbering, the same answer."""
    mesh = la.meshes.rectangle((0, 4), (-2, 0), 6, 4, grade_x=(1.0, 12.0), grade_y=(0.0, 12.0))
    footing = mesh.facets_satisfying(lambda x: (x[1] == 0) & (x[0] < 1), True)
    mesh = mesh.with_boundaries({"footing": footing})
    rng = np.random.default_rng(3)
    count = mesh.p.shape[1]
    place = rng.permutation(2 * count)  # of each node and of its double
    points = np.empty((2 * count, 2))
    points[place] = np.tile(mesh.p.T, (2, 1))
    either = place[mesh.t + count * rng.integers(0, 2, mesh.t.shape)]
    triangles = np.where(rng.random(mesh.nelements) < 0.5, either, either[[0, 2, 1]])
    lines = {
        name: place[mesh.facets[::-1, facets] + count * rng.integers(0, 2)].T
        for name, facets in mesh.boundaries.items()
    }
    again = read(write(tmp_path / "disorder.msh", points, lines, triangles.T))
    assert again.p.shape == mesh.p.shape
    one, two = (la.solve(punch(each)) for each in (mesh, again))
    # Another order of unknowns: each answer is within its gap, 1e-9 or less, of the optimum.
    slack = one.certificate.gap + two.certificate.gap
    assert two.load_factor == pytest.approx(one.load_factor, rel=1e-9 + slack)


def test_what_is_dropped_and_merged(tmp_path):
    """An orphan, a node that lies beside another one, a constant z, a triangle of two groups."""
    points = [(*p, 7.0) for p in [(9, 9), *UNIT, (1 + 1e-12, 1)]]
    triangles = [(1, 2, 3), (1, 5, 4), (3, 2, 1)]
    path = write(tmp_path / "m.msh", points, {"a": [(2, 5)]}, triangles, ["one", "two", "both"])
    mesh = read(path)
    assert np.array_equal(mesh.p.T, np.array(UNIT))
    assert mesh.nelements == 2
    assert {name: list(rows) for name, rows in mesh.subdomains.items()} == {
        "one": [0],
        "two": [1],
        "both": [0],
    }
    (facet,) = mesh.boundaries["a"]
    assert np.array_equal(mesh.p[:, mesh.facets[:, facet]].T, [(1, 0), (1, 1)])
    la.Body(mesh, CRITERION)


def test_a_crack_stays_open_where_nothing_is_merged(tmp_path):
    """Two triangles either side of a crack from (0, 0), whose sides are one place."""
    points = [(-1, 0), (0, 0), (1, 0), (1, 0), (0, 1), (0, -1)]
    triangles = [(0, 1, 4), (1, 2, 4), (0, 5, 1), (5, 3, 1)]
    path = write(tmp_path / "crack.msh", points, {}, triangles)
    assert read(path).p.shape == (2, 5)
    cracked = read(path, merge=0)
    assert cracked.p.shape == (2, 6)
    la.Body(cracked, CRITERION)


def test_second_order_is_reduced_to_its_vertices(tmp_path):
    points = [*UNIT, (0.5, 0), (1, 0.4), (0.5, 0.5), (0.6, 1), (0, 0.5)]
    triangles = [(0, 1, 2, 4, 5, 6), (0, 2, 3, 6, 7, 8)]
    mesh = read(write(tmp_path / "two.msh", points, {"top": [(2, 3)]}, triangles))
    assert np.array_equal(mesh.p.T, np.array(UNIT))
    points[5] = (1.1, 0.5)
    assert type(read(write(tmp_path / "two.msh", points, {}, triangles))).__name__ == "MeshTri2"


@pytest.mark.parametrize(
    ("change", "parts"),
    [
        ({"points": [*UNIT[:3], (0, 1, 0.1)]}, ("not plane", "0 to 0.1", "plane of x and y")),
        ({"triangles": []}, ("no triangles", "mesh the surfaces")),
        ({"pyramid": [(0, 1, 2, 3, 0)]}, ("pyramid", "tetrahedra only")),
        ({"lines": {"cut": [(1, 3)]}}, ("'cut'", "no edge of a triangle", "embed")),
        ({"lines": {"far": [(1, 4)]}, "points": [*UNIT, (5, 5)]}, ("'far'", "no edge")),
        ({"triangles": [*HALVES, (0, 4, 1)], "points": [*UNIT, (0, 0)]}, ("two vertices", "merge")),
        ({"points": [*UNIT[:3], (0, np.nan)]}, ("not finite", "fix")),
    ],
)
def test_refused(tmp_path, change, parts):
    given_ = {"points": UNIT, "triangles": HALVES} | change
    given_["points"] = [(*p, 0)[:3] for p in given_["points"]]
    with refused("path", *parts):
        read(write(tmp_path / "bad.msh", **given_))


@pytest.mark.parametrize("merge", [-1, 1.0, np.nan, "no", None])
def test_merge_is_a_share(merge):
    with refused("merge", "share of the size"):
        read(MESHES / "punch.msh", merge=merge)


def test_files_that_are_none(tmp_path):
    with refused("no such file", "give the path"):
        read(tmp_path / "none.msh")
    with refused("no such file"):
        read(tmp_path)
    (tmp_path / "mesh.txt").write_text("0 0\n")
    with refused("not known", "msh"):
        read(tmp_path / "mesh.txt")
    (tmp_path / "old.msh").write_text("$MeshFormat\n4.0 0 8\n$EndMeshFormat\n")
    with refused("4.0", "4.1 or 2.2"):
        read(tmp_path / "old.msh")


@pytest.mark.parametrize("share", [0.0, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9])
@pytest.mark.parametrize("version", ["4.1", "2.2"])
def test_files_that_end_early(tmp_path, share, version):
    path = MESHES / "punch.msh"
    if version == "2.2":
        path = saved(tmp_path / "whole.msh", read(path))
    text = path.read_text(encoding="utf-8")
    (tmp_path / "cut.msh").write_text(text[: int(share * len(text))])
    with refused("cut.msh"):
        read(tmp_path / "cut.msh")


def test_elements_without_their_nodes(tmp_path):
    """The reader numbers them -1, which would be the last node."""
    path = write(tmp_path / "m.msh", UNIT, {}, HALVES)
    head, nodes = path.read_text(encoding="utf-8").split("$Nodes")
    path.write_text(head + "$Nodes" + nodes.replace("\n4 ", "\n9 ", 1), encoding="utf-8")
    with refused("nodes that it lacks", "write it anew"):
        read(path)


@given(
    wounds=st.lists(
        st.tuples(st.floats(0, 0.999), st.sampled_from(["", "7", "-1", " ", "$", "1e9", "0\n"])),
        min_size=1,
        max_size=3,
    )
)
def test_broken_files_are_taken_or_refused(tmp_path_factory, wounds):
    """Whatever stands in a file, the one error there is says where and what to do."""
    text = (MESHES / "layers.msh").read_text(encoding="utf-8")
    for share, letters in wounds:
        place = int(share * len(text))
        text = text[:place] + letters + text[place + 1 :]
    path = tmp_path_factory.mktemp("broken") / "m.msh"
    path.write_text(text, encoding="utf-8")
    body = body_or_reason(path)
    assert isinstance(body, la.Body) or "; " in str(body)


def test_other_formats(tmp_path):
    """Sets of line elements are names wherever a format has them."""
    cells = [("line", np.array([(0, 1)])), ("triangle", np.array(HALVES))]
    points = [(*p, 0.0) for p in UNIT]
    sets = {"bottom": [np.array([0]), np.array([], dtype=int)]}
    meshio.abaqus.write(tmp_path / "m.inp", meshio.Mesh(points, cells, cell_sets=sets))
    mesh = read(tmp_path / "m.inp")
    assert mesh.boundaries["bottom"].size == 1
    meshio.vtk.write(tmp_path / "m.vtk", meshio.Mesh(points, cells), binary=False)
    assert read(tmp_path / "m.vtk").nelements == 2


@given(seed=st.integers(0, 10**6), inner=st.integers(0, 30), digits=st.sampled_from([1, 2, 16]))
def test_random_triangulations_are_taken_or_refused_with_a_reason(
    tmp_path_factory, seed, inner, digits
):
    """Of coarse coordinates many are flat, folded or coincide; all others are bodies that solve."""
    rng = np.random.default_rng(seed)
    sides = np.linspace(0, 1, 4)
    border = [(x, y) for x in sides for y in sides if {x, y} & {0.0, 1.0}]
    points = np.array([*border, *rng.uniform(0, 1, (inner, 2))])
    triangles = Delaunay(points).simplices
    points = points.round(digits)
    flat = MeshTri(points.T, triangles.T)
    held, loaded = (
        [ends for ends in flat.facets[:, flat.boundary_facets()].T if np.all(points[ends, 1] == y)]
        for y in (0, 1)
    )
    path = tmp_path_factory.mktemp("random") / "m.msh"
    write(path, points, {"held": held, "loaded": loaded}, triangles)
    body = body_or_reason(path)
    if isinstance(body, la.InputError):
        # Two sentences, and never for a triangulation that has shape.
        assert "; " in str(body)
        assert digits < 16 or la.meshes.quality(flat).min() < 1e-6, body
        return
    stated = la.Problem(
        {"block": body}, [la.Pressure("block", "loaded", 1)], [la.Fix("block", "held")]
    )
    upper, lower = la.solve(stated), la.lower_bound(stated)
    # Uniform uniaxial stress 2 k is linear in every element: found up to the solver's tolerance.
    assert lower.load_factor >= 2 * (1 - 1e-6)
    # One velocity in some hundred misses the residuals of a proof by little, and is no number.
    if upper.status is not la.Status.NOT_CERTIFIED:
        assert lower.load_factor <= upper.load_factor


def body_or_reason(path):
    try:
        return la.Body(read(path), CRITERION)
    except la.InputError as error:
        return error


def drawing():
    """The script that draws the committed meshes, where gmsh can be loaded."""
    try:
        from tests.lacore.model.meshes import draw
    except (ImportError, OSError) as error:  # not installed, or without its system libraries
        pytest.skip(f"gmsh: {error}")
    return draw


@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.parametrize("binary", [0, 1])
@pytest.mark.parametrize("order", [1, 2])
def test_every_way_to_save(tmp_path, version, binary, order):
    """Versions, binary or text, order: the names and the load factor of the committed mesh."""
    draw = drawing()
    with draw.session() as model:
        options = {"MshFileVersion": version, "Binary": binary, "ElementOrder": order}
        for name, value in options.items():
            draw.gmsh.option.setNumber(f"Mesh.{name}", value)
        draw.layers(model)
        draw.gmsh.write(str(tmp_path / "m.msh"))
    mesh, known = read(tmp_path / "m.msh"), read(MESHES / "layers.msh")
    for names in ("boundaries", "subdomains"):
        mine, its = getattr(mesh, names), getattr(known, names)
        assert {name: rows.size for name, rows in mine.items()} == {
            name: rows.size for name, rows in its.items()
        }


def test_all_elements_saved_beside_groups(tmp_path):
    """A choice of gmsh that the reader cannot follow: one sentence, with the way out."""
    draw = drawing()
    with draw.session() as model:
        draw.gmsh.option.setNumber("Mesh.SaveAll", 1)
        draw.layers(model)
        draw.gmsh.write(str(tmp_path / "m.msh"))
    with refused("cannot be read", "without Mesh.SaveAll"):
        read(tmp_path / "m.msh")


def test_example(tmp_path, monkeypatch):
    drawing()
    monkeypatch.syspath_prepend(EXAMPLE)
    import slope

    lower, upper = slope.main(tmp_path / "slope.msh", 0.6)
    # The best slip circle, 5.53, is an upper bound; both bounds are about a tenth off here.
    assert lower < 5.53
    assert lower < upper < 1.15 * 5.53
    stated = [slope.state(path) for path in (tmp_path / "slope.msh", EXAMPLE / "slope.msh")]
    names = [sorted(each.bodies["clay"].mesh.boundaries) for each in stated]
    assert names[0] == names[1], "what is committed is what it draws"
