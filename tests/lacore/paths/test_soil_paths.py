"""Paths of materials whose strength depends on pressure, against closed forms (T33)."""

from dataclasses import dataclass, replace
from math import cos, log, radians, sin, sqrt, tan

import numpy as np
import pytest

import lacore as la
from lacore.assembly.discretise import discretise
from lacore.paths.ending import Ending

SQUARE = la.meshes.rectangle((0, 1), (0, 1), 2, 2, crossed=False)
LATERAL = 0.5


def sample(criterion, lateral=LATERAL, kinematics="plane_strain", mesh=SQUARE):
    """A quarter of a block, or of a round sample, under a smooth platen."""
    space = "q2" if len(mesh.t) == 4 else "p2-gauss"
    supports = [la.Fix("soil", "bottom", "y")]
    if kinematics == "plane_strain":
        supports.append(la.Fix("soil", "left", "x"))
    return la.Problem(
        bodies={"soil": la.Body(mesh, criterion, kinematics=kinematics, space=space)},
        supports=supports,
        reference_loads=[la.RigidFooting("soil", "top", (0, -1), rough=False)],
        dead_loads=[la.Pressure("soil", "right", lateral)] if lateral else [],
    )


def ratio(angle):
    """Lateral per axial rate, (1 + sin psi)/(1 - sin psi), as of stresses with phi."""
    return (1 + sin(radians(angle))) / (1 - sin(radians(angle)))


def stress(cohesion, angle, lateral):
    """Of a block that yields, by Mohr's circle."""
    return 2 * cohesion * sqrt(ratio(angle)) + ratio(angle) * lateral


def width(path, mesh=SQUARE):
    """Of the body at the end: least and largest place of its right side."""
    side = np.isclose(path.snapshots[0].configuration.nodes["soil"][0], mesh.p[0].max())
    found = path.snapshots[-1].configuration.nodes["soil"][0, side]
    return found.min(), found.max()


def growth_error(exponent, travel, steps):
    """Of a width l^-K by leapfrog: w'''/6 < K (K + 1) (K + 2)/6 (1 - s)^-(K + 3) of steps squared.

    A midpoint rule errs by w''' h^2/24 per length, a velocity half a step old by twice as much
    again, and the first step by a h^2 w''/4: together less than w''' h^2/6 + w'' h^2/2.
    """
    third = exponent * (exponent + 1) * (exponent + 2) * (1 - travel) ** -(exponent + 3)
    second = exponent * (exponent + 1) * (1 - travel) ** -(exponent + 2)
    return (travel * third / 6 + second / 2) * (travel / steps) ** 2


@pytest.mark.parametrize(
    ("soil", "lateral", "dilation"),
    [
        (la.MohrCoulomb(0.0, 30.0), LATERAL, 30.0),  # no strength without pressure
        (la.MohrCoulomb(1.0, 30.0, dilation_angle=10.0), LATERAL, 10.0),
    ],
    ids=["sand", "dilates less"],
)
def test_a_block_between_smooth_platens(soil, lateral, dilation):
    travel, steps = 0.1, 4
    path = la.sequential(sample(soil, lateral), travel, steps)
    assert path.status is Ending.REACHED, path.message
    grows = ratio(dilation)
    allowed = growth_error(grows, travel, steps)
    if soil.dilation_angle is None:  # one a step, and one at the beginning
        assert path.history.solves.sum() == steps + 1
    narrow, wide = width(path)
    assert wide == pytest.approx((1 - travel) ** -grows, rel=allowed)
    assert wide - narrow < 1e-4  # as uniform as velocities are known: to the root of 1e-8
    force = (
        stress(soil.cohesion, soil.friction_angle, lateral) * (1 - path.history.travel) ** -grows
    )
    assert path.history.force.to_numpy() == pytest.approx(force.to_numpy(), rel=allowed)
    # The volume is that of a rectangle, and the strain that of its sides.
    assert path.history.volume.iloc[-1] == pytest.approx(0.9 * (wide + narrow) / 2, rel=1e-4)
    across, along = log(wide), log(1 - travel)
    mean = (across + along) / 3
    strain = sqrt(2 / 3 * ((across - mean) ** 2 + (along - mean) ** 2 + mean**2))
    # Increments of leapfrog are those of the middles of steps: second order, like the width.
    assert path.history.max_strain.iloc[-1] == pytest.approx(strain, rel=2 * allowed)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scheme", "order"),
    [("explicit", 1), ("implicit-euler", 1), ("leapfrog", 2), ("implicit-midpoint", 2)],
)
def test_orders_of_the_schemes_on_sand(scheme, order):
    errors = []
    for steps in (8, 16):
        path = la.sequential(sample(la.MohrCoulomb(0.0, 30.0)), 0.1, steps, scheme)
        exact = 3 * LATERAL * (1 - path.history.travel) ** -3
        errors.append(np.abs(path.history.force / exact - 1).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.2)


