"""Bodies of several regions, and strengths that vary from place to place."""

from math import cos, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la

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
    ],
)
def test_what_cannot_be_is_said(criterion, message):
    with pytest.raises(la.InputError, match=message):
        pulled(criterion)


def test_regions_that_overlap_are_refused():
    mesh = halves().with_subdomains({"middle": lambda x: abs(x[1] - 0.5) < 0.2})
    one = la.VonMises(1.0)
    with pytest.raises(la.InputError, match="overlaps region 'low' in 24 elements, near"):
        la.Body(mesh, {"low": one, "high": one, "middle": one})


@pytest.mark.parametrize("given", [[-1.0, 1.0], [np.nan], "strong", [[[1.0]]], []])
def test_strengths_of_elements_that_are_none(given):
    with pytest.raises(
        la.InputError, match=r"VonMises.shear_strength = .*(negative|not a positive|neither)"
    ):
        la.VonMises(given)


def test_layers_that_do_not_meet():
    with pytest.raises(la.InputError, match=r"layers\['high'\].*does not begin at 0.4"):
        la.meshes.layered((0, 1), {"low": (0, 0.4), "high": (0.5, 1)}, 2, 2)


def test_it_says_what_its_regions_are():
    body = la.Body(
        halves(), {"low": la.VonMises(lambda x: 1 + x[1]), "high": la.MohrCoulomb(2, 30)}
    )
    told = repr(body)
    assert "low: k varies; high: c = 2 Pa, φ = 30°" in told
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
