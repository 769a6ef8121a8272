"""The README's code runs as printed."""

import re
from pathlib import Path

import pytest
from click.testing import CliRunner

import lacore as la
from verification.commands import cli

README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")
FIRST, FILE, BOUNDS, PATH, WALL, MORE, RESULTS = re.findall(
    r"```python\n(.*?)```", README, flags=re.DOTALL
)


@pytest.fixture
def problem(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(FIRST, names)
    assert (tmp_path / "mechanism.png").stat().st_size > 0
    assert "strict upper bound" in capsys.readouterr().out
    return names["problem"]


def test_examples(problem):
    lines = [line for line in MORE.splitlines() if line.startswith("la.solve(")]
    assert len(lines) == 3
    for line in lines:
        state = eval(line, {"la": la, "problem": problem})
        assert state.status is la.Status.SOLVED, line


def test_file(monkeypatch, capsys):
    monkeypatch.chdir(Path(__file__).parents[1])
    exec(FILE, {"la": la})
    lower, upper = map(float, capsys.readouterr().out.split())
    # The best slip circle, an upper bound itself.
    assert lower < 5.53
    assert lower < upper


def test_bounds(problem, capsys):
    names = {"la": la, "problem": problem, "state": la.solve(problem)}
    exec(BOUNDS, names)
    assert "strict lower bound" in capsys.readouterr().out
    gap = names["upper"].load_factor - names["lower"].load_factor
    assert names["gaps"].total == pytest.approx(gap, rel=1e-5)


@pytest.mark.slow
def test_path(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    names = {"la": la}
    exec(PATH, names)
    printed = capsys.readouterr().out
    assert "reached" in printed
    assert "contact closed" in printed
    for made in ("billet.npz", "billet.png", "billet.gif", "billet/path.pvd"):
        assert (tmp_path / made).stat().st_size > 0
    # The load of a smooth billet, twice the shear stress, from below: friction adds to it.
    path = names["path"]
    assert path.history["load_factor"].iloc[0] > 2 / 3**0.5


def test_results_are_a_table(tmp_path, monkeypatch, capsys):
    """After the sweep that stands above it."""
    (line,) = re.findall(r"^lacore (sweep .* reports/r)$", README, re.MULTILINE)
    monkeypatch.chdir(tmp_path)
    assert CliRunner().invoke(cli.main, line.split()).exit_code == 0
    names = {}
    exec(RESULTS, names)
    slopes = names["slopes"].set_index("error")["slope"]
    # (T19), to what the analysis lets local slopes differ by.
    assert slopes["error_alpha_reg"] == pytest.approx(1, abs=0.1)
    assert slopes["error_lambda"] == pytest.approx(2, abs=0.2)
    assert "newton" in capsys.readouterr().out


def test_wall(capsys):
    exec(WALL, {"la": la})
    printed = capsys.readouterr().out
    assert "exact" in printed
    assert "found, not proven: that none is lower" in printed


def test_case_is_that_of_the_example():
    (excerpt,) = re.findall(r"```py\n(.*?)```", README, flags=re.DOTALL)
    example = Path(__file__).parents[1] / "examples" / "cases" / "block_on_step.py"
    assert excerpt in example.read_text(encoding="utf-8")


def test_every_backend_is_named():
    for name in la.backend_names():
        assert f"| `{name}` |" in README
