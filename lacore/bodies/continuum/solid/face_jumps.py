"""Velocity jumps on faces of tetrahedra, as dissipation like any other (T89, T90).

A jump over a face of area A is a layer of thickness ``h = sqrt(A)``: the strain rates of which are
``[u]/h``, its volume is A h. Normal velocities do not jump by construction; along the face the
cones stand at the control values of the jump, a vertex each of a linear one, six of a quadratic one
(`lacore.bodies.continuum.jumps.FACE_CONTROL`), A over their number each.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.arrays import Floats, Ints, Sparse
from lacore.bodies.continuum.dofs import BodyDofs
from lacore.bodies.continuum.jumps import Jumps, control_values
from lacore.bodies.continuum.regions.region import Region
from lacore.bodies.continuum.solid.faces import SIDES, face_corners, face_geometry
from lacore.bodies.continuum.solid.holding import HeldFaces
from lacore.bodies.continuum.solid.lattice import divided
from lacore.bodies.continuum.solid.normal_flow import nodes_of_faces
from lacore.errors import InputError
from lacore.materials.conic_form import of_elements
from lacore.materials.fields import Field
from lacore.numerics.interleaving import interleaved
from lacore.program import DissipationGroup


@dataclass(frozen=True, repr=False)
class FaceJumps(Jumps):
    """Those on faces; `ends` are bounds at the corners of faces, all the same, shape (3, m)."""

    def power(self, velocity: Floats, parts: int) -> tuple[Ints, Floats]:
        """As `Jumps.power`: on parts of each face, whose edges are 1/parts of its own."""
        _, first, face = np.unique(
            self.place // self.copies, return_index=True, return_inverse=True
        )
        control = np.zeros((first.size, self.copies, self.group.dim))
        control[face, self.place % self.copies] = self.group.cone_vectors(velocity)
        onto, share = _blossoms(self.copies, parts)
        size = np.linalg.norm(np.einsum("pc,fcd->fpd", onto, control), axis=2)
        most = self.copies * self.group.weights[first] * self.group.bound[first]
        return self.elements[:, first], np.asarray(most * (size @ share))


@cache
def _blossoms(copies: int, parts: int) -> tuple[Floats, Floats]:
    """Control values of all parts of a face from its own, shape (p, copies), and their weights.

    Of a quadratic ``sum_ij c_ij l_i l_j`` that of two places is ``sum_ij c_ij l_i(p) l_j(q)``
    (Ramshaw 1987); of a linear one its values.
    """
    places, parts_of = divided(parts, 3)
    if copies == 3:
        return places, np.bincount(parts_of.ravel()) / parts_of.size
    ends = np.concatenate([parts_of[:, [i, i]] for i in range(3)])
    ends = np.concatenate([ends, *(parts_of[:, [i, j]] for i, j in SIDES.T)])
    pairs, count = np.unique(np.sort(ends, axis=1), axis=0, return_counts=True)
    p, q = places[pairs[:, 0]], places[pairs[:, 1]]
    mixed = [p[:, i] * q[:, j] + p[:, j] * q[:, i] for i, j in SIDES.T]
    return np.concatenate([p * q, np.stack(mixed, axis=1)], axis=1), count / count.sum()


def face_jumps(name: str, dofs: BodyDofs, held: HeldFaces, speeds: Ints, n: int) -> list[Jumps]:
    """All jumps of a body for n unknowns: between its elements, and past what holds it.

    Between elements of different strength a jump costs what the weaker one asks for.

    Args:
        name: of the body.
        dofs: of it.
        held: what holds it.
        speeds: unknowns of the footings, shape (f,).
        n: unknowns.
    """
    mesh, copies = dofs.body.mesh, nodes_of_faces(dofs)
    inner = np.flatnonzero(mesh.f2t[1] >= 0)
    past = np.flatnonzero(held.sticking)
    facets = np.concatenate([inner, held.facets[past]])
    elements = mesh.f2t[:, facets].astype(np.int64)
    elements[1, inner.size :] = elements[0, inner.size :]
    own = control_values(dofs, facets, 0, n)
    beyond = [
        csr_matrix(vstack([inside, outside]))
        for inside, outside in zip(
            control_values(dofs, inner, 1, n), _held_rows(held, past, speeds, n), strict=True
        )
    ]
    jump = [csr_matrix(b - a) for a, b in zip(own, beyond, strict=True)]
    area, _ = face_geometry(mesh, facets)
    thickness = np.sqrt(area)
    axes = np.concatenate([_in_faces(face_corners(mesh, inner)), held.along[:, :, past]], axis=2)

    def along(axis: Floats) -> Sparse:
        share = np.repeat(axis / thickness, copies, axis=1)
        x, y, z = (part.multiply(s[:, None]) for part, s in zip(jump, share, strict=True))
        rows = csr_matrix(x + y + z)
        rows.eliminate_zeros()
        return rows

    slipping = interleaved(along(axes[0]), 1, along(axes[1]), 1)
    weak, bound = _weaker(dofs, elements)
    found: list[Jumps] = []
    for number, region in enumerate(dofs.body.regions):
        mine = np.flatnonzero(weak == number)
        cones = (copies * mine[:, None] + np.arange(copies)).ravel()
        strength = np.repeat(bound[mine], copies)
        group = DissipationGroup(
            name=f"{region.group_name(name)}: jumps",
            rows=csr_matrix(slipping[(2 * cones[:, None] + np.arange(2)).ravel()]),
            dim=2,
            weights=np.repeat((area * thickness / copies)[mine], copies),
            bound=strength,
            volumetric=csr_matrix((cones.size, n)),
            volumetric_factor=0.0,
        )
        both = np.repeat(elements[:, mine], copies, axis=1)
        ends = np.tile(strength, (3, 1))
        found.append(FaceJumps((name, name), group, both, np.arange(cones.size), copies, ends))
    return found


def _weaker(dofs: BodyDofs, elements: Ints) -> tuple[Ints, Floats]:
    """Regions of the weaker of two elements, shape (e,), and what layers of it carry, Pa."""
    strength = np.zeros(dofs.body.mesh.nelements)
    owner = np.zeros(strength.size, dtype=np.int64)
    for number, region in enumerate(dofs.body.regions):
        strength[region.elements] = _strengths(region)
        owner[region.elements] = number
    side = np.argmin(strength[elements], axis=0)
    weak = elements[side, np.arange(side.size)]
    return owner[weak], strength[weak]


def _strengths(region: Region) -> Floats:
    """Largest strength of a layer in each element of a region, shape (elements,), Pa."""
    form = region.form.across()
    if form.surfaces or form.rows.shape[0] != 2:
        raise InputError(
            "Body.space",
            region.criterion,
            "velocities that jump in space do not open: of a strength that depends on pressure they"
            " would have to",
            "take 'p2-vertex', or VonMises",
        )
    slope = float(np.abs(np.linalg.svd(form.rows[:, 1:], compute_uv=False)).max())
    if isinstance(form.bound, Field):
        most = region.of(form.bound).above_if_known().max(axis=1)
        largest = of_elements(form.bound.factor, region.elements) * most
    else:
        largest = np.asarray(region.seen(form.bound))
    return np.asarray(slope * np.broadcast_to(largest, region.elements.shape))


def _in_faces(corner: Floats) -> Floats:
    """Two orthonormal directions in faces with corners (3, 3, e), shape (2, 3, e)."""
    first, second = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    first = first / np.linalg.norm(first, axis=0)
    second = second - np.sum(first * second, axis=0) * first
    return np.stack([first, second / np.linalg.norm(second, axis=0)])


def _held_rows(held: HeldFaces, past: Ints, speeds: Ints, n: int) -> Sequence[Sparse]:
    """Rows of u_x, u_y, u_z of what holds faces, at their control values, (e copies, n) each."""
    motion = held.motion[:, :, past]  # (s, 3, e, copies)
    count = past.size * motion.shape[3]
    columns = np.tile(speeds, count)
    start = speeds.size * np.arange(count + 1)
    found = []
    for own in motion.transpose(1, 2, 3, 0):
        rows = csr_matrix((own.ravel(), columns, start), (count, n))
        rows.eliminate_zeros()
        found.append(rows)
    return found
