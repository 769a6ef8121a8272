"""What once made a path end with a traceback, a wrong name or a wrong number."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.paths.ending import Ending
from lacore_verification.cases.shared.exact_paths import strip_force
from tests.lacore.paths.path_billets import PLATEN, billet, pressed


def side(friction=0.2):
    return la.Interface(("billet", "right"), PLATEN, friction)


def refused(said, problem=None, **changes):
    """The sentence that a path is refused with: before any solve, so at once."""
    arguments = {"travel": 0.1, "steps": 2} | changes
    with pytest.raises(la.InputError, match=said):
        la.sequential(problem or billet()[0], **arguments)


@pytest.mark.parametrize(
    ("said", "changes"),
    [
        ("control = 'time': not a control", {"control": "time"}),
        ("not a control", {"control": la.Time}),
        (
            "PointTravel.at = .*: not a point",
            {"control": la.PointTravel("billet", (0, 0, 0), (1, 0))},
        ),
        ("PointTravel.at", {"control": la.PointTravel("billet", (np.nan, 0), (1, 0))}),
        ("PointTravel.body", {"control": la.PointTravel(["billet"], (0, 0), (1, 0))}),
        ("approaching = .*: not a list", {"approaching": side()}),
        ("approaching = 'right': not a list", {"approaching": "right"}),
        ("approaching: not a list", {"approaching": None}),
        (r"approaching\[0\] = 'right': not an interface", {"approaching": ["right"]}),
        ("on_step = 3", {"on_step": 3}),
        ("remesh = 3", {"remesh": 3}),
        ("checkpoint = 3: no path", {"checkpoint": 3}),
        ("backend = 'clarabell'", {"backend": "clarabell"}),
        ("coupling = 'x'", {"coupling": "x"}),
        ("coupling = 'associated'", {"coupling": "associated"}),
        ("tolerance = -1", {"tolerance": -1}),
        ("options", {"options": [1]}),
        ("options", {"options": {"no such": 1}}),
    ],
)
def test_bad_arguments_are_refused_before_any_solve(said, changes):
    refused(said, **changes)


def test_one_plane_has_one_friction_for_an_edge():
    """Two laws at one place could share its reaction in any way."""
    refused("shares boundary edges", approaching=[la.Interface(("billet", "top"), PLATEN, 0.9)])
    # Two planes for one side are a wedge.
    wedge = [la.RigidObstacle((1.2, 0.5), (-1, s)) for s in (-0.1, 0.1)]
    own = [la.Interface(("billet", "right"), plane, 0.1) for plane in wedge]
    path = la.sequential(billet()[0], 0.1, 2, approaching=own)
    assert path.status is Ending.REACHED


def test_a_step_without_a_certificate_says_that_another_scheme_may_go_on():
    path = la.sequential(billet()[0], 0.1, 2, options={"max_iterations": 3})
    assert path.status is Ending.NOT_SOLVED
    assert "iteration limit" in path.message
    assert "another scheme, or other steps" in path.message


def test_friction_that_dilates_is_refused():
    """It lifts bodies off, so that each other step would be without friction."""
    refused("lift the body off", approaching=[side(la.Coulomb(0.3, associated=True))])


def test_contact_that_contradicts_itself_is_bad_input():
    wall = la.RigidObstacle((0, 0), (1, 0))
    held = la.Interface(("billet", "left"), wall, 0.2)
    refused("a support holds the normal velocity", approaching=[held])


@pytest.mark.parametrize("scheme", ["leapfrog", "explicit", "implicit-midpoint"])
@pytest.mark.parametrize("slope", [0.0, 1.0])
def test_dead_loads_that_collapse_are_named(scheme, slope):
    """Hardening within a step would catch the bodies after a jump of any size."""
    problem, _ = billet(law=la.hardening.Linear(1.0, slope))
    pull = la.Traction("billet", "right", (1.3, 0.0))  # of 2/sqrt(3) that the bar bears
    smooth = la.Interface(("billet", "top"), PLATEN, la.SMOOTH)
    problem = replace(problem, dead_loads=[pull], interfaces=[smooth])
    path = la.sequential(problem, 0.1, 4, scheme)
    assert path.status is Ending.NOT_SOLVED
    assert "unsafe" in path.message
    assert path.history.empty
    borne = replace(problem, dead_loads=[replace(pull, vector=(1.1, 0.0))])
    path = la.sequential(borne, 0.1, 1, "explicit")
    assert path.history.load_factor.iloc[0] == pytest.approx(2 / np.sqrt(3) - 1.1, rel=1e-6)


def test_a_body_may_be_far_from_the_origin():
    """Maps of curved edges are inverted to a fixed 1e-12."""
    near = pressed(2, travel=0.1)

    def far():
        problem, approaching = billet()
        body, move = problem.bodies["billet"], np.array([[1e3], [1e4]])
        body = replace(body, mesh=replace(body.mesh, doflocs=body.mesh.doflocs + move))
        platen = la.RigidObstacle((1e3, 1e4 + 1), (0, -1))
        moved = [replace(own, master=platen) for own in (*problem.interfaces, *approaching)]
        return replace(problem, bodies={"billet": body}, interfaces=moved[:1]), moved[1:]

    path = pressed(2, travel=0.1, billet=far)
    # Two solves to 1e-6 each.
    assert path.history.load_factor.to_numpy() == pytest.approx(
        near.history.load_factor.to_numpy(), rel=1e-5
    )


def test_what_solvers_cannot_tell_from_touching_rubs():
    """Steps leave gaps of their tolerance, which must not cost a step of friction."""
    loads = []
    for gap in (0.0, 3e-7):
        problem, _ = billet()
        platen = la.RigidObstacle((0, 1 + gap), (0, -1))
        top = la.Interface(("billet", "top"), platen, la.Tresca(0.3))
        path = la.sequential(replace(problem, interfaces=()), 0.05, 1, approaching=[top])
        assert path.history.friction.iloc[0] > 0.01
        loads.append(path.history.load_factor.iloc[0])
    assert loads[1] == pytest.approx(loads[0], rel=1e-5)


def test_steep_hardening_is_not_locked():
    """On the tangent at the beginning a step has more than 10000 times the load that begins it."""
    law = la.hardening.Swift(1.0, 1e-7, 0.5)
    problem, _ = billet(law=law)
    smooth = la.Interface(("billet", "top"), PLATEN, la.SMOOTH)
    path = la.sequential(replace(problem, interfaces=[smooth]), 0.2, 10)
    assert path.status is Ending.REACHED
    exact = [strip_force(law, 1 - s) for s in path.history.travel]
    # Second order in steps of 1/50 of the height.
    assert path.history.force.to_numpy() == pytest.approx(exact, rel=1e-3)
