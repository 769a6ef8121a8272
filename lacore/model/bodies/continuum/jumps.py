"""Velocity jumps of a body as dissipation (T23).

They are between its elements, and along boundaries where it slips past a support
(`lacore.assembly.slips`).

A jump over an edge of length L is a layer of thickness L with the strain rate ``sym(n (x) [u])/L``:
the criterion gives its dissipation, for the volume L^2. Its cones are at the Bernstein control
values of the jump along the edge, L/(degree + 1) each: the ends for a linear jump, for a quadratic
one also ``2 [u]_mid - ([u]_start + [u]_end)/2``. The jump is a convex combination of them, so that
their sum is never below the dissipation, and ``[u_n] = 0`` holds along the whole edge. The
thickness cancels from all powers; only the regularised law depends on it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.sparse import csr_matrix, vstack
from skfem import Mesh

from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.regions.layers import (
    Beside,
    Carried,
    Ends,
    Layer,
    costs,
    shares_of_controls,
    within_both,
)
from lacore.model.bodies.continuum.slip import Slip
from lacore.model.materials.conic_form import ConicForm
from lacore.numerics.arrays import Bools, Floats, Ints, Sparse
from lacore.program.kinematic import DissipationGroup
from lacore.reporting.showing import Compact

CONTROL = {
    1: np.eye(2),
    2: np.array([[1.0, 0.0, 0.0], [-0.5, 2.0, -0.5], [0.0, 0.0, 1.0]]),
}
"""Bernstein control values from the values at the nodes of an edge, by degree."""
_FACE = np.eye(6)
_FACE[3:, :3] = [[-0.5, -0.5, 0.0], [0.0, -0.5, -0.5], [-0.5, 0.0, -0.5]]
_FACE[3:, 3:] *= 2.0
FACE_CONTROL = {1: np.eye(3), 2: _FACE}
"""The same of faces, their vertices first, then the midpoints of their edges (T90)."""
_ROUND_OFF = 1e-12  # by the entries of a row


@dataclass(frozen=True, repr=False)
class Jumps(Compact):
    """Velocity jumps of a region of a body, whose dissipation follows from its criterion.

    Attributes:
        bodies: bodies of the elements on either side; equal except across seams.
        group: their dissipation; cone by cone along each edge.
        elements: elements on both sides of each cone, shape (2, m); equal at a boundary.
        place: number of each cone among the control values of all edges, `copies` per edge, shape
            (m,); the others are zero.
        copies: number of control values of an edge.
        ends: bounds at both ends of the edge of each cone, between which they are linear, Pa,
            shape (2, m).
    """

    bodies: tuple[str, str]
    group: DissipationGroup
    elements: Ints
    place: Ints
    copies: int
    ends: Floats

    def kept(self, mask: Bools) -> "Jumps":
        """Return the jumps of a mask of shape (m,)."""
        group = replace(
            self.group,
            rows=self.group.rows[np.repeat(mask, self.group.dim)],
            weights=self.group.weights[mask],
            bound=self.group.bound[mask],
            volumetric=self.group.volumetric[mask],
            surfaces=None if self.group.surfaces is None else self.group.surfaces.at(mask),
        )
        return replace(
            self,
            group=group,
            elements=self.elements[:, mask],
            place=self.place[mask],
            ends=self.ends[:, mask],
        )

    def held_force(self, stress: Floats, mean: Floats) -> Floats:
        """Return the nodal forces on supports, shape (n,), of stresses (m, dim) and (m,)."""
        outer = self.elements[0] == self.elements[1]
        weights = np.where(outer, self.group.weights, 0.0)
        along = self.group.rows.T @ (weights[:, None] * stress).ravel()
        return np.asarray(along + self.group.volumetric.T @ (weights * mean))

    def power(self, velocity: Floats, parts: int) -> tuple[Ints, Floats]:
        """Return the elements on both sides of edges, shape (2, e), and an upper power there, (e,).

        It uses the control values of `parts` equal parts of each edge; `parts` = 1 gives the
        group's.
        """
        _, first, edge = np.unique(
            self.place // self.copies, return_index=True, return_inverse=True
        )
        # A single plane is linear, so its cones contain all of it.
        if self.group.surfaces is not None:
            power = np.bincount(edge, self.group.dissipation(velocity), minlength=first.size)
            return self.elements[:, first], np.asarray(power)
        control = np.zeros((first.size, self.copies, self.group.dim))
        control[edge, self.place % self.copies] = self.group.cone_vectors(velocity)
        total = np.zeros(first.size)
        low, high = self.ends[:, first]
        most = np.maximum(low, high)
        for start, end in pairwise(np.linspace(0, 1, parts + 1)):
            values = _control_values_of_part(control, start, end)
            shares = shares_of_controls(self.copies) @ np.array([1 - start, 1 - end])
            for value, share in zip(values, shares, strict=True):
                # This is exactly 1 if the strength is the same at both ends.
                level = 1 - ((most - low) * share + (most - high) * (1 - share)) / most
                total += np.linalg.norm(value, axis=1) * level
        return self.elements[:, first], (self.group.weights[first] * most) * total / parts


def jumps(name: str, dofs: BodyDofs, n: int, slip: Slip | None) -> list[Jumps]:
    """Return all jumps of a body for n unknowns: between elements, and past supports.

    Between two regions, or elements of different strength, the dissipation is that of the weaker
    side: tractions are within the criteria of both, so the dissipation of either is at least the
    power of any admissible ones. With two friction angles it is the largest power of tractions
    within both (T87).
    """
    mesh = dofs.body.mesh
    inner = np.flatnonzero((mesh.f2t[1] >= 0) & dofs.space.jumps)
    outer = np.zeros(0, dtype=np.int64) if slip is None else slip.facets
    facets, copies = np.concatenate([inner, outer]), dofs.degree + 1
    own = control_values(dofs, facets, 0, n)
    beyond = control_values(dofs, inner, 1, n)
    if slip is not None:
        held = slip.held_rows(copies, n)
        beyond = [csr_matrix(vstack(part)) for part in zip(beyond, held, strict=True)]
    x, y = (csr_matrix(b - a) for a, b in zip(own, beyond, strict=True))
    elements = mesh.f2t[:, facets].astype(np.int64)
    elements[1, inner.size :] = elements[0, inner.size :]
    within = np.repeat(np.arange(facets.size) < inner.size, copies)
    edges = np.repeat(facets, copies)
    along = mesh.p[:, mesh.facets[1, edges]] - mesh.p[:, mesh.facets[0, edges]]
    length = np.linalg.norm(along, axis=0)

    def across(direction: Floats) -> Sparse:
        share = direction / length**2
        return csr_matrix(x.multiply(share[0, :, None]) + y.multiply(share[1, :, None]))

    # Whether a boundary is held or not, it has no normal jump.
    normal = np.stack([along[1], -along[0]]) * within
    opening, slipping = across(normal * _outward(mesh, edges, normal)), across(along)
    start, end = mesh.p[:, mesh.facets[:, facets]].transpose(1, 0, 2)
    return layered(name, dofs, elements, (start, end), (opening, slipping), length**2 / copies)


def layered(
    name: str,
    dofs: BodyDofs,
    elements: Ints,
    ends: Ends,
    jump: Sequence[Sparse],
    volumes: Floats,
    kind: type[Jumps] = Jumps,
) -> list[Jumps]:
    """Return the jumps at e facets with m/e control values each, by the layers of both sides.

    Args:
        name: name of the body.
        dofs: unknowns of the body.
        elements: elements on both sides of the facets, shape (2, e).
        ends: ends of edges; any two corners of faces, as strengths do not vary along them.
        jump: rows of ``[u_n]``, and ``[u_t]`` along each tangent, per thickness of the layer, facet
            by facet, (m, n) each.
        volumes: volumes of the layer, shape (m,).
        kind: class of the jumps.
    """
    mesh, regions = dofs.body.mesh, dofs.body.regions
    beside = [
        number
        for number, region in enumerate(regions)
        if dofs.space.jumps or np.isin(elements[0], region.elements).any()
    ]
    layers = {number: Layer.of(regions[number]) for number in beside}
    cost = [costs(layers, mesh, ends, side) for side in elements]
    side = np.argmin([mean for mean, _ in cost], axis=0)
    every = np.arange(elements.shape[1])
    copies = len(_control(dofs))
    weak, strong = (
        Beside(
            mesh, layers, elements[at, every], np.asarray(np.where(at == 0, cost[0][1], cost[1][1]))
        )
        for at in (side, 1 - side)
    )
    found = []
    for number, ours in layers.items():
        mine = np.flatnonzero(weak.owner == number)
        parts = within_both(weak, strong, number, mine, ends, copies)
        for opposite, part, carried in parts:
            cones = (copies * part[:, None] + np.arange(copies)).ravel()
            title = f"{ours.region.group_name(name)}: jumps"
            if opposite is not None:
                title = f"{title} next to {layers[opposite].region.name or 'other angles'}"
            own = [csr_matrix(rows[cones]) for rows in jump]
            group = layer(title, ours.form, own, volumes[cones], carried)
            both = np.repeat(elements[:, part], copies, axis=1)
            bounds = np.repeat(carried.ends, copies, axis=1)
            found.append(kind((name, name), group, both, np.arange(cones.size), copies, bounds))
    return found


def layer(
    name: str,
    form: ConicForm,
    jump: Sequence[Sparse],
    weights: Floats,
    carried: Carried,
) -> DissipationGroup:
    """Return the dissipation of velocity jumps, as strain rates of a layer.

    Args:
        name: name of the group.
        form: form of the layer, see `ConicForm.across`.
        jump: rows of ``[u_n]`` (opening), and ``[u_t]`` along each tangent, per thickness of the
            layer, (m, n) each.
        weights: volumes of the layer, shape (m,).
        carried: strengths of the layer.
    """
    dim, count = form.rows.shape[0], weights.size
    order = np.arange(dim * count).reshape(dim, count).T.ravel()

    def combined(factors: Floats) -> Sparse:
        parts = [factor * rows for factor, rows in zip(factors, jump, strict=True)]
        return csr_matrix(sum(parts[1:], start=parts[0]))

    rows = csr_matrix(vstack([combined(own) for own in form.rows], format="csr")[order])
    volumetric = combined(form.volumes[0])
    for matrix in (rows, volumetric):
        matrix.eliminate_zeros()
    return DissipationGroup(
        name=name,
        rows=rows,
        dim=dim,
        weights=weights,
        bound=carried.bound,
        volumetric=volumetric,
        volumetric_factor=form.volumetric_factor,
        surfaces=carried.surfaces,
    )


def _outward(mesh: Mesh, facets: Ints, normal: Floats) -> Floats:
    """Return the signs that turn normals of facets away from their first element, shape (k,)."""
    first = mesh.p[:, mesh.t[:, mesh.f2t[0, facets]]].mean(axis=1)
    away = mesh.p[:, mesh.facets[0, facets]] - first
    return np.asarray(np.where(np.sum(normal * away, axis=0) < 0, -1.0, 1.0))


def movable(group: DissipationGroup, basis: Sparse) -> Bools:
    """Return which cones have free unknowns under supports and footings, shape (m,).

    The others would state ``0 = 0``, with an arbitrary multiplier.

    Args:
        group: group over all unknowns.
        basis: basis of the free velocities, see `lacore.model.conditions.elimination.free_basis`.
    """
    left = np.zeros(group.weights.size)
    for rows, dim in ((group.rows, group.dim), (group.volumetric, group.volumes)):
        entries = np.asarray(abs(csr_matrix(rows @ basis)).sum(axis=1))
        left += entries.reshape(left.size, dim).sum(axis=1)
    return np.asarray(left > _ROUND_OFF * left.max(initial=0.0))


def _control_values_of_part(control: Floats, start: float, end: float) -> list[Floats]:
    """Return the control values of the part of each edge between two shares, by blossoms."""

    def between(values: Floats, share: float) -> Floats:
        return np.asarray(values[:, :-1] * (1 - share) + values[:, 1:] * share)

    if control.shape[1] == 2:
        return [between(control, share)[:, 0] for share in (start, end)]
    pairs = ((start, start), (start, end), (end, end))
    return [between(between(control, a), b)[:, 0] for a, b in pairs]


def _control(dofs: BodyDofs) -> Floats:
    """Return the control values of a facet from the values at its nodes."""
    return (FACE_CONTROL if dofs.body.dimension == 3 else CONTROL)[dofs.degree]


def control_values(dofs: BodyDofs, facets: Ints, side: int, n: int) -> list[Sparse]:
    """Return the rows of u_x, u_y (and u_z) at the control values of facets, facet by facet."""
    nodes = dofs.facet_nodes(facets, side)
    control = _control(dofs)
    shape = (facets.size, *control.shape)
    values = np.broadcast_to(control, shape).ravel()
    start = np.arange(facets.size * shape[1] + 1) * shape[2]
    return [
        csr_matrix(
            (values, np.broadcast_to(own[nodes].T[:, None], shape).ravel(), start),
            (start.size - 1, n),
        )
        for own in dofs.dofs
    ]
