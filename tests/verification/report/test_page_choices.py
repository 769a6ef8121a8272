"""What a reader chooses on a page, and how wide its tables are, in a real Chromium."""

import pandas as pd
import pytest

from lacore_verification.report.blocks import (
    Card,
    Cards,
    Details,
    Filters,
    Page,
    PageLink,
    Section,
    Table,
    Text,
)
from lacore_verification.report.columns import Column
from tests.verification.report.browser import WIDTHS


def chosen(page):
    """What the address keeps, by name."""
    parts = page.evaluate("location.hash").lstrip("#").split("&")
    return dict(part.split("=", 1) for part in parts if "=" in part)


def cards_shown(page):
    return page.locator("article:visible h3").all_text_contents()


SAMPLE = {
    "Arch": ("masonry", "pass", 3.0),
    "Beam": ("frames", "FAIL", 1.0),
    "Cut": ("soil", "pass", 2.0),
    "Dam": ("masonry", "pass", 0.5),
}

SOLVERS = ["exact", "quick"]


@pytest.fixture
def listed(alone):
    """A list of cards in an order of its own, with a table of all their rows, and a second page."""
    cards, rows = [], []
    for name, (tag, verdict, seconds) in SAMPLE.items():
        frame = pd.DataFrame({"variant": [name.lower()], "verdict": [verdict]})
        own = Table([Column("variant"), Column("verdict")], frame, sortable=False, stacked=True)
        cards.append(
            Card(
                PageLink(name, "index.html", f"about {name}"), None, own,
                name=name, tags=[tag], verdicts=[verdict], seconds=seconds,
                runs=[f"quick\t{verdict}", *(["exact\tpass"] if tag == "masonry" else [])],
            )
        )  # fmt: skip
        rows.append({"case": name, "time, s": seconds})
    table = Table([Column("case"), Column("time, s", form="g")], pd.DataFrame(rows), card="case")
    filters = Filters(["frames", "masonry", "soil"], ["pass", "FAIL"], "as given", SOLVERS)
    rates = Table([Column("backend")], pd.DataFrame({"backend": SOLVERS}))
    sections = [
        Section("cases", "Cases", [filters, Cards(cards), Details("All", [table])]),
        Section("more", "More", [Text("text"), rates]),
    ]
    return alone(Page("Cards", "", sections))


def reopened(visit, seen):
    """The same address, opened afresh: after a page in between nothing is kept but the address."""
    page = seen.page
    address = page.url
    page.goto("about:blank")
    page.goto(address)
    return page


@pytest.mark.parametrize(
    ("name", "value", "shown"),
    [
        ("q", "about arch", ["Arch"]),
        ("q", "BEAM", ["Beam"]),
        ("q", "nowhere", []),
        ("verdict", "FAIL", ["Beam"]),
        ("tag", "masonry", ["Arch", "Dam"]),
        ("solver", "exact", ["Arch", "Dam"]),
        ("order", "solve time", ["Arch", "Cut", "Beam", "Dam"]),
        ("order", "title", ["Arch", "Beam", "Cut", "Dam"]),
    ],
)
def test_the_address_keeps_search_filters_and_order(visit, listed, name, value, shown):
    seen = visit(listed)
    control = seen.page.locator(f".filters [name={name}]")
    if name == "q":
        control.fill(value)
    else:
        control.select_option(value)
    assert cards_shown(seen.page) == shown
    assert chosen(seen.page)[name] == value.replace(" ", "+")
    page = reopened(visit, seen)
    assert cards_shown(page) == shown
    assert page.locator(f".filters [name={name}]").input_value() == value
    assert page.locator(".filters output").text_content() == f"{len(shown)} of 4 cases"
    assert seen.complaints == []


def test_choices_are_combined_and_taken_back(visit, listed):
    seen = visit(listed)
    page = seen.page
    page.locator("[name=tag]").select_option("masonry")
    page.locator("[name=q]").fill("dam")
    assert cards_shown(page) == ["Dam"]
    # Rows of the table of all cases follow their cards.
    rows = "rows => rows.filter(row => !row.hidden).map(row => row.cells[0].textContent)"
    assert page.locator("tr[data-card]").evaluate_all(rows) == ["Dam"]
    page.locator("[name=q]").fill("")
    page.locator("[name=tag]").select_option("")
    assert cards_shown(page) == list(SAMPLE)
    assert "#" not in page.url


def test_a_solver_hides_the_rows_of_others(visit, listed):
    """Only its own verdicts count, and links to other pages take the choice along."""
    seen = visit(listed)
    page = seen.page
    page.locator("[name=solver]").select_option("exact")
    assert page.locator("tr[data-solver]:visible").all_text_contents() == ["exact"]
    links = page.locator("article:visible h3 a")
    assert [link.get_attribute("href") for link in links.all()] == ["index.html#solver=exact"] * 2
    page.locator("[name=verdict]").select_option("FAIL")
    assert cards_shown(page) == []
    page.locator("[name=solver]").select_option("quick")
    assert cards_shown(page) == ["Beam"]
    page.locator("[name=solver]").select_option("")
    assert page.locator("tr[data-solver]:visible").all_text_contents() == SOLVERS
    assert page.locator("article a").first.get_attribute("href") == "index.html"
    assert seen.complaints == []


