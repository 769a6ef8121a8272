"""Strength that depends on pressure, regularised (T65): the exact value from below, in order."""

import numpy as np
import pytest

import lacore as la
from lacore.program.kinematic import associated_contact, dimensionless
from lacore.program.regularization import penalties
from lacore.solvers.backend import find_backend
from lacore_backends.clarabel_socp import Clarabel, ClarabelOptions
from lacore_verification.catalogue.catalogue import catalogue
from tests.backends.variants import SOILS

NAMES = ["clarabel-regularised", "ipopt", "newton"]
GAP = 1e-10  # that Clarabel leaves, relative


SOIL = la.MohrCoulomb(1.0, 30)


def block(criterion=SOIL, **more):
    """A unit block of soil of 30 degrees."""
    soil = la.Body(la.meshes.rectangle((0, 1), (0, 1), 2, 2), criterion)
    return la.Problem(bodies={"block": soil}, **more)


def elastic_energy(program, contact, point, r):
    """``sum w C*`` of stresses and reactions (T65, T18)."""
    k = penalties(program.scales, r)
    energy = sum(
        group.weights @ np.sum(stress**2, axis=1) / k.eta + group.volume_weights @ mean**2 / k.bulk
        for group, stress, mean in zip(program.groups, point.stress, point.mean_stress, strict=True)
    )
    weights = program.contact.weights
    energy += weights @ point.normal_reaction**2 / k.normal
    along = np.sum(point.tangential_reaction**2, axis=1)
    # Of a dilatant point both reactions are on the edge of the cone (T18).
    return float(energy + weights @ along / k.tangential) / 2


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(("case", "variant"), SOILS)
def test_the_exact_value_is_approached_from_below(case, variant, name):
    """T19, T65: P <= alpha_reg <= lambda <= alpha*, by no more than the exact stresses store.

    alpha_reg is the most that alpha less r times an energy comes to: convex in r, so that what is
    lost per r grows as r gets less, to the energy of exact stresses.
    """
    discretisation = la.discretise(case.problem(variant, "coarse"))
    program = dimensionless(discretisation.program, discretisation.natural).associated()
    contact = associated_contact(program.contact)
    exact = Clarabel().prepare(program, ClarabelOptions(tolerance=GAP)).solve(contact).point
    backend, every = find_backend(name), (1e-2, 1e-3)
    lost = []
    for r in every:
        answer = backend.prepare(program, backend.Options(r=r)).solve(contact)
        # In space clarabel says "almost": what follows is recomputed, and as sharp.
        assert answer.status in (la.Status.SOLVED, la.Status.ALMOST_SOLVED)
        values = answer.regularised
        # A gap g leaves elastic shares off by d with K d^2/2 <= g, and C = K e^2/2 by K e d at
        # most; the exact value has a gap of its own, beside the power of a dead load.
        gap = 10 * GAP * (1 + abs(exact.load_factor))
        off = 2 * np.sqrt(values.energy * gap) + gap
        assert values.plastic <= values.alpha_reg <= values.load_factor
        assert values.load_factor <= exact.load_factor + off
        assert values.multiplier == pytest.approx(values.load_factor, abs=off)
        most = elastic_energy(program, contact, exact, r)
        assert exact.load_factor - values.alpha_reg <= most + off
        assert exact.load_factor - values.load_factor <= most - values.energy + 2 * off
        lost.append((exact.load_factor - values.alpha_reg) / r)
    assert lost[1] >= lost[0] - off / every[1]


# A homogeneous state, a footing, a cut, and one that no tension holds.
AGREED = [
    "biaxial:phi-30",
    "strip-footing:phi-20",
    "vertical-cut-phi:phi-20",
    "no-tension-cut:phi-20",
]


@pytest.mark.parametrize("chosen", AGREED)
def test_all_find_one_triple(chosen):
    """T19 by three solvers that share no line but the laws."""
    case, _, variant = chosen.partition(":")
    found = catalogue()[case]
    (own,) = (one for one in found.variants if one.name == variant)
    discretisation = la.discretise(found.problem(own, "coarse"))
    program = dimensionless(discretisation.program, discretisation.natural)
    contact = associated_contact(program.contact)
    answers = []
    for name in NAMES:
        backend = find_backend(name)
        answer = backend.prepare(program, backend.Options(r=1e-3)).solve(contact)
        assert answer.status is la.Status.SOLVED
        answers.append(answer)
    one, *others = (answer.regularised for answer in answers)
    power = 1 + abs(one.load_factor)
    power += abs(float(program.dead_load @ answers[0].point.velocity))
    # As above; Clarabel's rows are off by 1e-10 of velocities, beside stiffnesses of 1e4.
    gap = GAP * power
    off = 2 * np.sqrt(one.energy * gap) + 100 * gap
    for other in others:
        assert one.alpha_reg == pytest.approx(other.alpha_reg, abs=100 * gap)
        for entry in ("plastic", "load_factor"):
            assert getattr(one, entry) == pytest.approx(getattr(other, entry), abs=off), entry


