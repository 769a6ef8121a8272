"""Bodies of several regions, and strengths that vary from place to place."""

from dataclasses import replace
from itertools import pairwise
from math import cos, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from lacore.bounds.equilibrium import element_geometry
from lacore.bounds.upper import plastic_power
from lacore.model.bodies.continuum.regions.varying import in_elements

EXACT = 1e-6  # the mechanism lies in every space: what is left is the bar of the certificate
# Shares of a gap are sums of the two solves' round-off and residuals, here of load factors of 1.
ROUND_OFF = 1e-7
SPACES = ("p2-vertex", "p1-disc", "p2-disc", "p2-gauss")


def halves(nx=4, ny=4):
    """Two layers on top of each other, 2 x 1/2 each."""
    return la.meshes.layered((0, 2), {"low": (0, 0.5), "high": (0.5, 1)}, nx, ny)


def pulled(criterion, space="p2-vertex", mesh=None, **more):
    """A bar 2 x 1, pulled by a uniform velocity at its end: strains are those of a uniform one."""
    body = la.Body(halves() if mesh is None else mesh, criterion, space=space, **more)
    return la.Problem(
        {"bar": body},
        [la.RigidFooting("bar", "right", (1.0, 0.0), rough=False)],
        [la.Fix("bar", "left", "x"), la.Fix("bar", "bottom", "y")],
    )


def tension(c, phi):
    """Strength of soil in tension beside none, in plane strain."""
    return 2 * c * cos(radians(phi)) / (1 + sin(radians(phi)))


MIXED = {
    "metal and soil": ({"low": la.VonMises(1.0), "high": la.MohrCoulomb(2.0, 25)}, 2.0, (2, 25)),
    "two soils": ({"low": la.MohrCoulomb(1.0, 10), "high": la.MohrCoulomb(2.0, 25)}, None, (2, 25)),
}


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("name", MIXED)
def test_layers_of_different_criteria_carry_the_sum(name, space):
    """Each is stretched as the other, grows thinner or thicker by its own law, and slides past
    nothing: the load is that of the two bars, on any mesh, from both sides."""
    criteria, metal, soil = MIXED[name]
    exact = ((tension(1.0, 10) if metal is None else metal) + tension(*soil)) / 2
    problem = pulled(criteria, space)
    state = la.solve(problem, throw=True)
    assert state.load_factor == pytest.approx(exact, rel=EXACT)
    lower = la.lower_bound(problem, throw=True)
    assert lower.load_factor == pytest.approx(exact, rel=EXACT)
    sigma = state.stress["bar"][..., 0].mean(axis=1)
    high = problem.bodies["bar"].mesh.subdomains["high"]
    # Stresses of elements oscillate about it; all are of one size.
    assert sigma[high].mean() == pytest.approx(tension(*soil), rel=1e-4)
    assert [group.name for group in state.program.groups][:2] == ["bar.low", "bar.high"]


def test_a_region_of_all_is_no_region():
    mesh = halves().with_subdomains({"all": lambda x: x[0] < 9})
    whole, parts = (
        la.discretise(pulled(criterion, mesh=mesh)).full.groups
        for criterion in (la.VonMises(2.0), {"all": la.VonMises(2.0)})
    )
    for one, other in zip(whole, parts, strict=True):
        assert np.array_equal(one.bound, other.bound)
        assert abs(one.rows - other.rows).max() == abs(one.volumetric - other.volumetric).max() == 0


