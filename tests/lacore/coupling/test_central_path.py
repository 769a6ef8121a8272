"""The Coulomb problem of blocks as complementarity problem, and paths to its solutions (T79)."""

from contextlib import contextmanager
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import lacore as la
from lacore.coupling.blocks import central_path as of_blocks
from lacore.coupling.blocks.central_path import (
    Path,
    _stepped,
    along_path,
    by_places,
    central_path,
)
from lacore.coupling.blocks.complementarity import Complementarity, poses
from lacore.coupling.blocks.matrix import _parity
from lacore.coupling.certified import averaged
from lacore.coupling.freezing import associated
from lacore.coupling.options import CouplingOptions
from lacore.coupling.run import Run
from lacore.coupling.steps import alternate, mean, static_alone
from lacore.numerics.linear_algebra import SingularError
from lacore.program.kinematic import associated_contact, dimensionless
from lacore.reporting.status import Status
from lacore.solvers.backend import find_backend, read_options
from lacore.solvers.inner.preparing import preparer
from tests.coulomb_checker import accepts, residuals
from tests.lacore.planted import sliding
from tests.rigid_problems import incline
from tests.statements import stated

BAR = 1e-6


def pushed(blocks, held, down):
    way = (1,) + (0,) * (len(down) - 1)
    return la.Problem(
        {"blocks": blocks},
        [la.BodyForce("blocks", way)],
        [la.Fix("blocks", held, "xyz" if len(down) == 3 else "xy")],
        dead_loads=[la.BodyForce("blocks", down)],
    )


def wall(wide, courses, every, mu=0.65):
    rows = la.masonry.regular_bond(wide, courses, la.masonry.windows(wide, courses, every))
    return pushed(la.masonry.running_bond(rows, friction=mu), "base", (0, -1))


def dome(meridians=6, rings=3, friction=0.5, joints=None):
    blocks = la.masonry3d.dome(meridians, rings, 1.0, 0.15, 0.3, friction)
    if joints is not None:
        blocks = replace(blocks, joint_friction=joints)
    base = tuple(name for name in blocks.names if name.startswith("base"))
    return pushed(blocks, base, (0, 0, -1))


@contextmanager
def started(problem):
    """A loop that has solved the associated problem."""
    stated = la.discretise(problem)
    program = dimensionless(stated.program, stated.natural)
    engine = find_backend("clarabel")
    prepare = preparer(engine, read_options(engine, {}))
    solver = prepare(program)
    run = Run(program, solver, False, CouplingOptions(), lambda _: None, prepare)
    run.solve("associated", associated(program).contact)
    yield run
    solver.close()


@pytest.fixture(scope="module", params=["wall", "dome", "mortar"])
def run(request):
    """In the plane, in space, and with cohesion beside friction."""
    given = {
        "wall": lambda: wall(3, 6, 3),
        "dome": partial(dome, 5, 2),
        "mortar": lambda: dome(5, 2, la.Coulomb(0.5, adhesion=0.01)),
    }
    with started(given[request.param]()) as own:
        yield own


def inside(run, product=0.01):
    problem = Complementarity(run.program)
    powers = np.full(run.program.contact.count, product)
    return problem, problem.start(run.iterates[0].inner.point, powers)


def test_the_start_is_inside_and_all_its_powers_are_equal(run):
    problem, z = inside(run)
    pressed, (along, across) = problem.products(z)
    assert problem.off(z, problem.residual(z)) <= 1e-9  # inf outside
    # Friction is within 1e-12 of what bisection looks for, 1e-3 or more from its bound.
    assert pressed == pytest.approx(0.01, rel=1e-9)
    assert along == pytest.approx(0.01, rel=1e-9)
    assert np.abs(across).max() <= 1e-11


def test_the_start_is_the_closest_one_to_its_state(run):
    """With r, force per velocity, ``p - r s = p0 - r N u0`` and ``q - r v = q0 - r T u0``.

    These are the normals of the curves of constant power at the place next to the state.
    """
    problem, z = inside(run)
    state, rows, rough = run.iterates[0].inner.point, run.program.contact, problem.rough
    p0 = rows.weights * state.normal_reaction
    q0 = (rows.weights[:, None] * state.tangential_reaction)[rough]
    ratio = np.abs(p0[rough]).max() / np.abs(state.velocity).max()
    p, q, s, _, v, u, alpha = problem.parts(z)
    assert p - ratio * s == pytest.approx(p0 - ratio * rows.opening(u), abs=1e-9 * p0.max())
    # Friction is bisected to 1e-12 of its bound, and slip is its reciprocal distance from there.
    aim = q0 - ratio * rows.slip(u)[rough]
    assert np.abs(q - ratio * v - aim).max() <= 1e-6 * p0.max()
    assert (u == state.velocity).all()
    assert alpha == state.load_factor


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_a_start_without_normal_reactions_is_inside(run, share):
    """Adhesion may carry the load alone; their size was the only measure of forces."""
    found = run.iterates[0].inner.point
    reactions = 0 * found.normal_reaction, share * found.tangential_reaction
    point = replace(found, normal_reaction=reactions[0], tangential_reaction=reactions[1])
    problem = Complementarity(run.program)
    with np.errstate(all="raise", under="ignore"):
        z = problem.start(point, np.full(run.program.contact.count, 0.01))
    assert problem.off(z, problem.residual(z)) <= 1e-9


