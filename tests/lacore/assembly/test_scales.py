"""Natural scales grow with the problem, and unknowns are numbered body after body."""

from dataclasses import replace
from math import cbrt, cos, radians, sqrt

import numpy as np
import pytest

import lacore as la
from lacore.assembly.loading import NoPowerError
from lacore.assembly.unknowns import Unknowns
from tests.lacore.model.bodies.blocks3d.solids import box
from tests.rigid_problems import box as rectangle


def clay(length, stress):
    mesh = la.meshes.rectangle((0, 2 * length), (0, length), 2, 1)
    return la.Problem(
        {"b": la.Body(mesh, la.VonMises(3 * stress))},
        [la.Traction("b", "top", (stress, 0))],
        [la.Fix("b", "bottom")],
        dead_loads=[la.Pressure("b", "top", 5 * stress)],
    )


def sand(length, stress):
    mesh = la.meshes.rectangle((0, 2 * length), (0, length), 2, 1)
    return la.Problem(
        {"b": la.Body(mesh, la.MohrCoulomb(0.0, 30))},
        [la.Pressure("b", "right", stress)],
        [la.Fix("b", "bottom"), la.Fix("b", "left")],
        dead_loads=[la.Pressure("b", "top", 5 * stress)],
    )


def masonry(length, stress):
    mesh = la.meshes.rectangle((0, 2 * length), (0, length), 2, 1)
    return la.Problem(
        {"b": la.Body(mesh, la.NoTension(3 * stress))},
        [la.Pressure("b", "top", stress)],
        [la.Fix("b", "bottom")],
    )


def ring(length, stress):
    mesh = la.meshes.rectangle((length, 2 * length), (0, 0.5 * length), 2, 1)
    return la.Problem(
        {"b": la.Body(mesh, la.VonMises(2 * stress), space="p2-gauss", kinematics="axisymmetric")},
        [la.Pressure("b", "left", stress)],
        [la.Fix("b", "bottom", "y")],
    )


def wall(length, stress):
    blocks = {str(n): rectangle(0, 2 * length, n * length, (n + 1) * length) for n in range(2)}
    weight = stress / length
    return la.Problem(
        {"b": la.BlockAssembly(blocks, 0.5)},
        [la.BodyForce("b", (weight, 0))],
        [la.Fix("b", "0")],
        dead_loads=[la.BodyForce("b", (0, -weight))],
    )


def beam(length, stress):
    nodes = {"a": (0, 0), "m": (length, 0), "b": (2 * length, 0)}
    members = {"left": ("a", "m"), "right": ("m", "b")}
    return la.Problem(
        {"b": la.Frame(nodes, members, 2 * stress * length**2)},
        [la.PointForce("b", "m", (0, -stress * length))],
        [la.Fix("b", end, "clamped") for end in "ab"],
    )


def film(length, stress):
    block = la.RigidBlock(rectangle(0, 2 * length, 0, length))
    floor = la.Interface(
        ("b", lambda x: x[1] < 1e-9), la.RigidObstacle((0, 0), (0, 1)), la.Tresca(stress)
    )
    return la.Problem({"b": block}, [la.BodyForce("b", (stress / length, 0))], interfaces=[floor])


def solid(length, stress):
    size = (2 * length, length, length)
    body = la.BlockAssembly3D({"a": box((0, 0, 0), size)}, 0.5)
    floor = la.Interface(("b", lambda x: x[2] < 1e-9), la.RigidObstacle((0, 0, 0), (0, 0, 1)), 0.5)
    weight = stress / length
    return la.Problem(
        {"b": body},
        [la.BodyForce("b", (weight, 0, 0))],
        interfaces=[floor],
        dead_loads=[la.BodyForce("b", (0, 0, -weight))],
    )


AREA = 2.0  # and volume, of all but the ring, for a length of 1
EXPECTED = {  # length, stress, thickness for a length and a stress of 1
    clay: (sqrt(AREA), 3 * sqrt(3), 1.0),
    # Dead load over the length by the slope sin(30); supports take an eleventh of the load.
    sand: (sqrt(AREA), 0.5 * (10 - 10 / 12) / sqrt(AREA), 1.0),
    masonry: (sqrt(AREA), 3.0, 1.0),  # only its crushing sets a stress
    # Its volume per area is the circumference at the middle radius.
    ring: (sqrt(0.5), 2 * sqrt(3), 2 * np.pi * 1.5),
    wall: (sqrt(2 * AREA), 4 / sqrt(2 * AREA), 1.0),  # with the weight of the base
    beam: (2.0, sqrt(3) * 2 / 2**2, 1.0),  # the moment of its hinges by the square of its length
    film: (sqrt(AREA), 1.0, 1.0),
    solid: (cbrt(AREA), AREA / cbrt(AREA) ** 2, cbrt(AREA)),
}


@pytest.mark.parametrize("make", EXPECTED, ids=lambda make: make.__name__)
def test_scales_are_those_of_size_and_strength(make):
    natural = la.discretise(make(1.0, 1.0)).natural
    if make is wall:  # what the support takes of it is no load
        assert natural.length == pytest.approx(EXPECTED[make][0])
        assert 0 < natural.stress <= EXPECTED[make][1]
        return
    assert (natural.length, natural.stress, natural.thickness) == pytest.approx(EXPECTED[make])


