"""Charts as SVG, tables and documents as HTML: what a browser is not needed for."""

import re
from dataclasses import asdict
from html.parser import HTMLParser
from math import inf, nan

import pandas as pd
import pytest
from matplotlib.figure import Figure

from lacore import InputError
from lacore.pictures.axis import power
from lacore_verification.harness.analysis.slope_fits import Slope
from lacore_verification.report import document, files
from lacore_verification.report.blocks import (
    Details,
    Drawing,
    Gallery,
    Page,
    PageLink,
    Report,
    Section,
    Table,
)
from lacore_verification.report.charts import axes
from lacore_verification.report.charts.axes import ERROR, FACTOR, Axis
from lacore_verification.report.charts.svg import Chart, Tip, inline
from lacore_verification.report.charts.theme import VARIABLES
from lacore_verification.report.columns import Anchor, Column, slug

SWEEP = pd.DataFrame(
    [
        {"backend": backend, "r": r, "error": scale * r**2 + 1e-9, "mesh": "coarse"}
        for backend, scale in (("newton", 2.0), ("ipopt", 3.0))
        for r in (1e-1, 1e-2, 1e-3, 1e-4)
    ]
)
LAW = Slope(slope=2.0, low=1.98, high=2.02, coefficient=2.0, start=1e-3, stop=1e-1, floor=1e-9)
FITS = pd.DataFrame([{"backend": "newton", **asdict(LAW)}])
R = Axis("r", "regularisation r")


def fitted():
    return axes.fitted(SWEEP, FITS, R, ERROR, tip=["mesh"])


def ids(text):
    return re.findall(r'\sid="([^"]+)"', text)


def test_svg_is_the_same_on_each_run():
    assert inline(fitted(), "a") == inline(fitted(), "a")


def test_charts_have_neither_indentation_nor_empty_groups():
    text = inline(fitted(), "a")
    assert "<g></g>" not in text.replace("<g />", "<g></g>")
    assert not re.search(r">\s+<", text)


def test_svgs_on_one_page_share_no_id_and_refer_to_their_own():
    first, second = inline(fitted(), "one"), inline(fitted(), "two")
    assert ids(first)
    assert not set(ids(first)) & set(ids(second))
    for text in (first, second):
        used = re.findall(r'href="#([^"]+)"|url\(#([^)]+)\)', text)
        assert {a or b for a, b in used} <= set(ids(text))
        assert len(ids(text)) == len(set(ids(text)))


def test_svg_refers_to_nothing_outside_and_has_no_style_sheet():
    text = inline(fitted(), "a")
    assert "://" not in text
    assert "<style" not in text
    assert "<metadata" not in text
    assert "font-family" not in text
    assert "DejaVu" not in text


def test_all_colours_of_a_chart_follow_the_mode_of_the_page():
    text = inline(fitted(), "a")
    assert re.findall(r"#[0-9a-f]{6}\b", text) == []
    style = document.templates().get_template("style.html.j2").render()
    light, dark = style.split("@media (prefers-color-scheme: dark)", 1)
    for name in VARIABLES.values():
        assert f"{name}:" in light
        assert f"{name}:" in dark


def test_svg_is_as_wide_as_its_place_and_has_a_name():
    text = inline(fitted(), "a")
    head = text[: text.index(">")]
    assert 'width="100%"' in head
    assert "viewBox=" in head
    assert 'role="img"' in head
    assert "height=" not in head
    assert "newton: slope 2.00" in head


def test_svg_names_begin_an_id():
    with pytest.raises(ValueError, match="cannot begin an id"):
        inline(fitted(), '"><script>')


def test_each_point_says_its_values():
    text = inline(fitted(), "a")
    assert text.count('class="tip"') == len(SWEEP)
    assert "newton\nregularisation r: 0.01\nrelative error: 0.0002\nmesh: coarse" in text


