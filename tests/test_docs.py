"""Every code block of docs/backends.md runs as printed, or stands in the file that it is from."""

import re
import shlex
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "backends.md").read_text(encoding="utf-8")
EXAMPLE = ROOT / "examples" / "lacore-ecos"
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


def test_commands_run(with_example):
    """The first is what the fixture does."""
    (text,) = of("sh")
    install, *commands = [shlex.split(line) for line in text.splitlines()]
    assert install == ["pip", "install", "./examples/lacore-ecos"]
    assert (ROOT / install[-1]).samefile(EXAMPLE)
    for program, *arguments in commands:
        assert program == "lacore"
        ran = with_example("verification", *arguments)
        assert ran.returncode == 0, ran.stderr
        assert "ecos" in ran.stdout


@pytest.mark.parametrize(
    "page", ["docs/backends.md", "docs/theory.md", "docs/benchmarks.md", "README.md"]
)
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


CITATION = re.compile(r"\((T\d[^()]*)\)|\bof (T\d+)")  # (T8, T15), (T17-T20), of T19


def test_every_formula_that_is_cited_is_in_the_theory():
    theory = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
    defined = set(re.findall(r"\*\*\(?(T\d+[bc]?)\b", theory))
    pages = [ROOT / "docs" / "backends.md", EXAMPLE / "lacore_ecos.py"]
    for path in [*pages, *ROOT.glob("lacore/*.py"), *ROOT.glob("backends/*.py")]:
        for both in CITATION.findall(path.read_text(encoding="utf-8")):
            cited = set(re.findall(r"T\d+[bc]?", "".join(both)))
            assert cited <= defined, path