def test_newton_solves_the_linearised_equations(run):
    """What a step leaves of equations that are linear but for products is its own products."""
    problem, z = inside(run)
    right = np.random.default_rng(0).standard_normal(problem.residual(z).size)
    step = problem.linear(z).solve(right)
    left = problem.residual(z + step) - problem.residual(z) - right
    dp, _, ds, *_ = problem.parts(step)
    (x, q), (r, v) = problem.rates(step)
    own = dp * ds, x * r + np.sum(q * v, axis=1), x[:, None] * v + r[:, None] * q
    own = np.concatenate([np.ravel(part) for part in own])
    left[-own.size :] -= own
    size = max(np.abs(problem.residual(z + step)).max(), np.abs(right).max())
    assert np.abs(left).max() <= 1e-9 * size  # round-off, of a condition of some 1e5


def dense(problem, z):
    """The derivative by columns: central differences are exact, as equations are quadratic."""
    ways = np.eye(z.size)
    return np.column_stack(
        [(problem.residual(z + way) - problem.residual(z - way)) / 2 for way in ways]
    )


def test_signs_are_those_of_the_determinant(run):
    """Against dense ones, at places whose matrices differ: both signs change alike."""
    problem, z = inside(run)
    rng, signs, own = np.random.default_rng(1), [], []
    for _ in range(4):
        place = z.copy()
        _, _, s, r, v, *_ = problem.parts(place)
        s *= np.exp(3 * rng.standard_normal(s.size))  # speeds may be any
        factors = np.exp(3 * rng.standard_normal(r.size))
        r *= factors
        v *= factors[:, None]
        v += 0.9 * rng.uniform(-1, 1, v.shape) * (r - np.linalg.norm(v, axis=1))[:, None] / 2
        signs.append(np.linalg.slogdet(dense(problem, place))[0] * problem.linear(place).sign)
        own.append(problem.linear(place).sign)
    assert set(signs) == {signs[0]}


def test_changes_say_how_far_the_boundary_is(run):
    problem, z = inside(run)
    rng = np.random.default_rng(2)
    for _ in range(5):
        step = z * rng.standard_normal(z.size)
        change = problem.changes(z, step)
        assert change.least < 0 < change.most
        # Relative to its own products what is inside is off by less than infinity, what is not is.
        aim = problem.residual(z)
        for share, within in ((1 - 1e-6, True), (1 + 1e-6, False)):
            assert np.isfinite(problem.off(z - share / change.least * step, aim)) == within
        # An eigenvalue of a cone is at most its length, and the vector has all of them.
        assert max(-change.least, change.most) <= np.linalg.norm(change.vector) * (1 + 1e-12)


def test_parity():
    rng = np.random.default_rng(0)
    for size in (1, 2, 5, 8):
        order = rng.permutation(size)
        assert _parity(order) == round(np.linalg.det(np.eye(size)[order]))


@pytest.mark.parametrize(("mu", "slope"), [(0.5, 0.6), (0.3, 1.0), (0.8, 0.3)])
def test_the_path_ends_at_the_closed_form(mu, slope):
    """C2c: a block pushed up an incline."""
    with started(incline(mu, slope)) as run:
        found = central_path(run, run.iterates[0].inner.point)
    assert found is not None
    factor = found.inner.point.load_factor * run.program.scales.load_factor
    power = mu * np.tan(slope)  # the error of alpha is 1/(1 - lambda) times that of the gap (T15)
    assert factor == pytest.approx(np.tan(slope + np.arctan(mu)), rel=10 * BAR / (1 - power))


@pytest.mark.parametrize("spread", [0.01, 0.3])
def test_paths_certify_walls_and_domes(run, spread):
    start = run.iterates[0].inner.point
    found = along_path(run, start, spread, np.random.default_rng(0))
    assert found.kind == "path"
    assert found.inner.status is Status.SOLVED
    assert found.certificate.holds(BAR)
    assert 0 < found.inner.point.load_factor <= start.load_factor * (1 + BAR)


