"""Anyone can recompute what a state proves, and plant an error in it: `LimitState.certify`."""

from dataclasses import asdict, replace
from functools import cache

import numpy as np
import pytest

import lacore as la
from tests.frame_problems import pushed
from tests.lacore.models import deformable_block, punch, square
from tests.rigid_problems import block_slide, wall

BAR = 1e-6  # of `solve`


def ring():
    """A thick tube under pressure, a slice of it: (r, z)."""
    mesh = la.meshes.quadrilaterals((1, 2), (0, 0.5), 3, 2)
    return la.Problem(
        bodies={"ring": la.Body(mesh, la.VonMises(1.0), kinematics="axisymmetric", space="q2")},
        supports=[la.Fix("ring", side, "y") for side in ("bottom", "top")],
        reference_loads=[la.Pressure("ring", "left", 1.0)],
    )


def pulled(kinematics="plane_stress"):
    return la.Problem(
        bodies={"block": square(kinematics=kinematics)},
        supports=[la.Fix("block", "left", "x"), la.Fix("block", "bottom", "y")],
        reference_loads=[la.Traction("block", "right", (1, 0))],
    )


PROBLEMS = {
    "sliding": lambda: la.solve(deformable_block(0.5)),
    "crushing": lambda: la.solve(deformable_block(0.9)),
    "associated": lambda: la.solve(deformable_block(0.5), coupling="associated"),
    "frictionless wall": lambda: la.solve(block_slide(), coupling="frictionless"),
    "stick": lambda: la.solve(deformable_block(0.5), coupling="stick"),
    "regularised": lambda: la.solve(deformable_block(0.5), backend="newton"),
    "punch": lambda: la.solve(punch()),
    "jumps": lambda: la.solve(punch(space="p2-disc")),
    "smooth punch": lambda: la.solve(punch(rough=False)),
    "plane stress": lambda: la.solve(pulled()),
    "ring": lambda: la.solve(ring()),
    "wall": lambda: la.solve(wall("wall-1")),
    "frame": lambda: la.solve(pushed(0.35, 1.5)),
}


@cache
def solved(name):
    return PROBLEMS[name]()


@pytest.mark.parametrize("name", PROBLEMS)
def test_what_is_recomputed_is_what_was_reported(name):
    """The gap of a kinematic value is that to the load factor reported, not to the solver's."""
    state = solved(name)
    assert state.point is not None
    again = asdict(state.certify())
    reported = asdict(state.certificate)
    # Round-off of unknowns that went to SI units and back, amplified by penalties.
    for residual in set(again) - {"gap"}:
        assert again[residual] == pytest.approx(reported[residual], rel=1e-6, abs=1e-11), residual
    assert again["gap"] <= reported["gap"] * (1 + 1e-6) + 1e-11


@pytest.mark.parametrize("name", PROBLEMS)
def test_what_a_state_shows_is_read_back(name):
    """All that is shown goes back in, and proves the same."""
    state = solved(name)
    own = asdict(state.certify())
    shown = state.certify(
        load_factor=state.point.load_factor,
        velocity=state.velocity,
        stress=state.stress,
        reactions=state.reactions,
        hinges=state.hinges if len(state.hinges) else None,
    )
    for residual, value in asdict(shown).items():
        assert value == pytest.approx(own[residual], rel=1e-6, abs=1e-11), residual


