"""Sections of members: tables, N-M polygons, bars and rigid members, against hand calculations.

1e-6 relative is the bar of the certificate.
"""

import pickle
from math import inf, sqrt

import numpy as np
import pytest
from scipy.optimize import brentq

import lacore as la
from lacore import sections
from lacore.model.bodies.frames.profiles import PROFILES
from lacore.reporting.errors import InputError
from tests.frame_problems import DOWN, RIGHT, force, solved, storeys, storeys_both_ways
from tests.shares import one_in

BAR = 1e-6
TABLE = {  # area cm^2, W_pl cm^3, I_y cm^4 as tabulated beside EN 10365, in three or more digits
    "IPE 80": (7.64, 23.2, 80.1),
    "IPE 160": (20.1, 123.9, 869.3),
    "IPE 200": (28.5, 220.6, 1943),
    "IPE 270": (45.9, 484.0, 5790),
    "IPE 300": (53.8, 628.4, 8356),
    "IPE 330": (62.6, 804.3, 11770),
    "IPE 360": (72.7, 1019, 16270),
    "IPE 400": (84.5, 1307, 23130),
    "IPE 450": (98.8, 1702, 33740),
    "IPE 500": (115.5, 2194, 48200),
    "IPE 550": (134.4, 2787, 67120),
    "IPE 600": (156.0, 3512, 92080),
    "HEA 100": (21.24, 83.01, 349.2),
    "HEA 140": (31.42, 173.5, 1033),
    "HEA 200": (53.83, 429.5, 3692),
    "HEA 240": (76.84, 744.6, 7763),
    "HEA 260": (86.82, 919.8, 10450),
    "HEA 300": (112.5, 1383, 18260),
}


@pytest.mark.parametrize(("name", "listed"), TABLE.items(), ids=TABLE)
def test_rolled_sections_are_those_of_the_tables(name, listed):
    """ArcelorMittal, Sections and merchant bars, and public tables of EN 10365 after it.

    Half a unit of the third digit of tabulated areas is 0.5 %, of moduli less.
    """
    section = sections.standard(name, yield_stress=1.0)
    area, modulus, inertia = listed
    assert 1e4 * section.squash_load == pytest.approx(area, rel=2.5e-3)
    assert 1e6 * section.plastic_moment == pytest.approx(modulus, rel=1e-3)
    # The second moment sees what is far from the middle, which area and W_pl may hide.
    profile = PROFILES[name]
    y = np.linspace(0.0, profile.height / 2, 4001)
    strips, middle = np.diff(profile.area(y)), (y[1:] + y[:-1]) / 2
    # Strips of 1/8000 of the height: 1e-7 of I, less than the tables' four digits.
    assert 1e8 * np.sum(middle**2 * strips) == pytest.approx(inertia, rel=1e-3)
    assert sections.standard(name.replace(" ", "").lower(), 1.0).name == name


def test_all_profiles_have_the_area_that_integration_finds():
    for profile in PROFILES.values():
        y = (np.arange(200_000) + 0.5) * profile.height / 400_000
        step = profile.height / 400_000
        area = profile.area(y)
        # Midpoints: the width jumps by 0.2 m at most in one of the strips.
        assert profile.moment(np.zeros(1))[0] == pytest.approx(
            np.sum(y * np.gradient(area, y)) * step, rel=1e-3
        )
        assert np.all(np.diff(area) > 0)


@pytest.mark.parametrize("n", [0.0, 0.3, 0.5, 0.9])
def test_polygons_close_in_on_the_parabola_of_a_rectangle(n):
    """M/M_p = 1 - n^2 lies between both; chords of a parabola are off by their width^2/4."""
    for layers in (4, 16):
        for polygon, sign in (("inner", 1.0), ("outer", -1.0)):
            own = sections.rectangle(0.2, 0.3, 1e6, layers, polygon)
            assert own.squash_load == pytest.approx(0.06e6)
            assert own.plastic_moment == pytest.approx(1e6 * 0.2 * 0.3**2 / 4)
            moment = own.plastic_moment * (1 - n**2)
            used = own.use(np.array([n * own.squash_load]), np.array([moment]))[0]
            assert -1e-12 < sign * (used - 1) * (1 - n**2) < 1 / (2 * layers**2 * (1 - n**2))