def test_tips_lie_on_their_markers():
    """The circle of a point and its marker, which matplotlib has placed, have the same centre."""
    figure = Figure(figsize=(4, 3), layout="constrained")
    axes = figure.add_subplot(xscale="log")
    axes.plot([1, 10, 100], [0.3, 0.2, 0.7], "o")
    axes.set_ylabel("a label for which the layout must make room")
    chart = Chart(figure, "", [Tip(axes, 10, 0.2, "here")])
    text = inline(chart, "a")
    ((x, y),) = re.findall(r'<circle class="tip" cx="([\d.]+)" cy="([\d.]+)"', text)
    uses = re.findall(r'<use href="#([^"]+)" x="([\d.]+)" y="([\d.]+)"', text)
    # Coordinates are rounded to 0.01 points, each of the two.
    assert any(
        abs(float(u) - float(x)) <= 0.02 and abs(float(v) - float(y)) <= 0.02 for _, u, v in uses
    )


def test_law_in_words():
    assert axes.slope_text(asdict(LAW)) == "slope 2.00 ± 0.02"
    minus = axes.slope_text(asdict(Slope(slope=-1.0)))
    assert minus == "slope \N{MINUS SIGN}1.00"
    assert axes.slope_text(asdict(Slope())) == "no slope"


def test_one_line_has_one_law():
    with pytest.raises(ValueError, match="several fits for one backend"):
        axes.fitted(SWEEP, pd.concat([FITS, FITS]), R, ERROR)


def test_legend_says_the_slope_and_the_floor_is_drawn():
    text = inline(fitted(), "a")
    assert ">newton, slope 2.00 ± 0.02<" in text
    assert ">ipopt<" in text
    assert text.count("stroke-dasharray") == 1


def test_what_cannot_be_drawn_is_counted():
    data = pd.DataFrame(
        {"backend": "a", "n_elements": [10, 20, 30, 40], "error": [-0.1, 0.0, nan, inf]}
    )
    chart = axes.fitted(data, FITS, axes.ELEMENTS, ERROR)
    assert len(chart.tips) == 1
    assert chart.tips[0].y == pytest.approx(0.1)
    assert "3 points cannot be drawn" in chart.summary


def test_a_chart_of_nothing_can_be_drawn():
    empty = SWEEP.iloc[:0]
    for chart in (
        axes.fitted(empty, FITS.iloc[:0], R, ERROR),
        axes.curves(empty, R, ERROR),
        axes.profile(empty, R, Axis("error", "share", log=False), by="backend"),
    ):
        assert "no points" in chart.summary
        assert inline(chart, "a").startswith("<svg")


def test_profile_steps():
    data = pd.DataFrame(
        {"solver": ["a", "a", "b"], "factor": [1.0, 4.0, 2.0], "share": [0.5, 1, 0.25]}
    )
    chart = axes.profile(data, FACTOR)
    assert [tip.text for tip in chart.tips] == [
        "a: 50 % within 1",
        "a: 100 % within 4",
        "b: 25 % within 2",
    ]
    assert ">100%<" in inline(chart, "a")


def test_cost_joins_meshes_in_the_order_of_time():
    data = pd.DataFrame(
        {"backend": "a", "solve_time": [2.0, 1.0], "error": [0.1, 0.2], "mesh": ["fine", "coarse"]}
    )
    assert [tip.x for tip in axes.cost(data).tips] == [1.0, 2.0]


@pytest.mark.parametrize(
    ("value", "text"),
    [(1e-3, "10⁻³"), (1e-12, "10⁻¹²"), (2e-5, "2·10⁻⁵"), (1, "10⁰"), (1e5, "10⁵")],
)
def test_powers(value, text):
    assert power(value) == text


def test_ticks_of_an_axis_are_written_alike():
    short, long = axes.tick_words(1e-3, 1.0), axes.tick_words(1e-9, 1.0)
    assert [short(value, 0) for value in (0.001, 0.1, 1.0)] == ["0.001", "0.1", "1"]
    assert [long(value, 0) for value in (1e-9, 0.1, 1.0)] == ["10⁻⁹", "10⁻¹", "10⁰"]


HOSTILE = [
    "<script>window.owned = 1</script>",
    "\"'><img src=x onerror='window.owned = 1'>",
    "a & b &amp; $x_1$ \\frac{}{",
    "_hidden",
    "漢字 ü ∫ \x00\x1b",
    "W" * 400,
]


