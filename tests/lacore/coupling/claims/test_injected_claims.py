"""Claims that are wrong in exactly one way are refused."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from scipy.spatial.transform import Rotation

import lacore as la
from lacore.coupling.claims import dead_collapse as collapses
from lacore.coupling.claims import locking_ray as rays
from lacore.coupling.claims.dead_collapse import DeadCollapse, dead_collapse
from lacore.coupling.claims.dead_loads import _mechanism_residual, prove_dead_loads
from lacore.coupling.claims.locking_ray import LockingRay, _judged, locking_ray
from lacore.program.free_motion import without_dissipation
from lacore.program.kinematic import associated_contact, reaction_contact
from lacore.program.state import out_of_balance
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution
from lacore.solvers.inner.preparing import preparer_named
from tests.lacore.coupling.claims.test_claims import frozen, on_incline
from tests.lacore.coupling.claims.test_rays import in_a_box
from tests.lacore.model.bodies.blocks3d.solids import box
from tests.lacore.planted import MU, P0, on_free_unknowns, pushed_weight, sliding

TOLERANCE = 1e-6
FALLING = DeadCollapse(
    power=1.0, dissipated_share=0.5, felt=0.0, impossible=0.0, point=sliding()[1]
)


def test_a_mechanism_that_the_dead_load_drives_proves_a_collapse():
    assert FALLING.proves(TOLERANCE)


@pytest.mark.parametrize(
    "wrong",
    [
        {"dissipated_share": 1.0},  # as much is dissipated: the structure stands, just
        {"dissipated_share": 1.0 - TOLERANCE / 2},
        {"power": 1.0 + 2 * TOLERANCE},
        {"power": 1.0 - 2 * TOLERANCE},
        {"felt": 2 * TOLERANCE},
        {"impossible": 2 * TOLERANCE},
    ],
    ids=str,
)
def test_one_wrong_number_proves_no_collapse(wrong):
    assert not replace(FALLING, **wrong).proves(TOLERANCE)


def rising(opening):
    """A square pushed by mu times its weight: at load factor 0 it slides, and may rise."""
    d, state = sliding()
    problem = d.problem
    push = la.Traction("block", "top", (MU * P0, 0))
    program = la.discretise(replace(problem, dead_loads=[*problem.dead_loads, push])).program

    def field(x):
        return np.stack([np.ones_like(x[0]), np.full_like(x[0], opening)])

    return program, replace(state, velocity=on_free_unknowns(d, field), load_factor=0.0)


def test_sliding_that_lifts_a_weight_is_no_free_motion():
    """With associated friction it rises by mu: the push does all of the power of the weight.

    Nothing dissipates and the loads do no power together, but the square presses on its base.
    """
    program, state = rising(MU)
    contact = associated_contact(program.contact)
    assert abs(program.dead_load @ state.velocity) <= 1e-12
    assert not without_dissipation(program, state, contact, TOLERANCE)
    loose = replace(state, normal_reaction=0 * state.normal_reaction)
    assert without_dissipation(program, loose, contact, TOLERANCE)


LOCKED = LockingRay(residual=0.0, beyond=0.0, release=0.0, point=sliding()[1])


def test_reactions_that_carry_the_load_alone_prove_that_it_is_locked():
    assert LOCKED.proves
    assert replace(LOCKED, residual=1e-13, beyond=1e-13, release=0.999).proves


@pytest.mark.parametrize(
    "wrong",
    [{"residual": 1e-11}, {"beyond": 1e-11}, {"release": 1 - 1e-10}, {"release": 1.5}],
    ids=str,
)
def test_one_wrong_number_proves_no_locking(wrong):
    assert not replace(LOCKED, **wrong).proves


def pressed_on_a_slope(friction):
    """A unit block at 0.3 rad that is pressed by a vertical force: locked from tan 0.3 on."""
    return frozen(on_incline(0.3, friction, weight=1.0))


def test_a_locking_ray_is_judged_by_the_laws_of_the_problem():
    """Friction of 0.31 = tan(0.3) carries it; what 0.4 carries is beyond a cone of 0.2."""
    program, contact = pressed_on_a_slope(0.4)
    ray = locking_ray(program, contact)
    sizes = np.abs(program.reference_load)
    assert ray.proves
    assert _judged(program, contact, ray.point, sizes).proves
    weaker = _judged(*pressed_on_a_slope(0.2), ray.point, sizes)
    assert weaker.residual <= 1e-12
    assert weaker.beyond > 0.1
    assert not weaker.proves
    for name in ("normal_reaction", "tangential_reaction"):
        more = replace(ray.point, **{name: (1 + 1e-9) * getattr(ray.point, name)})
        other = _judged(program, contact, more, sizes)
        assert other.residual > 1e-12
        assert not other.proves


def test_a_locking_ray_needs_what_shifts_cannot_release():
    """A distance that closes by 1 per unit of the load's power is as much load factor."""
    program, contact = pressed_on_a_slope(0.4)
    ray = locking_ray(program, contact)
    pressed = float(program.contact.weights @ ray.point.normal_reaction)
    for share, proves in ((0.5, True), (1.5, False)):
        shift = np.full(program.contact.count, share / pressed)
        other = _judged(program, replace(contact, shift=shift), ray.point, np.ones(program.n))
        assert other.release == pytest.approx(share)
        assert other.proves == proves


