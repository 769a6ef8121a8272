"""Velocity jumps on faces of tetrahedra, as dissipation like any other (T89, T90).

A jump over a face of area A is a layer of thickness ``h = sqrt(A)``: the strain rates of which are
``[u]/h``, its volume is A h. The cones stand at the control values of the jump, a vertex each of a
linear one, six of a quadratic one (`lacore.model.bodies.continuum.jumps.FACE_CONTROL`), A over
their number each. Normal velocities do not jump by construction, but of soil, which opens as it
slips.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.jumps import Jumps, control_values, layered
from lacore.model.bodies.continuum.solid.faces import SIDES, face_geometry
from lacore.model.bodies.continuum.solid.holding import HeldFaces
from lacore.model.bodies.continuum.solid.lattice import divided
from lacore.model.bodies.continuum.solid.normal_flow import nodes_of_faces
from lacore.model.meshes.solid.faces import face_corners
from lacore.numerics.arrays import Floats, Ints, Sparse


@dataclass(frozen=True, repr=False)
class FaceJumps(Jumps):
    """Those on faces, along which strengths are the same everywhere."""

    def power(self, velocity: Floats, parts: int) -> tuple[Ints, Floats]:
        """As `Jumps.power`: on parts of each face, whose edges are 1/parts of its own."""
        if self.group.surfaces is not None:
            return super().power(velocity, parts)
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

    Between elements of different strength as in the plane, see
    `lacore.model.bodies.continuum.jumps`.

    Args:
        name: of the body.
        dofs: of it.
        held: what holds it, and what it slips past.
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
    area, normal = face_geometry(mesh, facets)
    thickness = np.sqrt(area)
    axes = np.concatenate([_in_faces(face_corners(mesh, inner)), held.along[:, :, past]], axis=2)

    def along(axis: Floats) -> Sparse:
        share = np.repeat(axis / thickness, copies, axis=1)
        x, y, z = (part.multiply(s[:, None]) for part, s in zip(jump, share, strict=True))
        rows = csr_matrix(x + y + z)
        rows.eliminate_zeros()
        return rows

    opening = csr_matrix(jump[0].shape) if dofs.normal_flow else along(normal)
    start, end, _ = face_corners(mesh, facets).transpose(1, 0, 2)
    volumes = np.repeat(area * thickness / copies, copies)
    return layered(
        name, dofs, elements, (start, end), (opening, *map(along, axes)), volumes, FaceJumps
    )


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
