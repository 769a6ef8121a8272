"""README and guide run as printed, page by page; numbers that they state are those that come out.

A block under ``<!-- slow -->`` is run, with all others of its page, by a slow test only. Numbers of
the prose are computed as well: ``<!-- 5.14: 2 + pi; 94: state.load_factor -->`` beside it says how,
by what the code before it has made; ``<!-- slow 94: ... -->`` where that is slow. What cannot be
computed here says why: ``<!-- typed 0.1075: Milankovitch 1907 -->``.
"""

import ast
import math
import re
import shlex
import tomllib
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from pkgutil import resolve_name

import click
import matplotlib.pyplot as plt
import pytest
from click.testing import CliRunner

import lacore as la
from lacore_verification.commands import cli
from lacore_verification.harness.verify import ask

ROOT = Path(__file__).parents[1]
BLOCK = re.compile(r"(?:<!-- (slow|from \S+) -->\n)?```(\w+)\n(.*?)```", flags=re.DOTALL)
NUMBER = r"[-+]?(?:\d+\.?\d*(?:e[-+]?\d+)?|inf)"
MARK = re.compile(rf"<!-- (slow |typed |)({NUMBER}(?:, {NUMBER})*: .*?) -->", flags=re.DOTALL)
PAGES = {
    page.stem: page.read_text(encoding="utf-8")
    for page in (
        ROOT / "README.md",
        ROOT / "CONTRIBUTING.md",
        ROOT / "docs" / "limitations.md",
        *(ROOT / "docs" / "site" / f"{name}.md" for name in ("index", "claims", "notation")),
        *sorted((ROOT / "docs" / "guide").glob("*.md")),
    )
}
BLOCKS = {name: BLOCK.findall(text) for name, text in PAGES.items()}
NAMES = {"printed": "", "math": math, "of": resolve_name}
"""What code of a page begins with: what is printed, and what marks may ask for."""


def python(page, slow):
    """Code of a page in its order, and numbers of its prose, with or without what is slow."""
    found = []
    for piece in re.finditer(f"{BLOCK.pattern}|{MARK.pattern}", PAGES[page], flags=re.DOTALL):
        mark, kind, text, when, numbers = piece.groups()
        if kind == "python" and (not mark or (slow and mark == "slow")):
            found.append(text)
        elif when == "" or (slow and when == "slow "):
            found.append("\n".join(f"print({how})  # {said}" for said, how in marked(numbers)))
    return found


def marked(numbers):
    """Numbers of a mark, and what is said of each."""
    parts = (part.partition(": ") for part in " ".join(numbers.split()).split("; "))
    return [(said, how) for said, _, how in parts]


def run(code, names):
    """Statement by statement: where a comment with numbers follows, these are what is printed."""
    lines = code.splitlines()
    for statement in ast.parse(code).body:
        printed = StringIO()
        with redirect_stdout(printed):
            exec(compile(ast.Module([statement], []), "<guide>", "exec"), names)
        stated = lines[statement.end_lineno - 1].partition("  # ")[2]
        if printed.getvalue() and re.match(rf"[\[(]?{NUMBER}", stated):
            agrees(stated, printed.getvalue())
        names["printed"] += printed.getvalue()


def agrees(stated, printed):
    """The numbers that a comment begins with, each to one unit of its last digit."""
    first = re.match(rf"[\[\]() ,]*(?:{NUMBER}[\[\]() ,]*)+", stated)[0]
    found = re.findall(NUMBER, printed)
    for told, was in zip(re.findall(NUMBER, first), found, strict=False):
        digits, _, power = told.partition("e")
        unit = 10.0 ** (int(power or 0) - len(digits.partition(".")[2]))
        assert float(was) == pytest.approx(float(told), abs=unit, rel=0), (stated, printed)
    assert len(found) >= len(re.findall(NUMBER, first)), (stated, printed)


@pytest.fixture
def somewhere(tmp_path, monkeypatch):
    """An empty folder but for the examples, as the root of the repository has them."""
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    (tmp_path / "reports").mkdir()
    (tmp_path / "reports" / "reference").symlink_to(ROOT / "reports" / "reference")
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    plt.close("all")


QUICK = [page for page in PAGES if python(page, slow=False)]
SLOW = [page for page in QUICK if python(page, slow=True) != python(page, slow=False)]


@pytest.mark.parametrize("page", QUICK)
def test_quick_code_runs_as_printed(page, somewhere):
    if page == "programs-as-files":
        (export,) = [line for line in shell(page) if line.endswith("--out instances")]
        assert CliRunner().invoke(cli.main, shlex.split(export)[1:]).exit_code == 0
    names = dict(NAMES)
    for text in python(page, slow=False):
        run(text, names)
    check_quick = {"README": check_readme, "bounds": check_gap, "numbers": check_forged}
    check_quick.get(page, check_nothing)(names)


def check_nothing(names):
    pass


