"""What straining a body dissipates, as rows of the program (T6)."""

from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_matrix

from lacore.arrays import Floats, Sparse
from lacore.bodies.continuum.volume import means_projector
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
    volumetric = csr_matrix(means_projector(dofs) @ rows(form.volumes))
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
