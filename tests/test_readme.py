"""README is one page: what it shows stays what it is, and every page of the guide is named.

Its code is run with that of the guide.
"""

from pathlib import Path

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
MOST_LINES = 140
MARKS = ("times", "end times", "comparison", "end")  # `make readme` writes between them


def test_it_is_one_page():
    assert len(README.splitlines()) <= MOST_LINES
    assert README.count("```python") == 1
    assert README.count("![") == 1


def test_every_page_of_the_guide_is_named():
    for page in (ROOT / "docs" / "guide").glob("*.md"):
        assert f"(docs/guide/{page.name})" in README


def test_what_is_computed_has_its_place():
    places = [README.index(f"<!-- {mark} -->") for mark in MARKS]
    assert places == sorted(places)
    assert [README.count(f"<!-- {mark} -->") for mark in MARKS] == [1] * len(MARKS)
