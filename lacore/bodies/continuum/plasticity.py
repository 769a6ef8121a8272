"""What straining a body dissipates, as rows of the program (T6)."""

from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_matrix, diags_array, eye_array, kron

from lacore.arrays import Bools, Floats, Sparse
from lacore.bodies.continuum.volume import volume_projector
from lacore.program import DissipationGroup

if TYPE_CHECKING:
    from lacore.bodies.continuum.dofs import BodyDofs


def plasticity(name: str, dofs: "BodyDofs", n: int) -> DissipationGroup:
    """Dissipation at the strain points of a body, over n unknowns (T6)."""
    form = dofs.body.form
    basis = dofs.basis
    gradient = np.stack([np.asarray(shape[0].grad) for shape in basis.basis], axis=-1)
    rates = [gradient[0, 0], gradient[1, 1], gradient[0, 1] + gradient[1, 0]]
    if dofs.body.axisymmetric:  # strain points lie off the axis
        radial = np.stack([np.asarray(shape[0])[0] for shape in basis.basis], axis=-1)
        radius = np.asarray(basis.global_coordinates())[0]
        rates.insert(2, radial / radius[:, :, None])
    strain = np.stack(rates, axis=2)
    # strain: (elements, points, components, shapes)
    columns = basis.element_dofs.T.astype(np.int64) + dofs.offset

    def rows(coefficients: Floats) -> Sparse:
        values = np.einsum("rs,epsi->epri", coefficients, strain)
        count = int(np.prod(values.shape[:3]))
        indices = np.broadcast_to(columns[:, None, None, :], values.shape)
        start = np.arange(count + 1) * values.shape[3]
        return csr_matrix((values.ravel(), indices.ravel(), start), shape=(count, n))

    weights = dofs.weights.ravel()
    volumetric = _projected(rows(form.volumes), dofs, form.preserved)
    elements = np.repeat(np.arange(dofs.body.mesh.nelements), dofs.weights.shape[1])
    return DissipationGroup(
        name=name,
        rows=rows(form.rows),
        dim=form.rows.shape[0],
        weights=weights,
        bound=form.bounds(elements),
        volumetric=volumetric,
        volumetric_factor=form.volumetric_factor,
        surfaces=form.surfaces_of(elements),
    )


def _projected(rows: Sparse, dofs: "BodyDofs", preserved: Bools) -> Sparse:
    """Volumetric rows, those that must vanish as few as elements can bear, L a point."""
    if dofs.space.pressures is not None:
        preserved = np.ones_like(preserved)
    if not preserved.any():
        return rows
    projector, count = volume_projector(dofs), preserved.size
    if count == 1:
        return csr_matrix(projector @ rows)
    one = diags_array(preserved.astype(np.float64))
    own = kron(projector, one) + kron(eye_array(projector.shape[0]), eye_array(count) - one)
    return csr_matrix(csr_matrix(own) @ rows)
