"""Meshes of other programs: their elements, sets of nodes and units."""

import meshio
import numpy as np
import pytest
from skfem import MeshQuad, MeshTri

import lacore as la
from lacore.model.meshes.curved import signed_jacobians
from lacore.model.meshes.files.notes import notes_of
from lacore.model.meshes.reading import read
from lacore.reporting.kinds import Kind
from tests.lacore.models import CRITERION

HALVES = [(0, 1, 2), (0, 2, 3)]
CORNERS = {"triangle": 3, "quad": 4}


def second_order(mesh, kind):
    """Nodes of a mesh with midside nodes, and of each element in the order of meshio."""
    whole = la.meshes.isoparametric(mesh)
    corners = mesh.t
    rows = [corners]
    for place in range(len(corners)):
        ends = np.sort(corners[[place, (place + 1) % len(corners)]], axis=0)
        known = {tuple(own): n for n, own in enumerate(np.sort(mesh.facets, axis=0).T.tolist())}
        rows.append([[mesh.nvertices + known[tuple(own)] for own in ends.T.tolist()]])
    if kind == "quad9":
        rows.append([mesh.nvertices + mesh.nfacets + np.arange(mesh.nelements)])
    return whole.p.T, np.concatenate(rows).T


def abaqus(path, points, elements, code, first=11):
    """An input file with its own numbers, generated sets, a set of a set, and a surface."""
    ids = 10 * np.arange(1, len(points) + 1)
    lines = ["*HEADING", "a plate", "** comment", "*NODE, NSET=Nall"]
    lines += [f"{n}, {x!r}, {y!r}" for n, (x, y) in zip(ids, points.tolist(), strict=True)]
    half = len(elements) // 2
    for name, begin, end in (("low", 0, half), ("high", half, len(elements))):
        lines.append(f"*Element, type={code}, elset={name}")
        for number, own in enumerate(elements[begin:end].tolist(), start=begin + first):
            lines.append(", ".join(map(str, [number, *ids[own]])))
    for name, axis, value in (("base", 1, 0.0), ("left", 0, 0.0)):
        own = ids[points[:, axis] == value]
        lines += [f"*NSET, NSET={name}", *(f"{n}," for n in own)]
    lines += ["*NSET, NSET=corner", str(ids[0]), "*NSET, NSET=again", "base"]
    lines += ["*ELSET, ELSET=all, GENERATE", f"{first}, {first + len(elements) - 1}, 1"]
    path.write_text("\n".join(lines).replace("np.", "") + "\n")
    return path


def pressed(mesh, space, kinematics="plane_strain"):
    """A plate on a smooth floor under a uniform pressure on its free top, y = 1."""
    body = la.Body(mesh, CRITERION, kinematics, space)
    return la.Problem(
        {"plate": body},
        [la.Pressure("plate", la.Within(y=1.0), 1.0)],
        [la.Fix("plate", "base", "y"), la.Fix("plate", "left", "x")],
    )


@pytest.mark.parametrize(
    ("kind", "code", "space"),
    [
        ("triangle", "CPE3", "p2-vertex"),
        ("triangle6", "CPE6", "p2-vertex"),
        ("triangle6", "CPS6M", "p2-vertex"),
        ("quad", "CPE4R", "q2"),
        ("quad8", "CPE8RH", "q2"),
        ("quad9", "S9R5", "q2"),
    ],
)
def test_a_plate_of_abaqus_yields_uniformly(tmp_path, kind, code, space):
    """Uniaxial plane strain: 2 k on any elements, held by sets of nodes."""
    quads = kind.startswith("quad")
    make = la.meshes.quadrilaterals if quads else la.meshes.rectangle
    mesh = make((0, 2), (0, 1), 2, 2)
    points, elements = (mesh.p.T, mesh.t.T) if kind in CORNERS else second_order(mesh, kind)
    found = read(abaqus(tmp_path / "plate.inp", points, elements, code))
    assert found.nelements == mesh.nelements
    assert sorted(found.boundaries) == ["Nall", "again", "base", "left"]
    assert sorted(found.subdomains) == ["all", "high", "low"]
    sizes = {name: len(own) for name, own in found.subdomains.items()}
    assert sizes["low"] + sizes["high"] == sizes["all"] == mesh.nelements
    assert any("corner" in note for note in notes_of(found)), "a set without an edge is reported"
    state = la.solve(pressed(found, space))
    assert state.load_factor == pytest.approx(2.0, rel=1e-5)  # certified to 1e-6 of either side


