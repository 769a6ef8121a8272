"""Bodies that are bonded go through large deformation as the uncut one."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.paths.renewal.remeshing import restaged
from lacore.paths.stage import staged
from tests.lacore.paths.path_billets import PLATEN, billet

LAW = la.VonMises(hardening=la.hardening.Linear(1.0, 1.0))
# Loads of a path follow velocities, which are known to the root of what a solver is asked for: 1e-6
# of 1e-11. A load feels them to first order by how bodies have moved and hardened.
SAME = 1e-6
TIGHT = {"options": {"tolerance": 1e-11}, "tolerance": 1e-8}


def part(x, y, nx, ny):
    return la.Body(
        la.meshes.rectangle(x=x, y=y, nx=nx, ny=ny, crossed=False), LAW, space="p2-gauss"
    )


def bond(one, other):
    return la.Interface(one, other, la.BOND)


def flat(nx=2, friction=0.2):
    """The billet in two at half its height: a problem, and what approaches."""
    bodies = {"low": part((0, 1), (0, 0.5), 2, 1), "top": part((0, 1), (0.5, 1), nx, 1)}
    problem = la.Problem(
        bodies,
        [la.RigidFooting("low", "bottom", (0, 1), rough=False)],
        [la.Fix(name, "left", "x") for name in bodies],
        [
            la.Interface(("top", "top"), PLATEN, friction),
            bond(("top", "bottom"), ("low", "top")),
        ],
    )
    return problem, [la.Interface((name, "right"), PLATEN, friction) for name in bodies]


def punched(bodies, bonds=()):
    """Pressed down on the left half alone, on a smooth plate."""
    first = next(iter(bodies))

    def above(x):
        return (x[1] > 1 - 1e-9) & (x[0] <= 0.5 + 1e-9)

    floor = la.RigidObstacle((0, 0), (0, 1))
    return la.Problem(
        bodies,
        [la.RigidFooting(first, above, (0, -1), rough=False)],
        [la.Fix(first, "left", "x")],
        [*bonds, *(la.Interface((name, "bottom"), floor, la.SMOOTH) for name in bodies)],
    )


def test_a_billet_cut_and_bonded_is_pressed_like_the_uncut_one():
    """Under a friction whose load is unique, unlike Coulomb's."""
    rubs = la.Tresca(0.2)
    whole, above = billet(2)
    whole = replace(whole, interfaces=[replace(whole.interfaces[0], friction=rubs)])
    above = [replace(one, friction=rubs) for one in above]
    uncut = la.sequential(whole, 0.3, 3, approaching=above, **TIGHT)
    problem, approaching = flat(friction=rubs)
    cut = la.sequential(problem, 0.3, 3, approaching=approaching, **TIGHT)
    assert cut.status is uncut.status
    loads = [path.history["load_factor"].to_numpy() for path in (uncut, cut)]
    assert loads[1] == pytest.approx(loads[0], rel=SAME)
    low, top = (cut.problem().bodies[name].mesh for name in ("low", "top"))
    seams = [
        own.doflocs[:, np.unique([own.facets[:, own.boundaries[side]]])]
        for own, side in ((low, "top"), (top, "bottom"))
    ]
    one, other = (own[:, np.argsort(own[0])] for own in seams)
    assert one == pytest.approx(other, abs=1e-15)
    assert not np.allclose(one[1], one[1, 0], atol=1e-3)  # what was straight is bent


def test_a_bond_beside_a_punch_is_drawn_down_with_it():
    whole = {"in": part((0, 1), (0, 1), 4, 4)}
    halves = {"in": part((0, 0.5), (0, 1), 2, 4), "out": part((0.5, 1), (0, 1), 2, 4)}
    uncut, cut = (
        la.sequential(punched(*given), 0.1, 2, **TIGHT)
        for given in ((whole,), (halves, [bond(("out", "left"), ("in", "right"))]))
    )
    loads = [path.history["load_factor"].to_numpy() for path in (uncut, cut)]
    assert loads[1] == pytest.approx(loads[0], rel=SAME)


def test_a_bonded_path_goes_on_from_its_file(tmp_path):
    problem, approaching = flat()
    kept = {"approaching": approaching, "checkpoint": tmp_path / "path.npz"}
    first = la.sequential(problem, 0.2, 2, **kept)
    again = la.sequential(problem, 0.2, 2, **kept)
    assert again.history["load_factor"].tolist() == first.history["load_factor"].tolist()
    parted = replace(problem, interfaces=problem.interfaces[:1])
    with pytest.raises(la.InputError, match="interfaces"):
        la.sequential(parted, 0.2, 2, **kept)


def test_new_meshes_have_to_match_too():
    problem, approaching = flat()
    stage = staged(problem, approaching)
    meshes = {"top": la.meshes.rectangle(x=(0, 1), y=(0.5, 1), nx=3, ny=1)}
    names = stage.problem.bodies["top"].mesh.boundaries
    assert set(meshes["top"].boundaries) >= set(names)
    with pytest.raises(la.InputError, match="do not match"):
        restaged(stage, stage.start, meshes)
    finer = {
        "top": la.meshes.rectangle(x=(0, 1), y=(0.5, 1), nx=4, ny=2),
        "low": la.meshes.rectangle(x=(0, 1), y=(0, 0.5), nx=4, ny=2),
    }
    new, _ = restaged(stage, stage.start, finer)
    assert [own.name for own in new.problem.interfaces] == ["top.bottom|low.top"]


WRONG = {
    "matching": (lambda: flat(3)[0], (), r"do not match.*lacore\.matching"),
    "obstacle": (
        lambda: billet()[0],
        [la.Interface(("billet", "right"), PLATEN, la.BOND)],
        "may open and close along a path is not bonded.*hold the boundary by a Fix",
    ),
}


@pytest.mark.parametrize(("build", "approaching", "told"), WRONG.values(), ids=WRONG)
def test_what_a_path_does_not_bond(build, approaching, told):
    with pytest.raises(la.InputError, match=told):
        la.sequential(build(), 0.2, 2, approaching=approaching)