def diamond(m_p, n_p):
    """N/N_p + M/M_p = 1."""
    return la.sections.Section(((-n_p, 0.0), (0.0, m_p), (n_p, 0.0)), "diamond")


FEET = [(("A", "D"), "clamped")]
BACKENDS = ("clarabel", "highs", "cvxpy", "ipopt-static")


def portal(h, span, m_p, n_p):
    column = diamond(m_p, n_p)
    return la.Frame(
        {"A": (0, 0), "B": (0, h), "C": (span, h), "D": (span, 0)},
        {"left": ("A", "B"), "beam": ("B", "C"), "right": ("D", "C")},
        sections={"left": column, "right": column, "beam": la.sections.rigid()},
    )


@pytest.mark.parametrize("backend", BACKENDS)
def test_portal_by_hand(backend):
    """Four hinges in the columns, V = H h/(2 L) in them, below P: what one loses the other gains.

    ``H h = 2 M(P - V) + 2 M(P + V) = 4 M_p (1 - P/N_p)``.
    """
    h, span, press, m_p, n_p = 3.0, 5.0, 2.0, 1.5, 10.0
    dead = [force(node, (0, -press)) for node in "BC"]
    state = solved(portal(h, span, m_p, n_p), [force("B", RIGHT)], FEET, dead, backend)
    assert state.load_factor == pytest.approx(4 * m_p * (1 - press / n_p) / h, rel=BAR)
    hinges = state.hinges
    uplift = state.load_factor * h / (2 * span)
    axial = -press + uplift * np.where(hinges["member"] == "left", 1, -1)
    assert hinges["axial_force"].to_numpy() == pytest.approx(axial, abs=1e-5)
    assert set(hinges["state"]) == {"turns"}
    moments = m_p * (1 - np.abs(axial) / n_p)
    assert np.abs(hinges["moment"]).to_numpy() == pytest.approx(moments, abs=1e-5)


def test_certificates_refuse_what_was_planted():
    state = solved(portal(3.0, 5.0, 1.5, 10.0), [force("B", RIGHT)], FEET, backend="clarabel")
    assert state.certify().holds(1e-6)
    for row, factor in ((0, 1.01), (2, 0.9), (3, -1.0)):
        planted = state.hinges
        planted.loc[row, "moment"] *= factor
        assert not state.certify(hinges=planted).holds(1e-6)
    moved = {"frame": state.velocity["frame"].copy()}
    moved["frame"][1, 1] += 0.01
    assert not state.certify(velocity=moved).holds(1e-6)
    assert state.certify(hinges=state.hinges, velocity=state.velocity).holds(1e-6)


def test_column_alone():
    """N_p under a force on top; under its own weight, too, all of which its foot carries."""
    column = la.Frame({"A": (0, 0), "B": (0, 3)}, {"c": ("A", "B")}, sections=diamond(1.5, 4.0))
    foot = [("A", "clamped")]
    assert solved(column, [force("B", DOWN)], foot).load_factor == pytest.approx(4.0, rel=BAR)
    weight = [la.Traction("frame", "c", DOWN)]
    assert solved(column, weight, foot).load_factor == pytest.approx(4.0 / 3, rel=BAR)
    # A force across, under a force along: M_p (1 - N/N_p) = H h.
    across = solved(column, [force("B", RIGHT)], foot, [force("B", (0, -1))])
    assert across.load_factor == pytest.approx(1.5 * (1 - 1 / 4) / 3, rel=BAR)


