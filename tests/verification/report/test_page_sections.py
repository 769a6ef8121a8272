"""Sections that the analysis fills: convergence, refinement, solvers side by side."""

from math import nan

import pandas as pd
import pytest

from lacore_verification.report.blocks import Details, Gallery, Page, Section
from lacore_verification.report.charts.lines import with_lines
from lacore_verification.report.studies import single_solves
from lacore_verification.report.studies.convergence import (
    refinement_section,
    regularisation_section,
)
from lacore_verification.report.studies.single_solves import single_solves_section
from lacore_verification.report.studies.solvers import effort_section, solvers_section
from lacore_verification.report.tables import certificates_table, reasons_table, results_table
from tests.shares import one_in
from tests.verification.report.test_page import HOSTILE, Parsed, rendered

STAR = 2.0
R = [10 ** (-k / 2) for k in range(2, 11)]
COMMON = {
    **{"case": "made", "variant": "up", "coupling": "reaction", "mesh": "coarse", "n_elements": 10},
    **{"n_dofs": 40, "load_factor": STAR, "reference": STAR, "expected": "2", "error": 0.0},
    **{"rigor": "regularised", "status": "solved", "outer_iterations": 1, "iterations": 12},
    **{"gap": 1e-9, "contraction": nan, "build_time": 0.1, "solve_time": 0.5, "verdict": "pass"},
    **{"peak_memory_mb": 100.0, "why": "in", "message": "", "claimed": True, "residual_gap": 1e-9},
}


def row(run, **more):
    regularised = dict.fromkeys(("alpha_reg", "lambda", "P", "energy", "option_r"), nan)
    return COMMON | regularised | {"run": run, "backend": "exact"} | more


def swept(**names):
    """An exact value, and two backends whose errors are r and r**2 to all digits."""
    rows = [row("star", **names)]
    for backend in ("first", "second"):
        for r in R:
            values = {"alpha_reg": STAR - r, "lambda": STAR - r**2, "energy": r, "option_r": r}
            rows.append(row(f"{backend}-{r:.1e}", backend=backend, **values | names))
    return pd.DataFrame(rows)


def refined(error_of=lambda n: 3 / n, **names):
    return pd.DataFrame(
        [
            row(f"{mesh}-{backend}", backend=backend, mesh=mesh, n_elements=n, n_dofs=4 * n,
                error=error_of(n), solve_time=n * time, **names)
            for backend, time in (("slow", 0.02), ("fast", 0.001))
            for mesh, n in (("coarse", 10), ("medium", 100), ("fine", 1000))
        ]
    )  # fmt: skip


def drawings(section):
    return [item for block in section.blocks if isinstance(block, Gallery) for item in block.items]


def test_regularisation_has_two_charts_a_problem_with_their_slopes():
    section = regularisation_section(swept())
    first, second = drawings(section)
    assert first.caption == "made:up, coarse mesh: α* − α_reg"
    assert "first: slope 1.000" in first.chart.summary
    assert "second: slope 2.0" in second.chart.summary
    (details,) = [block for block in section.blocks if isinstance(block, Details)]
    (table,) = details.blocks
    assert len(table.data) == 4


def test_without_a_sweep_there_is_no_section():
    assert regularisation_section(refined()) is None
    assert regularisation_section(swept().drop(columns="option_r")) is None
    assert refinement_section(swept().iloc[:1]) is None


def test_refinement_shows_error_and_cost():
    error, cost = drawings(refinement_section(refined()))
    assert "slope −1.000" in error.chart.summary
    assert len(cost.chart.tips) == 6


def test_what_is_exact_on_every_mesh_has_no_refinement_chart():
    section = refinement_section(refined(lambda n: 1e-9))
    assert drawings(section) == []


def test_least_times_link_to_their_runs():
    results = refined()
    (table,) = [t for t in effort_section(results).blocks if "fastest mesh" in t.caption]
    text = rendered(Page("", "", [Section("one", "", [table, results_table(results)])]))
    assert '<a href="#run-fine-fast">1</a>' in text
    assert table.plain["1 %"].tolist() == ["20", "1"]
    assert table.plain["0.1 %"].tolist() == ["", ""]


