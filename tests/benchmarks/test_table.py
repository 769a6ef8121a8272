"""The script that makes tables of the benchmarks, and the page that shows them."""

import importlib
import json
import re
import sys
from pathlib import Path

import pytest

SITE = Path(__file__).parents[2] / "docs" / "site"
MACHINE = {
    "date": "2000-01-01",
    "machine": "an abacus",
    "python": "3.11",
    "packages": "lacore 0.1.0",
    "direct_solver": "PARDISO",
    "backends": {},
}


def run(kind, what, triangles, seconds, **more):
    columns = {"kind": kind, "what": what, "triangles": triangles, "unknowns": 4 * triangles}
    return columns | {"seconds": seconds} | more


RECORDS = [
    *[
        run("solve", "newton", n, 1e-4 * n**1.5, options={"r": 1e-4}, elastic_solves=12.3456)
        for n in (1024, 100, 10_000)
    ],
    run("solve", "clarabel", 1024, 0.123, iterations=17, memory_mb=120.4, options={}),
    run("elastic", "elastic solve, PARDISO", 1024, 0.5, again_seconds=0.1),
    run("loop", "block", 5000, 4.0, own_share=0.0123),
    run("start", "import lacore", 0, 0.45, bare_starts=30.4),
    run("sweep", "block, medium", 288, 25.0, own_share=0.048, runs=200, seconds_a_run=0.12),
]
BRACKETS = [
    {"kind": "bracket", "what": what, "width": width, "seconds": 2 * wall, "wall": wall} | asked
    for what, width, wall, asked in (
        ("cut, 0.1%", 0.0009, 5.84, {"bar": 6, "aim": 5}),
        ("cut, 1%", 0.008, 1.1, {}),
        ("notched-strip, 0.2%", 0.0019, 5.2, {"bar": 5}),
    )
]
SAMPLE = {"measured": MACHINE, "records": [*RECORDS, *BRACKETS]}


@pytest.fixture
def scripts(monkeypatch):
    """Modules of docs/site by name, as they import each other."""
    before = set(sys.modules)
    monkeypatch.syspath_prepend(SITE)
    yield importlib.import_module
    for name in set(sys.modules) - before:
        if str(SITE) in str(getattr(sys.modules[name], "__file__", "")):
            del sys.modules[name]


@pytest.fixture
def script(scripts):
    return scripts("benchmarks")


@pytest.fixture
def kept(script, scripts):
    """Loaded after the script, which imports it."""
    return scripts("kept")


def table_of(script, kind, records):
    """Lines of the table of a kind."""
    (section,) = [one for one in script.SECTIONS if kind in one.kinds]
    frame = script.records({"records": records})
    return script.markdown(script.rows_of(frame, section), section.columns).splitlines()


def test_table(script):
    head, _, *lines = table_of(script, "solve", RECORDS)
    assert head == (
        "| backend | triangles | unknowns | seconds | elastic solves | iterations | memory, MB |"
    )
    assert lines == [
        "| elastic solve, PARDISO | 1024 | 4096 | 0.50 |  |  |  |",
        "| clarabel | 1024 | 4096 | 0.12 |  | 17 | 120 |",
        "| newton, r = 0.0001 | 100 | 400 | 0.10 | 12 |  |  |",
        "| newton, r = 0.0001 | 1024 | 4096 | 3.3 | 12 |  |  |",
        "| newton, r = 0.0001 | 10000 | 40000 | 100 | 12 |  |  |",
    ]


def test_growth_is_that_of_the_sample(script):
    (fit,) = script.growth(script.records(SAMPLE), ["solve"]).itertuples()
    assert fit.label == "newton, r = 0.0001"
    assert fit.exponent == pytest.approx(1.5, abs=1e-3)
    assert fit.error < 1e-3