def test_the_page_of_a_case_shows_one_solver(visit, page_of_case):
    seen = visit(page_of_case)
    seen.page.goto("about:blank")
    seen.page.goto(f"{seen.address}#solver=newton")
    shown = seen.page.locator("tr[data-solver]:visible")
    assert {row.get_attribute("data-solver") for row in shown.all()} == {"newton"}
    assert seen.page.locator("[name=solver]").input_value() == "newton"
    assert seen.complaints == []


def test_the_address_keeps_column_and_direction(visit, listed):
    """Also of a table in a fold, beside what is chosen, and the place that a link leads to."""
    seen = visit(listed)
    page = seen.page
    page.locator("summary").click()
    head = seen.head(1).locator("button")
    head.click()
    head.click()
    assert chosen(page) == {"sort-cases": "time-s%2Cdown"}
    page.locator("[name=verdict]").select_option("pass")
    page.locator("nav a", has_text="More").click()
    page.wait_for_function("location.hash.startsWith('#more&')")
    page = reopened(visit, seen)
    assert page.url.endswith("#more&sort-cases=time-s%2Cdown&verdict=pass")
    assert seen.column(0) == ["Arch", "Cut", "Beam", "Dam"]
    assert seen.head(1).get_attribute("aria-sort") == "descending"
    assert cards_shown(page) == ["Arch", "Cut", "Dam"]
    assert seen.complaints == []


def test_a_third_press_gives_the_first_order_back(sorted_page):
    first = sorted_page.column(0)
    button = sorted_page.head(0).locator("button")
    for _ in range(3):
        button.click()
    assert sorted_page.column(0) == first
    assert sorted_page.head(0).get_attribute("aria-sort") is None
    assert "#" not in sorted_page.page.url


@pytest.mark.parametrize(
    "address",
    [
        "#sort-one=nothing,up",
        "#sort-none=name,up",
        "#verdict=no+such&q=%",
        "#%",
        "#=",
        "#&&",
        "#a=b",
    ],
)
def test_any_address_shows_the_page(visit, listed, address):
    seen = visit(listed)
    seen.page.goto("about:blank")
    seen.page.goto(seen.address + address)
    assert seen.page.locator("article").count() == 4
    assert seen.page.locator(".filters").is_visible()
    assert seen.complaints == []


def test_a_comparison_lists_its_cases_with_filters(visit, compared):
    """The real page has them from a few cases on; of two it needs none."""
    assert visit(compared).page.locator(".filters").count() == 0


@pytest.mark.parametrize("place", ["compared", "page_of_case"])
def test_no_table_is_wider_than_a_page_of_1300_pixels(visit, request, place):
    page = visit(request.getfixturevalue(place), width=1300).page
    page.evaluate("document.querySelectorAll('details').forEach(part => part.open = true)")
    excess = "parts => parts.map(part => part.scrollWidth - part.clientWidth)"
    widths = page.locator(".scroll").evaluate_all(excess)
    assert widths
    assert max(widths) <= 1


def test_on_a_telephone_tables_that_scroll_say_so(visit, page_of_case):
    page = visit(page_of_case, width=390).page
    page.evaluate("document.querySelectorAll('details').forEach(part => part.open = true)")
    page.wait_for_selector(".wide")
    scrolls = "parts => parts.map(part => [part.scrollWidth > part.clientWidth + 1,"
    marked = " part.classList.contains('wide')])"
    page.wait_for_timeout(50)
    for scrolling, said in page.locator(".scroll").evaluate_all(scrolls + marked):
        assert scrolling == said
    cue = "part => getComputedStyle(part, '::before').content"
    assert "scroll" in page.locator(".wide").first.evaluate(cue)


def test_on_a_telephone_summaries_are_lists(visit, compared):
    """A line a cell, with its head; none scrolls."""
    page = visit(compared, width=390).page
    parts = page.locator("article .scroll")
    assert parts.evaluate_all("all => all.every(own => own.scrollWidth <= own.clientWidth + 1)")
    head = "cell => getComputedStyle(cell, '::before').content"
    assert "variant" in page.locator("article td").first.evaluate(head)


def test_thumbnails_are_crisp_at_their_size(visit, compared):
    """Twice as many pixels as they are shown with, and nothing but the mechanism."""
    for width in WIDTHS:
        page = visit(compared, width=width).page
        images = page.locator("article img")
        assert images.count() == 2
        for box in [image.bounding_box() for image in images.all()]:
            assert (round(box["width"]), round(box["height"])) == (230, 160)
        natural = "images => images.map(image => [image.naturalWidth, image.naturalHeight])"
        images.evaluate_all("images => images.forEach(image => image.loading = 'eager')")
        page.wait_for_load_state("networkidle")
        assert images.evaluate_all(natural) == [[460, 320]] * 2