def test_profile_names_both_filters():
    _, columns = solvers_section(refined(), "certificate", "drop", 600.0).blocks
    (drawing,) = columns.left
    assert "its certificate" in drawing.note
    assert "left out" in drawing.note
    assert "fast reaction" in drawing.chart.summary


def test_data_profile_has_the_time_per_unknown():
    _, columns = solvers_section(refined(), "certificate", "drop", 600.0).blocks
    (drawing,) = columns.right
    tips = [tip.text for tip in drawing.chart.tips if tip.text.startswith("fast")]
    assert tips[0].startswith("fast reaction: 0 % within")
    assert tips[1].startswith(f"fast reaction: 33.3 % within {10 * 0.001 / 41:.3g}")
    assert "left out" not in drawing.chart.summary


def test_lines_are_named_by_what_tells_them_apart():
    frame = pd.DataFrame(
        {"backend": ["a", "a", "b"], "coupling": "shift", "option_r": [0.1, nan, 0.1]}
    )
    named = with_lines(frame, ["backend", "coupling", "option_r"], frame)
    assert named["line"].tolist() == ["a, r=0.1", "a", "b, r=0.1"]


@pytest.mark.parametrize("name", one_in(6, HOSTILE))
def test_any_name_can_be_in_results(name):
    names = dict.fromkeys(("case", "variant", "mesh"), name)
    results = pd.concat([swept(**names), refined(case=name).assign(backend=name + "2")])
    results = results.drop_duplicates(["case", "variant", "mesh", "backend", "option_r"])
    plain = results[results["option_r"].isna()]
    sections = [
        regularisation_section(results),
        refinement_section(plain),
        solvers_section(plain, "verdict", "keep", 600.0),
        effort_section(plain),
        Section("all", "All", [results_table(results), reasons_table(results)]),
        Section("certificates", "Certificates", [certificates_table(results)]),
    ]
    page = Parsed(rendered(Page(name, name, [s for s in sections if s is not None])))
    assert page.tags.count("script") == 1
    assert "img" not in page.tags
    assert len(page.ids) == len(set(page.ids))


def solved_once(**names):
    """Two backends that gain a digit for each tenth of a second."""
    return pd.DataFrame(
        [
            row(f"{backend}-{k}-{names}", backend=backend, option_tolerance=10.0**-k, gap=10.0**-k,
                residual_gap=10.0**-k, solve_time=start + k / 10, **names)
            for backend, start in (("fast", 0.0), ("slow", 1.0))
            for k in (1, 2, 4, 8)
        ]
    )  # fmt: skip


def test_several_tolerances_are_a_curve_of_accuracy_against_time():
    section = single_solves_section(solved_once())
    gap, residual = drawings(section)
    assert gap.caption == "made:up, coarse mesh: certificate gap"
    assert residual.caption == "made:up, coarse mesh: largest residual of the certificate"
    (axes,) = gap.chart.figure.axes
    assert [line.get_label() for line in axes.get_lines()] == ["fast", "slow"]
    for line in axes.get_lines():
        times, gaps = line.get_data()
        assert list(gaps) == sorted(gaps)
        assert list(times) == sorted(times, reverse=True)
    assert "tolerance" in gap.chart.tips[0].text
    (details,) = [block for block in section.blocks if isinstance(block, Details)]
    (table,) = details.blocks
    assert len(table.data) == 8


def test_two_tolerances_are_no_curve():
    assert single_solves_section(solved_once().iloc[[0, 1]]) is None


def test_the_largest_problems_are_drawn(monkeypatch):
    monkeypatch.setattr(single_solves, "MOST", 1)
    both = pd.concat([solved_once(), solved_once(mesh="fine", n_dofs=400)], ignore_index=True)
    section = single_solves_section(both)
    assert [item.caption.split(":")[1] for item in drawings(section)] == ["up, fine mesh"] * 2
    assert any("1 smaller problem" in getattr(block, "text", "") for block in section.blocks)
