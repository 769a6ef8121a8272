"""Friction angles that vary: as those of regions, of homogeneous states, and between envelopes."""

from math import cos, radians, sin, tan

import numpy as np
import pytest

import lacore as la
from lacore.model.bodies.continuum.regions.layers import Layer

LOOSE, DENSE = 20.0, 35.0
SAME = 1e-8  # of one program in another order: the gap that Clarabel leaves; mostly it is 1e-12
ROUND_OFF = 1e-7  # of shares of a gap: two solves' residuals, of load factors of 10


def mesh(nx=4, ny=4):
    return la.meshes.layered((0, 2), {"low": (0, 0.5), "high": (0.5, 1)}, nx, ny)


def of_elements(mesh):
    angles = np.full(mesh.nelements, DENSE)
    angles[mesh.subdomains["low"]] = LOOSE
    return angles


def jumping(x):
    return np.where(x[1] < 0.5, LOOSE, DENSE)


def pressed(criterion, mesh, **more):
    """A footing on half of a box of soil."""
    return la.Problem(
        {"soil": la.Body(mesh, criterion, **more)},
        [la.RigidFooting("soil", lambda x: (x[1] == 1) & (x[0] <= 0.5), (0, -1))],
        [la.Fix("soil", "bottom"), la.Fix("soil", "left", "x"), la.Fix("soil", "right", "x")],
    )


def three_ways(mesh, cohesion=1.0, **more):
    """By regions, by elements, as a function that jumps between elements."""
    regions = {
        "low": la.MohrCoulomb(cohesion, LOOSE, **more),
        "high": la.MohrCoulomb(cohesion, DENSE, **more),
    }
    angles = (of_elements(mesh), jumping)
    return [regions, *(la.MohrCoulomb(cohesion, angle, **more) for angle in angles)]


@pytest.mark.parametrize(
    ("space", "more"),
    [
        ("p2-vertex", {}),
        ("p2-gauss", {}),
        ("p1-disc", {}),
        ("p2-disc", {}),
        ("p2-gauss", {"kinematics": "axisymmetric"}),
        ("p2-vertex", {"kinematics": "plane_stress"}),
    ],
)
@pytest.mark.parametrize("cohesion", [1.0, la.Linear(2.0, (0.5, -1.0))])
def test_angles_by_regions_and_by_elements_are_one(space, more, cohesion):
    own = mesh()
    loads = [
        la.solve(pressed(criterion, own, space=space, **more), throw=True).load_factor
        for criterion in three_ways(own, cohesion)
    ]
    assert loads[1:] == pytest.approx([loads[0], loads[0]], rel=SAME)


def test_bounds_and_gaps_by_regions_and_by_elements_are_one():
    """Lower bounds are solved again with a margin or not: 1e-8 is what that may cost."""
    own, found = mesh(), []
    for criterion in three_ways(own, tension_cutoff=0.5):
        problem = pressed(criterion, own)
        lower, upper = la.lower_bound(problem, throw=True), la.upper_bound(problem, throw=True)
        gap = la.gap_identity(upper, lower)
        assert gap.total == pytest.approx(upper.load_factor - lower.load_factor, rel=1e-9)
        assert gap.least >= -ROUND_OFF
        found.append((lower.load_factor, upper.load_factor))
    assert found[1] == pytest.approx(found[0], rel=1e-8)
    assert found[2] == pytest.approx(found[0], rel=1e-8)


@pytest.mark.parametrize("space", ["p2-vertex", "p1-disc", "p2-disc"])
def test_a_bar_of_two_soils_carries_the_sum_of_both(space):
    """Pulled by one velocity both halves yield in tension, 2 c cos(phi)/(1 + sin(phi)) each."""
    own = mesh()
    problem = la.Problem(
        {"bar": la.Body(own, la.MohrCoulomb(1.0, of_elements(own)), space=space)},
        [la.RigidFooting("bar", "right", (1.0, 0.0), rough=False)],
        [la.Fix("bar", "left", "x"), la.Fix("bar", "bottom", "y")],
    )
    exact = np.mean([2 * cos(radians(a)) / (1 + sin(radians(a))) for a in (LOOSE, DENSE)])
    assert la.solve(problem, throw=True).load_factor == pytest.approx(exact, rel=1e-6)
    assert la.lower_bound(problem, throw=True).load_factor == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("cohesion", [1.0, la.Linear(2.0, (0.3, -1.0))])
