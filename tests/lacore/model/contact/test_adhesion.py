"""Interfaces and joints with adhesion and strength in tension (T66), against closed forms.

1e-6 relative is the bar of the certificate; regularised solves of rigid blocks lose less than 1e-6,
too: with no strain all that is softened is the contact, and lambda is off by its square (T19).
"""

from dataclasses import replace
from itertools import pairwise
from math import cos, pi, radians, sin, tan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog
from scipy.sparse import diags_array

import lacore as la
from lacore.program.state import ProgramState
from lacore.reporting.status import Status
from lacore.reporting.units import Units
from tests.lacore.models import obstacle, square

BAR = 1e-6
EXACT = ("clarabel", "cvxpy", "highs", "ipopt-static")
SOFTENED = ("newton", "ipopt", "clarabel-regularised", "slsqp")
STICKY = la.Coulomb(0.4, adhesion=5.0, tension=4.0)
WIDE, HIGH, WEIGHT = 2.0, 0.1, 3.0


def on_slope(law, load, slope=0.0, weight=WEIGHT, wide=WIDE, high=HIGH):
    """A block on a slope, loaded at its centroid, along and across the slope."""
    turn = np.array([[cos(slope), -sin(slope)], [sin(slope), cos(slope)]])

    def box(x0, x1, y0, y1):
        return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]) @ turn.T

    blocks = {
        "slope": box(-wide, wide, -high, 0),
        "block": box(-wide / 2, wide / 2, 0, high),
    }
    return la.Problem(
        {"blocks": la.BlockAssembly(blocks, law)},
        [la.PointForce("blocks", "block", tuple((turn @ load).tolist()))],
        supports=[la.Fix("blocks", "slope")],
        dead_loads=[la.PointForce("blocks", "block", (0, -weight))] if weight else [],
    )


def sheared(law, load, **body):
    """A square on a floor, under its weight of 1, pulled up or pushed aside by its volume."""
    return la.Problem(
        {"block": square(**body)},
        [la.BodyForce("block", load)],
        interfaces=[obstacle(friction=law)],
        dead_loads=[la.BodyForce("block", (0, -1))],
    )


@pytest.mark.parametrize("associated", [False, True])
@pytest.mark.parametrize("backend", [*EXACT, *SOFTENED])
def test_a_block_is_pulled_off_and_pushed_up(backend, associated):
    """``W + T b`` across a floor, ``c_a b + W (mu cos + sin)`` along a slope."""
    law = replace(STICKY, associated=associated)
    off = la.solve(on_slope(law, (0, 1)), backend, throw=True)
    assert off.load_factor == pytest.approx(WEIGHT + 4 * WIDE, rel=BAR)
    up = la.solve(on_slope(law, (1, 0), 0.3), backend, throw=True)
    exact = 5 * WIDE + WEIGHT * (0.4 * cos(0.3) + sin(0.3))
    assert up.load_factor == pytest.approx(exact, rel=BAR)


@given(
    mu=st.floats(0, 1),
    adhesion=st.floats(0.1, 10),
    share=st.floats(0, 1),
    slope=st.floats(-0.5, 0.5),
    unit=st.floats(-6, 6),
    associated=st.booleans(),
)
def test_closed_forms_whatever_the_numbers(mu, adhesion, share, slope, unit, associated):
    """In any unit of stress; a flat block does not topple."""
    one = 10.0**unit
    tension = share * min(adhesion / mu if mu > 0 else 10.0, 10.0)
    law = la.Coulomb(mu, associated, one * adhesion, one * tension)
    weight = WEIGHT * one
    off = la.solve(on_slope(law, (0, 1), weight=weight), throw=True)
    assert off.load_factor == pytest.approx(one * (WEIGHT + tension * WIDE), rel=BAR)
    up = la.solve(on_slope(law, (1, 0), slope, weight), throw=True)
    exact = adhesion * WIDE + WEIGHT * (mu * cos(slope) + sin(slope))
    power = abs(exact) + WEIGHT  # what residuals are judged by
    assert up.load_factor == pytest.approx(one * exact, abs=BAR * one * power)


