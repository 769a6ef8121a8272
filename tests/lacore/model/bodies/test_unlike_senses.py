"""Sections that bear more in one sense than in the other, against hand calculations.

1e-6 relative is the bar of the certificate.
"""

from math import sqrt

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

import lacore as la
from lacore import sections
from lacore.model.bodies.frames.ways import ways_of
from lacore.reporting.errors import InputError
from tests.frame_problems import DOWN, force, solved, storeys, storeys_both_ways
from tests.shares import one_in

BAR = 1e-6
CAPPED = sections.polygon([(-4, -1), (-4, 1), (-2, 2), (0, 1.5), (1, 0), (0, -1), (-2, -1.5)])
KINDS = {
    "IPE": sections.standard("IPE 300", 1e-3),
    "diamond": sections.Section(((-4.0, 0.0), (0.0, 1.5), (4.0, 0.0))),
    "shifted": sections.polygon([(-3, -1), (-1, 2), (2, 1.5), (0, -1.5)]),
    "tee": sections.fibres([(0.3 - 0.1 * k, 1.0 + k, 1.0 + k) for k in range(4)]),
    "concrete": sections.fibres([(0.2, 0, 3.0), (0.1, 0, 3.0), (-0.2, 1.0, 0.0)]),
    "capped": CAPPED,
    "triangle": sections.polygon([(-3, 0), (1, 2), (1, -1)]),
    "mirrored": sections.Section(((-5.0, 0.0), (-2.0, 1.0), (0.5, 0.0))),
}


def dissipated(ways, stretch, turn):
    """Least over the rates of what is an unknown of the end."""
    rates = ways.stretch * stretch + ways.turn * turn
    r, e = ways.beyond.shape
    # t >= |rates + beyond x|, by variables (t, x).
    rows = [np.concatenate([-np.eye(r), s * ways.beyond], axis=1) for s in (1, -1)]
    answer = linprog(
        np.concatenate([ways.strength, ways.beyond.T @ ways.centre]),
        np.concatenate(rows),
        np.concatenate([-rates, rates]),
        bounds=[(0, None)] * r + [(None, None)] * e,
    )
    assert answer.status == 0
    return answer.fun + ways.centre @ rates


@pytest.mark.parametrize("section", KINDS.values(), ids=KINDS)
def test_ways_dissipate_what_the_polygon_supports(section):
    ways, corners = ways_of(section, True), section.outline
    largest = np.abs(corners).max(axis=0)
    for angle in np.linspace(0.05, 2 * np.pi, 17):
        rate = np.array([np.cos(angle), np.sin(angle)]) / largest
        assert dissipated(ways, *rate) == pytest.approx((corners @ rate).max(), rel=1e-8, abs=1e-9)


@pytest.mark.parametrize("section", KINDS.values(), ids=KINDS)
def test_use_is_one_on_the_outline(section):
    corners = section.outline
    edges = (corners + np.roll(corners, -1, axis=0)) / 2
    for points in (corners, edges):
        assert section.use(*points.T) == pytest.approx(np.ones(len(points)), rel=1e-9)
    assert section.use(*section.sides[1][:, None])[0] == pytest.approx(0.0, abs=1e-12)


def test_released_ends_bear_what_the_axis_of_the_polygon_says():
    ways = ways_of(CAPPED, False)
    low, high = dissipated(ways, -1.0, 0.0), dissipated(ways, 1.0, 0.0)
    assert (-low, high) == pytest.approx((-4.0, 1.0))


BACKENDS = ("highs", "clarabel", "cvxpy")


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("ratio", [0.0, 0.5, 1.0, 3.0])
def test_propped_beam_under_a_uniform_load(ratio, backend):
    """Hogging at the clamp, sagging inside: ``q L^2 = 2 m (1 + sqrt(1 + m'/m))^2``."""
    beam = la.Frame(
        {"a": (0, 0), "b": (2, 0)}, {"m": ("a", "b")}, sections=sections.plastic(1.5, 1.5 * ratio)
    )
    state = solved(
        beam, [la.Traction("frame", "m", DOWN)], [("a", "clamped"), ("b", "y")], (), backend
    )
    exact = 2 * 1.5 * (1 + sqrt(1 + ratio)) ** 2 / 4
    assert state.load_factor == pytest.approx(exact, rel=BAR)
    turning = state.hinges[state.hinges["state"] == "turns"]
    power = (turning["plastic_moment"] * turning["rotation_rate"].abs()).sum()
    assert power == pytest.approx(exact, rel=1e-4)  # rates from the solver


