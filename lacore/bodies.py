"""Deformable bodies: a mesh, a criterion, kinematics and a velocity space."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from skfem import MeshQuad, MeshTri
from skfem.mesh import MeshTri1

from lacore.arrays import Floats, Ints
from lacore.criteria import KINEMATICS, VonMises
from lacore.errors import InputError, require_known
from lacore.locking import crossed_quadrilaterals
from lacore.spaces import SPACES, VelocitySpace

GEOMETRIES = ("exact", "approximated")
_DEGENERATE = 1e-10  # area over squared longest edge; below it gradients lose all their digits


@dataclass(frozen=True)
class Body:
    """A continuum body.

    Attributes:
        mesh: straight-edged triangles (`skfem.MeshTri`), boundaries named; for the space ``q2``
            convex quadrilaterals (`skfem.MeshQuad`).
        criterion: yield criterion, `VonMises`.
        kinematics: ``plane_strain`` or ``plane_stress``; unit thickness.
        space: velocity space. Strict upper bounds: ``p2-vertex`` (T22), ``p2-disc`` and
            ``p1-disc`` with velocity jumps between elements (T23), ``p1`` where it does not lock.
            More accurate than bounds: ``p2-gauss``, ``q2`` (T22, T24).
        geometry: ``exact``, or ``approximated`` where straight edges replace a curved boundary:
            then no value is called a bound.

    Raises:
        InputError: wrong mesh type, inverted, degenerate or disconnected elements, a vertex
            that no element uses, unknown names, a space that locks on the mesh.
    """

    mesh: MeshTri | MeshQuad
    criterion: VonMises
    kinematics: str = "plane_strain"
    space: str = "p2-vertex"
    geometry: str = "exact"

    def __post_init__(self) -> None:
        require_known("Body.kinematics", self.kinematics, KINEMATICS)
        require_known("Body.space", self.space, SPACES)
        require_known("Body.geometry", self.geometry, GEOMETRIES)
        if not isinstance(self.criterion, VonMises):
            raise InputError(
                "Body.criterion",
                self.criterion,
                "not a yield criterion",
                "give lacore.VonMises(shear_strength=...)",
            )
        space = SPACES[self.space]
        _check_mesh(self.mesh, space)
        incompressible = not self.criterion.conic_form(self.kinematics).compressible
        if space.locks and incompressible and not crossed_quadrilaterals(self.mesh):
            raise InputError(
                "Body.space",
                self.space,
                "locks: on this mesh triangles of constant strain cannot flow at constant volume,"
                " and load factors would be far too high",
                "take 'p1-disc' or 'p2-vertex', or cut all quadrilaterals along both diagonals"
                " (lacore.meshes.rectangle(crossed=True))",
            )

    @property
    def size(self) -> float:
        """Diagonal of the bounding box, the length that tolerances refer to."""
        return float(np.linalg.norm(np.ptp(self.mesh.p, axis=1)))


def _check_mesh(mesh: MeshTri | MeshQuad, space: VelocitySpace) -> None:
    if type(mesh) is not space.mesh:
        triangles = space.mesh is MeshTri1
        wanted = "straight-edged triangles" if triangles else "quadrilaterals"
        mend = (
            "give a skfem.MeshTri (of curved boundaries: straight edges, geometry='approximated';"
            " of quadrilaterals: mesh.to_meshtri(style='x'), or space='q2')"
            if triangles
            else "give a skfem.MeshQuad, or another space"
        )
        raise InputError(
            "Body.mesh",
            type(mesh).__name__,
            f"only {wanted} are taken by the space {space.name!r}",
            mend,
        )
    if not np.all(np.isfinite(mesh.p)):
        raise InputError(
            "Body.mesh", None, "has vertices that are not finite", "mend the coordinates"
        )
    unused = np.setdiff1d(np.arange(mesh.p.shape[1]), mesh.t)
    if unused.size:
        raise InputError(
            "Body.mesh",
            unused[:5].tolist(),
            "vertices that no element uses",
            "remove them (mesh.remove_unused_nodes())",
        )
    corner = mesh.p[:, mesh.t]
    before, after = np.roll(corner, 1, axis=1), np.roll(corner, -1, axis=1)
    turn = _cross(corner - before, after - corner)  # twice the area of a triangle, thrice
    turn = turn * np.sign(turn.sum(axis=0))
    least = 2 * _DEGENERATE * np.max(np.linalg.norm(after - corner, axis=0), axis=0) ** 2
    flat = np.flatnonzero(turn.max(axis=0) < least)
    if flat.size:
        raise InputError(
            "Body.mesh", flat[:5].tolist(), "elements without area", "remove or move their vertices"
        )
    bent = np.flatnonzero(turn.min(axis=0) < least)
    if bent.size:
        raise InputError(
            "Body.mesh",
            bent[:5].tolist(),
            "quadrilaterals that are not convex",
            "move their vertices, or cut them into triangles",
        )
    folded = _folded_facets(mesh)
    if folded.size:
        raise InputError(
            "Body.mesh",
            np.unique(mesh.f2t[:, folded[:5]]).tolist(),
            "inverted elements (they lie on top of a neighbour)",
            "move the vertices so that elements do not overlap",
        )
    inner = mesh.f2t[:, mesh.f2t[1] >= 0]
    links = coo_matrix((np.ones(inner.shape[1]), inner), shape=(mesh.nelements,) * 2)
    parts = connected_components(links, directed=False)[0]
    if parts > 1:
        raise InputError(
            "Body.mesh",
            parts,
            "disconnected parts (joined by no element edge)",
            "make each part a Body of its own, or merge coincident vertices",
        )


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[0] * b[1] - a[1] * b[0])


def _folded_facets(mesh: MeshTri | MeshQuad) -> Ints:
    """Interior facets whose two elements lie on the same side."""
    inner = np.flatnonzero(mesh.f2t[1] >= 0)
    start, end = mesh.p[:, mesh.facets[0, inner]], mesh.p[:, mesh.facets[1, inner]]

    def side(elements: Ints) -> Floats:
        centre = mesh.p[:, mesh.t[:, elements]].mean(axis=1)
        return np.asarray(np.sign(_cross(end - start, centre - start)))

    return np.asarray(inner[side(mesh.f2t[0, inner]) == side(mesh.f2t[1, inner])])
