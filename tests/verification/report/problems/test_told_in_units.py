"""All that `lacore solve` tells of a file is in the units that the file is written in."""

import csv
import html
import json
import re

import pytest

import lacore as la
from lacore.reporting import views
from lacore.reporting.units import LENGTHS, STRESSES, Units
from tests.verification.command_line import lacore
from tests.verification.report.problems.test_more import PORTAL

GROUND = """\
[solve]
units = { force = "FORCE", length = "LENGTH" }
stable = true
[bodies.clay]
kind = "continuum"
material = { criterion = "von-mises", shear_strength = 20e3 }
mesh = { shape = "rectangle", x = [0, 2], y = [-1, 0], nx = 2, ny = 1 }
[bodies.stone]
kind = "block"
outline = [[0.2, 0], [1, 0], [1, 0.5], [0.2, 0.5]]
[[supports]]
body = "clay"
where = "bottom"
[[interfaces]]
slave = { body = "stone", where = { x = [0.2, 1], y = 0 } }
master = { body = "clay", where = "top" }
friction = { mu = 0.5, associated = true, adhesion = 2e3 }
[[dead_loads]]
load = "weight"
body = "stone"
unit_weight = 24e3
[[reference_loads]]
load = "point-force"
body = "stone"
at = [0.6, 0.5]
vector = [2e3, -1e3]
"""
SIZES = {**LENGTHS, **STRESSES, "N": 1.0, "lbf": 4.4482216152605}
PAGE = {"N": "Pa", "lbf": "psf"}


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """The folders and documents of one problem in two choices of units."""
    folder, found = tmp_path_factory.mktemp("units"), {}
    for force, length in (("N", "mm"), ("lbf", "cm")):
        file = folder / f"{force}.toml"
        text = GROUND.replace("FORCE", force).replace("LENGTH", length)
        file.write_text(text, encoding="utf-8")
        result = lacore("solve", file, "--out", folder / force, "--json", "--sensitivity")
        assert result.exit_code == 0, result.output
        found[force] = folder / force, json.loads(result.stdout), length
    return found


def test_a_document_says_its_units(answers):
    for force, (_, document, length) in answers.items():
        told = {"force": force, "length": length, "stress": PAGE[force]}
        assert document["units"] == told


def test_values_and_derivatives_of_sensitivities_are_in_them(answers):
    tables = [own[1]["sensitivity"]["table"] for own in answers.values()]
    names = {"mm": "cm", "Pa": "psf", "N/m": "lbf/ft", "N/m^3": "lbf/ft^3", "": ""}
    per = {"N/m": 1 / 0.3048, "N/m^3": 1 / 0.3048**3}
    seen = set()
    by_value = [sorted(table, key=lambda row: row["parameter"][:22]) for table in tables]
    for metric, other in zip(*by_value, strict=True):
        assert names[metric["unit"]] == other["unit"]
        size = {"": 1.0, "mm": 10.0, "Pa": SIZES["psf"]}.get(metric["unit"])
        size = size or SIZES["lbf"] * per[metric["unit"]]
        assert metric["value"] == pytest.approx(size * other["value"], rel=1e-9)
        # To what both solves agree.
        if metric["derivative"] is not None:  # what is beside the body has none
            assert other["derivative"] == pytest.approx(size * metric["derivative"], rel=1e-4)
            assert metric["elasticity"] == pytest.approx(other["elasticity"], rel=1e-4, abs=1e-6)
        seen.add(metric["unit"])
    assert seen == {"mm", "Pa", "N/m", "N/m^3", ""}


def test_tables_are_in_them(answers):
    tables = []
    for folder, _, _ in answers.values():
        files = sorted((folder / "tables").glob("tables-*.csv"))
        tables.append(
            [list(csv.DictReader(file.read_text(encoding="utf-8").splitlines())) for file in files]
        )
    compared = 0
    for metric, other in zip(*tables, strict=True):
        for row, same in zip(metric, other, strict=True):
            for (head, value), (also, twin) in zip(row.items(), same.items(), strict=True):
                if "[mm]" in head:
                    assert also == head.replace("mm", "cm")
                    assert float(value) == pytest.approx(10 * float(twin), abs=1e-6)
                    compared += 1
                assert "[m]" not in head
    assert compared > 10


def test_texts_of_a_page_are_in_them(answers):
    for force, (folder, _, length) in answers.items():
        page = (folder / "index.html").read_text(encoding="utf-8")
        said = page[: page.index('id="file"')]  # the file itself is as it is written
        said = html.unescape(re.sub(r"<(style|script).*?</\1>|<[^>]*>", " ", said, flags=re.S))
        assert f"(x = {'200 to 1000' if force == 'N' else '20 to 100'} {length}" in said
        amounts = re.findall(r"\d (k?Pa|psi|psf|MPa|N|lbf|m|mm|cm|ft)\b(?!/)", said)
        assert {PAGE[force], length} <= set(amounts) <= {PAGE[force], length, force}, amounts


def test_pictures_are_in_them(tmp_path):
    file = tmp_path / "my.toml"
    file.write_text(GROUND.replace("FORCE", "N").replace("LENGTH", "mm"), encoding="utf-8")
    problem = la.read_problem(file)
    state, units = la.solve(problem), Units("N", "mm")
    stands = la.stable(problem)
    for figure in (
        views.picture(problem, units=units),
        views.picture(state, units=units),
        views.picture(stands, units=units),
    ):
        labels = [text for axes in figure.axes for text in (axes.get_xlabel(), axes.get_ylabel())]
        assert any("[mm]" in text for text in labels)
        assert not any("[m]" in text or "[kN" in text for text in labels)
        maps = [axes for axes in figure.axes if axes.get_xlabel() == "x [mm]"]
        assert maps
        for axes in maps:
            texts = [own.get_text() for own in axes.get_xticklabels()]
            ticks = [float(own.replace("\N{MINUS SIGN}", "-")) for own in texts]
            assert ticks == pytest.approx([1e3 * place for place in axes.get_xticks()])


def test_frames_are_told_in_feet(tmp_path):
    file = tmp_path / "portal.toml"
    asked = '[solve]\nunits = { force = "kip", length = "ft" }\n'
    file.write_text(PORTAL + asked, encoding="utf-8")
    result = lacore("solve", file, "--out", tmp_path / "out", rendered=False)
    assert "(0, -0.2248089) kip at (6.56168, 9.84252) ft of portal" in result.output
    hinges = (tmp_path / "out" / "tables").glob("*hinges*.csv")
    head, *rows = next(hinges).read_text(encoding="utf-8").splitlines()
    assert "moment [kip ft],plastic moment [kip ft]" in head
    own = dict(zip(head.split(","), rows[0].split(","), strict=True))
    # 10 kN m, as N m over the newtons of a kip and the metres of a foot.
    assert float(own["plastic moment [kip ft]"]) == pytest.approx(10e3 / 4448.2216152605 / 0.3048)


def test_unknown_units_are_refused_with_their_line(tmp_path):
    file = tmp_path / "portal.toml"
    file.write_text('[solve]\nunits = { length = "mile" }\n' + GROUND[GROUND.index("[bodies") :])
    result = lacore("solve", file)
    assert result.exit_code == 2
    assert "portal.toml:2: solve.units.length = 'mile': unknown; known" in result.output
