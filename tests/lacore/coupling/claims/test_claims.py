"""LOCKED, UNSAFE and FREE rest on rays that our own code checks, by the scale of the load (T13)."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.coupling.claims import proving
from lacore.coupling.claims.dead_collapse import dead_collapse
from lacore.coupling.claims.locking_ray import locking_ray
from lacore.program.free_motion import without_dissipation
from lacore.program.kinematic import associated_contact, dimensionless, frictionless_contact
from lacore.reporting.kinds import Kind
from lacore.solvers.backend import InnerSolution
from lacore.solvers.inner.preparing import preparer, preparer_named
from tests.shares import one_in

R = la.masonry.rectangle


def on_incline(angle, friction, push=(0.0, -1.0), weight=0.0):
    """A unit block on a plane that rises to the right."""
    along = np.array([np.cos(angle), np.sin(angle)])
    out = np.array([-np.sin(angle), np.cos(angle)])
    corners = [0 * along, along, along + out, out]
    block = la.BlockAssembly({"block": [tuple(c.tolist()) for c in corners]}, 0.0)
    dead = [la.BodyForce("b", (0.0, -weight))] if weight else []
    return la.Problem(
        {"b": block},
        [la.PointForce("b", "block", push)],
        interfaces=[
            la.Interface(
                ("b", lambda x: np.abs(x[0] * out[0] + x[1] * out[1]) < 1e-9),
                la.RigidObstacle((0, 0), tuple(out.tolist())),
                friction,
            )
        ],
        dead_loads=dead,
    )


def frozen(problem, freeze=associated_contact):
    discretisation = la.discretise(problem)
    program = dimensionless(discretisation.program, discretisation.natural)
    return program, freeze(program.contact)


@pytest.mark.parametrize("angle", [1e-9, 1e-6, 1e-3])
def test_a_slight_incline_locks_nothing(angle):
    """Exact: limit/sin(angle); interior points call 1e9 infinite, and are not believed."""
    problem = on_incline(angle, la.Tresca(1.0))
    assert not locking_ray(*frozen(problem)).proves
    state = la.solve(problem)
    assert state.status is not la.Status.LOCKED
    exact = la.solve(problem, "highs")
    assert exact.status is la.Status.SOLVED
    assert exact.load_factor == pytest.approx(1 / np.sin(angle), rel=2e-6)


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.0])
def test_a_push_against_the_plane_is_locked(angle):
    """By the normal forces, at any inclination of the axes; their residual is round-off."""
    push = (float(np.sin(angle)), -float(np.cos(angle)))
    problem = on_incline(angle, la.Tresca(1.0), push)
    ray = locking_ray(*frozen(problem))
    assert ray.proves
    assert ray.residual <= 1e-12
    assert la.solve(problem).status is la.Status.LOCKED


def test_a_locked_body_is_locked_by_its_pressure():
    """An incompressible body in a box: mean stresses alone carry what presses on it."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 3, 3)
    problem = la.Problem(
        {"b": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        [la.Traction("b", "top", (0, -1.0))],
        [la.Fix("b", "left", "x"), la.Fix("b", "right", "x"), la.Fix("b", "bottom", "y")],
    )
    assert la.solve(problem).status is la.Status.LOCKED
    assert locking_ray(*frozen(problem)).proves


class Claiming:
    """A backend that answers every program with one word."""

    def __init__(self, status):
        self.status = status

    def solve(self, contact):
        return InnerSolution(self.status, "its word", 1, 0.0, None)

    def close(self):
        """Nothing is held."""


@pytest.mark.parametrize("status", [la.Status.LOCKED, la.Status.UNSAFE])
def test_the_word_of_a_solver_is_not_enough(status, monkeypatch):
    """A block that slides on a floor, called locked or unsafe by a solver that lies."""
    problem = on_incline(0.0, 0.3, (1.0, 0.0), weight=1.0)
    program, contact = frozen(problem)
    backend = la.find_backend("highs")
    monkeypatch.setattr(type(backend), "prepare", lambda *_: Claiming(status))
    state = la.solve(problem, "highs")
    assert state.status is la.Status.NOT_CERTIFIED
    assert "the solver calls" in state.message
    assert not locking_ray(program, frictionless_contact(program.contact)).proves
    prepare = preparer(backend, backend.Options())
    assert dead_collapse(program, contact, prepare, 1e-6) is None


@pytest.mark.parametrize("backend", ["clarabel", "highs"])
@pytest.mark.parametrize("light", [1.0, 1e-5, 1e-10])
def test_a_light_block_that_falls_makes_a_structure_unsafe(light, backend):
    """Beside one of any weight; the mechanism that proves it is the light block's."""
    blocks = la.BlockAssembly(
        {"floor": R(-2, 1, -1, 0), "heavy": R(-1, 0, 0, 1), "light": R(0.75, 2.25, 0, 1)}, 0.5
    )
    problem = la.Problem(
        {"b": blocks},
        [la.PointForce("b", "heavy", (1.0, 0.0))],
        [la.Fix("b", "floor")],
        dead_loads=[
            la.PointForce("b", "heavy", (0.0, -1.0)),
            la.PointForce("b", "light", (0.0, -light)),
        ],
    )
    state = la.solve(problem, backend)
    assert state.status is la.Status.UNSAFE
    program, contact = frozen(problem)
    engine = la.find_backend(backend)
    prepare = preparer(engine, engine.Options())
    fall = dead_collapse(program, contact, prepare, 1e-6)
    assert fall.dissipated_share < 1e-6  # nothing resists turning about the edge
    assert program.dead_load @ fall.point.velocity == pytest.approx(1.0)
    velocity = fall.point.velocity
    assert abs(program.reference_load @ velocity) <= 1e-6 * np.abs(velocity).max()


def green(share, cells=3):
    """A weightless rigid block on soil under a load inclined by 20 degrees."""
    angle = np.radians(20.0)
    mesh = la.meshes.rectangle((-4, 6), (-3, 0), 5 * cells, 2 * cells)
    return la.Problem(
        {
            "soil": la.Body(mesh, la.VonMises(shear_strength=1.0)),
            "b": la.BlockAssembly({"punch": R(-1, 1, 0, 0.5)}, 0.0),
        },
        [la.PointForce("b", "punch", (float(np.sin(angle)), -float(np.cos(angle))))],
        [la.Fix("soil", "bottom"), la.Fix("soil", "left", "x"), la.Fix("soil", "right", "x")],
        [
            la.Interface(
                ("b", lambda x: np.abs(x[1]) < 1e-9), ("soil", "top"), share * np.tan(angle)
            )
        ],
    )


@pytest.mark.parametrize("share", one_in(3, [1.0001, 1.01, 1.2]))
def test_weightless_contact_is_not_settled_at_without_load(share):
    """Green (1954): the soil fails, at a load that other loops certify too."""
    problem = green(share)
    state = la.solve(problem)
    assert state.status is la.Status.SOLVED
    other = la.solve(problem, coupling="shift")
    assert other.status is la.Status.SOLVED
    # Coulomb loads are not unique (T14b); both lie below the associated one, and near it.
    associated = la.solve(problem, coupling="associated").load_factor
    for one in (state, other):
        assert 0.9 * associated <= one.load_factor <= associated * (1 + 1e-6)


def test_outside_of_the_friction_cone_it_is_free():
    state = la.solve(green(0.99))
    assert state.status is la.Status.FREE
    assert "outside of the friction cones" in state.message


def test_a_mode_that_no_load_drives_frees_nothing():
    """A block crushed on a smooth floor may slide at any speed; beside it strain looks small."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 4, 4)
    problem = la.Problem(
        {"b": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        [la.Traction("b", "top", (0, -1.0))],
        interfaces=[la.Interface(("b", "bottom"), la.RigidObstacle((0, 0), (0, 1)), la.SMOOTH)],
    )
    program, contact = frozen(problem)
    backend = la.find_backend("clarabel")
    prepare = preparer(backend, backend.Options())
    point = prepare(program).solve(contact).point
    discretisation = la.discretise(problem)
    sliding = np.zeros(discretisation.full.n)
    sliding[discretisation.continua["b"].dofs[0]] = 1e8
    mode = np.linalg.lstsq(discretisation.free_basis.toarray(), sliding, rcond=None)[0]
    moved = replace(point, velocity=point.velocity + mode)
    assert abs(program.reference_load @ mode) <= 1e-6  # round-off of 1e8
    assert not without_dissipation(program, moved, contact, 1e-6)


def test_each_claim_that_is_not_proven_says_what_is_known_instead(monkeypatch):
    """A block that slides on a floor: a mechanism refutes LOCKED, and nothing proves UNSAFE."""
    program, contact = frozen(on_incline(0.0, 0.3, (1.0, 0.0), weight=1.0))
    free = frictionless_contact(program.contact)
    prepare = preparer_named("clarabel", {})

    def claim(status):
        found, why, proof = proving.prove_claim(status, program, free, contact, prepare, 1e-6)
        assert proof is None
        return found, None if why is None else why.kind

    assert claim(la.Status.SOLVED) == (la.Status.SOLVED, None)
    assert claim(la.Status.JAM) == (la.Status.JAM, None)
    assert claim(la.Status.UNSAFE) == (la.Status.NOT_CERTIFIED, Kind.UNSAFE_NOT_PROVEN)
    assert claim(la.Status.LOCKED) == (la.Status.NOT_CERTIFIED, Kind.LOCKED_REFUTED)
    # Neither reactions nor a mechanism are found.
    monkeypatch.setattr(proving, "_mechanism", lambda *given: None)
    assert claim(la.Status.LOCKED) == (la.Status.NOT_CERTIFIED, Kind.LOCKED_NOT_PROVEN)
