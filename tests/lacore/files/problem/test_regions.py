"""Regions, strengths that vary, sections: as the same in Python, and once more through a file."""

import numpy as np
import pytest

import lacore as la

GROUND = """\
[bodies.ground]
kind = "continuum"
mesh = {mesh}
{regions}
[bodies.ground.material]
fill = {{ criterion = "mohr-coulomb", cohesion = "2 kPa", friction_angle = 30 }}
clay = {{ criterion = "von-mises", shear_strength = {strength} }}

[[supports]]
body = "ground"
where = "bottom"
[[reference_loads]]
load = "pressure"
body = "ground"
where = {{ x = [0, 1], y = 0 }}
value = 1000
"""
LAYERED = (
    '{ shape = "layered", x = [0, 4], layers = { clay = [-2, -1], fill = [-1, 0] },'
    " nx = 4, ny = 4 }"
)
RECTANGLE = '{ shape = "rectangle", x = [0, 4], y = [-2, 0], nx = 4, ny = 4 }'
LINEAR = '{ value = "10 kPa", gradient = [0, "-2 kPa/m"], at = [0, -1] }'
TABLE = '{ levels = [-2, -1.2, 0], values = ["12 kPa", "10.4 kPa", "8 kPa"] }'

FRAME = """\
[bodies.portal]
kind = "frame"
nodes = { A = [0, 0], B = [0, 4], C = [6, 4], D = [6, 0], E = [9, 0], F = [3, 0] }
members.left = ["A", "B"]
members.beam = ["B", "C"]
members.right = ["C", "D"]
members.stay = ["C", "E"]
members.post = ["F", "B"]
members.arm = ["F", "C"]
sections.left = { name = "HEA 200", yield_stress = "235 MPa" }
sections.beam = { width = "10 cm", height = "20 cm", yield_stress = "235 MPa" }
sections.right = "rigid"
sections.stay = { tension = "50 kN", compression = 0 }
sections.post = { height = 0.3, width = 0.2, web = "8 mm", flange = "12 mm", yield_stress = 235e6 }
sections.arm = { name = "IPE 80", yield_stress = "235 MPa", layers = 4, polygon = "outer" }
[[supports]]
body = "portal"
where = ["A", "D", "E", "F"]
[[reference_loads]]
load = "point-force"
body = "portal"
at = "B"
vector = ["10 kN", 0]
"""


def read(folder, mesh=RECTANGLE, regions="", strength=LINEAR):
    file = folder / "ground.toml"
    file.write_text(GROUND.format(mesh=mesh, regions=regions, strength=strength), encoding="utf-8")
    return la.read_problem(file)


@pytest.mark.parametrize(
    ("mesh", "regions"),
    [
        (RECTANGLE, "regions = { fill = { y = [-1, 0] }, clay = { y = [-2, -1] } }"),
        (
            RECTANGLE,
            "regions = { fill = { point = [0, -1], normal = [0, 1] },"
            " clay = { point = [0, -1], normal = [0, -2] } }",
        ),
        (LAYERED, ""),
        (
            '{ shape = "patches", parts = ['
            '{ corners = [[0, -1], [4, -1], [4, 0], [0, 0]], nx = 4, ny = 2, name = "fill" },'
            '{ corners = [[0, -2], [4, -2], [4, -1], [0, -1]], nx = 4, ny = 2, name = "clay" }] }',
            "",
        ),
    ],
    ids=["boxes", "half-planes", "layered", "patches"],
)
def test_regions_of_all_kinds_are_one_problem(mesh, regions, tmp_path):
    layers = la.meshes.layered((0, 4), {"clay": (-2, -1), "fill": (-1, 0)}, 4, 4)
    clay = la.VonMises(shear_strength=lambda x: 10e3 - 2e3 * (x[1] + 1))
    own = la.Problem(
        bodies={"ground": la.Body(layers, {"fill": la.MohrCoulomb(2e3, 30.0), "clay": clay})},
        supports=[la.Fix("ground", "bottom")],
        reference_loads=[la.Pressure("ground", lambda x: (x[1] == 0) & (x[0] <= 1), 1e3)],
    )
    problem = read(tmp_path, mesh, regions)
    # The same program in another order: the two solves end within the solver's own tolerance.
    assert la.solve(problem).load_factor == pytest.approx(la.solve(own).load_factor, rel=1e-6)
    la.write_problem(problem, tmp_path / "again.toml")
    again = la.solve(la.read_problem(tmp_path / "again.toml"))
    assert again.load_factor == pytest.approx(la.solve(problem).load_factor, rel=1e-12)


