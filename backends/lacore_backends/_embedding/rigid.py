"""Motions of bodies as they are, as unknowns of their own.

A body that slides as one strains by round-off, and its stiffness against straining is 1e20 times
that of what it slides on: in the sum of both the latter is lost. With velocities

    U = Z a + v,   v = 0 where a moves,   D Z = 0

its rows do not know a, and contact alone resists it.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import qr
from scipy.sparse import csc_matrix, csr_matrix, diags_array, vstack
from scipy.sparse.csgraph import connected_components

from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.numerics.linear_algebra import SingularError, SymmetricSolver
from lacore.program.kinematic import KinematicProgram

_MOST = 7  # motions that are looked for: of a body one more than there are in space
_SHIFT = 1e-10  # of the diagonal: next to the least stiffness of a body, nothing
_TIMES = 3  # solves, each of which leaves a millionth of what is no motion as one
_STRAINS = 1e-10  # of a row and a velocity: more is a strain


@dataclass(frozen=True)
class Motions:
    """Motions without strain of all bodies, each named by an unknown that it alone moves.

    Attributes:
        own: these unknowns, shape (k,).
        basis: ``U = basis q``, shape (n, n): unit columns, and Z in those of `own`.
    """

    own: Ints
    basis: Sparse

    def stated(self, program: KinematicProgram) -> KinematicProgram:
        """The program in q; strain rates do not know what moves bodies as they are."""
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
    """The motions of bodies that touch something; None where no body moves as it is."""
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
    """Rows of all strain rates and changes of volume, each of length one."""
    rows = csr_matrix(
        vstack([*(g.rows for g in program.groups), *(g.volumetric for g in program.groups)])
    )
    sizes = np.sqrt(np.asarray(rows.multiply(rows).sum(axis=1)).ravel())
    return csr_matrix(diags_array(1 / np.where(sizes > 0, sizes, 1.0)) @ rows)


def softest(stiffness: Sparse, solver: SymmetricSolver, forces: Floats) -> Floats:
    """Velocities that resist least, by inverse iteration, shape (n, `_MOST`).

    Args:
        stiffness: semidefinite, n rows; without any for an unknown it is free.
        solver: takes it with a shift.
        forces: what some of the velocities are looked for from, shape (n, k).

    Raises:
        SingularError: it cannot be factorised, or they are no numbers.
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
        raise SingularError("a motion is no number")
    return found


def without_strain(rows: Sparse, found: Floats) -> Floats:
    """Of velocities of a body those that strain nothing, orthonormal, shape (n, k)."""
    basis, _ = np.linalg.qr(found)
    none = np.zeros((basis.shape[1], basis.shape[1]))  # so that there are as many rows as motions
    _, strains, turn = np.linalg.svd(np.vstack([rows @ basis, none]), full_matrices=False)
    return np.asarray(basis @ turn[strains <= _STRAINS * np.sqrt(rows.shape[0])].T)


def _resisted(rows: Sparse, modes: Floats) -> Floats:
    """Those that contact feels at all; of the others no unknown has a stiffness."""
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
