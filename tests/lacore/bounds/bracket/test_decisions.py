"""Decisions of a bracket on bounds and meshes that are made up."""

import time
from dataclasses import replace
from math import inf, nan
from types import SimpleNamespace

import numpy as np
import pytest

import lacore as la
from lacore.bounds import constants
from lacore.bounds.bracket import asking, marking, refine
from lacore.bounds.bracket.bracket import Bracket, crossing, proven
from lacore.bounds.bracket.same_domain import difference
from lacore.bounds.bracket.track import Track
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Status
from tests.lacore.models import CRITERION, deformable_block, punch

SOLVED, LOCKED, UNSAFE = Status.SOLVED, Status.LOCKED, Status.UNSAFE


@pytest.fixture(scope="module")
def bounds():
    """A block that slides, 1.6 from either side."""
    stated = deformable_block(la.Tresca(0.4))
    return la.lower_bound(stated), la.upper_bound(stated)


def test_only_bounds_that_hold_can_cross(bounds):
    """A side that is missing is no bound, whatever its number says."""
    lower, upper = bounds
    above = replace(lower, load_factor=2 * upper.load_factor)
    found = crossing(above, upper)
    assert found is not None
    assert found.values["lower"] == above.load_factor
    assert found.values["upper"] == upper.load_factor
    for one, other in (
        (replace(above, status=Status.NOT_CERTIFIED), upper),
        (above, replace(upper, status=Status.NOT_CERTIFIED)),
    ):
        assert crossing(one, other) is None
    assert proven(None, -inf) == -inf
    assert proven(lower, nan) == lower.load_factor
    assert np.isnan(proven(replace(lower, status=LOCKED), nan))


def test_round_off_of_a_rigid_motion_is_no_crossing(bounds):
    """Strains of what moves as rigid are round-off of its speed, not of its small load factor."""
    lower, upper = bounds
    above = replace(lower, load_factor=upper.load_factor * (1 + 1e-8))
    assert crossing(above, upper) is not None
    fast = replace(upper, velocity=1e6 * upper.velocity)
    assert crossing(above, fast) is None


def refining(**more):
    given = {"best": {}, "failures": {}, "absent": {}, "coulomb": False} | more
    solver = SimpleNamespace(backend="clarabel")
    own = SimpleNamespace(**given, solver=solver, _tell=lambda *_: None)
    own._ask_whether_any = lambda kind, problem: refine._Run._ask_whether_any(own, kind, problem)
    return own


def made_up(load_factor, status=SOLVED):
    return SimpleNamespace(
        load_factor=load_factor, status=status, unanswered=lambda backend: f"no answer of {backend}"
    )


def kept(own, kind, *found):
    for bound in found:
        asked = SimpleNamespace(kind=kind, problem=punch(2, 2))
        refine._Run._keep(own, asked, bound)
    return own.best[kind].load_factor


@pytest.mark.parametrize(("kind", "best"), [("lower", 3.0), ("upper", 1.0)])
def test_the_best_bound_is_kept_whatever_comes_later(kind, best):
    own = refining()
    failed = made_up(9.0 if kind == "lower" else -9.0, Status.NOT_CERTIFIED)
    assert kept(own, kind, made_up(2.0), made_up(1.0), made_up(3.0), failed) == best
    assert own.failures[kind] == "no answer of clarabel"
    assert kept(own, kind, made_up(2.0)) == best
    assert own.failures[kind] is None
    assert kept(refining(), kind, failed, made_up(2.0)) == 2.0


@pytest.mark.parametrize(
    ("kind", "status", "fails"),
    [
        ("lower", UNSAFE, False),
        ("lower", LOCKED, True),
        ("upper", LOCKED, False),
        ("upper", UNSAFE, True),
    ],
)
def test_meshes_with_too_few_elements_are_no_failure(kind, status, fails):
    own = refining()
    kept(own, kind, made_up(nan, status))
    assert (own.failures[kind] is not None) == fails
    assert not own.absent