def test_a_round_sample_of_drucker_and_prager():
    """Matched in compression each lateral rate is K/2 of the axial one, by its own flow rule."""
    soil = la.DruckerPrager(1.0, 30.0, match="compression")
    lateral = (sqrt(3) + 2 * soil.slope) / (2 * (sqrt(3) - soil.slope))
    assert lateral == pytest.approx(ratio(30) / 2)
    path = la.sequential(sample(soil, kinematics="axisymmetric"), 0.1, 2)
    assert path.status is Ending.REACHED, path.message
    assert width(path)[1] == pytest.approx(0.9**-lateral, rel=growth_error(lateral, 0.1, 2))
    # The load factor is a pressure on the top as it is by then.
    assert path.history.load_factor.to_numpy() == pytest.approx(
        stress(1.0, 30.0, LATERAL), rel=1e-4
    )


def test_a_round_sample_dilates_by_its_own_angle():
    """At an edge of Mohr and Coulomb's surface, where two planes flow: laterally K/2 (T88)."""
    soil = la.MohrCoulomb(1.0, 30.0, dilation_angle=10.0)
    path = la.sequential(sample(soil, LATERAL, kinematics="axisymmetric"), 0.1, 4)
    assert path.status is Ending.REACHED, path.message
    lateral = ratio(10) / 2
    assert width(path)[1] == pytest.approx(0.9**-lateral, rel=growth_error(lateral, 0.1, 4))


def test_a_thick_tube_of_soil():
    """v ~ r^-beta by the flow rule, and the pressure of the radii as they are."""
    angle, travel, steps = 30.0, 0.3, 4
    mesh = la.meshes.quadrilaterals((1, 2), (0, 0.25), 4, 1, grade_x=(1, 2))
    soil = la.Body(mesh, la.MohrCoulomb(1.0, angle), kinematics="axisymmetric", space="q2")
    tube = la.Problem(
        bodies={"soil": soil},
        supports=[la.Fix("soil", "bottom", "y"), la.Fix("soil", "top", "y")],
        reference_loads=[la.Pressure("soil", "left")],
    )
    bore = la.PointTravel("soil", (1, 0), (1, 0))
    path = la.sequential(tube, travel, steps, control=bore)
    assert path.status is Ending.REACHED, path.message
    power = 2 / (1 + sin(radians(angle)))

    def outer(inner):
        return (2**power + inner**power - 1) ** (1 / power)

    inner = 1 + path.history.travel.to_numpy()
    share = 2 * sin(radians(angle)) / (1 + sin(radians(angle)))
    exact = ((outer(inner) / inner) ** share - 1) / tan(radians(angle))
    # Half a step of v' = -beta v/r at the bore: (h/2)^2/2 of v, of which b/a has the difference,
    # and 3e-4 of four elements.
    allowed = (travel / steps) ** 2 / 4 + 3e-4
    assert path.history.load_factor.to_numpy() == pytest.approx(exact, rel=allowed)
    assert width(path, mesh)[1] == pytest.approx(outer(1 + travel), rel=allowed)


@dataclass(frozen=True)
class Layered:
    """von Mises with a strength of each element."""

    strengths: np.ndarray
    law: object = None
    label = "layers"

    @property
    def strength(self):
        return float(self.strengths.max())

    def conic_form(self, kinematics):
        return replace(la.VonMises(1.0).conic_form(kinematics), bound=self.strengths)