def test_truss_of_three_bars():
    """All three yield: N (1 + 2 cos 45)."""
    nodes = {"a": (-1, 1), "b": (0, 1), "c": (1, 1), "o": (0, 0)}
    truss = la.Frame(nodes, [(top, "o") for top in "abc"], sections=la.sections.bar(2.0))
    state = solved(truss, [force("o", DOWN)], [(("a", "b", "c"), "xy")])
    assert state.load_factor == pytest.approx(2 * (1 + sqrt(2)), rel=BAR)
    assert state.hinges["axial_force"].to_numpy() == pytest.approx([2.0] * 3)
    assert state.hinges["state"][1] == "stretches"  # of the others one may do, or both
    assert list(state.hinges["node"]) == [""] * 3


@pytest.mark.parametrize(("strength", "expected"), [(0.25, 1.5 / 3 + 0.25), (inf, 3.0)])
def test_cantilever_on_a_strut(strength, expected):
    """M_p/L + S at the tip while the strut yields; on a rigid one (4 + 2) M_p/L at mid-span."""
    frame = la.Frame(
        {"a": (0, 0), "b": (3, 0), "s": (3, -2)},
        {"beam": ("a", "b"), "strut": ("s", "b")},
        plastic_moment=1.5,
        sections={"strut": la.sections.bar(strength)},
    )
    at = "b" if np.isfinite(strength) else (1.5, 0.0)
    state = solved(frame, [force(at, DOWN)], [("a", "clamped"), ("s", "xy")])
    assert state.load_factor == pytest.approx(expected, rel=BAR)


@pytest.mark.parametrize(
    ("held", "expected"), [("clamped", 16.0), ("y", 6 + 4 * sqrt(2)), ("xy", 6 + 4 * sqrt(2))]
)
@pytest.mark.parametrize("section", [None, la.sections.plastic(1.0), diamond(1.0, 50.0)])
def test_uniform_load(held, expected, section):
    """16 M_p/L^2 fixed, 11.657 propped: with hinges where the moment peaks, and nowhere beyond."""
    moment = 1.0 if section is None else None
    beam = la.Frame({"a": (0, 0), "b": (1, 0)}, {"m": ("a", "b")}, moment, sections=section)
    load = [la.Traction("frame", "m", DOWN)]
    state = solved(beam, load, [("a", "clamped"), ("b", held)])
    assert state.load_factor == pytest.approx(expected, rel=BAR)


def test_the_peak_between_nodes_is_that_of_both_forces():
    """An inclined beam under its weight, pinned below, leaning against a wall: N falls upwards.

    ``N(x)/N_p + M(x)/M_p``, x from the top, peaks where its derivative is 0.
    """
    angle, length, m_p, n_p = 0.6, 3.0, 1.5, 4.0
    c, s = np.cos(angle), np.sin(angle)
    lean = length / 2 * c / s
    x = (lean * s + s * m_p / n_p) / c
    most = (lean * c + x * s) / n_p + (lean * s * x - c * x**2 / 2) / m_p
    nodes = {"a": (0, 0), "b": (length * c, length * s)}
    beam = la.Frame(nodes, {"beam": ("a", "b")}, sections=diamond(m_p, n_p))
    state = solved(beam, [la.Traction("frame", "beam", DOWN)], [("a", "xy"), ("b", "x")])
    assert state.load_factor == pytest.approx(1 / most, rel=BAR)