@pytest.mark.parametrize(
    ("kind", "status", "other", "absent"),
    [
        ("lower", UNSAFE, UNSAFE, True),
        ("lower", UNSAFE, SOLVED, False),
        ("upper", LOCKED, LOCKED, True),
        ("upper", LOCKED, SOLVED, False),
    ],
)
def test_friction_may_leave_no_bound_on_any_mesh(monkeypatch, kind, status, other, absent):
    """Frictionless bodies that fall, and associated ones that lock, as the other side proves."""
    asked = []

    def answer(side):
        return lambda problem, backend, *more: (
            asked.append((side, backend, *more)) or made_up(0, other)
        )

    monkeypatch.setattr(refine, "solve", answer("lower"))
    monkeypatch.setattr(refine, "lower_bound", answer("upper"))
    own = refining(coulomb=True)
    kept(own, kind, made_up(nan, status))
    assert (kind in own.absent) == absent
    assert asked == [(kind, "clarabel", *(("associated",) if kind == "lower" else ()))]
    kept(own, kind, made_up(1.0))
    assert len(asked) == 1


def test_shares_of_soil_vanish_where_shear_is_constant():
    """Zero of equal rates; of rates that cancel, their whole dissipation."""
    weights = np.array([1.0, 2.0, 1.0, 2.0])
    group = SimpleNamespace(
        weights=weights, dim=2, strength_at=lambda mean: np.array([1.0, 3.0, 2.0, 2.0])
    )
    same = np.array([[3.0, 4.0]] * 2)
    opposite = np.array([[2.0, 0.0], [-1.0, 0.0]])  # weighted they cancel
    rates = np.concatenate([same, opposite])
    shares = marking._varying(group, rates, np.zeros(4), 2)
    assert shares == pytest.approx([0.0, 2.0 * (2.0 + 2.0)])


def test_parts_add_up_to_one():
    assert marking._parts(np.array([1.0, 3.0])) == pytest.approx([0.25, 0.75])
    assert marking._parts(np.zeros(2)).tolist() == [0.0, 0.0]


@pytest.mark.parametrize(
    ("geometries", "polygonal"), [(["exact"] * 2, False), (["exact", "approximated"], True)]
)
def test_one_curved_outline_makes_a_bracket_one_of_a_polygon(geometries, polygonal):
    bodies = {str(i): SimpleNamespace(geometry=own) for i, own in enumerate(geometries)}
    continua = {name: SimpleNamespace(body=body) for name, body in bodies.items()}
    upper = SimpleNamespace(discretisation=SimpleNamespace(continua=continua))
    assert Bracket.polygonal.fget(SimpleNamespace(upper_bound=upper)) == polygonal


def test_processors_are_those_that_the_process_may_use(monkeypatch):
    monkeypatch.setattr(asking.os, "sched_getaffinity", lambda _: {0, 5, 7}, raising=False)
    assert asking.processors() == 3
    monkeypatch.delattr(asking.os, "sched_getaffinity")
    monkeypatch.setattr(asking.os, "cpu_count", lambda: 6)
    assert asking.processors() == 6
    monkeypatch.setattr(asking.os, "cpu_count", lambda: None)
    assert asking.processors() == 1


def run_with(lower=None, upper=None, **more):
    best = {"lower": lower, "upper": upper}
    given = {"target": 0.1, "coulomb": False, "pressure_dependent": False} | more
    return refine._Run(
        bodies=["soil"],
        solver=None,
        begin=0.0,
        max_elements=1000,
        on_step=None,
        best={kind: made_up(own) for kind, own in best.items() if own is not None},
        **given,
    )


