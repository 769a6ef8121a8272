"""Gap identity (T26): the sources of the difference between upper and lower bound."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lacore.assembly.discretisation import Discretisation
from lacore.bounds.enclosing import require_associated_flow
from lacore.bounds.equilibrium import EquilibriumDofs
from lacore.bounds.lower import LowerBound
from lacore.bounds.quadratic.bubbles import bubble_power
from lacore.bounds.solid.restriction import solid_restriction
from lacore.bounds.upper import UpperBound, plastic_power
from lacore.limit.state import LimitState
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.regions.gathering import by_body, element_sums
from lacore.model.bodies.continuum.slip import Slip
from lacore.numerics.arrays import Floats, Ints
from lacore.program.kinematic import require_homogeneous
from lacore.reporting import terms, views
from lacore.reporting.errors import InputError, typed
from lacore.reporting.showing import Facts, Picture, Shown, counted
from lacore.reporting.status import Status
from lacore.reporting.text import text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_ORDER = "give what lacore.upper_bound returns, and then what lacore.lower_bound does"


@dataclass(frozen=True, repr=False)
class GapIdentity(Shown):
    """``upper - lower`` as a sum of non-negative shares.

    Attributes:
        upper, lower: load factors.
        elements: share of each element by body, shape (elements,), in the unit of load factors.
        interfaces: share of each interface, and of each joint of rigid blocks, by name.
        bodies: the continua, with the mesh of the elements, by name.
    """

    upper: float
    lower: float
    elements: Mapping[str, Floats]
    interfaces: Mapping[str, float]
    bodies: Mapping[str, Body]

    @property
    def total(self) -> float:
        """Sum of all shares."""
        elements = sum(float(gaps.sum()) for gaps in self.elements.values())
        return elements + sum(self.interfaces.values())

    @property
    def least(self) -> float:
        """Smallest share, which is negative only by the round-off of both solves."""
        return min(
            [*self.interfaces.values(), *(float(gaps.min()) for gaps in self.elements.values())]
        )

    def facts(self) -> Facts:
        """Return the gap and its shares, for printing."""
        gap, count = self.upper - self.lower, sum(gaps.size for gaps in self.elements.values())
        pairs = counted(len(self.interfaces), "interface")
        told = {
            "shares": f"of {counted(count, 'element')} and {pairs}",
            "sum": f"{self.total:.7g}, off by {self.total - gap:.1e}",
            "least": f"{self.least:.1e}",
        }
        title = f"GapIdentity: gap {gap:.7g} = upper {self.upper:.7g} - lower {self.lower:.7g}"
        return Facts(title, told)

    def picture(self) -> Picture | None:
        """Return the figure of `plot`."""
        return Picture(self.plot()) if self.bodies else None

    def plot(self) -> Figure:
        """Plot the shares of the elements: see `lacore.pictures.mesh.plot_gap`."""
        return views.picture(self)

    def __str__(self) -> str:
        gap, count = self.upper - self.lower, sum(gaps.size for gaps in self.elements.values())
        pairs = len(self.interfaces)
        return (
            f"gap {gap:.6g} = upper {self.upper:.6g} - lower {self.lower:.6g}\n"
            f"shares of {count} elements and {pairs} interface{'' if pairs == 1 else 's'}:"
            f" sum {self.total:.6g} (off by {self.total - gap:.1e}), least {self.least:.1e}"
        )


@typed(**dict.fromkeys(("upper", "lower"), _ORDER))
def gap_identity(upper: UpperBound | LimitState, lower: LowerBound) -> GapIdentity:
    """Compute the element gaps ``D_e - int_e sigma : eps`` of two bounds on the same meshes.

    Velocities and dissipation are those of the upper bound, stresses those of the lower one. The
    dissipation of velocity jumps counts half to either side, along supports and footings all to the
    body. Interfaces, and joints of rigid blocks, have ``w limit ||u_t|| + int t.u``.

    Raises:
        InputError: a bound is not proven or missing; other meshes, a velocity space without bounds,
            Coulomb friction, or a state within a step of a path with hardening.

    Example:
        >>> problem = la.examples.footing()
        >>> gap = la.gap_identity(la.upper_bound(problem), la.lower_bound(problem))
        >>> round(gap.total, 2), round(gap.upper - gap.lower, 2)  # shares of all elements
        (0.9, 0.9)
    """
    _check(upper, lower)
    discretisation, static, t = upper.discretisation, lower.model.full, lower.point
    program = discretisation.full
    assert t is not None
    if isinstance(upper, UpperBound):
        velocity, dissipation = upper.velocity, upper.dissipation
    else:
        assert upper.point is not None
        velocity = upper.point.velocity
        velocity = velocity / float(program.reference_load @ velocity)
        dissipation = plastic_power(discretisation, velocity, 1)
    restricted = np.zeros(static.n)
    for name, multipliers in lower.model.continua.items():
        nodes, values = _restricted(discretisation, name, multipliers, velocity)
        for axis, own in enumerate(values):
            restricted[len(values) * nodes + axis] = own
    for name, blocks in lower.model.assemblies.items():
        own = discretisation.assemblies[name]
        moving = velocity[own.offset : own.offset + own.count]
        restricted[blocks.offset : blocks.offset + blocks.count] = moving
    restricted = lower.model.bonds.carried(restricted)
    elements = {}
    powers = []
    for group, s, p in zip(static.groups, t.stress, t.mean_stress, strict=True):
        power = np.sum(s * group.cone_vectors(restricted), axis=1)
        powers.append(group.weights * (power + p * (group.volumetric @ restricted)))
    for name, dofs, parts in by_body(lower.model.continua, powers):
        elements[name] = dissipation[name] - element_sums(dofs.body, parts)
        if lower.model.bulging.any:
            bulging = lower.model.bulging.at(name, lower.load_factor)
            elements[name] -= bubble_power(bulging, discretisation.continua[name], velocity)

    rows, contact = program.contact, static.contact
    limit = np.where(np.isfinite(rows.limit), rows.limit, 0.0)
    friction = rows.weights * limit * np.linalg.norm(rows.slip(velocity), axis=1)
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
        bodies={name: discretisation.continua[name].body for name in lower.model.continua},
    )


def _restricted(
    discretisation: Discretisation, name: str, multipliers: EquilibriumDofs, velocity: Floats
) -> tuple[Ints, Floats]:
    dofs = discretisation.continua[name]
    if dofs.body.dimension == 3:
        speeds = velocity[discretisation.footings]
        return solid_restriction(name, dofs, multipliers, velocity, discretisation.problem, speeds)
    return restriction(dofs, multipliers, velocity, discretisation.slips.get(name))


def restriction(
    dofs: BodyDofs, multipliers: EquilibriumDofs, velocity: Floats, slip: Slip | None
) -> tuple[Ints, Floats]:
    """Return the nodes of multipliers with the power of a velocity on linear stresses, and values.

    The values are ``2/L int N_i u ds`` at the ends of facets and means over elements. Discontinuous
    velocities have the mean of both sides, which gives each element half the power of the jump;
    where the body slips, the velocity of its support.

    Returns:
        Nodes, shape (k,), and velocities, shape (2, k).
    """
    mesh = dofs.body.mesh
    u = velocity[dofs.dofs][:, dofs.element_nodes]  # shape (2, nodes of an element, elements)
    corner, middle = u[:, :3], u[:, 3:]
    quadratic = dofs.degree > 1
    total = np.zeros((2, 2, mesh.nfacets))  # components, ends
    for j, (a, b) in enumerate(mesh.elem.refdom.facets):
        for i, k in ((a, b), (b, a)):
            facets = mesh.t2f[j]
            end = (mesh.facets[1, facets] == mesh.t[i]).astype(np.int64)
            other = middle[:, j] - corner[:, i] / 2 if quadratic else corner[:, k] / 2
            for axis in (0, 1):
                share = corner[axis, i] + other[axis]
                np.add.at(total[axis], (end, facets), share * 2 / 3)
    if slip is not None:
        total[..., slip.facets] = slip.stuck_to(total[..., slip.facets], velocity)
    sides = 1 + (mesh.f2t[1] >= 0)
    mean = (middle if quadratic else corner).mean(axis=1)
    facets = np.arange(mesh.nfacets)
    nodes = np.concatenate([multipliers.facet_nodes(facets).ravel(), multipliers.element_nodes])
    return nodes, np.concatenate([(total / sides).reshape(2, -1), mean], axis=1)


def _check(upper: UpperBound | LimitState, lower: LowerBound) -> None:
    for field, bound in {"upper": upper, "lower": lower}.items():
        if bound.status is not Status.SOLVED:
            raise InputError(
                field, bound.status.label, "there is no bound", "look at its message for the reason"
            )
    require_homogeneous(
        upper.discretisation.program, "upper", "take the bounds of one problem, or lacore.solve's"
    )
    stated, contact = upper.discretisation, upper.discretisation.full.contact
    continua, blocks = stated.continua, stated.assemblies
    require_associated_flow(of_kind(stated.problem.bodies, Body))
    if contact.coulomb.any():
        raise InputError(
            "upper",
            None,
            "Coulomb friction has no bounds whose difference could be split",
            text("state {} for both", terms.ASSOCIATED),
        )
    outlines = [
        [(name, dofs.body.names, dofs.body.edges.start.tolist()) for name, dofs in own.items()]
        for own in (blocks, lower.model.assemblies)
    ]
    if list(continua) != list(lower.model.continua) or outlines[0] != outlines[1] or stated.frames:
        raise InputError(
            "upper",
            list(stated.problem.bodies),
            "other bodies than those of the lower bound",
            "take one problem",
        )
    for name, dofs in continua.items():
        if not (dofs.space.strict or (isinstance(upper, UpperBound) and dofs.linear)):
            raise InputError(
                "upper",
                dofs.body.space,
                "its dissipation is not a bound, so that shares could be negative",
                "give its `upper_bound`, or solve with Body(space='p2-vertex')",
            )
        mesh, other = dofs.body.mesh, lower.model.continua[name].body.mesh
        same = np.array_equal(mesh.t, other.t) and np.array_equal(mesh.p, other.p)
        if not same:
            raise InputError(
                "lower",
                name,
                "its mesh is not that of the upper bound",
                "solve both on the same mesh; of bodies whose edges do not match where they touch,"
                " `lacore.matching(problem)` has those of a lower bound",
            )