def written(path, points, cells, boundary):
    """A file of gmsh with a group of lines."""
    lines = ("line", np.array(boundary))
    data = [np.full(len(own), 1 if kind == "line" else 2) for kind, own in (lines, *cells)]
    tags = {"gmsh:physical": data, "gmsh:geometrical": data}
    names = {"base": np.array([1, 1]), "soil": np.array([2, 2])}
    places = np.column_stack([points, np.zeros(len(points))])
    file = meshio.Mesh(places, [lines, *cells], cell_data=tags, field_data=names)
    meshio.gmsh.write(path, file, fmt_version="2.2", binary=False, float_fmt=".17g")
    return path


MIXED = (
    np.array([(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1), (3, 0.0)], dtype=float),
    [("quad", np.array([(0, 1, 4, 3), (1, 2, 5, 4)])), ("triangle", np.array([(2, 6, 5)]))],
    [(0, 1), (1, 2), (2, 6)],
)


def test_mixed_meshes_become_triangles_and_report_it(tmp_path):
    mesh = read(written(tmp_path / "mixed.msh", *MIXED))
    assert type(mesh).__name__ == "MeshTri1"
    assert mesh.nelements == 5
    assert len(mesh.boundaries["base"]) == 3
    assert mesh.subdomains["soil"].size == 5
    assert any("2 quadrilaterals divided" in note for note in notes_of(mesh))
    body = la.Body(mesh, CRITERION)
    assert "divided" in body.facts().told["file"]


def test_a_quadrilateral_that_is_not_convex_is_cut_along_its_inner_diagonal(tmp_path):
    points = np.array([(0, 0), (2, 0.0), (0.5, 0.5), (0, 2), (3, 0)])
    cells = [("quad", np.array([(0, 1, 2, 3)])), ("triangle", np.array([(1, 4, 2)]))]
    la.Body(read(written(tmp_path / "m.msh", points, cells, [(0, 1)])), CRITERION)


def test_collapsed_quadrilaterals_are_triangles(tmp_path):
    points, (quads, (_, triangle)), lines = MIXED
    collapsed = np.column_stack([triangle, triangle[:, -1]])
    whole = np.concatenate([quads[1], collapsed])
    mesh = read(written(tmp_path / "m.msh", points, [("quad", whole)], lines))
    assert mesh.nelements == 5
    la.Body(mesh, CRITERION)


def ring(kind):
    """A quarter ring of radii 1 and 2 with curved edges."""
    make = la.meshes.quadrilaterals if kind.startswith("quad") else la.meshes.rectangle
    mesh = make((1, 2), (0, np.pi / 2), 2, 4)
    round_ = la.meshes.isoparametric(mesh, lambda x: x[0] * np.array([np.cos(x[1]), np.sin(x[1])]))
    _, elements = second_order(mesh, kind)
    points = round_.p.T
    if kind == "quad8":
        elements = elements[:, :8]
        points = points[: mesh.nvertices + mesh.nfacets]
    bore = mesh.facets[:, mesh.facets_satisfying(lambda x: x[0] == 1, True)].T
    return round_, points, elements, bore


@pytest.mark.parametrize(
    ("kind", "space"), [("triangle6", "p2-gauss"), ("quad8", "q2"), ("quad9", "q2")]
)
@pytest.mark.parametrize("surface", [None, "soil"])
def test_curved_elements_keep_their_shape(tmp_path, kind, space, surface):
    """The area of the ring is that of the mesh in memory; its error is of fourth order."""
    round_, points, elements, bore = ring(kind)
    mesh = read(written(tmp_path / "ring.msh", points, [(kind, elements)], bore), surface)
    assert type(mesh) is type(round_)
    areas = [np.abs(signed_jacobians(own)).mean(axis=1).sum() for own in (mesh, round_)]
    size = 1 if kind.startswith("quad") else 0.5
    assert size * areas[0] == pytest.approx(3 / 4 * np.pi, rel=2e-3)
    # The serendipity element has another centre, hence an area that agrees to fourth order only.
    assert areas[0] == pytest.approx(areas[1], rel=2e-4 if kind == "quad8" else 1e-12)
    la.Body(mesh, CRITERION, space=space)
    assert mesh.boundaries["base"].size == len(bore)


def test_chords_in_place_of_curves_are_no_exact_body(tmp_path):
    _, points, elements, bore = ring("quad8")
    path = written(tmp_path / "ring.msh", points, [("quad8", elements)], bore)
    body = la.Body(read(path, elements="triangles"), CRITERION)
    assert body.geometry == "approximated"
    assert "chords" in body.facts().told["file"]


def test_curved_quadrilaterals_next_to_triangles_need_a_decision(tmp_path):
    _, points, elements, bore = ring("quad8")
    tri = np.array([(0, 1, 2, 3, 4, 5)])
    path = written(tmp_path / "m.msh", points, [("quad8", elements), ("triangle6", tri)], bore)
    with pytest.raises(la.InputError, match=r"(?s)curved edge.*elements='triangles'"):
        read(path)


