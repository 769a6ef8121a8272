"""lacore's own interior point: statuses and values of Clarabel, and residuals recomputed."""

from dataclasses import replace
from itertools import product, zip_longest

import numpy as np
import pytest
from scipy.sparse import csr_matrix

import lacore as la
from lacore.assembly.discretise import discretise
from lacore.numerics.linear_algebra import SuperLU
from lacore.program.certificate import certify
from lacore.program.kinematic import associated_contact, dimensionless
from lacore.program.reduction import reduced
from lacore.reporting.status import Status
from lacore.solvers.backend import find_backend
from lacore_backends import interior_point
from lacore_backends._embedding import follow as way
from lacore_backends._embedding.arrays import Translation
from lacore_backends._embedding.dilating import as_moved
from lacore_backends._embedding.follow import judged, residuals
from lacore_backends._embedding.least import least_program
from lacore_backends._embedding.loops import plain
from lacore_backends._embedding.place import Place
from lacore_backends._embedding.rigid import motions
from lacore_backends._goal import Goal
from lacore_backends.interior_point import InteriorPoint
from lacore_verification.catalogue import catalogue
from lacore_verification.fuzz.programs.drawn import draw_program
from lacore_verification.fuzz.programs.judge import ask
from tests.backends import hand_made
from tests.lacore.models import punch, square
from tests.lacore.random_programs import (
    CONES,
    POINTS,
    N,
    frozen,
    random_program,
    random_soil,
    random_step,
)

BAR = 1e-6  # residuals, of certificates: a hundred tolerances of 1e-8
# Where a shift or hardening rounds the minimum, the load factor is a slope: the root of the gap.
ROUND = 1e-4
KINDS = ("friction", "dilatant and shifted", "step", "sticking", "rigid")


def stated(kind, seed):
    """A random program, and its frozen contact."""
    rng, program = np.random.default_rng(1000 + seed), random_program(seed)
    bound = rng.uniform(0, 2, POINTS) * (rng.uniform(size=POINTS) > 0.3)
    match kind:
        case "friction":
            return program, frozen(bound)
        case "dilatant and shifted":
            dilatancy = rng.uniform(0, 1, POINTS) * (rng.uniform(size=POINTS) > 0.3)
            return program, frozen(bound, dilatancy, rng.uniform(0, 0.3, POINTS))
        case "step":
            program = random_step(seed)
            return program, frozen(bound, 0.0, program.contact.lead)
        case "sticking":
            light = replace(program, dead_load=0.1 * program.dead_load)
            stuck = np.where(rng.uniform(size=POINTS) > 0.6, np.inf, bound)
            return light, frozen(stuck, rng.uniform(0, 0.5, POINTS))
        case _:
            rigid = replace(program, groups=())
            return rigid, frozen(bound, rng.uniform(0, 1, POINTS))


def answer(name, program, contact):
    backend = InteriorPoint() if name == "interior_point" else find_backend(name)
    solver = backend.prepare(program, backend.Options())
    found = solver.solve(contact)
    solver.close()
    return found


def check(kind, seed):
    program, contact = stated(kind, seed)
    own, other = (answer(name, program, contact) for name in ("interior_point", "clarabel"))
    assert own.status is other.status, (kind, seed)
    if own.status is Status.SOLVED:
        assert certify(program, own.point, contact).holds(BAR)
        slope = ROUND if kind in KINDS[1:3] else BAR
        known = other.point.load_factor
        assert own.point.load_factor == pytest.approx(known, rel=slope, abs=slope)


@pytest.mark.parametrize("kind", KINDS)
def test_random_programs_end_as_with_clarabel(kind):
    for seed in range(5):
        check(kind, seed)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_many_random_programs_end_as_with_clarabel(kind):
    for seed in range(5, 45):
        check(kind, seed)


@pytest.fixture(scope="module")
def smooth():
    d = la.discretise(punch(8, 4, rough=False))
    program = dimensionless(d.program, d.natural)
    return program, associated_contact(program.contact)


