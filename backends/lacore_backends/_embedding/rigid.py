"""Rigid motions of bodies as separate unknowns.

A body that slides without strain has strains from round-off alone, and its stiffness is 1e20 times
that of the contact on which it slides. In the sum of both the latter would be lost. With velocities

    U = Z a + v,   v = 0 where a moves,   D Z = 0

the rows of the body do not contain a, and contact alone resists it.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import qr
from scipy.sparse import csc_matrix, csr_matrix, diags_array, vstack
from scipy.sparse.csgraph import connected_components

from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.numerics.linear_algebra import SingularError, SymmetricSolver
from lacore.program import KinematicProgram

_MOST = 7  # number of motions to search for: one more than a body has in three dimensions
_SHIFT = 1e-10  # shift by the diagonal: negligible compared with the smallest stiffness of a body
_TIMES = 3  # number of solves, each of which reduces other motions by a factor of 1e-6
_STRAINS = 1e-10  # strain rate by row and velocity above which a motion has strain


@dataclass(frozen=True)
class Motions:
    """Motions without strain of all bodies, each identified by an unknown that only it moves.

    Attributes:
        own: these unknowns, shape (k,).
        basis: ``U = basis q``, shape (n, n): unit columns, and Z in those of `own`.
    """

    own: Ints
    basis: Sparse

    def stated(self, program: KinematicProgram) -> KinematicProgram:
        """Return the program in q, whose strain rates do not contain the rigid motions."""
        kept = np.ones(program.n)
        kept[self.own] = 0.0
        straining = csr_matrix(diags_array(kept))

        def cut(rows: Sparse, by: Sparse) -> Sparse:
            product = csr_matrix(rows @ by)
            product.eliminate_zeros()
            product.sort_indices()
            return product

        contact = program.contact
        return replace(
            program,
            groups=tuple(
                replace(
                    group,
                    rows=cut(group.rows, straining),
                    volumetric=cut(group.volumetric, straining),
                )
                for group in program.groups
            ),
            contact=replace(
                contact,
                normal=cut(contact.normal, self.basis),
                tangential=cut(contact.tangential, self.basis),
            ),
            reference_load=np.asarray(self.basis.T @ program.reference_load),
            dead_load=np.asarray(self.basis.T @ program.dead_load),
        )


def motions(program: KinematicProgram, solver: SymmetricSolver) -> Motions | None:
    """Return the motions of bodies in contact; None if no body moves without strain."""
    contact = program.contact
    if not program.groups or not contact.count:
        return None
    rows = _straining(program)
    stiffness = csr_matrix(rows.T @ rows)
    diagonal = stiffness.diagonal()
    moved = np.flatnonzero(diagonal > 0)
    if not moved.size:
        return None
    inner = csr_matrix(stiffness[moved][:, moved])
    count, body = connected_components(inner, directed=False)
    try:
        found = softest(inner, solver, np.zeros((moved.size, 0)))
    except SingularError:
        return None
    columns, own = [], []
    strain = csc_matrix(rows[:, moved])
    touch = csc_matrix(csr_matrix(vstack([contact.normal, contact.tangential]))[:, moved])
    for number in range(count):
        which = np.flatnonzero(body == number)
        modes = without_strain(csr_matrix(strain[:, which]), found[which])
        modes = _resisted(csr_matrix(touch[:, which]), modes)
        if modes.shape[1]:
            _, pivots = qr(modes.T, mode="r", pivoting=True)
            pivots = pivots[: modes.shape[1]]
            columns.append((moved[which], modes @ np.linalg.inv(modes[pivots])))
            own.append(moved[which[pivots]])
    if not columns:
        return None
    return _motions(program.n, np.concatenate(own), columns)


def _straining(program: KinematicProgram) -> Sparse:
    """Return the rows of all strain rates and changes of volume, normalised."""
    rows = csr_matrix(
        vstack([*(g.rows for g in program.groups), *(g.volumetric for g in program.groups)])
    )
    sizes = np.sqrt(np.asarray(rows.multiply(rows).sum(axis=1)).ravel())
    return csr_matrix(diags_array(1 / np.where(sizes > 0, sizes, 1.0)) @ rows)


def softest(stiffness: Sparse, solver: SymmetricSolver, forces: Floats) -> Floats:
    """Return the velocities of least resistance, by inverse iteration, shape (n, `_MOST`).

    Args:
        stiffness: positive semidefinite, n rows; an unknown without stiffness is free.
        solver: factorises it with a shift.
        forces: starts of some of the velocities, shape (n, k).

    Raises:
        SingularError: the matrix cannot be factorised, or the velocities are not finite.
    """
    diagonal = stiffness.diagonal()
    diagonal[diagonal == 0] = 1.0
    shifted = csr_matrix(stiffness + diags_array(_SHIFT * diagonal))
    shifted.sort_indices()
    solver.factorise(shifted)
    found = np.random.default_rng(0).normal(size=(diagonal.size, _MOST))
    pulled = diagonal[:, None] * found
    pulled[:, : forces.shape[1]] = forces
    for _ in range(_TIMES):
        found = solver.solve(pulled)
        fastest = np.abs(found).max(axis=0)
        found = found / np.where(fastest > 0, fastest, 1.0)
        pulled = diagonal[:, None] * found
    if not np.all(np.isfinite(found)):
        raise SingularError("a motion is not a number")
    return found


def without_strain(rows: Sparse, found: Floats) -> Floats:
    """Return an orthonormal basis of the velocities without strain, shape (n, k)."""
    basis, _ = np.linalg.qr(found)
    none = np.zeros((basis.shape[1], basis.shape[1]))  # There must be as many rows as motions.
    _, strains, turn = np.linalg.svd(np.vstack([rows @ basis, none]), full_matrices=False)
    return np.asarray(basis @ turn[strains <= _STRAINS * np.sqrt(rows.shape[0])].T)


def _resisted(rows: Sparse, modes: Floats) -> Floats:
    """Return the motions that contact resists; the others have no stiffness in any unknown."""
    if not modes.shape[1]:
        return modes
    _, sizes, turn = np.linalg.svd(rows @ modes, full_matrices=False)
    return np.asarray(modes @ turn[sizes > _STRAINS * max(float(sizes.max(initial=0.0)), 1.0)].T)


def _motions(n: int, own: Ints, columns: list[tuple[Ints, Floats]]) -> Motions:
    unit = np.ones(n)
    unit[own] = 0.0
    rows, places, values = [np.arange(n)], [np.arange(n)], [unit]
    first = 0
    for unknowns, modes in columns:
        names = own[first : first + modes.shape[1]]
        first += modes.shape[1]
        rows.append(np.repeat(unknowns, names.size))
        places.append(np.tile(names, unknowns.size))
        values.append(modes.ravel())
    entries = np.concatenate(rows), np.concatenate(places)
    basis = csr_matrix((np.concatenate(values), entries), (n, n))
    basis.eliminate_zeros()
    return Motions(own, basis)