def answering(change):
    """A solver whose answers are changed."""
    true = preparer_named("clarabel", {})

    def prepare(program):
        class Solver:
            def __init__(self):
                self._solver = true(program)

            def solve(self, contact):
                answer = self._solver.solve(contact)
                return replace(answer, point=change(answer.point))

            def close(self):
                self._solver.close()

        return Solver()

    return prepare


def stood(friction, change=lambda point: point):
    """Whether a block under its own weight stands on a slope of 0.3 rad."""
    program, contact = frozen(on_incline(0.3, friction, push=(1.0, 0.0), weight=2.0))
    return program, prove_dead_loads(program, contact, answering(change), TOLERANCE)


def test_a_block_carries_its_weight_on_a_slope_below_the_angle_of_friction():
    program, found = stood(0.4)
    assert found.mechanism is None
    rows, weight = program.contact, float(np.abs(program.dead_load).sum())
    point = found.equilibrium
    pressed, rubbed = (
        float(rows.weights @ own)
        for own in (point.normal_reaction, point.tangential_reaction[:, 0])
    )
    assert (pressed, abs(rubbed)) == pytest.approx((weight * np.cos(0.3), weight * np.sin(0.3)))
    assert not point.velocity.any()


def test_a_block_slides_down_a_slope_above_the_angle_of_friction():
    """Dilation of 0.2 on a slope of tan 0.31: it falls by the difference, and nothing is taken."""
    program, found = stood(0.2)
    assert found.equilibrium is None
    velocity = found.mechanism.velocity
    assert program.dead_load @ velocity == pytest.approx(1.0)
    slip, opening = program.contact.slip(velocity)[:, 0], program.contact.opening(velocity)
    assert np.all(opening >= 0.2 * np.abs(slip) * (1 - 1e-5))


def off(**changes):
    def change(point):
        fields = {name: factor * getattr(point, name) for name, factor in changes.items()}
        return replace(point, **fields)

    return change


@pytest.mark.parametrize(
    ("friction", "change"),
    [
        (0.4, off(normal_reaction=1.001)),
        (0.4, off(tangential_reaction=0.0)),
        (0.4, off(load_factor=0.9)),
        (0.2, off(velocity=-1.0)),
        (0.2, lambda point: replace(point, velocity=0 * point.velocity)),
    ],
)
def test_answers_that_are_wrong_prove_nothing(friction, change):
    found = stood(friction, change)[1]
    assert (found.equilibrium, found.mechanism) == (None, None)
    assert np.isnan(found.residual)


