"""Paths that stop anywhere, and go on as if nothing had been."""

import io
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import lacore as la
from lacore.coupling.friction_start import FrictionStart
from lacore.paths.configuration import Configuration
from lacore.paths.flow import Moment, Snapshot
from lacore.paths.renewal.remeshing import NewMeshes
from lacore.paths.schemes import Here
from lacore.paths.stored.progress import Progress
from lacore.reporting.errors import InputError
from tests.lacore.paths.path_billets import FOLLOWED, billet, pressed
from tests.shares import one_in

ROOT = Path(__file__).parents[3]


class Stop(Exception):  # noqa: N818  # of these tests
    pass


def stop_after(step):
    def on_step(row):
        if row.step == step:
            raise Stop

    return on_step


def assert_same(path, other):
    """Bit for bit, wall clock excepted."""
    assert (path.status, path.message) == (other.status, other.message)
    for one, two in ((path.history, other.history), (path.events, other.events)):
        pd.testing.assert_frame_equal(
            one.drop(columns="seconds", errors="ignore"),
            two.drop(columns="seconds", errors="ignore"),
            check_exact=True,
        )
    assert len(path.snapshots) == len(other.snapshots)
    assert [own.duration for own in path.snapshots] == [own.duration for own in other.snapshots]
    for one, two in zip(path.snapshots, other.snapshots, strict=True):
        assert (one.step, one.travel) == (two.step, two.travel)
        for a, b in zip(arrays(one), arrays(two), strict=True):
            np.testing.assert_array_equal(a, b, strict=True)
    assert path.last.load_factor == other.last.load_factor
    np.testing.assert_array_equal(path.last.point.velocity, other.last.point.velocity)


def arrays(snapshot):
    parts = (snapshot.configuration.nodes, snapshot.configuration.strain)
    parts += (snapshot.velocity, snapshot.strain_rate)
    return [part[name] for part in parts for name in sorted(part)]


@pytest.mark.parametrize(
    "more",
    [
        {},
        pytest.param({"scheme": "implicit-midpoint"}, marks=pytest.mark.slow),
        pytest.param({"scheme": "explicit", "keep_every": 2}, marks=pytest.mark.slow),
        {"steps": la.AdaptiveSteps(tolerance=3e-3, first=0.2)},
        pytest.param(
            {"steps": 5, "travel": 0.75, "billet": lambda: billet(crossed=True)},
            marks=pytest.mark.slow,
        ),
        pytest.param({"control": la.PointTravel("billet", (0, 0), (0, 1))}, marks=pytest.mark.slow),
    ],
    ids=["leapfrog", "midpoint", "explicit", "adaptive", "folding", "point"],
)
def test_goes_on_as_if_nothing_had_been(tmp_path, more):
    whole = pressed(**more)
    assert ("billet" in more) == ("contact closed" in set(whole.events["kind"]))
    for step in (1, 3):
        with pytest.raises(Stop):
            pressed(checkpoint=tmp_path / "path.npz", on_step=stop_after(step), **more)
    taken = []
    path = pressed(checkpoint=tmp_path / "path.npz", on_step=taken.append, **more)
    assert [row.step for row in taken] == list(range(4, len(whole.history) + 1))
    assert_same(path, whole)
    # Nothing is left to do: one solve, for the last state.
    assert_same(pressed(checkpoint=tmp_path / "path.npz", on_step=stop_after(0), **more), whole)


def test_a_path_that_ends_early_ends_so_again(tmp_path):
    """With its event, once."""
    asked = {"steps": 2, "travel": 0.9}
    path = pressed(checkpoint=tmp_path / "p", **asked)
    assert list(path.events["kind"]).count("inversion predicted") == 1
    assert_same(pressed(checkpoint=tmp_path / "p", **asked), path)


def test_without_a_step_there_is_no_file(tmp_path):
    problem, _ = billet()
    control = la.PointTravel("billet", (0, 0), (0, -1))  # against the motion
    path = la.sequential(problem, 0.1, 2, control=control, checkpoint=tmp_path / "new" / "p")
    assert path.status.label == "standstill"
    assert path.last is None
    assert not (tmp_path / "new" / "p").exists()


@dataclass(frozen=True)
class Offset:
    """A control of a user."""

    share: float

    def gauge(self, problem):
        return lambda d, velocity: self.share


class Bare:
    def gauge(self, problem):
        return lambda d, velocity: 1.0


class Own:
    """A law of a user that is no dataclass: known by its values."""

    def __init__(self, slope):
        self.slope = slope

    def stress(self, strain):
        return 1 + self.slope * np.asarray(strain)

    def modulus(self, strain):
        return np.full(np.shape(strain), self.slope)


