"""Quadratic stresses in addition to linear ones of a lower bound, and their use of strengths."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lacore.bounds.enclosing import named_criterion
from lacore.bounds.equilibrium import EquilibriumDofs
from lacore.bounds.quadratic.bubbles import Bubbles, bubbles
from lacore.model.bodies.continuum.body_forces import at_vertices
from lacore.model.bodies.continuum.regions.region import Region
from lacore.model.conditions.loads import Load
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.program.dissipation import DissipationGroup
from lacore.program.kinematic import KinematicProgram
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact


@dataclass(frozen=True, repr=False)
class Bulging(Compact):
    """Quadratic stresses of body forces that vary in elements, by body; zero for others.

    Attributes:
        reference: stresses per load factor.
        dead: stresses of dead loads.
    """

    reference: Mapping[str, Bubbles]
    dead: Mapping[str, Bubbles]

    @classmethod
    def of(cls, problem: Problem, bodies: Mapping[str, EquilibriumDofs]) -> "Bulging":
        """Return the quadratic stresses of a problem.

        Raises:
            InputError: see `lacore.bounds.quadratic.bubbles.bubbles`.
        """
        both = {
            name: _carrying(getattr(problem, name), name, bodies)
            for name in ("reference_loads", "dead_loads")
        }
        return cls(both["reference_loads"], both["dead_loads"])

    @property
    def any(self) -> bool:
        """Whether any stress is not zero."""
        return self.live or any(own.any for own in self.dead.values())

    @property
    def live(self) -> bool:
        """Whether some stresses grow with the load factor."""
        return any(own.any for own in self.reference.values())

    def at(self, name: str, load_factor: float) -> Bubbles:
        """Return the stresses of a body at a load factor."""
        return self.dead[name].plus(self.reference[name].times(load_factor))


def lifted(bodies: Mapping[str, EquilibriumDofs], own: Mapping[str, Bubbles], n: int) -> Floats:
    """Return the remaining forces of quadratic stresses on n multipliers, N/m.

    They are uniform in each element.
    """
    total = np.zeros((n // 2 + 1, 2))
    for name, dofs in bodies.items():
        total[dofs.element_nodes] += (dofs.areas * own[name].divergence.mean(axis=2)).T
    return total.ravel()[:n]


def weakened(
    program: KinematicProgram,
    bodies: Mapping[str, EquilibriumDofs],
    bulging: Bulging,
    load_factor: float,
) -> KinematicProgram:
    """Return the program with reduced strengths for a range of load factors.

    The range is from 0 to a given load factor of either sign.

    Raises:
        InputError: no strength remains somewhere.
    """
    groups, first = list(program.groups), 0
    for name, dofs in bodies.items():
        stresses = [bulging.at(name, factor) for factor in (0.0, load_factor)]
        for region in dofs.body.regions:
            groups[first] = _less(groups[first], name, region, stresses)
            first += 1
    return replace(program, groups=tuple(groups))


def _less(
    group: DissipationGroup, body: str, region: Region, stresses: Sequence[Bubbles]
) -> DissipationGroup:
    """Return the group with strengths reduced by the largest use.

    The use is convex in the load factor, so it is largest at an end of the range.
    """
    uses = [own.uses(region.weakest) for own in stresses]
    bound, planes = (np.repeat(np.maximum(*both), 3, axis=0) for both in zip(*uses, strict=True))
    surfaces = group.surfaces
    if surfaces is not None:
        strength = surfaces.strength - planes
        surfaces, left = replace(surfaces, strength=strength), strength.min(axis=1)
    else:
        left = group.bound - bound
    if left.size and not left.min() > 0:
        raise InputError(
            named_criterion(body, region),
            region.criterion.label,
            f"a body force varies so much in element {region.elements[int(left.argmin()) // 3]}"
            " that its quadratic stresses may use up all strength without pressure",
            "refine the mesh, give a value for each element, or lend it some cohesion",
        )
    kept = group.bound if surfaces is not None else left
    return replace(group, bound=kept, surfaces=surfaces)


def _carrying(
    loads: Sequence[Load], kind: str, bodies: Mapping[str, EquilibriumDofs]
) -> dict[str, Bubbles]:
    found = {}
    for name, dofs in bodies.items():
        forces = np.zeros((2, dofs.body.mesh.nelements, 3))
        for number, load in enumerate(loads):
            if load.body == name:
                forces += at_vertices(load, dofs.body.mesh, f"Problem.{kind}[{number}]")
        found[name] = bubbles(dofs.body, forces, f"Problem.{kind}")
    return found
