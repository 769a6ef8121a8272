"""Loads on surfaces that supports or footings hold: they act on the support (T23, T90).

Where a body slips past a support or a footing, its velocity at the surface is that inside the slip
layer. A traction on the surface acts outside of this layer, on the support, and has power on its
velocity: a support takes it, and a footing is moved by it. Where the body sticks, both velocities
are equal, and there is no difference.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from lacore.assembly.bonds import Ties
from lacore.assembly.slips import contact_facets
from lacore.assembly.unknowns import Unknowns
from lacore.model.bodies.continuum.boundaries import outward_normals
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.forces import force_along
from lacore.model.bodies.continuum.slip import Slip
from lacore.model.bodies.continuum.solid.holding import slid_past
from lacore.model.conditions.loads import Load
from lacore.model.contact.interfaces import Interface
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact

_ROUND_OFF = 1e-9  # by the load: components along facets from the round-off of their normals


@dataclass(frozen=True, repr=False)
class _Held(Compact):
    """Facets of a body that slip past one support or footing.

    Attributes:
        facets: Facets of the mesh, shape (e,).
        directions: Orthonormal held directions, zero for none, shape (k, d, e).
        speeds: Unknowns of the footing, shape (s,); empty for a support.
        motions: Velocities of the nodes of the body for each of these speeds, shape (s, d, nodes).
    """

    facets: Ints
    directions: Floats
    speeds: Ints
    motions: Floats


def moved_to_holders(
    loads: Sequence[Load], problem: Problem, unknowns: Unknowns, slipping: Mapping[str, Slip]
) -> Floats:
    """Return the changes of nodal forces that let loads act on supports and footings.

    Args:
        loads: Loads of one kind.
        problem: Problem of the loads.
        unknowns: Unknowns of the problem.
        slipping: Where plane bodies slip, see `lacore.assembly.slips`.

    Returns:
        Forces on all unknowns, shape (n,), N/m; in three dimensions N.
    """
    total = np.zeros(unknowns.n)
    for name, dofs in unknowns.continua.items():
        for held in _held(name, dofs, problem, unknowns, slipping.get(name)):
            for load in loads:
                if load.body == name:
                    force = force_along(load, dofs.velocity, held.facets, held.directions)
                    total[dofs.offset : dofs.offset + dofs.count] -= force
                    at_nodes = force[dofs.dofs - dofs.offset]
                    total[held.speeds] += np.sum(held.motions * at_nodes, axis=(1, 2))
    return total


def require_stated_side(
    problem: Problem, unknowns: Unknowns, yielding: Sequence[Interface], tied: Ties
) -> None:
    """Reject loads along interfaces within which a body slips at its own strength.

    Such a load could act on either side of the slip layer.

    Args:
        problem: The original problem.
        unknowns: Unknowns of the problem.
        yielding: Its interfaces; those that stick are replaced where the adjacent body slips.
        tied: Which segments of bonds move together; velocities jump across the others.

    Raises:
        InputError: There is such a load.
    """
    stuck = [n for n, own in enumerate(problem.interfaces) if yielding[n] is not own]
    jumping = [
        n
        for n, bond, _ in problem.bonds
        if bond.obstacle is None and not np.all(tied.tied.get(n, False))
    ]
    for index in [*stuck, *jumping]:
        interface = problem.interfaces[index]
        for name, facets in contact_facets(problem, index).items():
            dofs = unknowns.continua.get(name)
            for field, load in problem.loads.items():
                if dofs is not None and load.body == name and _acts_along(load, dofs, facets):
                    raise InputError(
                        field,
                        load.told,
                        f"acts along {interface.name}, where the body can slip at its own strength;"
                        " it is not defined on which side of the slip surface the load acts",
                        "load the other body, or another part of the boundary",
                    )


def _acts_along(load: Load, dofs: BodyDofs, facets: Ints) -> bool:
    """Return whether a load has components along facets."""
    normal = outward_normals(dofs.body.mesh, facets, 0.5)
    every = np.broadcast_to(np.eye(len(normal))[:, :, None], (len(normal), *normal.shape))
    along = every - normal[:, None] * normal  # projection
    part, whole = (
        np.abs(force_along(load, dofs.velocity, facets, own)).max(initial=0.0)
        for own in (along, every)
    )
    return bool(part > _ROUND_OFF * whole)


def _held(
    name: str, dofs: BodyDofs, problem: Problem, unknowns: Unknowns, slip: Slip | None
) -> Iterator[_Held]:
    footings = list(unknowns.footings)
    if dofs.body.dimension == 2:
        if slip is None:
            return
        facets, owners, directions = slip.facets, slip.footing, slip.tangent[None]
    else:
        if not dofs.space.jumps:
            return
        past = slid_past(dofs, problem.supports, footings, name)
        facets, owners, directions = past.facets, past.footing, past.directions
    for owner in np.unique(owners):
        mine = owners == owner
        own = [] if owner < 0 else [footings[owner]]
        speeds = [unknowns.footings[one] + np.arange(one.speeds) for one in own]
        motions = [one.motion(dofs.nodes, speed) for one in own for speed in range(one.speeds)]
        yield _Held(
            facets[mine],
            directions[:, :, mine],
            np.concatenate([np.zeros(0, dtype=np.int64), *speeds]),
            np.reshape(motions, (-1, *dofs.nodes.shape)),
        )
