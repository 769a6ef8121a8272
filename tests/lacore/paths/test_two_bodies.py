"""Two bodies in contact along a path: what one body would do, whichever side is the slave."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.paths.contact.meeting import meeting
from lacore.paths.contact.pair_stations import outlines
from lacore.paths.ending import Ending
from lacore.paths.flow import Moment, discretised
from lacore.paths.renewal.remeshing import restaged
from lacore.paths.stage import staged
from lacore_verification.cases.shared.exact_paths import cylinder, pressure, sphere, strip_force

LAW = la.hardening.Linear(1.0, 1.0)
SAME = 1e-6  # relative: certificates hold to 1e-6


def part(x, y, nx, ny, **more):
    mesh = la.meshes.quadrilaterals(x, y, nx, ny)
    return la.Body(mesh, la.VonMises(hardening=LAW), space="q2", **more)


def between(one, other, friction, swapped):
    return la.Interface(other, one, friction) if swapped else la.Interface(one, other, friction)


def rings(rows, swapped=False, friction=0.0):
    """A thick tube in two, of which the outer one has as many rows of elements as it is given."""
    bodies = {
        "inner": part((1, 1.5), (0, 0.25), 2, 1, kinematics="axisymmetric"),
        "outer": part((1.5, 2), (0, 0.25), 2, rows, kinematics="axisymmetric"),
    }
    return la.Problem(
        bodies,
        [la.Pressure("inner", "left")],
        [la.Fix(name, side, "y") for name in bodies for side in ("bottom", "top")],
        [between(("inner", "right"), ("outer", "left"), friction, swapped)],
    )


def expanded(problem, steps=2, **more):
    bore = la.PointTravel("inner", (1, 0), (1, 0))
    return la.sequential(problem, 0.1, steps, control=bore, **more)


@pytest.mark.parametrize("rows", [1, 2])
def test_two_rings_are_one_thick_ring(rows):
    path = expanded(rings(rows))
    exact = [pressure(cylinder(LAW), 1 + travel) for travel in path.history.travel]
    # Steps: 0.026 (0.1/0.5)^2/2^2 of the case hardening-cylinder, and 8e-5 of 4 elements.
    assert path.history.load_factor.to_numpy() == pytest.approx(exact, rel=5e-4)
    assert path.history.overlap.max() < 1e-6


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_either_ring_may_be_the_slave(friction):
    one, other = (expanded(rings(2, swapped, friction)) for swapped in (False, True))
    loads = [path.history.load_factor.to_numpy() for path in (one, other)]
    assert loads[1] == pytest.approx(loads[0], rel=SAME)


def sled(swapped=False, friction=0.3, press=0.5, start=0.2):
    """A block under pressure on a wide one with other elements, pushed along it."""
    bodies = {
        "low": part((0, 3), (0, 0.5), 7, 1),
        "top": part((start, start + 1), (0.5, 1), 3, 1),
    }
    return la.Problem(
        bodies,
        [la.RigidFooting("top", "left", (1, 0), rough=False)],
        [la.Fix("low", "bottom", "xy")],
        [between(("top", "bottom"), ("low", "top"), friction, swapped)],
        [la.Pressure("top", "top", press)],
    )


@pytest.mark.parametrize("swapped", [False, True])
def test_a_block_that_slides_over_many_elements_takes_mu_n(swapped):
    path = la.sequential(sled(swapped), 1.5, 3)
    assert path.status is Ending.REACHED, path.message
    assert path.history.force.to_numpy() == pytest.approx(0.3 * 0.5, rel=SAME)
    assert path.history.overlap.max() < 1e-6
    assert path.last.certificate.holds(1e-6)
    slave = "low" if swapped else "top"
    assert set(path.last.reactions.slave) == {slave}


def test_stacked_blocks_are_one_block():
    """Equal blocks with other elements, smooth: two steps of the implicit midpoint are exact."""
    bodies = {"low": part((0, 1), (0, 0.5), 2, 1), "top": part((0, 1), (0.5, 1), 3, 1)}
    problem = la.Problem(
        bodies,
        [la.RigidFooting("top", "top", (0, -1), rough=False)],
        [la.Fix("low", "bottom", "y"), *(la.Fix(name, "left", "x") for name in bodies)],
        [la.Interface(("top", "bottom"), ("low", "top"), 0.0)],
    )
    path = la.sequential(problem, 0.2, 1, "implicit-midpoint")
    exact = [strip_force(LAW, 1 - travel) for travel in path.history.travel]
    assert path.history.force.to_numpy() == pytest.approx(exact, rel=1e-6)


def neighbours(gap=0.05):
    """A block that is pressed until it comes to another one: a problem, and what approaches."""
    bodies = {"a": part((0, 1), (0, 1), 2, 2), "b": part((1 + gap, 2 + gap), (0, 1), 3, 3)}
    floor = la.RigidObstacle((0, 0), (0, 1))
    problem = la.Problem(
        bodies,
        [la.RigidFooting("a", "top", (0, -1), rough=False)],
        [la.Fix("a", "left", "x"), la.Fix("b", "right")],
        [la.Interface((name, "bottom"), floor, 0.0) for name in bodies],
    )
    return problem, [la.Interface(("a", "right"), ("b", "left"), 0.1)]


def test_a_gap_between_two_bodies_closes_before_the_load_rises():
    problem, approaching = neighbours()
    path = la.sequential(problem, 0.08, 4, approaching=approaching)
    assert path.status is Ending.REACHED, path.message
    free, touching = path.history.force.iloc[[0, -1]]
    assert free == pytest.approx(strip_force(LAW, 0.99), rel=1e-3)
    assert touching > 2 * free
    closed = path.events[path.events.kind == "contact closed"]
    assert closed.what.str.startswith("a.right|b.left").any()
    assert path.history.overlap.max() < 1e-3


def test_bodies_that_part_carry_nothing():
    """The upper block is lifted off: no tension crosses the interface."""
    problem = sled(friction=0.3)
    weight = [la.BodyForce("top", (0, -0.4))]
    lifted = replace(
        problem,
        reference_loads=[la.RigidFooting("top", "top", (0, 1), rough=False)],
        dead_loads=weight,
        supports=[*problem.supports, la.Fix("top", "left", "x")],
    )
    path = la.sequential(lifted, 0.2, 2)
    assert path.history.force.to_numpy() == pytest.approx(0.4 * 0.5, rel=1e-6)
    assert "contact opened" in set(path.events.kind)


def test_segments_are_the_same_whichever_side_is_the_slave():
    found = []
    for swapped in (False, True):
        problem = sled(swapped)
        stage = staged(problem, ())
        bodies = stage.plane_bodies_at(stage.start)
        own = meeting(*outlines(stage.pairs[0], bodies), 1e-6)
        places = np.concatenate([np.sum(own.places(share), axis=0) / 2 for share in (0.0, 1.0)])
        found.append(np.sort(places.round(12).ravel()))
        assert own.gaps() == pytest.approx(0.0, abs=1e-15)
        assert own.normal(0.5)[1] == pytest.approx(-1.0 if swapped else 1.0)
    assert found[0] == pytest.approx(found[1])


def test_sides_that_a_loose_solver_has_left_in_each_other_still_meet():
    """At the end of a step nothing moves, and overlaps of penalised contact are no other body."""
    deep = 2e-4
    stage = staged(sled(), ())
    (pair,) = stage.pairs
    sunk = {"low": 0.0, "top": -deep}
    nodes = {name: own + np.array([[0.0], [sunk[name]]]) for name, own in stage.start.nodes.items()}
    moment = Moment(*[replace(stage.start, nodes=nodes)] * 2, 1.0, 0.0)
    contact = discretised(stage, moment).full.contact
    assert pair.near < deep
    assert contact.weights.sum() == pytest.approx(1.0)  # the length of the upper block


@pytest.mark.parametrize(("sunk", "limit"), [(1e-4, 0.2), (0.0, 0.2), (-1e-4, 0.0)])
def test_friction_with_a_limit_acts_where_sides_overlap(sunk, limit):
    """It is lost where they are apart: what closes within a step sticks from the next one on."""
    stage = staged(sled(friction=la.Tresca(0.2)), ())
    down = {"low": 0.0, "top": -sunk}
    nodes = {name: own + np.array([[0.0], [down[name]]]) for name, own in stage.start.nodes.items()}
    contact = discretised(
        stage, Moment(*[replace(stage.start, nodes=nodes)] * 2, 1.0, 0.0)
    ).full.contact
    assert contact.limit == pytest.approx(limit)
    assert (contact.closing is None) == (sunk == 0)


def overlapping():
    problem, approaching = neighbours()
    low = part((0.98, 2), (0, 1), 3, 3)
    return replace(problem, bodies={**problem.bodies, "b": low}), approaching


def bonded():
    problem, (pair,) = neighbours()
    return problem, [replace(pair, friction=la.BOND)]


def dilating():
    problem, (pair,) = neighbours()
    return problem, [replace(pair, friction=la.Coulomb(0.3, associated=True))]


def unknown():
    problem, (pair,) = neighbours()
    return problem, [replace(pair, master=("c", "left"))]


WRONG = {
    "overlap": (overlapping, r"approaching\[0\].*overlap by 0.02 m.*move one of the bodies"),
    "bond": (bonded, "may open and close along a path is not bonded"),
    "dilatancy": (dilating, r"sliding would lift the body off.*take lacore\.Coulomb"),
    "unknown": (unknown, r"Interface\.master = 'c'.*no such body.*give one of"),
}


@pytest.mark.parametrize(("build", "message"), WRONG.values(), ids=WRONG)
def test_what_two_bodies_cannot_be(build, message):
    problem, approaching = build()
    with pytest.raises(la.InputError, match=message):
        la.sequential(problem, 0.1, 2, approaching=approaching)


def test_a_path_of_two_bodies_continues_from_its_checkpoint(tmp_path):
    file = tmp_path / "path.npz"
    first = la.sequential(sled(), 0.5, 1, checkpoint=file)
    again = la.sequential(sled(), 0.5, 1, checkpoint=file)
    assert np.array_equal(first.history.force, again.history.force)
    with pytest.raises(la.InputError, match="interfaces"):
        la.sequential(sled(friction=0.2), 0.5, 1, checkpoint=file)


def test_new_meshes_keep_their_contact():
    stage = staged(sled(), ())
    finer = {"top": la.meshes.quadrilaterals((0.2, 1.2), (0.5, 1), 4, 2)}
    new, _ = restaged(stage, stage.start, finer)
    assert [pair.name for pair in new.pairs] == ["top.bottom|low.top"]
    assert new.pairs[0].slave.edges.size == 4


@pytest.mark.slow
def test_pictures_and_files_of_two_bodies(tmp_path):
    path = la.sequential(sled(), 0.5, 2)
    path.plot().savefig(tmp_path / "path.png")
    path.last.plot().savefig(tmp_path / "state.png")
    path.to_vtu(tmp_path / "vtu")


def shells(along, swapped=False):
    """Two concentric quarter shells of other elements, smooth between them, and what approaches."""

    def shell(low, high, n):
        cells = la.meshes.quadrilaterals((low, high), (0, np.pi / 2), 2, n)
        mesh = la.meshes.isoparametric(
            cells, lambda x: x[0] * np.array([np.cos(x[1]), np.sin(x[1])])
        )
        metal = la.VonMises(hardening=la.hardening.Linear(1.0, 3.0))
        return la.Body(mesh, metal, kinematics="axisymmetric", space="q2")

    bodies = {"inner": shell(1, 1.5, 8), "outer": shell(1.5, 2, along)}
    problem = la.Problem(
        bodies, [la.Pressure("inner", "left")], [la.Fix(name, "bottom", "y") for name in bodies]
    )
    return problem, [between(("inner", "right"), ("outer", "left"), 0.0, swapped)]


@pytest.mark.slow
@pytest.mark.parametrize("along", [8, 6])
def test_smooth_shells_are_one_sphere_if_the_most_regular_velocity_is_taken(along):
    loads = []
    for swapped in (False, True):
        problem, approaching = shells(along, swapped)
        path = la.sequential(
            problem,
            0.5,
            20,
            control=la.PointTravel("inner", (1, 0), (1, 0)),
            approaching=approaching,
            selection=la.LeastNorm(),
        )
        assert path.status is Ending.REACHED, path.message
        loads.append(path.history.load_factor.to_numpy())
    whole = sphere(la.hardening.Linear(1.0, 3.0))
    exact = [pressure(whole, 1 + travel) for travel in path.history.travel]
    # Steps: 0.043/20^2 of the case hardening-sphere; 1e-4 of the load by the choice of LeastNorm.
    assert loads[0] == pytest.approx(exact, rel=2.1e-4)
    assert loads[1] == pytest.approx(loads[0], rel=SAME)


@pytest.mark.slow
def test_friction_of_two_bodies_needs_no_more_solves_than_that_of_a_platen():
    """Sides that overlap by a short part of an edge (before: 108 solves certified nothing)."""

    def billet(name, low, high, rows):
        mesh = la.meshes.rectangle((0, 1), (low, high), 20, rows, grade_x=(1.0, 3.0))
        return {name: la.Body(mesh, la.VonMises(hardening=LAW), space="p2-gauss")}

    def first_step(bodies, lowest, interface, *supports):
        load = la.RigidFooting(lowest, "bottom", (0, 1), rough=False)
        held = [la.Fix(name, "left", "x") for name in bodies]
        return la.sequential(
            la.Problem(bodies, [load], [*held, *supports], [interface]), 0.00625, 1
        )

    platen = la.Interface(("whole", "top"), la.RigidObstacle((0, 0.5), (0, -1)), 0.2)
    one = first_step(billet("whole", 0, 0.5, 10), "whole", platen)
    halves = billet("lower", 0, 0.25, 5) | billet("upper", 0.25, 0.5, 5)
    joint = la.Interface(("lower", "top"), ("upper", "bottom"), 0.2)
    two = first_step(halves, "lower", joint, la.Fix("upper", "top", "xy"))
    assert two.status is Ending.REACHED
    assert two.history.solves.sum() <= one.history.solves.sum()
