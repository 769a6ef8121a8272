"""What paths must come to, against the exact ones (T33)."""

import numpy as np
import pytest

import lacore as la
from lacore.arrays import Floats
from lacore.hardening import HardeningLaw, Linear, Perfect, Voce
from lacore.path import Ending
from verification.exact_paths import cylinder, pressure

LAWS = {
    "perfect": Perfect(1.0),
    "linear": Linear(1.0, 3.0),
    "voce": Voce(1.0, 3.0, 2 * np.sqrt(3)),
}


def tube(law: HardeningLaw, n: int = 8) -> la.Problem:
    """A slice of a thick tube, radii 1 and 2."""
    mesh = la.meshes.quadrilaterals((1, 2), (0, 0.25), n, 1, grade_x=(1.0, 2.0))
    return la.Problem(
        bodies={"tube": la.Body(mesh, la.VonMises(hardening=law), "axisymmetric", "q2")},
        supports=[la.Fix("tube", "bottom", "y"), la.Fix("tube", "top", "y")],
        reference_loads=[la.Pressure("tube", "left")],
    )


def errors(path: la.Path, law: HardeningLaw) -> Floats:
    """Relative, of the pressure at every step."""
    exact = [pressure(cylinder(law), 1 + at) for at in path.history["travel"]]
    return np.asarray(path.history["load_factor"] / exact - 1)


@pytest.mark.parametrize("name", LAWS)
def test_leapfrog_is_within_1e_4_of_the_exact_pressure_at_every_one_of_20_steps(name: str) -> None:
    bore = la.PointTravel("tube", (1.0, 0.0), (1.0, 0.0))
    path = la.sequential(tube(LAWS[name]), 0.5, 20, control=bore)
    assert path.status is Ending.REACHED
    assert len(path.history) == 20
    assert np.abs(errors(path, LAWS[name])).max() <= 1e-4
    assert path.history["solves"].sum() == 21  # one a step, and one at the beginning
