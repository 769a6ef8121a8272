"""Flow that is not associated where surfaces meet: cut-offs, sheets, revolution (T88)."""

from dataclasses import replace
from itertools import combinations
from math import cos, pi, radians, sin, sqrt, tan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog

import lacore as la
from lacore_verification.cases import cavity_cylinder, cavity_sphere, circular_footing_tresca

PHI = 30.0
EXACT = ["clarabel", *(pytest.param(b, marks=pytest.mark.slow) for b in ("cvxpy", "ipopt-static"))]
SINE = sin(radians(PHI))
FREE = 2 * cos(radians(PHI)) / (1 - SINE)  # strength in compression, c = 1: 2 sqrt(3)

CRITERIA = {
    "soil": lambda psi: la.MohrCoulomb(1.3, 30, dilation_angle=psi),
    "sand": lambda psi: la.MohrCoulomb(0.0, 35, dilation_angle=psi),
    "cut off": lambda psi: la.MohrCoulomb(1.0, 30, tension_cutoff=0.3, dilation_angle=psi),
    "crushed": lambda psi: la.MohrCoulomb(1.0, 25, crushing=4.0, dilation_angle=psi),
    "cut off and crushed": lambda psi: la.MohrCoulomb(
        1.0, 20, tension_cutoff=0.2, crushing=4.0, dilation_angle=psi
    ),
}
KINEMATICS = ("plane_strain", "plane_stress", "axisymmetric")
FLOWS = st.lists(st.floats(0.0, 1.0), min_size=9, max_size=9)


def one_point(criterion, kinematics):
    return criterion.conic_form(kinematics).surfaces_of(np.zeros(1, dtype=int))


def yielding(own, pressure, hoop, corner):
    """A stress (q, p) on one surface, or on two: where they meet, if that is allowed."""
    p = np.array([pressure, hoop][: own.volumes])
    normals, strengths = own.planes
    pairs = [
        pair
        for pair in combinations(range(own.count), 2)
        if abs(np.linalg.det(normals[0, pair, :2])) > 1e-6
    ]
    for pair in pairs[corner:] + pairs[:corner]:
        rest = strengths[0, pair] - normals[0, pair, 2:] @ p[1:]
        q, first = np.linalg.solve(normals[0, pair, :2], rest)
        met = np.array([first, *p[1:]])
        if q >= 0 and (own.use(np.array([q]), met) <= own.strength + 1e-12).all():
            return float(q), met
    return float(own.strength_at(p)[0]), p


def flowing(own, multipliers):
    """Strain rates (||d||, v) of multipliers of surfaces, by the rule of flow."""
    slopes = own.slope if own.flow is None else own.flow
    return multipliers @ own.normed, multipliers @ slopes[0]


def defect(own, stress, rates):
    """What flow costs at the friction of a stress less what that does: ``b - sigma:eps``."""
    (q, p), (length, volume) = stress, rates
    frozen = own.at_friction(own.friction(p))
    power = frozen.dissipation(np.array([length]), volume)[0]
    return float(power - q * length - p @ volume)


@pytest.mark.parametrize("kinematics", KINEMATICS)
@pytest.mark.parametrize("name", CRITERIA)
@given(
    dilation=st.sampled_from([0.0, 5.0, 15.0]),
    pressure=st.floats(-3.0, 0.2),
    hoop=st.floats(-1.0, 1.0),
    corner=st.integers(0, 20),
    flows=FLOWS,
)
def test_flow_of_surfaces_that_are_reached_costs_what_stresses_do(
    name, kinematics, dilation, pressure, hoop, corner, flows
):
    """``b >= sigma:eps``, equal for the rule of flow, and for no other multipliers (T88)."""
    own = one_point(CRITERIA[name](dilation), kinematics)
    q, p = yielding(own, pressure, hoop, corner)
    left = (own.strength - own.use(np.array([q]), p))[0]
    if left.min() < -1e-9:  # beyond planes in p alone: no stress to be had there
        return
    lam = np.array(flows[: own.count])
    size = 1.0 + np.abs(own.strength).max() + np.abs(p).max()
    # Multipliers of least cost may be others than these, and cost less.
    # Corners are exact to 1e-12 of their size, and slopes of 5 degrees divide by 0.1.
    other = defect(own, (q, p), flowing(own, lam))
    assert -1e-9 * size <= other <= lam @ left + 1e-9 * size
    reached = np.where(left <= 1e-9 * size, lam, 0.0)
    assert abs(defect(own, (q, p), flowing(own, reached))) <= 1e-8 * size


