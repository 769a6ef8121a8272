"""Members under loads along them: hinges where moments peak, curved diagrams.

1e-6 relative is the bar of the certificate, and of the excess of moments inside members.
"""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_hex

import lacore as la
from lacore.assembly.span_nodes import spanned
from lacore.limit.hinging import excess
from lacore.limit.span_moments import SpanMoments, span_moments
from lacore.pictures.frames import MOMENT
from lacore.pictures.mechanism import plot_mechanism
from tests.frame_problems import DOWN, portal, static_load_factor
from tests.lacore.pictures.readings import drawn, words

BAR = 1e-6
CLAMPED = [("a", "clamped"), ("b", "clamped")]
PROPPED = [("a", "clamped"), ("b", "xy")]
SIMPLE = [("a", "xy"), ("b", "y")]
EXACT = [(CLAMPED, 16.0), (PROPPED, 6 + 4 * np.sqrt(2)), (SIMPLE, 8.0)]


def beam(supports, at=(3, 0), nodes=None, loads=None, m_p=1.0, dead=()):
    """A straight member from "a" at the origin to "b", of length 3, under a load across it."""
    frame = la.Frame({"a": (0, 0), "b": at, **(nodes or {})}, {"beam": ("a", "b")}, m_p)
    turned = tuple(np.array([at[1], -at[0]]) / np.hypot(*at))
    return la.Problem(
        {"beam": frame},
        loads or [la.Traction("beam", "beam", turned)],
        [la.Fix("beam", *given) for given in supports],
        dead_loads=dead,
    )


@pytest.mark.parametrize("backend", ["clarabel", "highs"])
@pytest.mark.parametrize(("supports", "exact"), EXACT)
def test_a_beam_under_a_uniform_load(supports, exact, backend):
    """w L^2/M_p = 16, 11.657 and 8: a beam between two clamps had no mechanism at all."""
    state = la.solve(beam(supports), backend, throw=True)
    assert state.load_factor == pytest.approx(exact / 9, rel=BAR)
    assert state.rigor is la.Rigor.UPPER
    assert excess(state) <= BAR


def test_the_hinge_stands_where_the_moment_peaks():
    """(sqrt 2 - 1) L from the prop; no further node but the first one, midway."""
    state = la.solve(beam(PROPPED), throw=True)
    turning = state.hinges[state.hinges["state"] == "turns"]
    # The load factor is off by the square of the place.
    assert turning["x"].max() == pytest.approx(3 * (2 - np.sqrt(2)), abs=3 * np.sqrt(BAR))
    assert len(state.discretisation.frames["beam"].body.names) == 4


@pytest.mark.parametrize("where", [0.02, 0.4, 0.586, 0.9])
def test_nodes_of_the_user_stay_and_change_nothing(where):
    problem = beam(PROPPED, nodes={"m": (3 * where, 0)})
    state = la.solve(problem, throw=True)
    assert state.load_factor == pytest.approx(EXACT[1][1] / 9, rel=BAR)
    assert "m" in state.discretisation.frames["beam"].body.names
    again = la.solve(state.discretisation, throw=True)
    assert again.load_factor == pytest.approx(state.load_factor, rel=BAR)


@pytest.mark.parametrize("scale", [1e-4, 1.0, 1e5])
@pytest.mark.parametrize("at", [(3, 0), (0, 3), (-1.8, 2.4)])
def test_directions_and_units_do_not_matter(at, scale):
    state = la.solve(beam(PROPPED, at, m_p=scale), throw=True)
    assert state.load_factor == pytest.approx(scale * EXACT[1][1] / 9, rel=BAR)


def test_a_load_along_the_axis_needs_no_hinge():
    problem = beam([("a", "clamped")], loads=[la.Traction("beam", "beam", (1, 0))], at=(3, 0))
    assert spanned(problem) is problem