@pytest.mark.parametrize("space", SPACES)
def test_one_strength_stated_in_three_ways_is_one(space):
    """By regions, by elements, and as a function that jumps between elements."""
    mesh = halves()
    high = mesh.p[1, mesh.t].mean(axis=0) > 0.5
    ways = (
        {"low": la.VonMises(1.0), "high": la.VonMises(3.0)},
        la.VonMises(np.where(high, 3.0, 1.0)),
        la.VonMises(lambda x: np.where(x[1] > 0.5, 3.0, 1.0)),
    )
    for criterion in ways:
        problem = pulled(criterion, space, mesh)
        state = la.solve(problem, throw=True)
        assert state.load_factor == pytest.approx(2.0 * 2.0, rel=EXACT)
        if space != "p2-gauss":
            upper = la.upper_bound(state)
            assert (state.rigor, upper.rigor) == (la.Rigor.UPPER, la.Rigor.UPPER)
            assert upper.load_factor == pytest.approx(4.0, rel=EXACT)


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("phi", [0, 20])
def test_a_strength_linear_with_height_is_exact(space, phi):
    """Uniform strain, and stresses as linear as the strength: both bounds are the mean of it."""
    kind = la.VonMises if not phi else lambda c: la.MohrCoulomb(c, phi)
    problem = pulled(kind(lambda x: 1.0 + 3.0 * x[1]), space)
    exact = (2.0 if not phi else tension(1.0, phi)) * 2.5
    assert la.lower_bound(problem, throw=True).load_factor == pytest.approx(exact, rel=EXACT)
    state = la.solve(problem, throw=True)
    assert state.load_factor == pytest.approx(exact, rel=EXACT)
    if space != "p2-gauss":
        assert la.upper_bound(state).load_factor == pytest.approx(exact, rel=EXACT)


def test_what_is_not_linear_needs_its_slope():
    """k = 1 + y^2: with its largest slope 2 bounds enclose the mean 4/3, about 2 slope h apart."""
    curved = pulled(la.VonMises(lambda x: 1 + x[1] ** 2))
    assert la.solve(curved).rigor is la.Rigor.DISCRETE
    for bound in (la.lower_bound, la.upper_bound):
        with pytest.raises(la.InputError, match=r"not linear in each element.*steepest="):
            bound(curved)
    known = pulled(la.VonMises(la.Field(lambda x: 1 + x[1] ** 2, steepest=2.0)))
    lower, upper = la.lower_bound(known), la.upper_bound(known)
    assert lower.load_factor < 2 * 4 / 3 < upper.load_factor
    assert upper.load_factor - lower.load_factor < 4 * 2 * 0.25  # elements are 1/4 high
    with pytest.raises(la.InputError, match=r"steepest = 0.5: the function is steeper near"):
        pulled(la.VonMises(la.Field(lambda x: 1 + x[1] ** 2, steepest=0.5)))


@pytest.mark.parametrize("kind", [la.VonMises, lambda c: la.MohrCoulomb(c, 20.0), la.Rankine])
def test_elements_that_a_slope_leaves_no_strength_are_named(kind):
    """Slope times size is more than there is; an upper bound needs no least strength."""
    steep = pulled(kind(la.Field(lambda x: 1 + x[1] ** 2, steepest=20.0)))
    with pytest.raises(la.InputError, match=r"near \(.*may have no strength.*steepest slope"):
        la.lower_bound(steep)
    if kind is not la.Rankine:
        assert la.upper_bound(steep).status is la.Status.SOLVED


@pytest.mark.parametrize(
    ("criterion", "message"),
    [
        ({"hight": la.VonMises(1.0)}, "no such region of the mesh; did you mean 'high'?"),
        ({"low": la.VonMises(1.0)}, "32 elements in no region, near .* has also high"),
        ({}, "no region"),
        ({"low": 3.0, "high": la.VonMises(1.0)}, r"criterion\['low'\] = 3.0: not a yield"),
        (la.VonMises(lambda x: x[1] - 0.25), r"shear_strength = -0.25: at \(.*\): negative"),
        (la.MohrCoulomb(lambda x: -x[1], 30), r"cohesion = .*: at \(.*\): negative"),
        (la.VonMises(lambda x: 0 * x[1]), r"no strength at \(.*\), and no friction either"),
        (la.VonMises(lambda x: np.full(3, 1.0)), "does not return an array of shape"),
        (la.VonMises(lambda x: x[7]), "the function fails .* IndexError"),
        (la.VonMises(np.ones(7)), "'7 values': the mesh has 64 elements"),
        (la.VonMises(lambda x: np.nan * x[0]), "not a finite number; let it"),
        (la.VonMises(lambda x: -x[0]), "negative; let it"),
        (la.VonMises, "not a yield criterion"),
    ],
)
def test_what_cannot_be_is_said(criterion, message):
    with pytest.raises(la.InputError, match=message):
        pulled(criterion)


