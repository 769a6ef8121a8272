"""The kinematic program as the arrays of the embedding, and the way back.

    minimise   sum c t + h t^2/2 - Fd.u
    subject to s = (t, D u) in cones,  x = G u + g in cones,  E u = e,  F0.u = 1

Rows carry their weights, so that multipliers are stresses. The c of a friction cone is its bound;
dilatant contact points are cones of G, the others half-lines.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix, vstack

from backends._embedding.loops import Loops
from lacore.arrays import Bools, Floats, Sparse
from lacore.numerics.interleaving import interleaved
from lacore.program import FrozenContact, KinematicProgram
from lacore.state import ProgramState


@dataclass(frozen=True)
class Rows:
    """Rows of m points of `dim` components each, point by point.

    Attributes:
        matrix: shape (m dim, n).
        dim: components of a point.
        norms: squared norm of the rows of a point, their mean, shape (m,).
        loops: over points.
    """

    matrix: Sparse
    dim: int
    norms: Floats
    loops: Loops

    @classmethod
    def of(cls, matrix: Sparse, dim: int, weights: Floats, loops: Loops) -> "Rows":
        """Rows times the weights of their points, shape (m,)."""
        data = matrix.data * np.repeat(np.repeat(weights, dim), np.diff(matrix.indptr))
        own = csr_matrix((data, matrix.indices, matrix.indptr), matrix.shape)
        squares = np.asarray(own.multiply(own).sum(axis=1)).reshape(-1, dim).mean(axis=1)
        largest = float(squares.max(initial=0.0)) or 1.0
        return cls(own, dim, np.maximum(squares, 1e-12 * largest), loops)

    @property
    def count(self) -> int:
        """Points m."""
        return int(self.norms.size)

    def at(self, velocity: Floats) -> Floats:
        """Components of all points, shape (dim, m)."""
        return self.loops.rates(self.matrix, self.dim, velocity)

    def force(self, parts: Floats) -> Floats:
        """``matrix^T parts`` of components of shape (dim, m), shape (n,)."""
        return self.loops.forces(self.matrix, parts)

    def both(self, velocity: Floats, parts: Floats, force: Floats, found: Floats) -> None:
        """`at` into `found`, of shape (dim, m), and `force` added to a force."""
        if self.count:
            self.loops.both(self.matrix, velocity, parts, force, found)


@dataclass(frozen=True)
class Costly:
    """Cones ``(t, D u)`` whose t cost ``c t + h t^2/2``.

    Attributes:
        rows: D.
        cost, rise: c and h, shape (m,).
        weights: of the points, shape (m,).
    """

    rows: Rows
    cost: Floats
    rise: Floats
    weights: Floats


@dataclass(frozen=True)
class Free:
    """Cones that ``G u + g`` lies in.

    Attributes:
        rows: G, lead first.
        offset: g, shape (dim, m).
    """

    rows: Rows
    offset: Floats


@dataclass(frozen=True)
class Conic:
    """The whole program.

    Attributes:
        costly, free: cones, each kind of one dimension.
        equal: E.
        given: e, of all rows of E.
        load, dead: F0 and Fd, shape (n,).
    """

    costly: tuple[Costly, ...]
    free: tuple[Free, ...]
    equal: Rows
    given: Floats
    load: Floats
    dead: Floats

    @property
    def kinds(self) -> list[Rows]:
        """All rows: of costly cones, of free ones, and E."""
        cones: Sequence[Costly | Free] = (*self.costly, *self.free)
        return [*(kind.rows for kind in cones), self.equal]

    @property
    def degree(self) -> int:
        """Number of cones."""
        return sum(rows.count for rows in self.kinds[:-1])


@dataclass(frozen=True)
class Multipliers:
    """Of a solution: of cones of both kinds without the leads of the costly, and of E and F0."""

    costly: tuple[Floats, ...]
    free: tuple[Floats, ...]
    equal: Floats
    load: float


class Translation:
    """A program at a frozen contact as arrays, and states of what is found of them."""

    def __init__(self, program: KinematicProgram, contact: FrozenContact, loops: Loops) -> None:
        points, dim = program.contact, program.contact.tangent_dim
        self._program, self._contact = program, contact
        self._rubs = np.isfinite(contact.bound) & (contact.bound > 0)
        self._sticks = np.isinf(contact.bound)
        self._dilates = contact.dilatancy > 0
        self._carries = [(g.bound > 0) | (g.rise > 0) for g in program.groups]
        self._changes = [_filled(group.volumetric) for group in program.groups]

        def slip(mask: Bools) -> Sparse:
            return csr_matrix(points.tangential[np.repeat(mask, dim)])

        costly = [
            Costly(
                Rows.of(_picked(group.rows, group.dim, own), group.dim, group.weights[own], loops),
                group.bound[own],
                group.rise[own] / group.weights[own],
                group.weights[own],
            )
            for group, own in zip(program.groups, self._carries, strict=True)
        ]
        rubs, plain, dilates = self._rubs, ~self._dilates, self._dilates
        weights, none = points.weights, np.zeros(int(rubs.sum()))
        rubbing = Rows.of(slip(rubs), dim, weights[rubs], loops)
        costly.append(Costly(rubbing, contact.bound[rubs], none, weights[rubs]))

        shift = weights * contact.shift
        lifting = Rows.of(csr_matrix(points.normal[plain]), 1, weights[plain], loops)
        steep = np.repeat(contact.dilatancy[dilates], dim)
        sliding = slip(dilates).multiply(steep[:, None])
        leading = interleaved(csr_matrix(points.normal[dilates]), 1, csr_matrix(sliding), dim)
        lead = np.zeros((1 + dim, int(dilates.sum())))
        lead[0] = shift[dilates]
        free = [
            Free(lifting, shift[plain][None]),
            Free(Rows.of(csr_matrix(leading), 1 + dim, weights[dilates], loops), lead),
        ]
        volumes = [
            Rows.of(csr_matrix(group.volumetric[own]), 1, group.volume_weights[own], loops).matrix
            for group, own in zip(program.groups, self._changes, strict=True)
        ]
        sticks = self._sticks
        stuck = Rows.of(slip(sticks), dim, weights[sticks], loops).matrix
        equal = csr_matrix(vstack([*volumes, stuck]))
        self._ends = np.cumsum([part.shape[0] for part in volumes])
        self.conic = Conic(
            tuple(costly),
            tuple(free),
            Rows.of(equal, 1, np.ones(equal.shape[0]), loops),
            np.zeros(equal.shape[0]),
            program.reference_load,
            program.dead_load,
        )

    def alike(self, contact: FrozenContact) -> bool:
        """Whether another frozen contact comes to the same rows."""
        return (
            np.array_equal(self._rubs, np.isfinite(contact.bound) & (contact.bound > 0))
            and np.array_equal(self._sticks, np.isinf(contact.bound))
            and np.array_equal(self._contact.dilatancy, contact.dilatancy)
        )

    def state(self, velocity: Floats, found: Multipliers) -> ProgramState:
        """Velocity and multipliers in the signs of `ProgramState`."""
        program, dim = self._program, self._program.contact.tangent_dim
        *strained, rubbed = found.costly
        lifted, led = found.free
        *volumes, stuck = np.split(found.equal, self._ends)
        stresses, means = [], []
        kinds = zip(program.groups, self._carries, self._changes, strained, volumes, strict=True)
        for group, carries, changes, strain, volume in kinds:
            stress = np.zeros((group.weights.size, group.dim))
            stress[carries] = -strain.T
            mean = np.zeros(group.volumetric.shape[0])
            mean[changes] = -volume
            stresses.append(stress)
            means.append(mean)
        normal = np.zeros(program.contact.count)
        tangential = np.zeros((normal.size, dim))
        normal[~self._dilates], normal[self._dilates] = lifted[0], led[0]
        tangential[self._rubs] = rubbed.T
        tangential[self._sticks] = stuck.reshape(-1, dim)
        tangential[self._dilates] += (self._contact.dilatancy[self._dilates] * led[1:]).T
        return ProgramState(
            velocity=velocity,
            load_factor=found.load,
            stress=tuple(stresses),
            mean_stress=tuple(means),
            normal_reaction=normal,
            tangential_reaction=tangential,
        )


def _picked(rows: Sparse, dim: int, own: Bools) -> Sparse:
    """Rows of some of the points."""
    return rows if own.all() else csr_matrix(rows[np.repeat(own, dim)])


def _filled(rows: Sparse) -> Bools:
    """Which rows have an entry; the others would say ``0 = 0``."""
    return np.asarray(abs(rows).sum(axis=1)).ravel() > 0
