"""Problem files with meshes in other units, piezometric lines, and lists of boundaries."""

import numpy as np
import pytest

import lacore as la

TEXT = """
[bodies.soil]
kind = "continuum"
mesh = { file = "soil.vtk", unit = "ft" }
material = { criterion = "mohr-coulomb", cohesion = "10 kPa", friction_angle = 20 }
boundaries.top = { y = 0 }
boundaries.left = { x = 0 }
boundaries.right = { x = "4 ft" }
boundaries.base = { y = "-2 ft" }

[[supports]]
body = "soil"
where = ["left", "right"]
components = "x"

[[supports]]
body = "soil"
where = "base"

[[dead_loads]]
load = "pore-pressure"
body = "soil"
pressure = { points = [[0, "-0.5 ft"], ["4 ft", "-1 ft"]] }

[[reference_loads]]
load = "pressure"
body = "soil"
where = "top"
value = 1000
"""


def written(folder, text=TEXT):
    la.meshes.rectangle((0, 4), (-2, 0), 4, 4).save(str(folder / "soil.vtk"))
    path = folder / "soil.toml"
    path.write_text(text)
    return path


def test_a_file_in_feet_with_a_piezometric_line(tmp_path):
    problem = la.read_problem(written(tmp_path))
    body = problem.bodies["soil"]
    assert np.ptp(body.mesh.p, axis=1) == pytest.approx([4 * 0.3048, 2 * 0.3048])
    assert problem.supports[0].where == ("left", "right")
    (water,) = problem.dead_loads
    ends = np.array([[0, 4 * 0.3048], [-2 * 0.3048] * 2])
    assert water.pressure(ends) == pytest.approx(9.81e3 * 0.3048 * np.array([1.5, 1.0]))


def test_the_file_survives_writing(tmp_path):
    problem = la.read_problem(written(tmp_path))
    la.write_problem(problem, tmp_path / "again.toml")
    again = la.read_problem(tmp_path / "again.toml")
    assert again.dead_loads == problem.dead_loads
    assert np.allclose(again.bodies["soil"].mesh.p, problem.bodies["soil"].mesh.p, rtol=1e-15)


def test_unknown_keys_are_answered_with_all_valid_ones(tmp_path):
    text = TEXT.replace('unit = "ft"', 'units = "ft"')
    with pytest.raises(la.InputError) as found:
        la.read_problem(written(tmp_path, text))
    for key in ("did you mean 'unit'?", "elements", "file", "merge", "surface"):
        assert key in str(found.value)
