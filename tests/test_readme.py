"""README is short, leads to every page of the guide, and its generated parts have marks.

Its code is run with that of the guide.
"""

import re
from pathlib import Path

from tests.test_guide import ROOT
from tests.test_layers import script_of

README = (ROOT / "README.md").read_text(encoding="utf-8")
MOST_LINES = 110
MARKS = ("times", "end times", "comparison", "end")  # `make readme` writes between them
GUIDE = ROOT / "docs" / "guide"
ENTRANCES = ("start-structure.md", "start-solver.md")


def test_it_is_one_page():
    assert len(README.splitlines()) <= MOST_LINES
    assert README.count("```python") == 1
    assert README.count("![") == 2


def test_both_commands_are_named():
    assert "\nmake compare " in README
    assert "\nmake test " in README


def test_entrances_lead_to_every_page_of_the_guide():
    for entrance in ENTRANCES:
        assert f"(docs/guide/{entrance})" in README
    start = (ROOT / "docs" / "site" / "index.md").read_text(encoding="utf-8")
    texts = [(GUIDE / entrance).read_text(encoding="utf-8") for entrance in ENTRANCES]
    linked = {name for text in texts for name in re.findall(r"\]\(([\w-]+\.md)", text)}
    assert {page.name for page in GUIDE.glob("*.md")} == linked | {*ENTRANCES}
    for entrance in ENTRANCES:
        assert f":link: guide/{Path(entrance).stem}\n" in start


def test_engineers_read_nothing_of_couplings_before_they_are_explained():
    for page in (ROOT / "docs" / "site" / "index.md", GUIDE / "start-structure.md"):
        assert "coupling" not in page.read_text(encoding="utf-8")


def test_generated_parts_have_marks():
    places = [README.index(f"<!-- {mark} -->") for mark in MARKS]
    assert places == sorted(places)
    assert [README.count(f"<!-- {mark} -->") for mark in MARKS] == [1] * len(MARKS)


def test_pictures_of_the_guide_are_drawn_by_its_code():
    """`make readme` runs the pages; here only the names that it looks for are checked."""
    for picture, (page, drawn) in script_of("refresh").OF_GUIDE.items():
        text = (GUIDE / f"{page}.md").read_text(encoding="utf-8")
        blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
        (last,) = [number for number, code in enumerate(blocks) if f'"{picture}"' in code]
        assert re.search(rf"^{drawn} = ", "".join(blocks[: last + 1]), re.MULTILINE), picture


def test_cases_of_the_table_exist():
    refresh = script_of("refresh")
    runs = [*refresh.bracketed()]
    assert len(runs) == len(refresh.BRACKETED)
    for name in refresh.SOLVED:
        refresh.find(name)


def test_times_are_those_of_whole_commands(tmp_path):
    said = script_of("refresh").times(
        {"make nothing": ["true"], "lacore nothing": ["true", "--out"]}
    )
    number = r"\d+ s \(\d+ s of processor time\)"
    assert re.fullmatch(
        rf"On \d+ cores: `make nothing` {number}, `lacore nothing` {number}\.", said
    )
