"""What supports and rigid footings exert on what they hold or move."""

import pandas as pd

from lacore.assembly.bonds import supports_of, without_bonds
from lacore.assembly.discretisation import Discretisation
from lacore.bodies.any_body import RigidParts
from lacore.bodies.continuum.regions import gathering
from lacore.state import ProgramState, out_of_balance

_COLUMNS = {
    2: ("x", "y", "force_x", "force_y", "moment"),
    3: (*"xyz", *(f"{kind}_{axis}" for kind in ("force", "moment") for axis in "xyz")),
}


def support_reactions(discretisation: Discretisation, point: ProgramState) -> pd.DataFrame:
    """Table of forces, N/m, and moments, N, in space N and N m: see `LimitState.support_reactions`.

    Args:
        discretisation: of the problem.
        point: in SI units.
    """
    d = discretisation
    rigid: dict[str, RigidParts] = {**d.assemblies, **d.frames, **d.solids}
    force = without_bonds(d.problem, rigid, out_of_balance(d.full, point))
    after = point.stress[gathering.region_count(d.bodies) :]
    for jump, stress in zip(d.jumps.values(), after, strict=False):
        force -= jump.held_force(stress)  # what the body slips past pulls it back
    frames = []
    for name, dofs in d.bodies.items():
        held = d.held_nodes[dofs.first_node :][: dofs.nodes.shape[1]]
        frames.append(
            pd.DataFrame(
                {
                    "body": name,
                    "x": dofs.nodes[0, held],
                    "y": dofs.nodes[1, held],
                    "force_x": force[dofs.dofs[0, held]],
                    "force_y": force[dofs.dofs[1, held]],
                    "moment": 0.0,
                }
            )
        )
    supports = supports_of(d.problem)
    for name, part in rigid.items():
        place, exerted = part.support_forces(
            force[part.offset : part.offset + part.count],
            [support for support in supports if support.body == name],
        )
        columns = dict(zip(_COLUMNS[len(place)], (*place, *exerted), strict=True))
        frames.append(pd.DataFrame({"body": name, **columns}))
    return pd.concat(frames, ignore_index=True)
