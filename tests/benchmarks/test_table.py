"""The script that makes tables of the benchmarks, and the page that shows them."""

import importlib.util
import json
import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "docs" / "site" / "benchmarks.py"
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
    return {"extra_info": columns | {"seconds": seconds} | more}


SAMPLE = {
    "machine_info": MACHINE | {"node": "name of a machine"},
    "benchmarks": [
        *[
            run("solve", "newton", n, 1e-4 * n**1.5, options={"r": 1e-4}, elastic_solves=12.3456)
            for n in (1024, 100, 10_000)
        ],
        run("solve", "clarabel", 1024, 0.123, iterations=17, memory_mb=120.4, options={}),
        run("elastic", "elastic solve, PARDISO", 1024, 0.5, again_seconds=0.1),
        run("loop", "block", 5000, 4.0, own_share=0.0123),
        run("start", "import lacore", 0, 0.45, bare_starts=30.4),
        run("sweep", "block, medium", 288, 25.0, own_share=0.048, runs=200, seconds_a_run=0.12),
    ],
}


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location("benchmarks_table", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_table(script):
    head, _, *lines = script.table(script.records(script.condensed(SAMPLE))).splitlines()
    assert head == "| " + " | ".join(script._COLUMNS) + " |"
    assert lines == [
        "| elastic solve, PARDISO | 1024 | 4096 | 0.50 |  |  |  |",
        "| clarabel | 1024 | 4096 | 0.12 |  | 17 | 120 |",
        "| newton, r = 0.0001 | 100 | 400 | 0.10 | 12 |  |  |",
        "| newton, r = 0.0001 | 1024 | 4096 | 3.3 | 12 |  |  |",
        "| newton, r = 0.0001 | 10000 | 40000 | 100 | 12 |  |  |",
    ]


def test_growth_is_that_of_the_sample(script):
    (fit,) = script.growth(script.records(script.condensed(SAMPLE))).itertuples()
    assert fit.label == "newton, r = 0.0001"
    assert fit.exponent == pytest.approx(1.5, abs=1e-3)
    assert fit.error < 1e-3


def test_what_is_kept_can_be_read_again(script, tmp_path, monkeypatch, capsys):
    (tmp_path / "docs").mkdir()
    monkeypatch.setattr(script, "PAGE", tmp_path / "page.md")
    monkeypatch.setattr(script, "KEPT", tmp_path / "docs" / "benchmarks.json")
    script.PAGE.write_text("before\n<!-- benchmarks -->\nold\n<!-- end -->\nafter\n")
    (tmp_path / "raw.json").write_text(json.dumps(SAMPLE))
    monkeypatch.setattr(sys, "argv", ["benchmarks.py", str(tmp_path / "raw.json"), "--page"])
    script.main()
    kept = script.load()
    assert kept == script.condensed(SAMPLE)
    assert "name of a machine" not in script.KEPT.read_text()
    text = script.PAGE.read_text()
    assert text == f"before\n<!-- benchmarks -->\n{script.shown(kept)}<!-- end -->\nafter\n"
    assert "| newton, r = 0.0001 | 10000 |" in text
    printed = capsys.readouterr().out
    assert "| newton, r = 0.0001 | 100 |" in printed
    assert "power of 1.50 ± 0.00 (newton, r = 0.0001)" in printed
    assert "at most 1.2 %" in printed
    assert "process of its own: import lacore 0.45 s, 30 times a bare Python." in printed
    assert "200 runs of 120 ms (block, medium), one at a time, takes 25.0 s" in printed
    assert "is 4.8% of it" in printed
    assert "by PARDISO, of which analysis takes 80% on 1024 triangles; an abacus" in printed


def test_page_shows_what_was_kept(script):
    kept = script.load()
    page = script.PAGE.read_text(encoding="utf-8")
    (shown,) = re.findall(script.MARKS, page, flags=re.DOTALL)
    assert shown[0] + script.shown(kept) + shown[1] in page


def test_benchmarks_that_were_not_run_again_stay(script):
    before = script.condensed(SAMPLE)
    anew = {
        "measured": before["measured"] | {"date": "2000-01-02"},
        "records": [{"kind": "loop", "what": "block", "triangles": 5000, "own_share": 0.5}],
    }
    joined = script.joined(before, anew)
    assert joined["measured"]["date"] == "2000-01-01 to 2000-01-02"
    assert sum(record["kind"] == "loop" for record in joined["records"]) == 1
    assert len(joined["records"]) == len(before["records"])
    newer = anew["measured"] | {"packages": "lacore 0.2.0"}
    assert len(script.joined(before, anew | {"measured": newer})["records"]) == 1
    more = anew["measured"] | {"packages": "lacore 0.1.0, numpy 2.0"}
    assert len(script.joined(before, anew | {"measured": more})["records"]) > 1
    elsewhere = anew | {"measured": anew["measured"] | {"machine": "a slide rule"}}
    assert script.joined(before, elsewhere) == elsewhere


def test_a_run_of_brackets_alone_has_its_table(script):
    bracket = {"kind": "bracket", "what": "cut", "lower": 3.77, "upper": 3.78, "width": 0.0026}
    sizes = {"triangles_lower": 900, "triangles_upper": 1000, "solves": 9}
    times = {"seconds": 1.23, "aim": 1.5, "elastic_seconds": 0.04, "elastic_solves": 30.75}
    shown = script.shown(script.condensed(SAMPLE) | {"records": [bracket | sizes | times]})
    row = "| cut | 3.77000 | 3.78000 | 0.26% | 900 | 1000 | 9 | 1.2 | 1.5 | 0.040 | 31 |"
    assert row in shown.splitlines()


def test_a_path_stands_beside_its_time_before(script):
    path = {"kind": "path", "what": "billet", "triangles": 800, "steps": 40, "solves": 204}
    times = {"gap": 7.3e-7, "seconds": 31.4, "before": 41.0, "aim": 25.0, "ratio": 112.3}
    shown = script.shown(script.condensed(SAMPLE) | {"records": [path | times]})
    assert "| billet | 800 | 40 | 204 | 7e-07 | 31 | 41 | 25 | 112 |" in shown.splitlines()


def test_widths_of_problems_that_were_asked_for_several(script):
    """A line each, the widest first."""
    names = {"cut, 0.5%": (0.004, 2.5), "cut, 1%": (0.008, 1.1), "notched-strip, 0.5%": (0.004, 3)}
    records = [
        {"kind": "bracket", "what": name, "width": width, "seconds": seconds}
        for name, (width, seconds) in names.items()
    ]
    frame = script.records({"records": [record | {"options": {}} for record in records]})
    drawn = script.widths(frame)
    assert {told: list(rows["seconds"]) for told, rows in drawn.items()} == {
        "vertical cut": [1.1, 2.5]
    }


def test_what_was_changed_by_hand_is_not_shown(script, tmp_path, monkeypatch):
    kept = tmp_path / "benchmarks.json"
    kept.write_bytes(script.KEPT.read_bytes().replace(b'"seconds": 0.', b'"seconds": 0.0', 1))
    script.seal_of(kept).write_bytes(script.seal_of(script.KEPT).read_bytes())
    monkeypatch.setattr(script, "KEPT", kept)
    with pytest.raises(ValueError, match="checksum"):
        script.load()
