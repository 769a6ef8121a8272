"""The README's code runs as printed."""

import re
from pathlib import Path

import pytest

import lacore as la

README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")
FIRST, WALL, MORE = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)


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
