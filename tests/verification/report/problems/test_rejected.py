"""`lacore solve` with analyses that reject the problem: before the first solve, or later."""

import pytest

import lacore as la
from lacore.reporting.errors import InputError
from lacore_verification.report.problems import answers, bounding, starters
from tests.lacore.files.problem import footing
from tests.verification.command_line import lacore


@pytest.fixture
def solves(monkeypatch):
    """The problems that are solved."""
    seen, solved = [], la.solve
    monkeypatch.setattr(answers.la, "solve", lambda *given: seen.append(given) or solved(*given))
    return seen


@pytest.mark.parametrize("option", [("--safety",), ("--bracket", "0.05")])
@pytest.mark.parametrize(
    "material",
    [
        'criterion = "mohr-coulomb", cohesion = 0, friction_angle = "20 deg"',
        'criterion = "drucker-prager", cohesion = 0, friction_angle = "20 deg"',
        'criterion = "no-tension"',
    ],
)
def test_soil_without_cohesion_is_rejected_before_the_first_solve(
    option, material, tmp_path, solves
):
    file, text = tmp_path / "slope.toml", starters.text("slope")
    given = 'criterion = "mohr-coulomb", cohesion = "10 kPa", friction_angle = "20 deg"'
    assert given in text
    file.write_text(text.replace(given, material), encoding="utf-8")
    result = lacore("solve", file, "--out", tmp_path, *option)
    assert result.exit_code == 2
    assert "cohesion" in result.stderr
    assert not solves


def test_what_was_solved_is_printed_before_a_late_rejection(tmp_path, monkeypatch, solves):
    """Of an analysis that rejects only after the load factor is known; the exit code is 2."""

    def rejecting(*given, **options):
        raise InputError("problem", 1, "too large", "make it smaller")

    monkeypatch.setattr(bounding.la, "bracket", rejecting)
    file = tmp_path / "footing.toml"
    file.write_text(footing.TEXT, encoding="utf-8")
    result = lacore("solve", file, "--out", tmp_path, "--bracket", "0.05")
    assert result.exit_code == 2
    assert len(solves) == 1
    assert f"{la.solve(footing.problem()).load_factor:.6g}, strict upper" in result.stdout
    assert "too large" in result.stderr