@pytest.mark.parametrize("kinematics", KINEMATICS)
def test_flow_by_other_slopes_is_refused(kinematics):
    """That of all of the friction, or against the rule, costs more than stresses do."""
    own = one_point(la.MohrCoulomb(1.0, PHI, dilation_angle=10.0), kinematics)
    p = np.array([-1.0, 0.2][: own.volumes])
    q = float(own.strength_at(p)[0])
    left = (own.strength - own.use(np.array([q]), p))[0]
    rubbing = np.abs(own.slope - own.flow)[0].max(axis=1) > 0
    lam = np.where((left <= 1e-12) & rubbing, 1.0, 0.0)
    assert lam.sum() == 1
    length, volume = flowing(own, lam)
    assert defect(own, (q, p), (length, volume)) == pytest.approx(0, abs=1e-12)
    others = {
        "dilates by all of its friction": (length, lam @ own.slope[0]),
        "against the rule": (length, -volume - 0.1),
        "not at all": (length + 1.0, volume),
    }
    frozen = own.at_friction(own.friction(p))
    for name, (long, wide) in others.items():
        impossible = frozen.impossible(np.array([long]), wide)[0]
        assert max(impossible, defect(own, (q, p), (long, wide))) > 1e-2, name


@pytest.mark.parametrize("kinematics", KINEMATICS)
@pytest.mark.parametrize("name", CRITERIA)
def test_multipliers_are_those_of_least_cost(name, kinematics):
    rng = np.random.default_rng(3)
    for dilation in (0.0, 10.0):
        own = one_point(CRITERIA[name](dilation), kinematics)
        at = np.array([-1.0, 0.1][: own.volumes])
        frozen = own.at_friction(own.friction(at))
        for _ in range(20):
            lam = rng.exponential(size=frozen.count) * rng.integers(0, 2, frozen.count)
            rates = flowing(frozen, lam)
            length = np.array([rates[0] * rng.uniform()])
            found = frozen.multipliers(length, rates[1])[0]
            assert found.min() >= 0
            assert found @ frozen.slope[0] == pytest.approx(rates[1], abs=1e-9)
            assert found @ frozen.normed >= length[0] - 1e-9
            cost = frozen.dissipation(length, rates[1])[0]
            assert found @ frozen.strength[0] == pytest.approx(cost, rel=1e-9, abs=1e-9)
            slowest = linprog(
                1 + frozen.normed,  # what is not needed of shear counts as well
                A_eq=frozen.slope[0].T,
                b_eq=rates[1],
                A_ub=[-frozen.normed, frozen.strength[0]],
                b_ub=[-length[0], cost + 1e-9 * abs(cost)],
            ).fun
            # The room of 1e-9 in the cost, by slopes of 10 degrees and less, is 1e-7 in rates.
            assert found @ (1 + frozen.normed) <= slowest * (1 + 1e-6) + 1e-6