def test_cones_of_elements_lie_within_and_around_all_of_them(cohesion):
    """At 200 places of each element, by random pressures: what fails is beyond round-off."""
    angle = la.Linear(25.0, (-3.0, 8.0))
    body = la.Body(mesh(), la.MohrCoulomb(cohesion, angle))
    (region,), rng = body.regions, np.random.default_rng(0)
    elements, corners = region.elements, body.mesh.p[:, body.mesh.t]
    for _ in range(200):
        shares = rng.dirichlet(np.ones(3))
        x = np.einsum("a,xae->xe", shares, corners)
        phi = np.radians(angle(x))
        c = cohesion(x) if callable(cohesion) else cohesion
        mean = c / np.tan(phi) - rng.exponential(3.0, elements.size) * rng.integers(0, 2)
        there = c * np.cos(phi) - np.sin(phi) * mean
        within, around = (
            own.surfaces_of(elements).strength_at(mean) for own in (region.within, region.form)
        )
        assert np.all(within <= there + 1e-12)
        assert np.all(around >= there - 1e-12)


def test_bounds_of_an_angle_that_rises_with_depth_enclose_and_close():
    """And they close in on a finer mesh, in whose elements the angle varies less."""
    criterion = la.MohrCoulomb(1.0, la.Linear(25.0, (0.0, -6.0), at=(0.0, 1.0)))
    widths = []
    for n in (2, 4):
        problem = pressed(criterion, mesh(2 * n, 2 * n))
        lower, upper = la.lower_bound(problem, throw=True), la.upper_bound(problem, throw=True)
        gap = la.gap_identity(upper, lower)
        assert gap.least >= -ROUND_OFF
        assert gap.total == pytest.approx(upper.load_factor - lower.load_factor, rel=1e-9)
        widths.append((lower.load_factor, upper.load_factor))
    assert widths[0][0] < widths[1][0] < widths[1][1] < widths[0][1]


def test_a_jump_between_two_angles_costs_what_tractions_within_both_do():
    """On random slips and openings that both allow: the most of the corners of both cones."""
    own = la.meshes.layered((0, 1), {"low": (0, 0.5), "high": (0.5, 1)}, 1, 2, crossed=False)
    soils = {"low": la.MohrCoulomb(1.0, LOOSE), "high": la.MohrCoulomb(0.5, DENSE)}
    body = la.Body(own, soils, space="p1-disc")
    edges = own.p[:, [0]], own.p[:, [1]]
    one, two = (
        Layer.of(region).along(own, edges, region.elements[:1], 2) for region in body.regions
    )
    both = one.within(two).surfaces
    (c1, t1), (c2, t2) = (1.0, tan(radians(LOOSE))), (0.5, tan(radians(DENSE)))
    meet = (c2 - c1) / (t2 - t1)  # normal stress at which both carry the same
    corners = [(0.0, min(c1 / t1, c2 / t2)), (c1 - t1 * meet, meet)]
    for slip, more in np.random.default_rng(1).exponential(1.0, (20, 2)):
        opening = min(t1, t2) * slip + more
        power = both.dissipation(np.full(2, slip), np.full(2, opening))
        exact = max(tau * slip + sigma * opening for tau, sigma in corners)
        assert power == pytest.approx([exact, exact], rel=1e-12)
    assert both.impossible(np.ones(2), np.full(2, min(t1, t2) - 1e-3)).min() > 0


def test_a_safety_factor_by_elements_is_that_of_regions():
    """Tangents of the angles of elements are divided as those of regions are."""
    own = mesh(2, 2)
    one, other = (la.MohrCoulomb(1.0, angle).weakened(1.3) for angle in (DENSE, of_elements(own)))
    assert np.max(other.friction_angle.values) == pytest.approx(one.friction_angle, rel=1e-14)
    with pytest.raises(la.InputError, match="value for each element"):
        la.MohrCoulomb(1.0, jumping).weakened(1.3)