def test_a_punch_has_the_load_factor_of_clarabel(smooth):
    own, other = answer("interior_point", *smooth), answer("clarabel", *smooth)
    assert own.status is Status.SOLVED
    assert certify(smooth[0], own.point, smooth[1]).holds(BAR)
    assert own.point.load_factor == pytest.approx(other.point.load_factor, rel=BAR)


def ended(asked, monkeypatch):
    """Where a program and its contact end."""
    places = []

    def remembering(place, goal, power):
        places.append(place)
        return judged(place, goal, power)

    monkeypatch.setattr(way, "judged", remembering)
    answer("interior_point", *asked)
    return places[-1]


@pytest.fixture
def last(smooth, monkeypatch):
    """Where the punch ends."""
    return ended(smooth, monkeypatch)


def test_residuals_know_forces_out_of_balance(last):
    """A thousandth more stress leaves a thousandth of the power unbalanced, and not much more."""
    at = last.at
    more = replace(at, stresses=tuple(1.001 * z for z in at.stresses))
    assert residuals(last, 1.0)[1] <= BAR
    # Of their power a hundredth counts, as certificates allow.
    assert 1e-5 <= residuals(Place(at.conic, more), 1.0)[1] <= 1e-3


@pytest.mark.parametrize("part", ["equal", "stresses", "velocity"])
def test_what_is_no_number_has_no_name(last, part):
    """Forces of a pressure that is no number were none, beside a gap that is zero."""
    goal, at = Goal(BAR, 1, np.inf), last.at
    assert judged(last, goal, 1.0) == "solved"
    known = getattr(at, part)
    lost = tuple(np.nan * x for x in known) if isinstance(known, tuple) else np.nan * known
    assert judged(Place(at.conic, replace(at, **{part: lost})), goal, 1.0) == ""


@pytest.mark.slow
def test_nodal_forces_that_add_up_are_not_called_balanced():
    # A block slides between dead pressure and friction, mu p b / h = 2: out of balance by 3e-7 of
    # its loads at each of a thousand nodes, and all of them one way, it was solved at 1.99967.
    sliding, variants = catalogue.find("deformable-block")
    state = la.solve(sliding.problem(variants[0], "medium"), backend="interior_point")
    solved = state.status is Status.SOLVED
    assert not solved or state.load_factor == pytest.approx(2, rel=10 * BAR)


def test_without_pardiso_the_answer_is_the_same(smooth, monkeypatch):
    own = answer("interior_point", *smooth)
    monkeypatch.setattr(interior_point, "symmetric_solver", lambda **_: SuperLU())
    other = answer("interior_point", *smooth)
    assert other.status is Status.SOLVED
    assert other.point.load_factor == pytest.approx(own.point.load_factor, rel=BAR)


def test_without_numba_the_answer_is_the_same(smooth, monkeypatch):
    own = answer("interior_point", *smooth)
    monkeypatch.setattr(interior_point, "best_loops", lambda: plain)
    other = answer("interior_point", *smooth)
    assert other.status is Status.SOLVED
    assert other.point.load_factor == pytest.approx(own.point.load_factor, rel=BAR)


def soil(kind, seed):
    """Random soils of several planes, or of one, with flow that dilates besides, or hardening."""
    rng, program = np.random.default_rng(1000 + seed), random_soil(seed)
    (group,) = program.groups
    contact = frozen(rng.uniform(0, 2, POINTS))
    if kind == "several planes":
        return program, contact
    light = replace(program, dead_load=0.1 * program.dead_load)
    if kind == "hardening":
        hardening = replace(group, modulus=rng.uniform(0, 2, CONES))
        return replace(light, groups=(hardening,)), contact
    planes = replace(
        group.surfaces,
        slope=rng.uniform(0.01, 0.9, (CONES, 1, 1)),
        strength=group.surfaces.strength[:, :1],
        normed=np.ones(1),
        dilation=rng.uniform(-0.1, 0.1, CONES),
    )
    alone = replace(group, volumetric=group.volumetric[:CONES], surfaces=planes)
    return replace(light, groups=(alone,)), contact