def test_a_table_whose_levels_run_through_elements_bounds_strictly(tmp_path):
    """It is the same straight line here, which its least and greatest values enclose."""
    regions = "regions = { fill = { y = [-1, 0] }, clay = { y = [-2, -1] } }"
    table = read(tmp_path, regions=regions, strength=TABLE)
    above = la.upper_bound(table)
    assert above.rigor is la.Rigor.UPPER
    straight = read(tmp_path, regions=regions)
    assert above.load_factor >= la.upper_bound(straight).load_factor * (1 - 1e-6)


@pytest.mark.parametrize(
    ("regions", "strength", "said"),
    [
        ("regions = { fill = { y = [-1, 0] } }", "1", r":7: .*material.clay.*no such region"),
        (
            "regions = { fill = { y = [-1.1, 0] }, clay = { y = [-2, -1.1] } }",
            "1",
            r":4: bodies.ground.regions.fill: its line runs through the element",
        ),
        ("regions = { fill = { y = [1, 2] } }", "1", r":4: .*regions.fill: no element is there"),
        (
            "regions = { fill = { y = [-1, 0] }, clay = { y = [-2, -1] } }",
            '{ value = "1 kPa", gradient = [0, "2 kPa/m"] }',
            r":7: .*clay.shear_strength.* at \(.*negative",
        ),
        (
            "regions = { fill = { y = [-1, 0] }, clay = { y = [-2, -1] } }",
            '{ value = "1 kPa", gradient = [0, "2 kPa"] }',
            r":7: .*shear_strength.gradient\[1\] = '2 kPa': 'kPa' does not fit",
        ),
        (
            "regions = { fill = { y = [-1, 0] }, clay = { y = [-2, -1] } }",
            "{ levels = [0, 0], values = [1, 2] }",
            r":7: .*shear_strength.levels = .*: a level is there twice",
        ),
    ],
)
def test_what_cannot_be_is_said(regions, strength, said, tmp_path):
    with pytest.raises(la.InputError, match=said):
        read(tmp_path, regions=regions, strength=strength)


def test_sections_of_frames(tmp_path):
    (tmp_path / "frame.toml").write_text(FRAME, encoding="utf-8")
    problem = la.read_problem(tmp_path / "frame.toml")
    frame = problem.bodies["portal"]
    sections = {
        "left": la.sections.standard("HEA 200", 235e6),
        "beam": la.sections.rectangle(0.1, 0.2, 235e6),
        "right": la.sections.rigid(),
        "stay": la.sections.bar(50e3, 0),
        "post": la.sections.i_section(0.3, 0.2, 0.008, 0.012, 0.0, 235e6),
        "arm": la.sections.standard("IPE 80", 235e6, 4, "outer"),
    }
    own = la.Frame(frame.nodes, frame.members, sections=sections)
    load = la.solve(problem).load_factor
    same = la.Problem({"portal": own}, problem.reference_loads, problem.supports)
    assert load == pytest.approx(la.solve(same).load_factor, rel=1e-12)
    la.write_problem(problem, tmp_path / "again.toml")
    again = la.read_problem(tmp_path / "again.toml")
    assert la.solve(again).load_factor == pytest.approx(load, rel=1e-12)