@given(seed=st.integers(0, 2**32 - 1))
def test_walls_against_a_linear_program_of_their_own(seed):
    """The largest load that tractions carry, as they are stated: no shift, no velocity, no loop.

    That of associated sliding; Coulomb's is no larger, and its reactions are within the law.
    """
    rng = np.random.default_rng(seed)
    mu, adhesion = rng.uniform(0.2, 1.0), rng.uniform(0.0, 2.0)
    tension = rng.uniform(0, 1) * adhesion / mu
    law = la.Coulomb(mu, adhesion=adhesion, tension=tension)
    wall = la.Problem(
        {"wall": la.masonry.running_bond([[1, 1, 1], [0.5, 1, 1, 0.5]] * 2, friction=law)},
        [la.BodyForce("wall", (1, 0))],
        supports=[la.Fix("wall", "base")],
        dead_loads=[la.BodyForce("wall", (0, -1))],
    )
    state = la.solve(wall, coupling="associated", throw=True)
    program, rows = state.discretisation.program, state.discretisation.program.contact
    m, weight = rows.count, diags_array(rows.weights)
    pressed = np.column_stack([weight @ rows.normal.toarray(), weight @ rows.tangential.toarray()])
    balance = np.column_stack(
        [pressed[:, : program.n].T, pressed[:, program.n :].T, program.reference_load]
    )
    weights = program.dead_load - program.held_shut
    one, none = np.eye(m), np.zeros((m, 1))
    found = linprog(
        np.append(np.zeros(2 * m), -1.0),
        A_ub=np.block([[-mu * one, one, none], [-mu * one, -one, none]]),
        b_ub=np.full(2 * m, adhesion),
        A_eq=balance,
        b_eq=-weights,
        bounds=[*[(-tension, None)] * m, *[(None, None)] * m, (None, None)],
    )
    assert found.status == 0, found.message
    assert state.load_factor == pytest.approx(-found.fun, rel=BAR)
    sliding = la.solve(wall)
    if sliding.status is Status.SOLVED:
        assert sliding.load_factor <= state.load_factor * (1 + BAR)
        t_n, t_t = sliding.reactions["t_n"], sliding.reactions["t_t"].abs()
        slack = BAR * float(np.hypot(t_n, t_t).max())
        assert t_n.min() >= -tension - slack
        assert (t_t - mu * t_n).max() <= adhesion + slack


def test_flow_of_soil_and_sliding_in_one_loop():
    """Soil that dilates less than its friction slides on a floor with adhesion: ``c_a + mu p``."""
    soil = la.MohrCoulomb(50.0, 30, dilation_angle=0)
    mesh = la.meshes.rectangle(x=(0, 4), y=(0, 1), nx=8, ny=2)
    problem = la.Problem(
        {"block": la.Body(mesh, soil)},
        [la.BodyForce("block", (1, 0))],
        interfaces=[obstacle(friction=la.Coulomb(0.3, adhesion=0.8, tension=1.0))],
        dead_loads=[la.BodyForce("block", (0, -1)), la.Pressure("block", "top", 2.0)],
    )
    state = la.solve(problem, throw=True)
    assert state.load_factor == pytest.approx(0.8 + 0.3 * 3, rel=BAR)
    assert state.certificate.holds(1e-6)


def test_a_block_topples_against_tension():
    """About its edge: ``alpha h/2 = W b/2 + T b^2/2``."""
    law = la.Coulomb(5.0, adhesion=25.0, tension=4.0)
    state = la.solve(on_slope(law, (1, 0), high=8.0), throw=True)
    assert state.load_factor == pytest.approx((WEIGHT * WIDE / 2 + 4 * WIDE**2 / 2) / 4, rel=BAR)
    # At the edge it turns about nothing is known beforehand; the other one is torn.
    assert state.reactions["t_n"].min() == pytest.approx(-4, rel=BAR)


def test_reactions_are_the_real_tractions():
    """In equilibrium with the loads, and with the support beneath."""
    problem = on_slope(STICKY, (0, 1))
    state = la.solve(problem, throw=True)
    table = state.reactions
    assert table["t_n"].to_numpy() == pytest.approx([-4, -4])
    force = float(table["length"] @ table["t_n"])
    assert force + state.load_factor == pytest.approx(WEIGHT)
    assert state.support_reactions["force_y"].sum() == pytest.approx(force)
    assert state.certify(reactions=table).worst[1] == pytest.approx(state.certificate.worst[1])


def _scaled(column, factor):
    return lambda table: table.assign(**{column: factor * table[column]})


@pytest.mark.parametrize(
    ("load", "planted", "residual"),
    [
        ((0, 1), _scaled("t_n", 1.001), "cone"),  # beyond the strength
        ((0, 1), _scaled("t_n", 0.0), "equilibrium"),  # tension forgotten
        ((0, 1), lambda table: table.assign(t_n=table["t_n"] + 4), "equilibrium"),  # not shifted
        ((1, 0), _scaled("t_t", 1.001), "cone"),
        ((1, 0), _scaled("t_t", -1.0), "slip"),
        ((1, 0), lambda table: table.assign(t_t=table["t_t"] * 0.2), "equilibrium"),  # no adhesion
    ],
)
def test_planted_errors_are_refused(load, planted, residual):
    state = la.solve(on_slope(STICKY, load), throw=True)
    seen = state.certify(reactions=planted(state.reactions))
    assert not seen.holds(state.tolerance)
    assert getattr(seen, residual) > 1e-5


