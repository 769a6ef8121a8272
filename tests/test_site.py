"""The site: what it is put together of, and, built whole, what a reader meets in a browser."""

import importlib.util
import re
import subprocess
import sys
from dataclasses import replace

import pandas as pd
import pytest

from lacore_verification.catalogue.catalogue import catalogue
from tests.conftest import ROOT
from tests.verification.report.browser import Visit, chromium, idle_pages, visit

__all__ = ["chromium", "idle_pages", "visit"]

SITE = ROOT / "docs" / "site"


@pytest.fixture(scope="module")
def scripts():
    """Modules of docs/site by name, as they import each other."""
    before = set(sys.modules)
    sys.path.insert(0, str(SITE))
    yield lambda name: importlib.import_module(name)
    sys.path.remove(str(SITE))
    for name in set(sys.modules) - before:
        if str(SITE) in str(getattr(sys.modules[name], "__file__", "")):
            del sys.modules[name]


@pytest.fixture(scope="module")
def results(scripts):
    return scripts("results").load()


def test_committed_results_are_what_was_kept(results):
    """Of most cases: one that came since says on its page that it was not run."""
    there = {outcome.run.case.id for outcome in results.outcomes}
    assert len(there) >= 80
    assert len(results.outcomes) >= 9 * results.left, "make results"
    assert {outcome.row.verdict for outcome in results.outcomes} >= {"pass"}
    assert "FAIL" not in {outcome.row.verdict for outcome in results.outcomes}


def test_results_that_were_changed_are_not_shown(scripts, monkeypatch, tmp_path):
    module = scripts("results")
    changed = tmp_path / "results.jsonl.gz"
    changed.write_bytes(module.FILE.read_bytes() + b"\0")
    monkeypatch.setattr(module, "FILE", changed)
    with pytest.raises(ValueError, match="checksum"):
        module.load()


def test_runs_of_one_backend_take_the_place_of_its_own_only(scripts, results):
    """Dear backends are asked later, and what others said of the case stays."""
    kept = scripts("results")._read()
    rest = kept.without({("prandtl-punch", "clarabel")})
    for lines in (rest.lines, kept.lines):
        told = [one["identity"] for one in lines if one["identity"]["case"] == "prandtl-punch"]
        assert ("clarabel" in {one["backend"] for one in told}) == (lines is kept.lines)
        assert "newton" in {one["backend"] for one in told}
    assert 0 < len(rest.checks) < len(kept.checks)
    assert not results.checks["allowed"].astype(str).str.startswith("'").any()


def test_values_outside_of_proven_bounds_are_found(scripts, results):
    """A reference that is moved by a tenth is excluded by the bracket of its variant."""
    manual = scripts("manual")
    case = catalogue()["vertical-cut"]
    right = case.reference(**case.variants[0].parameters)
    wrong = replace(case, reference=lambda: replace(right, value=1.1 * right.value))
    inside, all_of_them = manual.excluded([case], results).split("## All that were compared")
    assert "None lies outside" in inside
    said = rf"\| \[{right.low:.7g}, {right.high:.7g}\] \| \[3\.77.* elements for the lower bound, "
    assert re.search(said, all_of_them)
    told, _ = manual.excluded([wrong], results).split("## All that were compared")
    assert "1 lies outside" in told
    assert "| [4.15" in told
    with pytest.raises(ValueError, match="no case has proven bounds"):
        manual.excluded([catalogue()["wall-1"]], results)


def test_coulomb_friction_is_bounded_by_associated_friction_from_above_alone(scripts, results):
    """At mu = 0.2 a published 2.365 +- 0.003 is above it; half of a value is below, and may be."""
    manual = scripts("manual")
    case = catalogue()["platens-coulomb"]
    told = manual.excluded([case], results)
    assert "1 lies outside" in told
    assert "| mu-0.2 | independent computation" in told
    assert "| <= 2.36" in told
    (published,) = case.beside(mu=0.2)
    half = replace(case, beside=lambda mu: [replace(published, value=published.value / 2)])
    assert "None lies outside" in manual.excluded([half], results)


