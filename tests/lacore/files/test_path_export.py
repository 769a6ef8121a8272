"""Files for ParaView, read again by meshio."""

from xml.etree import ElementTree

import numpy as np
import pytest

import lacore as la
from lacore.files.vtu import SERIES
from lacore.model.bodies.any_body import numbered
from lacore.model.bodies.blocks import masonry
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.nodal import element_means, node_means, vertex_means
from lacore.reporting.errors import InputError
from tests.lacore.paths.path_billets import billet, pressed, quad_billet
from tests.lacore.pictures.readings import column

meshio = pytest.importorskip("meshio")
ROUND_OFF = 1e-12  # of sums of tens of terms of order one


def test_a_state_within_a_step_is_as_strong_as_it_has_become(tmp_path):
    """Where flow is uniform: yield stress times strain rate is what is dissipated."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2, crossed=False)
    steel = la.VonMises(hardening=la.hardening.Linear(1.0, 3.0))
    bar = la.Problem(
        {"bar": la.Body(mesh, steel)},
        [la.RigidFooting("bar", "right", (1, 0), rough=False)],
        [la.Fix("bar", "left", "x"), la.Fix("bar", "bottom", "y")],
    )
    la.sequential(bar, 0.2, 2).state(2).to_vtu(tmp_path / "state.vtu")
    at = {name: own for name, (own,) in meshio.read(tmp_path / "state.vtu").cell_data.items()}
    # Uniform to the root of the solver's accuracy.
    np.testing.assert_allclose(
        at["yield_stress"] * at["equivalent_strain_rate"], at["dissipation"], rtol=1e-5
    )


def pressed_soil(cohesion, **more):
    """A block of soil, a pressure on its side, that a smooth platen has begun to press."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2, crossed=False)
    soil = la.Problem(
        {"soil": la.Body(mesh, la.MohrCoulomb(cohesion, 30.0, **more), space="p2-gauss")},
        [la.RigidFooting("soil", "top", (0, -1), rough=False)],
        [la.Fix("soil", "left", "x"), la.Fix("soil", "bottom", "y")],
        dead_loads=[la.Pressure("soil", "right", 0.5)],
    )
    return la.sequential(soil, 1e-4, 1, "explicit")


def cells_of(file):
    """Values at cells by name, of the only part."""
    return {name: own for name, (own,) in meshio.read(file).cell_data.items()}


def test_soils_without_strength_at_no_pressure(tmp_path):
    """A rate of K = 3 to the side: the deviator of (3, -1, 0) has sqrt(2/3) ||e|| = 2.404."""
    path = pressed_soil(0.0)
    path.last.to_vtu(tmp_path / "state.vtu")
    path.to_vtu(tmp_path / "path")
    exact = np.sqrt(2 / 3 * (np.sum(np.square([3, -1, 0])) - 4 / 3))
    for at in (cells_of(tmp_path / "state.vtu"), cells_of(tmp_path / "path" / "step-1.vtu")):
        # Velocities are known to the root of the solver's accuracy, the body to a step of 1e-4.
        assert at["equivalent_strain_rate"] == pytest.approx(exact, rel=1e-3)
        assert at["dissipation"] == pytest.approx(0.0, abs=1e-9)


def test_dissipation_along_a_path_of_soil(tmp_path):
    path = pressed_soil(1.0)
    at = cells_of(path.to_vtu(tmp_path).parent / "step-1.vtu")
    power = at["dissipation"] @ path.stage.dofs_at(path.stage.start)["soil"].volumes
    assert power == pytest.approx(path.history.plastic.iloc[0], rel=1e-3)  # of a step of 1e-4
    assert "yield_stress" not in at
    # Of flow that is not associated it depends on the stresses, which a path does not keep.
    kept = pressed_soil(1.0, dilation_angle=0.0).to_vtu(tmp_path / "other").parent
    assert "dissipation" not in cells_of(kept / "step-1.vtu")