def check_soil(kind, seed):
    program, contact = soil(kind, seed)
    own, other = (answer(name, program, contact) for name in ("interior_point", "clarabel"))
    # Beside surfaces hardening chooses between velocities, and flow of an apex is not certified.
    doubted = own.status is Status.ALMOST_SOLVED and kind == "hardening"
    assert own.status is other.status or doubted, (kind, seed)
    if own.status is Status.SOLVED:
        # With what dilates besides a certificate has nothing to do: an unknown that moves so has.
        assert certify(*as_moved(program, own.point), contact).holds(BAR)
    if own.status.has_point:
        known = other.point.load_factor
        assert own.point.load_factor == pytest.approx(known, rel=ROUND, abs=ROUND)


SOILS = ("several planes", "one plane", "hardening")


@pytest.mark.parametrize("kind", SOILS)
def test_random_soils_end_as_with_clarabel(kind):
    for seed in range(5):
        check_soil(kind, seed)


@pytest.mark.slow
@pytest.mark.parametrize("kind", SOILS)
def test_many_random_soils_end_as_with_clarabel(kind):
    for seed in range(5, 45):
        check_soil(kind, seed)


@pytest.mark.parametrize("angle", [0.1, 30.0])
def test_a_biaxial_test_of_soil_has_its_closed_form(angle):
    """Between smooth platens: ``2 c cos(phi)/(1 - sin(phi))``, at the least friction as well."""
    soil = la.MohrCoulomb(cohesion=1.0, friction_angle=angle)
    problem = la.Problem(
        bodies={"soil": la.Body(square(2).mesh, soil)},
        supports=[
            la.Fix("soil", "bottom", components="y"),
            la.Fix("soil", "left", components="x"),
        ],
        reference_loads=[la.Traction("soil", "top", (0, -1))],
    )
    state = la.solve(problem, "interior_point")
    phi = np.radians(angle)
    assert state.status is Status.SOLVED
    exact = 2 * np.cos(phi) / (1 - np.sin(phi))
    assert state.load_factor == pytest.approx(exact, rel=BAR)


def test_slip_that_dilates_where_nothing_opens_is_none():
    """The corner of a wall is held across it: its cone has no inside, and there it stalled."""
    program, rng = random_program(3), np.random.default_rng(3)
    rows = program.contact
    normal = csr_matrix(rows.normal.multiply([[0.0], [1.0], [1.0]]))
    program = replace(
        program,
        contact=replace(rows, normal=normal),
        dead_load=0.1 * program.dead_load,
    )
    for shift in (0.0, rng.uniform(0.1, 0.3, POINTS)):
        contact = frozen(rng.uniform(0, 1, POINTS), 0.5, shift)
        own, other = (answer(name, program, contact) for name in ("interior_point", "clarabel"))
        assert own.status is Status.SOLVED
        assert certify(program, own.point, contact).holds(BAR)
        known = other.point.load_factor
        assert own.point.load_factor == pytest.approx(known, rel=ROUND, abs=ROUND)


def test_bodies_that_move_as_they_are_have_unknowns_of_their_own():
    """A body that slides strains by round-off: what it slides on was lost beside its stiffness."""
    rigid = draw_program("two bodies", 1, 1, 300).program
    found = motions(rigid, SuperLU())
    for group in rigid.groups:
        strained = group.rows @ found.basis[:, found.own]
        assert np.abs(strained.toarray()).max() <= 1e-10 * np.abs(group.rows.data).max()
    stated = found.stated(rigid)
    q = np.random.default_rng(1).normal(size=rigid.n)
    u = found.basis @ q
    assert stated.plastic_dissipation(q) == pytest.approx(rigid.plastic_dissipation(u), rel=1e-9)
    assert stated.contact.opening(q) == pytest.approx(rigid.contact.opening(u), rel=1e-9, abs=1e-12)
    assert stated.dead_load @ q == pytest.approx(rigid.dead_load @ u, rel=1e-9)
    assert np.linalg.matrix_rank(found.basis.toarray()) == rigid.n