def test_regions_that_overlap_are_refused():
    mesh = halves().with_subdomains({"middle": lambda x: abs(x[1] - 0.5) < 0.2})
    one = la.VonMises(1.0)
    with pytest.raises(la.InputError, match=r"'low' in 24 elements, .* m deep, within x = 0 to"):
        la.Body(mesh, {"low": one, "high": one, "middle": one})


@pytest.mark.parametrize("given", [[-1.0, 1.0], [np.nan], "strong", [[[1.0]]], []])
def test_strengths_of_elements_that_are_none(given):
    with pytest.raises(
        la.InputError, match=r"VonMises.shear_strength = .*(negative|not a positive|neither)"
    ):
        la.VonMises(given)


def test_values_at_points_are_those_of_the_space():
    """Two for each element, whose space takes its strains at three."""
    with pytest.raises(la.InputError, match="'p2-vertex' has 3; give one value for each"):
        la.solve(pulled(la.VonMises(np.ones((64, 2)))))


def test_layers_that_do_not_meet():
    with pytest.raises(la.InputError, match=r"layers\['high'\].*does not begin at 0.4"):
        la.meshes.layered((0, 1), {"low": (0, 0.4), "high": (0.5, 1)}, 2, 2)


def test_it_says_what_its_regions_are():
    body = la.Body(
        halves(), {"low": la.VonMises(lambda x: 1 + x[1]), "high": la.MohrCoulomb(2, 30)}
    )
    told = repr(body)
    assert "low: k = 1 to 1.5 Pa; high: c = 2 Pa, φ = 30°" in told
    assert "shear_strength 1 to 1.5 Pa" in told


strengths = st.floats(0.1, 10.0)


@given(st.lists(strengths, min_size=3, max_size=3), strengths, st.floats(0.1, 10.0))
def test_bounds_of_any_strengths_enclose_and_scale(plane, second, factor):
    """Laws of limit loads: what strengths are times, load factors are; more strength carries no
    less; the gap is a sum of shares none of which is negative."""
    a, b, c = plane
    mesh = halves(3, 2)

    def problem(scale, more=0.0):
        return la.Problem(
            {
                "bar": la.Body(
                    mesh,
                    {
                        "low": la.VonMises(lambda x: scale * (a + b * x[0] + c * x[1] + more)),
                        "high": la.MohrCoulomb(scale * (second + more), 20),
                    },
                )
            },
            [la.Pressure("bar", "top", 1.0)],
            [la.Fix("bar", "bottom")],
        )

    lower, upper = la.lower_bound(problem(1.0)), la.upper_bound(problem(1.0))
    identity = la.gap_identity(upper, lower)
    assert identity.total == pytest.approx(upper.load_factor - lower.load_factor, rel=1e-6)
    assert identity.least >= -ROUND_OFF * upper.load_factor
    scaled = la.lower_bound(problem(factor)).load_factor
    assert scaled == pytest.approx(factor * lower.load_factor, rel=1e-6)
    assert la.lower_bound(problem(1.0, 0.5)).load_factor > lower.load_factor


def test_a_path_takes_strengths_along():
    """Of regions and of places: bars side by side carry the sum while they are stretched."""
    ways = (
        ({"low": la.VonMises(1.0), "high": la.MohrCoulomb(lambda x: 2.0 + 0 * x[0], 25)}, None),
        (la.VonMises(lambda x: 1.0 + 4.0 * x[1]), 2.0 * 3.0),
    )
    for criterion, exact in ways:
        path = la.sequential(pulled(criterion, "p2-gauss"), travel=0.1, steps=2)
        first = (2.0 + tension(2.0, 25)) / 2 if exact is None else exact
        # Soil grows beside metal that keeps its volume: its share of the height, by 1 % a step.
        rest = 1e-2 if exact is None else EXACT
        assert path.history["load_factor"].to_numpy() == pytest.approx(first, rel=rest)