def check_readme(names):
    """The output below the code is what the code prints."""
    (stated,) = [text for _, kind, text in BLOCKS["README"] if kind == "text"]
    assert re.sub(NUMBER, "0", stated) == re.sub(NUMBER, "0", names["printed"])
    numbers = (re.findall(NUMBER, text) for text in (stated, names["printed"]))
    for digits, number in zip(*numbers, strict=True):
        agrees(digits, number)
    assert "strict upper bound" in names["printed"]
    assert Path("mechanism.png").stat().st_size > 0


def check_gap(names):
    assert "strict lower bound" in names["printed"]
    assert names["gaps"].least > -1e-9  # round-off: shares are not below 0


def check_forged(names):
    assert names["state"].certify().holds(1e-6)
    assert not names["forged"].holds(1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("page", SLOW)
def test_all_code_runs_as_printed(page, somewhere):
    names = dict(NAMES)
    for text in python(page, slow=True):
        run(text, names)
    check_all = {
        "friction": check_friction,
        "large-deformation": check_path,
        "bounds": check_gap,
        "footing": check_footing,
    }
    check_all.get(page, check_nothing)(names)


def check_friction(names):
    """The search finds more than a tenth below what one solve reports, as the page says."""
    range_of_wall = names["searched"]
    assert range_of_wall.low < 0.9 * names["state"].interval().high
    assert "not proven: a lower one may exist" in names["printed"]
    assert names["found"].low > names["found"].continuum[1]  # of the discrete problem


def check_path(names):
    assert "contact closed" in names["printed"]
    for made in ("billet.npz", "billet.png", "billet.gif", "billet/path.pvd"):
        assert Path(made).stat().st_size > 0
    # The load of a smooth billet, twice the shear stress, from below: friction adds to it.
    first, *_ = re.findall(r"step 1: load factor ([\d.]+)", names["printed"])
    assert float(first) > 2 / 3**0.5
    # The wedge touches ever more of the body.
    assert names["indentation"].message.startswith("reached")
    forces = names["indentation"].history["force"]
    assert forces.is_monotonic_increasing, forces


def check_footing(names):
    """Bounds close in from both sides; what is searched lies below the bound that still holds."""
    table = names["table"]
    assert table.lower.is_monotonic_increasing
    assert table.upper.is_monotonic_decreasing
    assert (table.lower < table.upper).all()
    assert names["load_range"].high <= names["upper"].load_factor
    assert Path("footing.csv").stat().st_size > 0


@pytest.mark.slow
def test_slopes_of_the_sweep_that_stands_above_them(somewhere):
    (sweep,) = [line for line in shell("sweeps") if line.endswith("--out reports/r")]
    assert CliRunner().invoke(cli.main, shlex.split(sweep)[1:]).exit_code == 0
    names = dict(NAMES)
    for text in python("sweeps", slow=False):
        run(text.replace("reports/reference", "reports/r"), names)
    slopes = names["slopes"].set_index("error")["slope"]
    # (T19), to what the analysis lets local slopes differ by.
    assert slopes["error_alpha_reg"] == pytest.approx(1, abs=0.1)
    assert slopes["error_lambda"] == pytest.approx(2, abs=0.2)


def shell(page):
    """Commands of a page, a line each, without their comments."""
    texts = [text for _, kind, text in BLOCKS[page] if kind == "sh"]
    lines = [line.partition("  #")[0] for text in texts for line in text.splitlines()]
    return [line.partition(" > ")[0].strip() for line in lines]


@pytest.mark.parametrize("page", [page for page in PAGES if shell(page)])
def test_commands_are_understood(page, monkeypatch):
    """Names of cases, options and values, without running them."""
    monkeypatch.chdir(ROOT)
    targets = re.findall(
        r"^([\w-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE
    )
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    for line in shell(page):
        program, *words = shlex.split(line)
        if program == "lacore":
            command = cli.main.get_command(click.Context(cli.main), words[0])
            command.make_context(words[0], words[1:])
        elif program == "make":
            assert words[0] in targets
        elif program == "pip":
            (extra,) = re.findall(r"\[(\w+)\]", line) or [None]
            assert extra is None or extra in project["optional-dependencies"]
        else:
            assert (program, *words[:2]) == ("pytest", "verification", "-k")
            assert words[2] in [question.name for question in ask([words[2].partition("-clar")[0]])]


@pytest.mark.parametrize("page", PAGES)
def test_every_block_is_of_a_kind_that_is_tested(page):
    assert PAGES[page].count("```") == 2 * len(BLOCKS[page])
    kinds = {"python", "sh", "toml", *(["text"] if page == "README" else [])}
    assert {kind for _, kind, _ in BLOCKS[page]} <= kinds
    for mark, _, text in BLOCKS[page]:
        if mark.startswith("from "):
            assert text in (ROOT / mark.removeprefix("from ")).read_text(encoding="utf-8")


def test_every_backend_is_named():
    for name in la.backend_names():
        assert f"| `{name}` |" in PAGES["solvers"]