def test_what_does_not_harden_is_a_perfect_metal():
    """Tresca in plane strain, and a criterion that says nothing of hardening."""
    metal, *others = (
        la.sequential(sample(own, 0.0), 0.1, 2).history.drop(columns="seconds").to_numpy()
        for own in (la.VonMises(1.0), la.MaximumShear(1.0), Layered(np.ones(SQUARE.nelements)))
    )
    for other in others:  # the yield stress of the metal takes the way by sqrt(3) and back
        assert other == pytest.approx(metal, rel=1e-9, abs=1e-9, nan_ok=True)


def test_a_bar_of_soil_drifts_and_a_selection_keeps_it_uniform():
    mesh = la.meshes.rectangle((0, 2), (0, 0.5), 4, 1, crossed=False)
    bar = la.Problem(
        bodies={"soil": la.Body(mesh, la.NoTension(1.0), space="p2-gauss")},
        supports=[la.Fix("soil", "left", "x"), la.Fix("soil", "bottom", "y")],
        reference_loads=[la.RigidFooting("soil", "right", (-1, 0), rough=False)],
    )
    loose = la.sequential(bar, 0.05, 1)  # cracks along it open for nothing
    assert "velocity not unique" in set(loose.events.kind)
    path = la.sequential(bar, 0.05, 2, selection=la.LeastNorm())
    assert path.status is Ending.REACHED, path.message
    strain = path.snapshots[-1].configuration.strain["soil"]
    assert np.ptp(strain) < 1e-4 * strain.mean()
    assert path.history.load_factor.to_numpy() == pytest.approx(1.0, rel=1e-6)


def test_strengths_of_elements_do_not_go_to_another_mesh():
    own = Layered(np.full(SQUARE.nelements, 1.0))

    def finer(now):
        return {"soil": la.meshes.rectangle((0, 1), (0, 1), 3, 3, crossed=False)}

    path = la.sequential(sample(own, 0.0), 2.0, 1, remesh=finer)
    assert path.status is Ending.NOT_REMESHED
    assert "a strength of each element" in path.message


def test_a_side_that_is_pulled_beyond_the_apex_is_unsafe():
    path = la.sequential(sample(la.MohrCoulomb(1.0, 30.0), -2.0), 0.1, 1)  # c cot(phi) = 1.73
    assert path.status is Ending.NOT_SOLVED
    assert "unsafe" in path.message
    assert "another scheme" not in path.message  # none carries it
    assert path.history.empty


def test_what_no_path_takes():
    class Stiffening(la.MohrCoulomb):
        law = la.hardening.Perfect(1.0)

    with pytest.raises(la.InputError, match=r"criterion.law = .* does not harden along a path"):
        la.sequential(sample(Stiffening(1.0, 30.0)), 0.1, 1)
    with pytest.raises(la.InputError, match="coupling = 'davis'"):
        la.sequential(sample(la.MohrCoulomb(1.0, 30.0)), 0.1, 1, coupling="davis")
    with pytest.raises(la.CapabilityError, match="hardening"):
        la.sequential(
            sample(la.MohrCoulomb(1.0, 30.0)),
            0.1,
            1,
            selection=la.LeastNorm(),
            backend="ipopt-static",
        )


@pytest.mark.parametrize("backend", ["clarabel", "cvxpy"])
def test_a_modulus_beside_surfaces_raises_them(backend):
    """A block pressed by 1 1/s strains by d = 1 + K: the load grows by h d^2."""
    modulus = 0.1
    d = discretise(sample(la.MohrCoulomb(1.0, 30.0)))
    stiffer = {
        name: replace(
            own, groups=tuple(replace(g, modulus=modulus * (0 * g.bound + 1)) for g in own.groups)
        )
        for name, own in (("full", d.full), ("program", d.program))
    }
    state = la.solve(replace(d, **stiffer), backend)
    assert state.certificate.holds(1e-6)
    exact = stress(1.0, 30.0, LATERAL) + modulus * (1 + ratio(30.0)) ** 2
    assert state.load_factor == pytest.approx(exact, rel=1e-6)
    assert cos(radians(30.0)) < state.program.groups[0].surfaces.strength.min()