def sample(criterion, kinematics, lateral=0.5, pull=-1.0, cells=2):
    """A block under pressure from its sides: the same stress everywhere."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=cells, ny=cells)
    body = la.Body(mesh, criterion, kinematics=kinematics, space="p2-gauss")
    return la.Problem(
        bodies={"block": body},
        supports=[la.Fix("block", "bottom", "y"), la.Fix("block", "left", "x")],
        reference_loads=[la.Traction("block", "top", (0, pull))],
        dead_loads=[la.Pressure("block", "right", lateral)],
    )


def carried(kinematics, lateral):
    """Of a block with c = 1; in plane stress nothing presses on the third direction."""
    return FREE + (0.0 if kinematics == "plane_stress" else lateral * (1 + SINE) / (1 - SINE))


@pytest.mark.parametrize("backend", EXACT)
@pytest.mark.parametrize("kinematics", KINEMATICS)
@pytest.mark.parametrize("dilation", [0.0, 10.0, 30.0])
def test_a_homogeneous_state_does_not_feel_how_much_a_soil_dilates(kinematics, backend, dilation):
    soil = la.MohrCoulomb(1.0, PHI, dilation_angle=dilation)
    state = la.solve(sample(soil, kinematics), backend, tolerance=1e-6)
    assert state.status is la.Status.SOLVED
    # Exact backends solve to 1e-8 and better (verification/lacore_verification/cases/biaxial.py).
    assert state.load_factor == pytest.approx(carried(kinematics, 0.5), rel=1e-7)
    assert len(state.history) <= 3
    assert state.certify().holds(1e-6)
    if dilation == PHI:
        same = la.solve(sample(la.MohrCoulomb(1.0, PHI), kinematics), backend, tolerance=1e-6)
        assert same.load_factor == state.load_factor


@pytest.mark.parametrize("kinematics", KINEMATICS)
@pytest.mark.parametrize("dilation", [0.0, 10.0])
def test_homogeneous_states_at_cut_offs(kinematics, dilation):
    """Pulled, cracks open at T; pressed, what comes first of friction and crushing."""
    cut = la.MohrCoulomb(1.0, PHI, 0.3, 3.0, dilation_angle=dilation)
    pulled = la.solve(sample(cut, kinematics, 0.0, pull=1.0), tolerance=1e-6)
    crushed = la.solve(sample(cut, kinematics, 0.0), tolerance=1e-6)
    for state, exact in ((pulled, 0.3), (crushed, 3.0)):
        assert state.status is la.Status.SOLVED
        assert len(state.history) <= 3
        assert state.load_factor == pytest.approx(exact, rel=1e-7)  # as above


@pytest.mark.parametrize("dilation", [0.0, 10.0])
@pytest.mark.parametrize("match", ["plane_strain", "compression", "extension"])
def test_a_cone_in_plane_strain_carries_what_its_flow_makes_of_the_third_stress(match, dilation):
    """``q (1 - ab/3) = sqrt(1 - b^2/3) (k - a P)``: below all that is allowed (T88)."""
    soil = la.DruckerPrager(1.0, PHI, match, dilation_angle=dilation)
    a, b, k = soil.slope, soil.flow, soil.k
    factor = sqrt(1 - b**2 / 3) / (1 - a * b / 3)
    sine, shear = a * factor, k * factor
    exact = (2 * shear + 0.5 * (1 + sine)) / (1 - sine)
    state = la.solve(sample(soil, "plane_strain", cells=1), tolerance=1e-6)
    assert state.status is la.Status.SOLVED
    # States are not unique: flow may be uneven, and stresses with it, their mean in balance. On the
    # straight flank of the cone what that changes in the load is of second order. And a gap turns
    # the stress by its root on the round of the cone, where the load is not stationary.
    stress = state.stress["block"].reshape(-1, 4)
    uneven = np.mean(np.sum((stress - stress.mean(axis=0)) ** 2, axis=1))
    uneven /= np.sum(stress.mean(axis=0) ** 2)
    assert uneven < 1e-3
    assert state.load_factor == pytest.approx(exact, rel=uneven + sqrt(state.certificate.gap))
    above = la.solve(sample(soil, "plane_strain", cells=1), coupling="associated").load_factor
    assert state.load_factor < above * (1 - 1e-3)
    # The third stress is what flow makes of it: s_zz = -2 b sqrt(J2)/3.
    x, y, z, _ = stress.mean(axis=0)
    mean = (x + y + z) / 3
    size = sqrt(((x - mean) ** 2 + (y - mean) ** 2 + (z - mean) ** 2) / 2)
    assert z - mean == pytest.approx(-2 * b * size / 3, abs=1e-2 * size)


def triaxial(dilation, cells=2):
    """A round sample with the state that it is in, which no solver had a part in."""
    problem = sample(la.MohrCoulomb(1.0, PHI, dilation_angle=dilation), "axisymmetric")
    state = la.solve(problem)
    (dofs,) = state.discretisation.continua.values()
    down = 1 / pi  # a pressure of 1 on a circle of radius 1 turns over a power of 1
    load = carried("axisymmetric", 0.5)
    stress = np.zeros((*dofs.weights.shape, 4))
    stress[..., [0, 2]], stress[..., 1] = -0.5, -load
    growth = (1 + sin(radians(dilation))) / (1 - sin(radians(dilation)))
    speed = down * np.stack([growth / 2 * dofs.nodes[0], -dofs.nodes[1]])
    return state, {"velocity": {"block": speed}, "stress": {"block": stress}}, load


@pytest.mark.parametrize("dilation", [0.0, 10.0])
def test_planted_errors_are_refused(dilation):
    state, parts, load = triaxial(dilation)
    # Sums of a few hundred terms in double precision.
    assert state.certify(load_factor=load, **parts).holds(1e-11)
    stress, speed = parts["stress"]["block"], parts["velocity"]["block"]
    full = (1 + SINE) / (1 - SINE) / ((1 + sin(radians(dilation))) / (1 - sin(radians(dilation))))
    cracked = stress + 4 * np.array([1, 1, 1, 0])  # beyond the apex, c cot(phi) = 1.73
    hoop = stress * np.array([1, 1, 1 + 1e-3, 1])  # no equilibrium of rings
    planted = {
        "load factor": {"load_factor": load * (1 + 1e-4)},
        "all of the friction dilates": {"velocity": {"block": speed * [[full], [1.0]]}},
        "less than it dilates": {"velocity": {"block": speed * [[0.9], [1.0]]}},
        "multipliers below 0": {"velocity": {"block": speed * [[-1.0], [1.0]]}},
        "sign of the velocity": {"velocity": {"block": -speed}},
        "sign of the stress": {"stress": {"block": -stress}},
        "beyond the apex": {"stress": {"block": cracked}},
        "hoop stress": {"stress": {"block": hoop}},
        "less friction": {"stress": {"block": stress * (1 - 1e-4)}},
    }
    for name, changed in planted.items():
        proof = state.certify(**{"load_factor": load, **parts, **changed})
        assert not proof.holds(5e-5), name


@pytest.mark.parametrize(
    ("kinematics", "cut"), [("axisymmetric", {}), ("plane_strain", {"tension_cutoff": 0.3})]
)
def test_a_state_of_another_dilation_is_refused(kinematics, cut):
    """Of platens, where it matters: associated ones, and those of angles exchanged."""

    def platens(angle, dilation):
        soil = la.MohrCoulomb(1.0, angle, dilation_angle=dilation, **cut)
        mesh = la.meshes.rectangle(x=(0, 1), y=(0, 0.5), nx=4, ny=2)
        return la.Problem(
            bodies={"block": la.Body(mesh, soil, kinematics=kinematics, space="p2-gauss")},
            supports=[la.Fix("block", "bottom", "y"), la.Fix("block", "left", "x")],
            reference_loads=[la.RigidFooting("block", "top", (0, -1))],
        )

    problem = platens(PHI, 20.0)
    own = la.solve(problem)
    assert own.certify().holds(own.tolerance)
    associated = la.solve(problem, coupling="associated")
    assert own.load_factor <= associated.load_factor * (1 + 1e-6)
    assert replace(associated, coupling="certified").certify().worst[1] > 1e-3
    for other in (platens(20.0, 20.0), platens(PHI, 10.0)):
        assert not own.certify(point=la.solve(other).point).holds(1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("case", [cavity_cylinder, cavity_sphere])
@pytest.mark.parametrize("dilation", [0.0, 20.0])
def test_cavities_do_not_feel_how_much_a_soil_dilates(case, dilation):
    """Yielding everywhere, their stresses follow from equilibrium (T61)."""
    state = la.solve(case.build(12, 12, PHI, dilation))
    assert state.status is la.Status.SOLVED
    # Of the mesh, 5e-6, and of a gap of 1e-6.
    assert state.load_factor == pytest.approx(case.reference(PHI, dilation).value, rel=1e-5)


@pytest.mark.slow
def test_a_circular_footing_has_a_range():
    problem = circular_footing_tresca.build(4, 3, 4.0, 20.0, rough=False)
    (body,) = problem.bodies.values()
    soil = replace(body.criterion, dilation_angle=10.0)
    found = la.soil_range(
        replace(problem, bodies={"soil": replace(body, criterion=soil)}), shares=(1.0, 0.3)
    )
    assert found.status is la.Status.SOLVED
    assert found.bracket[0] <= found.low <= found.high <= found.bracket[1]
    assert found.width <= 1e-3  # loads are unique here, as in plane strain (T59)
    assert np.isnan(found.davis)  # his strength is one of planes of slip
    for state in (found.lowest, found.highest):
        assert state.certify().holds(found.tolerance)


def test_what_these_soils_cannot_be_asked():
    around = sample(la.MohrCoulomb(1.0, PHI, dilation_angle=0), "axisymmetric")
    cut = sample(la.MohrCoulomb(1.0, PHI, 0.1, dilation_angle=0), "plane_strain")
    for problem in (cut, sample(la.MohrCoulomb(1.0, PHI, dilation_angle=0), "plane_stress")):
        for ask in (la.lower_bound, la.upper_bound, la.bracket):
            with pytest.raises(la.InputError, match=r"bound theorems do not hold.*T54"):
                ask(problem)
    with pytest.raises(la.InputError, match="hoop stress"):
        la.lower_bound(around)
    with pytest.raises(la.InputError, match=r"bound theorems do not hold.*T54"):
        la.upper_bound(around)
    with pytest.raises(la.InputError, match="planes of slip"):
        la.solve(around, coupling="davis")
    cone = la.DruckerPrager(1.0, PHI, dilation_angle=0)
    with pytest.raises(la.InputError, match=r"axes of their own.*take MohrCoulomb"):
        la.solve(sample(cone, "plane_stress"))


@pytest.mark.parametrize("cut", [{"tension_cutoff": 0.0}, {"crushing": 5.0}])
def test_the_apex_and_the_wedge_behind_it(cut):
    """Frozen without friction nothing is left but what dilates: an associated soil (T54)."""
    own = one_point(la.MohrCoulomb(1.0, PHI, dilation_angle=10.0, **cut), "axisymmetric")
    least = own.at_friction(np.zeros_like(own.strength))
    inner = tan(radians(10.0)) / tan(radians(PHI))
    same = one_point(la.MohrCoulomb(inner, 10.0, **cut), "axisymmetric")
    assert least.slope[0, : own.count] == pytest.approx(same.slope[0], rel=1e-12)
    assert least.strength[0, : own.count] == pytest.approx(same.strength[0], rel=1e-12)


@given(
    friction=st.floats(5.0, 45.0),
    dilation=st.sampled_from([0.0, 3.0, 5.0]),
    largest=st.floats(0.1, 5.0),
    between=st.sampled_from([0.0, 0.3, 1.0]),
    order=st.permutations(range(3)),
    flows=st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)),
)
def test_it_is_mohr_and_coulombs_law_of_principal_stresses(
    friction, dilation, largest, between, order, flows
):
    """On each plane of two principal directions the potential is that of the dilation angle.

    Built from principal stresses alone: ``sigma_i (1 + sin) - sigma_j (1 - sin)``, of the largest
    and the least, and of the middle one where it equals either.
    """
    sine, flat = sin(radians(friction)), sin(radians(dilation))
    own = one_point(la.MohrCoulomb(1.0, friction, dilation_angle=dilation), "axisymmetric")
    apex, ratio = 1 / tan(radians(friction)), (1 + sine) / (1 - sine)
    distance = largest * np.array([1.0, 1 + between * (ratio - 1), ratio])
    normals = [(0, 2)] + ([(1, 2)] if between == 0 else [(0, 1)] if between == 1 else [])
    rates = np.zeros(3)
    for (most, least), multiplier in zip(normals, flows, strict=False):
        rates[most] += multiplier * (1 + flat)
        rates[least] -= multiplier * (1 - flat)
    stress, rates = (apex - distance)[list(order)], rates[list(order)]
    (first, second, hoop), (wide, high, around) = stress, rates
    if first < second:
        first, second, wide, high = second, first, high, wide
    q, p = (first - second) / 2, np.array([(first + second) / 2, 0.0])
    p[1] = hoop - p[0]
    # Round-off of numbers of 10 that slopes of 3 degrees divide.
    assert np.abs(own.use(np.array([q]), p) - own.strength).min() <= 1e-10
    if wide >= high:  # coaxial; equal stresses have no order
        given_rates = (wide - high, np.array([wide + high + around, around]))
        assert defect(own, (q, p), given_rates) == pytest.approx(0, abs=1e-9)
    else:
        assert first == pytest.approx(second)
