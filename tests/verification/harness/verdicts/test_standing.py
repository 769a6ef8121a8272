"""Rows, tables and the terminal say whether a structure stands under its dead loads."""

import io
from functools import cache

import numpy as np
import pytest
from rich.console import Console

from lacore_verification.catalogue.catalogue import catalogue
from lacore_verification.commands.tables import show_results
from lacore_verification.harness.campaigns.comparison import plan
from lacore_verification.harness.perform.one_run import run_here
from lacore_verification.harness.store.results import as_table
from lacore_verification.report.page import results_frame
from lacore_verification.report.tables import results_table

HELD = "block-incline-vertical:rough-pulled"
STANDS = "block-incline:up-mu-0.5"


@cache
def outcomes(backend="clarabel"):
    names = [HELD, STANDS, "block-incline-vertical:slippery-pulled"]
    return tuple(run_here(plan(names, [backend], couplings=["certified"], known=catalogue())))


def by_variant(found):
    return {outcome.row.variant: outcome.row for outcome in found}


def test_rows_say_on_which_side_a_structure_holds():
    """mu < tan beta, pulled into the slope: it slides for every load below, and holds above."""
    rows = by_variant(outcomes())
    held, stands, unsafe = rows["rough-pulled"], rows["up-mu-0.5"], rows["slippery-pulled"]
    assert (held.standing, held.side) == ("falls", "above")
    assert held.carried_low == pytest.approx(held.reference, rel=1e-6)
    assert held.carried_high == np.inf
    assert (stands.standing, stands.side) == ("stands", "below")
    down = 0.5 * np.cos(0.3) - np.sin(0.3)  # the opposite push that makes it slide
    assert stands.carried_low == pytest.approx(-down, rel=1e-6)
    assert stands.carried_high == stands.load_factor
    assert (unsafe.status, unsafe.standing, unsafe.side) == ("unsafe", "falls", "")
    assert np.isnan([unsafe.carried_low, unsafe.carried_high]).all()


def test_an_unsafe_run_leaves_what_falls():
    (unsafe,) = [o for o in outcomes() if o.row.variant == "slippery-pulled"]
    assert unsafe.evidence.arrays


def test_tables_have_columns_for_it():
    results = results_frame(outcomes())
    titles = [column.title for column in results_table(results).columns]
    assert "dead loads" in titles
    assert "loads carried" in titles
    without = as_table({**outcome.record(), "standing": "", "run": "x"} for outcome in outcomes())
    assert "loads carried" not in [column.title for column in results_table(without).columns]


def test_the_terminal_names_what_does_not_stand():
    written = io.StringIO()
    show_results(Console(file=written, width=160), outcomes())
    text = written.getvalue()
    assert "dead loads alone: falls; load factors from 2.028" in text
    assert text.count("dead loads alone") == 2


def test_regularised_backends_leave_it_to_exact_ones():
    (outcome,) = run_here(plan([STANDS], ["newton"], known=catalogue()))
    assert outcome.row.standing == ""