def test_a_bound_may_lose_a_quarter_of_the_width_that_is_expected():
    """As a load factor; of the target where less than that is expected, of zero next to nothing."""
    run = run_with(9.0, 11.0)
    assert (run.lower, run.upper, run.size) == (9.0, 11.0, 11.0)
    assert run.width == pytest.approx(0.2)
    assert run._asked("lower", None, 0.2).affordable == pytest.approx(0.25 * 0.2 * 11)
    assert run._asked("lower", None, 0.01).affordable == pytest.approx(0.25 * 0.1 * 11)
    about_zero = run_with(-1.0, 1.0)
    assert about_zero._asked("upper", None, 0.2).affordable == pytest.approx(0.25 * 1e-3 * 0.1)
    assert run_with()._asked("upper", None, np.inf).affordable == np.inf


@pytest.mark.parametrize("soil", [False, True])
@pytest.mark.parametrize("kind", ["lower", "upper"])
def test_solvers_are_asked_for_a_share_of_the_width(kind, soil):
    """In proportion to the width while it is small, and sharper for soils."""
    run = run_with(0.99, 1.0, target=1e-4, pressure_dependent=soil)
    one, ten = (run._asked(kind, None, own).tolerance for own in (1e-3, 1e-2))
    assert ten == pytest.approx(10 * one)
    assert one == pytest.approx(1e-3 * (1e-3 if not soil else {"lower": 1e-4, "upper": 3e-6}[kind]))
    assert run._asked(kind, None, 1e9).tolerance == constants.LOOSEST_TOLERANCE
    sharper = run_with(0.99, 1.0, target=1e-4, pressure_dependent=soil, sharper={kind: 0.5})
    assert sharper._asked(kind, None, 1e-2).tolerance == pytest.approx(ten / 2)
    stays_wide = run_with(0.1, 1.0, target=1e-4, pressure_dependent=soil, coulomb=True)
    assert stays_wide._asked(kind, None, 1e-2).tolerance <= one


@pytest.mark.parametrize(
    ("lower", "upper", "unsigned"),
    [
        (-1.0, 1.0, True),
        (0.0, 0.0, True),
        (1e-9, 1.0, True),
        (-1.0, -1e-9, True),
        (1e-3, 1.0, False),
        (-1.0, -1e-3, False),
        (None, 1.0, False),
        (-1.0, None, False),
    ],
)
def test_the_sign_of_a_load_factor_is_known_where_zero_is_outside(lower, upper, unsigned):
    assert run_with(lower, upper).unsigned == unsigned


def test_without_a_proven_bound_there_is_no_size_and_no_crossing():
    run = run_with()
    assert (run.lower, run.upper, run.width, run.size) == (-inf, inf, inf, inf)
    assert run_with(-3.0).size == 3.0
    assert not run_with(2.0, 1.0).crossed  # numbers that are no bounds of either kind
    assert run.natural == 1.0


@pytest.mark.parametrize(("top", "expected"), [(CRITERION, False), (la.MohrCoulomb(1, 20), True)])
def test_one_soil_makes_a_bracket_pressure_dependent(monkeypatch, top, expected):
    def run(bodies, pressure_dependent, *more):
        seen.append((bodies, pressure_dependent))
        raise KeyboardInterrupt

    seen = []
    monkeypatch.setattr(refine, "_Run", run)
    bodies = {
        name: la.Body(la.meshes.rectangle((0, 1), (y, y + 1), 1, 1), own)
        for name, y, own in (("low", -1, CRITERION), ("top", 0, top))
    }
    problem = la.Problem(
        bodies,
        [la.Traction("top", "top", (1, 0))],
        [la.Fix("low", "bottom")],
        [la.Interface(("top", "bottom"), ("low", "top"), la.BOND)],
    )
    with pytest.raises(KeyboardInterrupt):
        la.bracket(problem, 0.1)
    assert seen == [(["low", "top"], expected)]


def test_lengths_of_boundaries_that_differ_are_in_metres():
    mesh = la.meshes.rectangle((0, 10), (0, 10), 2, 2)
    half = {"top": lambda x: (x[1] == 10) & (x[0] <= 5)}
    other = mesh.with_boundaries(half)
    why = difference(la.Body(mesh, CRITERION), la.Body(other, CRITERION))
    assert why == "its boundary 'top' lies elsewhere (lengths 5 and 10)"