def test_of_another_path(tmp_path, monkeypatch):
    """Refused by the name of what differs; the file stays as it is."""
    file = tmp_path / "path.npz"
    problem, approaching = billet()

    def go(problem=problem, approaching=approaching, travel=0.1, steps=2, **more):
        return la.sequential(
            problem, travel, steps, approaching=approaching, checkpoint=file, **more
        )

    go()
    data = file.read_bytes()
    moved = replace(problem, bodies={"billet": billet(3)[0].bodies["billet"]})
    harder = billet(law=la.hardening.Linear(1.0, 2.0))[0]
    dead = replace(problem, dead_loads=[la.BodyForce("billet", (0, -0.1))])
    held = replace(problem, supports=[la.Fix("billet", "left", "x"), la.Fix("billet", "top", "y")])
    others = {
        "bodies": [{"problem": moved}, {"problem": harder}],
        "loads": [{"problem": dead}],
        "supports": [{"problem": held}],
        "interfaces": [{"approaching": ()}],
        "travel": [{"travel": 0.2}],
        "steps": [{"steps": 3}, {"steps": la.AdaptiveSteps()}],
        "scheme": [{"scheme": "explicit"}],
        "control": [{"control": Offset(1.0)}],
        "keep_every": [{"keep_every": 2}],
        "backend": [{"backend": "cvxpy"}],
        "coupling": [{"coupling": "reaction"}],
        "tolerance": [{"tolerance": 1e-5}],
        "options": [{"options": {"time_limit": 100.0}}],
    }
    for name, changes in others.items():
        for change in changes:
            with pytest.raises(InputError, match=f"is of another path: .*{name}.*; give the same"):
                go(**change)
            assert file.read_bytes() == data
    monkeypatch.setattr("lacore.paths.stored.checkpoint.__version__", "0.0")
    with pytest.raises(InputError, match="version of lacore"):
        go()
    assert file.read_bytes() == data


def test_values_of_others_are_known_again(tmp_path):
    for name, law in (("one", Own(1.0)), ("two", la.hardening.Table([0, 1], [1, 2]))):
        made = billet(law=law)
        first = pressed(1, billet=lambda made=made: made, checkpoint=tmp_path / name)
        again = pressed(1, billet=lambda made=made: made, checkpoint=tmp_path / name)
        assert_same(again, first)
    with pytest.raises(InputError, match="other bodies"):
        pressed(1, billet=lambda: billet(law=Own(2.0)), checkpoint=tmp_path / "one")
    with pytest.raises(InputError, match=r"control = .* frozen dataclass"):
        pressed(1, control=Bare(), checkpoint=tmp_path / "three")


