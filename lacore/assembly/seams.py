"""Velocity jumps across bonded interfaces whose sides do not move together (T23, T43).

This is where edges do not match, where velocities jump in the bodies, or where one side is rigid.
Such a seam shears, and opens in soils, at the cost of a layer of the weaker side. The cost is
evaluated at the Bernstein control values of the jump on each segment, so that bounds remain strict.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.assembly.bonds import Ties
from lacore.model.bodies.any_body import Dofs
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.jumps import Jumps, layer
from lacore.model.bodies.continuum.regions.layers import Beside, Layer, costs, within_both
from lacore.model.bodies.continuum.regions.region import Region
from lacore.model.contact.controls import controls
from lacore.model.contact.interfaces import Interface
from lacore.model.contact.rows import jump_rows
from lacore.model.contact.segments import Segments
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Bools, Floats, Ints, Sparse
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact

_ORDER = (0, 2, 1)  # order of the control values along an edge: start, middle, end


def seams(
    problem: Problem,
    continua: Mapping[str, BodyDofs],
    dofs: Mapping[str, Dofs],
    tied: Ties,
    n: int,
) -> dict[str, Jumps]:
    """Return the velocity jumps across the bonds of a problem, by the names of interfaces.

    Interfaces with different weaker regions are split by the names of their groups.

    Args:
        problem: the problem.
        continua: unknowns of the continua.
        dofs: unknowns of all bodies.
        tied: nodes that move together.
        n: number of unknowns.

    Raises:
        InputError: a layer of the weaker side has no strength of its own.
    """
    found: dict[str, Jumps] = {}
    for index, interface, segments in problem.bonds:
        names = [name for name, _ in interface.sides]
        if len(names) < 2 or not any(name in continua for name in names):
            continue
        jumping = ~tied.tied.get(index, np.zeros(segments.slave.size, dtype=bool))
        if jumping.any():
            own = _kept(segments, jumping)
            found |= _seam(index, interface, own, continua, dofs, n)
    return found


def _kept(segments: Segments, mask: Bools) -> Segments:
    return Segments(
        segments.slave[mask],
        segments.master[mask],
        segments.start[:, mask],
        segments.end[:, mask],
        segments.normal[:, mask],
    )


def _seam(
    index: int,
    interface: Interface,
    segments: Segments,
    continua: Mapping[str, BodyDofs],
    dofs: Mapping[str, Dofs],
    n: int,
) -> dict[str, Jumps]:
    meeting = [
        (name, edges) for (name, _), edges in zip(interface.sides, segments.edges, strict=True)
    ]
    rates = _Rates.of(segments, [(dofs[name], dofs[name].parts(own)) for name, own in meeting], n)
    sides = [
        _Side.of(index, name, continua[name], edges, segments)
        for name, edges in meeting
        if name in continua
    ]
    beside = (sides[0], sides[-1])  # the same side twice next to a rigid one
    side = np.argmin([own.cost for own in beside], axis=0)
    ends, count, copies = (segments.start, segments.end), segments.slave.size, rates.copies
    found = {}
    for which, own in enumerate(beside):
        other = beside[1 - which]
        for number, weak in own.layers.items():
            mine = np.flatnonzero((side == which) & (own.owner == number))
            if not mine.size:
                continue
            for beyond, part, carried in within_both(
                own.beside, other.beside, number, mine, ends, copies
            ):
                if not part.size:
                    continue
                title = interface.name
                if len(own.layers) > 1 or part.size < count:
                    title = f"{title}, {weak.region.group_name(own.name)}"
                if beyond is not None:
                    title = f"{title} next to {other.layers[beyond].region.group_name(other.name)}"
                cones = (copies * part[:, None] + np.arange(copies)).ravel()
                found[title] = Jumps(
                    bodies=(beside[0].name, beside[1].name),
                    group=layer(f"{title}: jumps", weak.form, *rates.at(cones), carried),
                    elements=np.stack([np.repeat(one.elements[part], copies) for one in beside]),
                    place=np.arange(cones.size),
                    copies=copies,
                    ends=np.repeat(carried.ends, copies, axis=1),
                )
    return found


@dataclass(frozen=True, repr=False)
class _Rates(Compact):
    """Rates of the jump at its control values, segment by segment.

    Attributes:
        opening, slipping: rows divided by the length of the segment, (copies e, n) each.
        weights: weights times that length, shape (copies e,).
        copies: number of control values of a segment.
    """

    opening: Sparse
    slipping: Sparse
    weights: Floats
    copies: int

    @classmethod
    def of(cls, segments: Segments, sides: Sequence[tuple[Dofs, Ints]], n: int) -> "_Rates":
        """Return those on segments; sides: slave and master, and which parts of them."""
        stands = controls(segments, sides)
        values = jump_rows(stands, sides, n)
        order = _ORDER if len(stands) > 2 else (0, 1)
        count, copies = segments.slave.size, len(stands)
        along = np.argsort(np.tile(np.arange(count), copies), kind="stable")
        x, y = (
            csr_matrix(vstack([values[k][axis] for k in order], format="csr")[along])
            for axis in (0, 1)
        )
        normal = np.concatenate([stands[k].normal for k in order], axis=1)[:, along]
        weights = np.concatenate([stands[k].weight for k in order])[along]
        length = np.repeat(np.linalg.norm(segments.end - segments.start, axis=0), copies)

        def across(direction: Floats) -> Sparse:
            share = direction / length
            return csr_matrix(x.multiply(share[0, :, None]) + y.multiply(share[1, :, None]))

        slipping = across(np.stack([-normal[1], normal[0]]))
        return cls(across(normal), slipping, weights * length, copies)

    def at(self, cones: Ints) -> tuple[tuple[Sparse, Sparse], Floats]:
        """Return opening and slipping, and the weights, of some control values."""
        return (self.opening[cones], self.slipping[cones]), self.weights[cones]


@dataclass(frozen=True, repr=False)
class _Side(Compact):
    """Deformable side of e segments.

    Attributes:
        name: name of the body.
        dofs: unknowns of the body.
        layers: layers of its regions, by number.
        elements: elements at the segments, shape (e,).
        cost: strength of their layer, shape (e,), Pa.
        owner: numbers of their regions, shape (e,).
    """

    name: str
    dofs: BodyDofs
    layers: Mapping[int, Layer]
    elements: Ints
    cost: Floats
    owner: Ints

    @property
    def beside(self) -> Beside:
        """The elements on this side of the segments."""
        return Beside(self.dofs.body.mesh, self.layers, self.elements, self.owner)

    @classmethod
    def of(cls, index: int, name: str, dofs: BodyDofs, facets: Ints, segments: Segments) -> "_Side":
        """Return the side of a body.

        Raises:
            InputError: a layer of an adjacent region has no strength of its own.
        """
        elements = dofs.body.mesh.f2t[0, facets].astype(np.int64)
        layers = {
            number: _layer(index, name, region)
            for number, region in enumerate(dofs.body.regions)
            if np.isin(elements, region.elements).any()
        }
        cost, owner = costs(layers, dofs.body.mesh, (segments.start, segments.end), elements)
        return cls(name, dofs, layers, elements, cost, owner)


def _layer(index: int, name: str, region: Region) -> Layer:
    try:
        return Layer.of(region)
    except InputError as none:
        raise InputError(
            f"Problem.interfaces[{index}].friction",
            "BOND",
            f"velocities may jump there, and a layer of {region.group_name(name)!r} has no strength"
            f" that could be stated: {none.reason}",
            "give both sides the same vertices and a continuous space, so that they move as one;"
            " for a rigid block take a RigidFooting",
        ) from None
