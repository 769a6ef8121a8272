"""A report as a reader meets it: opened from a file in a real Chromium."""

from dataclasses import replace

import pandas as pd
import pytest
from markupsafe import Markup
from matplotlib.figure import Figure

from lacore_verification.catalogue.catalogue import find
from lacore_verification.report.blocks import (
    Card,
    Cards,
    Count,
    Details,
    Drawing,
    Facts,
    Gallery,
    Heading,
    Html,
    Link,
    Links,
    Page,
    PageLink,
    PageLinks,
    Picture,
    Preformatted,
    Section,
    Table,
    Tally,
    Text,
)
from lacore_verification.report.charts import axes
from lacore_verification.report.charts.axes import ERROR
from lacore_verification.report.charts.figures import png
from lacore_verification.report.columns import Anchor, Column, slug
from lacore_verification.report.description import description, lead
from lacore_verification.report.tables import certificates_table, reasons_table, results_table
from tests.verification.report.browser import WIDTHS
from tests.verification.report.test_page import FITS, SWEEP, R

HOSTILE = (
    "<script>window.owned = 1</script>\"'><img src=x onerror='window.owned = 1'>"
    " </title></svg></pre></textarea>&amp; & $x_{ ü 漢 {{ 7*7 }} " + "W" * 300
)


def hostile_results():
    """Results in which every text is hostile."""
    texts = ("case", "variant", "mesh", "backend", "coupling", "expected", "rigor", "status")
    numbers = ("n_elements", "load_factor", "reference", "error", "energy", "outer_iterations")
    times = ("build_time", "solve_time", "residual_gap")
    row = dict.fromkeys([*texts, "verdict", "why", "message", "run"], HOSTILE)
    return pd.DataFrame([row | dict.fromkeys([*numbers, *times], 1.0)])


def hostile_page():
    """Every block there is, of hostile texts."""
    case, (variant, *_) = find("shear-patch")
    case = replace(
        case, id=HOSTILE, title=HOSTILE, unit=HOSTILE, explanation=HOSTILE, tags=(HOSTILE,),
        hand_calculation=HOSTILE,
    )  # fmt: skip
    variant = replace(variant, name=HOSTILE, unfit={HOSTILE: HOSTILE})
    data = SWEEP.assign(backend=HOSTILE, mesh=HOSTILE)
    chart = axes.fitted(
        data, FITS.assign(backend=HOSTILE), replace(R, label=HOSTILE), ERROR, tip=["mesh"]
    )
    results = hostile_results()
    anchor = Anchor("own", "why")
    table = Table((Column("why", HOSTILE, link=anchor, hover="why"),), results, HOSTILE, anchor)
    picture = Picture(HOSTILE, HOSTILE, png(Figure((1, 1))))
    loose = replace(table, anchor=None)  # one place of the page has the id of a row
    blocks = [
        Text(HOSTILE, lead=HOSTILE),
        Heading(HOSTILE),
        Preformatted(HOSTILE, sketch=HOSTILE),
        Links([Link(HOSTILE, slug(HOSTILE), HOSTILE)]),
        Facts({HOSTILE: HOSTILE}),
        PageLinks([PageLink(HOSTILE, "index.html", HOSTILE)]),
        Tally([Count(1, HOSTILE)]),
        table,
        Cards([Card(PageLink(HOSTILE, "index.html", HOSTILE), picture, loose, "bad")]),
        Gallery([Drawing(HOSTILE, HOSTILE, chart), picture]),
        Details(HOSTILE, [results_table(results), reasons_table(results)]),
        certificates_table(results),
        description(case, [variant], {HOSTILE: 2}),
    ]
    section = Section(slug(HOSTILE), f"{HOSTILE} 1", blocks, lead(case), "bad")
    more = Section("more", HOSTILE, [])
    trail = [PageLink(HOSTILE, "index.html")]
    return Page(HOSTILE, HOSTILE, [section, more], [Text(HOSTILE)], trail)


@pytest.mark.parametrize("place", ["compared", "page_of_case"])
def test_nothing_is_asked_for_elsewhere_and_nothing_goes_wrong(visit, request, place):
    seen = visit(request.getfixturevalue(place))
    seen.page.evaluate("document.querySelectorAll('img').forEach(image => image.loading = 'eager')")
    seen.page.wait_for_load_state("networkidle")
    assert seen.elsewhere == []
    assert seen.complaints == []
    assert seen.requests.count(seen.address) == 1
    assert any("/pictures/" in url for url in seen.requests)