@pytest.mark.parametrize("make", EXPECTED, ids=lambda make: make.__name__)
@pytest.mark.parametrize(("length", "stress"), [(1e-3, 1.0), (1.0, 1e8), (40.0, 1e-4)])
def test_scales_grow_with_the_problem(make, length, stress):
    one, other = la.discretise(make(1.0, 1.0)).natural, la.discretise(make(length, stress)).natural
    deep = make in (ring, solid)
    assert other.length == pytest.approx(length * one.length)
    assert other.stress == pytest.approx(stress * one.stress)
    assert other.thickness == pytest.approx(one.thickness * (length if deep else 1.0))
    # F0.u = 1 at the speed of a load of the size of the problem.
    force = stress * length * (length if deep else 1.0)
    assert other.velocity == pytest.approx(one.velocity / force)


def test_the_strength_of_regions_is_between_theirs():
    """Of 1 and 100 the geometric mean 10; of soil with cohesion c cos(phi) without pressure."""
    mesh = la.meshes.rectangle((0, 1), (0, 2), 1, 2).with_subdomains({"low": lambda x: x[1] < 1})
    low = mesh.subdomains["low"]
    mesh = mesh.with_subdomains({"high": np.setdiff1d(np.arange(mesh.nelements), low)})
    body = la.Body(mesh, {"low": la.VonMises(1.0), "high": la.VonMises(100.0)})
    problem = la.Problem({"b": body}, [la.Traction("b", "top", (1, 0))], [la.Fix("b", "bottom")])
    assert la.discretise(problem).natural.stress == pytest.approx(10 * sqrt(3))
    soil = la.Body(la.meshes.rectangle((0, 1), (0, 2), 1, 2), la.MohrCoulomb(2.0, 30))
    problem = la.Problem({"b": soil}, [la.Traction("b", "top", (1, 0))], [la.Fix("b", "bottom")])
    assert la.discretise(problem).natural.stress == pytest.approx(2 * cos(radians(30)) * sqrt(3))


def test_what_sets_no_scale_is_refused():
    block = la.RigidBlock(rectangle(0, 1, 0, 1))
    floor = la.Interface(("b", lambda x: x[1] == 0), la.RigidObstacle((0, 0), (0, 1)), 0.5)
    with pytest.raises(la.InputError, match="nothing sets a scale of forces"):
        la.discretise(la.Problem({"b": block}, [la.BodyForce("b", (1, 0))], interfaces=[floor]))


def test_unknowns_are_those_of_bodies_footings_blocks_and_frames():
    soil = la.Body(la.meshes.rectangle((0, 2), (-1, 0), 2, 1), la.VonMises(1.0))
    stones = la.BlockAssembly({"a": rectangle(0, 1, 0, 1), "b": rectangle(0, 1, 1, 2)}, 0.5)
    frame = la.Frame({"A": (5, 0), "B": (5, 3)}, {"column": ("A", "B")}, 1.0)
    problem = la.Problem(
        {"frame": frame, "stones": stones, "soil": soil},
        [la.RigidFooting("soil", lambda x: (x[1] == 0) & (x[0] >= 1), (0, -1))],
        [la.Fix("soil", "bottom"), la.Fix("stones", "a"), la.Fix("frame", "A")],
    )
    unknowns = Unknowns.of(problem)
    offsets = [own.offset for own in unknowns.dofs.values()]
    counts = [own.count for own in unknowns.dofs.values()]
    assert list(unknowns.dofs) == ["soil", "stones", "frame"]
    # The speed of the footing comes after all continua.
    assert unknowns.speeds.tolist() == [counts[0]]
    assert offsets == [0, counts[0] + 1, counts[0] + 1 + counts[1]]
    assert unknowns.n == sum(counts) + 1
    parts = unknowns.parts
    assert parts[: counts[0]].tolist() == [0] * counts[0]
    assert parts[unknowns.speeds].tolist() == [0]  # with the body under it
    assert parts[offsets[1] : offsets[2]].tolist() == [1] * 3 + [2] * 3
    assert set(parts[offsets[2] :].tolist()) == {3}
    assert unknowns.dimension == 2


def test_the_size_of_a_load_adds_the_lengths_of_its_forces():
    """Of nodal forces (3, 4) and (0, 2), and of a block (1, -1, 0.5)."""
    soil = la.Body(la.meshes.rectangle((0, 2), (-1, 0), 2, 1), la.VonMises(1.0))
    problem = la.Problem(
        {"soil": soil, "stone": la.RigidBlock(rectangle(0, 1, 0, 1))},
        [la.Traction("soil", "top", (1, 0))],
        [la.Fix("soil", "bottom"), la.Fix("stone", lambda x: x[1] == 0)],
    )
    unknowns = Unknowns.of(problem)
    load = np.zeros(unknowns.n)
    load[unknowns.node_dofs[:, 2]] = 3.0, -4.0
    load[unknowns.node_dofs[:, 5]] = 0.0, 2.0
    load[unknowns.blocks["stone"].offset :][:3] = 1.0, -1.0, 0.5
    assert unknowns.load_size(load) == pytest.approx(5 + 2 + 2.5)


@pytest.mark.parametrize(("free", "accepted"), [(1e-10, True), (1e-14, False)])
def test_a_load_does_power_if_more_than_round_off_of_it_can_move(free, accepted):
    """A support takes all of a force on a block but a share of it."""
    problem = replace(
        film(1.0, 1.0),
        reference_loads=[la.PointForce("b", "block", (free, 1))],
        supports=[la.Fix("b", "block", "y")],
    )
    if accepted:
        assert la.discretise(problem).full.n == 3
        return
    with pytest.raises(NoPowerError):
        la.discretise(problem)
