"""Hooks of a path: when they are called, what they see, and what happens where one fails."""

from xml.etree import ElementTree

import pandas as pd
import pytest

import lacore as la
from lacore.limit.state import LimitState
from lacore.paths.ending import Ending
from lacore.paths.hooks.hook import TIMES
from lacore.reporting.errors import InputError
from tests.lacore.paths.path_billets import pressed
from tests.lacore.paths.test_path_checkpoint import assert_same

BAR = la.Problem(
    {
        "bar": la.Body(
            la.meshes.quadrilaterals(x=(0, 1), y=(0, 1), nx=1, ny=1),
            la.VonMises(hardening=la.hardening.Linear(1.0, 1.0)),
            space="q2",
        )
    },
    [la.RigidFooting("bar", "right", (1, 0), rough=False)],
    [la.Fix("bar", "left", "x"), la.Fix("bar", "bottom", "y")],
)


def drawn(steps=3, **more):
    """A bar that is drawn out."""
    return la.sequential(BAR, 0.3, steps, **more)


@pytest.fixture(scope="module")
def plain():
    return drawn()


def test_hooks_are_called_in_order_and_change_nothing(plain):
    seen = []
    hooks = [la.Hook(lambda now: seen.append((now.step, now.when)), when) for when in TIMES]
    path = drawn(hooks=hooks)
    assert_same(path, plain)
    first, second = ([when for at, when in seen if at == step] for step in (1, 2))
    assert (first[0], first[-1]) == ("before step", "after step")
    assert second == ["before step", "before solve", "after solve", "after step"]
    assert seen[-1] == (3, "end")
    solves = sum(when == "after solve" for _, when in seen)
    assert solves == plain.history["solves"].sum()


def test_a_bare_function_is_called_after_each_step(plain):
    rows = []
    drawn(hooks=[lambda now: rows.append(now.row)])
    assert [row.step for row in rows] == [1, 2, 3]
    assert [row.load_factor for row in rows] == plain.history["load_factor"].tolist()


def test_a_hook_sees_the_path_so_far_the_shape_and_the_state():
    lengths, states, paths = [], [], []
    drawn(
        hooks=[
            la.Hook(lambda now: lengths.append(now.problem.bodies["bar"].mesh.p[0].max())),
            la.Hook(lambda now: states.append(now.state), "after solve"),
            la.Hook(lambda now: paths.append(now.path), "before step"),
            la.Hook(lambda now: paths.append(now.path), "end"),
        ]
    )
    assert lengths == pytest.approx([1.1, 1.2, 1.3])
    assert all(
        isinstance(state, LimitState) and state.status is la.Status.SOLVED for state in states
    )
    assert [len(path.history) for path in paths] == [0, 1, 2, 3]
    assert [path.status for path in paths] == [*[Ending.RUNNING] * 3, Ending.REACHED]


@pytest.mark.parametrize(
    ("when", "steps"), [("after step", 2), ("before step", 1), ("after solve", 1)]
)
def test_an_exception_ends_the_path_and_keeps_the_finished_steps(plain, when, steps):
    def stop(now):
        if now.step == 2:
            raise ValueError("the press is too weak")

    path = drawn(hooks=[la.Hook(stop, when)])
    assert path.status is Ending.STOPPED
    assert path.message.startswith(f"stopped: hook 'stop' ({when}) raised ValueError: the press is")
    assert "(test_hooks.py, line " in path.message
    columns = ["travel", "load_factor", "end"]
    pd.testing.assert_frame_equal(path.history[columns], plain.history[columns].head(steps))


def test_a_stopped_path_continues_from_its_checkpoint(plain, tmp_path):
    def stop(now):
        raise RuntimeError

    file = tmp_path / "path.npz"
    assert len(drawn(checkpoint=file, hooks=[stop]).history) == 1
    assert_same(drawn(checkpoint=file), plain)


def test_a_failure_at_the_end_keeps_the_path(plain):
    def broken(now):
        raise OSError("disk full")

    path = drawn(hooks=[la.Hook(broken, "end")])
    assert path.status is Ending.STOPPED
    assert "hook 'broken' (end) raised OSError: disk full" in path.message
    assert path.history["load_factor"].equals(plain.history["load_factor"])


def test_interrupts_pass():
    def interrupt(now):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        drawn(hooks=[interrupt])


def test_hooks_around_new_meshes():
    seen = []

    def remesh(problem):
        seen.append("remesh")
        return {"billet": la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=3, ny=3, crossed=False)}

    def note(now):
        seen.append((now.when, now.problem.bodies["billet"].mesh.nelements))

    hooks = [la.Hook(note, f"{when} remeshing") for when in ("before", "after")]
    path = pressed(2, travel=0.8, remesh=remesh, hooks=hooks)
    assert "remeshed" in set(path.events["kind"])
    assert seen == [("before remeshing", 8), "remesh", ("after remeshing", 18)]


def test_shipped_hooks_write_progress_tables_curves_and_films(tmp_path, capsys, plain):
    drawn(
        hooks=[
            la.hooks.progress(),
            la.hooks.table(tmp_path / "history.csv"),
            la.hooks.curve(tmp_path / "force.png"),
            la.hooks.animation(tmp_path / "bar.gif", dpi=20),
        ]
    )
    assert [line.split(":")[0] for line in capsys.readouterr().out.splitlines()] == [
        *("step 1", "step 2", "step 3")
    ]
    table = pd.read_csv(tmp_path / "history.csv")
    assert table["force"].to_numpy() == pytest.approx(plain.history["force"].to_numpy(), rel=1e-12)
    assert (tmp_path / "force.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "bar.gif").read_bytes().startswith(b"GIF")


def test_the_table_is_complete_when_the_path_is_stopped(tmp_path):
    def stop(now):
        if now.step == 2:
            raise ValueError

    drawn(hooks=[la.hooks.table(tmp_path / "history.csv"), stop])
    assert pd.read_csv(tmp_path / "history.csv")["step"].tolist() == [1, 2]


def test_vtu_files_have_every_step_even_those_that_are_not_kept(tmp_path):
    meshio = pytest.importorskip("meshio")
    counts = []

    def count(now):
        series = ElementTree.parse(tmp_path / "bar" / "path.pvd").getroot()
        counts.append(len(series.findall(".//DataSet")))

    path = drawn(keep_every=3, hooks=[la.hooks.vtu(tmp_path / "bar"), count])
    assert counts == [2, 3, 4]  # with the beginning
    assert [own.step for own in path.snapshots] == [0, 3]
    last = meshio.read(tmp_path / "bar" / "step-0003.vtu")
    assert last.points[:, 0].max() == pytest.approx(1.3)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: drawn(hooks=3), "hooks = 3: .*give|hooks = 3: not a list"),
        (lambda: drawn(hooks=[3]), r"hooks\[0\] = 3: neither a hook nor a function"),
        (lambda: la.Hook(print, "after stp"), "Hook.when = 'after stp'.*after step"),
        (lambda: la.Hook(3), "Hook.call = 3: not a function"),
        (lambda: la.hooks.animation("a.png"), "file = 'a.png'.*gif"),
        (lambda: la.hooks.curve("there/is/none.png"), "its folder does not exist"),
    ],
)
def test_bad_hooks_are_refused_before_the_first_step(make, said):
    with pytest.raises(InputError, match=said):
        make()
