"""Every code block of docs/backends.md runs as printed, or stands in the file that it is from.

Links of all pages lead somewhere, and what pages and docstrings name exists.
"""

import re
import shlex
import tomllib
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest

import lacore as la
from lacore.reporting.errors import DISTRIBUTION
from tests.test_layers import PLACES, script_of

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "backends.md").read_text(encoding="utf-8")
EXAMPLE = ROOT / "examples" / "lacore-ecos"
HISTORY = "CHANGELOG.md"  # says what was where
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
BLOCK = re.compile(r"(?:<!-- from (\S+) -->\n)?```(\w+)\n(.*?)```", flags=re.DOTALL)
BLOCKS = BLOCK.findall(PAGE)
QUOTED = [(source, text) for source, _, text in BLOCKS if source]


def of(language):
    return [text for source, kind, text in BLOCKS if kind == language and not source]


def test_every_block_is_of_a_kind_that_is_tested():
    assert PAGE.count("```") == 2 * len(BLOCKS)
    assert {kind for _, kind, _ in BLOCKS} == {"python", "toml", "sh"}
    assert len(QUOTED) >= 5


def test_python_blocks_run_in_order():
    names = {}
    for text in of("python"):
        exec(compile(text, "docs/backends.md", "exec"), names)
    assert set(names["findings"].verdict) == {"pass"}
    force, along = names["slope"], names["program"].reference_load
    assert force.shape == along.shape


@pytest.mark.parametrize(("source", "text"), QUOTED)
def test_quotations_are_true(source, text):
    assert text in (ROOT / source).read_text(encoding="utf-8")


def test_registration_is_that_of_the_example():
    (text,) = of("toml")
    assert text in (EXAMPLE / "pyproject.toml").read_text(encoding="utf-8")


@pytest.mark.slow
def test_commands_run(with_example):
    """The first is what the fixture does."""
    (text,) = of("sh")
    install, *commands = [shlex.split(line) for line in text.splitlines()]
    assert install == ["pip", "install", "./examples/lacore-ecos"]
    assert (ROOT / install[-1]).samefile(EXAMPLE)
    for program, *arguments in commands:
        assert program == "lacore"
        ran = with_example("lacore_verification", *arguments)
        assert ran.returncode == 0, ran.stderr
        assert "ecos" in ran.stdout


PAGES = sorted(
    str(page.relative_to(ROOT))
    for pattern in ("*.md", "docs/**/*.md", "examples/**/*.md")
    for page in ROOT.glob(pattern)
)


@pytest.mark.parametrize("page", PAGES)
def test_links_within_the_repository_lead_somewhere(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)]+)\)", text):
        file, _, anchor = target.partition("#")
        if file.startswith("http"):
            continue
        found = (ROOT / page).parent / file if file else ROOT / page
        assert found.exists(), target
        if anchor:
            headings = re.findall(r"^#+ (.*)$", found.read_text(encoding="utf-8"), re.MULTILINE)
            made = [re.sub(r"[^\w\- ]", "", h).lower().replace(" ", "-") for h in headings]
            assert anchor in made, target


def test_design_decisions_stay_short():
    """One paragraph and one table each; complete measurements are in the history of the file."""
    text = (ROOT / "docs" / "design-decisions.md").read_text(encoding="utf-8")
    assert len(text.split()) <= 6000


CITATION = re.compile(r"\((T\d[^()]*)\)|\bof (T\d+)")  # (T8, T15), (T17-T20), of T19
CODE = [
    path
    for house in ("lacore", "verification", "backends")
    for path in sorted((ROOT / house).rglob("*.py*"))
    if path.suffix in (".py", ".pyi")
]


def test_every_formula_that_is_cited_is_in_the_theory():
    theory = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
    defined = set(re.findall(r"\*\*\(?(T\d+[bc]?)\b", theory))
    for path in [*CODE, *(ROOT / page for page in PAGES), EXAMPLE / "lacore_ecos.py"]:
        for both in CITATION.findall(path.read_text(encoding="utf-8")):
            cited = set(re.findall(r"T\d+[bc]?", "".join(both)))
            assert cited <= defined, path


