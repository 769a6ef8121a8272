"""A yield criterion of one's own, with a strength of its own in each element."""

from dataclasses import dataclass
from math import sqrt

import numpy as np
import pytest

import lacore as la
from lacore.model.materials.conic_form import ConicForm
from lacore.numerics.arrays import Floats


@dataclass(frozen=True)
class Layered:
    """von Mises with a shear strength of each element, Pa."""

    strengths: Floats
    law = None

    @property
    def strength(self):
        return float(self.strengths.max())

    @property
    def label(self):
        return f"k = {self.strengths.min():.4g} ... {self.strengths.max():.4g} Pa"

    def conic_form(self, kinematics):
        form = la.VonMises(1.0).conic_form(kinematics)
        return ConicForm(form.rows, form.volumetric, self.strengths, form.volumetric_factor)


def bar(space, kinematics="plane_strain", strengths=(1.0, 3.0)):
    """Two bars on top of each other, 2 x 1/2 each, pulled by a uniform traction at the ends."""
    mesh = la.meshes.rectangle((0, 2), (0, 1), 4, 4)
    middle = mesh.p[1, mesh.t].mean(axis=0)
    criterion = Layered(np.where(middle < 0.5, *strengths))
    return la.Problem(
        {"bar": la.Body(mesh, criterion, kinematics, space)},
        [la.RigidFooting("bar", "right", (1.0, 0.0), rough=False)],
        [la.Fix("bar", "left", "x")],  # free to move up and down, which costs nothing
    )


EXACT = 1e-6  # the mechanism lies in every space: what is left is the bar of the certificate


@pytest.mark.parametrize("space", ["p2-vertex", "p1-disc", "p2-disc", "p2-gauss"])
@pytest.mark.parametrize(
    ("kinematics", "tension"), [("plane_strain", 2.0), ("plane_stress", sqrt(3))]
)
def test_bars_side_by_side_carry_the_sum(space, kinematics, tension):
    """Uniform strain, and in each bar its yield stress in tension: exact from both sides."""
    problem = bar(space, kinematics)
    exact = tension * 2.0  # of mean strength 2
    assert la.solve(problem).load_factor == pytest.approx(exact, rel=EXACT)
    assert la.lower_bound(problem).load_factor == pytest.approx(exact, rel=EXACT)


@pytest.mark.parametrize("space", ["p1-disc", "p2-disc"])
def test_a_jump_costs_what_the_weaker_side_carries(space):
    d = la.discretise(bar(space))
    jumps, strengths = d.jumps["bar"], d.continua["bar"].body.criterion.strengths
    sides = strengths[jumps.elements]
    assert {(1.0, 3.0), (3.0, 1.0)} & set(map(tuple, sides.T.tolist()))
    assert np.array_equal(jumps.group.bound, sides.min(axis=0))


def test_it_says_what_it_is_worth():
    body = bar("p2-vertex").bodies["bar"]
    assert "k = 1 ... 3 Pa" in body.contents


def test_a_path_takes_one_that_does_not_harden_as_it_is():
    """Strengths of elements move with them: the mean traction stays that of both."""
    problem = bar("p2-gauss")
    path = la.sequential(problem, travel=0.1, steps=2)
    assert path.history["load_factor"].to_numpy() == pytest.approx(4.0, rel=EXACT)
    # In plane strain the height falls as 1/length; midway through a step to second order in it,
    # (0.05/2)^2 = 6e-4.
    force, travel = (path.history[name].to_numpy() for name in ("force", "travel"))
    assert force == pytest.approx(4.0 * 2 / (2 + travel), rel=1e-3)