@pytest.mark.parametrize("order", [("a", "b"), ("b", "a")])
@pytest.mark.parametrize("load", [DOWN, (0.0, 1.0)])
def test_a_member_sags_on_its_right(order, load):
    """Clamped at both ends, a force midway: ``P = 4 (m + m')/L`` however it is drawn and pushed;
    as a cantilever it bears what the clamp does in the sense of the push."""
    sag, hog = 1.0, 0.25
    beam = la.Frame({"a": (0, 0), "b": (2, 0)}, {"m": order}, sections=sections.plastic(sag, hog))
    both = solved(beam, [force((1.0, 0.0), load)], [(("a", "b"), "clamped")])
    assert both.load_factor == pytest.approx(4 * (sag + hog) / 2, rel=BAR)
    hogs = (load == DOWN) == (order == ("a", "b"))
    arm = solved(beam, [force("b", load)], [("a", "clamped")])
    assert arm.load_factor == pytest.approx((hog if hogs else sag) / 2, rel=BAR)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_column_of_a_polygon_without_a_centre(sense, backend):
    """Clamped, a push at its top, 2 high: what `CAPPED` bears beside N = -3 in either sense."""
    column = la.Frame({"A": (0, 0), "B": (0, 2)}, {"c": ("A", "B")}, sections=CAPPED)
    dead = [force("B", (0, -3))]
    state = solved(column, [force("B", (sense, 0.0))], [("A", "clamped")], dead, backend)
    # Pushed to the right (its right, seen upwards) the foot is in tension on the left: it hogs.
    exact = {1.0: 1.25, -1.0: 1.5}[sense]
    assert state.load_factor == pytest.approx(exact / 2, rel=BAR)
    assert state.hinges["moment"][0] == pytest.approx(-sense * exact, rel=1e-5)
    assert state.hinges["axial_force"][0] == pytest.approx(-3.0, rel=1e-5)
    assert state.certify().holds(1e-6)
    planted = state.hinges
    planted.loc[0, "moment"] *= -1.0
    assert not state.certify(hinges=planted).holds(1e-6)
    assert state.certify(hinges=state.hinges).holds(1e-6)


def test_tee_by_hand():
    """Flange 6 x 1 on a web 1 x 6, strength 1, under N = -2 at its centroid 4.75 above the foot.

    Of 12, 7 are pressed, 5 are pulled: where it sags 5 of the web below, where it hogs the upper
    5/6 of the flange.
    """
    strips = 8  # in a unit of height
    parts = [(y, 1 / strips, 1 / strips) for y in (np.arange(6 * strips) + 0.5) / strips]
    parts += [(6 + (k + 0.5) / strips, 6 / strips, 6 / strips) for k in range(strips)]
    centroid = (6 * 3 + 6 * 6.5) / 12
    tee = sections.fibres([(y - centroid, t, c) for y, t, c in parts])
    assert (tee.squash_load, tee.middle) == pytest.approx((12.0, 0.0))
    beam = la.Frame({"a": (0, 0), "b": (2, 0)}, {"m": ("a", "b")}, sections=tee)
    found = []
    for load in ((0.0, 1.0), DOWN):
        dead = [force("b", (-2.0, 0.0))]
        found.append(2 * solved(beam, [force("b", load)], [("a", "clamped")], dead).load_factor)

    def first(low, high, width):
        return width * (high - low) * ((low + high) / 2 - centroid)

    sags = first(6, 7, 6) + first(5, 6, 1) - first(0, 5, 1)
    hogs = first(7 - 5 / 6, 7, 6) - first(6, 7 - 5 / 6, 6) - first(0, 6, 1)
    assert found[0] == pytest.approx(sags, rel=BAR)
    # Its axis lies a third into a strip: the chord of a parabola lies that far inside.
    assert found[1] == pytest.approx(hogs - 6 * (1 / 3) * (2 / 3) / strips**2, rel=BAR)


def test_reinforced_concrete_by_hand():
    """Steel below alone: sagging ``A f (d - x/2)`` with ``x = A f/(b f_c)``.

    Hogging with what little of the concrete is below the steel, c: ``b f_c x (c - x/2)``, x = c.
    """
    b, h, d, f_c, steel, strips = 0.3, 0.5, 0.45, 20.0, 0.6, 50
    depth = steel / (b * f_c)  # 0.1: ten strips
    parts = [((k + 0.5) * h / strips - h / 2, 0.0, b * h / strips * f_c) for k in range(strips)]
    beam = sections.fibres([*parts, (h / 2 - d, steel, steel)])
    assert np.interp(0, *np.transpose(beam.corners)) == pytest.approx(steel * (d - depth / 2))
    assert np.interp(0, *np.transpose(beam.lower)) == pytest.approx(-b * f_c * (h - d) ** 2 / 2)
    # Simply supported, a force midway: P L/4 = m, whatever hogging is.
    simple = la.Frame({"a": (0, 0), "b": (4, 0)}, {"m": ("a", "b")}, sections=beam)
    state = solved(simple, [force((2.0, 0.0), DOWN)], [("a", "xy"), ("b", "y")])
    assert state.load_factor == pytest.approx(steel * (d - depth / 2), rel=BAR)