def test_what_is_kept_can_be_read_again(script, kept, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(script, "PAGE", tmp_path / "page.md")
    monkeypatch.setattr(script, "WIDTHS", tmp_path / "widths.svg")
    monkeypatch.setattr(kept, "KEPT", tmp_path / "benchmarks.json")
    script.PAGE.write_text("before\n<!-- benchmarks -->\nold\n<!-- end -->\nafter\n")
    twice = [RECORDS[0] | {"seconds": 7.0}, *RECORDS]  # run again after a crash: the last counts
    lines = [json.dumps({"measured": MACHINE, "record": record}) for record in [*twice, *BRACKETS]]
    (tmp_path / "raw.jsonl").write_text("\n".join(lines))
    monkeypatch.setattr(sys, "argv", ["benchmarks.py", str(tmp_path / "raw.jsonl"), "--page"])
    script.main()
    assert kept.load() == SAMPLE
    text = script.PAGE.read_text()
    assert text == f"before\n<!-- benchmarks -->\n{script.shown(SAMPLE)}<!-- end -->\nafter\n"
    assert "| newton, r = 0.0001 | 10000 |" in text
    assert script.WIDTHS.read_text().rstrip().endswith("</svg>")
    printed = capsys.readouterr().out
    assert "| newton, r = 0.0001 | 100 |" in printed
    assert "power of 1.50 ± 0.00 (newton, r = 0.0001)" in printed
    assert "at most 1.2 %" in printed
    assert "relative to starting Python: import lacore 0.45 s, 30 times that of Python." in printed
    assert "200 runs of 120 ms (block, medium), one at a time, takes 25.0 s" in printed
    assert "takes 4.8% of this time" in printed
    assert "PARDISO (analysis takes 80% of the time on 1024 triangles); an abacus" in printed
    with pytest.raises(ValueError, match="no benchmark"):
        kept.found("")


def test_page_and_picture_show_what_was_kept(script, kept, tmp_path):
    page = script.PAGE.read_text(encoding="utf-8")
    (shown,) = re.findall(script.MARKS, page, flags=re.DOTALL)
    assert shown[0] + script.shown(kept.load()) + shown[1] in page
    drawn = script.WIDTHS.read_text(encoding="utf-8")
    for problem in script.widths(script.records(kept.load())):
        assert problem in drawn


def test_benchmarks_that_were_not_run_again_stay(kept):
    loop = {"kind": "loop", "what": "block", "triangles": 5000, "own_share": 0.5}
    anew = {"measured": MACHINE | {"date": "2000-01-02"}, "records": [loop]}
    joined = kept.joined(SAMPLE, anew)
    assert joined["measured"]["date"] == "2000-01-01 to 2000-01-02"
    assert sum(record["kind"] == "loop" for record in joined["records"]) == 1
    assert len(joined["records"]) == len(SAMPLE["records"])
    newer = anew["measured"] | {"packages": "lacore 0.2.0"}
    assert len(kept.joined(SAMPLE, anew | {"measured": newer})["records"]) == 1
    more = anew["measured"] | {"packages": "lacore 0.1.0, numpy 2.0"}
    assert len(kept.joined(SAMPLE, anew | {"measured": more})["records"]) > 1
    elsewhere = anew | {"measured": anew["measured"] | {"machine": "a slide rule"}}
    assert kept.joined(SAMPLE, elsewhere) == elsewhere


def test_brackets_stand_by_problem_the_widest_first(script):
    lines = table_of(script, "bracket", BRACKETS)
    assert lines[2:] == [
        "| cut, 1% | 0.800% | 2.2 | 1.1 |",
        "| cut, 0.1% | 0.090% | 12 | 5.8 |",
        "| notched-strip, 0.2% | 0.190% | 10 | 5.2 |",
    ]


def test_widths_of_problems_that_were_asked_for_several(script):
    """A line each, the widest first."""
    found = script.widths(script.records({"records": BRACKETS}))
    assert {told: list(rows["seconds"]) for told, rows in found.items()} == {
        "vertical cut": [2.2, 11.68]
    }


def test_figures_that_are_missed_are_said_to_be(script):
    gap = [
        {"kind": "true gap", "what": what, "triangles": n, "seconds": s * n**p, "memory_mb": m}
        for n in (100, 1000, 10_000)
        for what, s, p, m in (("interior_point", 1e-4, 1.4, 200), ("clarabel", 4e-4, 1.4, 190))
    ]
    tally = {"large": 200, "large_right": 191, "wrong": 0}
    right = [{"backend": "a"} | tally, {"backend": "b"} | tally]
    right += [{"backend": "a, then b"} | tally | {"large_right": 199}]
    programs = {"kind": "robustness", "what": "400 programs", "runs": right}
    head, _, *lines = table_of(script, "held", [*BRACKETS, *gap, programs])
    assert head == "| benchmark | required | aim | measured | fulfilled |"
    told = {line.split(" | ")[0].strip("| "): line.split(" | ")[1:] for line in lines}
    assert told["cut, 0.1%"] == ["6 s elapsed", "5", "5.84", "yes |"]
    assert told["notched-strip, 0.2%"][-1] == "**no** |"
    of = "upper bound on 10000 triangles at a true gap of 1e-5, interior_point relative to clarabel"
    growth = "exponent of the growth of this time with triangles, interior_point"
    assert told[f"{of}: time"][-2:] == ["0.25", "yes |"]
    assert told[f"{of}: memory"][-2:] == ["1.05", "**no** |"]
    assert told[growth][-2:] == ["1.4", "**no** |"]
    assert told["400 programs: share of large ones right, a"][-2:] == ["95.5%", "yes |"]
    assert told["400 programs: share of large ones right, a, then b"][-2:] == ["99.5%", "**no** |"]
    assert told["400 programs: reported as solved but wrong, a"][-1] == "yes |"


def test_what_is_not_a_number_does_not_hold(script):
    wide = [BRACKETS[0] | {"wall": float("nan")}]
    assert table_of(script, "held", wide)[-1].endswith("| **no** |")


def test_answers_to_random_programs_are_counted(script):
    said = [("one", 9, "right"), ("two", 9, "wrong"), ("one", 1500, "no answer")]
    said += [("two", 1500, "refused"), ("one", 2000, "right"), ("two", 2000, "right")]
    runs = [
        {"backend": who, "unknowns": n, "verdict": verdict, "seconds": 1.0}
        for who, n, verdict in said
    ]
    lines = table_of(script, "programs", [{"kind": "programs", "what": "3", "runs": runs}])
    assert lines[2:] == [
        "| 3 | one | 3 | 2 | 0 | 1 | 0 | 2 | 1 | 3.0 |",
        "| 3 | two | 3 | 1 | 1 | 0 | 1 | 1 | 1 | 3.0 |",
    ]


def test_what_was_changed_by_hand_is_not_shown(kept, tmp_path, monkeypatch):
    changed = tmp_path / "benchmarks.json"
    changed.write_bytes(kept.KEPT.read_bytes().replace(b'"seconds": 0.', b'"seconds": 0.0', 1))
    kept.seal_of(changed).write_bytes(kept.seal_of(kept.KEPT).read_bytes())
    monkeypatch.setattr(kept, "KEPT", changed)
    with pytest.raises(ValueError, match="checksum"):
        kept.load()
