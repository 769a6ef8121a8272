"""What is written is read as the same problem; what no file can state is refused."""

import numpy as np
import pytest

import lacore as la
from lacore.reporting.errors import InputError
from tests.lacore.files.problem import footing
from tests.lacore.shown import portal, wall


def written(problem, folder, name="own"):
    la.write_problem(problem, folder / f"{name}.toml", "A title")
    return la.read_problem(folder / f"{name}.toml")


def square(**more):
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    fields = {
        "bodies": {"soil": la.Body(mesh, la.MohrCoulomb(5e3, 25.0, tension_cutoff=100.0))},
        "supports": [la.Fix("soil", "bottom")],
        "reference_loads": [la.Traction("soil", "top", (1e3, -2e3))],
        "dead_loads": [la.BodyForce("soil", (0, -18e3)), la.PorePressure("soil", 3.0)],
    }
    return la.Problem(**(fields | more))


def contact():
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    return la.Problem(
        bodies={
            "soil": la.Body(mesh, la.VonMises(yield_stress=1e4), space="p2-gauss"),
            "stone": la.RigidBlock([(0, 1), (1, 1), (0.5, 2)]),
        },
        interfaces=[
            la.Interface(("soil", "top"), ("stone", la.Along((0, 1), (1, 1))), la.BOND),
            la.Interface(
                ("soil", "bottom"),
                la.RigidObstacle((0, 0), (0, 1)),
                la.Coulomb(0.5, associated=True, adhesion=10.0, tension=2.0),
            ),
            la.Interface(("soil", "left"), la.RigidObstacle(), la.Tresca(3e3)),
        ],
        reference_loads=[la.PointForce("stone", "block", (10.0, -1.0))],
        dead_loads=[la.StandingWater("soil", "right", la.WaterTable(0.5))],
    )


def in_water():
    """Standing water by its numbers, on places by theirs."""
    side = la.Beyond((1.0, 0.0), (1.0, 0.0))
    return square(
        dead_loads=[
            la.StandingWater("soil", side, la.Linear(9.81e3, (0.0, -9.81e3))),
            la.StandingWater("soil", "left", la.ByLevel([0.0, 1.0], [8e3, 0.0])),
        ]
    )


def rough():
    """A coefficient of friction that would be read as an angle if it stood alone."""
    return wall(la.Coulomb(30.0))


@pytest.mark.parametrize(
    "state",
    [square, contact, wall, portal, lambda: wall(la.Coulomb(0.7, True)), in_water, rough],
)
def test_it_is_read_as_the_same_problem(state, tmp_path):
    """All that is shown of it, its program to the last digit, and its file once more."""
    problem = state()
    read = written(problem, tmp_path)
    again = written(read, tmp_path, "again")
    text, other = ((tmp_path / f"{name}.toml").read_text() for name in ("own", "again"))
    assert text == other
    for own in (read, again):
        assert str(own) == str(problem)
        programs = [la.discretise(one).program for one in (problem, own)]
        for load in ("reference_load", "dead_load"):
            assert np.array_equal(*(getattr(program, load) for program in programs))
        for one, two in zip(*(program.groups for program in programs), strict=True):
            assert (one.rows != two.rows).nnz == 0


def test_shapes_of_a_file_stay_shapes(tmp_path):
    file = tmp_path / "footing.toml"
    file.write_text(footing.TEXT, encoding="utf-8")
    written(la.read_problem(file), tmp_path)
    text = (tmp_path / "own.toml").read_text(encoding="utf-8")
    assert 'shape = "rectangle"' in text
    assert not list(tmp_path.glob("*.npz"))


def test_a_mesh_that_was_changed_since_is_no_shape(tmp_path):
    file = tmp_path / "footing.toml"
    file.write_text(footing.TEXT, encoding="utf-8")
    problem = la.read_problem(file)
    mesh = problem.bodies["clay"].mesh
    mesh.doflocs[:, 0] += 1e-3
    assert written(problem, tmp_path).bodies["clay"].mesh.doflocs[0, 0] == mesh.doflocs[0, 0]
    assert list(tmp_path.glob("*.npz"))


