"""Rows that somebody changed on purpose: refused by a sentence that names file, row and field.

Forged by hand is only the checksum of the row; forged by our own code is the seal, too.
"""

import json
import shutil
import sqlite3
from contextlib import closing
from dataclasses import replace
from math import inf, nan
from pathlib import Path

import numpy as np
import pytest

import lacore as la
from lacore_verification.case import Variant
from lacore_verification.catalogue.plugins import gather
from lacore_verification.harness.campaigns import comparison
from lacore_verification.harness.campaigns.run_all import run_all
from lacore_verification.harness.campaigns.sweep import plan
from lacore_verification.harness.evidence.limit_state import packed, unpacked
from lacore_verification.harness.store.results import load_outcomes, load_results
from lacore_verification.harness.store.store import (
    _COLUMNS,
    NAME,
    SCHEMA,
    Store,
    _checksum,
    entries,
    sessions,
)
from lacore_verification.harness.store.stored_rows import TEXTS, seal_of
from lacore_verification.runs.run import canonical
from tests.conftest import ROOT
from tests.verification.command_line import run_in_order

ODD = [
    nan, inf, -inf, -1.0, 1e308, 10**400, 0.5, 7, True, None, "", "solved", "x" * 5000, "\x00",
    [], [1, 2], {}, {"a": 1}, [[[]]], "NaN", "=HYPERLINK(1)", 2**63, -0.0, "2026-01-01",
]  # fmt: skip


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    folder = tmp_path_factory.mktemp("store")
    runs = plan(["block-slide:mu-0.2"], ["mu=0.1:0.5:3"], ["clarabel"])
    run_all(runs, folder / NAME, executor=run_in_order)
    return folder


@pytest.fixture
def path(original, tmp_path):
    return Path(shutil.copy(original / NAME, tmp_path / NAME))


def record_of(path):
    with closing(sqlite3.connect(path)) as database:
        names = ", ".join(_COLUMNS)
        return dict(
            zip(
                _COLUMNS,
                database.execute(f"SELECT {names} FROM runs ORDER BY run").fetchone(),
                strict=True,
            )
        )


def forge(path, before, record, sealed=False):
    """Write a record in place of another, with its checksum made afresh."""
    if sealed:
        record["seal"] = seal_of([record[name] for name in TEXTS])
    record["checksum"] = _checksum([record[name] for name in _COLUMNS[:-1]])
    sets = ", ".join(f"{name} = ?" for name in _COLUMNS)
    with closing(sqlite3.connect(path)) as database, database:
        database.execute(
            f"UPDATE OR REPLACE runs SET {sets} WHERE run = ?",
            (*(record[name] for name in _COLUMNS), before["run"]),
        )


def altered(draw, record):
    """A record with one thing changed somewhere, and what."""
    record = dict(record)
    column = str(draw.choice([*TEXTS, "row", "row", "row", "identity", "history", "residuals"]))
    if column in ("run", "code", "session", "finished"):
        odd = [value for value in ODD if isinstance(value, str | int) and value not in (True,)]
        record[column] = _storable(column, odd[draw.integers(len(odd))], record[column])
        return record, column
    data = json.loads(record[column])
    part = data
    if column == "history":
        part = data[draw.integers(len(data))]
    elif column == "identity" and draw.random() < 0.5:
        part = data["parameters"]
    name = str(draw.choice(list(part)))
    way = draw.random()
    if way < 0.1:
        del part[name]
    elif way < 0.2:
        part[name + "x"] = part.pop(name)
    elif way < 0.45 and isinstance(part[name], float) and part[name] == part[name]:
        part[name] = part[name] * float(draw.choice([1.01, -1.0, 1e6])) + 0.25
    else:
        part[name] = ODD[draw.integers(len(ODD))]
    record[column] = json.dumps(data, sort_keys=True, separators=(",", ":"))
    return record, f"{column}.{name}"


def _storable(column, value, before):
    """Columns are strict: a session is a number, all else text."""
    if column == "session":
        return 99 if isinstance(value, str) or value > 2**62 else int(value) + 7
    return f"{before}a" if str(value) == before else str(value)


def looked_at(folder, known):
    """All that reads a store, to the end."""
    load_results(folder)
    outcomes, _ = load_outcomes(folder, known)
    return outcomes


def refusal(path, known):
    """The sentence by which a store is refused; empty where it is read."""
    try:
        looked_at(path.parent, known)
    except la.InputError as error:
        return str(error)
    return ""


def campaign(path, count, seed, sealed):
    """How many alterations were refused by a sentence, and what was let through."""
    whole, known = path.read_bytes(), gather()
    record = record_of(path)
    draw = np.random.default_rng(seed)
    refused, accepted = 0, []
    for _ in range(count):
        path.write_bytes(whole)
        changed, what = altered(draw, record)
        same = all(changed[name] == record[name] for name in TEXTS)
        forge(path, record, changed, sealed)
        if same:
            continue
        if sentence := refusal(path, known):
            assert str(path) in sentence
            assert "field" in sentence
            refused += 1
        else:
            accepted.append(what)
    path.write_bytes(whole)
    return refused, accepted


def test_no_row_with_a_forged_checksum_is_believed(path):
    refused, accepted = campaign(path, 75, 2031, sealed=False)
    assert refused > 60
    assert accepted == []


TOLD_TWICE = {
    "run", "session", "row.case", "row.variant", "row.backend", "row.mesh", "row.gap",
    "row.outer_iterations", "row.iterations", "row.claimed",
}  # fmt: skip


