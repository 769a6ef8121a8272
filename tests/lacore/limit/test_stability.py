"""Whether a structure stands under its dead loads, and on which side of a load factor it holds."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.coupling.claims.dead_loads import prove_dead_loads
from lacore.limit.conversion import point_in_program
from lacore.limit.stability import stability_of
from lacore.program.certificate import certify
from lacore.program.kinematic import associated_contact, dimensionless
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Standing, Status
from lacore.solvers.backend import InnerSolution
from tests.frame_problems import DOWN
from tests.lacore.limit.test_span_hinges import PROPPED, beam
from tests.lacore.models import deformable_block, obstacle, square
from tests.lacore.whole.test_random_walls import random_wall
from tests.rigid_problems import wall
from tests.shares import one_in

BAR = 1e-6  # of `solve`
SLOPE = 0.5  # rad
C, S = np.cos(SLOPE), np.sin(SLOPE)


def on_slope(mu, live, weight=1.0, unit=1.0):
    """A block of a weight on a slope, pushed by alpha times a force in weights."""

    def placed(corners):
        return [(unit * (C * x - S * y), unit * (S * x + C * y)) for x, y in corners]

    rectangle = la.masonry.rectangle
    blocks = {"base": placed(rectangle(-5, 5, -1, 0)), "block": placed(rectangle(-1, 1, 0, 0.5))}
    return la.Problem(
        bodies={"blocks": la.BlockAssembly(blocks, friction=mu)},
        supports=[la.Fix("blocks", "base")],
        reference_loads=[la.PointForce("blocks", "block", tuple(weight * np.array(live)))],
        dead_loads=[la.PointForce("blocks", "block", (0, -weight))],
    )


def slides(mu, live):
    """Load factors that a block on a slope carries, by hand: ``|t| <= mu n``, no toppling.

    n = W (cos - alpha live.normal), down the slope t = W (sin + alpha live.down).
    """
    normal, down = np.dot(live, (-S, C)), np.dot(live, (-C, -S))
    ends = []
    for sign in (1, -1):  # sign t <= mu n
        slope, room = sign * down + mu * normal, mu * C - sign * S
        ends.append((-np.inf if slope < 0 else np.inf, room / slope))
    low = max([value for side, value in ends if side < 0], default=-np.inf)
    high = min([value for side, value in ends if side > 0], default=np.inf)
    return low, high


@pytest.mark.parametrize(
    ("live", "side"),
    [
        ((-C, -S), "below"),  # down the slope: only a pull up holds it
        ((C, S), "below"),  # up: held from a load on, pushed up by a larger one
        ((S - 0.1 * C, -C - 0.1 * S), "above"),  # into it, a little down: slides below, holds above
        ((-1, 0), "below"),
        ((1, 0), "below"),
    ],
)
@pytest.mark.parametrize("unit", [1.0, 1e-3])
def test_a_block_on_a_slope_that_is_too_steep(live, side, unit):
    state = la.solve(on_slope(0.3, live, weight=unit, unit=unit))
    found, (low, high) = state.stability(), slides(0.3, live)
    assert found.standing is Standing.FALLS
    assert [found.low, found.high] == pytest.approx([low, high], rel=1e-6)
    assert found.side == side
    assert min(abs(state.load_factor - end) for end in (low, high)) <= 1e-6 * abs(state.load_factor)


@pytest.mark.parametrize("live", [(1, 0), (-1, 0), (0, 1)])
def test_the_same_block_on_a_rougher_slope_stands(live):
    state = la.solve(on_slope(0.7, live))
    found = state.stability()
    assert found.standing is Standing.STANDS
    assert [found.low, found.high] == pytest.approx(slides(0.7, live), rel=1e-6)
    assert found.side == "below"
    assert state.certify(point=found.point).equilibrium <= BAR


def test_a_locked_load_does_not_make_it_stand():
    """Straight into the slope: any larger load holds, none below it does."""
    live = (S, -C)
    state = la.solve(on_slope(0.3, live))
    assert state.status is Status.LOCKED
    found = state.stability()
    assert found.standing is Standing.FALLS
    assert [found.low, found.high] == pytest.approx(slides(0.3, live), rel=1e-6)
    assert found.low == pytest.approx((S - 0.3 * C) / 0.3, rel=1e-6)
    assert found.high == np.inf


def test_solve_warns_of_a_load_factor_that_is_no_safe_limit():
    def kinds(problem):
        return {own.kind for own in la.solve(problem).findings}

    assert kinds(on_slope(0.3, (-1, 0))) == {Kind.NEGATIVE}
    assert kinds(on_slope(0.3, (S - 0.1 * C, -C - 0.1 * S))) == {Kind.MINIMUM_HOLDING_LOAD}
    assert not kinds(on_slope(0.7, (1, 0)))


def test_print_says_it():
    text = str(la.solve(on_slope(0.3, (-1, 0))).stability())
    assert "falls" in text
    assert "-0.2116" in text
    assert "stands" in str(la.solve(wall("wall-1")).stability())


def column(weight, friction=None):
    """A unit square of k = 1 under its own weight; a vertical cut when it is held at its base."""
    held = {"supports": [la.Fix("block", "bottom")]}
    if friction is not None:
        held = {"interfaces": [obstacle(friction=friction)]}
    return la.Problem(
        bodies={"block": square(n=4)},
        reference_loads=[la.Traction("block", "right", (1, 0))],
        dead_loads=[la.BodyForce("block", (0, -weight))],
        **held,
    )


@pytest.mark.parametrize("weight", [1e-6, 1.0, 1.99])
def test_a_column_that_carries_its_weight_at_any_section_stands(weight):
    """Uniaxial stress at the base, 2 k by yield: a column of no more weight is a lower bound."""
    state = la.solve(column(weight, la.SMOOTH))
    found = state.stability()
    assert found.standing is Standing.STANDS
    sigma = state.certify(point=found.point)
    assert max(sigma.equilibrium, sigma.yield_violation, sigma.cone) <= BAR


@pytest.mark.parametrize("weight", [4.1, 40.0])
def test_a_column_that_is_too_heavy_falls(weight):
    """A wedge that slides at 45 degrees: ``W/2 cos 45 > k sqrt 2`` from a weight of 4 k on."""
    state = la.solve(column(weight))
    assert state.status is Status.UNSAFE
    found = state.stability()
    assert found.standing is Standing.FALLS
    assert np.isnan([found.low, found.high]).all()


def test_without_dead_loads_it_stands_and_nothing_is_solved():
    state = la.solve(
        la.Problem(
            bodies={"block": square()},
            supports=[la.Fix("block", "bottom")],
            reference_loads=[la.Traction("block", "top", (1, 0))],
        )
    )
    stands = replace(state, backend="highs").stability()  # which could not solve it
    assert (stands.standing, stands.low, stands.high) == (Standing.STANDS, 0, state.load_factor)


def test_a_state_of_a_regularised_backend_is_judged_by_an_exact_one():
    found = la.solve(deformable_block(0.5), backend="newton").stability()
    assert (found.standing, found.low, found.high, found.side) == (Standing.STANDS, 0, 0, "")


def test_without_friction_an_arch_falls_and_with_it_stands():
    arch = spreading(0.7)
    assert la.solve(arch).stability().standing is Standing.STANDS
    assert la.solve(arch, coupling="frictionless").stability().standing is Standing.FALLS


@pytest.mark.parametrize("seed", one_in(3, range(6)))
def test_two_backends_agree_on_what_is_carried(seed):
    problem, _ = random_wall(seed)
    found = [la.solve(problem, backend=name).stability() for name in ("clarabel", "highs")]
    assert found[0].standing is found[1].standing is Standing.STANDS


@pytest.mark.parametrize(
    ("intensity", "standing"),
    [(11.6, Standing.STANDS), (11.8, Standing.UNDECIDED), (12.1, Standing.FALLS)],
)
def test_moments_inside_members_count(intensity, standing):
    """A propped cantilever with a node midway carries w L^2/M_p = 6 + 4 sqrt 2 = 11.657.

    Its hinges at nodes alone would carry 12: what stands by them only is not proven to.
    """
    load = la.Traction("beam", "beam", (0, -intensity / 9))
    problem = beam(PROPPED, nodes={"mid": (1.5, 0)}, loads=[la.PointForce("beam", "mid", DOWN)])
    problem = replace(problem, dead_loads=[load])
    d = la.discretise(problem)
    found = stability_of(d, "clarabel", {}, "certified", BAR, np.nan)
    if standing is Standing.STANDS:  # by moments that are one choice of many
        assert found.standing in (Standing.STANDS, Standing.UNDECIDED)
    else:
        assert found.standing is standing
    if standing is Standing.UNDECIDED:
        assert "nodes where they peak" in str(found)


# What is proven is proven by residuals, whatever a solver says.


def proof(problem, solver_of=None):
    d = la.discretise(problem)
    program = dimensionless(d.program, d.natural)
    backend = la.find_backend("clarabel")

    def prepare(p):
        solver = backend.prepare(p, backend.Options())
        return solver if solver_of is None else solver_of(solver)

    return d, program, prove_dead_loads(program, associated_contact(program.contact), prepare, BAR)


def test_the_mechanism_of_a_fall_takes_less_power_than_the_dead_load_has():
    _, program, found = proof(on_slope(0.3, (1, 0)))
    u = found.mechanism.velocity
    assert found.equilibrium is None
    assert program.dead_load @ u == pytest.approx(1, rel=1e-9)
    slip, opening = program.contact.slip(u)[:, 0], program.contact.opening(u)
    assert (opening >= 0.3 * np.abs(slip) - 1e-7 * np.abs(u).max()).all()  # associated


def test_what_is_carried_is_in_equilibrium():
    _, program, found = proof(deformable_block(0.5))
    seen = certify(program, found.equilibrium)
    assert max(seen.equilibrium, seen.yield_violation, seen.cone) <= BAR
    assert found.equilibrium.load_factor == 0
    assert found.residual == max(seen.equilibrium, seen.yield_violation, seen.cone)


class Spoiling:
    """A solver whose answer is changed on its way."""

    def __init__(self, solver, change):
        self.solver, self.change = solver, change

    def solve(self, contact):
        answer = self.solver.solve(contact)
        return replace(answer, point=self.change(answer.point))

    def close(self):
        self.solver.close()


@pytest.mark.parametrize(
    "change",
    [
        lambda p: replace(p, normal_reaction=0.9 * p.normal_reaction),
        lambda p: replace(p, tangential_reaction=-p.tangential_reaction),
        lambda p: replace(p, load_factor=1.01 * p.load_factor),
        lambda p: replace(p, normal_reaction=np.nan * p.normal_reaction),
        lambda p: None,
    ],
    ids=["lighter", "friction downhill", "share", "NaN", "nothing"],
)
def test_reactions_that_do_not_carry_prove_nothing(change):
    _, _, found = proof(on_slope(0.7, (1, 0)), lambda solver: Spoiling(solver, change))
    assert found.equilibrium is None
    assert found.mechanism is None
    assert np.isnan(found.residual)


@pytest.mark.parametrize(
    "change",
    [
        lambda p: replace(p, velocity=-p.velocity),  # into the slope
        lambda p: replace(p, velocity=0 * p.velocity),
        lambda p: replace(p, velocity=np.roll(p.velocity, 1)),
    ],
    ids=["reversed", "rest", "another motion"],
)
def test_motions_that_are_no_fall_prove_nothing(change):
    _, _, found = proof(on_slope(0.3, (1, 0)), lambda solver: Spoiling(solver, change))
    assert found.equilibrium is None
    assert found.mechanism is None


def test_a_fall_that_takes_more_power_than_it_gives_is_none():
    """The mechanism of a column twice as heavy proves nothing of this one."""
    _, _, heavy = proof(column(8.0))
    fall = heavy.mechanism.velocity

    def change(point):
        return replace(point, load_factor=0.0, velocity=np.append(fall, 0.0))

    _, _, found = proof(column(1.0), lambda solver: Spoiling(solver, change))
    assert found.equilibrium is None
    assert found.mechanism is None


class Silent:
    """A solver that fails."""

    def solve(self, contact):
        return InnerSolution(Status.FAILED, "silent", 0, 0.0, None)

    def close(self):
        pass


def test_nothing_is_decided_without_an_answer():
    _, _, found = proof(on_slope(0.3, (1, 0)), lambda _: Silent())
    assert found.equilibrium is found.mechanism is None


def test_the_state_of_a_fall_reads_back():
    """In SI units: the power of the dead loads is 1 W."""
    problem = on_slope(0.3, (1, 0), weight=2e3, unit=3.0)
    state = la.solve(problem)
    fall = state.stability().point
    d = state.discretisation
    assert d.full.dead_load @ fall.velocity == pytest.approx(1, rel=1e-9)
    inside = point_in_program(d, fall)
    back = d.free_basis @ inside.velocity * d.natural.velocity
    assert back == pytest.approx(fall.velocity, abs=1e-12 * np.abs(fall.velocity).max())


# A structure that is unsafe keeps what falls.


def spreading(mu=0.3):
    """An arch on so little friction that it spreads."""
    return la.Problem(
        bodies={"arch": la.masonry.arch(9, 1.0, 0.25, mu)},
        supports=[la.Fix("arch", ("left", "right"))],
        reference_loads=[la.BodyForce("arch", (1, 0))],
        dead_loads=[la.BodyForce("arch", (0, -1))],
    )


@pytest.mark.parametrize("backend", ["clarabel", "highs"])
def test_an_unsafe_state_shows_what_falls(backend):
    """The crown goes down, and the dead load gains the 1 W that the mechanism is normalised to."""
    state = la.solve(spreading(), backend=backend)
    assert state.status is Status.UNSAFE
    assert np.isnan(state.load_factor)
    body = state.discretisation.assemblies["arch"].body
    u = state.velocity["arch"]
    assert -float(body.area @ u[1]) == pytest.approx(1, rel=1e-9)
    crown = np.argmax(body.centroid[1])
    assert u[1, crown] < 0
    assert not state.certify().holds(BAR)  # no limit state: there is no load factor


def test_its_picture_says_so_and_shows_what_drives_it():
    figure = la.solve(spreading()).plot()
    text = " ".join(
        [figure.get_suptitle()]
        + [entry.get_text() for axes in figure.axes for entry in axes.get_legend().get_texts()]
    )
    assert "under the dead loads alone" in text
    assert "dead load" in text
    assert "live load" not in text


def test_what_is_unsafe_by_a_continuum_shows_its_mechanism():
    state = la.solve(column(5.0))
    top = state.discretisation.continua["block"].nodes[1] == 1
    assert (state.velocity["block"][1, top] < 0).all()
    power = sum(
        float(state.dissipation[name] @ d.volumes)
        for name, d in state.discretisation.continua.items()
    )
    assert 0.5 < power < 1  # of 1 W: the discrete column falls from 3.9 k on or so


@pytest.mark.parametrize("weight", [1e-2, 1e-6])
def test_a_light_block_that_falls_beside_a_heavy_one_is_seen(weight):
    """Judged by its own weight: of the heavy one's it would be out of balance by nothing."""
    problem = on_slope(0.3, (1, 0))
    rectangle = la.masonry.rectangle
    blocks = dict(problem.bodies["blocks"].polygons)
    blocks |= {"floor": rectangle(20, 40, -1, 0), "heavy": rectangle(25, 26, 0, 1)}
    beside = la.Problem(
        bodies={"blocks": la.BlockAssembly(blocks, friction=0.3)},
        supports=[la.Fix("blocks", ("base", "floor"))],
        reference_loads=[la.PointForce("blocks", "heavy", (1, 0))],
        dead_loads=[
            la.PointForce("blocks", "heavy", (0, -1)),
            la.PointForce("blocks", "block", (0, -weight)),
        ],
    )
    assert la.solve(beside).stability().standing is Standing.FALLS
