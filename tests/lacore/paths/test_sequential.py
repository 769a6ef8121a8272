"""Paths of large deformation against what must come out of them."""

import re
from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.paths import flow as flow_module
from lacore.paths.ending import Ending
from lacore_verification.cases.shared.exact_paths import strip_force
from tests.shares import one_in

LAWS = {
    "perfect": la.hardening.Perfect(1.0),
    "linear": la.hardening.Linear(1.0, 3.0),
    "voce": la.hardening.Voce(1.0, 3.0, 2 * np.sqrt(3)),
}
MESHES = {
    "triangles": la.meshes.rectangle((0, 1), (0, 1), 2, 2, crossed=False),
    "crossed": la.meshes.rectangle((0, 1), (0, 1), 2, 2),
    "quadrilaterals": la.meshes.quadrilaterals((0, 1), (0, 1), 2, 2),
}
BEHIND = la.RigidObstacle((0, 2), (0, 1))
PLATEN = la.RigidObstacle((0.0, 1.0), (0.0, -1.0))


def block(mesh, law, friction=0.0, **more):
    """A block of which the lower half of a symmetric billet is cut off, pushed up to a platen."""
    space = "q2" if len(mesh.t) == 4 else "p2-gauss"
    body = la.Body(mesh, la.VonMises(hardening=law), space=space)
    return la.Problem(
        bodies={"block": body},
        reference_loads=[la.RigidFooting("block", "bottom", (0, 1), rough=False)],
        supports=[la.Fix("block", "left", "x")],
        interfaces=[la.Interface(("block", "top"), PLATEN, friction)],
        **more,
    )


