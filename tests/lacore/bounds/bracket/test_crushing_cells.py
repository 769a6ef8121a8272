"""Cells of joints that crush are cut where mechanisms begin to crush them."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import lacore as la
from lacore.bounds.bracket import crushing_bracket
from lacore.bounds.bracket.crushing_bracket import _crushing, _finer
from lacore.model.bodies.blocks3d.crushing import Cells
from tests.lacore.model.bodies.blocks3d.solids import box
from tests.lacore.whole.test_crushing import PRESSED, pier

MU, STRENGTH = 0.5, 4.0
TURNS = [None, Rotation.from_euler("xyz", (0.3, -0.5, 2.0))]
UP = np.array([0.0, 0.0, 1.0])


def blocks(turn=None, long=1.0, count=1, divisions=1, whole=True):
    """Blocks of ``long`` x 1 x 1 on a floor, each on a joint of one cell, or of four."""
    solids = {"floor": box((0, 0, -1), (20, 1, 0))}
    for number in range(count):
        start = 10.0 * number
        solids[f"b{number}"] = box((start, 0, 0), (start + long, 1, 1))
    if turn is not None:
        solids = {
            name: la.Polyhedron(turn.apply(own.vertices), own.faces) for name, own in solids.items()
        }
    law = la.Crushing(STRENGTH, divisions)
    body = la.BlockAssembly3D(solids, MU, crushing=law)
    if not whole:
        return body, law
    corners = np.array([[0, 0, 0], [long, 0, 0], [long, 1, 0], [0, 1, 0]], dtype=float)
    starts = 10.0 * np.arange(count)[:, None, None] * np.array([1.0, 0, 0])
    corners = (corners + starts).reshape(-1, 3)
    corners = corners if turn is None else turn.apply(corners)
    one = Cells(corners.T, np.repeat(np.arange(count), 4), np.arange(count))
    law = la.Crushing(STRENGTH, divisions, cells=one)
    return body.crushed(law), law


def moving(body, block, at, slip, spin, turn=None):
    """A block turns about a point of its joint, which slips."""
    at, slip, spin = (np.array(own, dtype=float) for own in (at, slip, spin))
    if turn is not None:
        at, slip, spin = (turn.apply(own) for own in (at, slip, spin))
    motion = np.zeros((6, len(body.names)))
    number = body.names.index(block)
    motion[:3, number] = slip + np.cross(spin, body.centroid[:, number] - at)
    motion[3:, number] = spin
    return motion


def state(motion, filled):
    groups = (SimpleNamespace(name="own: crushing"),)
    return SimpleNamespace(
        velocity={"own": motion},
        point=SimpleNamespace(stress=(STRENGTH * np.reshape(filled, (-1, 1)),)),
        discretisation=SimpleNamespace(full=SimpleNamespace(groups=groups)),
    )


def finer(body, law, motions, filled=1.0, halved=False):
    filled = np.broadcast_to(filled, body.joints.cells.joint.size)
    return _finer(body, "own", law, [state(motion, filled) for motion in motions], halved)


def places(cells, turn=None):
    """Areas and centroids (x, y) of cells, by x."""
    middle = cells.centroid.T if turn is None else turn.inv().apply(cells.centroid.T)
    assert np.abs(middle[:, 2]).max() < 1e-12
    order = np.lexsort(middle[:, 1::-1].T.round(9))
    return cells.area[order], middle[order, :2]


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_cell_is_cut_where_a_rocking_block_begins_to_crush(turn, way):
    """It closes beyond x = 0.8, and by 0.5 times its slip of 0.2 more: beyond x = 0.7."""
    body, law = blocks(turn)
    rocking = moving(body, "b0", (0.8, 0, 0), (0, 0.2 * way, 0), (0, 1, 0), turn)
    area, middle = places(finer(body, law, [rocking, rocking]), turn)
    assert area == pytest.approx([0.7, 0.3])
    assert middle == pytest.approx(np.array([[0.35, 0.5], [0.85, 0.5]]))


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("filled", [1e-7, 0.25, 0.6, 1 - 1e-7])
def test_a_part_of_the_area_that_is_at_its_strength_is_cut_off(turn, filled):
    """On the side that crushes, whatever the place where the mechanism begins to."""
    body, law = blocks(turn)
    rocking = moving(body, "b0", (0.5, 0, 0), (0, 0, 0), (0, 1, 0), turn)
    area, middle = places(finer(body, law, [rocking, rocking], filled), turn)
    assert area == pytest.approx([1 - filled, filled], rel=1e-6)
    assert middle[1] == pytest.approx([1 - filled / 2, 0.5])


@pytest.mark.parametrize("filled", [1e-10, 1 - 1e-10])
def test_a_cell_that_is_empty_or_full_is_cut_where_it_begins_to_crush(filled):
    body, law = blocks()
    rocking = moving(body, "b0", (0.5, 0, 0), (0, 0, 0), (0, 1, 0))
    area, _ = places(finer(body, law, [rocking, rocking], filled))
    assert area == pytest.approx([0.5, 0.5])


@pytest.mark.parametrize("turn", TURNS)
def test_a_cell_is_halved_across_its_longer_side(turn):
    body, law = blocks(turn, long=2.0)
    rocking = moving(body, "b0", (1.7, 0.9, 0), (0, 0, 0), (1, 2, 0), turn)
    area, middle = places(finer(body, law, [rocking, rocking], halved=True), turn)
    assert area == pytest.approx([1.0, 1.0])
    assert middle == pytest.approx(np.array([[0.5, 0.5], [1.5, 0.5]]))


@pytest.mark.parametrize("first", [True, False])
def test_only_cells_that_a_mechanism_crushes_in_part_are_cut(first):
    """Of four squares those beyond x = 0.5, along x = 0.8, in whichever state they crush."""
    body, law = blocks(whole=False)
    rocking = moving(body, "b0", (0.8, 0, 0), (0, 0, 0), (0, 1, 0))
    lifted = moving(body, "b0", (0, 0, 0), UP, (0, 0, 0))
    area, middle = places(finer(body, law, [rocking, lifted] if first else [lifted, rocking]))
    assert area == pytest.approx([0.25, 0.25, 0.15, 0.15, 0.1, 0.1])
    assert middle[:, 0] == pytest.approx([0.25, 0.25, 0.65, 0.65, 0.9, 0.9])


@pytest.mark.parametrize(("speed", "cut"), [(0.1, True), (0.01, False)])
def test_cells_that_make_hardly_any_difference_stay(speed, cut):
    """Two blocks rock alike, one of them slowly: a share of less than 2 % is left as it is."""
    body, law = blocks(count=2)
    both = sum(
        moving(body, name, (0.8 + x, 0, 0), (0, 0, 0), (0, own, 0))
        for name, x, own in (("b0", 0.0, 1.0), ("b1", 10.0, speed))
    )
    cells = finer(body, law, [both, both])
    assert np.bincount(cells.joint, cells.area) == pytest.approx([1.0, 1.0])
    assert np.bincount(cells.joint).tolist() == [2, 2 if cut else 1]


@pytest.mark.parametrize("turn", TURNS)
def test_motions_of_all_blocks_together_crush_nothing(turn):
    """A joint sees the motion of one block relative to the other."""
    body, law = blocks(turn)
    rocking = moving(body, "b0", (0.8, 0, 0), (0, 0.2, 0), (0, 1, 0), turn)
    together = sum(
        moving(body, name, (0.3, 5.0, -2.0), (0.7, -0.2, 0.4), (0.5, 2.0, -0.3), turn)
        for name in body.names
    )
    area, middle = places(finer(body, law, [rocking + together] * 2), turn)
    assert area == pytest.approx([0.7, 0.3])
    assert middle == pytest.approx(np.array([[0.35, 0.5], [0.85, 0.5]]))


@pytest.mark.parametrize("turn", TURNS)
def test_rates_of_crushing_are_those_of_closing_and_of_slip(turn):
    """``mu ||slip|| - opening`` at corners and centroids, and its slope by differences."""
    body, _ = blocks(turn, whole=False)
    slip, spin, at = np.array([0.3, -0.1, 0]), np.array([0.4, -0.7, 0.9]), np.array([0.2, 0.6, 0])
    motion = moving(body, "b0", at, slip, spin, turn)

    def rate(place):
        speed = slip + np.cross(spin, place - at)
        return MU * np.linalg.norm(speed[:, :2], axis=1) - speed[:, 2]

    def back(place):
        return place if turn is None else turn.inv().apply(place)

    cells = body.joints.cells
    axes = np.array([[1.0, 0, 0], [0, 1.0, 0]])
    axes = axes if turn is None else turn.apply(axes)
    placed = np.repeat(axes[:, :, None], cells.joint.size, axis=2)
    corners, middles, slope = _crushing(body, motion, cells, placed)
    middle, step = back(cells.centroid.T), 1e-5 * np.eye(3)[:2]
    assert corners == pytest.approx(rate(back(cells.corners.T)))
    assert middles == pytest.approx(rate(middle))
    for found, own in zip(slope, step, strict=True):
        difference = (rate(middle + own) - rate(middle - own)) / 2e-5
        assert found == pytest.approx(difference, abs=1e-6)


@pytest.mark.parametrize("failing", [0, 1, 2, 3])
def test_a_side_without_a_state_ends_the_iterations(monkeypatch, failing):
    """There is no mechanism to follow; bounds that were found before are kept."""
    states = []

    def solve(problem, *given, **named):
        states.append(la.solve(problem, *given, **named))
        if len(states) - 1 != failing:
            return states[-1]
        failed = {"point": None, "load_factor": np.nan, "certificate": None}
        return replace(states[-1], status=la.Status.FAILED, **failed)

    monkeypatch.setattr(crushing_bracket, "solve", solve)
    found = la.crushing_bracket(pier(la.Crushing(4 * PRESSED, 1)), target_width=1e-6)
    assert len(found.rounds) == 1 + failing // 2
    assert (found.status is la.Status.SOLVED) == (failing > 1)
    assert np.isnan([found.low, found.high]).tolist() == [failing == 0, failing == 1]