@pytest.mark.parametrize(
    ("section", "said"),
    [
        (
            '{ name = "IPE 310", yield_stress = 1 }',
            r"left.name = 'IPE 310': no section of the table; did you mean 'IPE",
        ),
        ('{ name = "IPE 300" }', r"sections.left: missing; add yield_stress"),
        ('{ name = "IPE 300", yield_stress = "2 kN" }', r"left.yield_stress = '2 kN': 'kN' does"),
        ('{ name = "IPE 300", yield_stress = -1 }', r"left.yield_stress = -1: not a positive"),
        ('{ name = "IPE 300", yield_stress = 1, layers = 0 }', r"left.layers = 0: out of range"),
        ('{ name = "IPE 300", yield_stress = 1, polygon = "in" }', r"left.polygon = 'in': unknown"),
        (
            "{ height = 0.3, width = 0.2, web = 0.3, flange = 0.01, yield_stress = 1 }",
            r"sections.left.web = 0.3: web, flanges and fillets do not fit",
        ),
        (
            '{ height = "300 kg", width = 0.2, web = 0.01, flange = 0.01, yield_stress = 1 }',
            r"left.height = '300 kg': 'kg' does not fit: this is in m",
        ),
        ('"rigd"', r"sections.left = 'rigd': unknown; did you mean 'rigid'"),
        ("{ tension = -1 }", r"sections.left.tension = -1: not a strength"),
        ("{ corners = [[-1, 0], [-2, 1]] }", r"sections.left.corners"),
        ("{ }", r"sections.left: missing; add yield_stress, name"),
    ],
)
def test_what_is_no_section_is_said(section, said, tmp_path):
    text = FRAME.replace('{ name = "HEA 200", yield_stress = "235 MPa" }', section)
    assert section in text
    (tmp_path / "frame.toml").write_text(text, encoding="utf-8")
    with pytest.raises(la.InputError, match=rf"frame.toml:10: bodies.portal.*{said}") as told:
        la.read_problem(tmp_path / "frame.toml")
    assert told.value.fix


@pytest.mark.parametrize("given", [(), (2.0,), (2.0, 0.5), (0.0, 3.0)])
def test_bars_come_back_from_a_file(tmp_path, given):
    bar = la.Frame({"a": (0, 0), "b": (1, 0)}, {"m": ("a", "b")}, sections=la.sections.bar(*given))
    fixed = [la.Fix("f", "a"), la.Fix("f", "b", "y")]
    problem = la.Problem({"f": bar}, [la.PointForce("f", "b", (1, 0))], fixed)
    la.write_problem(problem, tmp_path / "bar.toml")
    again = la.read_problem(tmp_path / "bar.toml").bodies["f"]
    assert again.section_of[0].corners == bar.section_of[0].corners


@pytest.mark.parametrize(
    "section",
    [
        la.sections.plastic(2.0),
        la.sections.plastic(2.0, 0.0),
        la.sections.plastic(2.0, 0.5),
        la.sections.polygon([(-4, -1), (-2, 2), (1, 0), (0, -1)]),
        la.sections.fibres([(0.2, 0, 3.0), (-0.2, 1.0, 0.0)], "beam"),
    ],
)
def test_sections_unlike_in_two_senses_come_back_from_a_file(tmp_path, section):
    beam = la.Frame({"a": (0, 0), "b": (1, 0)}, {"m": ("a", "b")}, sections=section)
    fixed = [la.Fix("f", "a", "clamped"), la.Fix("f", "b", "y")]
    problem = la.Problem({"f": beam}, [la.Traction("f", "m", (0, -1))], fixed)
    la.write_problem(problem, tmp_path / "beam.toml")
    again = la.read_problem(tmp_path / "beam.toml").bodies["f"].section_of[0]
    same = (again.corners, again.lower, again.name)
    assert same == (section.corners, section.lower, section.name)


def test_places_and_functions_by_numbers():
    x = np.array([[0.0, 1.0, 2.0], [0.0, -1.0, 1.0]])
    assert la.Within(x=(0, 1))(x).tolist() == [True, True, False]
    assert la.Beyond((0, 0), (0, 3))(x).tolist() == [True, False, True]
    assert la.Along((0, 0), (2, 1))(x).tolist() == [True, False, True]
    assert la.Linear(1.0, (2.0, 3.0), (0.0, 1.0))(x).tolist() == [-2.0, -3.0, 5.0]
    assert la.ByLevel([1, -1], [2, 6])(x).tolist() == [4.0, 6.0, 2.0]


def test_functions_by_numbers_in_space():
    x = np.array([[0.0, 1.0, 2.0], [0.0, -1.0, 1.0], [0.5, 0.0, 1.0]])
    assert la.Linear(1.0, (2.0, 3.0, 4.0))(x).tolist() == [3.0, 0.0, 12.0]
    assert la.ByLevel([1, 0], [2, 6])(x).tolist() == [4.0, 6.0, 2.0]
    with pytest.raises(la.InputError, match="2 numbers, where places have 3"):
        la.Linear(1.0, (2.0, 3.0))(x)
    with pytest.raises(la.InputError, match="space of gradient"):
        la.Linear(1.0, (2.0, 3.0), at=(0.0, 0.0, 1.0))