@pytest.mark.parametrize("backend", ["clarabel", "highs", "cvxpy"])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_strut_bears_more_in_one_sense(sign, backend):
    """Pulled to the right the left bar stretches, the right one shortens: t + c, either way."""
    nodes = {"a": (-1, 0), "o": (0, 0), "b": (2, 0)}
    given = {"left": la.sections.bar(2.0, 0.5), "right": la.sections.bar(0.0, 3.0)}
    pair = la.Frame(nodes, {"left": ("a", "o"), "right": ("o", "b")}, sections=given)
    held = [(("a", "b"), "xy"), ("o", "y")]
    state = solved(pair, [force("o", (sign, 0.0))], held, backend=backend)
    expected = {1.0: 2.0 + 3.0, -1.0: 0.5 + 0.0}[sign]
    assert state.load_factor == pytest.approx(expected, rel=BAR)
    forces = {1.0: [2.0, -3.0], -1.0: [-0.5, 0.0]}[sign]
    assert state.hinges["axial_force"].to_numpy() == pytest.approx(forces, abs=1e-5)
    pull = state.support_reactions.groupby("x")["force_x"].sum()
    assert pull[-1.0] == pytest.approx(-forces[0], abs=1e-5)
    assert pull[2.0] == pytest.approx(forces[1], abs=1e-5)
    assert state.certify().holds(1e-6)


@pytest.mark.parametrize(("weight", "stands"), [(0.9, True), (1.1, False)])
def test_whether_a_weight_on_a_cable_stands(weight, stands):
    """What the bar holds in its middle is no load: the weight alone is judged."""
    hung = la.Frame(
        {"a": (0, 0), "o": (0, -1)}, {"c": ("a", "o")}, sections=la.sections.bar(1.0, 0.0)
    )
    fixed = [la.Fix("frame", "a"), la.Fix("frame", "o", "x")]
    dead = [force("o", (0, -weight))]
    state = la.solve(la.Problem({"frame": hung}, [force("o", (0, -1))], fixed, dead_loads=dead))
    assert state.load_factor == pytest.approx(1 - weight, abs=BAR)
    assert (state.stability().standing is la.Standing.STANDS) == stands


def test_a_column_that_bears_no_tension():
    """N from -4 to 0, M largest at -2: a push at the top of h needs weight, as a pier does."""
    pier = la.sections.Section(((-4.0, 0.0), (-2.0, 1.0), (0.0, 0.0)))
    column = la.Frame({"A": (0, 0), "B": (0, 2)}, {"c": ("A", "B")}, sections=pier)
    for weight, moment in ((1.0, 0.5), (2.0, 1.0), (3.0, 0.5)):
        dead = [force("B", (0, -weight))]
        state = solved(column, [force("B", RIGHT)], [("A", "clamped")], dead)
        assert state.load_factor == pytest.approx(moment / 2, rel=BAR)


def test_beam_column_of_a_rolled_section():
    """Clamped, under N = 0.4 N_p: M reduced as the stresses of the exact section say."""
    inner, outer = (
        la.sections.standard("HEA 200", 235e6, layers=24, polygon=polygon)
        for polygon in ("inner", "outer")
    )
    press, h = 0.4 * inner.squash_load, 4.0
    factors = []
    for section in (inner, outer):
        column = la.Frame({"A": (0, 0), "B": (0, h)}, {"c": ("A", "B")}, sections=section)
        dead = [force("B", (0, -press))]
        state = solved(column, [force("B", (1e3, 0))], [("A", "clamped")], dead)
        factors.append(1e3 * state.load_factor * h)
    profile = PROFILES["HEA 200"]
    axis = brentq(lambda y: 235e6 * profile.area(np.array([y]))[0] - press, 0, profile.height / 2)
    exact = 235e6 * profile.moment(np.array([axis]))[0]
    assert factors[0] <= exact * (1 + BAR)
    assert exact <= factors[1] * (1 + BAR)
    # 12 layers a flange: polygons are 1/12^2 of a flange's share apart, no more than 1 %.
    assert factors[1] / factors[0] < 1.01


def random_frame(seed):
    """Two storeys with diagonals that are bars, columns in which N and M interact."""
    draw = np.random.default_rng(seed)
    nodes, members = storeys(draw)
    column = la.sections.rectangle(draw.uniform(0.1, 0.3), draw.uniform(0.1, 0.3), 100.0, layers=3)
    given = dict.fromkeys((name for name in members if name[0] == "c"), column)
    given["d"] = la.sections.bar(draw.uniform(0.1, 1.0))
    frame = la.Frame(nodes, members, plastic_moment=draw.uniform(0.1, 0.5), sections=given)
    live, dead = draw.uniform(-1, 1, (2, 6, 2)) * [[[1.0]], [[0.05]]]
    return frame, live, dead