@pytest.mark.parametrize(
    "other",
    [
        replace(STICKY, adhesion=4.99),
        replace(STICKY, tension=3.99),
        replace(STICKY, tension=0.0),
        replace(STICKY, mu=0.39),
        la.Coulomb(0.4),
    ],
)
def test_a_state_of_another_law_is_refused(other):
    """Pushed up and off at once, so that each number of the law counts."""
    for load in ((0, 1), (1, 0)):
        state = la.solve(on_slope(STICKY, load, 0.3), throw=True)
        weaker = la.discretise(on_slope(other, load, 0.3))
        mine, its = state.discretisation.full.contact.pull, weaker.full.contact.pull
        point = replace(state.point, normal_reaction=state.point.normal_reaction - mine + its)
        assert isinstance(point, ProgramState)
        seen = replace(state, discretisation=weaker, point=point).certify(point=point)
        answer = la.solve(weaker)
        same = answer.load_factor == pytest.approx(state.load_factor, rel=1e-6)
        assert seen.holds(state.tolerance) == same


def test_what_has_neither_is_as_before():
    """Not one number of the program, and not one word of its text, differs."""
    plain = la.discretise(on_slope(la.Coulomb(0.4), (1, 0))).full
    named = la.discretise(on_slope(la.Coulomb(0.4, adhesion=0.0, tension=0.0), (1, 0))).full
    assert plain.contact.tension is None
    assert named.contact.tension is None
    assert np.array_equal(plain.dead_load, named.dead_load)
    assert not plain.held_shut.any()
    assert repr(la.Coulomb(0.4)) == "Coulomb(mu=0.4, associated=False)"


@pytest.mark.parametrize("associated", [False, True])
def test_tension_is_a_pressure_that_holds_shut(associated):
    """The same load with the shifted law under a dead traction of T; reactions differ by T."""
    own = la.Coulomb(0.3, associated, adhesion=0.5, tension=0.4)
    shifted = replace(own, adhesion=0.5 - 0.3 * 0.4, tension=0.0)
    torn = sheared(own, (1, 0.2))
    held = replace(
        sheared(shifted, (1, 0.2)),
        dead_loads=[la.BodyForce("block", (0, -1)), la.Traction("block", "bottom", (0, -0.4))],
    )
    one, other = la.solve(torn, throw=True), la.solve(held, throw=True)
    assert one.load_factor == pytest.approx(other.load_factor, rel=BAR)
    d, e = one.discretisation.program, other.discretisation.program
    assert np.allclose(d.dead_load, e.dead_load, rtol=0, atol=1e-14)  # sums of terms below 1
    force = [float(s.reactions["length"] @ s.reactions["t_n"]) for s in (one, other)]
    assert force[1] - force[0] == pytest.approx(0.4, rel=1e-5)


@pytest.mark.parametrize("load", [(0, 1), (1, 0)])
@pytest.mark.parametrize("tension", [0.0, 0.2, 1.0])
def test_bounds_hold(load, tension):
    """Of associated sliding: proven below and above, and shares of the gap that sum up to it.

    Of Coulomb sliding bracketed by two problems, so that its load factor, of the discrete problem,
    is between the one of the continuum and the other of the same discretisation.
    """
    law = la.Coulomb(0.5, True, adhesion=0.5, tension=tension)
    problem = sheared(law, load, n=3)
    lower, upper = la.lower_bound(problem, throw=True), la.upper_bound(problem, throw=True)
    assert lower.rigor is la.Rigor.LOWER
    assert upper.rigor is la.Rigor.UPPER
    assert lower.load_factor <= upper.load_factor * (1 + 1e-12)
    assert lower.reactions["t_n"].min() >= -tension
    shares = la.gap_identity(upper, lower)
    gap = upper.load_factor - lower.load_factor
    assert shares.total == pytest.approx(gap, rel=1e-6, abs=1e-12)
    assert shares.least >= -1e-12 * max(upper.load_factor, 1)
    sliding = sheared(replace(law, associated=False), load, n=3)
    state = la.solve(sliding, throw=True)
    found = la.bracket(sliding, target_width=0.3)
    assert found.lower <= state.load_factor * (1 + BAR)
    dilating = la.solve(sliding, coupling="associated", throw=True)
    assert state.load_factor <= dilating.load_factor * (1 + BAR)
    if load == (0, 1):  # rigid and exact: the weight and the tension
        assert upper.load_factor == pytest.approx(1 + tension, rel=BAR)
        assert lower.load_factor == pytest.approx(1 + tension, rel=BAR)