@pytest.mark.parametrize(("width", "scheme"), [*zip(WIDTHS, ["light", "dark"], strict=True)])
@pytest.mark.parametrize("place", ["compared", "page_of_case"])
def test_page_never_scrolls_sideways(visit, request, place, width, scheme):
    seen = visit(request.getfixturevalue(place), width=width, scheme=scheme)
    assert seen.overflow <= 0
    seen.page.evaluate("document.querySelectorAll('details').forEach(part => part.open = true)")
    assert seen.overflow <= 0


def test_load_factors_are_on_the_screen_of_a_telephone(visit, page_of_case):
    """Their whole column, without scrolling sideways; also in tables that are folded away."""
    page = visit(page_of_case, width=390).page
    page.evaluate("document.querySelectorAll('details').forEach(part => part.open = true)")
    heads = page.locator("th:visible", has_text="load factor").all()
    assert len(heads) >= 2
    for head in heads:
        box = head.bounding_box()
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= 390


def test_index_is_small_and_soon_there(visit, compared):
    """The time is that of the browser: from the request until all of the page is read and shown."""
    assert compared.stat().st_size < 1_000_000
    page = visit(compared).page
    entry = "performance.getEntriesByType('navigation')[0]"
    # A tenth of what a page may take for all cases: this one has two, on whatever machine.
    assert page.evaluate(f"{entry}.domInteractive") < 1000
    assert page.locator("*").count() < 2000


def test_each_case_has_its_picture_and_its_page(visit, compared):
    page = visit(compared).page
    loaded = "images => images.every(image => image.complete && image.naturalWidth > 0)"
    assert page.locator("article").count() == 2
    assert page.locator("article img").evaluate_all(loaded)
    page.locator("article h3 a").first.click()
    page.wait_for_url("**/cases/*.html")
    page.locator(".trail a").first.click()
    page.wait_for_url("**/index.html")


@pytest.mark.parametrize("width", WIDTHS)
def test_figures_are_there_and_fit(visit, compared, page_of_case, width):
    profile = visit(compared, width=width).page
    page = visit(page_of_case, width=width).page
    assert profile.locator("figure svg").count() == 4
    assert page.locator("figure svg").count() == 1  # load factor against friction
    assert page.locator("figure img").count() >= 2
    figures = [*profile.locator("figure svg").all(), *page.locator("figure svg, figure img").all()]
    for box in [figure.bounding_box() for figure in figures]:
        assert box["width"] > 250
        assert box["height"] > 100
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= width
    page.evaluate("document.querySelectorAll('img').forEach(image => image.loading = 'eager')")
    page.wait_for_load_state("networkidle")
    loaded = "images => images.every(image => image.complete && image.naturalWidth > 0)"
    assert page.locator("figure img").evaluate_all(loaded)
    shown = page.locator("circle.tip title").all_text_contents()
    assert any("load factor: " in text for text in shown)


def test_dark_mode_turns_paper_ink_and_charts(visit, compared):
    def colours(scheme):
        page = visit(compared, scheme=scheme).page
        style = "getComputedStyle(document.querySelector('{}')).{}"
        return [
            page.evaluate(style.format(*what))
            for what in (
                ("body", "backgroundColor"),
                ("body", "color"),
                ("figure svg text", "fill"),
                ("figure svg path[style*=series-1], figure svg use[style*=series-1]", "stroke"),
            )
        ]

    light, dark = colours("light"), colours("dark")
    assert light[0] == "rgb(255, 255, 255)"
    assert all(a != b for a, b in zip(light, dark, strict=True))
    assert light[1] == light[2]
    assert dark[1] == dark[2]


@pytest.mark.parametrize(
    ("number", "up", "down"),
    [
        (0, ["a9", "a10", "b", "B", ""], ["B", "b", "a10", "a9", ""]),
        (1, ["-1", "9", "100", "inf", ""], ["inf", "100", "9", "-1", ""]),
        (
            2,
            ["coarse", "coarse", "medium", "fine", "finest"],
            ["finest", "fine", "medium", "coarse", "coarse"],
        ),
    ],
)
def test_tables_sort_both_ways(sorted_page, number, up, down):
    button = sorted_page.head(number).locator("button")
    button.click()
    assert sorted_page.column(number) == up
    assert sorted_page.head(number).get_attribute("aria-sort") == "ascending"
    button.click()
    assert sorted_page.column(number) == down
    assert sorted_page.head(number).get_attribute("aria-sort") == "descending"
    assert sorted_page.complaints == []


