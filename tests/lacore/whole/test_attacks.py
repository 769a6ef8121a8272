"""What an attacker found: wrong numbers under a good name, and what becomes of them now."""

import pickle

import numpy as np
import pytest

import lacore as la
from tests.lacore.models import deformable_block, obstacle, square

BLOCK = la.Body(la.meshes.rectangle((0, 2), (0, 1), 4, 2), la.VonMises(shear_strength=1.0))


def squeezed(p):
    """Sheared on a fixed base under a pressure that cannot matter: it is self-equilibrated."""
    return la.Problem(
        bodies={"block": BLOCK},
        supports=[la.Fix("block", "bottom")],
        reference_loads=[la.Traction("block", "top", (1, 0))],
        dead_loads=[la.Pressure("block", side, p) for side in ("top", "left", "right")],
    )


@pytest.mark.parametrize(
    ("backend", "p"),
    [
        *(("ipopt", 1e3), ("ipopt", 1e6), ("newton", 1e3), ("newton", 1e6)),
        *(pytest.param("slsqp", p, marks=pytest.mark.slow) for p in (1e3, 1e6)),  # of many steps
    ],
)
def test_penalties_filled_by_a_dead_load_are_not_certified(backend, p):
    """The pressure compresses what should be incompressible, and the load factor goes with it."""
    state = la.solve(squeezed(p), backend, options={"r": 0.03})
    assert state.status is not la.Status.SOLVED
    assert np.isnan(state.load_factor)


def test_the_exact_value_does_not_see_the_pressure():
    """To the certificate's bar, per the power of a dead load p times larger than the other."""
    free, loaded = (la.solve(squeezed(p), throw=True).load_factor for p in (1.0, 1e2))
    assert loaded == pytest.approx(free, rel=1e-4)


def cornered(law, side=0.5):
    """In a corner: `law` below, Coulomb friction on the left."""
    return la.Problem(
        bodies={"block": square()},
        interfaces=[obstacle("bottom", law), obstacle("left", side)],
        dead_loads=[la.BodyForce("block", (0, -0.3))],
        reference_loads=[la.Traction("block", "right", (0.3, 1))],
    )


def test_friction_beside_an_interface_that_sticks():
    """Stick below holds u_x at the corner, which is the normal velocity of the left side."""
    with pytest.raises(la.InputError, match=r"'block.left': meets an interface that sticks"):
        la.discretise(cornered(la.STICK))


def test_a_corner_in_contact_on_both_sides_is_flagged():
    """Rigid turning about the upper left contact: a continuum of states, 0.225 to 0.261."""
    state = la.solve(cornered(2.0), throw=True)
    assert "may not be unique" in state.message
    assert 0.2 < state.load_factor < 0.3
    assert "unique" not in la.solve(cornered(la.SMOOTH, 0.0)).message


@pytest.mark.parametrize("components", ["normal", "tangential"])
def test_the_normal_of_a_polygon_in_place_of_an_arc(components):
    """Two normals at each vertex left no velocity: a ring that could turn came back as locked."""
    ring = la.meshes.quarter_ring(1, 2, 4, 8)
    body = la.Body(ring, la.VonMises(shear_strength=1.0), geometry="approximated")
    problem = la.Problem(
        bodies={"ring": body},
        supports=[la.Fix("ring", "outside", components)],
        reference_loads=[la.Traction("ring", "y_axis", (1, 0))],
    )
    with pytest.raises(la.InputError, match="polygon in place of an arc"):
        la.discretise(problem)


def test_a_corner_that_is_meant_may_be_held_by_its_normals():
    """All four sides of a square at right angles."""
    problem = la.Problem(
        bodies={"block": square()},
        supports=[la.Fix("block", lambda x: (x[1] == 0) | (x[0] == 0), "normal")],
        reference_loads=[la.Traction("block", "right", (1, 0))],
    )
    # Plane strain tension between smooth walls: 2 k.
    assert la.solve(problem, throw=True).load_factor == pytest.approx(2.0, rel=1e-2)