@pytest.mark.parametrize(
    ("made", "kind"), [(billet, "triangle6"), (quad_billet, "quad9")], ids=["triangles", "quads"]
)
def test_series(tmp_path, made, kind):
    path = pressed(2, billet=made)
    file = path.to_vtu(tmp_path / "new" / "series")
    assert file == tmp_path / "new" / "series" / SERIES
    sets = ElementTree.parse(file).getroot().findall("Collection/DataSet")
    assert [float(own.get("timestep")) for own in sets] == [s.travel for s in path.snapshots]
    dofs = numbered(path.stage.bodies, BodyDofs.at)["billet"]
    for own, snapshot in zip(sets, path.snapshots, strict=True):
        mesh = meshio.read(file.parent / own.get("file"))
        cells, platen = mesh.cells
        assert (cells.type, platen.type) == (kind, "line")
        np.testing.assert_array_equal(cells.data.T, dofs.element_nodes)
        nodes = snapshot.configuration.nodes["billet"]
        own_nodes = slice(nodes.shape[1])
        np.testing.assert_array_equal(mesh.points[own_nodes, :2].T, nodes)
        assert set(mesh.points[platen.data.ravel(), 1]) == {1.0}
        now = path.stage.dofs_at(snapshot.configuration)["billet"]
        strain = snapshot.configuration.strain["billet"]
        law = now.body.criterion.law
        moved = nodes - path.snapshots[0].configuration.nodes["billet"]
        np.testing.assert_array_equal(mesh.point_data["displacement"][own_nodes, :2].T, moved)
        np.testing.assert_array_equal(
            mesh.point_data["velocity"][own_nodes, :2].T, snapshot.velocity["billet"]
        )
        at = {name: values for name, (values, _) in mesh.cell_data.items()}
        assert at.keys() == {
            *(
                "body",
                "region",
                "equivalent_strain",
                "equivalent_strain_rate",
                "yield_stress",
                "dissipation",
            )
        }
        assert at["equivalent_strain"] @ now.volumes == pytest.approx(
            float(np.sum(now.weights * strain)), abs=ROUND_OFF
        )
        # The law is linear, and means with it.
        np.testing.assert_allclose(
            at["yield_stress"], law.stress(at["equivalent_strain"]), rtol=ROUND_OFF
        )
        assert np.all(at["dissipation"] >= 0)
        assert not np.any(at["body"])
    # The power of the last step is what its load does: F0.u = 1, without friction and changes of
    # geometry and strength within half a step of 0.1 that shift it by about as much.
    row = path.history.iloc[-1]
    assert at["dissipation"] @ now.volumes == pytest.approx(row["plastic"], rel=0.2)


def test_order_of_nodes():
    """Each edge node lies between the two corners that VTK puts it between."""
    for made in (billet, quad_billet):
        problem, _ = made()
        dofs = numbered(dict(problem.bodies), BodyDofs.at)["billet"]
        places = dofs.nodes[:, dofs.element_nodes]
        corners = len(dofs.body.mesh.t)
        middles = (places[:, :corners] + np.roll(places[:, :corners], -1, axis=1)) / 2
        np.testing.assert_allclose(places[:, corners : 2 * corners], middles, atol=ROUND_OFF)


@pytest.mark.parametrize("made", [billet, quad_billet], ids=["triangles", "quads"])
@pytest.mark.parametrize("kinematics", ["plane_strain", "axisymmetric"])
def test_means(made, kinematics):
    """Between the least and the largest, of the same integral, exact for a uniform field."""
    body = made()[0].bodies["billet"]
    body = la.Body(
        body.mesh, body.criterion, kinematics, "q2" if made is quad_billet else "p2-gauss"
    )
    dofs = numbered({"b": body}, BodyDofs.at)["b"]
    values = np.random.default_rng(1).uniform(0.1, 2.0, dofs.weights.shape)
    vertex, node, element = (
        mean(dofs, values) for mean in (vertex_means, node_means, element_means)
    )
    for means in (vertex, node, element):
        assert values.min() < means.min() <= means.max() < values.max()
    assert element @ dofs.volumes == pytest.approx(float((dofs.weights * values).sum()))
    hat = vertex_means(dofs, np.ones_like(values))
    np.testing.assert_allclose(hat, 1, rtol=ROUND_OFF)
    # A linear field at nodes: its integral by the hats is that of the values.
    np.testing.assert_array_equal(node[: vertex.size], vertex)
    corners = body.mesh.t
    ends = dofs.element_nodes[: len(corners)]
    np.testing.assert_array_equal(node[ends], vertex[corners])
    np.testing.assert_allclose(
        node[dofs.element_nodes[len(corners) : 2 * len(corners)]],
        (vertex[corners] + np.roll(vertex[corners], -1, axis=0)) / 2,
    )