@pytest.mark.parametrize("backend", ["newton", "ipopt", "clarabel-regularised"])
def test_softened_values_stay_in_order(backend):
    """``P <= alpha_reg <= lambda <= alpha*`` of sliding that dilates beside a bound (T19)."""
    problem = sheared(la.Coulomb(0.5, True, adhesion=0.5, tension=0.2), (1, 0))
    star = la.solve(problem, coupling="associated", throw=True).load_factor
    state = la.solve(problem, backend, coupling="associated", throw=True)
    values = state.regularised
    ordered = [values.plastic, values.alpha_reg, values.load_factor, star]
    slack = 1e-7 * star  # of the solves
    assert all(a <= b + slack for a, b in pairwise(ordered))
    assert values.load_factor == pytest.approx(star, rel=1e-3)


def test_an_interval_of_reactions_with_adhesion():
    """A plug between walls that are held: adhesion adds ``c_a`` per side to what weight asks for.

    The least is that of walls that do not press: ``W + 2 c_a h``.
    """

    def box(x0, x1, y0, y1):
        return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], dtype=float)

    blocks = {"left": box(-2, -1, -1, 3), "block": box(-1, 1, 0, 2), "right": box(1, 2, -1, 3)}
    plug = la.Problem(
        {"plug": la.BlockAssembly(blocks, la.Coulomb(0.3, adhesion=0.7))},
        [la.PointForce("plug", "block", (0, 1))],
        supports=[la.Fix("plug", "left"), la.Fix("plug", "right")],
        dead_loads=[la.BodyForce("plug", (0, -1), where="block")],
    )
    found = la.solve(plug, throw=True).interval()
    assert found.low == pytest.approx(4 + 2 * 0.7 * 2, rel=BAR)
    assert found.high == np.inf
    # With tension the walls may pull each other: less is carried, by mu T of the friction.
    pulling = replace(
        plug,
        bodies={"plug": la.BlockAssembly(blocks, la.Coulomb(0.3, adhesion=0.7, tension=1.0))},
    )
    found = la.solve(pulling, throw=True).interval()
    assert found.low == pytest.approx(4 + 2 * (0.7 - 0.3) * 2, rel=BAR)


@pytest.mark.parametrize("weight", [7.0, 9.0])
def test_a_hanging_block_falls_or_holds(weight):
    """``T b = 8``; the share of the weight that is carried is one of the weight alone."""
    law, turned = la.Coulomb(0.4, adhesion=5.0, tension=4.0), pi
    state = la.solve(on_slope(law, (1, 0), turned, weight))
    if weight < 8:
        assert state.status is Status.SOLVED
        assert state.stability().standing.label == "stands"
        assert state.stability().point.normal_reaction.min() >= 0
    else:
        assert state.status is Status.UNSAFE
        assert state.stability().standing.label == "falls"
        assert state.reactions["t_n"].to_numpy() == pytest.approx([-4, -4], rel=1e-5)


def test_mortar_of_single_joints():
    """Two blocks hang from a third; the weaker joint gives way."""

    def box(y0, y1):
        return np.array([(0, y0), (1, y0), (1, y1), (0, y1)], dtype=float)

    hung = la.BlockAssembly(
        {"roof": box(2, 3), "upper": box(1, 2), "lower": box(0, 1)},
        la.Coulomb(0.6, adhesion=3.0, tension=2.5),
        {("upper", "lower"): la.Coulomb(0.6, adhesion=0.6, tension=0.9)},
    )
    assert hung.joints.tension.tolist() == [2.5, 0.9]
    problem = la.Problem(
        {"hung": hung}, [la.BodyForce("hung", (0, -1))], supports=[la.Fix("hung", "roof")]
    )
    state = la.solve(problem, throw=True)
    assert state.load_factor == pytest.approx(0.9, rel=BAR)
    assert np.sort(state.reactions["t_n"]) == pytest.approx([-1.8, -1.8, -0.9, -0.9], rel=1e-5)
    # Here: matplotlib takes half a second to load.
    from lacore.pictures.sketch.conditions import joint_laws, law_text

    shown = joint_laws(hung, Units())
    assert "$c_a = 0.6$ Pa" in shown[1]
    assert r"$t_n \geq -0.9$ Pa" in shown[1]
    assert law_text(la.Coulomb(0.3), Units()) == r"$\mu = 0.3$"