def test_dead_and_live_loads_add_up():
    """Of 11.657 the dead load takes 4; where it alone is more, nothing stands."""
    own = [la.Traction("beam", "beam", (0, -4 / 9))]
    state = la.solve(beam(PROPPED, dead=own), throw=True)
    assert state.load_factor == pytest.approx((EXACT[1][1] - 4) / 9, rel=BAR)
    # Below 12, which a hinge at mid-span carries.
    heavy = [la.Traction("beam", "beam", (0, -11.8 / 9))]
    push = [la.Traction("beam", "beam", (0, -1))]
    state = la.solve(beam(PROPPED, loads=push, dead=heavy), throw=True)
    assert state.load_factor == pytest.approx((EXACT[1][1] - 11.8) / 9, rel=1e-5)


def test_spans_between_supports_of_one_member():
    """Clamped at both ends, three equal spans: the same 16, however supports are selected."""
    nodes = {"m": (1, 0), "n": (2, 0)}
    frame = la.Frame({"a": (0, 0), "b": (3, 0), **nodes}, {"beam": ("a", "b")}, 1.0)
    problem = la.Problem(
        {"beam": frame},
        [la.Traction("beam", "beam", DOWN)],
        [la.Fix("beam", ("a", "b"), "clamped"), la.Fix("beam", lambda x: x[1] == 0, "y")],
    )
    state = la.solve(problem, throw=True)
    assert state.load_factor == pytest.approx(16, rel=BAR)
    body = state.discretisation.frames["beam"].body
    assert len(body.names) == 7  # a predicate that holds all there is would hold new nodes, too
    once = spanned(problem)
    assert spanned(once) is once


def test_members_that_pass_each_other_stay_apart():
    """The peak is where another member crosses that no node joins."""
    nodes = {"a": (0, 0), "b": (3, 0), "c": (1.5, -1), "d": (1.5, 1), "e": (0, -1)}
    members = {"beam": ("a", "b"), "post": ("c", "d"), "tie": ("c", "e"), "end": ("e", "a")}
    problem = la.Problem(
        {"f": la.Frame(nodes, members, {"beam": 1.0, "post": 9.0, "tie": 9.0, "end": 9.0})},
        [la.Traction("f", "beam", DOWN)],
        [la.Fix("f", ("a", "b", "c", "d", "e"), "clamped")],
    )
    assert la.solve(problem, throw=True).load_factor == pytest.approx(16 / 9, rel=BAR)


def dense(frame, live, dead, parts):
    """The frame with many nodes, and line loads by member, N/m per m, as forces on them."""
    share = np.arange(1, parts) / parts
    nodes = dict(frame.nodes)
    for name, (one, other) in frame.members.items():
        start, end = (np.array(frame.nodes[own]) for own in (one, other))
        for k, s in enumerate(share):
            nodes[f"{name} {k}"] = tuple((1 - s) * start + s * end)
    fine = replace(frame, nodes=nodes)
    forces = []
    for loads in (live, dead):
        total = np.zeros((len(fine.names), 2))
        for name, vector in loads.items():
            own = fine.pieces.member == fine.member_names.index(name)
            half = np.outer(fine.pieces.length[own] / 2, vector)
            for ends in (fine.pieces.start[own], fine.pieces.end[own]):
                np.add.at(total, ends, half)
        forces.append(total)
    return fine, *forces


@pytest.mark.parametrize("seed", range(8))
def test_random_portals_against_the_static_theorem(seed):
    """An independent program with 40 nodes a member: above by O(1/40^2), and never below."""
    rng, parts = np.random.default_rng(seed), 40
    names = ("left", "beam", "right")
    frame = portal(
        h=rng.uniform(1, 3),
        span=rng.uniform(2, 5),
        m_p=dict(zip(names, rng.uniform(1, 3, 3), strict=True)),
    )
    live = {name: tuple(rng.uniform(-1, 1, 2)) for name in names}
    dead = {name: tuple(0.05 * rng.uniform(-1, 1, 2)) for name in names}
    problem = la.Problem(
        {"f": frame},
        [la.Traction("f", name, vector) for name, vector in live.items()],
        [la.Fix("f", ("A", "D"), "clamped")],
        dead_loads=[la.Traction("f", name, vector) for name, vector in dead.items()],
    )
    fine, *forces = dense(frame, live, dead, parts)
    clamped = np.isin(fine.names, ["A", "D"])
    state = la.solve(problem, throw=True)
    above = static_load_factor(fine, *forces, clamped) / state.load_factor - 1
    # Half a cell beside the peak, of a parabola of 8 M_p over the span, four times for two hinges.
    assert -BAR <= above <= 4 * 8 * (0.5 / parts) ** 2


