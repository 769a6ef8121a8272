"""Equilibrium elements (T25) with discontinuous linear stresses, and their multipliers.

Elements are triangles or tetrahedra (T91). The unknowns of the kinematic dual (T26b) are "nodes" of
two components each, or of three in three dimensions: W at every vertex of every facet, and v of
every element. With L, n and A lengths, outward normals and areas,

    eps at vertex i = 3/(2 A) sum over the two facets f at i of L_f sym((W_f,i - v) x n_f)

has the power ``A/3 sum_i sigma_i : eps_i`` on the vertex stresses of an element: W is the
multiplier of traction continuity at an end of a facet, times L/2, v that of ``div sigma + b = 0``,
times A. In three dimensions areas A and volumes V take their place, with ``4/(3 V)`` and three
facets.
"""

from dataclasses import dataclass
from functools import singledispatch

import numpy as np
from scipy.sparse import csr_matrix
from skfem import Mesh

from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.body_forces import force_field
from lacore.model.bodies.continuum.boundaries import facet_geometry, facets_of, outward_normals
from lacore.model.bodies.continuum.regions.varying import Varying
from lacore.model.bodies.continuum.solid.faces import face_geometry
from lacore.model.bodies.continuum.water import in_pores, on_facets
from lacore.model.conditions.body_forces import BodyForce
from lacore.model.conditions.footings import Footing
from lacore.model.conditions.loads import Load, SurfaceLoad
from lacore.model.conditions.water import PorePressure, StandingWater
from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.program.kinematic import DissipationGroup
from lacore.reporting.showing import Compact

_OPPOSITE = {2: np.array([2, 0, 1]), 3: np.array([3, 2, 1, 0])}
"""Local vertex across each local facet of scikit-fem, by dimension."""
_FACETS = {
    2: np.array([[0, 2], [0, 1], [1, 2]]),
    3: np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]),
}
"""Local facets at each local vertex."""
_SHEARS = {2: ((1, 0),), 3: ((1, 0), (2, 1), (0, 2))}
"""For shear (xy), or (xy, yz, zx): the component of ``n`` for u along the other axis."""