@pytest.mark.parametrize(
    ("angle", "said"),
    [
        (lambda x: 90 * x[1], "not an angle from 0 to 89"),
        (lambda x: 0 * x[1], "without friction"),
        (lambda x: np.where(x[1] < 0.5, 0.0, 30.0), "without friction"),
        (lambda x: 0.5236 + 0 * x[1], "in radians, by its looks"),
        ([20.0, 30.0], "the mesh has 64 elements"),
        (lambda x: x[1] - 5, "negative"),
    ],
)
def test_angles_that_are_none_are_refused(angle, said):
    with pytest.raises(la.InputError, match=said) as refused:
        la.Body(mesh(), la.MohrCoulomb(1.0, angle))
    assert "friction_angle" in refused.value.field


def test_an_angle_that_nobody_knows_within_elements_has_no_bounds():
    problem = pressed(la.MohrCoulomb(1.0, lambda x: 20 + 10 * x[1] ** 2), mesh())
    assert la.solve(problem).load_factor > 0
    with pytest.raises(la.InputError, match="not linear in each element"):
        la.lower_bound(problem)
    known = la.Field(lambda x: 20 + 10 * x[1] ** 2, steepest=20.0)
    problem = pressed(la.MohrCoulomb(1.0, known), mesh())
    assert la.lower_bound(problem).load_factor < la.upper_bound(problem).load_factor


@pytest.mark.parametrize(
    ("kind", "kinematics"),
    [
        (la.MohrCoulomb, "plane_strain"),
        (la.MohrCoulomb, "axisymmetric"),
        (la.DruckerPrager, "plane_strain"),
        (la.DruckerPrager, "axisymmetric"),
    ],
)
def test_dilation_by_regions_and_by_elements_is_one(kind, kinematics):
    """Surfaces of elements, not load factors, of which flow that is not associated has many."""
    own = mesh()
    low, psi = own.subdomains["low"], np.full(own.nelements, 15.0)
    psi[low] = 5.0

    def surfaces(criterion):
        found = np.zeros((own.nelements, 0))
        for region in la.Body(own, criterion, space="p2-gauss", kinematics=kinematics).regions:
            one = region.form.surfaces_of(region.elements)
            numbers = np.concatenate([one.slope, one.flow, one.strength[..., None]], axis=2)
            found = found if found.size else np.zeros((own.nelements, *numbers.shape[1:]))
            found[region.elements] = numbers
        return found

    for high in (LOOSE, DENSE):
        regions = {
            "low": kind(1.0, LOOSE, dilation_angle=5.0),
            "high": kind(1.0, high, dilation_angle=15.0),
        }
        friction = np.full(own.nelements, high)
        friction[low] = LOOSE
        for phi in (LOOSE, friction) if high == LOOSE else (friction,):
            for dilation in (psi, lambda x: np.where(x[1] < 0.5, 5.0, 15.0)):
                one = surfaces(kind(1.0, phi, dilation_angle=dilation))
                assert one == pytest.approx(surfaces(regions), rel=1e-13)


def test_dilation_that_rises_with_height_has_certified_states():
    """And carries no more than with associated flow on the same mesh (T54)."""
    own = mesh(4, 2)
    psi, phi = la.Linear(5.0, (0.0, 10.0)), 20.0
    state = la.solve(
        pressed(la.MohrCoulomb(1.0, phi, dilation_angle=psi), own, space="p2-gauss"), throw=True
    )
    assert state.certificate.holds(1e-6)
    associated = la.solve(pressed(la.MohrCoulomb(1.0, phi), own, space="p2-gauss"), throw=True)
    assert state.load_factor <= associated.load_factor * (1 + 1e-6)