def test_a_mechanism_that_dissipates_the_dead_power_is_no_fall():
    """A block on a slope whose base has a limit of friction of just what pulls it down."""
    for share, falls in (
        (0.9, True),
        (1 - 2 * TOLERANCE, True),
        (1 - TOLERANCE / 2, False),
        (1.1, False),
    ):
        pull = 2.0 * np.sin(0.3)  # the base is 1 m long
        program, contact = frozen(on_incline(0.3, la.Tresca(share * pull), (1.0, 0.0), weight=2.0))
        along = stood(0.2)[1].mechanism  # some state, with the velocity of the slope
        direction = slide_of(program)
        falling = replace(along, velocity=direction / float(program.dead_load @ direction))
        residual = _mechanism_residual(program, contact, falling, TOLERANCE)
        assert (residual <= TOLERANCE) == falls


def slide_of(program):
    """The motion down the slope of a block: no opening, slip alike at both corners."""
    rows = program.contact
    matrix = np.vstack([rows.normal.toarray(), rows.tangential.toarray()])
    wanted = np.append(np.zeros(rows.count), np.ones(rows.count))
    motion = np.linalg.lstsq(matrix, wanted, rcond=None)[0]
    return motion * np.sign(program.dead_load @ motion)


@pytest.mark.parametrize("share", [0.3, 0.7, 0.95, 1.05, 3.0])
def test_a_base_carries_a_block_from_its_pull_on(share):
    """A limit of friction, of a share of what pulls a block down a slope: it falls below 1."""
    pull = 2.0 * np.sin(0.3)  # the base is 1 m long
    program, contact = frozen(on_incline(0.3, la.Tresca(share * pull), (1.0, 0.0), weight=2.0))
    found = prove_dead_loads(program, contact, preparer_named("clarabel", {}), TOLERANCE)
    assert (found.equilibrium is not None) == (share > 1)
    assert (found.mechanism is not None) == (share < 1)
    assert found.residual <= TOLERANCE
    if share < 1:  # its stresses carry that share of the dead load
        rubbed = program.contact.weights @ found.mechanism.tangential_reaction[:, 0]
        weight = float(np.abs(program.dead_load).sum())
        assert abs(rubbed) == pytest.approx(share * weight * np.sin(0.3), rel=1e-5)


@pytest.mark.parametrize("criterion", [la.VonMises(1.0), la.MohrCoulomb(1.0, 30)])
def test_a_locking_ray_calls_on_no_strength(criterion):
    """What yields at last carries no load without bound: a little shear is beyond."""
    program, contact = frozen(in_a_box(criterion))
    ray = locking_ray(program, contact)
    assert ray.proves
    (shear,), sizes = ray.point.stress, np.abs(program.reference_load)
    assert _judged(program, contact, ray.point, sizes).beyond <= 1e-12
    sheared = replace(
        ray.point,
        stress=(shear + np.array([0.0, 1e-3]),),
        mean_stress=(0 * ray.point.mean_stress[0],),
    )
    found = _judged(program, contact, sheared, sizes)
    assert found.beyond > 1e-6
    assert not found.proves


@pytest.mark.parametrize("share", [0.3, 0.9, 1.1, 1.9])
def test_a_collapse_is_proven_by_what_its_mechanism_dissipates(share):
    """A limit of friction takes its share of the power of the dead load; from 1 on none falls."""
    pull = 2.0 * np.sin(0.3)
    program, contact = frozen(on_incline(0.3, la.Tresca(share * pull), (0.0, 1.0), weight=2.0))
    still = replace(program, reference_load=across(program))
    found = dead_collapse(still, contact, preparer_named("clarabel", {}), TOLERANCE)
    assert (found is not None) == (share < 1)
    if found is not None:
        assert found.dissipated_share == pytest.approx(share, rel=1e-6)
        assert found.power == pytest.approx(1.0)
        assert found.felt <= TOLERANCE


def across(program):
    """A load that presses the block on its slope, which no slide along it feels."""
    return -np.asarray(program.contact.normal.sum(axis=0)).ravel()


