"""The order of blocks changes nothing, nor which of two is the slave: the program is the same."""

import numpy as np
import pytest
from scipy.spatial import Voronoi

import lacore as la
from tests.lacore.whole.test_random_walls import random_wall

ROUND_OFF = 1e-14  # of entries of order one


def cells(seed, count=9):
    """Random cells on a floor, and friction."""
    rng = np.random.default_rng(seed)
    inside = rng.uniform(0, 1, (count, 2)) * [2, 1]
    mirrors = [
        inside * [-1, 1],
        inside * [1, -1],
        [4, 0] - inside * [1, -1],
        [0, 2] + inside * [1, -1],
    ]
    diagram = Voronoi(np.concatenate([inside, *mirrors]))
    blocks = {"base": la.masonry.rectangle(-1, 3, -0.3, 0)}
    for k in range(count):
        blocks[f"cell {k}"] = diagram.vertices[diagram.regions[diagram.point_region[k]]]
    return blocks, float(rng.uniform(0.3, 0.9))


def wall(seed):
    problem, mu = random_wall(seed)
    return dict(problem.bodies["blocks"].polygons), mu


def listed(blocks, mu, order, scale=1.0):
    names = np.array(list(blocks))[order]
    polygons = {str(name): scale * np.array(blocks[str(name)]) for name in names}
    return la.Problem(
        {"b": la.BlockAssembly(polygons, mu)},
        [la.BodyForce("b", (1, 0))],
        [la.Fix("b", "base")],
        dead_loads=[la.BodyForce("b", (0, -1))],
    )


@pytest.mark.parametrize("draw", [cells, wall])
@pytest.mark.parametrize("seed", range(4))
def test_the_program_does_not_know_the_order(draw, seed):
    blocks, mu = draw(seed)
    rng = np.random.default_rng(seed)
    orders = (np.arange(len(blocks)), rng.permutation(len(blocks)))
    assert_same(*(la.discretise(listed(blocks, mu, order)).program for order in orders))


@pytest.mark.parametrize("scale", [1e-6, 1e5])
def test_the_order_does_not_depend_on_the_unit_of_length(scale):
    """Columns, and rows of contact, in metres and in another unit of length."""
    blocks, mu = cells(2)
    order = np.arange(len(blocks))[::-1]
    one, other = (la.discretise(listed(blocks, mu, order, own)) for own in (1.0, scale))
    assert np.allclose(other.points.position, scale * one.points.position, atol=1e-9 * scale)
    rows, columns = (own.free_basis.tocoo() for own in (one, other))
    assert np.array_equal(rows.row, columns.row)
    assert np.array_equal(rows.col, columns.col)


def test_each_of_two_assemblies_has_an_order_of_its_own():
    """The second one is the first one moved: its columns follow, in the same order."""
    blocks, mu = cells(1)
    names = np.array(list(blocks))
    rng = np.random.default_rng(0)
    programs = []
    for order in (np.arange(names.size), rng.permutation(names.size)):
        bodies = {
            body: la.BlockAssembly(
                {
                    str(name): np.array(blocks[str(name)]) + np.array([shift, 0])
                    for name in names[order]
                },
                mu,
            )
            for body, shift in (("one", 0.0), ("two", 8.0))
        }
        d = la.discretise(
            la.Problem(
                bodies,
                [la.BodyForce("one", (1, 0)), la.BodyForce("two", (2, 0))],
                [la.Fix(body, "base") for body in bodies],
                dead_loads=[la.BodyForce(body, (0, -1)) for body in bodies],
            )
        )
        programs.append(d.program)
    assert_same(*programs)
    (program, _), half = programs, programs[0].n // 2
    assert program.reference_load[half:] == pytest.approx(2 * program.reference_load[:half])


def assert_same(one, other):
    for name in ("reference_load", "dead_load"):
        first, second = getattr(one, name), getattr(other, name)
        assert np.allclose(first, second, rtol=0, atol=ROUND_OFF * np.abs(first).max())
    for name in ("normal", "tangential"):
        first, second = (getattr(program.contact, name) for program in (one, other))
        assert abs(first - second).max() <= ROUND_OFF
        assert np.array_equal(first.indices, second.indices)
    for name in ("weights", "coefficient", "limit", "dilatancy"):
        first, second = (getattr(program.contact, name) for program in (one, other))
        assert np.allclose(first, second, rtol=ROUND_OFF, atol=0)


@pytest.mark.parametrize("seed", [6, 9])
def test_a_wall_whose_load_is_not_unique_has_one_answer(seed):
    """By the order of its blocks load factors differed by up to 1e-3 (T14b)."""
    blocks, mu = wall(seed)
    rng = np.random.default_rng(seed)
    orders = [np.arange(len(blocks)), *(rng.permutation(len(blocks)) for _ in range(2))]
    states = [la.solve(listed(blocks, mu, order), throw=True) for order in orders]
    assert np.ptp([state.load_factor for state in states]) <= 1e-6


def test_reactions_belong_to_their_joints():
    """Of any order: equal and opposite where slave and master change places."""
    blocks, mu = cells(0)
    order = np.arange(len(blocks))
    tables = [
        la.solve(listed(blocks, mu, way), throw=True).reactions for way in (order, order[::-1])
    ]
    sense = [np.where(table["slave"] < table["master"], 1.0, -1.0) for table in tables]
    for name in ("n_x", "n_y"):
        one, other = (table[name] * own for table, own in zip(tables, sense, strict=True))
        assert np.allclose(one, other, atol=ROUND_OFF)
    for name in ("x", "y", "length", "t_n", "t_t", "u_n", "u_t"):
        assert np.allclose(tables[0][name], tables[1][name], atol=1e-9)


def test_joints_run_along_the_edges_of_their_slaves():
    blocks, mu = cells(1)
    for way in (1, -1):
        joints = la.BlockAssembly(dict(list(blocks.items())[::way]), mu).joints
        assert np.all(joints.slave > joints.master)
        body = la.BlockAssembly(dict(list(blocks.items())[::way]), mu)
        edges = body.edges
        assert np.array_equal(edges.block[joints.slave_edge], joints.slave)
        along = (edges.end - edges.start)[:, joints.slave_edge]
        assert np.all(np.sum((joints.end - joints.start) * along, axis=0) > 0)
        assert np.allclose(joints.normal, -edges.normal[:, joints.slave_edge], atol=1e-5)
        assert np.all(np.diff(joints.slave_edge) >= 0)