def test_a_body_that_is_held_has_no_such_motion(smooth):
    assert motions(smooth[0], SuperLU()) is None
    held = draw_program("body and blocks", 1, 1, 300).program  # the body, that is
    assert held.contact.count
    assert motions(held, SuperLU()) is None


@pytest.mark.parametrize(
    ("family", "place"),
    [("two bodies", 1), ("plane strain", 5), ("hardening", 7), ("soil from below", 1)],
)
def test_loads_that_nothing_resists_are_zero(family, place):
    """Per load factor what is left of forces never vanishes: it ended at its limit, or stalled."""
    drawn = draw_program(family, 1, place, 300)
    found = ask(InteriorPoint(), drawn, {})
    assert found.solved
    assert found.holds


def test_a_load_of_zero_is_no_answer_where_dead_loads_are_out_of_balance():
    # Blocks of a millionth of the strength under them: 1.5e-5 of their weight was left.
    drawn = draw_program("body and blocks", 3, 7, 2300)
    assert np.any(drawn.program.dead_load)
    found = ask(InteriorPoint(), drawn, {})
    certificate = certify(drawn.program, found.answer.point, drawn.contact)
    assert not found.solved or certificate.equilibrium <= BAR


def test_what_ends_at_round_off_is_solved_if_ten_tolerances_are_left(smooth, monkeypatch):
    program, contact = smooth
    options = replace(InteriorPoint.Options(), tolerance=1e-7)
    whole = InteriorPoint().prepare(program, options).solve(contact)
    words = set()
    for most in range(whole.iterations - 3, whole.iterations):
        solver = InteriorPoint().prepare(program, replace(options, max_iterations=most))
        found = solver.solve(contact)
        words.add(found.native_status)
        if found.status is Status.SOLVED:
            # A certificate may be a hundred tolerances off.
            assert certify(program, found.point, contact).holds(1e-5)
    assert "iteration limit" in words
    assert words <= {"iteration limit", "solved to round-off", "almost solved"}


def test_all_loops_are_compiled_before_a_solve():
    """Within one they counted to its time limit: on a busy machine the first solve ended there."""
    compiled = pytest.importorskip("lacore_backends._embedding.loops.compiled")
    InteriorPoint().prepare(*least_program()[:1], InteriorPoint.Options()).close()
    names = ("compliances", "cones", "matrices", "principal", "products", "steps")
    files = [getattr(compiled, name) for name in names]
    every = [(name, own) for file in files for name, own in vars(file).items()]
    # Those that others call alone are kept with them.
    public = [own for name, own in every if not name.startswith("_")]
    loops = [own for own in public if hasattr(own, "signatures")]
    assert loops
    assert all(own.signatures for own in loops)
    known = [own.signatures for own in loops]
    program, contact = random_program(1), frozen(1.0, 0.5, 0.1)
    answer("interior_point", program, contact)
    answer("interior_point", random_soil(1), frozen(1.0))
    assert [own.signatures for own in loops] == known


@pytest.mark.parametrize("changed", ["bound", "dilatancy", "shift"])
def test_solves_one_after_the_other_are_fresh_ones(changed):
    """What is kept of the last contact is the pattern of its rows, where they are the same.

    Of one point nothing opens: there the sign of a shift says which rows there are.
    """
    program = random_program(0)
    rows = program.contact
    normal = csr_matrix(rows.normal.multiply([[0.0], [1.0], [1.0]]))
    program = replace(
        program, contact=replace(rows, normal=normal), dead_load=0.1 * program.dead_load
    )
    given = {"bound": 1.0, "dilatancy": 0.3, "shift": 0.1}
    contacts = [frozen(**{**given, changed: value}) for value in (0.5, 0.7, 0.0, [0.5, 0.0, 0.1])]
    solver = InteriorPoint().prepare(program, InteriorPoint.Options())
    for contact in contacts:
        again, fresh = solver.solve(contact), answer("interior_point", program, contact)
        assert again.status is fresh.status is Status.SOLVED
        assert again.point.load_factor == pytest.approx(fresh.point.load_factor, rel=BAR)
    solver.close()
    made = [Translation(program, contact, plain) for contact in contacts]
    rows = [[kind.matrix.toarray() for kind in one.conic.kinds] for one in made]
    for (one, own), (contact, others) in product(
        zip(made, rows, strict=True), zip(contacts, rows, strict=True)
    ):
        same = [np.array_equal(a, b) for a, b in zip_longest(own, others)]
        assert one.alike(contact) == all(same)


