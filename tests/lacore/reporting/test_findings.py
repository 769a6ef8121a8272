"""Findings are values: rendered for each reader, stored, and never read from a text."""

import json
from string import Formatter

import numpy as np
import pytest

from lacore.reporting import terms
from lacore.reporting.findings import (
    Finding,
    Message,
    Severity,
    fill,
    records,
    restored,
    stored,
    texts,
)
from lacore.reporting.kinds import FILES, Kind
from lacore.reporting.text import PYTHON, Quantity, Reader, Term, text
from lacore.reporting.units import Units

IN_CM = Reader(Units("kN", "cm"), files=True)
DEPTH = Quantity(0.5, "m", ".3g")
GROUND = Finding(
    Kind.MORE_GROUND, ("soil.bottom",), {"depth": DEPTH, "percent": 12.3}, Severity.WARNING
)
WHY = Finding(Kind.LOCKED_NOT_PROVEN, (), {"residual": 0.25}, Severity.REASON)
SOLVE = Finding(Kind.SOLVE, (), {"report": Message("stalled", "try again", (GROUND,))})


def test_a_finding_is_rendered_in_the_units_of_its_reader():
    assert "soil.bottom: with 0.5 m of additional ground" in str(GROUND)
    assert "soil.bottom: with 50 cm of additional ground" in GROUND.text_for(IN_CM)
    assert "load factor is 12 % lower" in str(GROUND)


def test_a_finding_is_rendered_in_the_names_of_its_reader():
    other = Finding(Kind.OTHER_LOAD_FACTORS)
    assert "lacore.soil_range" in str(other)
    assert "--range" in other.text_for(IN_CM)
    assert "lacore" not in other.text_for(IN_CM)


@pytest.mark.parametrize(
    ("value", "written"),
    [
        (("a",), "'a'"),
        (("a", "b"), "'a' and 'b'"),
        (("a", "b", "c"), "'a', 'b' and 'c'"),
    ],
)
def test_tuples_are_written_as_lists(value, written):
    assert fill("{names!r}", {"names": value}) == written


@pytest.mark.parametrize("unknown", [float("nan"), np.float64("nan")])
@pytest.mark.parametrize("reader", [PYTHON, IN_CM])
def test_no_sentence_contains_nan(unknown, reader):
    """As a number, as a quantity, and in a tuple of them."""
    length = Quantity((unknown, 1.0), "m", ".3g")
    told = fill("{a:.1e}, {b}, {c:.2g}", {"a": unknown, "b": length, "c": (unknown, 2.0)}, reader)
    assert "nan" not in told
    assert told.count("unknown") == 3


def test_texts_and_terms_keep_their_parts():
    values = {"why": text("at most {}, see {}", Quantity(2e4, "Pa"), Term("la.x", "--x"))}
    assert fill("{why}", values) == "at most 20000 Pa, see la.x"
    assert fill("{why}", values, IN_CM) == "at most 20 kPa, see --x"


def test_a_reason_takes_the_place_of_the_general_text():
    message = Message("not certified", "residuals prove nothing", (GROUND, WHY))
    assert str(message).startswith("not certified: the solver calls the load locked")
    assert str(message).endswith(str(GROUND))
    assert "residuals prove nothing" not in str(message)


def test_a_plain_status_needs_no_general_text():
    assert Message("solved", "to the tolerance", (), plain=True).summary_for(PYTHON) == "solved"
    noted = Message("solved", "to the tolerance", (GROUND,), plain=True)
    assert noted.summary_for(PYTHON) == f"solved; {GROUND}"
    assert str(noted) == f"solved: to the tolerance; {GROUND}"
    failed = Message("stalled", "try another backend")
    assert failed.summary_for(PYTHON) == "stalled: try another backend"


@pytest.mark.parametrize(
    "findings",
    [
        (),
        (GROUND, WHY),
        (SOLVE,),
        (Finding(Kind.BACKEND, (), {"text": text("{} of {}", DEPTH, terms.BOND)}),),
        (Finding(Kind.CORNERS_DRIVEN, ("wall",), {"place": Quantity((1.0, 2.0), "m", ".6g")}),),
    ],
)
def test_findings_are_stored_and_restored(findings):
    again = restored(stored(findings))
    assert again == findings
    assert stored(again) == stored(findings)


@pytest.mark.parametrize("broken", ["{", "[1]", '[{"kind": "NONE"}]', "7"])
def test_a_text_that_holds_no_findings_is_rejected(broken):
    with pytest.raises(ValueError, match=r"findings|Expecting"):
        restored(broken)


def test_findings_are_plain_values_for_other_programs():
    (record,) = json.loads(json.dumps(records([GROUND], IN_CM)))
    assert record["kind"] == "MORE_GROUND"
    assert record["where"] == ["soil.bottom"]
    assert record["severity"] == "WARNING"
    assert record["text"] == GROUND.text_for(IN_CM)


@pytest.mark.parametrize("kind", Kind)
def test_texts_of_kinds_are_well_formed(kind):
    """Each names only terms that exist, and that for files has no name of Python."""
    for template in {kind.value, FILES.get(kind, kind.value)}:
        for _, field, _, _ in Formatter().parse(template):
            if field and field.startswith("terms."):
                assert isinstance(getattr(terms, field.removeprefix("terms.")), Term)
    assert "lacore." not in FILES.get(kind, kind.value)
    assert "state." not in FILES.get(kind, kind.value)


def test_kinds_do_not_share_a_text():
    assert len({kind.value for kind in Kind}) == len(Kind.__members__)


def test_texts_can_be_limited_to_some_severities():
    assert texts((GROUND, WHY), severities=(Severity.REASON,)) == str(WHY)
