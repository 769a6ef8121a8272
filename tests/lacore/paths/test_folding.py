"""Bodies that come to touch themselves: where, when, and how the path ends."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.paths.contact.folding import first_fold
from lacore.paths.ending import Ending

GAP = 0.1  # m, between the tips of the jaw


def clamp():
    """A jaw that is open to the right: a weak web of height 1 on the left, strong arms with tips.

    The arms are 1 high; from them tips at the right reach towards each other.
    """

    def part(x, y):
        corners = [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])]
        return la.meshes.Patch(corners, 2, 2)

    low, high = (0, 1), (2, 3)
    arms = [part(x, y) for x in ((0, 1), (1, 1.5), (1.5, 2)) for y in (low, high)]
    middle = 1.5
    tips = [part((1.5, 2), (1, middle - GAP / 2)), part((1.5, 2), (middle + GAP / 2, 2))]
    mesh = la.meshes.patches([part((0, 1), (1, 2)), *arms, *tips], crossed=False)
    web = (mesh.p[:, mesh.t].mean(axis=1) < [[1], [2]]).all(axis=0)
    web &= mesh.p[1, mesh.t].mean(axis=0) > 1
    return mesh.with_subdomains({"web": np.flatnonzero(web), "arms": np.flatnonzero(~web)})


def closing(**more):
    metals = {"web": la.VonMises(1.0), "arms": la.VonMises(50.0)}
    problem = la.Problem(
        {"jaw": la.Body(clamp(), metals, space="p2-gauss")},
        [la.RigidFooting("jaw", lambda x: x[1] > 3 - 1e-9, (0, -1), rough=True)],
        [la.Fix("jaw", lambda x: x[1] < 1e-9)],
    )
    return la.sequential(problem, **more)


@pytest.mark.parametrize(
    ("scheme", "steps"),
    [
        ("leapfrog", 2),
        ("explicit", 3),
        pytest.param("implicit-midpoint", 1, marks=pytest.mark.slow),
    ],
)
def test_a_path_ends_where_the_body_touches_itself(scheme, steps):
    """The arms are rigid, so that the tips touch at the travel of the gap, in mid-step."""
    path = closing(travel=0.16, steps=steps, scheme=scheme)
    assert path.status is Ending.FOLDED, path.message
    (event,) = path.events[path.events["kind"] == "boundary folded"].itertuples()
    assert event.travel == pytest.approx(GAP, rel=1e-6)
    assert path.history["end"].iloc[-1] == pytest.approx(GAP, rel=2e-5)
    assert event.step == path.history["step"].iloc[-1]
    assert "the boundary of 'jaw' touches itself near (" in path.message
    assert "add an interface between them to 'approaching'" in path.message


def test_a_path_that_ends_before_is_not_folded():
    path = closing(travel=0.09, steps=2)
    assert path.status is Ending.REACHED
    assert "boundary folded" not in set(path.events["kind"])


def test_the_first_touch_of_a_motion_is_exact():
    """One arm turns: its corner comes down by a quarter of its length."""
    mesh = la.meshes.isoparametric(clamp())
    x, y = mesh.doflocs
    turned = np.where((y > 1.5) & (x > 1), 0.5 * (x - 1), 0.0)  # 0.5 at x = 2
    moved = replace(mesh, doflocs=np.stack([x, y - turned]))
    fold = first_fold({"jaw": mesh}, {"jaw": moved})
    assert fold.share == pytest.approx(GAP / 0.5, rel=1e-12)
    assert fold.place == pytest.approx([2, 1.45], abs=1e-12)
    lifted = replace(mesh, doflocs=np.stack([x, y + turned]))
    assert first_fold({"jaw": mesh}, {"jaw": lifted}) is None