@pytest.mark.parametrize("share", [0.5, 0.9, 1.2])
def test_a_column_is_crushed_by_its_weight_beyond_the_strength(share):
    """Pressed by 2 k per share: plastic flow takes that share of the power of the pressure."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    problem = la.Problem(
        {"b": la.Body(mesh, la.VonMises(1.0))},
        # Felt by no mechanism that keeps the volume of the column.
        [la.Pressure("b", side) for side in ("left", "right", "top")],
        [la.Fix("b", "bottom", "y"), la.Fix("b", "left", "x")],
        dead_loads=[la.Pressure("b", "top", 2.0 / share)],
    )
    program, contact = frozen(problem)
    found = dead_collapse(program, contact, preparer_named("clarabel", {}), TOLERANCE)
    assert (found is not None) == (share < 1)
    if found is not None:
        assert found.dissipated_share == pytest.approx(share, rel=1e-5)


@pytest.mark.parametrize(("reaction", "free"), [(1e-9, True), (1e-4, False), (1.0, False)])
def test_without_a_weight_what_rubs_at_all_resists(reaction, free):
    """Friction of 1e-4 of the strength is no round-off."""
    d, state = sliding()
    program = replace(d.program, dead_load=0 * d.program.dead_load)
    pressed = replace(
        state, normal_reaction=np.full(program.contact.count, reaction), load_factor=0.0
    )
    contact = reaction_contact(program.contact, pressed.normal_reaction)
    assert without_dissipation(program, pressed, contact, TOLERANCE) == free


def test_a_collapse_by_lines_needs_no_cones():
    """Of rigid blocks a linear program finds the mechanism where the solver has no answer."""

    def answerless(program):
        answer = InnerSolution(Status.FAILED, "", 0, 0.0, None)
        return SimpleNamespace(solve=lambda contact: answer, close=lambda: None)

    program, contact = frozen(on_incline(0.3, la.Tresca(0.3), (0.0, 1.0), weight=2.0))
    still = replace(program, reference_load=across(program))
    found = dead_collapse(still, contact, answerless, TOLERANCE)
    assert found.proves(TOLERANCE)
    assert found.dissipated_share == pytest.approx(0.3 / (2 * np.sin(0.3)))


def test_the_former_name_of_the_dissipated_share_warns_and_works():
    with pytest.warns(DeprecationWarning, match="dissipated_share"):
        assert FALLING.carried == FALLING.dissipated_share


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("share", [0.7, 1.4])
def test_proofs_of_dead_loads_do_not_depend_on_the_unit_of_forces(share, size):
    """A block on a slope whose base takes a share of what pulls it down."""
    pull = 2.0 * np.sin(0.3)
    program, contact = frozen(on_incline(0.3, la.Tresca(share * pull), (1.0, 0.0), weight=2.0))
    rows = program.contact
    other = replace(
        program,
        dead_load=size * program.dead_load,
        contact=replace(rows, limit=size * rows.limit),
    )
    scaled = replace(contact, bound=size * contact.bound)
    found = prove_dead_loads(other, scaled, preparer_named("clarabel", {}), TOLERANCE)
    state = found.equilibrium if share > 1 else found.mechanism
    weight = float(np.abs(other.dead_load).sum())
    assert state.load_factor == 0.0
    rubbed = rows.weights @ state.tangential_reaction[:, 0]
    assert abs(rubbed) == pytest.approx(min(share, 1) * weight * np.sin(0.3), rel=1e-5)
    assert found.residual <= TOLERANCE


@pytest.mark.parametrize("size", [-1.0, 0.0, 0.1, 1.0, 30.0])
@pytest.mark.parametrize("sign", [-1, 1])
def test_the_power_of_the_load_in_a_collapse_is_relative_to_the_velocity(size, sign):
    """A load along the slope feels all of the slide of the block, however fast it is."""
    push = sign * np.cos(0.3), sign * np.sin(0.3)
    program, contact = frozen(on_incline(0.3, la.Tresca(0.1), push, 2.0))
    driven, added = collapses._driven(program, contact)
    slide = size * slide_of(program)
    found = collapses._judged(program, driven, added, slide, np.inf)
    load, fastest = np.abs(program.reference_load).sum(), np.abs(slide_of(program)).max()
    expected = abs(program.reference_load @ slide_of(program)) / (load * fastest)
    assert expected > 0.1
    assert found.felt == pytest.approx(expected if size else 0.0)
    assert found.power == pytest.approx(size * float(program.dead_load @ slide_of(program)))
    # The load is a point that sticks, and slips by what the load feels.
    assert found.impossible == pytest.approx(found.felt)


def test_a_locking_ray_is_out_of_balance_by_a_share_of_all_forces_on_the_part(monkeypatch):
    """Forces that are too large by 1e-9, per sum of the sizes of loads and reactions."""
    program, contact = frozen(on_incline(0.0, la.Tresca(1.0)))
    carried = rays._carried
    monkeypatch.setattr(rays, "_carried", lambda *given: (1 + 1e-9) * carried(*given))
    found, rows = rays._from_edges(program, contact), program.contact
    load = program.reference_load
    pressed = rows.weights * found.point.normal_reaction
    forces = np.abs(load) + abs(rows.normal).T @ pressed
    assert found.residual == pytest.approx(1e-9 * np.abs(load).max() / forces.sum(), rel=1e-6)
    assert not found.proves


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("seed", range(3))
def test_multipliers_carry_all_of_a_load_that_can_be_carried(seed, size):
    """Those of what presses are not negative, whatever the size of rows."""
    rng = np.random.default_rng(seed)
    pressing, free = rng.uniform(-1, 1, (5, 6)) * size, rng.uniform(-1, 1, (2, 6)) * size
    wanted = pressing.T @ [1.0, 0.0, 2.0, 0.0, 0.5] - free.T @ [0.3, 2.0]
    found = rays._carried(csr_matrix(pressing), csr_matrix(free), wanted / size)
    assert np.all(found[:5] >= 0)
    carried = np.vstack([pressing, free]).T @ found
    assert carried == pytest.approx(wanted / size, rel=1e-12, abs=1e-13)


def test_multipliers_leave_the_least_of_a_load_that_cannot_be_carried():
    """What presses along x carries that part of a load, and none of it the other way round."""
    pressing, free = csr_matrix([[0.1, 0.0, 0.0]]), csr_matrix([[0.0, 0.1, 0.0]])
    assert rays._carried(pressing, free, np.array([1.0, -1.0, 1.0])) == pytest.approx([10, -10])
    assert rays._carried(pressing, free, np.array([-1.0, 1.0, 1.0])) == pytest.approx([0, 10])


@pytest.mark.parametrize(("friction", "locked"), [(0.31, True), (0.308, False)])
@pytest.mark.parametrize("turn", [0.0, np.pi / 2])
def test_a_block_in_space_is_locked_by_friction_that_dilates_from_its_slope_on(
    turn, friction, locked
):
    """A vertical push on a slope of tan(0.3) = 0.3093, which descends in several directions."""
    slope = np.array([np.sin(0.3) * np.cos(turn), np.sin(0.3) * np.sin(turn), np.cos(0.3)])
    rotation, _ = Rotation.align_vectors([slope], [[0.0, 0.0, 1.0]])
    stone = box((0, 0, 0), (1, 1, 1))
    turned = la.Polyhedron(stone.vertices @ rotation.as_matrix().T, stone.faces)
    law = la.Coulomb(friction, associated=True)
    problem = la.Problem(
        {"b": la.BlockAssembly3D({"stone": turned}, 0.0)},
        [la.BodyForce("b", (0.0, 0.0, -1.0))],
        interfaces=[
            la.Interface(
                ("b", lambda x: np.abs(slope @ x) < 1e-9),
                la.RigidObstacle((0, 0, 0), tuple(slope)),
                law,
            )
        ],
        dead_loads=[la.BodyForce("b", (0.0, 0.0, -1.0))],
    )
    program, contact = frozen(problem)
    ray = locking_ray(program, contact)
    assert ray.proves == locked
    if locked:
        pressed = program.contact.weights @ ray.point.normal_reaction
        size = np.abs(program.reference_load).max()
        assert pressed > 0.9 * size


def hanging(tension, weight):
    """A unit block below a ceiling, to which a joint with strength in tension holds it."""
    return la.Problem(
        {"b": la.BlockAssembly({"block": [(0, 0), (1, 0), (1, 1), (0, 1)]}, 0.0)},
        [la.PointForce("b", "block", (1.0, 0.0))],
        interfaces=[
            la.Interface(
                ("b", lambda x: np.abs(x[1] - 1) < 1e-9),
                la.RigidObstacle((0, 1), (0, -1)),
                la.Coulomb(0.5, adhesion=1.0, tension=tension),
            )
        ],
        dead_loads=[la.BodyForce("b", (0.0, -weight))] if weight else [],
    )


@pytest.mark.parametrize("tension", [0.5, 0.9, 1.1, 1.9])
def test_tension_of_a_joint_is_a_strength_and_no_load(tension):
    """A weight of 1 N below 1 m: the joint carries it from a tension of 1 Pa on."""
    program, contact = frozen(hanging(tension, 1.0))
    found = prove_dead_loads(program, contact, preparer_named("clarabel", {}), TOLERANCE)
    assert (found.equilibrium is not None) == (tension > 1)
    assert (found.mechanism is not None) == (tension < 1)
    state, rows = found.equilibrium or found.mechanism, program.contact
    weight = float(np.abs(program.dead_load - program.held_shut).sum())
    pulled = rows.weights @ (rows.pull - state.normal_reaction)
    assert pulled == pytest.approx(min(tension, 1.0) * weight, rel=1e-5)


def test_what_no_dead_load_pulls_at_is_held_by_the_whole_tension():
    """Nothing acts on the block: the joint is without traction, and in equilibrium."""
    program, contact = frozen(hanging(0.5, 0.0))
    found = prove_dead_loads(program, contact, None, TOLERANCE)
    assert found.mechanism is None
    assert found.residual == 0.0
    assert found.equilibrium.load_factor == 0.0
    assert found.equilibrium.normal_reaction == pytest.approx(program.contact.pull)
    assert np.abs(out_of_balance(program, found.equilibrium)).max() <= 1e-12


def test_a_collapse_by_cones_needs_no_linear_program(monkeypatch):
    """Where the linear program has no answer the solver finds the mechanism."""
    program, contact = frozen(on_incline(0.3, la.Tresca(0.3), (0.0, 1.0), weight=2.0))
    still = replace(program, reference_load=across(program))
    monkeypatch.setattr(collapses, "least", lambda *given, **more: None)
    found = dead_collapse(still, contact, preparer_named("clarabel", {}), TOLERANCE)
    assert found.proves(TOLERANCE)
    assert found.dissipated_share == pytest.approx(0.3 / (2 * np.sin(0.3)), rel=1e-6)


def test_a_linear_program_finds_no_mechanism_of_what_stands():
    program, contact = frozen(on_incline(0.3, la.Tresca(0.7), (0.0, 1.0), weight=2.0))
    still = replace(program, reference_load=across(program))
    assert collapses._by_lines(*collapses._driven(still, contact)) is None


@pytest.mark.parametrize("pull", [0.5, 0.98, 1.02, 3.0])
def test_a_linear_program_counts_the_area_of_what_yields(pull):
    """A spring of 0.5 Pa on 2 m^2 carries 1 N of the dead load, which pulls along it."""
    weight = pushed_weight()
    program = replace(
        weight,
        contact=replace(weight.contact, coefficient=np.zeros(2)),
        reference_load=np.array([0.0, -1.0]),
        dead_load=np.array([pull, 0.0]),
    )
    driven, added = collapses._driven(program, associated_contact(program.contact))
    velocity = collapses._by_lines(driven, added)
    assert (velocity is not None) == (pull > 1)
    if velocity is not None:
        assert velocity == pytest.approx([1 / pull, 0.0])


def test_what_a_linear_program_leaves_is_carried_up_to_round_off(monkeypatch):
    """Its multipliers are off by a ten-millionth: a proof needs those that carry all of it."""
    program, contact = pressed_on_a_slope(0.4)
    solved = rays.least

    def inexact(*given, **more):
        found = solved(*given, **more)
        return found * (1 + 1e-7 * np.cos(np.arange(found.size)))

    monkeypatch.setattr(rays, "least", inexact)
    ray = rays._from_edges(program, contact)
    assert ray.residual <= 1e-14
    assert ray.proves