@pytest.mark.parametrize("name", NAMES)
def test_a_mechanism_of_shear_and_growth_is_certified(name):
    """T38 in closed form: 2 sqrt(3) c + 3 p of a block at 30 degrees under a lateral pressure p."""
    problem = block(
        supports=[la.Fix("block", "bottom", "y")],
        reference_loads=[la.Pressure("block", "top")],
        dead_loads=[la.Pressure("block", side, 0.5) for side in ("left", "right")],
    )
    state = la.solve(problem, name, throw=True)
    assert state.rigor is la.Rigor.REGULARISED
    # Stresses are determined by equilibrium: lambda is exact at any r.
    assert state.load_factor == pytest.approx(2 * np.sqrt(3) + 1.5, rel=1e-7)
    assert state.certificate.yield_violation <= 1e-9


@pytest.mark.parametrize("name", NAMES)
def test_lambda_comes_closer_faster_than_r(name):
    """T19, T65: what alpha_reg loses is linear in r, what lambda loses is o(r); on a footing.

    The first is sum w C* of stresses that hardly move any more: a slope of 1 to a tenth. The
    second is of the second order in how far they move, which is in proportion to r at best: more
    than halfway between both orders is no accident.
    """
    case = catalogue()["strip-footing"]
    discretisation = la.discretise(case.problem(case.variants[0], "coarse"))
    program = dimensionless(discretisation.program, discretisation.natural)
    contact = associated_contact(program.contact)
    exact = Clarabel().prepare(program, ClarabelOptions(tolerance=GAP)).solve(contact).point
    backend = find_backend(name)
    lost = []
    for r in (1e-2, 1e-3):
        found = backend.prepare(program, backend.Options(r=r)).solve(contact).regularised
        lost.append(exact.load_factor - np.array([found.alpha_reg, found.load_factor]))
    first, second = np.log10(lost[0] / lost[1])
    assert first == pytest.approx(1, abs=0.1)
    assert second > 1.5


CONFINED = {"supports": [("bottom", "xy"), ("left", "x"), ("right", "x")]}
CRUSHED = {"supports": [("bottom", "y")], "dead_loads": [la.Pressure("block", "top", 10.0)]}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    ("given", "load", "status"),
    [
        # Pressed between walls it would have to grow sideways.
        (CONFINED, la.Pressure("block", "top"), la.Status.LOCKED),
        # Twice what an unconfined block carries, 2 sqrt(3) c.
        (CRUSHED, la.Traction("block", "right", (1, 0)), la.Status.UNSAFE),
    ],
)
def test_what_has_no_limit_load_has_a_name(given, load, status, name):
    """T13, T48: penalties make every program feasible, and hide what is not."""
    supports = [la.Fix("block", *one) for one in given["supports"]]
    more = {"supports": supports, "dead_loads": given.get("dead_loads", ())}
    assert la.solve(block(reference_loads=[load], **more), name).status is status


def test_slsqp_refuses():
    problem = block(
        supports=[la.Fix("block", "bottom", "y")], reference_loads=[la.Pressure("block", "top")]
    )
    with pytest.raises(la.CapabilityError, match=r"pressure.*'clarabel-regularised'"):
        la.solve(problem, "slsqp")


@pytest.mark.parametrize("name", NAMES)
def test_flow_that_is_not_associated_is_refused_by_what_was_said(name):
    """Nobody who names a backend alone has heard of couplings; what was chosen is told, and why."""
    problem = block(
        criterion=la.MohrCoulomb(1.0, 30, dilation_angle=0),
        supports=[la.Fix("block", "bottom", "y")],
        reference_loads=[la.Pressure("block", "top")],
    )
    with pytest.raises(la.InputError, match=r"coupling='reaction' was chosen") as caught:
        la.solve(problem, name)
    assert str(caught.value).startswith(f"backend = {name!r}: is regularised")
    assert "'clarabel', or coupling='associated' or 'davis'" in str(caught.value)
    with pytest.raises(la.InputError, match=r"coupling = 'reaction': iterates"):
        la.solve(problem, name, "reaction")
    assert la.solve(problem, name, "associated").status is la.Status.SOLVED