def test_all_statements_of_the_version_agree():
    """The version is `lacore.__version__`; tests/test_wheel.py compares it with the wheel."""
    dynamic = PYPROJECT["tool"]["setuptools"]["dynamic"]
    assert PYPROJECT["project"]["dynamic"] == ["version"]
    assert dynamic == {"version": {"attr": "lacore.__version__"}}
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    released = re.findall(r"^## (\S+) ", (ROOT / HISTORY).read_text(encoding="utf-8"), re.MULTILINE)
    assert f"\nversion: {la.__version__}\n" in citation
    assert f"\nlicense: {PYPROJECT['project']['license']}\n" in citation
    assert released[0] == la.__version__


INSTALLED = re.compile(r"pip install '?([\w.-]+)\[([\w,]+)\]")


def test_optional_dependencies_are_installed_by_the_name_of_the_distribution():
    """`pip install lacore` would install an unrelated project."""
    pages = [ROOT / page for page in PAGES if page != HISTORY]
    named = [
        found
        for path in [*CODE, *pages, *ROOT.glob("examples/**/*.py")]
        for found in INSTALLED.findall(path.read_text(encoding="utf-8"))
    ]
    assert {name for name, _ in named} == {".", DISTRIBUTION}
    assert {extra for _, extra in named} <= PYPROJECT["project"]["optional-dependencies"].keys()
    assert PYPROJECT["project"]["name"] == DISTRIBUTION


NAME = re.compile(r"(?<![\w./-])(?:lacore|lacore_backends|lacore_verification)(?:\.[A-Za-z_]\w+)+")
FILE = re.compile(r"(?<![\w./-])(?:lacore|verification|backends|docs|examples|tests)/[\w./-]*\w")
GROUPS = {"lacore.backends", "lacore.cases"}  # of entry points, not modules


def test_modules_and_files_that_are_named_exist():
    """In pages, docstrings, comments and strings, where no import would see that one has moved."""
    dead = []
    pages = [ROOT / page for page in PAGES if page != HISTORY]
    for path in [*CODE, *pages, *ROOT.glob("docs/*.py"), *ROOT.glob("tests/**/*.py")]:
        text = path.read_text(encoding="utf-8")
        names = {name for name in NAME.findall(text) if not name.endswith((".py", ".md"))}
        wrong = [name for name in names - GROUPS if not _known(name)]
        named = {file for file in FILE.findall(text) if "NAME" not in file}
        wrong += [file for file in named if not (ROOT / file).exists()]
        dead += [f"{path.relative_to(ROOT)}: {name}" for name in wrong]
    assert not dead


@cache
def _known(name):
    """Whether a module has that name, or something in one; only the latter is imported."""
    parts = name.split(".")
    folder = PLACES[parts[0]].parent
    places = [folder.joinpath(*parts[:count]) for count in range(1, len(parts) + 1)]
    found = sum(place.is_dir() or place.with_suffix(".py").exists() for place in places)
    if found == len(parts):
        return True
    thing = import_module(".".join(parts[:found]))
    for part in parts[found:]:
        fields = getattr(thing, "__annotations__", {})  # without a default they are no attributes
        if not hasattr(thing, part):
            return part in fields
        thing = getattr(thing, part)
    return True


def test_the_page_on_architecture_counts_packages_and_is_short():
    """`make architecture` writes the counts."""
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    for pattern, count in script_of("architecture").counts().items():
        ((before, after),) = re.findall(pattern, page)
        assert f"{before}{count}{after}" in page
    assert len(page.split()) <= 900


@pytest.mark.slow
@pytest.mark.parametrize("name", list(script_of("entries").MOST))
def test_the_page_on_architecture_counts_entries_into_packages(name):
    """`python docs/entries.py` writes the counts, which depend on the iterations of solvers."""
    counting = script_of("entries")
    page = counting.PAGE.read_text(encoding="utf-8")
    ((counted, most),) = re.findall(rf"\| {name} \| (\d+) \| (\d+) \|", page)
    assert int(most) == counting.MOST[name]
    found = counting.entries(counting.analyses()[name]).total()
    assert int(counted) == pytest.approx(found, rel=0.05)
    assert found <= counting.MOST[name]