@pytest.mark.parametrize("law", [0.0, la.Tresca(0.1)])
def test_joints_without_coulomb_friction_may_be_among_others(law):
    with started(dome(joints={("base1", "r1m1"): law})) as run:
        assert not run.program.contact.coulomb.all()
        found = central_path(run, run.iterates[0].inner.point)
        assert found is not None
        assert run.proven(found)


@pytest.mark.slow
def test_the_path_certifies_a_wall_whose_alternation_stalls():
    with started(wall(8, 40, 3)) as run:
        start = run.iterates[0].inner.point
        run.options = CouplingOptions(max_iterations=12)
        assert averaged(run, start) is None
        run.options = CouplingOptions()
        found = central_path(run, start)
        assert found is not None
        assert run.proven(found)
        assert run.iterates[-1].kind == "path"
        assert found.inner.point.load_factor <= start.load_factor * (1 + BAR)


def test_steps_from_a_place_certify_a_wall_that_steps_alone_do_not(monkeypatch):
    """Those from the associated state stall, as `averaged` on the same wall below."""
    with started(wall(8, 40, 3)) as run:
        start = run.iterates[0].inner.point
        assert by_places(run, start) is None  # not of a wall as small as this
        monkeypatch.setattr(of_blocks, "_LARGE", 0)
        found = by_places(run, start)
        assert found is not None
        assert run.proven(found)
        first, *others = run.iterates[1:]
        assert first.kind == "path"
        assert first.inner.native_status == "on its way"
        assert not run.proven(first)
        assert {one.kind for one in others} <= {"K", "S"}


def recorded(monkeypatch, answer):
    """Whose reactions K- and S-steps freeze, and whether they led to a state."""
    calls = []

    def alternate(run, static, kind, patience, blend):
        found = answer(run, static, kind, patience, blend)
        calls.append((blend, found is not None))
        return found

    monkeypatch.setattr(of_blocks, "alternate", alternate)
    return calls


def test_from_pairs_that_are_nearly_proven_steps_go_on(monkeypatch):
    """Means of both steps stay at a gap of 1.3e-3 on this wall, below ten tolerances."""
    calls = recorded(monkeypatch, alternate)
    with started(wall(12, 30, 3)) as run:
        run.options = CouplingOptions(tolerance=2e-4)
        found = _stepped(run, iter(run.iterates[:1]))
        assert run.proven(found)
    assert calls[0] == (mean, False)
    assert calls[-1][1]
    assert calls[1][0] is static_alone


@pytest.mark.parametrize(("bars", "more"), [(11, 0), (9, 1)])
def test_they_do_so_once_from_each_pair_that_is_near(monkeypatch, bars, more):
    calls = recorded(monkeypatch, lambda *_: None)
    with started(wall(3, 6, 3)) as run:
        monkeypatch.setattr(of_blocks, "least_gap", lambda _: bars * run.options.tolerance)
        assert _stepped(run, iter(2 * run.iterates)) is None
    assert [blend for blend, _ in calls] == [mean, *(static_alone, mean) * more, mean]


def test_the_loop_begins_with_a_place_on_large_walls(monkeypatch):
    problem = wall(3, 6, 3)
    usual = la.solve(problem, coupling="certified")
    monkeypatch.setattr(of_blocks, "_LARGE", 0)
    large = la.solve(problem, coupling="certified")
    assert list(usual.history["kind"])[:2] == ["associated", "K"]
    assert list(large.history["kind"])[:2] == ["associated", "path"]
    assert large.status is Status.SOLVED


def test_walls_in_space_have_no_places(monkeypatch):
    monkeypatch.setattr(of_blocks, "_LARGE", 0)
    with started(dome(4, 2)) as run:
        assert by_places(run, run.iterates[0].inner.point) is None
        assert len(run.iterates) == 1


def test_places_that_lead_nowhere_end(monkeypatch):
    """Each stop is tried once, then others have their turn."""
    monkeypatch.setattr(of_blocks, "_LARGE", 0)
    monkeypatch.setattr(of_blocks, "alternate", lambda *_: None)
    with started(wall(3, 6, 3)) as run:
        assert by_places(run, run.iterates[0].inner.point) is None
        assert [one.kind for one in run.iterates[1:]] == ["path"] * len(of_blocks._STOPS)


def test_a_path_goes_on_from_where_it_stopped(run):
    program, start = run.program, run.iterates[0].inner.point
    given = program, start, np.ones(program.contact.count), BAR, np.inf
    contact = associated_contact(program.contact)
    whole = Path(*given).solve(contact)
    stopping = Path(*given, stops=((0.1, 1000), (0.0, 1000)))
    parts = [stopping.solve(contact) for _ in range(2)]
    assert [part.native_status for part in parts] == ["on its way", "end"]
    assert [part.status for part in parts] == [Status.ALMOST_SOLVED, Status.SOLVED]
    assert sum(part.iterations for part in parts) == whole.iterations
    assert (parts[-1].point.velocity == whole.point.velocity).all()