def test_weights_act_in_regions():
    """Half of the weight is that of the upper layer, and both are that of the body."""
    body = la.Body(halves(), la.VonMises(1.0))

    def stated(*where):
        loads = [la.BodyForce("bar", (0, -1), where=part) for part in where]
        return la.Problem({"bar": body}, loads, [la.Fix("bar", "bottom")])

    whole, parts = (la.discretise(stated(*w)).full for w in ((None,), ("low", "high")))
    assert parts.reference_load == pytest.approx(whole.reference_load, abs=1e-14)
    bounds = [la.lower_bound(stated(part)).load_factor for part in ("high", None)]
    assert bounds[0] > bounds[1] > 0
    with pytest.raises(la.InputError, match=r"where = 'hih': no such region .* 'high'"):
        stated("hih")


@pytest.mark.parametrize(
    "criterion",
    [
        {"low": la.VonMises(1.0), "high": la.VonMises(4.0)},
        {"low": la.VonMises(1.0), "high": la.MohrCoulomb(lambda x: 1.0 + x[1], 20)},
        la.MohrCoulomb(np.linspace(1, 2, 64), 20),
    ],
)
def test_meshes_that_are_refined_keep_regions_and_values(criterion):
    body = la.Body(halves(), criterion)
    problem = la.Problem({"bar": body}, [la.Pressure("bar", "top")], [la.Fix("bar", "bottom")])
    bracket = la.bracket(problem, target_width=0.04, max_elements=600)
    finer = bracket.lower_bound.model.continua["bar"].body
    areas = [
        [element_geometry(own)[0][region.elements].sum() for region in own.regions]
        for own in (body, finer)
    ]
    assert finer.mesh.nelements > body.mesh.nelements
    assert areas[0] == pytest.approx(areas[1], rel=1e-12)
    assert bracket.lower <= bracket.upper
    identity = la.gap_identity(la.upper_bound(problem), la.lower_bound(problem))
    assert identity.least >= -ROUND_OFF * bracket.upper


def test_factors_of_safety_weaken_all_regions():
    """Without friction anywhere the factor is the load factor."""
    body = la.Body(halves(), {"low": la.VonMises(4.0), "high": la.VonMises(lambda x: 2.0 + x[1])})
    problem = la.Problem({"bar": body}, [la.BodyForce("bar", (0, -1))], [la.Fix("bar", "bottom")])
    factor = la.safety_factor(problem)
    assert factor.lower == pytest.approx(la.lower_bound(problem).load_factor, rel=2e-3)
    assert factor.upper == pytest.approx(la.upper_bound(problem).load_factor, rel=2e-3)


@pytest.mark.parametrize("space", ["p2-vertex", "p2-disc", "p1-disc"])
@given(st.lists(st.floats(0.1, 3.0), min_size=3, max_size=3), st.integers(0, 100))
def test_rules_are_above_the_dissipation_of_strengths_that_vary(space, plane, seed):
    """On finer lattices they fall, in each element, towards the integral; of any velocity."""
    a, b, c = plane
    criterion = {
        "low": la.VonMises(lambda x: a + b * x[0] + c * x[1]),
        "high": la.VonMises(lambda x: a + b * (2 - x[0]) + c * (1 - x[1])),
    }
    d = la.discretise(pulled(criterion, space, halves(2, 2)))
    velocity = np.random.default_rng(seed).normal(size=d.full.n)
    powers = [plastic_power(d, velocity, parts)["bar"] for parts in (1, 2, 16)]
    for coarse, fine in pairwise(powers):
        assert np.all(coarse >= fine * (1 - 1e-12))


