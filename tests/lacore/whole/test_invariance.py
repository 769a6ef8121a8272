"""Moving, turning and rescaling a problem changes the load factor exactly as it must."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from tests.lacore.models import obstacle

# Kinematic values of single solves agree to the solver's gap, below 1e-7 on this mesh; those of the
# loop to 1e-5 (residuals below 1e-6, T15).
SOLVED, LOOPED = 1e-6, 1e-5
TRIANGULAR = ["p2-vertex", "p2-gauss", "p2-disc", "p1-disc", "p1"]
MESH = la.meshes.rectangle((0, 2), (0, 1), 4, 2, grade_x=(0.0, 2.0))
MIDDLE = MESH.p[:, MESH.facets].mean(axis=1)
MESH = MESH.with_boundaries({"guide": np.flatnonzero((MIDDLE[0] == 2) & (MIDDLE[1] > 0.5))})


def problem(
    angle=0.0,
    shift=(0.0, 0.0),
    length=1.0,
    stress=1.0,
    load=1.0,
    space="p2-vertex",
    guided=False,
    friction=0.4,
):
    """A block on a rough floor, pushed, pressed and heavy.

    A guide at its end carries weight that the floor then does not feel, in a proportion that no
    equation fixes: Coulomb loads of the guided block are an interval (T14b), from which round-off
    picks one. Its associated load is unique.

    Turned by `angle`, then moved by `shift` block lengths; lengths times `length`, strength and
    dead loads times `stress`, reference loads times `load`: the load factor is times stress/load.
    """
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s], [s, c]])

    def turned(vector, factor):
        return tuple(factor * (turn @ vector))

    points = length * (turn @ MESH.p + np.reshape(shift, (2, 1)))
    corner = tuple(length * (turn @ [0.0, 1.0] + np.array(shift)))
    body = la.Body(
        replace(MESH, doflocs=points), la.VonMises(shear_strength=1.3 * stress), space=space
    )
    return la.Problem(
        {"block": body},
        reference_loads=[
            la.Traction("block", "left", turned([1.0, 0.2], load)),
            la.PointForce("block", corner, turned([0.1, -0.1], load * length)),
        ],
        supports=[la.Fix("block", "guide", "tangential")] if guided else [],
        interfaces=[obstacle(friction=friction)],
        dead_loads=[
            la.Pressure("block", "top", 0.7 * stress),
            la.BodyForce("block", turned([0.05, -0.3], stress / length)),
        ],
    )


@pytest.fixture(scope="module")
def base():
    def solved(coupling, space):
        stated = problem(space=space, guided=coupling == "associated")
        return la.solve(stated, coupling=coupling, throw=True)

    return {
        (coupling, space): solved(coupling, space)
        for coupling in ("reaction", "associated")
        for space in TRIANGULAR
    }


@given(
    angle=st.floats(0, 2 * np.pi),
    shift=st.tuples(st.floats(-100, 100), st.floats(-100, 100)),
    length=st.floats(-3, 9),
    stress=st.floats(-3, 9),
    load=st.floats(-3, 9),
    coupling=st.sampled_from(["reaction", "associated"]),
    space=st.sampled_from(TRIANGULAR),
)
def test_load_factor(base, angle, shift, length, stress, load, coupling, space):
    other = problem(angle, shift, 10**length, 10**stress, 10**load, space, coupling == "associated")
    state = la.solve(other, coupling=coupling, throw=True)
    expected = base[coupling, space].load_factor * 10**stress / 10**load
    bar = LOOPED if coupling == "reaction" else SOLVED
    assert state.load_factor == pytest.approx(expected, rel=bar)


@given(angle=st.floats(0, 2 * np.pi), stress=st.floats(-3, 9), length=st.floats(-3, 6))
def test_resultant_of_the_reactions(base, angle, stress, length):
    """Turns with the model; pressures point by point are not unique, their sum is here."""
    state = la.solve(problem(angle, length=10**length, stress=10**stress), throw=True)
    one, other = base["reaction", "p2-vertex"].reactions, state.reactions
    force = 10.0 ** (stress + length)
    for name in ("t_n", "t_t"):
        total = one[name] @ one.length
        assert other[name] @ other.length == pytest.approx(total * force, rel=LOOPED)
    assert np.allclose(other.n_x, -np.sin(angle), atol=1e-9)
    assert np.allclose(other.n_y, np.cos(angle), atol=1e-9)


@given(angle=st.floats(0, 2 * np.pi))
def test_where_coulomb_loads_are_an_interval_each_answer_is_one_of_them(angle):
    """The guided block: certified from any side, and bracketed (T14), though not one number."""
    guided = problem(angle, guided=True)
    state = la.solve(guided, throw=True)
    assert state.certificate.holds(1e-6)
    upper = la.solve(guided, coupling="associated", throw=True).load_factor
    lower = la.solve(problem(angle, guided=True, friction=la.SMOOTH), throw=True).load_factor
    assert lower < state.load_factor < upper


def punch(angle, rough):
    """A footing with a direction of its own, on a turned half-space."""
    mesh = la.meshes.rectangle((0, 4), (-2, 0), 6, 3, grade_x=(1.0, 6.0))
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    top = mesh.p[:, mesh.facets].mean(axis=1)
    under = np.flatnonzero((top[1] == 0) & (top[0] < 1))
    named = mesh.with_boundaries({"footing": under})
    soil = la.Body(replace(named, doflocs=turn @ mesh.p), la.VonMises(shear_strength=1.0))
    return la.Problem(
        {"soil": soil},
        [la.RigidFooting("soil", "footing", tuple(turn @ [0.0, -1.0]), rough=rough)],
        supports=[
            la.Fix("soil", "bottom"),
            la.Fix("soil", "right"),
            la.Fix("soil", "left", "normal"),
        ],
    )


@given(angle=st.floats(0, 2 * np.pi), rough=st.booleans())
def test_footing(angle, rough):
    one, other = (la.solve(punch(a, rough), throw=True).load_factor for a in (0.0, angle))
    assert other == pytest.approx(one, rel=SOLVED)


def squeezed(angle, size, friction):
    """A flat block between a rough platen and a floor: friction and plastic flow in one."""
    mesh = la.meshes.rectangle((0, 2), (0, 1), 4, 2)
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    body = la.Body(replace(mesh, doflocs=size * (turn @ mesh.p)), la.VonMises(shear_strength=1.0))
    return la.Problem(
        {"block": body},
        [la.RigidFooting("block", "top", tuple(turn @ [0.0, -1.0]))],
        interfaces=[obstacle(friction=friction)],
        dead_loads=[la.BodyForce("block", tuple(turn @ [0.1, -0.2] / size))],
    )


@given(
    angle=st.floats(0, 2 * np.pi),
    size=st.floats(-3, 6).map(lambda e: 10**e),
    friction=st.sampled_from([0.05, 0.2, 0.4]),
)
def test_friction_with_plastic_flow(angle, size, friction):
    one, other = (
        la.solve(squeezed(*to, friction), throw=True).load_factor
        for to in ((0.0, 1.0), (angle, size))
    )
    assert other == pytest.approx(one, rel=LOOPED)


def test_mirrored():
    """Left and right have no meaning; the tangent of the interface does not either."""

    def push(side, force):
        return la.Problem(
            {"block": la.Body(la.meshes.rectangle((-2, 2), (0, 1), 4, 2), la.VonMises(1.0))},
            [la.Traction("block", side, (force, 0.1))],
            interfaces=[obstacle(friction=0.5)],
            dead_loads=[la.Pressure("block", "top", 1.0)],
        )

    one, other = (la.solve(push(*to), throw=True) for to in (("left", 1.0), ("right", -1.0)))
    assert one.load_factor == pytest.approx(other.load_factor, rel=LOOPED)
    slip = [s.reactions.t_t @ s.reactions.length for s in (one, other)]
    assert slip[0] == pytest.approx(-slip[1], rel=LOOPED)


def test_order_of_bodies_and_loads_has_no_meaning():
    one = problem()
    other = la.Problem(
        one.bodies,
        one.reference_loads[::-1],
        supports=one.supports,
        interfaces=one.interfaces,
        dead_loads=one.dead_loads[::-1],
    )
    values = [la.solve(p, throw=True).load_factor for p in (one, other)]
    assert values[0] == pytest.approx(values[1], rel=LOOPED)


@pytest.mark.parametrize("factor", [1e-6, 1e6])
def test_strength_in_other_units(factor):
    """Pa or MPa: the whole statement in either."""
    states = [la.solve(problem(stress=s, load=s), throw=True) for s in (1.0, factor)]
    assert states[1].load_factor == pytest.approx(states[0].load_factor, rel=LOOPED)


@pytest.mark.parametrize("kinematics", ["plane_strain", "axisymmetric", "3d"])
def test_scales_are_those_of_the_problem_in_any_unit_of_length(kinematics):
    """m or mm: stresses by N/m^2, and the weight's share of them, are 1e-6 as large in the other.

    By them residuals are judged: a scale that grows with the unit lets errors pass.
    """

    def stress(unit):
        side, force = (0, unit), -18e3 / unit**3
        if kinematics == "3d":
            mesh, down = la.meshes.box(side, side, side, 1, 1, 1), (0.0, 0.0)
            space = "p2-vertex"
            soil = la.DruckerPrager(1e3 / unit**2, 20.0)
        else:
            mesh, down = la.meshes.rectangle(side, side, 2, 2), (0.0,)
            space = "p2-gauss"
            soil = la.MohrCoulomb(1e3 / unit**2, 30.0)
        stated = la.Problem(
            bodies={"soil": la.Body(mesh, soil, space=space, kinematics=kinematics)},
            reference_loads=[la.Traction("soil", "top", (*down, -1.0))],
            supports=[la.Fix("soil", "bottom")],
            dead_loads=[la.BodyForce("soil", (*down, force))],
        )
        return la.discretise(stated).natural.stress

    assert stress(1e3) * 1e6 == pytest.approx(stress(1.0), rel=1e-12)  # round-off
