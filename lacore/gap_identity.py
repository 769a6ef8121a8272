"""Gap identity (T26): where the difference between upper and lower bound comes from."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from lacore.arrays import Floats
from lacore.dofs import BodyDofs
from lacore.equilibrium import EquilibriumDofs
from lacore.errors import InputError
from lacore.result import LimitState
from lacore.static_bound import LowerBound
from lacore.status import Status

_SPACE = "p2-vertex"


@dataclass(frozen=True)
class GapIdentity:
    """``upper - lower`` as a sum of shares that are all >= 0.

    Attributes:
        upper, lower: load factors.
        elements: share of each element by body, shape (elements,), in the unit of load factors.
        interfaces: share of each interface by name.
    """

    upper: float
    lower: float
    elements: Mapping[str, Floats]
    interfaces: Mapping[str, float]

    @property
    def total(self) -> float:
        """Sum of all shares."""
        elements = sum(float(gaps.sum()) for gaps in self.elements.values())
        return elements + sum(self.interfaces.values())

    @property
    def least(self) -> float:
        """The least share: below 0 by the round-off of both solves only."""
        return min(
            [*self.interfaces.values(), *(float(gaps.min()) for gaps in self.elements.values())]
        )


def gap_identity(upper: LimitState, lower: LowerBound) -> GapIdentity:
    """Element gaps ``A/3 sum_i D(eps_i) - int sigma : eps`` of two bounds on the same meshes.

    Strain rates of the upper bound, stresses of the lower one; interfaces have
    ``w limit ||u_t|| + int t.u``.

    Raises:
        InputError: other meshes, a velocity space that is not ``p2-vertex``, friction that is
            frozen by a loop, a bound that is not there.
    """
    _check(upper, lower)
    program, static = upper.discretisation.full, lower.model.full
    assert upper.point is not None
    assert lower.point is not None
    velocity = upper.point.velocity / float(program.reference_load @ upper.point.velocity)
    bodies = upper.discretisation.bodies
    restricted = np.zeros(static.n)
    for name, multipliers in lower.model.bodies.items():
        nodes, values = _restriction(bodies[name], multipliers, velocity)
        restricted[2 * nodes], restricted[2 * nodes + 1] = values
    elements = {}
    for name, kinematic, group, s, p in zip(
        lower.model.bodies,
        program.groups,
        static.groups,
        lower.point.stress,
        lower.point.mean_stress,
        strict=True,
    ):
        power = np.sum(s * group.cone_vectors(restricted), axis=1)
        power += p * (group.volumetric @ restricted)
        local = kinematic.dissipation(velocity) - group.weights * power
        elements[name] = local.reshape(-1, 3).sum(axis=1)

    rows = program.contact
    limit = np.where(np.isfinite(rows.limit), rows.limit, 0.0)
    friction = rows.weights * limit * np.linalg.norm(rows.slip(velocity), axis=1)
    contact, t = static.contact, lower.point
    pressed = t.normal_reaction * contact.opening(restricted)
    pressed += np.sum(t.tangential_reaction * contact.slip(restricted), axis=1)
    names = lower.model.points.names
    shares = np.bincount(rows.interface, friction, minlength=len(names))
    shares += np.bincount(contact.interface, contact.weights * pressed, minlength=len(names))
    return GapIdentity(
        upper=upper.load_factor,
        lower=lower.load_factor,
        elements=elements,
        interfaces=dict(zip(names, shares.tolist(), strict=True)),
    )


def _restriction(
    dofs: BodyDofs, multipliers: EquilibriumDofs, velocity: Floats
) -> tuple[Floats, Floats]:
    """Nodes of the multipliers that do the power of a P2 velocity on linear stresses, and values.

    ``2/L int N_i u ds = (u_i + 2 u_mid)/3`` at the ends of facets, and the mean over elements,
    that of their midside nodes.
    """
    mesh = dofs.body.mesh
    u = velocity[dofs.dofs]
    facets = np.arange(mesh.nfacets)
    start, middle, end = (u[:, nodes] for nodes in dofs.facet_nodes(facets))
    mean = u[:, mesh.p.shape[1] + mesh.t2f].mean(axis=1)
    nodes = np.concatenate([multipliers.facet_nodes(facets).ravel(), multipliers.element_nodes])
    values = np.concatenate([(start + 2 * middle) / 3, (end + 2 * middle) / 3, mean], axis=1)
    return nodes, values


def _check(upper: LimitState, lower: LowerBound) -> None:
    for field, bound in (("upper", upper), ("lower", lower)):
        if bound.status is not Status.SOLVED or bound.point is None:
            raise InputError(
                field, bound.status.label, "there is no bound", "look at its message for the reason"
            )
    continua, contact = upper.discretisation.bodies, upper.discretisation.full.contact
    if contact.coulomb.any():
        raise InputError(
            "upper",
            upper.coupling,
            "Coulomb friction has no bounds whose difference could be split",
            "state Coulomb(mu, associated=True) for both",
        )
    if list(continua) != list(lower.model.bodies):
        raise InputError(
            "upper",
            list(continua),
            "other bodies than those of the lower bound",
            "take one problem",
        )
    for name, dofs in continua.items():
        if dofs.body.space != _SPACE:
            raise InputError(
                "upper",
                dofs.body.space,
                "element gaps need strain rates at the vertices",
                f"solve with Body(space={_SPACE!r})",
            )
        mesh, other = dofs.body.mesh, lower.model.bodies[name].body.mesh
        same = np.array_equal(mesh.t, other.t) and np.array_equal(mesh.p, other.p)
        if not same:
            raise InputError(
                "lower",
                name,
                "its mesh is not that of the upper bound",
                "solve both on the same mesh",
            )