def test_clockwise_quadrilaterals_are_turned(tmp_path):
    mesh = la.meshes.quadrilaterals((0, 2), (0, 1), 2, 2)
    turned = mesh.t.T[:, ::-1]
    found = read(written(tmp_path / "m.msh", mesh.p.T, [("quad", turned)], [(0, 1)]))
    assert isinstance(found, MeshQuad)
    assert np.all(signed_jacobians(found) > 0)


@pytest.mark.parametrize(("unit", "length"), [("ft", 0.3048), ("mm", 1e-3), (None, 1.0)])
def test_units_scale_the_load_factor_of_weight(tmp_path, unit, length):
    """The load factor of weight is proportional to strength divided by height."""
    points = np.array([(0, 0), (2, 0), (2, 1), (0, 1.0)])
    cells = [("triangle", np.array([(0, 1, 2), (0, 2, 3)]))]
    mesh = read(written(tmp_path / "m.msh", points, cells, [(0, 1)]), unit=unit)
    assert np.ptp(mesh.p[1]) == pytest.approx(length, rel=1e-15)
    assert any((unit or "no unit") in note for note in notes_of(mesh))
    assert la.solve(weighed(mesh)).load_factor * length == pytest.approx(
        la.solve(weighed(MeshTri(points.T, cells[0][1].T))).load_factor, rel=1e-5
    )


def weighed(mesh, strength=1.0, weight=1.0):
    floor = la.Fix("wall", la.Within(y=0.0))
    body = la.Body(mesh, la.VonMises(strength))
    return la.Problem({"wall": body}, [la.BodyForce("wall", (0, -weight))], [floor])


@pytest.mark.parametrize(
    ("scale", "strength", "weight", "warned"),
    [
        (1.0, 20e3, 18e3, False),
        (1000.0, 1.0, 1.0, False),  # without units
        (1000.0, 20e3, 18e3, True),
        (1000.0, 20e3, 1.0, True),
        (1000.0, 1.0, 18e3, True),
        (0.001, 20e3, 18e3, True),
        (0.001, 200e6, 1.0, False),  # a metal specimen
    ],
)
def test_dimensions_that_do_not_fit_weight_or_strength_are_reported(
    scale, strength, weight, warned
):
    mesh = MeshTri(scale * np.array([(0, 0), (4, 0), (4, 3), (0, 3.0)]).T, np.array(HALVES).T)
    found = la.solve(weighed(mesh, strength, weight)).findings
    assert any(own.kind is Kind.DIMENSIONS for own in found) == warned


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("*ELEMENT, TYPE=COH2D4\n1, 1, 2, 3, 4", ("line 5", "COH2D4")),
        ("*ELEMENT, TYPE=CPE3\n1, 1, 2", ("line 5", "3 nodes")),
        ("*ELEMENT, TYPE=CPE3\n1, 1, 2, 9", ("element 1", "nodes that the file lacks")),
        ("*NODE\n1, 0, 0", ("line 6", "node 1 is given twice")),
        ("*NSET, NSET=a\nmissing", ("line 6", "'missing'")),
        ("*NSET, NSET=a, GENERATE\n1", ("line 6", "GENERATE")),
        ("*INSTANCE, NAME=a\n1., 0., 0.", ("line 5", "instance")),
        ("*INCLUDE, INPUT=a.inp", ("line 5", "includes")),
        ("*ELEMENT, TYPE=CPE3\n1, 1, 2, 3\n*SURFACE, NAME=s\n1, S4", ("line 8", "S4")),
    ],
)
def test_lines_of_abaqus_that_cannot_be_read(tmp_path, text, parts):
    path = tmp_path / "bad.inp"
    path.write_text("*NODE\n1, 0, 0\n2, 1, 0\n3, 0, 1\n" + text + "\n")
    with pytest.raises(la.InputError, match="(?s)" + ".*".join(parts)):
        read(path)


def test_surfaces_of_elements_are_boundaries(tmp_path):
    path = tmp_path / "m.inp"
    path.write_text(
        "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n"
        "*ELEMENT, TYPE=CPE4, ELSET=soil\n1, 1, 2, 3, 4\n"
        "*SURFACE, NAME=bottom\nsoil, S1\n*SURFACE, NAME=sides\n1, S2\n1, S4\n"
    )
    mesh = read(path)
    assert {name: own.size for name, own in mesh.boundaries.items()} == {"bottom": 1, "sides": 2}
    ends = mesh.p[:, mesh.facets[:, mesh.boundaries["bottom"]]]
    assert np.all(ends[1] == 0)