def test_a_step_that_hardens_steeply_is_not_locked():
    """By 1e4 strengths at the speed of the load, which then is as large."""
    program, contact = stated("step", 0)
    (group,) = program.groups
    program = replace(program, groups=(replace(group, modulus=1e4 * group.modulus),))
    own, other = (answer(name, program, contact) for name in ("interior_point", "clarabel"))
    assert own.status is other.status is Status.SOLVED
    assert own.point.load_factor == pytest.approx(other.point.load_factor, rel=ROUND)


def test_small_nodal_forces_that_are_all_out_of_balance_count(monkeypatch):
    """A thousandth more of a load that is spread over many nodes: of its power a hundredth."""
    problem = la.Problem(
        bodies={"block": square(8)},
        supports=[la.Fix("block", "bottom")],
        reference_loads=[la.BodyForce("block", (1.0, 0.0))],
    )
    program = discretise(problem).program
    load = np.abs(program.reference_load)
    assert load.max() < load.sum() / 200
    place = ended((program, associated_contact(program.contact)), monkeypatch)
    more = replace(place.at, load=1.001 * place.at.load)
    # It works 1e-3 of the power at the speed of the load, and more where nodes outrun it.
    assert residuals(Place(place.conic, more), 1.0)[1] > 0.99e-2 * 1e-3


@pytest.mark.parametrize("share", [1 - 1e-5, 1.01])
def test_dead_loads_next_to_collapse_are_borne_or_not(share):
    """A clamped beam, its load in the middle; what pulls up and down beside it holds neither."""
    beam = hand_made.clamped_beam(hand_made.mid_load)
    dead = share * 8 * hand_made.M_P / hand_made.LENGTH * beam.reference_load
    across = np.array([0.0, 1.0, 0.0, 0.0, 0.0, -1.0, 0.0])
    program = replace(beam, reference_load=across, dead_load=dead)
    found = answer("interior_point", program, hand_made.NO_CONTACT)
    assert found.status is (Status.SOLVED if share < 1 else Status.UNSAFE)


def test_time_that_is_over_is_a_status(smooth):
    options = replace(InteriorPoint.Options(), time_limit=1e-9)
    solver = InteriorPoint().prepare(smooth[0], options)
    found = solver.solve(smooth[1])
    solver.close()
    assert found.status is Status.TIME_LIMIT
    assert found.iterations == 0


def test_the_least_program_has_a_load():
    program, contact = least_program()
    found = answer("interior_point", program, contact)
    assert found.status is Status.SOLVED
    assert certify(program, found.point, contact).holds(BAR)


def test_what_is_held_all_over_is_locked():
    """Strong bodies are asked as rigid ones, and those may have no motion: it ended in an error."""
    program = reduced(replace(random_program(1), groups=()), csr_matrix((9, 0)))
    assert answer("interior_point", program, frozen(1.0)).status is Status.LOCKED


def test_a_load_that_is_none_is_locked():
    """No velocity has a power of it, as Clarabel says; it was divided by."""
    program = replace(random_program(1), reference_load=np.zeros(N))
    for name in ("interior_point", "clarabel"):
        assert answer(name, program, frozen(1.0)).status is Status.LOCKED


def test_strengths_that_no_number_holds_end_in_a_status():
    """Squares of rows overflow, where the method begins: it ended in an error."""
    program = random_program(1)
    (group,) = program.groups
    large = replace(program, groups=(replace(group, rows=1e200 * group.rows),))
    with np.errstate(over="ignore"):
        assert answer("interior_point", large, frozen(1.0)).status is Status.FAILED
