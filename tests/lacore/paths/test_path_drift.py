"""Paths whose velocity is one of many (T32): rings in plane strain, bars without hardening."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.paths import drift
from lacore.paths.ending import Ending
from lacore.paths.path import Event
from lacore.paths.selection import least_norm
from lacore_verification.cases.shared.exact_paths import cylinder, pressure
from tests.lacore.paths.path_billets import billet, pressed

LAWS = {
    "perfect": la.hardening.Perfect(1.0),
    "linear": la.hardening.Linear(1.0, 3.0),
    "voce": la.hardening.Voce(1.0, 3.0, 2 * np.sqrt(3)),
}
CELLS = 4  # across the wall
VELOCITY = ("velocity not unique", "velocity selected", "velocity not selected")


def ring(law, uneven=0.0):
    """A quarter in plane strain under a pressure in its bore; inner nodes may stand unevenly."""
    flat = la.meshes.quadrilaterals((1.0, 2.0), (0.0, 1.0), CELLS, 6)
    inside = (flat.p > flat.p.min(axis=1)[:, None]) & (flat.p < flat.p.max(axis=1)[:, None])
    moved = np.random.default_rng(0).uniform(-uneven, uneven, flat.p.shape)
    moved *= np.array([[1 / CELLS], [1 / 6]]) * inside.all(axis=0)
    flat = replace(flat, doflocs=flat.p + moved)
    mesh = la.meshes.isoparametric(
        flat, lambda x: x[0] * np.array([np.cos(np.pi / 2 * x[1]), np.sin(np.pi / 2 * x[1])])
    )
    body = la.Body(mesh, la.VonMises(hardening=law), space="q2")
    return la.Problem(
        bodies={"ring": body},
        supports=[la.Fix("ring", "bottom", "y"), la.Fix("ring", "top", "x")],
        reference_loads=[la.Pressure("ring", "left")],
    )


def expanded(law, steps, travel=0.5, uneven=0.0, **more):
    """The path of a ring whose bore grows."""
    control = la.PointTravel("ring", (1.0, 0.0), (1.0, 0.0))
    return la.sequential(ring(law, uneven), travel, steps, control=control, **more)


def errors(path, law):
    """Of the loads, relative."""
    exact = [pressure(cylinder(law, 1.0, 2.0), 1 + at) for at in path.history.travel]
    return np.abs(path.history.load_factor.to_numpy() / np.array(exact) - 1)


def allowed(steps):
    """Of the case `hardening-cylinder`, whose slice has one mechanism: steps, then elements."""
    return 1.3 * 0.026 / steps**2 + 3e-3 * CELLS**-4


def kinds(path):
    """Of the events about velocities, in their order."""
    return [kind for kind in path.events["kind"] if kind in VELOCITY]


def stretched(strength=1.0, size=1.0):
    """The limit state of a bar without hardening: it may draw out anywhere."""
    mesh = la.meshes.rectangle((0, 2 * size), (0, 0.5 * size), 6, 2, crossed=False)
    body = la.Body(mesh, la.VonMises(strength / np.sqrt(3)), space="p2-gauss")
    return la.solve(
        la.Problem(
            bodies={"bar": body},
            reference_loads=[la.RigidFooting("bar", "right", (1, 0), rough=False)],
            supports=[la.Fix("bar", "left", "x"), la.Fix("bar", "bottom", "y")],
        )
    )


@pytest.fixture(scope="module")
def drifting():
    """Half of the way of a ring without hardening, in steps of a tenth of all of it."""
    return expanded(LAWS["perfect"], 5, travel=0.25)


def test_a_ring_that_drifts_is_kept_round_from_there_on(drifting):
    judge_kept(drifting, LAWS["perfect"])
    assert drifting.status is Ending.REACHED


@pytest.mark.slow
@pytest.mark.parametrize(("law", "steps"), [("linear", 10), ("linear", 40), ("voce", 40)])
def test_no_ring_that_is_wrong_is_reached(law, steps):
    judge_kept(expanded(LAWS[law], steps), LAWS[law])


def judge_kept(path, law):
    """An event with the size of the drift; loads are right, or the path has not reached its end."""
    assert kinds(path) == ["velocity not unique"]
    (event,) = path.events[path.events.kind == "velocity not unique"].itertuples()
    wrong = errors(path, law)
    assert wrong[: event.step - 1].max() < 2e-3
    assert path.status is not Ending.REACHED or wrong.max() < 2e-3
    assert "of their norm" in event.what
    assert f"at step {event.step} the velocity became one of many" in path.message
    assert "LeastNorm" in path.message


def test_a_drift_that_is_seen_late_is_no_reached_path(monkeypatch):
    """Nobody looks before the fourth step: by then the ring has lost its shape."""
    monkeypatch.setattr(drift, "due", lambda rows, error, distance: len(rows) >= 3)
    path = expanded(LAWS["perfect"], 5, travel=0.1)
    assert "velocity not unique before" in set(path.events.kind)
    assert path.status is Ending.DRIFTED
    assert "may have drifted" in path.message


def test_the_least_norm_keeps_a_ring_round():
    law = LAWS["perfect"]
    path = expanded(law, 5, travel=0.25, selection=la.LeastNorm())
    assert path.status is Ending.REACHED
    assert errors(path, law).max() < allowed(10)
    assert kinds(path) == []
    nodes = path.snapshots[-1].configuration.nodes["ring"]
    bore = np.isclose(np.hypot(*path.stage.start.nodes["ring"]), 1.0)
    # Velocities are known to the root of the tolerance of a solver, 1e-10.
    assert np.ptp(np.hypot(*nodes[:, bore])) < 2e-5


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("steps", [10, 40])
def test_no_number_of_steps_lets_it_drift(law, steps):
    path = expanded(LAWS[law], steps, selection=la.LeastNorm())
    assert path.status is Ending.REACHED
    assert errors(path, LAWS[law]).max() < allowed(steps)


@pytest.mark.slow
def test_the_least_norm_keeps_a_ring_of_uneven_elements_round():
    """They prefer some directions, by what their load errs; that the norm outweighs."""
    law = LAWS["perfect"]
    drifting = expanded(law, 5, travel=0.25, uneven=0.15)
    assert kinds(drifting)
    assert drifting.status is not Ending.REACHED or errors(drifting, law).max() < 3e-3
    path = expanded(law, 5, travel=0.25, uneven=0.15, selection=la.LeastNorm())
    assert errors(path, law).max() < 3e-3


@pytest.mark.slow
def test_paths_that_are_regular_have_no_such_event():
    assert kinds(pressed(4)) == []
    assert kinds(expanded(LAWS["linear"], 5)) == []


@pytest.mark.slow
def test_looking_takes_few_solves(monkeypatch):
    looked = []

    def counting(*args, **more):
        looked.append(1)
        return least_norm(*args, **more)

    monkeypatch.setattr(drift, "least_norm", counting)
    path = pressed(8, travel=0.2)
    assert 1 <= len(looked) <= 2
    assert path.history.solves.min() > 1  # each step has several of its own


@pytest.mark.parametrize(("strength", "size"), [(1.0, 1.0), (250e6, 1e-3)])
def test_the_least_norm_of_a_bar_is_uniform(strength, size):
    """Closed form: of all ``u_x(x)`` of one speed at the end the linear one, whatever the units."""
    state = stretched(strength, size)
    found = least_norm(state, 1e-4)
    d = state.discretisation
    nodes = d.continua["bar"].nodes
    velocity = found.velocity[d.continua["bar"].dofs]
    # Of the norm a share of the power: what is not linear costs its square.
    np.testing.assert_allclose(velocity[0], nodes[0] / (2 * size) * velocity[0].max(), rtol=1e-4,
                               atol=1e-4 * velocity[0].max())  # fmt: skip
    assert found.excess < 1e-6
    power = d.full.plastic_dissipation(found.velocity) - d.full.dead_load @ found.velocity
    assert power == pytest.approx(state.load_factor, rel=1e-6)


@pytest.mark.parametrize("within", [1e-6, 1e-4, 1e-2])
def test_the_load_of_a_selected_velocity_is_that_of_the_state(within):
    """Recomputed: no power above the one allowed, at a velocity that is admissible."""
    problem, _ = billet(law=LAWS["perfect"])
    state = la.solve(problem)
    found = least_norm(state, within)
    full, u = state.discretisation.full, found.velocity
    contact, reaction = full.contact, state.point.normal_reaction
    assert full.reference_load @ u == pytest.approx(1.0, rel=1e-8)
    assert contact.opening(u).min() > -1e-6 * np.abs(u).max()
    friction = contact.weights * contact.coefficient * reaction @ np.abs(contact.slip(u)[:, 0])
    power = full.plastic_dissipation(u) + friction
    assert power / state.load_factor - 1 <= within + 1e-7
    assert power / state.load_factor - 1 == pytest.approx(found.excess, abs=1e-7)
    assert found.width > 0
    (group,) = full.groups
    norms = [group.weights @ np.sum(group.cone_vectors(v) ** 2, axis=1) for v in
             (u, state.point.velocity)]  # fmt: skip
    assert norms[0] < norms[1]


def test_the_excess_counts_hardening_within_the_step():
    """Of half of the square of each strain rate (T29)."""
    state = pressed(1).last
    found = least_norm(state, 1e-2)
    full, contact = state.discretisation.full, state.discretisation.full.contact
    bound = contact.coefficient * state.point.normal_reaction
    costs = []
    for u in (found.velocity, state.point.velocity):
        (group,) = full.groups
        rates = np.linalg.norm(group.cone_vectors(u), axis=1)
        each = group.bound * rates + group.modulus * rates**2 / 2
        slip = np.abs(contact.slip(u)[:, 0])
        costs.append(group.weights @ each + contact.weights * bound @ slip)
    # Differences of costs that agree to 1e-10 between two sets of units.
    assert found.excess == pytest.approx(costs[0] / costs[1] - 1, rel=1e-5)
    assert found.excess > 1e-3


def test_forces_and_pictures_are_of_the_velocity_that_moves_the_bodies():
    law = LAWS["linear"]
    path = expanded(law, 2, travel=0.1, uneven=0.15, selection=la.LeastNorm())
    (at,) = np.flatnonzero(np.all(np.isclose(path.stage.start.nodes["ring"].T, [1.0, 0.0]), axis=1))
    moved, solved = (
        own["ring"][0, at] for own in (path.snapshots[-1].velocity, path.last.velocity)
    )
    row = path.history.iloc[-1]
    assert row.load_factor / row.force == pytest.approx(moved, rel=1e-12)
    assert abs(moved / solved - 1) > 1e-6


def test_a_selected_path_goes_on_from_its_file(tmp_path):
    law, more = LAWS["linear"], {"travel": 0.1, "selection": la.LeastNorm()}
    whole = expanded(law, 3, **more)

    class StoppedError(Exception):
        pass

    def stop(row):
        if row.step == 2:
            raise StoppedError

    with pytest.raises(StoppedError):
        expanded(law, 3, checkpoint=tmp_path / "p", on_step=stop, **more)
    with pytest.raises(la.InputError, match="of another path: other selection"):
        expanded(law, 3, travel=0.1, checkpoint=tmp_path / "p")
    resumed = expanded(law, 3, checkpoint=tmp_path / "p", **more)
    for name in ("travel", "load_factor", "force", "solves"):
        assert list(resumed.history[name]) == list(whole.history[name])


def test_a_drifting_path_goes_on_from_its_file_with_its_warning(tmp_path):
    law, more = LAWS["perfect"], {"travel": 0.15, "checkpoint": tmp_path / "p"}
    whole, resumed = expanded(law, 3, **more), expanded(law, 3, **more)
    assert kinds(whole) == kinds(resumed) == ["velocity not unique"]
    assert resumed.message == whole.message


def test_pictures_show_where_it_begins_to_drift(drifting):
    legend = drifting.plot().axes[1].get_legend()
    assert "velocity not unique" in [text.get_text() for text in legend.get_texts()]


@pytest.mark.parametrize(
    ("said", "selection", "backend"),
    [
        ("selection = 3: no LeastNorm", 3, "clarabel"),
        (
            r"selection = 'LeastNorm': the class itself; give LeastNorm\(\.\.\.\)",
            la.LeastNorm,
            "clarabel",
        ),
        ("selects velocities already", la.LeastNorm(), "clarabel-regularised"),
    ],
)
def test_bad_selections_are_refused(said, selection, backend):
    with pytest.raises(la.InputError, match=said):
        expanded(LAWS["linear"], 2, selection=selection, backend=backend)


@pytest.mark.parametrize("within", [0.0, -1e-4, float("nan"), 0.5, "1e-4"])
def test_bad_shares_are_refused(within):
    with pytest.raises(la.InputError, match=r"LeastNorm\.within"):
        la.LeastNorm(within)


def test_velocities_are_selected_from_the_event_on_that_reports_a_drift():
    """By the default, unless a selection is given; other events change nothing."""
    begins = Event(drift.DRIFTS, 3, 0.1, "")
    other = Event("contact closed", 2, 0.05, "")
    assert drift.selection_after([other, begins], None) == la.LeastNorm()
    assert drift.selection_after([other], None) is None
    given = la.LeastNorm(within=1e-3)
    assert drift.selection_after([other, begins], given) is given
    assert drift.selection_after([other], given) is given


@pytest.mark.parametrize(
    ("kinds", "ending"),
    [
        ((), Ending.REACHED),
        (("contact closed",), Ending.REACHED),
        ((drift.DRIFTS,), Ending.REACHED),  # a regular velocity was selected from there on
        ((drift.LOST,), Ending.REACHED),
        ((drift.DRIFTS, drift.LOST), Ending.DRIFTED),
        ((drift.DRIFTS, drift.LATE), Ending.DRIFTED),
    ],
)
def test_a_path_that_has_drifted_without_a_selection_is_not_reached(kinds, ending):
    assert drift.ending([Event(kind, 1, 0.1, "") for kind in kinds]) is ending
