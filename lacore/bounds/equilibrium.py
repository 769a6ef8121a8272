"""Equilibrium elements (T25): linear stresses a triangle, discontinuous, and their multipliers.

The unknowns of the kinematic dual (T26b) are "nodes" of two components each: two for every facet,
W at its ends, and one v for every element. With L, n and A lengths, outward normals and areas,

    eps at vertex i = 3/(2 A) sum over the two facets f at i of L_f sym((W_f,i - v) x n_f)

is what does the power ``A/3 sum_i sigma_i : eps_i`` on the vertex stresses of an element: W is the
multiplier of traction continuity at an end of a facet, times L/2, v that of ``div sigma + b = 0``,
times A.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from lacore.arrays import Floats, Ints, Sparse
from lacore.bodies.continuum.body import Body
from lacore.bodies.continuum.boundaries import facet_geometry
from lacore.bodies.continuum.loaded import facets_of
from lacore.bodies.continuum.regions.varying import Varying
from lacore.bounds.static_loads import multiplied
from lacore.conditions.loads import Load, RigidFooting
from lacore.program import DissipationGroup
from lacore.showing import Compact

_OPPOSITE = np.array([2, 0, 1])  # local vertex across each local facet of scikit-fem
_FACETS = np.array([[0, 2], [0, 1], [1, 2]])  # local facets at each local vertex


@dataclass(frozen=True, repr=False)
class EquilibriumDofs(Compact):
    """Where a body's multipliers stand among all: as nodes, then components.

    Attributes:
        body: the body.
        first_node: number of its first node among those of all bodies.
    """

    body: Body
    first_node: int

    @classmethod
    def at(cls, body: Body, offset: int) -> "EquilibriumDofs":
        """The multipliers of a body from a number on; before it stand nodes of two each."""
        return cls(body, offset // 2)

    @property
    def n_nodes(self) -> int:
        """Number of its nodes."""
        return int(2 * self.body.mesh.nfacets + self.body.mesh.nelements)

    @property
    def offset(self) -> int:
        """Number of its first unknown."""
        return 2 * self.first_node

    @property
    def count(self) -> int:
        """Number of its unknowns."""
        return 2 * self.n_nodes

    @property
    def strength(self) -> float:
        """Largest shear stress that it can carry, Pa: of what has friction, any."""
        return self.body.largest_shear

    def facet_nodes(self, facets: Ints) -> Ints:
        """Nodes of W at both ends of facets, in the order of ``mesh.facets``, shape (2, k)."""
        ends = self.first_node + self.body.mesh.nfacets * np.arange(2)
        return np.asarray(ends[:, None] + facets)

    @property
    def element_nodes(self) -> Ints:
        """Nodes of v, shape (elements,)."""
        mesh = self.body.mesh
        return np.asarray(self.first_node + 2 * mesh.nfacets + np.arange(mesh.nelements))

    def groups(self, name: str, n: int) -> tuple[DissipationGroup, ...]:
        """Yield at the vertices, weights A/3, over n unknowns: duals are the vertex stresses.

        By region. Where strengths vary the vertices have their own: linear stresses stay within
        what is linear, or nowhere more than the strength between.
        Where friction angles do, each element has a cone within all of its own (T87).
        """
        body, mesh = self.body, self.body.mesh
        area, sides = element_geometry(body)
        facets = mesh.t2f[_FACETS]  # (vertices, 2, elements)
        end = (mesh.facets[1][facets] == mesh.t[:, None, :]).astype(np.int64)
        own = np.broadcast_to(self.element_nodes, (3, 1, mesh.nelements))
        ends = self.first_node + end * mesh.nfacets + facets
        nodes = np.concatenate([ends, own], axis=1).transpose(2, 0, 1)  # (elements, 3, 3)
        pull = sides[:, _FACETS]  # (2, vertices, 2, elements): L n of the facets at a vertex
        pull = np.concatenate([pull, -pull.sum(axis=2, keepdims=True)], axis=2)
        x, y = np.transpose(1.5 * pull / area, (0, 3, 1, 2))  # (elements, vertices, 3 nodes)
        none = np.zeros_like(x)
        strain = np.stack(
            [np.stack([x, none], -1), np.stack([none, y], -1), np.stack([y, x], -1)], axis=2
        )  # (elements, vertices, (xx, yy, gamma), nodes, components)
        columns = 2 * nodes[..., None] + np.arange(2)

        def rows(coefficients: Floats, elements: Ints) -> Sparse:
            values = np.einsum("rs,eisnc->eirnc", coefficients, strain[elements])
            indices = np.broadcast_to(columns[elements][:, :, None], values.shape)
            count, width = int(np.prod(values.shape[:3])), 6
            starts = np.arange(count + 1) * width
            matrix = csr_matrix((values.ravel(), indices.ravel(), starts), shape=(count, n))
            matrix.eliminate_zeros()
            return matrix

        groups = []
        for region in (own.weakest for own in body.regions):
            form = region.form
            bound, surfaces = region.at_points(Varying.below, 3)
            groups.append(
                DissipationGroup(
                    name=region.group_name(name),
                    rows=rows(form.rows, region.elements),
                    dim=form.rows.shape[0],
                    weights=np.repeat(area[region.elements] / 3, 3),
                    bound=bound,
                    volumetric=rows(form.volumes, region.elements),
                    volumetric_factor=form.volumetric_factor,
                    surfaces=surfaces,
                )
            )
        return tuple(groups)

    @property
    def areas(self) -> Floats:
        """Areas of the elements, m^2, shape (elements,)."""
        return element_geometry(self.body)[0]

    def rises(self, values: Floats) -> Floats:
        """Area times gradient of what is linear between vertices, shape (2, elements)."""
        _, sides = element_geometry(self.body)
        across = values[self.body.mesh.t[_OPPOSITE]]
        return np.asarray(-np.sum(across * sides, axis=1) / 2)

    def force(self, load: Load) -> Floats:
        """Forces of a load on the multipliers, shape (count,), N/m."""
        return multiplied(load, self)

    def area(self, footing: RigidFooting) -> float:
        """Length of what a footing touches, m: m^2 per unit thickness."""
        return float(self.lengths(facets_of(footing, self.body)).sum())

    def lengths(self, facets: Ints) -> Floats:
        """Lengths of boundary facets, m, shape (k,)."""
        start, end, _ = facet_geometry(self.body, facets)
        return np.asarray(np.linalg.norm(end - start, axis=0))


def element_geometry(body: Body) -> tuple[Floats, Floats]:
    """Areas, shape (elements,), and length times outward normal of facets, (2, 3, elements)."""
    mesh = body.mesh
    start, end = mesh.p[:, mesh.facets[0][mesh.t2f]], mesh.p[:, mesh.facets[1][mesh.t2f]]
    along = end - start
    across = np.stack([along[1], -along[0]])
    inward = mesh.p[:, mesh.t[_OPPOSITE]] - start
    height = np.sum(across * inward, axis=0)  # twice the area, signed
    sides = -across * np.sign(height)
    return np.abs(height[0]) / 2, sides