def test_tables_sort_from_the_keyboard(sorted_page):
    sorted_page.head(1).locator("button").focus()
    sorted_page.page.keyboard.press("Enter")
    assert sorted_page.column(1)[0] == "-1"
    sorted_page.page.keyboard.press("Space")
    assert sorted_page.column(1)[0] == "inf"
    sorted_page.head(0).locator("button").press("Enter")
    assert sorted_page.head(1).get_attribute("aria-sort") is None


def test_results_sort_by_what_they_say(visit, page_of_case):
    """The real table: numbers by number, though they are shown rounded and with signs."""
    seen = visit(page_of_case)
    tables = seen.page.locator("table.sortable").count()
    table = next(
        t for t in range(tables) if "load factor" in seen.head(0, t).locator("..").text_content()
    )
    heads = seen.page.locator("table.sortable").nth(table).locator("thead th").all_text_contents()
    number = heads.index("load factor")
    seen.head(number, table).locator("button").click()
    values = [float(text) for text in seen.column(number, table) if text]
    assert values == sorted(values)
    assert len(values) >= 2


def test_numbers_lead_to_their_certificate_and_back(visit, compared):
    """From the index to the page of the case, where the certificate is unfolded, to its run."""
    page = visit(compared).page
    link = page.locator("article a[href*='#certificate-']").first
    name = link.get_attribute("href").partition("#")[2]
    link.click()
    page.wait_for_url(f"**/cases/*.html#{name}")
    target = page.locator(f"#{name}")
    target.wait_for(state="visible")
    target.locator("a[href^='#run-']").click()
    page.wait_for_function("location.hash.startsWith('#run-')")
    again = page.locator(page.evaluate("location.hash")).locator("a[href^='#certificate-']")
    assert again.get_attribute("href") == f"#{name}"


def test_every_link_has_its_target(visit, compared):
    """Also on the page of another case, and in other files."""
    dead = "links => links.map(a => a.hash.slice(1)).filter(id => !document.getElementById(id))"
    pages = [compared, *(compared.parent / "cases").iterdir()]
    ids, links = {}, {}
    for path in pages:
        page = visit(path).page
        assert page.locator("a[href^='#']").evaluate_all(dead) == []
        ids[path] = set(page.locator("[id]").evaluate_all("parts => parts.map(one => one.id)"))
        links[path] = page.locator("a[href]:not([href^='#'])").evaluate_all(
            "links => links.map(a => a.getAttribute('href'))"
        )
    for path in pages:
        for link in links[path]:
            file, _, name = link.partition("#")
            target = (path.parent / file).resolve()
            assert target.is_file(), link
            assert not name or name in ids[target], link


def test_printed_page_shows_what_is_folded(visit, page_of_case):
    page = visit(page_of_case).page
    page.emulate_media(media="print")
    assert page.pdf().startswith(b"%PDF")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.locator("details:not([open])").count() == 0
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    assert page.locator("details[open]").count() == 0


@pytest.mark.parametrize("width", WIDTHS)
def test_hostile_names_are_text(visit, alone, width):
    seen = visit(alone(hostile_page()), width=width)
    page = seen.page
    assert page.evaluate("window.owned") is None
    assert (seen.elsewhere, seen.complaints, seen.dialogs) == ([], [], [])
    assert page.locator("script").count() == 1
    assert page.locator("img").count() == 2  # the picture, on its card and alone
    assert page.title() == HOSTILE
    page.evaluate("document.querySelectorAll('details').forEach(part => part.open = true)")
    places = (
        "h1", "h2:not(nav h2)", "h3:first-of-type", "p b", "li a", "dt", "dd", "td", "caption",
        "th", "summary", "figcaption", "pre", "circle title", ".tally div",
        ".trail a", "article h3 a",
    )  # fmt: skip
    for place in places:
        assert HOSTILE in page.locator(place).first.text_content(), place
    assert page.locator("td[title]").first.get_attribute("title") == HOSTILE
    assert page.locator("img").first.get_attribute("alt") == HOSTILE
    assert HOSTILE in page.locator("svg").get_attribute("aria-label")
    assert seen.overflow <= 0


def test_a_script_that_got_in_would_not_run(visit, alone):
    """Were a text let through unescaped one day, the policy of the page still stops it."""
    planted = Html(Markup("<script>window.owned = 1</script><b onclick='window.owned = 1'>b</b>"))
    page = Page("Planted", "", [Section("one", "One", [planted])])
    seen = visit(alone(page))
    seen.page.locator("section b").click()
    assert seen.page.evaluate("window.owned") is None
    assert any("Content Security Policy" in text for text in seen.complaints)