@pytest.mark.parametrize("limit", [1e3, 1e12, 1e30])
def test_a_friction_limit_beyond_the_strength_is_stick(limit):
    """The body's shear strength is 1: nothing can slip; 1e12 once came back as unsafe."""

    def pushed(law):
        return la.Problem(
            bodies={"block": BLOCK},
            interfaces=[obstacle("bottom", law)],
            dead_loads=[la.BodyForce("block", (0, -0.3))],
            reference_loads=[la.Traction("block", "left", (1, 0))],
        )

    by_limit, by_name = (la.solve(pushed(law), throw=True) for law in (la.Tresca(limit), la.STICK))
    assert by_limit.load_factor == pytest.approx(by_name.load_factor, rel=1e-9)


def test_a_weak_body_beside_a_strong_one_is_not_free():
    """It shears at k = 1 beside k = 1e8: a number or no proof, but not without dissipation."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    problem = la.Problem(
        bodies={
            "weak": la.Body(mesh, la.VonMises(shear_strength=1.0)),
            "strong": la.Body(mesh, la.VonMises(shear_strength=1e8)),
        },
        supports=[la.Fix("weak", "bottom"), la.Fix("strong", "bottom")],
        reference_loads=[la.Traction(name, "top", (1, 0)) for name in ("weak", "strong")],
    )
    assert la.solve(problem).status is not la.Status.FREE


@pytest.mark.parametrize(
    "given",
    [
        {"tolerance": 10.0},
        {"options": {"r": 1e3}, "backend": "ipopt"},
        {"options": {"r": 1e-300}, "backend": "ipopt"},
        {"damping": "a"},
        {"damping": None},
        {"anderson": 1.5},
        {"max_iterations": 2.5},
        {"options": {"max_iterations": 2.5}},
        {"options": {"reduction": "a"}, "backend": "ipopt"},
        {"options": {"rescue": "a"}, "backend": "ipopt"},
    ],
)
def test_settings_that_prove_nothing_are_refused(given):
    with pytest.raises(la.InputError, match="; "):
        la.solve(squeezed(1.0), **given)


@pytest.mark.parametrize(
    "given",
    [
        {"bodies": BLOCK},
        {"bodies": [BLOCK]},
        {"reference_loads": la.Traction("block", "top", (1, 0))},
        {"supports": la.Fix("block", "bottom")},
        {"interfaces": None},
        {"supports": [la.Fix(["block"], "bottom")]},
    ],
)
def test_parts_in_the_wrong_wrapping_are_named(given):
    parts = {
        "bodies": {"block": BLOCK},
        "reference_loads": [la.Traction("block", "top", (1, 0))],
    }
    with pytest.raises(la.InputError, match="; "):
        la.Problem(**(parts | given))


def test_one_footing_given_by_two_lengths_of_its_direction():
    """The docstring says that the direction is normalised."""
    problem = la.Problem(
        bodies={"block": BLOCK},
        supports=[la.Fix("block", "bottom")],
        reference_loads=[la.RigidFooting("block", "top", (0, -2))],
        dead_loads=[la.RigidFooting("block", "top", (0, -1), pressure=0.5)],
    )
    alone = la.Problem(
        bodies={"block": BLOCK},
        supports=[la.Fix("block", "bottom")],
        reference_loads=[la.RigidFooting("block", "top", (0, -1))],
    )
    shared = la.solve(problem, throw=True).load_factor
    assert shared == pytest.approx(la.solve(alone, throw=True).load_factor - 0.5, rel=1e-6)


def test_a_limit_state_survives_pickling():
    state = la.solve(deformable_block(0.5), throw=True)
    again = pickle.loads(pickle.dumps(state))
    assert again.load_factor == state.load_factor
    assert again.reactions.equals(state.reactions)


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        ({"backend": 3}, "backend = 3: not a name"),
        ({"options": {"max_iterations": 10**12}}, "more than solvers count to"),
    ],
)
def test_what_only_a_machine_would_say_is_said_in_words(arguments, field):
    with pytest.raises(la.InputError, match=field):
        la.solve(deformable_block(0.5), **arguments)