HEAVY = '{ value = "18 kN/m3", gradient = ["0.1 kN/m4", "-2 kN/m3/m"], at = [0, -1] }'
BY_LEVEL = '{ levels = [-2, -1, 0], values = ["22 kN/m3", "19 kN/m3", 16000] }'


@pytest.mark.parametrize(
    ("stated", "own"),
    [
        (f"weight'\nunit_weight = {HEAVY}", la.Linear(-18e3, (-100.0, 2e3), at=(0.0, -1.0))),
        (f"weight'\nunit_weight = {BY_LEVEL}", la.ByLevel([-2, -1, 0], [-22e3, -19e3, -16e3])),
        (
            "body-force'\nvector = [0, { value = -18000, gradient = [-100, 2000], at = [0, -1] }]",
            la.Linear(-18e3, (-100.0, 2e3), at=(0.0, -1.0)),
        ),
    ],
    ids=["linear", "by level", "body force"],
)
def test_weights_that_vary_are_those_of_python_and_come_again(stated, own, tmp_path):
    """The forces of the file, of the same in Python, and of the file that is written of it."""
    text = GROUND.format(mesh=LAYERED, regions="", strength=LINEAR)
    file = tmp_path / "ground.toml"
    file.write_text(f"{text}[[dead_loads]]\nbody = 'ground'\nload = '{stated}\n", encoding="utf-8")
    problem = la.read_problem(file)
    mine = problem.with_loads(problem.reference_loads, [la.BodyForce("ground", (0, own))])
    la.write_problem(mine, tmp_path / "again.toml")
    again = la.read_problem(tmp_path / "again.toml")
    loads = [la.discretise(one).full.dead_load for one in (mine, problem, again)]
    assert np.array_equal(loads[0], loads[1])
    assert np.array_equal(loads[0], loads[2])


def test_a_weight_in_the_wrong_unit_names_the_line(tmp_path):
    text = GROUND.format(mesh=LAYERED, regions="", strength=LINEAR)
    wrong = "{ value = '18 kN/m3', gradient = [0, '-2 kPa/m'], at = [0, -1] }"
    file = tmp_path / "ground.toml"
    load = f"[[dead_loads]]\nbody = 'ground'\nload = 'weight'\nunit_weight = {wrong}\n"
    file.write_text(text + load, encoding="utf-8")
    with pytest.raises(la.InputError, match="does not fit") as refused:
        la.read_problem(file)
    assert "gradient" in str(refused.value)


@pytest.mark.parametrize(
    ("stated", "own"),
    [
        (
            '{ value = 25, gradient = [0, "-4 deg/m"], at = [0, -1] }',
            la.Linear(25.0, (0.0, -4.0), at=(0.0, -1.0)),
        ),
        (
            '{ levels = [-1, 0], values = ["30 deg", 20] }',
            la.Field(la.ByLevel([-1, 0], [30.0, 20.0]), steepest=10.0),
        ),
    ],
    ids=["linear", "by level"],
)
def test_angles_that_vary_are_those_of_python_and_come_again(stated, own, tmp_path):
    text = GROUND.format(mesh=LAYERED, regions="", strength=LINEAR)
    text = text.replace("friction_angle = 30", f"friction_angle = {stated}")
    file = tmp_path / "ground.toml"
    file.write_text(text, encoding="utf-8")
    problem = la.read_problem(file)
    la.write_problem(problem, tmp_path / "again.toml")
    again = la.read_problem(tmp_path / "again.toml")
    mesh = problem.bodies["ground"].mesh
    fill = la.MohrCoulomb(2e3, own)
    mine = la.Body(mesh, {"fill": fill, "clay": problem.bodies["ground"].criterion["clay"]})
    forms = [body.regions[0] for body in (mine, *(p.bodies["ground"] for p in (problem, again)))]
    for region in forms[1:]:
        for one, two in ((region.form, forms[0].form), (region.within, forms[0].within)):
            surfaces, others = (form.surfaces_of(region.elements) for form in (one, two))
            assert np.array_equal(surfaces.slope, others.slope)
            assert np.array_equal(surfaces.strength, others.strength)