def bar(law, steps, scheme="leapfrog", n=4, travel=1.0):
    """A quarter of a bar in tension, pulled at its end; returns its path."""
    mesh = la.meshes.rectangle((0, 2), (0, 0.5), 2 * n, n // 2, crossed=False)
    body = la.Body(mesh, la.VonMises(hardening=law), space="p2-gauss")
    problem = la.Problem(
        bodies={"bar": body},
        reference_loads=[la.RigidFooting("bar", "right", (1, 0), rough=False)],
        supports=[la.Fix("bar", "left", "x"), la.Fix("bar", "bottom", "y")],
    )
    return la.sequential(problem, travel, steps, scheme)


@pytest.mark.parametrize(
    ("law", "mesh"),
    [
        *zip(LAWS, MESHES, strict=True),
        *(
            pytest.param(law, mesh, marks=pytest.mark.slow)
            for one, law in enumerate(LAWS)
            for other, mesh in enumerate(MESHES)
            if one != other
        ),
    ],
)
def test_two_midpoint_steps_are_exact_for_homogeneous_flow(law, mesh):
    path = la.sequential(block(MESHES[mesh], LAWS[law]), 0.5, 2, "implicit-midpoint")
    assert path.status is Ending.REACHED
    exact = [strip_force(LAWS[law], 1 - s) for s in path.history.travel]
    assert path.history.force.to_numpy() == pytest.approx(exact, rel=1e-8)
    # Velocities are known to the root of the solver's 1e-10 only; the load does not feel it.
    assert path.history.max_strain.iloc[-1] == pytest.approx(2 / np.sqrt(3) * np.log(2), rel=1e-4)


@pytest.mark.parametrize("mesh", one_in(3, MESHES))
def test_midpoint_steps_keep_the_area(mesh):
    """Friction makes the flow inhomogeneous; theta vanishes at all points of triangles (T30)."""
    path = la.sequential(block(MESHES[mesh], LAWS["linear"], 0.2), 0.1, 2, "implicit-midpoint")
    # Quadrilaterals and crossings bound theta in the mean only, where steps are not linear.
    bar = 1e-10 if mesh == "triangles" else 1e-4
    assert path.history.volume.to_numpy() == pytest.approx(1.0, abs=bar)


@pytest.mark.slow
def test_orders_of_the_schemes_on_a_block():
    orders = {"explicit": 1, "implicit-euler": 1, "leapfrog": 2}
    for scheme, expected in orders.items():
        errors = []
        for steps in (8, 16):
            path = la.sequential(
                block(MESHES["triangles"], LAWS["linear"]), 0.2, steps, scheme, tolerance=1e-6
            )
            exact = np.array([strip_force(LAWS["linear"], 1 - s) for s in path.history.travel])
            errors.append(np.abs(path.history.force / exact - 1).max())
        slopes = np.log2(np.array(errors[:-1]) / errors[1:])
        assert slopes[0] == pytest.approx(expected, abs=0.15)


def test_hardening_keeps_a_bar_uniform():
    path = bar(LAWS["linear"], 20)
    strain = path.snapshots[-1].configuration.strain["bar"]
    assert np.ptp(strain) / strain.mean() < 1e-4
    exact = [0.5 * strip_force(LAWS["linear"], 1 + s / 2) for s in path.history.travel]
    # Second order in steps of 1/40 of the length.
    assert path.history.force.to_numpy() == pytest.approx(exact, rel=1e-3)


@pytest.mark.slow
def test_a_bar_that_necks_says_where_its_force_was_largest():
    """Considere in plane strain: the force peaks where the stress is its slope over the length."""
    law = la.hardening.Linear(1.0, 1.3)
    path = bar(law, 30, travel=1.5)
    (peak,) = path.events[path.events.kind == "peak force"].itertuples()
    lengths = np.linspace(1.0, 1.75, 1_001)
    exact = lengths[np.argmax([strip_force(law, own) for own in lengths.tolist()])]
    assert peak.travel == pytest.approx(2 * (exact - 1), abs=0.01)  # a fifth of a step
    assert not (path.events.kind == "peak load").any()  # a pressure on a face that shrinks


def test_a_constant_load_has_no_peak():
    path = la.sequential(block(MESHES["triangles"], LAWS["perfect"]), 0.1, 6)
    assert path.events.empty


def test_without_the_quadratic_term_a_bar_does_not_stay_uniform():
    path = bar(LAWS["linear"], 20, "explicit")
    strain = path.snapshots[-1].configuration.strain["bar"]
    assert np.ptp(strain) / strain.mean() > 1e-2


def test_the_choice_between_mechanisms_is_not_in_the_load(monkeypatch):
    loads = []
    for choice in (1e-2, 1e-4):
        monkeypatch.setattr(flow_module, "_CHOICE", choice)
        path = la.sequential(block(MESHES["triangles"], LAWS["perfect"]), 0.1, 4)
        loads.append(path.history.load_factor.to_numpy())
    assert loads[0] == pytest.approx(loads[1], rel=1e-7)


def test_a_path_does_not_depend_on_units():
    law = la.hardening.Linear(1.0, 1.0)
    mesh = MESHES["triangles"]
    one = la.sequential(block(mesh, law, 0.2), 0.2, 4)
    milli = replace(mesh, doflocs=mesh.doflocs * 1e-3)
    metal = la.Body(milli, la.VonMises(hardening=la.hardening.Linear(250e6, 250e6)))
    platen = la.Interface(("block", "top"), la.RigidObstacle((0, 1e-3), (0, -1)), 0.2)
    problem = replace(block(mesh, law, 0.2), bodies={"block": metal}, interfaces=[platen])
    other = la.sequential(problem, 0.2e-3, 4)
    # Two inner solves to 1e-6 each; steps carry their errors on.
    assert other.history.load_factor.to_numpy() / 250e6 == pytest.approx(
        one.history.load_factor.to_numpy(), rel=1e-5
    )


def test_powers_add_up_to_the_load():
    path = la.sequential(block(MESHES["triangles"], LAWS["linear"], 0.2), 0.2, 4)
    h = path.history
    assert (h.friction > 0).all()
    assert (h.plastic > 0).all()
    powers = h.plastic + h.friction - h.dead
    assert powers.to_numpy() == pytest.approx(h.load_factor.to_numpy(), rel=1e-12)
    state = path.last
    assert state is not None
    assert state.certificate.holds(1e-6)


def test_progress_is_a_line_a_step(capsys):
    path = la.sequential(block(MESHES["triangles"], LAWS["linear"]), 0.1, 2, on_step=print)
    first, second = capsys.readouterr().out.splitlines()
    assert first.startswith("step 1: load factor ")
    assert f"load factor {path.history.load_factor.iloc[1]:.6g} at travel 0.075" in second


@pytest.mark.slow
def test_a_side_folds_onto_the_platen():
    mesh = la.meshes.rectangle((0, 1), (0, 1), 8, 8, crossed=False)
    problem = block(mesh, la.hardening.Linear(1.0, 1.0), 0.2)
    side = la.Interface(("block", "right"), PLATEN, 0.2)
    path = la.sequential(problem, 0.5, 30, approaching=[side])
    assert path.status is Ending.REACHED, path.message
    closed = path.events[path.events.what.str.startswith("block.right")]
    assert "contact closed" in set(closed.kind)
    for snapshot in path.snapshots:  # nothing passes the platen: certificates to 1e-6 a step
        assert snapshot.configuration.nodes["block"][1].max() < 1 + 1e-5


def test_a_gap_closes_before_the_load_comes():
    """A block is pushed against a spring of another law: it is free until it meets the wall."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2, crossed=False)
    body = la.Body(mesh, la.VonMises(yield_stress=1.0), space="p2-gauss")
    wall = la.RigidObstacle((1.1, 0.0), (-1.0, 0.0))
    problem = la.Problem(
        bodies={"block": body},
        reference_loads=[la.RigidFooting("block", "top", (0, -1), rough=False)],
        supports=[la.Fix("block", "left", "x"), la.Fix("block", "bottom", "y")],
    )
    side = la.Interface(("block", "right"), wall, 0.0)
    path = la.sequential(problem, 0.2, 10, approaching=[side])
    # Incompressible between the walls: it fills the gap and then cannot move any more.
    assert path.status is Ending.LOCKED
    assert path.history.end.iloc[-1] == pytest.approx(0.1, abs=0.02 + 1e-9)
    assert path.snapshots[-1].configuration.nodes["block"][0].max() < 1.1 + 1e-6


def test_adaptive_steps_keep_their_error():
    mesh = la.meshes.rectangle((0, 1), (0, 1), 3, 3, crossed=False)
    problem = block(mesh, la.hardening.Linear(1.0, 1.0), 0.2)
    path = la.sequential(problem, 0.2, la.AdaptiveSteps(tolerance=2e-4, first=0.2))
    assert path.status is Ending.REACHED
    assert path.history.error.max() <= 2e-4
    assert path.history.end.iloc[-1] == pytest.approx(0.2)
    path = la.sequential(problem, 0.2, la.AdaptiveSteps(tolerance=1e-9, first=0.2, smallest=0.1))
    assert path.status is Ending.STEP_TOO_SMALL
    assert len(path.snapshots) >= 1


def test_no_result_beyond_an_inverted_element():
    mesh = la.meshes.quadrilaterals((0, 1), (0, 1), 4, 4)
    problem = block(mesh, la.hardening.Linear(1.0, 1.0), la.STICK)
    side = la.Interface(("block", "right"), PLATEN, la.STICK)
    path = la.sequential(problem, 0.6, 12, approaching=[side])
    assert path.status is Ending.INVERSION
    assert path.events.kind.iloc[-1] == "inversion predicted"
    assert (path.history.min_jacobian > 0).all()
    assert path.history.end.iloc[-1] == path.snapshots[-1].travel
    path.problem()  # still a mesh


def test_the_message_states_how_long_elements_stay_upright():
    """A step of the rigid-plastic block inverts its elements when the footing reaches its base."""

    def followed(travel):
        problem = block(MESHES["triangles"], LAWS["perfect"])
        return la.sequential(problem, travel, 1, "explicit")

    path = followed(2.0)
    assert path.status is Ending.INVERSION
    share = int(re.search(r", after (\d+) % of the step: the next step", path.message)[1]) / 100
    assert followed(2.0 * (share - 0.011)).status is Ending.REACHED
    assert followed(2.0 * (share + 0.011)).status is Ending.INVERSION


def test_steps_longer_than_the_body_are_stopped():
    path = la.sequential(block(MESHES["triangles"], LAWS["linear"]), 3.0, 2)
    assert path.status in (Ending.INVERSION, Ending.OVERLAP)
    assert len(path.history) == 0
    assert len(path.snapshots) == 1


def test_a_control_that_stands_still():
    still = la.PointTravel("block", (0.0, 0.0), (-1.0, 0.0))
    path = la.sequential(block(MESHES["triangles"], LAWS["linear"]), 0.1, 2, control=still)
    assert path.status is Ending.STANDSTILL


def test_controls_measure_the_same_path():
    mesh, law = MESHES["triangles"], LAWS["linear"]
    footing = la.sequential(block(mesh, law), 0.2, 4)
    corner = la.PointTravel("block", (0.0, 0.0), (0.0, 2.0))
    point = la.sequential(block(mesh, law), 0.2, 4, control=corner)
    assert point.history.load_factor.to_numpy() == pytest.approx(
        footing.history.load_factor.to_numpy(), rel=1e-6
    )
    # The footing is 1 m wide: at F0.u = 1 it moves at 1 m/s in the beginning, slower later.
    timed = la.sequential(block(mesh, law), 0.2, 4, control=la.Time())
    assert timed.snapshots[-1].configuration.nodes["block"][1].min() < 0.2


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"travel": 0.0}, "travel"),
        ({"travel": np.nan}, "travel"),
        ({"steps": 0}, "steps"),
        ({"scheme": "euler"}, "scheme"),
        ({"control": la.PointTravel("bloc", (0, 0), (0, 1))}, "PointTravel.body"),
        ({"control": la.PointTravel("block", (0.1, 0), (0, 1))}, "PointTravel.at"),
        ({"control": la.PointTravel("block", (0, 0), (0, 0))}, "PointTravel.direction"),
        ({"approaching": [la.Interface(("bloc", "right"), PLATEN, 0.1)]}, "Interface.slave"),
        ({"approaching": [la.Interface(("block", "right"), ("tool", "x"), 0.1)]}, "Interface.m"),
        (
            {
                "approaching": [
                    la.Interface(("block", "right"), la.RigidObstacle((0, 2), (0, 1)), 0)
                ]
            },
            "Interface.slave",
        ),
    ],
)
def test_bad_input_gets_a_sentence(change, field):
    problem = block(MESHES["triangles"], LAWS["linear"])
    arguments = {"travel": 0.1, "steps": 2} | change
    with pytest.raises(la.InputError, match=field):
        la.sequential(problem, **arguments)


def test_bodies_that_a_path_does_not_follow():
    mesh = MESHES["triangles"]
    thin = la.Body(mesh, la.VonMises(yield_stress=1.0), kinematics="plane_stress")
    loads = [la.Traction("sheet", "right", (1.0, 0.0))]
    problem = la.Problem({"sheet": thin}, loads, supports=[la.Fix("sheet", "left")])
    control = la.PointTravel("sheet", (1, 0), (1, 0))
    with pytest.raises(la.InputError, match="thickness"):
        la.sequential(problem, 0.1, control=control)
    with pytest.raises(la.InputError, match="control"):
        la.sequential(
            replace(problem, bodies={"sheet": replace(thin, kinematics="plane_strain")}), 1
        )


def test_a_backend_without_hardening_says_so():
    problem = block(MESHES["triangles"], LAWS["linear"])
    with pytest.raises(la.CapabilityError, match="hardening"):
        la.sequential(problem, 0.1, 2, backend="ipopt-static")


def hardening_path():
    return la.sequential(block(MESHES["triangles"], LAWS["linear"]), 0.02, 2)


def closing_path():
    problem = block(MESHES["triangles"], LAWS["perfect"])
    wall = la.RigidObstacle((1.1, 0.0), (-1.0, 0.0))
    return la.sequential(
        problem, 0.02, 2, approaching=[la.Interface(("block", "right"), wall, 0.0)]
    )


@pytest.mark.parametrize("stated", [hardening_path, closing_path])
def test_a_state_within_a_step_has_no_bounds(stated):
    """Its load goes with the speed that the step gives it: no limit load is bounded by that."""
    path, below = stated(), la.lower_bound(block(MESHES["triangles"], LAWS["perfect"]))
    closes = path.last.discretisation.program.contact.closing is not None
    assert closes == (stated is closing_path)
    for state in (path.last, path.state(1)):
        assert not state.discretisation.program.homogeneous
        for one in (state, state.discretisation):
            with pytest.raises(la.InputError, match="problem: a state within a step of a path"):
                la.upper_bound(one)
        with pytest.raises(la.InputError, match="upper: a state within a step of a path"):
            la.gap_identity(state, below)
        with pytest.raises(la.InputError, match="interval: a state within a step of a path"):
            _ = state.interval()