def test_with_its_seal_forged_too_a_row_is_read_as_what_it_could_be_or_refused(path):
    """No exception but ours; what passes is a plain value that stands nowhere else in the row."""
    refused, accepted = campaign(path, 75, 7, sealed=True)
    assert refused > 37
    assert not TOLD_TWICE & set(accepted)
    assert not any(what.startswith("identity") for what in accepted)


@pytest.mark.parametrize(
    ("column", "change", "words"),
    [
        ("row", lambda row: row | {"load_factor": None}, "'row.load_factor' is not a number"),
        ("row", lambda row: row | {"load_factor": nan}, "'row.load_factor' is missing"),
        ("row", lambda row: row | {"status": "fine"}, "'row.status' = 'fine' is no status"),
        ("row", lambda row: row | {"verdict": "PASS"}, "is no verdict"),
        ("row", lambda row: row | {"n_elements": -3}, "'row.n_elements' = -3"),
        ("row", lambda row: row | {"n_dofs": 1.5}, "'row.n_dofs' = 1.5"),
        ("row", lambda row: row | {"iterations": 10**400}, "'row.iterations' is not a number"),
        ("row", lambda row: row | {"gap": 0.0}, "'row.gap' = 0.0 contradicts"),
        ("row", lambda row: row | {"case": "other"}, "'row.case' is not that of its identity"),
        ("row", lambda row: row | {"findings": '["x"]'}, "'row.findings' are no findings"),
        ("row", lambda row: row | {"more": 1}, "has not the columns of a row: more"),
        (
            "row",
            lambda row: {k: v for k, v in row.items() if k != "mesh"},
            "columns of a row: mesh",
        ),
        ("row", lambda row: [row], "'row' is no dict"),
        ("residuals", lambda own: own | {"gap": "0"}, "'residuals.gap' is not a number"),
        ("residuals", lambda own: {}, "field"),
        ("history", lambda own: [*own, {}], "has not the columns of the first one"),
        ("history", lambda own: [1], "has not the columns"),
        ("history", lambda own: own[:-1], "contradicts"),
        ("identity", lambda own: own | {"parameters": {"mu": [{}]}}, "neither text nor a finite"),
        ("identity", lambda own: own | {"backend": 3}, "'identity.backend' is no str"),
        ("identity", lambda own: own | {"backend": "highs"}, "'run' is not the key"),
    ],
)
def test_a_wrong_field_is_named(path, column, change, words):
    record = record_of(path)
    text = canonical(change(json.loads(record[column])))
    forge(path, record, record | {column: text}, sealed=True)
    with pytest.raises(la.InputError) as caught:
        load_results(path.parent)
    assert words in str(caught.value)
    assert str(path) in str(caught.value)
    assert record["run"] in str(caught.value)
    with pytest.raises(la.InputError, match="is damaged"):
        Store(path, {})


@pytest.mark.parametrize("text", ["", "[", "{" * 100_000, "[" * 100_000, "null", "3"])
@pytest.mark.parametrize("column", ["identity", "row", "residuals", "history"])
def test_text_that_is_no_json_is_named(path, column, text):
    record = record_of(path)
    forge(path, record, record | {column: text}, sealed=True)
    with pytest.raises(la.InputError, match=f"field '{column}"):
        load_results(path.parent)


def test_provenance_that_is_none_is_named(path):
    for text in ("", "[]", '{"date": 3}'):
        with closing(sqlite3.connect(path)) as database, database:
            database.execute("UPDATE sessions SET provenance = ?", (text,))
        with pytest.raises(la.InputError, match="session 1, provenance"):
            sessions(path)


def test_a_session_that_nobody_wrote_is_named(path):
    with closing(sqlite3.connect(path)) as database, database:
        database.execute("DELETE FROM sessions")
    with pytest.raises(la.InputError, match="'session' names none"):
        load_results(path.parent)


def test_a_state_of_another_load_factor_is_left_to_verify(path):
    """Arrays are not of the seal: `lacore verify` computes residuals afresh from them."""
    record = record_of(path)
    point = unpacked(record["arrays"])
    other = packed(replace(point, load_factor=2 * point.load_factor))
    forge(path, record, record | {"arrays": other})
    assert len(load_results(path.parent)) == 3


def test_a_store_from_before_there_were_seals_is_read_and_goes_on(tmp_path):
    """The committed report: its rows have none; the next session gives it a column for them."""
    folder = ROOT / "reports" / "reference"
    copy = Path(shutil.copy(folder / NAME, tmp_path / NAME))
    before = load_results(tmp_path)
    with Store(copy, {"date": "a day"}):
        pass
    with closing(sqlite3.connect(copy)) as database:
        assert database.execute("PRAGMA user_version").fetchone() == (SCHEMA,)
    assert load_results(tmp_path).equals(before)
    assert len(entries(copy)) == len(before) > 0


def test_variants_are_found_again(original):
    """Sound rows are read as they were, with their cases."""
    outcomes = looked_at(original, gather())
    assert [type(outcome.run.variant) for outcome in outcomes] == [Variant] * 3


def test_paths_of_earlier_versions_can_be_read(tmp_path):
    """Their histories do not state by how much bodies overlap."""
    path = tmp_path / NAME
    runs = comparison.plan(["upsetting:smooth-perfect"], ["clarabel"], ["coarse"])
    run_all(runs, path, executor=run_in_order)
    record = record_of(path)
    history = json.loads(record["history"])
    rows = [{name: own for name, own in row.items() if name != "overlap"} for row in history]
    assert len(rows[0]) == len(history[0]) - 1
    forge(path, record, {**record, "history": json.dumps(rows)}, sealed=True)
    assert len(entries(path)) == 1