def test_damaged(tmp_path):
    """A changed bit is found, or changes nothing; the file stays as it is."""
    file = tmp_path / "path.npz"
    made = pressed(1, checkpoint=file)
    data = file.read_bytes()
    draw = np.random.default_rng(7)
    cases = [b"", b"nothing of ours\n", data[:-1], data[: len(data) // 2], data[100:]]
    for place in draw.integers(len(data), size=20):
        changed = bytearray(data)
        changed[place] ^= 1 << int(draw.integers(8))
        cases.append(bytes(changed))
    refused = 0
    for case in cases:
        file.write_bytes(case)
        with suppress(InputError):
            assert_same(pressed(1, checkpoint=file), made)
            continue
        with pytest.raises(InputError, match=r"checkpoint.*restore a copy, or name another file"):
            pressed(1, checkpoint=file)
        refused += 1
        assert file.read_bytes() == case
    assert refused > len(cases) / 2


def test_arrays_that_hold_code_are_refused(tmp_path):
    buffer = io.BytesIO()
    np.savez(buffer, head=np.array([{"a": 1}], dtype=object))
    (tmp_path / "p").write_bytes(buffer.getvalue())
    with pytest.raises(InputError, match="is damaged, or no checkpoint"):
        pressed(1, checkpoint=tmp_path / "p")


def test_places_that_cannot_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    for place in (tmp_path, tmp_path / "file" / "p"):
        with pytest.raises(InputError, match="checkpoint"):
            pressed(1, checkpoint=place)


@pytest.mark.skipif(sys.platform != "linux", reason="limits the size of files")
def test_full_disk(tmp_path):
    """Files may not grow: one sentence, the steps before are kept, nothing half done is left."""
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    file, sizes = tmp_path / "path.npz", []

    def on_step(row):
        sizes.append(file.stat().st_size)
        resource.setrlimit(resource.RLIMIT_FSIZE, (sizes[0] // 2, hard))

    try:
        with pytest.raises(InputError, match=r"checkpoint.*cannot be used.*the last step"):
            pressed(checkpoint=file, on_step=on_step)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert len(sizes) == 1
    assert sorted(own.name for own in tmp_path.iterdir()) == ["path.npz", "path.npz.lock"]
    taken = []
    path = pressed(checkpoint=file, on_step=taken.append)
    assert [row.step for row in taken] == [2, 3, 4]
    assert_same(path, pressed())


def test_two_at_once(tmp_path):
    def on_step(row):
        pressed(checkpoint=tmp_path / "p")

    with pytest.raises(InputError, match="is being written by another process"):
        pressed(checkpoint=tmp_path / "p", on_step=on_step)


def test_all_that_a_step_needs_is_kept():
    """Who adds a field to one of these adds it to the file, and raises its format."""
    known = {
        Here: ["step", "travel", "configuration", "velocity", "strain_rate", "speed", "growth"],
        Moment: ["begin", "at", "duration", "share", "friction_start"],
        FrictionStart: ["normal_reaction", "slip"],
        Configuration: ["nodes", "strain"],
        Snapshot: [
            "step",
            "travel",
            "configuration",
            "velocity",
            "strain_rate",
            "moment",
            "duration",
        ],
        Progress: ["here", "step", "rows", "events", "snapshots", "made"],
        NewMeshes: ["step", "nodes", "meshes"],
    }
    for kind, names in known.items():
        assert [entry.name for entry in fields(kind)] == names


@pytest.mark.parametrize("scheme", one_in(2, ["leapfrog", "implicit-midpoint"]))
def test_states_of_steps_are_those_of_their_rows(tmp_path, scheme):
    """What the platen bears is what presses; on the way, at the end, and read from the disk."""
    path = pressed(3, scheme=scheme, checkpoint=tmp_path / "p")
    again = pressed(3, scheme=scheme, checkpoint=tmp_path / "p")
    for one in (path, again):
        assert one.state() is one.state(3) is one.last
        for row in one.history.itertuples():
            state = one.state(row.step)
            point, contact = state.point, state.discretisation.full.contact
            force = row.force * state.load_factor / row.load_factor
            assert contact.weights @ point.normal_reaction == pytest.approx(force, rel=1e-9)
            assert state.certificate.gap == row.gap
            # Of second order in how much the speed changes within a step, here a sixth.
            assert state.load_factor == pytest.approx(row.load_factor, rel=1e-3)
    with pytest.raises(InputError, match="step = 0: is the beginning, without a state"):
        path.state(0)
    for wrong in ("2", None, True, 2.0):
        with pytest.raises(InputError, match="not the number of a step; give a whole number"):
            path.state(wrong)
    assert str(path) == "path of 3 steps to travel 0.2, reached: the requested travel is reached"


@pytest.mark.parametrize("scheme", one_in(3, ["explicit", "leapfrog", "implicit-midpoint"]))
def test_states_of_steps_dissipate_what_their_load_does(scheme):
    """With the hardening within the step; no dead loads."""
    state = pressed(2, scheme=scheme).state(1)
    volumes, reactions = state.discretisation.continua["billet"].volumes, state.reactions
    plastic = volumes @ state.dissipation["billet"]
    friction = -(reactions.length * reactions.t_t * reactions.u_t).sum()
    # The certificate's bar on the gap.
    assert plastic + friction == pytest.approx(state.load_factor, rel=1e-6)


@pytest.mark.parametrize("keep_every", one_in(2, [1, 2, 3, 100]))
def test_kept_snapshots(keep_every):
    path = pressed(5, keep_every=keep_every)
    wanted = sorted({*range(0, 6, keep_every), 5})
    assert [own.step for own in path.snapshots] == wanted
    assert path.snapshot(5) is path.snapshots[-1] is path.snapshot(-1)
    assert path.problem(wanted[1]).bodies.keys() == {"billet"}
    if keep_every > 1:
        with pytest.raises(InputError, match="step = 1: has no snapshot; give one of 0, "):
            path.problem(1)


def test_kept_snapshots_are_counted():
    with pytest.raises(InputError, match="keep_every"):
        pressed(1, keep_every=0)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize(("what", "steps", "most"), [("billet", 60, 8), ("stack", 30, 6)])
def test_killed_at_random_moments(tmp_path, what, steps, most):
    """SIGKILL, again and again, while it starts, solves and writes; two bodies and tools, too."""
    file, follow = tmp_path / "path.npz", FOLLOWED[what]
    whole = follow(steps, travel=0.3)
    draw = np.random.default_rng(2031)
    words = [sys.executable, "-m", "tests.lacore.paths.path_billets", str(file), str(steps), what]
    last, kills, seen = 0, 0, []
    while kills < most:
        process = subprocess.Popen(words, cwd=ROOT, stdout=subprocess.PIPE, text=True)
        wanted = last + int(draw.integers(1, 5))
        for line in process.stdout:
            last = int(line)
            seen.append(last)
            if last >= wanted:
                break
        time.sleep(draw.uniform(0, 0.05))  # into the next step, or its writing
        os.kill(process.pid, signal.SIGKILL)
        rest, _ = process.communicate()
        seen += map(int, rest.split())
        last, kills = max([last, *seen]), kills + 1
        assert process.returncode == -signal.SIGKILL
    taken = []
    path = follow(steps, travel=0.3, checkpoint=file, on_step=lambda row: taken.append(row.step))
    # No step is lost that was said to be kept; one is said by nobody where the kill came between.
    assert taken[0] in (last + 1, last + 2)
    assert taken[-1] == steps
    assert sorted(set(seen)) == sorted(seen)
    assert_same(path, whole)
    assert sorted(own.name for own in tmp_path.iterdir()) == ["path.npz", "path.npz.lock"]