def test_curves_names_and_order_are_kept(tmp_path):
    flat = la.meshes.quadrilaterals((0, 1), (0, 1), 2, 2)
    curved = la.meshes.isoparametric(flat, lambda x: np.stack([x[0], x[1] * (2 - x[0])]))
    la.meshes.save(curved, tmp_path / "own.npz")
    read = la.meshes.load(tmp_path / "own.npz")
    assert type(read) is type(curved)
    assert np.array_equal(read.doflocs, curved.doflocs)
    assert np.array_equal(read.t, curved.t)
    assert read.boundaries.keys() == curved.boundaries.keys()
    assert all(
        np.array_equal(read.boundaries[own], curved.boundaries[own]) for own in read.boundaries
    )


@pytest.mark.parametrize(
    ("problem", "said"),
    [
        (square(supports=[la.Fix("soil", lambda x: x[1] == 0)]), r"supports\[0\].where.*functions"),
        (
            square(reference_loads=[la.Pressure("soil", lambda x: x[1] == 1, 1.0)]),
            r"reference_loads\[0\].where.*name the boundary",
        ),
        (
            square(dead_loads=[la.PorePressure("soil", lambda x: 0 * x[0])]),
            r"dead_loads\[0\].pressure.*WaterTable",
        ),
        (
            la.Problem(
                {
                    "cube": la.Body(
                        la.meshes.box((0, 1), (0, 1), (0, 1), 1, 1, 1),
                        la.VonMises(1.0),
                        kinematics="3d",
                    )
                },
                [la.Traction("cube", "top", (0.0, 0.0, -1.0))],
                [la.Fix("cube", "bottom")],
            ),
            "kinematics = '3d'.*plane problems",
        ),
        (3, "problem = 3: no Problem"),
    ],
)
def test_what_no_file_can_state_is_refused(problem, said, tmp_path):
    with pytest.raises(InputError, match=said):
        la.write_problem(problem, tmp_path / "own.toml")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "law",
    [
        la.hardening.Perfect(3.0),
        la.hardening.Linear(1.0, 2.5),
        la.hardening.Voce(1.0, 2.0, 7.0),
        la.hardening.Swift(3.0, 0.01, 0.2),
        la.hardening.Table([0, 0.1, 0.5], [1, 2, 3]),
    ],
)
def test_a_law_of_hardening_comes_back(law, tmp_path):
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    soil = {"soil": la.Body(mesh, la.VonMises(hardening=law))}
    read = written(square(bodies=soil, dead_loads=[]), tmp_path)
    assert read.bodies["soil"].criterion.hardening == law


def test_a_law_of_your_own_is_refused(tmp_path):
    class Own:
        def stress(self, strain):
            return 1.0 + 0 * np.asarray(strain)

        def modulus(self, strain):
            return 0 * np.asarray(strain)

    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    soil = {"soil": la.Body(mesh, la.VonMises(hardening=Own()))}
    with pytest.raises(InputError, match=r"criterion.hardening.*a file has no functions"):
        la.write_problem(square(bodies=soil, dead_loads=[]), tmp_path / "a.toml")


def test_what_is_no_saved_mesh_is_refused(tmp_path):
    file = tmp_path / "a.npz"
    file.write_bytes(b"PK no")
    for path, said in [
        (file, "is not a mesh"),
        (tmp_path / "b.npz", "no such file"),
        ("a.msh", "npz"),
    ]:
        with pytest.raises(InputError, match=said):
            la.meshes.load(path)
    with pytest.raises(InputError, match="cannot be written"):
        la.meshes.save(la.meshes.rectangle((0, 1), (0, 1), 1, 1), tmp_path / "no" / "a.npz")
