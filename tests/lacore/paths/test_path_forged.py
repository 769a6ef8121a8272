"""Checkpoints that were changed inside a valid archive: refused by a sentence that names the field.

By hand, and with all digests made afresh by our own code.
"""

import io
import json
from math import inf, nan

import numpy as np
import pytest

from lacore.paths.stage import staged
from lacore.paths.stored.checkpoint import Checkpoint, _digest, _seal
from lacore.reporting.errors import InputError
from tests.lacore.paths.path_billets import billet, pressed

ODD = [nan, inf, -1, -1.0, 0, 1e308, 10**400, 0.5, 3, True, None, "", "x", [], [1, 2], {}, {"a": 1}]
START = staged(*billet()).start


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """The bytes of a checkpoint of three steps."""
    file = tmp_path_factory.mktemp("kept") / "path.npz"
    pressed(3, checkpoint=file)
    return file.read_bytes()


def parts(data):
    with np.load(io.BytesIO(data)) as archive:
        arrays = dict(archive)
    return json.loads(arrays.pop("head").tobytes()), arrays


def archived(head, arrays, forged):
    """Bytes of an archive; `forged`: with the digests that our own code would have written."""
    arrays = dict(arrays)
    if forged:
        digests = {name: _digest(values) for name, values in arrays.items() if name != "seal"}
        head = {**head, "digests": digests}
    text = json.dumps(head).encode()
    if forged:
        arrays["seal"] = _seal(text)
    buffer = io.BytesIO()
    np.savez(buffer, head=np.frombuffer(text, dtype=np.uint8), **arrays)
    return buffer.getvalue()


def refusal(file, identity):
    """The sentence by which a file is refused; empty where it is read."""
    try:
        with Checkpoint(file, identity) as checkpoint:
            checkpoint.load(START)
    except InputError as error:
        return str(error)
    return ""


def altered(draw, head, arrays):
    """One thing changed somewhere, and what."""
    arrays, head = dict(arrays), json.loads(json.dumps(head))
    if draw.random() < 0.6:
        name = str(draw.choice(sorted(set(arrays) - {"seal"})))
        arrays[name] = other_array(draw, arrays[name])
        if arrays[name] is None:
            del arrays[name]
        return head, arrays, name
    part, way = head, ["here", "snapshots", "events", "step", "bodies"][draw.integers(5)]
    where = way
    if way in ("snapshots", "events") and head[way]:
        part = head[way][draw.integers(len(head[way]))]
        way = str(draw.choice(list(part)))
    elif way == "here":
        part = head["here"]
        way = str(draw.choice(list(part)))
    number = isinstance(part[way], int | float) and not isinstance(part[way], bool)
    if number and draw.random() < 0.4:
        part[way] = part[way] * 1.01 + 0.001
    elif draw.random() < 0.15:
        del part[way]
    else:
        part[way] = ODD[draw.integers(len(ODD))]
    return head, arrays, f"{where}.{way}"


def other_array(draw, values):
    way = int(draw.integers(8))
    if way == 0:
        return None
    if way == 1:
        return values[:-1] if values.ndim else values[None]
    if way == 2:
        return values.astype(str)
    if way == 3:
        return values.astype(complex)
    if way == 4:
        return np.zeros((0,) * values.ndim)
    changed = np.array(values, dtype=float)
    if changed.size:
        place = np.unravel_index(int(draw.integers(changed.size)), changed.shape)
        changed[place] = [nan, inf, changed[place] * 1.001 + 1e-6][way - 5]
    return changed


def campaign(file, data, count, seed, forged):
    head, arrays = parts(data)
    draw = np.random.default_rng(seed)
    refused, accepted = 0, []
    for _ in range(count):
        changed, others, what = altered(draw, head, arrays)
        same = set(others) == set(arrays) and all(
            _digest(others[name]) == _digest(arrays[name]) for name in others
        )
        if same and json.dumps(changed) == json.dumps(head):
            continue
        file.write_bytes(archived(changed, others, forged))
        sentence = refusal(file, head["identity"])
        if not sentence:
            accepted.append(what)
            continue
        assert "checkpoint" in sentence
        assert sentence.endswith("restore a copy, or name another file")
        refused += 1
    return refused, accepted


def test_a_sound_one_is_read(tmp_path, kept):
    head, arrays = parts(kept)
    for forged in (False, True):
        (tmp_path / "p").write_bytes(archived(head, arrays, forged))
        assert refusal(tmp_path / "p", head["identity"]) == ""


def test_nothing_that_was_changed_inside_a_valid_archive_is_believed(tmp_path, kept):
    refused, accepted = campaign(tmp_path / "p", kept, 80, 14, forged=False)
    assert refused > 64
    assert accepted == []


def test_with_all_digests_forged_a_path_is_one_that_could_have_been_or_is_refused(tmp_path, kept):
    """No exception but ours; what passes is a number that follows from no other."""
    refused, accepted = campaign(tmp_path / "p", kept, 80, 15, forged=True)
    assert refused > 48
    rows = {"row/force", "row/error", "row/gap", "row/seconds", "row/solves", "row/travel"}
    rows |= {"row/volume", "row/min_jacobian", "row/max_strain"}
    once = {"here.speed", "here.growth", "step.step", "snapshots.duration", "snapshots.moment"}
    fields = {what for what in accepted if not what.startswith(("snapshot/", "events"))}
    assert fields <= rows | once


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda head, arrays: head["here"].update(travel=0.123), "'here.travel' is not the end"),
        (lambda head, arrays: head["here"].update(step=7), "'row' has 3 steps, and the path 7"),
        (lambda head, arrays: head["here"].update(speed=nan), "'here.speed' is no positive"),
        (lambda head, arrays: head.update(step="0.1"), "'step' is no positive number"),
        (lambda head, arrays: arrays["row/volume"].__setitem__(1, nan), "'row 2, volume'"),
        (lambda head, arrays: arrays["row/load_factor"].__setitem__(0, 9.0), "sum of its powers"),
        (lambda head, arrays: arrays["row/step"].__setitem__(0, 2), "'row 1, step' is 2"),
        (lambda head, arrays: arrays["here/nodes/0"].__setitem__((0, 0), 5), "'here, nodes'"),
        (lambda head, arrays: arrays["snapshot/0/nodes/0"].__setitem__((0, 0), 5), "snapshot 0"),
        (lambda head, arrays: arrays["snapshot/2/strain/0"].__setitem__((0, 0), 5), "maximum"),
        (lambda head, arrays: head["snapshots"][1].update(step=2), "snapshot 1, travel"),
        (lambda head, arrays: head["snapshots"].pop(), "snapshots"),
        (
            lambda head, arrays: arrays.update({"snapshot/2/normal_reaction": np.array([-1.0])}),
            "reactions",
        ),
        (
            lambda head, arrays: arrays.update({"snapshot/2/normal_reaction": np.array([np.nan])}),
            "normal_reaction",
        ),
        (lambda head, arrays: arrays.update({"snapshot/2/slip": np.array([-1.0])}), "slip"),
    ],
)
def test_a_wrong_field_is_named(tmp_path, kept, change, words):
    head, arrays = parts(kept)
    arrays = {name: np.array(values) for name, values in arrays.items()}
    change(head, arrays)
    (tmp_path / "p").write_bytes(archived(head, arrays, forged=True))
    sentence = refusal(tmp_path / "p", head["identity"])
    assert words in sentence
    assert str(tmp_path / "p") in sentence
    (tmp_path / "p").write_bytes(archived(head, arrays, forged=False))
    assert "was changed" in refusal(tmp_path / "p", head["identity"])