def test_a_case_without_results_says_so(scripts, results):
    manual = scripts("manual")
    case = catalogue()["wall-1"]
    none = replace(results, outcomes=[])
    drawn = {f"{case.id}-sketch": scripts("pictures").Text("not drawn")}
    assert "newer than the committed results" in manual.page(case, none, drawn)
    assert "not run yet" in manual.index([case], none)
    assert case.reference_of(case.variants[0]).text[1:6] in manual.page(case, results, drawn)


def test_backends_are_compared_on_what_all_of_them_were_asked(scripts):
    """One that few cases were asked of is left out, and does not shrink what is compared."""
    speed = scripts("speed")
    asked = {"all": "abcde", "most": "abcd", "few": "ab"}
    rows = [(who, case, "v", "coarse") for who, cases in asked.items() for case in cases]
    frame = pd.DataFrame(rows, columns=["backend", "case", "variant", "mesh"])
    alike = speed._asked_alike(frame)
    assert {*alike["backend"]} == {"all", "most"}
    assert "".join(sorted({*alike["case"]})) == "abcd"


def test_random_programs_that_nobody_solved_and_wrong_claims_are_told(scripts):
    speed = scripts("speed")
    said = [("one", 0, "right"), ("two", 0, "wrong"), ("one", 1, "no answer"), ("two", 1, "wrong")]
    runs = [
        {"backend": who, "family": "f", "place": n, "verdict": v, "seconds": 1.0, "unknowns": 9}
        for who, n, v in said
    ]
    kept = {"kind": "programs", "what": "2 programs", "limit": 60.0, "runs": runs}
    blocks = [*speed._programs(pd.DataFrame([kept]), pd.DataFrame(runs))]
    assert "that no backend solved: 1." in blocks[1].text
    table = blocks[-1].data.set_index("solver")
    assert list(table.loc["one", ["solved", "wrong"]]) == [1, 0]
    assert list(table.loc["two", ["solved", "wrong"]]) == [0, 2]
    with pytest.raises(ValueError, match="title"):
        speed.page("a page without a title", None)


def test_links_of_pages_lead_to_where_things_are_on_the_site(scripts, tmp_path):
    pages = scripts("pages")
    site = pages.Site(tmp_path, pages.sources())
    led = site._led
    text = "[a](../theory.md#laws) ![b](../wall.png) [c](../../tests/test_site.py) [d](#here)"
    found = led(text, "docs/guide/friction.md", "guide/friction.md")
    assert "[a](../theory.md#laws) ![b](../wall.png)" in found
    assert 'href="../files/tests/test_site.py"' in found
    assert "[d](#here)" in found
    assert (tmp_path / "wall.png").is_file()
    with pytest.raises(FileNotFoundError, match="nowhere"):
        led("[a](nowhere.md)", "docs/theory.md", "theory.md")


def test_links_that_lead_nowhere_are_found(scripts, tmp_path):
    broken = scripts("links").broken
    with pytest.raises(FileNotFoundError):
        list(broken(tmp_path))
    (tmp_path / "other.html").write_text('<p id="there">', encoding="utf-8")
    links = ["other.html#there", "other.html#not", "none.html", "../out.html", "https://x.org"]
    page = "".join(f'<a href="{link}">x</a>' for link in links)
    (tmp_path / "index.html").write_text(page, encoding="utf-8")
    wrong = [line.removeprefix("index.html: ") for line in broken(tmp_path)]
    assert wrong == ["other.html#not", "none.html", "../out.html"]


def test_every_case_is_in_the_gallery_in_one_group(scripts):
    gallery = scripts("gallery")
    page = gallery.page([*catalogue().values()], {})
    for name in catalogue():
        assert page.count(f":link: /manual/{name}\n") == 1
    shown = {file for own in gallery._EXAMPLES.values() for file, *_ in own}
    drawn = {path.name for path in (ROOT / "docs").glob("*.png")}
    assert drawn - shown == {"ground.png"}  # a problem whose answer is shown
    groups = {gallery.group(case) for case in catalogue().values()}
    assert groups == {*gallery._SHOWN}