def test_limit_state_of_everything(tmp_path):
    """A continuum on rigid blocks beside a frame: one file."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2)
    soil = la.Body(mesh, la.VonMises(shear_strength=2.0))
    frame = la.Frame(
        {"A": (5, 0), "B": (5, 1), "C": (6, 1), "D": (6, 0)},
        {"AB": ("A", "B"), "BC": ("B", "C"), "CD": ("C", "D")},
        plastic_moment=1.0,
    )
    wall = masonry.stack([(1.0, 0.5), (1.0, 0.5)], 0.5)
    problem = la.Problem(
        bodies={"wall": wall, "soil": soil, "frame": frame},
        reference_loads=[
            la.Traction("soil", "top", (0, -1)),
            la.PointForce("frame", "B", (1, 0)),
            la.BodyForce("wall", (0.1, 0)),
        ],
        dead_loads=[la.BodyForce("wall", (0, -1))],
        supports=[
            la.Fix("soil", "bottom"),
            la.Fix("wall", "base"),
            la.Fix("frame", ("A", "D"), "clamped"),
        ],
    )
    state = la.solve(problem)
    state.to_vtu(tmp_path / "state.vtu")
    mesh = meshio.read(tmp_path / "state.vtu")
    assert {block.type for block in mesh.cells} == {"triangle6", "polygon", "line"}
    found = dict(zip((block.type for block in mesh.cells), mesh.cell_data["stress"], strict=True))
    stress = found["triangle6"]
    assert stress.shape[1] == 6
    dofs = state.discretisation.continua["soil"]
    np.testing.assert_allclose(
        stress[:, 0], element_means(dofs, state.stress["soil"][..., 0]), rtol=ROUND_OFF
    )
    assert np.all(np.isnan(found["line"]))
    bodies = dict(zip((block.type for block in mesh.cells), mesh.cell_data["body"], strict=True))
    assert {name: set(own) for name, own in bodies.items()} == {
        "triangle6": {1},
        "polygon": {0},
        "line": {2},
    }


def test_dissipation_is_yield_stress_times_strain_rate(tmp_path):
    """Element by element: rates and strengths have their units."""
    for kinematics in ("plane_strain", "plane_stress"):
        mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2)
        body = la.Body(mesh, la.VonMises(yield_stress=2.0), kinematics)
        problem = la.Problem(
            {"b": body}, [la.Traction("b", "top", (0, -1))], [la.Fix("b", "bottom")]
        )
        la.solve(problem).to_vtu(tmp_path / "a.vtu")
        at = {n: values for n, (values,) in meshio.read(tmp_path / "a.vtu").cell_data.items()}
        np.testing.assert_allclose(at["yield_stress"], 2.0, rtol=ROUND_OFF)
        np.testing.assert_allclose(
            at["dissipation"], 2.0 * at["equivalent_strain_rate"], rtol=1e-9, atol=ROUND_OFF
        )


def test_blocks(tmp_path):
    state = la.solve(column((1.0, 3.0), 0.9))
    state.to_vtu(tmp_path / "a.VTU")
    mesh = meshio.read(tmp_path / "a.VTU", file_format="vtu")
    assert all(block.type == "polygon" for block in mesh.cells)


def test_places_that_cannot_be_written(tmp_path):
    state = la.solve(column((1.0, 3.0), 0.9))
    with pytest.raises(InputError, match=r"let it end in \.vtu"):
        state.to_vtu(tmp_path / "a.vtk")
    with pytest.raises(InputError, match=r"path = .*cannot be written"):
        state.to_vtu(tmp_path / "nowhere" / "a.vtu")
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"folder = .*cannot be written"):
        pressed(1).to_vtu(tmp_path / "file")


def test_rigid_blocks_and_tools_are_where_they_are(tmp_path):
    """A block that is pushed from the right, and a tool that turns about its corner."""
    square = la.meshes.quadrilaterals(x=(0, 1), y=(0, 1), nx=1, ny=1)
    steel = la.VonMises(hardening=la.hardening.Linear(1.0, 1.0))
    pushed = la.Problem(
        {
            "body": la.Body(square, steel, space="q2"),
            "block": la.RigidBlock([(1, -0.5), (2, -0.5), (2, 1.5), (1, 1.5)]),
        },
        [la.PointForce("block", "block", (-1, 0))],
        [la.Fix("body", "left", "x"), la.Fix("body", "bottom", "y")],
        [la.Interface(("body", "right"), ("block", "block"), 0.0)],
    )
    path = la.sequential(pushed, 0.1, 1, control=la.ToolTravel({"block": (-1, 0)}))
    folder = path.to_vtu(tmp_path / "pushed").parent
    shape = meshio.read(folder / "step-1.vtu")
    flowing, block = shape.cells
    corners = shape.points[block.data[0]]
    assert (flowing.type, block.type) == ("quad9", "polygon")
    assert sorted(set(corners[:, 0].round(9))) == [0.9, 1.9]
    np.testing.assert_allclose(
        shape.point_data["displacement"][block.data[0]], [[-0.1, 0, 0]] * 4, atol=1e-9
    )
    speed = path.snapshots[1].velocity["block"][0, 0]
    np.testing.assert_allclose(shape.point_data["velocity"][block.data[0], 0], speed, rtol=1e-9)
    assert [int(own[0]) for own in shape.cell_data["body"]] == [0, 1]

    held = la.Problem({"body": pushed.bodies["body"]}, supports=pushed.supports)
    plane = la.Tool(la.shapes.plane((1, 0), (-1, 0)), ("body", "right"), (-1, 0))
    path = la.sequential(held, 0.1, 1, tools={"platen": plane})
    shape = meshio.read(path.to_vtu(tmp_path / "held").parent / "step-1.vtu")
    _, line = shape.cells
    assert line.type == "line"
    np.testing.assert_allclose(shape.points[line.data.ravel(), 0], 0.9, atol=1e-9)