@pytest.mark.parametrize("name", HOSTILE)
def test_any_name_can_be_a_line(name):
    data = SWEEP.assign(backend=name)
    text = inline(axes.fitted(data, FITS.assign(backend=name), R, ERROR, tip=["backend"]), "a")
    assert "<script" not in text
    assert "<img" not in text
    assert text.count("slope 2.00") == 2  # in the legend and in the summary


class Parsed(HTMLParser):
    """Tags by name, and ids, of a page."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.ids = [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.ids += [value for key, value in attrs if key == "id"]


RUN = Anchor("run", "run")
PROOF = Anchor("proof", "proof")
RESULTS = pd.DataFrame(
    {
        "run": ["x/1", "x 2", "x-3"],
        "proof": ["x/1", None, "x-3"],
        "name": ["b", "a10", "a9"],
        "value": [2.0, nan, inf],
        "verdict": ["pass", "FAIL", "skipped"],
    }
)
PROOFS = Table((Column("name"),), RESULTS, anchor=PROOF)
TABLE = Table(
    (
        Column("name"),
        Column("value", "value %", ".1f", scale=100, link=PROOF),
        Column("verdict", moods={"pass": "good", "FAIL": "bad"}),
    ),
    RESULTS,
    anchor=RUN,
)


def rendered(page):
    """The text of a page that stands alone."""
    (text,) = files.rendered(Report({"index.html": page})).values()
    return text


def page(*blocks):
    return rendered(Page("Title", "Lead.", [Section("one", "One", blocks)]))


def test_cells():
    text = page(TABLE, PROOFS)
    assert '<td class="n" data-sort="2.0"><a href="#proof-x-2f-1">200.0</a></td>' in text
    assert '<td class="n" data-sort=""></td>' in text
    assert '<td class="n" data-sort="inf"><a href="#proof-x-3">inf</a></td>' in text
    assert '<td class="verdict bad">FAIL</td>' in text
    assert '<td class="verdict mild">skipped</td>' in text


def test_links_lead_to_the_page_that_has_their_target():
    """From the folder of the page that they are on; without a target they are text."""
    places = {"index.html": TABLE, "cases/a.html": PROOFS, "cases/b.html": TABLE}
    pages = {
        file: Page("", "", [Section("one", "", [table])], trail=[PageLink("up", "index.html")])
        for file, table in places.items()
    }
    text = files.rendered(Report(pages))
    assert '<a href="cases/a.html#proof-x-2f-1">200.0</a>' in text["index.html"]
    assert '<a href="a.html#proof-x-2f-1">200.0</a>' in text["cases/b.html"]
    assert '<a href="../index.html">up</a>' in text["cases/a.html"]
    assert '">200.0</td>' in page(TABLE)


def test_rows_can_be_linked_to():
    assert {"run-x-2f-1", "run-x-20-2", "run-x-3"} <= set(Parsed(page(TABLE)).ids)


def test_different_names_have_different_ids():
    names = ["a b", "a-b", "a/b", "a.b", "a_b", "ab", "A b", "ü"]
    assert len({slug(name) for name in names}) == len(names)


def test_a_table_as_plain_text():
    assert TABLE.plain.to_dict("list") == {
        "name": ["b", "a10", "a9"],
        "value %": ["200.0", "", "inf"],
        "verdict": ["pass", "FAIL", "skipped"],
    }


def test_ids_are_unique_over_all_charts_of_a_page():
    drawing = Drawing("chart", "caption", fitted())
    text = page(drawing, Gallery([drawing, drawing]), Details("more", [drawing]))
    found = Parsed(text).ids
    assert text.count("<svg") == 4
    assert len(found) == len(set(found))


def test_page_forbids_what_it_does_not_need():
    text = page(TABLE)
    (policy,) = re.findall(r'Content-Security-Policy" content="([^"]*)"', text)
    assert "default-src 'none'" in policy
    assert "script-src 'sha256-" in policy
    assert Parsed(text).tags.count("script") == 1


def test_a_page_that_cannot_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot write there"):
        files.write(Report({"index.html": Page("", "", [])}), tmp_path / "file")