@pytest.mark.parametrize("seed", one_in(3, range(12)))
def test_storeys_against_the_static_theorem(seed):
    """An independent linear program in forces, its polygons as inequalities."""
    found, expected = storeys_both_ways(*random_frame(seed))
    assert found == pytest.approx(expected, rel=BAR)


def test_copies_and_pickles():
    frame = portal(3.0, 5.0, 1.5, 10.0)
    again = pickle.loads(pickle.dumps(frame))
    assert again.section_of[0].corners == frame.section_of[0].corners
    assert "rigid" in str(frame)
    assert "diamond" in str(frame)


def two(**given):
    return la.Frame({"A": (0, 0), "B": (0, 3), "C": (3, 3)}, [("A", "B"), ("B", "C")], **given)


ROUND = la.sections.rectangle(0.1, 0.1, 1e6)
WRONG = {
    "both": (lambda: two(plastic_moment=1.0, sections=ROUND), "all members have sections"),
    "twice": (
        lambda: two(plastic_moment={"A-B": 1.0, "B-C": 1.0}, sections={"B-C": ROUND}),
        "this member has a section; give one of the two",
    ),
    "none": (lambda: two(sections={"B-C": ROUND}), r"\['A-B'\]: members without one"),
    "unknown": (lambda: two(plastic_moment=1.0, sections={"B-D": ROUND}), "did you mean 'B-C'"),
    "no section": (lambda: two(plastic_moment=1.0, sections={"B-C": 5.0}), "not a section"),
    "no sections": (lambda: two(sections=7.0), "not a section; give a section of lacore.sections"),
    "name": (lambda: la.sections.standard("IPE 310", 1.0), "no section of the table.*IPE 3"),
    "strength": (lambda: la.sections.bar(-1.0), "tension = -1.0: not a strength"),
    "web": (lambda: la.sections.i_section(0.1, 0.1, 0.2, 0.01, 0.0, 1.0), "do not fit"),
    "polygon": (
        lambda: la.sections.rectangle(1, 1, 1, polygon="middle"),
        "did you mean 'inner'|polygon",
    ),
    "hollow": (
        lambda: la.sections.Section(((-2, 0), (-1, 0.1), (0, 1), (1, 0.1), (2, 0))),
        "no upper half of a convex polygon",
    ),
    "nothing": (lambda: la.sections.bar(0.0), "a bar that bears nothing"),
    "one without limit": (lambda: la.sections.bar(inf, 1.0), "tension = inf: not a strength"),
    "yields alone": (
        lambda: la.sections.Section(((1.0, 0.0), (2.0, 1.0), (3.0, 0.0))),
        "let N = M = 0 lie inside",
    ),
    "numbers": (lambda: la.sections.Section(((-2, 0), "ab")), r"not \(N, M\)"),
    "bar with a node": (
        lambda: la.Frame(
            {"A": (0, 0), "B": (3, 0), "C": (1, 0), "D": (1, 1)},
            {"bar": ("A", "B"), "post": ("C", "D")},
            plastic_moment=1.0,
            sections={"bar": la.sections.bar(1.0)},
        ),
        "a bar with the node 'C' inside",
    ),
    "bar under a load": (
        lambda: la.Problem(
            {"frame": two(plastic_moment=1.0, sections={"B-C": la.sections.bar(1.0)})},
            [la.Traction("frame", "B-C", DOWN)],
            [la.Fix("frame", ("A", "C"))],
        ),
        "a bar, which carries axial force alone; load its nodes",
    ),
}


@pytest.mark.parametrize(("build", "told"), WRONG.values(), ids=WRONG)
def test_what_cannot_be(build, told):
    with pytest.raises(InputError, match=told):
        build()
