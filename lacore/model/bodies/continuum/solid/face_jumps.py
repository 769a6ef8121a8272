"""Velocity jumps on faces of tetrahedra as dissipation (T89, T90).

A jump over a face of area A is a layer of thickness ``h = sqrt(A)`` with strain rates ``[u]/h`` and
volume A h. The cones are at the control values of the jump: the vertices for a linear one, six
points for a quadratic one (`lacore.model.bodies.continuum.jumps.FACE_CONTROL`), each with A divided
by their number. Normal velocities do not jump by construction, except in soil, which opens as it
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
    """Jumps on faces, along which strengths are constant."""

    def power(self, velocity: Floats, parts: int) -> tuple[Ints, Floats]:
        """Return the power as `Jumps.power`, on parts of each face with 1/parts of its edges."""
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
    """Return the control values of all parts of a face, (p, copies), and their weights.

    For a quadratic ``sum_ij c_ij l_i l_j`` that of two places is ``sum_ij c_ij l_i(p) l_j(q)``
    (Ramshaw 1987); for a linear one it is the value.
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
    """Return all jumps of a body for n unknowns: between elements, and past supports.

    For elements of different strength see `lacore.model.bodies.continuum.jumps`.

    Args:
        name: name of the body.
        dofs: unknowns of the body.
        held: held faces, past which it may slip.
        speeds: unknowns of the footings, shape (f,).
        n: number of unknowns.
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
    """Return two orthonormal directions in faces with corners (3, 3, e), shape (2, 3, e)."""
    first, second = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    first = first / np.linalg.norm(first, axis=0)
    second = second - np.sum(first * second, axis=0) * first
    return np.stack([first, second / np.linalg.norm(second, axis=0)])


def _held_rows(held: HeldFaces, past: Ints, speeds: Ints, n: int) -> Sequence[Sparse]:
    """Return rows of u_x, u_y, u_z of the supports of faces at control values, (e copies, n)."""
    motion = held.motion[:, :, past]  # shape (s, 3, e, copies)
    count = past.size * motion.shape[3]
    columns = np.tile(speeds, count)
    start = speeds.size * np.arange(count + 1)
    found = []
    for own in motion.transpose(1, 2, 3, 0):
        rows = csr_matrix((own.ravel(), columns, start), (count, n))
        rows.eliminate_zeros()
        found.append(rows)
    return found