@dataclass(frozen=True, repr=False)
class EquilibriumDofs(Compact):
    """Places of the multipliers of a body among all: by nodes, then by components.

    Attributes:
        body: the body.
        first_node: number of its first node among those of all bodies.
    """

    body: Body
    first_node: int

    @classmethod
    def at(cls, body: Body, offset: int) -> "EquilibriumDofs":
        """Return the multipliers of a body that begin at a given number."""
        return cls(body, offset // body.dimension)

    @property
    def n_nodes(self) -> int:
        """Number of its nodes."""
        return int(self.body.dimension * self.body.mesh.nfacets + self.body.mesh.nelements)

    @property
    def offset(self) -> int:
        """Number of its first unknown."""
        return self.body.dimension * self.first_node

    @property
    def count(self) -> int:
        """Number of its unknowns."""
        return self.body.dimension * self.n_nodes

    @property
    def strength(self) -> float:
        """Largest shear stress that the body can carry, Pa; any value with friction."""
        return self.body.largest_shear

    def facet_nodes(self, facets: Ints) -> Ints:
        """Return the nodes of W at the vertices of facets as in ``mesh.facets``, shape (d, k)."""
        ends = self.first_node + self.body.mesh.nfacets * np.arange(self.body.dimension)
        return np.asarray(ends[:, None] + facets)

    @property
    def element_nodes(self) -> Ints:
        """Nodes of v, shape (elements,)."""
        mesh = self.body.mesh
        before = self.first_node + self.body.dimension * mesh.nfacets
        return np.asarray(before + np.arange(mesh.nelements))

    def groups(self, name: str, n: int) -> tuple[DissipationGroup, ...]:
        """Return the groups of yield at the vertices over n unknowns, by region.

        The weights are A/3 (V/4), and the duals are the vertex stresses. Where strengths vary, each
        vertex has its own: linear stresses stay within a linear strength, or nowhere exceed the
        strength between. Where friction angles vary, each element has a cone within all of its own
        (T87).
        """
        body, mesh, d = self.body, self.body.mesh, self.body.dimension
        area, sides = element_geometry(body)
        facets = mesh.t2f[_FACETS[d]]  # shape (vertices, d, elements)
        end = np.argmax(mesh.facets[:, facets] == mesh.t[None, :, None, :], axis=0)
        own = np.broadcast_to(self.element_nodes, (d + 1, 1, mesh.nelements))
        ends = self.first_node + end * mesh.nfacets + facets
        # shape (elements, vertices, ..)
        nodes = np.concatenate([ends, own], axis=1).transpose(2, 0, 1)
        # shape (d, vertices, d, elements): L n of the facets at a vertex
        pull = sides[:, _FACETS[d]]
        pull = np.concatenate([pull, -pull.sum(axis=2, keepdims=True)], axis=2)
        # shape (d, elements, vertices, ..)
        pull = np.transpose((d + 1) / d * pull / area, (0, 3, 1, 2))
        strain = np.zeros((*pull.shape[1:3], d + len(_SHEARS[d]), pull.shape[3], d))
        # shape (elements, vertices, (xx, yy, gamma), nodes, components)
        for axis in range(d):
            strain[:, :, axis, :, axis] = pull[axis]
        for row, (one, other) in enumerate(_SHEARS[d], start=d):
            strain[:, :, row, :, other] = pull[one]
            strain[:, :, row, :, one] = pull[other]
        columns = d * nodes[..., None] + np.arange(d)

        def rows(coefficients: Floats, elements: Ints) -> Sparse:
            values = np.einsum("rs,eisnc->eirnc", coefficients, strain[elements])
            indices = np.broadcast_to(columns[elements][:, :, None], values.shape)
            count, width = int(np.prod(values.shape[:3])), d * (d + 1)
            starts = np.arange(count + 1) * width
            matrix = csr_matrix((values.ravel(), indices.ravel(), starts), shape=(count, n))
            matrix.eliminate_zeros()
            return matrix

        groups = []
        for region in (own.weakest for own in body.regions):
            form = region.form
            bound, surfaces = region.at_points(Varying.below, d + 1)
            groups.append(
                DissipationGroup(
                    name=region.group_name(name),
                    rows=rows(form.rows, region.elements),
                    dim=form.rows.shape[0],
                    weights=np.repeat(area[region.elements] / (d + 1), d + 1),
                    bound=bound,
                    volumetric=rows(form.volumes, region.elements),
                    volumetric_factor=form.volumetric_factor,
                    surfaces=surfaces,
                )
            )
        return tuple(groups)

    @property
    def areas(self) -> Floats:
        """Areas of the elements, m^2, or volumes, m^3, shape (elements,)."""
        return element_geometry(self.body)[0]

    def rises(self, values: Floats) -> Floats:
        """Return the area times the gradient of linear functions, shape (2, elements)."""
        _, sides = element_geometry(self.body)
        across = values[self.body.mesh.t[_OPPOSITE[2]]]
        return np.asarray(-np.sum(across * sides, axis=1) / 2)

    def force(self, load: Load) -> Floats:
        """Return the forces of a load on the multipliers, shape (count,), N/m."""
        return _multiplied(load, self)

    def area(self, footing: Footing) -> float:
        """Return the length of the facets of a footing, m, or their area, m^2."""
        return float(self.lengths(facets_of(footing, self.body.mesh)).sum())

    def lengths(self, facets: Ints) -> Floats:
        """Return the lengths of boundary facets, m, or their areas, m^2, shape (k,)."""
        if self.body.dimension == 3:
            return face_geometry(self.body.mesh, facets)[0]
        start, end, _ = facet_geometry(self.body.mesh, facets)
        return np.asarray(np.linalg.norm(end - start, axis=0))


def element_geometry(body: Body) -> tuple[Floats, Floats]:
    """Return areas, shape (elements,), and length times outward normal of facets, (2, 3, elements).

    In three dimensions they are volumes, and area times outward normal, (3, 4, elements).
    """
    mesh = body.mesh
    if body.dimension == 3:
        return _in_space(mesh)
    start, end = mesh.p[:, mesh.facets[0][mesh.t2f]], mesh.p[:, mesh.facets[1][mesh.t2f]]
    along = end - start
    across = np.stack([along[1], -along[0]])
    inward = mesh.p[:, mesh.t[_OPPOSITE[2]]] - start
    height = np.sum(across * inward, axis=0)  # twice the area, signed
    sides = -across * np.sign(height)
    return np.abs(height[0]) / 2, sides


def _in_space(mesh: Mesh) -> tuple[Floats, Floats]:
    a, b, c = (mesh.p[:, end[mesh.t2f]] for end in mesh.facets)
    across = np.cross(b - a, c - a, axis=0) / 2
    inward = mesh.p[:, mesh.t[_OPPOSITE[3]]] - a
    height = np.sum(across * inward, axis=0)  # three times the volume, signed
    return np.abs(height[0]) / 3, -across * np.sign(height)


@singledispatch
def _multiplied(load: Load, dofs: "EquilibriumDofs") -> Floats:
    """Return the forces of a load, shape (count,), N/m; point forces are rejected before."""
    raise TypeError(f"no forces on multipliers: {type(load).__name__}")


@_multiplied.register(SurfaceLoad)
def _on_boundary(load: SurfaceLoad, dofs: "EquilibriumDofs") -> Floats:
    facets, d = facets_of(load, dofs.body.mesh), dofs.body.dimension
    share = dofs.lengths(facets) / d * load.on(outward_normals(dofs.body.mesh, facets, 0.5))
    return _at(dofs, dofs.facet_nodes(facets).ravel(), np.tile(share, d))


@_multiplied.register(BodyForce)
def _of_volume(load: BodyForce, dofs: "EquilibriumDofs") -> Floats:
    own = force_field(load, dofs.body.mesh, "BodyForce")
    return _at(dofs, dofs.element_nodes[own.elements], dofs.areas[own.elements] * own.mean)


@_multiplied.register(StandingWater)
def _standing(load: StandingWater, dofs: "EquilibriumDofs") -> Floats:
    facets = facets_of(load, dofs.body.mesh)
    return _pushed(dofs, facets, -on_facets(load, dofs.body.mesh, facets, "StandingWater"))


@_multiplied.register(PorePressure)
def _of_pores(load: PorePressure, dofs: "EquilibriumDofs") -> Floats:
    # This is the power of -u I on the vertex strains; multipliers of interior facets cancel.
    u, outline = in_pores(load, dofs.body.mesh, "PorePressure"), dofs.body.mesh.boundary_facets()
    return _at(dofs, dofs.element_nodes, -dofs.rises(u)) + _pushed(dofs, outline, u)


def _pushed(dofs: "EquilibriumDofs", facets: Ints, pressure: Floats) -> Floats:
    """Return the forces of pressures at vertices, linear along facets, along the outward normal."""
    start, end, outward = facet_geometry(dofs.body.mesh, facets)
    ends = dofs.body.mesh.facets[:, facets]
    half = np.linalg.norm(end - start, axis=0) / 2
    force = np.concatenate([half * pressure[own] * outward for own in ends], axis=1)
    return _at(dofs, dofs.facet_nodes(facets).ravel(), force)


def _at(dofs: "EquilibriumDofs", nodes: Ints, force: Floats) -> Floats:
    """Return the forces (d, k) added at nodes (k,), which may repeat."""
    total = np.zeros((dofs.n_nodes, dofs.body.dimension))
    np.add.at(total, nodes - dofs.first_node, force.T)
    return total.ravel()
