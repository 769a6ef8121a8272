"""Contact rows of curved edges: they see where the edge goes, and no point of it is missed."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lacore.model.meshes.curved import EdgeCurves
from lacore.paths.configuration import Configuration
from lacore.paths.contact.approach import gaps, obstacle_station
from lacore.paths.contact.stations import gathered
from lacore.paths.flow import Moment, discretised
from lacore.paths.stage import staged
from tests.lacore.paths.path_billets import billet, quad_billet

DURATION = 0.5


@pytest.fixture(scope="module", params=[billet, quad_billet])
def setting(request):
    """A stage whose right side may come to the platen, and its dofs."""
    problem, approaching = request.param()
    stage = staged(problem, approaching)
    start = Moment(stage.start, stage.start, DURATION, 0.0)
    return stage, discretised(stage, start).continua["billet"]


def anywhere(stage, dofs, rng, size):
    """The first configuration with every node moved at random: curved edges."""
    nodes = dofs.nodes + rng.uniform(-size, size, dofs.nodes.shape)
    return Configuration({"billet": nodes}, stage.start.strain)


@given(st.integers(0, 2**32 - 1))
def test_rows_are_how_distances_change(setting, seed):
    stage, dofs = setting
    rng = np.random.default_rng(seed)
    begin = anywhere(stage, dofs, rng, 0.05)
    velocity = rng.uniform(-1, 1, dofs.nodes.shape)
    unknowns = np.zeros(dofs.dofs.max() + 1)
    unknowns[dofs.dofs] = velocity
    n, obstacles = unknowns.size, stage.obstacles
    stations = [obstacle_station(own, dofs, n, begin) for own in obstacles]
    rows, _ = gathered(stations, obstacles, n, DURATION)
    before, after = (
        np.concatenate([gaps(own, nodes, dofs) for own in stage.obstacles])
        for nodes in (begin.nodes["billet"], begin.nodes["billet"] + DURATION * velocity)
    )
    assert rows.closing == pytest.approx(before / DURATION, abs=1e-13)
    assert rows.normal @ unknowns == pytest.approx((after - before) / DURATION, abs=1e-13)


@given(st.integers(0, 2**32 - 1))
def test_no_point_of_an_edge_is_nearer_than_its_controls(setting, seed):
    stage, dofs = setting
    nodes = anywhere(stage, dofs, np.random.default_rng(seed), 0.3).nodes["billet"]
    for own in stage.obstacles:
        start, middle, end = dofs.facet_nodes(own.facets)
        curves = EdgeCurves(nodes[:, start], nodes[:, middle], nodes[:, end])
        nearest = min(own.shape.distance(curves.at(s)).min() for s in np.linspace(0, 1, 21))
        assert nearest >= gaps(own, nodes, dofs).min() - 1e-15
