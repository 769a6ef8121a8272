"""A program in fewer unknowns, or in fewer contact points."""

from dataclasses import replace

import numpy as np
from scipy.sparse import csc_matrix, csr_matrix

from lacore.numerics.arrays import Bools, Ints, Sparse
from lacore.program.kinematic import ContactRows, KinematicProgram


def kept_points(contact: ContactRows, kept: Bools | Ints) -> ContactRows:
    """The contact points of a mask of shape (m,), or of numbers, in their order."""
    points = np.arange(contact.count)[kept]
    rows = (contact.tangent_dim * points[:, None] + np.arange(contact.tangent_dim)).ravel()
    return replace(
        contact,
        normal=contact.normal[kept],
        tangential=contact.tangential[rows],
        **{
            name: getattr(contact, name)[kept]
            for name in ("weights", "coefficient", "limit", "dilatancy", "interface")
        },
        tension=None if contact.tension is None else contact.tension[kept],
        closing=None if contact.closing is None else contact.closing[kept],
    )


def reduced(program: KinematicProgram, basis: Sparse) -> KinematicProgram:
    """The program for the unknowns q of ``U = basis q``, basis of shape (n, n_free)."""

    def cut(rows: Sparse) -> Sparse:
        product = csr_matrix(rows @ basis)
        product.eliminate_zeros()
        product.sort_indices()
        return product

    contact, parts = program.contact, program.parts
    if parts is not None:  # the columns of a basis do not mix parts
        columns = csc_matrix(basis)
        parts = parts[columns.indices[columns.indptr[:-1]]]
    return replace(
        program,
        groups=tuple(
            replace(group, rows=cut(group.rows), volumetric=cut(group.volumetric))
            for group in program.groups
        ),
        contact=replace(contact, normal=cut(contact.normal), tangential=cut(contact.tangential)),
        reference_load=np.asarray(basis.T @ program.reference_load),
        dead_load=np.asarray(basis.T @ program.dead_load),
        parts=parts,
    )


def held_shut(program: KinematicProgram) -> KinematicProgram:
    """The program with the dead load by which strength in tension holds contact shut (T66).

    Once, when all of its points are there.
    """
    if program.contact.tension is None:
        return program
    return replace(program, dead_load=program.dead_load + program.held_shut)