@pytest.mark.parametrize("space", ["p2-vertex", "p2-disc"])
@pytest.mark.parametrize("parts", [1, 3])
def test_what_is_linear_twice_is_integrated_exactly(space, parts):
    """u = (y^2, 0) shears by 2 y, against k = 1 + 2 x + 3 y: int k 2 y = 2 (1 + 2) + 3 (4/3)."""
    d = la.discretise(pulled(la.VonMises(lambda x: 1 + 2 * x[0] + 3 * x[1]), space))
    dofs, velocity = d.continua["bar"], np.zeros(d.full.n)
    velocity[dofs.dofs[0]] = dofs.nodes[1] ** 2
    power = plastic_power(d, velocity, parts)["bar"].sum()
    assert power == pytest.approx(2 * (1 + 2) + 3 * 4 / 3, rel=1e-9)  # 1e-6 inside of elements


@pytest.mark.parametrize("sign", [1, -1], ids=["ridge", "trough"])
def test_strengths_are_bounded_between_the_places_that_are_looked_at(sign):
    """A ridge 0.1 wide beside all corners, centres and quarters, no steeper than is said."""

    def uneven(x):
        ridge = np.maximum(0.05 - np.abs(x[0] - 0.4), 0.0)
        return 2.0 + 0.01 * x[0] ** 2 + sign * 10.0 * ridge

    own = la.Field(uneven, steepest=10.1)
    mesh = la.meshes.rectangle((0, 1), (0, 1), 1, 1, crossed=False)
    bounds = in_elements("k", own, mesh, np.arange(2), positive=True)
    assert bounds.vertex == pytest.approx(np.full((2, 3), 2.0), abs=0.02)
    assert bounds.below().max() <= 1.52  # 0.5 below 2, and the rise of a hundredth
    assert bounds.above().min() >= 2.5


def test_what_looks_linear_is_bounded_by_its_slope_where_one_is_said():
    """A ridge so narrow that all 15 places of an element miss it."""

    def ridge(x):
        return 2.0 + 10.0 * np.maximum(0.01 - np.abs(x[0] - 0.4), 0.0)

    own = la.Field(ridge, steepest=10.0)
    mesh = la.meshes.rectangle((0, 1), (0, 1), 1, 1, crossed=False)
    bounds = in_elements("k", own, mesh, np.arange(2), positive=True)
    assert np.ptp(bounds.vertex) == 0.0
    assert bounds.above().min() >= 2.1
    with_none = in_elements("k", la.Field(ridge), mesh, np.arange(2), positive=True)
    assert with_none.linear  # nothing was said of it


def test_several_values_of_an_element_are_bounded_by_the_least_and_the_largest():
    values = np.array([[1.0, 3.0, 2.0], [5.0, 4.0, 4.5]])
    mesh = la.meshes.rectangle((0, 1), (0, 1), 1, 1, crossed=False)
    bounds = in_elements("k", la.Field(values), mesh, np.arange(2), positive=True)
    assert bounds.below()[:, 0].tolist() == [1.0, 4.0]
    assert bounds.above()[:, 0].tolist() == [3.0, 5.0]
    assert [own.tolist() for own in bounds.limits()] == [[1.0, 4.0], [3.0, 5.0]]


@pytest.mark.parametrize("under", [la.MohrCoulomb(0.0, 30), la.MohrCoulomb(1e6, 30)])
@pytest.mark.parametrize("order", [("low", "high"), ("high", "low")])
def test_the_region_named_first_sets_no_scale(under, order):
    """Clay pressed on what has no strength by itself, or a million times as much: named first it
    was the scale of all forces, and there was none, or one that the load was round-off of."""
    criteria = {"low": under, "high": la.VonMises(1.0)}
    problem = la.Problem(
        {"soil": la.Body(halves(), {name: criteria[name] for name in order})},
        [la.RigidFooting("soil", lambda x: (x[1] == 1) & (x[0] <= 1), (0, -1))],
        [la.Fix("soil", "left", "x"), la.Fix("soil", "right", "x"), la.Fix("soil", "bottom")],
    )
    state = la.solve(problem, throw=True)
    other = la.solve(replace(problem, bodies={"soil": la.Body(halves(), criteria)}))
    assert state.load_factor == pytest.approx(other.load_factor, rel=2e-6)  # two certificates