def test_the_peak_between_nodes_counts_in_its_sense():
    """A pressed beam on two supports under its weight: sags everywhere, hogging is no matter."""
    weak = sections.polygon([(-4, 0.0), (0, 1.0), (4, 0.0), (0, -0.1)])
    strong = sections.polygon([(-4, 0.0), (0, 1.0), (4, 0.0), (0, -1.0)])
    found = []
    for section in (weak, strong):
        beam = la.Frame({"a": (0, 0), "b": (2, 0)}, {"m": ("a", "b")}, sections=section)
        dead = [force("b", (-1.0, 0.0))]
        state = solved(beam, [la.Traction("frame", "m", DOWN)], [("a", "xy"), ("b", "y")], dead)
        found.append(state.load_factor)
    assert found == pytest.approx([0.75 * 8 / 4] * 2, rel=BAR)


def test_the_peak_between_nodes_of_a_polygon_without_a_centre():
    """An inclined beam under its weight, pinned below, leaning against a wall: N falls upwards.

    At each place the load factor of what is statically determinate; the least of all places.
    """
    angle, length = 0.6, 3.0
    c, s = np.cos(angle), np.sin(angle)
    own = sections.polygon([(-4, 0), (1.0, 2.0), (2, 0), (0, -1)])
    lean, x = length / 2 * c / s, np.linspace(0, length, 200_001)
    forces = np.stack([-lean * c - x * s, lean * s * x - c * x**2 / 2])
    hull = ConvexHull(own.outline).equations
    most = (hull[:, :2] @ forces / -hull[:, 2:]).max()
    beam = la.Frame(
        {"a": (0, 0), "b": (length * c, length * s)}, {"beam": ("a", "b")}, sections=own
    )
    state = solved(beam, [la.Traction("frame", "beam", DOWN)], [("a", "xy"), ("b", "x")])
    assert state.load_factor == pytest.approx(1 / most, rel=BAR)


def random_frame(seed):
    """Two storeys of columns and beams that bear more in one sense, a bar across."""
    draw = np.random.default_rng(seed)
    nodes, members = storeys(draw)
    angle = np.sort(draw.uniform(0, 2 * np.pi, 7)) + 0.0
    around = np.stack([3 * np.cos(angle) - 1, np.sin(angle)], axis=1) * draw.uniform(0.5, 1)
    own = sections.polygon([*map(tuple, around), (0.3, 0.0), (-1.0, 0.4), (-1.0, -0.4)])
    tee = sections.fibres([(y, *draw.uniform(0.2, 1, 2)) for y in (-0.6, -0.2, 0.1, 0.3)])
    given = {name: own if name[0] == "c" else tee for name in members}
    given["d"] = sections.bar(draw.uniform(0.1, 1.0))
    frame = la.Frame(nodes, members, sections=given)
    live, dead = draw.uniform(-1, 1, (2, 6, 2)) * [[[1.0]], [[0.02]]]
    return frame, live, dead


@pytest.mark.parametrize("seed", one_in(3, range(12)))
def test_storeys_against_the_static_theorem(seed):
    """An independent linear program in forces, polygons as inequalities."""
    found, expected = storeys_both_ways(*random_frame(seed))
    assert found == pytest.approx(expected, rel=BAR)


def test_sensitivity_to_the_strength_of_an_unlike_section():
    """Only strengths bear the load: their elasticities add up to 1."""
    column = la.Frame({"A": (0, 0), "B": (0, 2)}, {"c": ("A", "B")}, sections=CAPPED)
    fixed = [la.Fix("frame", "A", "clamped")]
    load = [force("B", (1.0, -2.0))]
    table = la.sensitivity(la.solve(la.Problem({"frame": column}, load, fixed))).table
    own = table[table["parameter"] == "frame: sections (strength)"]
    assert own["elasticity"].item() == pytest.approx(1.0, rel=1e-4)


WRONG = {
    "in line": (lambda: sections.polygon([(0, 0), (1, 1), (2, 2)]), "enclose nothing"),
    "pairs": (lambda: sections.polygon([(0, 0), 1.0, (2, 2)]), "not pairs"),
    "outside": (lambda: sections.polygon([(1, 0), (2, 1), (2, -1)]), "yields under no force"),
    "fibre": (lambda: sections.fibres([(0, -1, 1)]), "no fibre"),
    "nothing": (lambda: sections.fibres([(0, 0, 0)]), "bear nothing"),
    "words": (lambda: sections.fibres("abc"), "not fibres"),
    "hogging": (lambda: sections.plastic(1.0, -1.0), "hogging = -1.0"),
    "upper": (
        lambda: sections.Section(((-2.0, -1.0), (2.0, 1.0))),
        "M < 0 on the upper half",
    ),
    "ends": (
        lambda: sections.Section(((-2.0, 0.0), (2.0, 0.0)), "", ((-1.0, -1.0), (2.0, -1.0))),
        "does not begin and end below",
    ),
    "lower": (
        lambda: sections.Section(
            ((-2.0, 0.0), (2.0, 0.0)), "", ((-2.0, 0.0), (-1, -1), (0, -0.5), (2.0, 0.0))
        ),
        "no lower half",
    ),
}


@pytest.mark.parametrize(("build", "told"), WRONG.values(), ids=WRONG)
def test_what_cannot_be(build, told):
    with pytest.raises(InputError, match=told):
        build()