def test_every_public_name_is_in_the_reference(scripts):
    import lacore as la

    api = scripts("api")
    rooms = api.by_room()
    assert sorted(name for names in rooms.values() for name in names) == sorted(la.__all__)
    assert dir(la) == sorted(la.__all__)  # nothing else is shown to who looks


def test_first_lines_of_properties_stay_whole_in_the_reference(scripts):
    """Napoleon reads `word: words` of an attribute as a type and its description."""
    from sphinx.ext.napoleon import Config, GoogleDocstring

    import lacore as la

    docstrings = scripts("docstrings")
    looked = 0
    for own in (getattr(la, name) for name in la.__all__):
        for name, part in vars(own).items() if isinstance(own, type) else ():
            if isinstance(part, property) and ":" in (part.__doc__ or "").partition("\n")[0]:
                lines = part.__doc__.splitlines()
                docstrings.before_napoleon(None, "property", name, part, None, lines)
                made = GoogleDocstring(lines, Config(), what="property", name=name).lines()
                assert made[0] == part.__doc__.partition("\n")[0]
                assert not any(line.startswith(":type:") for line in made)
                looked += 1
    assert looked > 0


def test_signatures_name_what_numpy_makes_arrays_of(scripts):
    from sphinx.util.inspect import signature

    import lacore as la

    aliases = scripts("conf").autodoc_type_aliases
    for own in (la.LimitState.certify, la.RigidBlock):
        assert "ArrayLike" in str(signature(own, type_aliases=aliases))
        assert "_SupportsArray" not in str(signature(own, type_aliases=aliases))


@pytest.fixture(scope="module")
def html(tmp_path_factory):
    """The whole site without pictures of cases; nothing may be wrong with it."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, str(SITE / "build.py"), str(folder), "--most", "0"]
    made = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert made.returncode == 0, made.stdout + made.stderr
    return folder / "html"


@pytest.mark.slow
def test_formulas_are_places_and_citations_links(html):
    theory = (html / "theory.html").read_text(encoding="utf-8")
    defined = re.findall(
        r"\*\*\(?(T\d+[bcd]?)\b", (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
    )
    assert len(defined) > 50
    for number in defined:
        assert f'id="{number.lower()}"' in theory, number
    api = (html / "api" / "limit.html").read_text(encoding="utf-8")
    assert 'href="../theory.html#t12"' in api


@pytest.mark.slow
@pytest.mark.parametrize(("width", "scheme"), [(1280, "light"), (390, "dark"), (390, "light")])
@pytest.mark.parametrize(
    "page",
    [
        "index.html",
        "manual/index.html",
        "manual/vertical-cut.html",
        "gallery.html",
        "theory.html",
        "api/limit.html",
        "benchmarks.html",
        "guide/bounds.html",
    ],
)
def test_pages_open_from_disk(html, visit, page, width, scheme):
    seen = visit(html / page, width=width, scheme=scheme)
    assert seen.complaints == []
    assert all(url.startswith(html.as_uri()) for url in seen.requests)
    assert seen.overflow <= 0
    light = seen.page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert (light == "rgb(255, 255, 255)") == (scheme == "light")


@pytest.mark.slow
def test_every_page_fits_a_telephone(html, chromium):
    """What is wider scrolls within its own box."""
    pages = [page for page in html.rglob("*.html") if not {"_modules", "files"} & {*page.parts}]
    assert len(pages) > 100
    tab, wrong = chromium.new_page(), {}
    for page in pages:
        seen = Visit(tab, page, width=390, scheme="dark")
        if seen.complaints or seen.overflow > 0:
            wrong[page.relative_to(html)] = (seen.overflow, seen.complaints)
        seen.leave()
    tab.close()
    assert wrong == {}


@pytest.mark.slow
def test_the_start_page_is_small(html, visit):
    """With all that it asks for."""
    seen = visit(html / "index.html")
    names = {url.removeprefix(html.as_uri() + "/").partition("?")[0] for url in seen.requests}
    assert len(names) >= 5
    assert sum((html / name).stat().st_size for name in names) < 1_000_000
