"""Points of several planes in lacore's own interior point: their cones, and where they start."""

import numpy as np
import pytest

import lacore as la
from lacore.assembly.discretise import discretise
from lacore.numerics.symmetric import symmetric_solver
from lacore.program.kinematic import associated_contact
from lacore.reporting.status import Status
from lacore_backends._embedding import follow as way
from lacore_backends._embedding.arrays import Translation
from lacore_backends._embedding.follow import follow
from lacore_backends._embedding.loops import plain
from lacore_backends._embedding.pressure_dependent import Planes
from lacore_backends._embedding.start import start
from lacore_backends._embedding.stiffness import Stiffness
from lacore_backends._embedding.system import System
from lacore_backends._embedding.whole import Whole
from lacore_backends._goal import Goal
from tests.lacore.random_programs import random_soil

BAR = 1e-6  # of certificates
SUMS = 1e-12  # sums of a few terms of order one
GOAL = Goal(1e-8, 60, np.inf)
NEAR, LOST = 1e-6, 1e-3  # residuals next to an answer, and of forces there, if they are lost
CUT = la.MohrCoulomb(1.0, 30.0, tension_cutoff=0.0)


def panel(material, kinematics="plane_strain", cells=3):
    """Pushed sideways under weight."""
    mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=2 * cells, ny=cells)
    return la.Problem(
        bodies={"panel": la.Body(mesh, material, kinematics=kinematics)},
        supports=[la.Fix("panel", "bottom")],
        reference_loads=[la.Traction("panel", "top", (1.0, 0.0))],
        dead_loads=[la.Traction("panel", "top", (0.0, -0.5))],
    )


def planes_of(group):
    return Planes.of(group, plain)


def test_multipliers_and_flows_are_adjoint():
    rng = np.random.default_rng(3)
    planes = planes_of(random_soil(3).groups[0])
    zeta = rng.normal(size=(planes.rows.dim, planes.rows.count))
    own = planes.multipliers(0.0, zeta)
    flows = [rng.normal(size=part.shape) for part in own]
    power = sum(float(np.sum(x * z)) for x, z in zip(flows, own, strict=True))
    assert power == pytest.approx(float(np.sum(planes.summed(flows) * zeta)), rel=SUMS)
    # What tau adds is the cost.
    more = planes.multipliers(1.0, zeta)
    cost = sum(float(np.sum(x * (a - b))) for x, a, b in zip(flows, more, own, strict=True))
    assert cost == pytest.approx(planes.cost(flows), rel=SUMS)


@pytest.mark.parametrize(
    ("material", "moved"),
    [
        (la.NoTension(4.0), True),
        (la.NoTension(1e-3), True),
        (CUT, True),
        (la.Rankine(0.3, 4.0), False),
        (la.MohrCoulomb(1.0, 30.0, tension_cutoff=0.2, crushing=20.0), False),
    ],
)
@pytest.mark.parametrize("kinematics", ["plane_strain", "plane_stress"])
def test_starts_are_inside_of_all_planes(material, moved, kinematics):
    """And without stress where that is inside, as nothing is out of balance there."""
    (group,) = discretise(panel(material, kinematics)).program.groups
    planes = planes_of(group)
    zeta = planes.inside()
    assert np.any(zeta != 0) == moved
    first, others = planes.multipliers(1.0, zeta)
    assert np.all(first[0] > np.linalg.norm(first[1:], axis=0))
    assert np.all(others > 0)


def test_what_has_no_strength_in_tension_is_certified():
    """Where the other certifies it, too: on a few elements."""
    own, other = (la.solve(panel(CUT), name) for name in ("interior_point", "clarabel"))
    for state in (own, other):
        assert state.status is Status.SOLVED
        assert state.certificate.holds(BAR)
    # Each is within its gap of the same minimum.
    assert own.load_factor == pytest.approx(other.load_factor, rel=2 * BAR)


def test_forces_that_are_lost_are_found_with_more_unknowns(monkeypatch):
    """From where they were last in balance, by other factors, once."""
    model = discretise(panel(la.MohrCoulomb(1.0, 20.0, tension_cutoff=0.2), cells=2))
    own = Translation(model.program, associated_contact(model.program.contact), plain)
    solvers = symmetric_solver(refined=False), symmetric_solver(refined=False, definite=False)
    parts = own.conic, Stiffness(own.conic.kinds, plain), solvers[0]
    system = System(*parts)
    begin = start(own.conic, system)
    plainly = follow(system, GOAL, *begin)
    asked, residuals = [], way.residuals

    def whole():
        asked.append(True)
        return Whole(*parts, solvers[1])

    def lost(place, power):
        gap, force, slow = residuals(place, power)
        return gap, force if asked or max(gap, slow) > NEAR else LOST, slow

    monkeypatch.setattr(way, "residuals", lost)
    found = follow(system, GOAL, *begin, whole)
    assert asked == [True]
    assert found.native == "solved"
    assert found.multipliers.load == pytest.approx(plainly.multipliers.load, rel=BAR)
    asked.clear()
    assert follow(system, GOAL, *begin).native != "solved"