@pytest.mark.parametrize("kinematics", ["plane_strain", "axisymmetric"])
@pytest.mark.parametrize("match", ["plane_strain", "compression", "extension"])
def test_cones_by_regions_and_by_elements_are_one(match, kinematics):
    own = mesh(4, 2)
    regions = {
        name: la.DruckerPrager(1.0, phi, match) for name, phi in (("low", LOOSE), ("high", DENSE))
    }
    more = {"space": "p2-gauss", "kinematics": kinematics}
    criteria = (
        regions,
        *(la.DruckerPrager(1.0, phi, match) for phi in (of_elements(own), jumping)),
    )
    loads = [la.solve(pressed(own_, own, **more), throw=True).load_factor for own_ in criteria]
    assert loads[1:] == pytest.approx([loads[0], loads[0]], rel=SAME)


def test_bounds_of_a_cone_whose_angle_varies_enclose_its_load():
    """In plane strain the cone that is met there is Mohr and Coulomb's: so are its bounds."""
    angle, own = la.Linear(25.0, (0.0, -6.0), at=(0.0, 1.0)), mesh(4, 2)
    cone, soil = (
        (la.lower_bound(problem, throw=True).load_factor, la.upper_bound(problem).load_factor)
        for problem in (
            pressed(kind(1.0, angle), own) for kind in (la.DruckerPrager, la.MohrCoulomb)
        )
    )
    assert cone == pytest.approx(soil, rel=1e-7)
    assert cone[0] < cone[1]


@pytest.mark.parametrize(
    ("criterion", "said"),
    [
        (lambda: la.MohrCoulomb(1.0, 20.0, dilation_angle=lambda x: 15 + 10 * x[1]), "more than"),
        (lambda: la.MohrCoulomb(1.0, jumping, dilation_angle=25.0), "at most the friction angle"),
        (lambda: la.DruckerPrager(1.0, 0.0, dilation_angle=[1.0] * 64), "without friction"),
        (lambda: la.MohrCoulomb(1.0, 20.0, dilation_angle=lambda x: -x[0]), "negative"),
    ],
)
def test_dilation_that_cannot_be_is_refused_with_its_place(criterion, said):
    with pytest.raises(la.InputError, match=said):
        la.Body(mesh(), criterion())


def test_a_sheet_of_a_cone_that_varies_is_refused():
    with pytest.raises(la.InputError, match="axes of cones turn"):
        la.Body(mesh(), la.DruckerPrager(1.0, jumping), kinematics="plane_stress")


def test_what_dilates_less_somewhere_has_no_bounds():
    problem = pressed(la.MohrCoulomb(1.0, DENSE, dilation_angle=of_elements(mesh())), mesh())
    with pytest.raises(la.InputError, match="not associated"):
        la.upper_bound(problem)
    weaker = la.MohrCoulomb(1.0, DENSE, dilation_angle=of_elements(mesh())).weakened(1.3)
    most = weaker.friction_angle
    assert np.max(weaker.dilation_angle.values) == pytest.approx(most, rel=1e-14)
    assert np.min(weaker.dilation_angle.values) == LOOSE


@pytest.mark.parametrize("space", ["p1-disc", "p2-disc"])
def test_a_body_that_is_cut_between_two_soils_and_bonded_is_the_uncut_one(space):
    """Jumps across the bond and within the body cost the same, whichever side has the least c."""
    soils = {"low": la.MohrCoulomb(1.0, LOOSE), "high": la.MohrCoulomb(0.6, DENSE)}
    whole = pressed(soils, mesh(), space=space)
    parts = {
        name: la.Body(la.meshes.rectangle((0, 2), y, 4, 2), soils[name], space=space)
        for name, y in {"low": (0, 0.5), "high": (0.5, 1)}.items()
    }
    cut = la.Problem(
        parts,
        [la.RigidFooting("high", lambda x: (x[1] == 1) & (x[0] <= 0.5), (0, -1))],
        [la.Fix("low", "bottom"), *(la.Fix(n, s, "x") for n in parts for s in ("left", "right"))],
        [la.Interface(("high", "bottom"), ("low", "top"), la.BOND)],
    )
    one, other = (la.solve(problem, throw=True) for problem in (whole, cut))
    assert other.load_factor == pytest.approx(one.load_factor, rel=1e-6)  # bar of a solve
    names = [group.name for group in one.program.groups]
    assert any(name.endswith("jumps next to low") for name in names)
    assert any("next to low: jumps" in group.name for group in other.program.groups)
