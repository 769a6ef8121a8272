"""A subclass of `SurfaceLoad` is a load everywhere, without further registration."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import pytest

import lacore as la
from lacore.model.bodies.blocks.loads import carried
from lacore.model.conditions.loads import SurfaceLoad
from lacore.numerics.arrays import Floats


@dataclass(frozen=True, repr=False)
class Shear(SurfaceLoad):
    """Uniform shear stress along a boundary, counterclockwise."""

    value: float = 1.0

    @property
    def told(self) -> str:
        """In a few words."""
        return f"shear on {self.body}"

    @property
    def size(self) -> float:
        """See `SurfaceLoad.size`."""
        return abs(self.value)

    def times(self, factor: float) -> Self:
        """See `SurfaceLoad.times`."""
        return replace(self, value=factor * self.value)

    def on(self, normal: Floats) -> Floats:
        """See `SurfaceLoad.on`."""
        return self.value * np.stack([-normal[1], normal[0]])


def layer(load):
    mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=2, ny=2)
    body = la.Body(mesh, la.VonMises(shear_strength=1.0))
    return la.Problem({"layer": body}, [load], [la.Fix("layer", "bottom")])


SHEAR = Shear("layer", "top", 2.0)
TRACTION = la.Traction("layer", "top", (-2.0, 0.0))  # counterclockwise along the top


@pytest.mark.parametrize("factor", [la.solve, la.lower_bound, la.upper_bound])
def test_it_loads_a_deformable_body_as_the_same_traction_does(factor):
    assert factor(layer(SHEAR)).load_factor == pytest.approx(
        factor(layer(TRACTION)).load_factor, rel=1e-6
    )


def test_it_loads_the_sides_of_rigid_blocks_as_the_same_traction_does():
    box = la.RigidBlock([(0, 0), (2, 0), (2, 1), (0, 1)])
    for load in (Shear("box", "block", 2.0), la.Pressure("box", "block", 2.0)):
        assert carried(load, box)[2].sum(axis=1) == pytest.approx([0, 0], abs=1e-12)
    places, forces = carried(Shear("box", "block", 2.0), box)[1:]
    moment = places[0] * forces[1] - places[1] * forces[0]
    assert moment.sum() == pytest.approx(2 * 2.0 * 2.0)  # the shear stress times twice the area


def test_its_size_is_a_parameter_of_the_load_factor():
    table = la.sensitivity(la.solve(layer(SHEAR))).table
    assert "reference_loads[0]: shear on layer" in table.parameter.tolist()