def test_boundaries_without_names_are_elsewhere_only_by_their_outline():
    """Names that one mesh lacks are no difference."""
    mesh = la.meshes.rectangle((0, 10), (0, 10), 2, 2)
    plain = type(mesh)(mesh.p, mesh.t)
    for one, other in ((mesh, plain), (plain, mesh), (plain, plain)):
        assert difference(la.Body(one, CRITERION), la.Body(other, CRITERION)) == ""


@pytest.mark.parametrize("coulomb", [False, True])
def test_growths_count_what_refinement_can_gain(monkeypatch, coulomb):
    """The part of the width that refinement of the open tracks does not remove."""
    asked = []

    def growths(tracks, missing, order, apart):
        asked.append((len(tracks), missing, apart))
        return [1.0] * len(tracks)

    monkeypatch.setattr(refine, "growths", growths)
    monkeypatch.setattr(refine, "order", lambda seen: 1.0)
    run = run_with(9.0, 11.0, coulomb=coulomb)
    tracks = [SimpleNamespace(rest=0.3), SimpleNamespace(rest=0.1)]
    run.growths(tracks, [0])
    run.growths(tracks, [0, 1])
    run.growths([SimpleNamespace(rest=inf), tracks[1]], [0])
    width = 2.0
    first = 1 - 0.3 / width if coulomb else 0.25
    both = 1 - 0.4 / width if coulomb else 0.0
    assert [own[0] for own in asked] == [1, 2, 1]
    assert [own[2] for own in asked] == pytest.approx([first, both, 0.0])
    assert asked[0][1] == pytest.approx(run.width / 0.1)


def track(**changes):
    given = {"late": 0, "too_fine": False, "kinds": ("lower", "upper"), "gains": (), "rests": ()}
    return SimpleNamespace(**(given | changes))


@pytest.mark.parametrize(
    ("bounds", "tracks", "ending"),
    [
        ((9.0, 11.0), [track()], None),
        ((9.9, 10.1), [track()], la.Ending.REACHED),
        ((9.0, 11.0), [track(late=500)], la.Ending.TIME_LIMIT),
        ((-1e-5, 1e-5), [track()], la.Ending.ZERO),
        ((-1.0, 1e-5), [track()], None),  # one side alone is next to zero
        ((5e-5, 9e-5), [track()], None),  # small, and of a sign that is known
        ((9.0, 11.0), [track(too_fine=True)], la.Ending.MAX_ELEMENTS),
        ((9.0, 11.0), [track(too_fine=True), track()], None),
        ((9.0, 11.0), [track(gains=(1.0, 0, 0, 0, 0))], la.Ending.NO_PROGRESS),
        ((9.0, 11.0), [track(gains=(0, 0, 0))], None),
        ((9.0, 11.0), [track(gains=(0, 0, 0, 0.1))], None),
    ],
)
def test_a_bracket_ends_for_one_reason(bounds, tracks, ending):
    """Load factors next to zero are zero only where their sign is unknown."""
    assert run_with(*bounds).ending(tracks) is ending


@pytest.mark.parametrize(("coulomb", "rest", "settled"), [(True, 0.2, True), (False, 0.2, False)])
def test_friction_may_keep_bounds_apart_for_good(coulomb, rest, settled):
    """A quarter of the target, 0.1 of 11, is left to gain on either end at most."""
    run = run_with(9.0, 11.0, coulomb=coulomb)
    assert (run.closed(track(rests=(rest,) * constants.RECENT)) is la.Ending.SETTLED) == settled
    assert run.closed(track(rests=(rest, *(0.3,) * (constants.RECENT - 1)))) is None
    assert run.closed(track(rests=(rest,) * (constants.RECENT - 1))) is None


