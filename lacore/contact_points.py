"""Contact points: rows of normal and tangential velocity on element edges (T28).

They stand at the Bernstein control values of the velocity on each edge (its ends, and
``2 u_mid - (u_start + u_end)/2``, weights L/3 each), so that ``u_n >= 0`` holds along the whole
edge and frozen friction dissipation is over-estimated. Control values that two edges of one
direction share are one point.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix, vstack

from lacore.arrays import Floats, Sparse
from lacore.boundaries import boundary_facets, facet_geometry
from lacore.dofs import BodyDofs
from lacore.interfaces import Interface
from lacore.program import ContactRows

_UNATTAINABLE = 100.0  # times the shear strength: control values may exceed it, not by this
_SAME_NORMAL = 9  # digits to which the normals of two edges count as one


@dataclass(frozen=True)
class ContactPoints:
    """Geometry of contact points, for results and pictures.

    Attributes:
        position, normal: shape (m, 2); `normal` from the master into the slave.
    """

    position: Floats
    normal: Floats


@dataclass(frozen=True)
class _ControlValues:
    """Control values of one interface; the velocity is ``(x rows @ U, y rows @ U)``."""

    points: ContactPoints
    weights: Floats
    x: Sparse
    y: Sparse


def contact_rows(
    interfaces: Sequence[Interface], bodies: Mapping[str, BodyDofs], n: int
) -> tuple[ContactRows, ContactPoints]:
    """Contact rows of all interfaces for n unknowns, and where they stand."""
    parts = [_control_values(interface, bodies[interface.slave[0]], n) for interface in interfaces]
    normal = np.concatenate([np.zeros((0, 2)), *(part.points.normal for part in parts)])
    position = np.concatenate([np.zeros((0, 2)), *(part.points.position for part in parts)])
    sizes = [part.weights.size for part in parts]
    x = vstack([csr_matrix((0, n)), *(part.x for part in parts)], format="csr")
    y = vstack([csr_matrix((0, n)), *(part.y for part in parts)], format="csr")

    def along(direction: Floats) -> Sparse:
        return csr_matrix(x.multiply(direction[:, :1]) + y.multiply(direction[:, 1:]))

    laws = [interface.law.terms() for interface in interfaces]
    rows = ContactRows(
        normal=along(normal),
        tangential=along(np.stack([-normal[:, 1], normal[:, 0]], axis=1)),
        tangent_dim=1,
        weights=np.concatenate([np.zeros(0), *(part.weights for part in parts)]),
        coefficient=np.repeat([law.coefficient for law in laws], sizes),
        limit=np.repeat(
            [
                _attainable(law.limit, bodies[interface.slave[0]])
                for law, interface in zip(laws, interfaces, strict=True)
            ],
            sizes,
        ),
        dilatancy=np.repeat([law.dilatancy for law in laws], sizes),
        interface=np.repeat(np.arange(len(parts)), sizes),
    )
    return rows, ContactPoints(position=position, normal=normal)


def _attainable(limit: float, dofs: BodyDofs) -> float:
    """A friction limit, infinite where it is far beyond any shear stress the body can carry."""
    strength = dofs.body.criterion.k
    return limit if limit <= _UNATTAINABLE * strength else inf


def _control_values(interface: Interface, dofs: BodyDofs, n: int) -> _ControlValues:
    facets = boundary_facets(dofs.body, interface.slave[1], "Interface.slave")
    start, end, outward = facet_geometry(dofs.body, facets)
    length = np.linalg.norm(end - start, axis=0)
    start_node, mid_node, end_node = dofs.facet_nodes(facets)
    nodes = np.concatenate([start_node, mid_node, end_node])
    normal = np.tile(-outward.T, (3, 1))
    key = np.column_stack([nodes, np.round(normal, _SAME_NORMAL) + 0.0])  # + 0.0: no minus zero
    _, first, point = np.unique(key, axis=0, return_index=True, return_inverse=True)
    point = point.ravel()
    mid_point = point[facets.size : 2 * facets.size]
    own_share = np.ones(first.size)
    own_share[mid_point] = 2.0
    row = np.concatenate([np.arange(first.size), mid_point, mid_point])
    node = np.concatenate([nodes[first], start_node, end_node])
    share = np.concatenate([own_share, np.full(2 * facets.size, -0.5)])
    x, y = (
        csr_matrix(coo_matrix((share, (row, dofs.dofs[axis, node])), shape=(first.size, n)))
        for axis in (0, 1)
    )
    return _ControlValues(
        points=ContactPoints(position=dofs.nodes[:, nodes[first]].T, normal=normal[first]),
        weights=np.bincount(point, np.tile(length / 3, 3)).astype(np.float64),
        x=x,
        y=y,
    )
