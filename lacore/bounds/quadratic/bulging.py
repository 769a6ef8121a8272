"""Quadratic stresses beside the linear ones of a lower bound, and what they take of strengths."""

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
    """Quadratic stresses of body forces that vary in elements, by body; none of others.

    Attributes:
        reference: per load factor.
        dead: of dead loads.
    """

    reference: Mapping[str, Bubbles]
    dead: Mapping[str, Bubbles]

    @classmethod
    def of(cls, problem: Problem, bodies: Mapping[str, EquilibriumDofs]) -> "Bulging":
        """Those of a problem.

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
        """Whether there are any."""
        return self.live or any(own.any for own in self.dead.values())

    @property
    def live(self) -> bool:
        """Whether there are some that grow with the load factor."""
        return any(own.any for own in self.reference.values())

    def at(self, name: str, load_factor: float) -> Bubbles:
        """Those of a body at a load factor."""
        return self.dead[name].plus(self.reference[name].times(load_factor))


def lifted(bodies: Mapping[str, EquilibriumDofs], own: Mapping[str, Bubbles], n: int) -> Floats:
    """Forces on n multipliers that are left of quadratic stresses: uniform in each element, N/m."""
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
    """The program with what is left of strengths at any load factor from 0 to one, either sign.

    Raises:
        InputError: nothing is left somewhere.
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
    """With strengths less what stresses take, of each the most: it is convex in the load factor."""
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
                forces += at_vertices(load, dofs.body, f"Problem.{kind}[{number}]")
        found[name] = bubbles(dofs.body, forces, f"Problem.{kind}")
    return found