def test_a_failure_ends_a_bracket_unless_a_bound_was_found_before():
    run = run_with(9.0, 11.0)
    run.failures["upper"] = "no answer"
    assert run.ending([track()]) is None
    run.best["upper"] = made_up(nan, Status.NOT_CERTIFIED)
    assert run.ending([track()]) is la.Ending.NO_BOUND
    run.failures.clear()
    run.absent["lower"] = run.absent["upper"] = "none on any mesh"
    assert run.ending([track()]) is la.Ending.NO_BOUND


@pytest.mark.parametrize(
    ("ending", "changes", "kinds"),
    [
        (la.Ending.REACHED, [{"too_fine": True}], []),
        (la.Ending.MAX_ELEMENTS, [{"too_fine": True}], [Kind.BOUNDS_STOPPED]),
        (
            la.Ending.TIME_LIMIT,
            [{"kinds": ("lower",)}, {"kinds": ("upper",), "late": 500}],
            [Kind.BOUND_STOPPED, Kind.BOUND_STOPPED],
        ),
    ],
)
def test_sides_that_stopped_short_of_the_target_are_reported(bounds, ending, changes, kinds):
    """With their elements and reasons; where the target is reached there is nothing to report."""
    run = run_with()
    run.best = dict(zip(("lower", "upper"), bounds, strict=True))
    found = run.found(ending, [track(elements=128, **own) for own in changes])
    assert found.status is ending
    assert (found.lower, found.upper) == tuple(own.load_factor for own in bounds)
    assert [own.kind for own in found.stops] == kinds
    assert [own.where for own in found.stops] == [
        own.get("kinds", ("lower", "upper")) for own in changes[: len(kinds)]
    ]
    for own, change in zip(found.stops, changes, strict=False):
        assert own.values["elements"] == 128
        why = own.values["why"]
        if change.get("late"):
            assert (why.kind, why.values["elements"]) == (Kind.NEXT_SOLVE_LATE, 500)
        else:
            assert (why == la.Ending.MAX_ELEMENTS.label) == change.get("too_fine", False)
    assert not found.failures


@pytest.mark.parametrize("missing", [0, 1])
def test_a_side_without_a_bound_is_reported_as_failed(bounds, missing):
    run = run_with()
    kinds = ("lower", "upper")
    run.best = dict(zip(kinds, bounds, strict=True))
    run.best[kinds[missing]] = replace(bounds[missing], status=Status.NOT_CERTIFIED)
    run.failures = dict.fromkeys(kinds)
    run.solver = SimpleNamespace(backend="clarabel")
    found = run.found(la.Ending.NO_BOUND, [track(elements=128)])
    assert [(own.kind, own.where) for own in found.failures] == [
        (Kind.BOUND_FAILED, (kinds[missing],))
    ]


@pytest.mark.parametrize(("seconds", "late"), [(4.0, False), (6.0, True)])
def test_a_solve_that_takes_more_than_the_time_that_is_left_is_not_begun(seconds, late):
    """In proportion to the elements: 10 s are left, and the next mesh has twice as many."""
    finer = punch(4, 2)
    before = track(seconds=seconds, elements=finer.bodies["soil"].mesh.nelements / 2)
    run = run_with(9.0, 11.0)
    run.solver = SimpleNamespace(deadline=time.perf_counter() + 10)
    assert run.too_late(before, finer) == late


@pytest.mark.parametrize(
    ("allowed", "ending"), [(True, la.Ending.TIME_LIMIT), (False, la.Ending.MAX_ELEMENTS)]
)
def test_a_mesh_that_takes_too_long_or_is_too_fine_is_not_solved(allowed, ending):
    run = run_with(9.0, 11.0)
    finer = punch(4, 2)
    run.growths = lambda tracks, open_: [2.0]
    run.refined = lambda track, times: finer if allowed else None
    run.too_late = lambda track, problem: True
    run.solved = lambda moves: [] if not moves else pytest.fail("it was solved")
    (after,) = run.advanced([Track(("lower", "upper"), punch(2, 2))])
    assert after.late == (finer.bodies["soil"].mesh.nelements if allowed else 0)
    assert after.too_fine != allowed
    assert run.ending([after]) is ending