def shaken(values, size=1e-3):
    values = np.array(values)
    values.flat[values.size // 2] += size * np.abs(values).max()
    return values


def other_reactions(**columns):
    def plant(state):
        table = state.reactions
        for name, change in columns.items():
            table[name] = change(table[name].to_numpy())
        return {"reactions": table}

    return plant


def of_body(kind, name, change):
    return lambda state: {kind: {name: change(getattr(state, kind)[name])}}


def along(axis, change):
    def planted(values):
        values = values.copy()
        values[axis] = change(values[axis])
        return values

    return planted


def zz(change):
    def planted(stress):
        stress = stress.copy()
        stress[..., 2] += change * np.abs(stress).max()
        return stress

    return planted


def at_the_base(state):
    """Where the soil is held, and nowhere else: no free unknown feels it."""
    u = state.velocity["soil"].copy()
    u[:, state.discretisation.continua["soil"].nodes[1] == -2] += 1e-3 * np.abs(u).max()
    return {"velocity": {"soil": u}}


ERRORS = {
    "velocity where it is held": ("punch", at_the_base),
    "load factor": ("sliding", lambda s: {"load_factor": 1.0001 * s.load_factor}),
    "load factor of a bound": ("associated", lambda s: {"load_factor": 0.9999 * s.load_factor}),
    "NaN": ("sliding", lambda _: {"load_factor": np.nan}),
    "velocity": ("sliding", of_body("velocity", "block", shaken)),
    "velocity beyond yield": ("crushing", of_body("velocity", "block", shaken)),
    "velocity scaled": ("punch", of_body("velocity", "soil", lambda u: 1.001 * u)),
    "velocity against a support": (
        "ring",
        of_body("velocity", "ring", along(1, lambda v: v + 1e-3)),
    ),
    "velocity of a footing": ("smooth punch", of_body("velocity", "soil", along(1, shaken))),
    "rotation of a block": ("wall", of_body("velocity", "blocks", along(2, shaken))),
    "stretch of a member": ("frame", of_body("velocity", "frame", along(0, shaken))),
    "stress": ("crushing", of_body("stress", "block", shaken)),
    "stress across the plane": ("crushing", of_body("stress", "block", zz(1e-3))),
    "stress across a sheet": ("plane stress", of_body("stress", "block", zz(1e-3))),
    "hoop stress": ("ring", of_body("stress", "ring", zz(1e-3))),
    "stress without a number": ("ring", of_body("stress", "ring", lambda s: np.nan * s)),
    "pressure": ("sliding", other_reactions(t_n=shaken)),
    "tension": ("wall", other_reactions(t_n=lambda t: -t)),
    "friction": ("sliding", other_reactions(t_t=lambda t: 1.001 * t)),
    "friction along the slip": ("wall", other_reactions(t_t=lambda t: -t)),
    "moment": (
        "frame",
        lambda s: {"hinges": s.hinges.assign(moment=shaken(s.hinges["moment"]))},
    ),
    "a point": (
        "jumps",
        lambda s: {"point": replace(s.point, stress=tuple(1.001 * t for t in s.point.stress))},
    ),
}


@pytest.mark.parametrize("error", ERRORS)
def test_a_planted_error_is_refused(error):
    name, plant = ERRORS[error]
    state = solved(name)
    assert state.certify().holds(BAR), state.certify()
    assert not state.certify(**plant(state)).holds(BAR), state.certify(**plant(state))


def test_a_forged_number_is_refused():
    state = solved("wall")
    assert not replace(state, load_factor=state.load_factor + 1e-4).certify().holds(BAR)


def test_another_state_of_the_same_mechanism_is_accepted():
    """A true Coulomb state that no solver of this state found: an end of its interval."""
    state = solved("wall")
    end = state.interval().lower
    assert end.load_factor < state.load_factor - 1e-3  # T14b: 0.638982 against 0.642859
    assert state.certify(point=end.point).holds(BAR)
    assert not state.certify(point=end.point, load_factor=state.load_factor).holds(BAR)


def test_rows_may_be_sorted():
    state = solved("wall")
    table = state.reactions.sort_values("t_n")
    assert asdict(state.certify(reactions=table)) == asdict(state.certify())


@pytest.mark.parametrize(
    ("given", "field"),
    [
        ({"velocity": {"sofl": np.zeros((2, 3))}}, "velocity"),
        ({"velocity": {"soil": np.zeros((2, 3))}}, r"velocity\['soil'\]"),
        ({"velocity": {"soil": "fast"}}, r"velocity\['soil'\]"),
        ({"stress": {"rock": 0}}, "stress"),
        ({"stress": {"soil": np.zeros(4)}}, r"stress\['soil'\]"),
        ({"reactions": {"t_n": []}}, "reactions"),
        ({"load_factor": "5.2"}, "load_factor"),
        ({"hinges": 3}, "hinges"),
    ],
)
def test_what_is_no_part_of_the_state_is_refused_by_name(given, field):
    with pytest.raises(la.InputError, match=field):
        solved("punch").certify(**given)


def test_a_point_of_another_problem_is_refused():
    with pytest.raises(la.InputError, match=r"point: has a .* of shape"):
        solved("punch").certify(point=solved("sliding").point)
    with pytest.raises(la.InputError, match="point: has stresses for"):
        solved("punch").certify(point=solved("wall").point)


def test_a_shortened_table_is_refused():
    state = solved("wall")
    with pytest.raises(la.InputError, match="reactions"):
        state.certify(reactions=state.reactions.iloc[1:])


def test_a_state_of_stresses_that_feel_the_hoop_checks_itself():
    """Tresca's criterion has two mean stresses a point in axisymmetry (T40)."""
    mesh = la.meshes.rectangle((1, 2), (0, 1), 2, 2)
    body = la.Body(mesh, la.MaximumShear(1.0), kinematics="axisymmetric", space="p2-gauss")
    state = la.solve(
        la.Problem(
            bodies={"ring": body},
            supports=[la.Fix("ring", side, "y") for side in ("bottom", "top")],
            reference_loads=[la.Pressure("ring", "left", 1.0)],
        )
    )
    assert state.certify(point=state.point).holds(state.tolerance)


@pytest.mark.parametrize("space", ["q2", "p2-gauss"])
def test_stresses_of_soil_are_shown_as_they_are_judged(space):
    """Given back as they are shown, they are within the surfaces that they were found in."""
    cells = {"x": (0, 2), "y": (0, 1), "nx": 2, "ny": 1}
    mesh = la.meshes.quadrilaterals(**cells) if space == "q2" else la.meshes.rectangle(**cells)
    problem = la.Problem(
        bodies={"soil": la.Body(mesh, la.MohrCoulomb(1.0, 30), space=space)},
        supports=[la.Fix("soil", "left", "x"), la.Fix("soil", "bottom", "y")],
        reference_loads=[la.RigidFooting("soil", "top", (0, -1))],
    )
    state = la.solve(problem)
    assert state.certify(stress=state.stress).holds(state.tolerance)
