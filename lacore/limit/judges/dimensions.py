"""Bodies whose dimensions do not fit their weight or strength, and changes made by readers."""

from collections.abc import Iterator
from functools import singledispatch

import numpy as np

from lacore.limit.outcome import Outcome
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.water import snapped
from lacore.model.conditions.body_forces import BodyForce
from lacore.model.conditions.loads import Load
from lacore.model.conditions.water import PorePressure, StandingWater, WaterTable
from lacore.model.meshes.files.notes import notes_of
from lacore.model.problem.problem import Problem
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Status
from lacore.reporting.text import Quantity

# No structure under weight is larger or smaller; a file in mm read in m is a thousand times larger.
_LARGEST, _SMALLEST = 2e3, 5e-3  # m
_WEIGHTS = (1e3, 2e5)  # N/m^3: unit weights from light fills to metals
_STRENGTHS = (1e3, 1e10)  # Pa: shear strengths from soft clay to steel


def implausible_dimensions(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """The size of a body does not fit its weight or its strength."""
    problem = outcome.discretisation.problem
    strengths = {name: own.largest_shear for name, own in of_kind(problem.bodies, Body).items()}
    for name, body in problem.bodies.items():
        size = float(np.max(np.ptp(np.array(body.box), axis=0)))
        weight = _weight(problem, name)
        strength = strengths.get(name, 0.0)
        strong = _STRENGTHS[0] <= strength <= _STRENGTHS[1]
        if weight and not _SMALLEST <= size <= _LARGEST:
            why = Quantity(weight, "N/m^3", ".3g")
        elif strong and size > _LARGEST:
            why = Quantity(strength, "Pa", ".3g")
        else:
            continue
        values = {"size": Quantity(size, "m", ".4g"), "why": why}
        yield Finding(Kind.DIMENSIONS, (name,), values, Severity.WARNING)


def changed_meshes(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """A reader changed the elements of a file, or left out names."""
    for name, body in of_kind(outcome.discretisation.problem.bodies, Body).items():
        if changes := notes_of(body.mesh)[1:]:
            yield Finding(Kind.MESH_CHANGED, (name,), {"text": "; ".join(changes)})


def snapped_tables(outcome: Outcome, status: Status) -> Iterator[Finding]:
    """A water table was moved to vertices that it nearly meets."""
    problem = outcome.discretisation.problem
    bodies = of_kind(problem.bodies, Body)
    for field, load in problem.loads.items():
        if not isinstance(load, PorePressure | StandingWater) or load.body not in bodies:
            continue
        if isinstance(load.pressure, WaterTable):
            table = snapped(load.pressure, bodies[load.body].mesh)
            if isinstance(table, WaterTable) and table.height != load.pressure.height:
                ends = {"height": load.pressure.height, "moved": table.height}
                values = {name: Quantity(own, "m", ".7g") for name, own in ends.items()}
                yield Finding(Kind.TABLE_SNAPPED, (field,), values)


def _weight(problem: Problem, name: str) -> float:
    """Return the largest uniform unit weight on a body if it is one of a real material, N/m^3."""
    sizes = [_size(load) for load in problem.loads.values() if load.body == name]
    return max((own for own in sizes if _WEIGHTS[0] <= own <= _WEIGHTS[1]), default=0.0)


@singledispatch
def _size(load: Load) -> float:
    """Return the size of a uniform force per volume, N/m^3; 0 of other loads."""
    return 0.0


@_size.register(BodyForce)
def _of_force(load: BodyForce) -> float:
    uniform = all(isinstance(own, float | int) for own in load.vector)
    return float(np.linalg.norm(np.array(load.vector, dtype=float))) if uniform else 0.0
