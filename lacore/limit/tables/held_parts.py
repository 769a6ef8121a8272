"""What supports and rigid footings exert on what they hold or move."""

import numpy as np
import pandas as pd

from lacore.assembly.bonds import supports_of, without_bonds
from lacore.assembly.discretisation import Discretisation
from lacore.assembly.held_loads import moved_to_holders
from lacore.assembly.loading import footings_of
from lacore.assembly.unknowns import Unknowns
from lacore.model.bodies.any_body import RigidParts
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.regions import gathering
from lacore.model.bodies.continuum.solid.holding import face_conditions
from lacore.model.bodies.continuum.solid.normal_flow import normal_forces
from lacore.numerics.arrays import Floats
from lacore.program.state import ProgramState, out_of_balance

_COLUMNS = {
    2: ("x", "y", "force_x", "force_y", "moment"),
    3: (*"xyz", *(f"{kind}_{axis}" for kind in ("force", "moment") for axis in "xyz")),
}


def support_reactions(discretisation: Discretisation, point: ProgramState) -> pd.DataFrame:
    """Return the table of forces and moments, see `LimitState.support_reactions`.

    They are in N/m and N, or in N and N m for three-dimensional problems.

    Args:
        discretisation: Discretisation of the problem.
        point: State in SI units.
    """
    d = discretisation
    rigid: dict[str, RigidParts] = {**d.blocks, **d.frames}
    force = without_bonds(d.problem, rigid, out_of_balance(d.full, point))
    taken, frames = _taken(d, point.load_factor), []
    for name, dofs in d.continua.items():
        held = d.held_nodes[dofs.first_node :][: dofs.nodes.shape[1]]
        nodal = _nodal(d, name, dofs, force, point) + taken[dofs.dofs]
        columns = dict(
            zip(_COLUMNS[len(nodal)], (*dofs.nodes[:, held], *nodal[:, held]), strict=False)
        )
        none = dict.fromkeys(_COLUMNS[len(nodal)][len(columns) :], 0.0)
        frames.append(pd.DataFrame({"body": name, **columns, **none}))
    supports = supports_of(d.problem)
    for name, part in rigid.items():
        place, exerted = part.support_forces(
            force[part.offset : part.offset + part.count],
            [support for support in supports if support.body == name],
        )
        columns = dict(zip(_COLUMNS[len(place)], (*place, *exerted), strict=True))
        frames.append(pd.DataFrame({"body": name, **columns}))
    return pd.concat(frames, ignore_index=True)


def _taken(d: Discretisation, load_factor: float) -> Floats:
    """Return the forces that balance tractions which act on supports and footings, (n,), N/m.

    A body that slips past them does not feel these tractions.
    """
    unknowns, problem = Unknowns.of(d.problem), d.problem
    reference, dead = (
        moved_to_holders(loads, problem, unknowns, d.slips)
        for loads in (problem.reference_loads, problem.dead_loads)
    )
    return load_factor * reference + dead


def _nodal(
    d: Discretisation, name: str, dofs: BodyDofs, force: Floats, point: ProgramState
) -> Floats:
    """Forces of supports and footings on the nodes of a continuum, shape (d, nodes)."""
    first = gathering.region_count(d.continua)
    after = zip(point.stress[first:], point.mean_stress[first:], strict=True)
    pulled = np.zeros(force.size)  # what the body slips past pulls it back
    for jump, stresses in zip(d.jumps.values(), after, strict=False):
        if name in jump.bodies:
            pulled += jump.held_force(*stresses)
    if not dofs.normal_flow:
        return np.asarray((force - pulled)[dofs.dofs])
    # Forces between elements whose normal velocities are one stand in the balance, too.
    own = force[dofs.offset : dofs.offset + dofs.count]
    footings = footings_of(d.problem)
    asked = face_conditions(dofs.body, d.problem.supports, footings, name)
    return np.asarray(normal_forces(dofs, own, np.unique(asked.nodes)) - pulled[dofs.dofs])