def test_feet_with_friction_under_a_line_load():
    """Against the same frame with many nodes; feet of Coulomb friction, thrust outwards."""

    def problem(nodes):
        frame = portal()
        spread = {f"n{k}": (4 * k / nodes, 2.0) for k in range(1, nodes)}
        frame = replace(frame, nodes={**frame.nodes, **spread})
        floor = la.RigidObstacle((0, 0), (0, 1))
        return la.Problem(
            {"f": frame},
            [la.Traction("f", "beam", DOWN)],
            interfaces=[la.Interface(("f", ("A", "D")), floor, 0.3)],
        )

    states = [la.solve(problem(nodes), throw=True) for nodes in (1, 64)]
    assert states[0].load_factor == pytest.approx(states[1].load_factor, rel=BAR)
    assert states[0].rigor is la.Rigor.DISCRETE


def test_parabolas():
    """Simply supported, q = -1 (down), L = 2: q L^2/8 below the member; with ends of its own."""
    moments = SpanMoments(
        ends=np.array([[0.0, 0.0], [1.0, 0.0], [5.0, 0.0]]),
        axial=np.full((3, 2), np.nan),
        load=-np.ones(3),
        length=np.full(3, 2.0),
    )
    assert moments.at(np.array([0.5]))[:, 0] == pytest.approx([-0.5, 0.0, 2.0])
    assert moments.peaks[:2] == pytest.approx([0.5, 0.75])
    assert np.isnan(moments.peaks[2])
    assert moments.inside == pytest.approx([0.5, 0.125, 0.0])


def test_moments_of_pieces_agree_at_their_nodes():
    """Across every node inside a member, whichever way it is turned."""
    state = la.solve(beam(PROPPED, (-1.8, 2.4)), throw=True)
    moments = span_moments(state.discretisation, state.point, "beam")
    pieces = state.discretisation.frames["beam"].body.pieces
    order = np.argsort(
        np.sum(
            pieces.along * state.discretisation.frames["beam"].body.position[:, pieces.start],
            axis=0,
        )
    )
    ends = moments.ends[order]
    assert ends[1:, 0] == pytest.approx(ends[:-1, 1], abs=BAR)
    assert ends[0, 0] == pytest.approx(1, rel=BAR)  # hogging: tension where the load comes from


def test_diagrams_are_curved():
    axes = drawn(plot_mechanism(la.solve(beam(PROPPED), throw=True))).axes[1]
    faces = [
        path.vertices
        for item in axes.collections
        if isinstance(item, PolyCollection)
        and to_hex(MOMENT) in [to_hex(own) for own in item.get_edgecolor()[:1]]
        for path in item.get_paths()
    ]
    places = np.concatenate(faces)
    scale = 0.12 * 3
    assert places[:, 1].min() == pytest.approx(-scale, rel=1e-3)  # of 33 samples a piece
    assert places[:, 1].max() == pytest.approx(scale, rel=1e-6)
    load = EXACT[1][1] / 9
    x = places[:, 0]
    parabola = (1 - x / 3) - load * x * (3 - x) / 2
    on_foot = np.abs(places[:, 1]) < 1e-9
    assert np.all(on_foot | (np.abs(places[:, 1] - scale * parabola) < 1e-5))
    assert "moment (max 1 N)" in words(axes.figure)


def test_states_with_hinges_inside_spans_are_stored():
    state = pickle.loads(pickle.dumps(la.solve(beam(PROPPED), throw=True)))
    assert excess(state) <= BAR