@pytest.mark.parametrize("active", [False, True])
def test_a_wall_with_adhesion_beside_soil(active):
    """Earth pressure, exact by Caquot's theorem from Prandtl's field beside a rough wall.

    Cohesion and adhesion with one apex, ``c_a = c tan(delta)/tan(phi)``, are a surcharge of
    ``c cot(phi)`` on the surface and on the wall.
    """
    from lacore_verification.cases import earth_pressure as case

    phi, delta, c = radians(30), radians(15), 0.4
    apex = c / tan(phi)
    rough = case.CASE.reference(30, 15, 0.0, 0.0, active).value
    sense = -1.0 if active else 1.0
    exact = rough * (1 + apex) - sense * apex
    problem = case.build(20, 10, 8.0, 30, 15, c, 0.0, active)
    face, bed = problem.interfaces
    law = la.Coulomb(tan(delta), True, adhesion=apex * tan(delta), tension=apex)
    problem = replace(problem, interfaces=[replace(face, friction=law), bed])
    lower, upper = la.lower_bound(problem, throw=True), la.upper_bound(problem, throw=True)
    assert lower.load_factor < exact < upper.load_factor
    # 400 triangles of no fan: a few per cent, as without adhesion.
    assert upper.load_factor - lower.load_factor < 0.25 * abs(exact)


def test_what_carries_less_at_any_pressure():
    """A cone within another one, wherever either ends."""
    strong, friction = la.Coulomb(0.5, adhesion=3.0, tension=4.0), la.Coulomb(0.5)
    for weak in (friction, la.Coulomb(0.5, True), la.Coulomb(0.4, adhesion=3.0), la.Tresca(1.0)):
        assert weak.terms().within(strong.terms())
        assert not strong.terms().within(weak.terms())
    assert not la.Coulomb(0.6, True).terms().within(strong.terms())
    # Stronger without pressure, weaker where it pulls: neither is within the other.
    pulled = la.Coulomb(0.1, adhesion=1.2, tension=6.0)
    assert not pulled.terms().within(strong.terms())
    assert not strong.terms().within(pulled.terms())
    assert la.Coulomb(0.5, adhesion=2.0, tension=4.0).terms().within(strong.terms())


def test_load_factors_feel_it_by_what_it_does_power_on():
    """Multipliers say the derivatives: the bed is 2 wide, by adhesion pushed, by tension pulled."""
    for load, felt in (((1, 0), (WIDE, 0.0)), ((0, 1), (0.0, WIDE))):
        state = la.solve(on_slope(replace(STICKY, associated=True), load, 0.3), throw=True)
        table = la.sensitivity(state).table.set_index("parameter").derivative
        found = [table[f"blocks: friction.{name}"] for name in ("adhesion", "tension")]
        assert found == pytest.approx(felt, abs=1e-5)


def test_factors_of_safety_divide_it():
    """With the friction, apex kept, and never beyond it."""
    law = la.Coulomb(0.5, True, adhesion=4.0, tension=6.0)
    half = law.divided(2.0)
    assert (half.mu, half.adhesion, half.tension) == (0.25, 2.0, 3.0)
    twice = law.divided(0.5)
    assert (twice.mu, twice.adhesion, twice.tension) == (1.0, 8.0, 8.0)
    assert la.Tresca(3.0).divided(2.0) == la.Tresca(1.5)


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"adhesion": -1.0}, "Coulomb.adhesion"),
        ({"adhesion": np.inf}, "finite"),
        ({"tension": np.nan}, "Coulomb.tension"),
        ({"tension": 1.0}, "apex of the cone, adhesion/mu = 0 Pa"),
        ({"adhesion": 1.0, "tension": 3.4}, "adhesion/mu = 3.33333 Pa"),
    ],
)
def test_strengths_that_are_none(wrong, told):
    with pytest.raises(la.InputError, match=told):
        la.Coulomb(0.3, **wrong)
    la.Coulomb(0.3, adhesion=0.9, tension=0.9 / 0.3)  # the apex itself, to round-off


def test_what_nothing_could_open_is_refused():
    with pytest.raises(la.InputError, match="nothing would ever open"):
        la.solve(sheared(la.Coulomb(0.0, tension=1e9), (0, 1)))


def test_paths_do_not_follow_what_sticks_in_tension():
    with pytest.raises(la.InputError, match="leave the tension out"):
        la.sequential(sheared(la.Coulomb(0.2, adhesion=1.0, tension=1.0), (0, -1)), 0.1, 1)
