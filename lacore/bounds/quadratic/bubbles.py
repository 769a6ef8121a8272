"""Quadratic bubble stresses for the linear part of body forces in elements (T86).

In each triangle ``tau = sum c_f lambda_i lambda_j`` over its edges f = ij: it is zero at the
vertices, and its traction on f is ``c_f n lambda_i lambda_j``. The divergence is linear, and at
vertex i ``c_ij g_j + c_ik g_k`` with the gradients g of the barycentric coordinates. With equal
tractions on both sides of edges, and none on boundaries, they balance the linear part of forces up
to a uniform rest in each element, which the linear stresses carry.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix, diags_array, eye_array, vstack

from lacore.bounds.constants import BUBBLE_REFINEMENTS, CHEAP_MEAN, NO_LINEAR_PART
from lacore.bounds.equilibrium import element_geometry
from lacore.bounds.precision import exactness
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.regions.region import Region
from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.numerics.linear_algebra import SingularError, SuperLU
from lacore.program.constants import FINISHED, SHIFT
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact

EDGES = np.array([[0, 1], [1, 2], [0, 2]])  # vertices of the local facets of scikit-fem
_NORMAL = ((0, 2), (2, 1))  # components of (xx, yy, xy) that multiply n_x and n_y in a traction


@dataclass(frozen=True, repr=False)
class Bubbles(Compact):
    """Quadratic stresses in the elements of a body.

    Attributes:
        control: c of the edges of each element, (xx, yy, xy), shape (elements, 3, 3), Pa.
        divergence: divergence at the vertices of each element, N/m^3, shape (2, elements, 3).
    """

    control: Floats
    divergence: Floats

    @classmethod
    def none(cls, body: Body) -> "Bubbles":
        """Return zero stresses."""
        count = body.mesh.nelements
        return cls(np.zeros((count, 3, 3)), np.zeros((2, count, 3)))

    @property
    def any(self) -> bool:
        """Whether any stress is not zero."""
        return bool(self.control.any())

    def times(self, factor: float) -> "Bubbles":
        """Return all stresses times a factor."""
        return Bubbles(factor * self.control, factor * self.divergence)

    def plus(self, other: "Bubbles") -> "Bubbles":
        """Return the sum of both stresses."""
        return Bubbles(self.control + other.control, self.divergence + other.divergence)

    def uses(self, region: Region) -> tuple[Floats, Floats]:
        """Return the largest use of strengths anywhere in elements, Pa, >= 0.

        The functions of criteria are sublinear: with linear stresses within the remaining strength
        at the vertices, the sum is within the strength everywhere.

        Returns:
            Use of the bound, shape (e,), and of each surface, shape (e, k).
        """
        form = region.form
        rows = np.concatenate([form.rows, form.volumes])
        own = self.control[region.elements] @ np.linalg.pinv(rows)  # sigma = rows^T (s, p)
        dim = len(form.rows)
        size, mean = np.linalg.norm(own[..., :dim], axis=2), own[..., dim:]
        bound = _most(size)
        # The use depends on slopes alone, so strengths that vary need no values here.
        _, surfaces = region.strengths(region.elements, lambda _: np.zeros(len(bound)))
        if surfaces is None:
            return bound, np.zeros((len(bound), 0))
        used = [
            surfaces.use(np.ascontiguousarray(size[:, f]), mean[:, f].ravel()) for f in range(3)
        ]
        return bound, _most(np.maximum(np.stack(used, axis=-1), 0.0))


def bubbles(body: Body, forces: Floats, field: str) -> Bubbles:
    """Return the smallest quadratic stresses for forces that are linear in elements.

    Deviatoric stresses count fully, and mean stresses less if no strength depends on pressure.

    Args:
        body: body of straight triangles.
        forces: forces at the vertices of each element, linear between, N/m^3, shape (2, elements,
            3).
        field: name for messages.

    Raises:
        InputError: a mesh whose edges cannot carry the moments of the forces.
    """
    linear = forces - forces.mean(axis=2, keepdims=True)
    if np.abs(linear).max(initial=0.0) <= NO_LINEAR_PART * np.abs(forces).max(initial=0.0):
        return Bubbles.none(body)
    gradients, spread = _gradients(body), _spread(body)
    divergence = _divergence(gradients)
    wanted = np.concatenate([-linear[axis, :, k] for axis in (0, 1) for k in (0, 1)])
    rows = csr_matrix(vstack([_continuity(body), *(_less_mean(divergence))], format="csr") @ spread)
    right = np.concatenate([np.zeros(rows.shape[0] - wanted.size), wanted])
    control = (spread @ _least(rows, right)).reshape(-1, 3, 3)
    found = np.stack([(own @ control.ravel()).reshape(3, -1).T for own in divergence])
    left = np.abs(found - found.mean(axis=2, keepdims=True) + linear).max()
    if not left <= exactness([body]) * np.abs(linear).max():
        raise InputError(
            field,
            None,
            "the edges of the mesh cannot carry the moments of a body force that varies in its"
            " elements",
            "refine the mesh once, mesh.refined(); or give a value for each element",
        )
    return Bubbles(control, found)


def bubble_power(own: Bubbles, dofs: BodyDofs, velocity: Floats) -> Floats:
    """Return ``int tau : eps`` of a velocity in elements, shape (elements,), W/m.

    It is integrated by parts: tractions have power on the mean velocity of both sides of a jump.

    Args:
        own: stresses of the body.
        dofs: unknowns on straight triangles.
        velocity: velocity of all unknowns.
    """
    mesh = dofs.body.mesh
    u = velocity[dofs.dofs][:, dofs.element_nodes]  # shape (2, nodes of an element, elements)
    corner, first, last = u[:, :3], u[:, EDGES[:, 0]], u[:, EDGES[:, 1]]
    middle = 2 * u[:, 3:] - (first + last) / 2 if dofs.degree > 1 else (first + last) / 2
    # Bernstein: u = sum corner l_i^2 + sum middle 2 l_i l_j; the divergence is linear.
    d = own.divergence.transpose(0, 2, 1)
    whole = d.sum(axis=1, keepdims=True)
    ends = d[:, EDGES[:, 0]] + d[:, EDGES[:, 1]]
    inside = np.sum(corner * (d / 10 + (whole - d) / 30), axis=(0, 1))
    inside += np.sum(middle * (ends / 15 + (whole - ends) / 30), axis=(0, 1))
    area, sides = element_geometry(dofs.body)
    total = np.zeros((2, mesh.nfacets))
    for local in range(3):
        along = (first + last)[:, local] / 20 + middle[:, local] / 15
        for axis in (0, 1):
            np.add.at(total[axis], mesh.t2f[local], along[axis])
    mean = total / (1 + (mesh.f2t[1] >= 0))
    c = own.control.transpose(2, 1, 0)  # shape ((xx, yy, xy), edges, elements)
    traction = np.stack([c[0] * sides[0] + c[2] * sides[1], c[2] * sides[0] + c[1] * sides[1]])
    around = np.sum(traction * mean[:, mesh.t2f], axis=(0, 1))
    return np.asarray(around - area * inside)


def _gradients(body: Body) -> Floats:
    """Return the gradients of barycentric coordinates, 1/m, shape (2, 3, elements)."""
    p = body.mesh.p[:, body.mesh.t]
    after, last = np.roll(p, -1, axis=1), np.roll(p, -2, axis=1)
    along = last - after
    across = np.stack([-along[1], along[0]])
    return np.asarray(across / np.sum(across * (p - after), axis=0))


def _spread(body: Body) -> Sparse:
    """Return the control stresses of (mean, difference, shear), cheap ones scaled up.

    The result is a square matrix.
    """
    count = body.mesh.nelements
    pressed = np.zeros(count, dtype=bool)
    for region in body.regions:
        pressed[region.elements] = bool(region.form.surfaces)
    cheap = np.repeat(np.where(pressed, 1.0, 1 / CHEAP_MEAN), 3)
    first = 3 * np.arange(3 * count)
    entries = [
        (first, first, cheap),
        (first, first + 1, np.ones(first.size)),
        (first + 1, first, cheap),
        (first + 1, first + 1, -np.ones(first.size)),
        (first + 2, first + 2, np.ones(first.size)),
    ]
    i, j, values = (np.concatenate(part) for part in zip(*entries, strict=True))
    return csr_matrix(coo_matrix((values, (i, j)), shape=(9 * count, 9 * count)))


def _traction(
    elements: Ints, facets: Ints, normal: Floats, sign: Floats, size: int
) -> list[Sparse]:
    """Return the rows of ``c n`` on local facets of elements, (x, y), each (k, size)."""
    first = 9 * elements + 3 * facets
    rows = np.arange(elements.size)
    found = []
    for parts in _NORMAL:
        i = np.tile(rows, 2)
        j = np.concatenate([first + part for part in parts])
        values = np.concatenate([sign * normal[0], sign * normal[1]])
        found.append(csr_matrix(coo_matrix((values, (i, j)), shape=(elements.size, size))))
    return found


def _continuity(body: Body) -> Sparse:
    """Return the differences of tractions on both sides of edges, and those of boundaries."""
    mesh = body.mesh
    size = 9 * mesh.nelements
    along = mesh.p[:, mesh.facets[1]] - mesh.p[:, mesh.facets[0]]
    normal = np.stack([along[1], -along[0]]) / np.linalg.norm(along, axis=0)
    total = [csr_matrix((mesh.nfacets, size)) for _ in _NORMAL]
    for local in range(3):
        facets = mesh.t2f[local]
        elements = np.arange(mesh.nelements)
        sign = np.where(mesh.f2t[0, facets] == elements, 1.0, -1.0)
        own = _traction(elements, np.full(elements.size, local), normal[:, facets], sign, size)
        onto = csr_matrix(
            (np.ones(elements.size), (facets, elements)), shape=(mesh.nfacets, elements.size)
        )
        total = [csr_matrix(one + onto @ more) for one, more in zip(total, own, strict=True)]
    return csr_matrix(vstack(total))


def _divergence(gradients: Floats) -> list[Sparse]:
    """Return the rows of the divergence at vertices, vertex by vertex, (x, y), each (3 e, 9 e)."""
    count = gradients.shape[2]
    elements = np.arange(count)
    found = []
    for parts in _NORMAL:
        i, j, values = [], [], []
        for local, (a, b) in enumerate(EDGES):
            for vertex, other in ((a, b), (b, a)):
                for part, gradient in zip(parts, gradients[:, other], strict=True):
                    i.append(vertex * count + elements)
                    j.append(9 * elements + 3 * local + part)
                    values.append(gradient)
        own = coo_matrix(
            (np.concatenate(values), (np.concatenate(i), np.concatenate(j))),
            shape=(3 * count, 9 * count),
        )
        found.append(csr_matrix(own))
    return found


def _less_mean(divergence: list[Sparse]) -> list[Sparse]:
    """Return the divergence at the first two vertices minus its mean."""
    found = []
    for own in divergence:
        count = own.shape[0] // 3
        parts = [own[k * count : (k + 1) * count] for k in range(3)]
        mean = (parts[0] + parts[1] + parts[2]) / 3
        found += [csr_matrix(part - mean) for part in parts[:2]]
    return found


def _least(rows: Sparse, right: Floats) -> Floats:
    """Return the shortest vector with ``rows @ x = right``, to round-off if there is one."""
    length = np.sqrt(np.asarray(rows.multiply(rows).sum(axis=1)).ravel())
    rows = csr_matrix(diags_array(1 / length) @ rows)
    right = right / length
    matrix = csr_matrix(rows @ rows.T + SHIFT * eye_array(rows.shape[0], format="csr"))
    matrix.sort_indices()
    found, left = np.zeros(rows.shape[1]), right
    solver = SuperLU()
    try:
        solver.factorise(matrix)
        for _ in range(BUBBLE_REFINEMENTS):
            moved = found + rows.T @ solver.solve(left)
            more = right - rows @ moved
            if not np.abs(more).max() < np.abs(left).max():
                break
            done = np.abs(more).max() > FINISHED * np.abs(left).max()
            found, left = moved, more
            if done:
                break
    except SingularError:
        pass  # The residual shows the result.
    finally:
        solver.close()
    return np.asarray(found)


def _most(of_edges: Floats) -> Floats:
    """Return the largest value of ``sum F_f lambda_i lambda_j`` in triangles, F >= 0.

    The last axis of F are the edges. The maximum is on an edge, or stationary inside.
    """
    a, b, c = np.moveaxis(of_edges, -1, 0)
    determinant = 2 * (a * b + b * c + c * a) - a**2 - b**2 - c**2
    inside = (a * (b + c - a) > 0) & (b * (a + c - b) > 0) & (c * (a + b - c) > 0)
    stationary = np.where(inside, a * b * c / np.where(inside, determinant, 1.0), 0.0)
    return np.asarray(np.maximum(of_edges.max(axis=-1) / 4, stationary))
