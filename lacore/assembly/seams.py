"""Velocity jumps across bonded interfaces whose two sides do not move as one (T23, T43).

Where edges do not match, where velocities jump in the bodies anyway, or where one side is rigid.
Such a seam shears, and of soils opens, at the cost of a layer of the weaker side, at the Bernstein
control values of the jump on each segment: so that bounds stay strict.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.arrays import Bools, Floats, Ints, Sparse
from lacore.assembly.bonds import Ties
from lacore.bodies.any_body import Dofs
from lacore.bodies.continuum.dofs import BodyDofs
from lacore.bodies.continuum.jumps import Jumps, layer, weaker_surfaces
from lacore.contact.controls import controls
from lacore.contact.interfaces import Interface
from lacore.contact.rows import jump_rows
from lacore.contact.segments import Segments
from lacore.errors import InputError
from lacore.materials.conic_form import ConicForm
from lacore.problem.problem import Problem
from lacore.showing import Compact
from lacore.surfaces import Surfaces

_ORDER = (0, 2, 1)  # of control values along an edge: start, middle, end
_Side = tuple[ConicForm, Ints]  # what a layer of a body costs, and the element at each cone


@dataclass(frozen=True, repr=False)
class Seam(Compact):
    """The velocity jumps across a bonded interface.

    Attributes:
        bodies: to whose elements each half of the dissipation belongs; twice the same beside what
            is rigid.
        jumps: elements are numbered in the one and in the other body.
    """

    bodies: tuple[str, str]
    jumps: Jumps

    def kept(self, mask: Bools) -> "Seam":
        """With the cones of a mask of shape (m,)."""
        return Seam(self.bodies, self.jumps.kept(mask))


def seams(
    problem: Problem,
    continua: Mapping[str, BodyDofs],
    dofs: Mapping[str, Dofs],
    tied: Ties,
    n: int,
) -> dict[str, Seam]:
    """Where velocities jump across the bonds of a problem, by the names of interfaces.

    Args:
        problem: the problem.
        continua: unknowns of those.
        dofs: of all bodies.
        tied: what moves as one.
        n: unknowns.

    Raises:
        InputError: a layer of the weaker side has no strength that could be stated.
    """
    found = {}
    for index, (interface, segments) in enumerate(
        zip(problem.interfaces, problem.segments, strict=True)
    ):
        if not interface.bonded or interface.obstacle is not None:
            continue
        jumping = ~tied.tied.get(index, np.zeros(segments.slave.size, dtype=bool))
        if jumping.any():
            own = _kept(segments, jumping)
            found[interface.name] = _seam(index, interface, own, continua, dofs, n)
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
) -> Seam:
    names = [name for name, _ in interface.sides]
    meeting = list(zip(names, segments.edges, strict=True))
    sides = [(dofs[name], dofs[name].parts(edges)) for name, edges in meeting]
    stands = controls(segments, sides)
    values = jump_rows(stands, sides, n)
    order = _ORDER if len(stands) > 2 else (0, 1)
    count, copies = segments.slave.size, len(stands)
    along = np.argsort(np.tile(np.arange(count), copies), kind="stable")  # segment by segment
    x, y = (
        csr_matrix(vstack([values[k][axis] for k in order], format="csr")[along]) for axis in (0, 1)
    )
    normal = np.concatenate([stands[k].normal for k in order], axis=1)[:, along]
    weights = np.concatenate([stands[k].weight for k in order])[along]
    length = np.repeat(np.linalg.norm(segments.end - segments.start, axis=0), copies)

    def across(direction: Floats) -> Sparse:
        share = direction / length
        return csr_matrix(x.multiply(share[0, :, None]) + y.multiply(share[1, :, None]))

    opening, slipping = across(normal), across(np.stack([-normal[1], normal[0]]))
    layers: list[tuple[str, _Side]] = []
    for name, edges in meeting:
        if name in continua:
            elements = np.repeat(continua[name].body.mesh.f2t[0, edges].astype(np.int64), copies)
            layers.append((name, (_layer(index, name, continua[name]), elements)))
    own = [side for _, side in layers]
    form, bound, surfaces = _weaker(own[0], own[-1])
    group = layer(
        f"{interface.name}: jumps",
        form,
        (opening, slipping),
        weights * length,
        bound,
        surfaces,
    )
    beside = (layers[0], layers[-1])
    return Seam(
        bodies=(beside[0][0], beside[1][0]),
        jumps=Jumps(
            group=group,
            elements=np.stack([elements for _, (_, elements) in beside]),
            place=np.arange(count * copies),
            copies=copies,
        ),
    )


def _layer(index: int, name: str, dofs: BodyDofs) -> ConicForm:
    try:
        return dofs.body.form.across()
    except InputError as none:
        raise InputError(
            f"Problem.interfaces[{index}].friction",
            "BOND",
            f"velocities may jump there, and a layer of {name!r} has no strength that could be"
            f" stated: {none.why}",
            "give both sides the same vertices and a continuous space, so that they move as one;"
            " for a rigid block take a RigidFooting",
        ) from None


def _weaker(one: _Side, other: _Side) -> tuple[ConicForm, Floats, Surfaces | None]:
    """Of the layers of two sides, (m,) each: its form, and what it carries at each cone.

    Each side bounds what the seam carries, so that the cost of either would do; of alike ones the
    lesser at each cone, else of all the one with the lesser strength in shear.
    """
    (form, elements), (facing, others) = one, other
    bounds, its = form.bounds(elements), facing.bounds(others)
    surfaces, those = form.surfaces_of(elements), facing.surfaces_of(others)
    alike = form.rows.shape == facing.rows.shape and np.array_equal(form.volumes, facing.volumes)
    if alike and np.allclose(form.rows, facing.rows) and (surfaces is None) == (those is None):
        if surfaces is not None and those is not None:
            surfaces = weaker_surfaces(surfaces, those)
        return form, np.minimum(bounds, its), surfaces
    if its.min() < bounds.min():
        return facing, its, those
    return form, bounds, surfaces