def path(run, end=BAR, time_limit=np.inf):
    ones = np.ones(run.program.contact.count)
    own = Path(run.program, run.iterates[0].inner.point, ones, end, time_limit)
    return own.solve(associated_contact(run.program.contact))


def test_the_same_path_each_time(run):
    first, again = path(run), path(run)
    assert first.status is Status.SOLVED
    assert first.iterations == again.iterations
    assert (first.point.velocity == again.point.velocity).all()


def test_a_path_keeps_to_its_time_and_says_so(run):
    short = path(run, time_limit=1e-9)
    assert short.status is Status.ALMOST_SOLVED
    assert short.native_status == "limit of time"
    assert short.iterations == 1


@pytest.mark.parametrize(("most", "paths"), [(1, 1), (2, 2)])
def test_lost_paths_are_followed_by_others_as_long_as_there_is_budget(monkeypatch, most, paths):
    monkeypatch.setattr(of_blocks, "_MOST", 1)  # each is lost at its start
    monkeypatch.setattr(of_blocks, "_ALL", most)
    monkeypatch.setattr(of_blocks, "alternate", lambda *_: None)
    with started(dome(4, 2)) as run:
        assert central_path(run, run.iterates[0].inner.point) is None
    assert [one.kind for one in run.iterates[1:]] == ["path"] * paths


def test_only_blocks_without_dilation_and_of_finite_friction_are_taken(run):
    assert poses(run.program)
    rows = run.program.contact
    nothing, many = np.zeros(rows.count), np.full(rows.count, np.inf)
    for change in ({"coefficient": nothing}, {"dilatancy": 0.1 + nothing}, {"limit": many}):
        assert not poses(replace(run.program, contact=replace(rows, **change)))
    closing = replace(rows, closing=0.1 + nothing)
    assert not poses(replace(run.program, contact=closing))
    assert not poses(sliding()[0].program)  # its body deforms, and has the same friction


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wide", "courses", "every", "mu"), [(12, 30, 3, 0.65), (12, 30, 4, 0.65), (16, 60, 5, 0.45)]
)
def test_tall_walls_pass_the_independent_check(wide, courses, every, mu):
    problem = wall(wide, courses, every, mu)
    state = la.solve(problem, coupling="certified")
    assert state.status is la.Status.SOLVED, state.message
    s = stated(problem, state, mu)
    assert accepts(s), residuals(s)


def test_a_start_keeps_the_difference_of_reactions_and_openings(run):
    """Each per its largest: their product is given, and nothing else of the state changes."""
    state, rows = run.iterates[0].inner.point, run.program.contact
    problem, z = inside(run)
    p, _, s, *_, u, alpha = problem.parts(z)
    pressed = rows.weights * state.normal_reaction
    size, speed = np.abs(pressed).max(), np.abs(state.velocity).max()
    expected = pressed / size - rows.opening(state.velocity) / speed
    assert p / size - s / speed == pytest.approx(expected, abs=1e-9)
    assert np.array_equal(u, state.velocity)
    assert float(alpha[0]) == state.load_factor


def test_a_path_begins_at_the_associated_state(run, monkeypatch):
    """Not at the state that the loop has reached, unless there is no other one."""
    asked = []
    monkeypatch.setattr(of_blocks, "_ends", lambda run, start: iter(asked.append(start) or ()))
    first = run.iterates[0].inner.point
    assert of_blocks.central_path(run, "static") is None
    assert asked == [first]
    without = replace(run.iterates[0], inner=replace(run.iterates[0].inner, point=None))
    of_blocks.central_path(replace(run, iterates=[without]), "static")
    assert asked[1] == "static"


@pytest.mark.parametrize("name", ["normal_reaction", "velocity"])
def test_a_state_without_forces_or_motion_starts_no_path(run, name):
    start = run.iterates[0].inner.point
    nothing = replace(start, **{name: 0 * getattr(start, name)})
    ones = np.ones(run.program.contact.count)
    answer = Path(run.program, nothing, ones, BAR, np.inf).solve(None)
    assert answer.point is None
    assert answer.native_status == "no start"


def test_there_is_no_derivative_outside_of_the_cones(run):
    problem, z = inside(run)
    outside = z.copy()
    outside[0] = -outside[0]
    with pytest.raises(SingularError, match="as flat as round-off"):
        problem.linear(outside)
    assert problem.off(outside, problem.residual(z)) == np.inf
