"""Kinematic program as the arrays of the embedding, and conversion of its results.

    minimise   sum c t + h t^2/2 - Fd.u
    subject to s = (t, D u) in cones,  x = G u + g in cones,  E u = 0,  F0.u = 1

Rows are multiplied by their weights, so that multipliers are stresses. The c of a friction cone is
its bound. Dilatant contact points are cones of G, the others half-lines. Points with several
surfaces have cones of their own (`lacore_backends._embedding.pressure_dependent`).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.numerics.arrays import Bools, Floats, Ints, Sparse
from lacore.numerics.interleaving import interleaved
from lacore.program import DissipationGroup, FrozenContact, KinematicProgram
from lacore.program.state import ProgramState
from lacore_backends._embedding.loops.best import Loops
from lacore_backends._embedding.pressure_dependent import Apex, Planes, alone
from lacore_backends._embedding.rows import Rows


@dataclass(frozen=True)
class Costly:
    """Cones ``(t, D u)`` whose t has the cost ``c t + h t^2/2``.

    Attributes:
        rows: D.
        cost, rise: c and h, shape (m,).
        weights: weights of the points, shape (m,).
    """

    rows: Rows
    cost: Floats
    rise: Floats
    weights: Floats


@dataclass(frozen=True)
class Free:
    """Cones that contain ``G u + g``.

    Attributes:
        rows: G, the row of the lead first.
        offset: g, shape (dim, m).
        dissipates: whether the leads dissipate power.
    """

    rows: Rows
    offset: Floats
    dissipates: bool = False


@dataclass(frozen=True)
class Conic:
    """Whole conic program.

    Attributes:
        costly, free: cones, those of one dimension together.
        planes: points with several surfaces, one entry per group.
        equal: E.
        load, dead: F0 and Fd, the latter without the linear cost of u, shape (n,).
        weight: sum of the absolute nodal forces of Fd without that cost.
        typical: a typical strength.
        loose: unknowns that only the loads act on (`lacore_backends._embedding.loose`).
    """

    costly: tuple[Costly, ...]
    free: tuple[Free, ...]
    planes: tuple[Planes, ...]
    equal: Rows
    load: Floats
    dead: Floats
    weight: float
    typical: float
    loose: Ints

    @property
    def kinds(self) -> list[Rows]:
        """All rows: of costly cones, of free ones, of planes, and E."""
        costly, free = [one.rows for one in self.costly], [one.rows for one in self.free]
        return [*costly, *free, *(one.rows for one in self.planes), self.equal]

    @property
    def degree(self) -> int:
        """Number of cones."""
        cones = sum(one.rows.count for one in self.costly) + sum(
            one.rows.count for one in self.free
        )
        return cones + sum(one.strength.size for one in self.planes)


@dataclass(frozen=True)
class Multipliers:
    """Multipliers of a solution, without the leads of costly cones, and of E and F0."""

    costly: tuple[Floats, ...]
    free: tuple[Floats, ...]
    planes: tuple[Floats, ...]
    equal: Floats
    load: float


class Translation:
    """Program at a frozen contact as arrays, and conversion of results to states."""

    def __init__(self, program: KinematicProgram, contact: FrozenContact, loops: Loops) -> None:
        self._program, self._contact, self._loops = program, contact, loops
        self._rubs = np.isfinite(contact.bound) & (contact.bound > 0)
        # Without an opening the cone would have no interior, so such points do not slip if they
        # dilate.
        self._shut = shut = ~_filled(program.contact.normal)
        self._held = shut & (contact.dilatancy > 0) & (contact.shift == 0)
        self._sticks = np.isinf(contact.bound) | self._held
        self._dilates = (contact.dilatancy > 0) & ~self._held
        self._plain = (contact.dilatancy == 0) & ~(shut & (contact.shift >= 0))
        plain = [group for group in program.groups if group.surfaces is None]
        soils = [group for group in program.groups if group.surfaces is not None]
        self._carries = [
            (g.rise > 0) | ((g.bound > 0) & (g.surfaces is None)) for g in program.groups
        ]
        self._changes = [_filled(group.volumetric) for group in plain]
        self._pointed = [alone(group) for group in soils]
        sorted_ = list(zip(soils, self._pointed, strict=True))
        pointed = [group for group, own in sorted_ if own]
        self._apexes = [Apex(group) for group in pointed]
        self._planes = [Planes.of(group, loops) for group, own in sorted_ if not own]
        costly = [*self._strained(), self._rubbing()]
        free = [self._lifting(), self._leading(), *map(self._pressing, pointed, self._apexes)]
        equal = self._equal(plain)
        every = [one.rows for one in costly] + [kind.rows for kind in free]
        self._empty = [rows.count == 0 for rows in every]
        self._shapes = [(rows.dim, 0) for rows in every]
        self._count = len(costly)
        self.conic = self._filled(costly, free, equal)

    def _filled(self, costly: Sequence[Costly], free: Sequence[Free], equal: Sparse) -> Conic:
        """Return the program without empty kinds: each costs as many calls as a full one."""
        program = self._program
        return Conic(
            tuple(one for one in costly if one.rows.count),
            tuple(kind for kind in free if kind.rows.count),
            tuple(self._planes),
            Rows.of(equal, 1, np.ones(equal.shape[0]), self._loops),
            program.reference_load,
            sum((-one.cost for one in self._apexes), program.dead_load.copy()),
            float(np.abs(program.dead_load).sum()),
            _typical([one.cost for one in costly]),
            np.zeros(0, dtype=np.int64),
        )

    def _rows(self, matrix: Sparse, dim: int, weights: Floats) -> Rows:
        return Rows.of(_rowwise(matrix), dim, weights, self._loops)

    def _slip(self, mask: Bools) -> Sparse:
        points = self._program.contact
        return _picked(points.tangential, points.tangent_dim, mask)

    def _strained(self) -> Iterator[Costly]:
        """Yield the strain rates of each group that carry something."""
        for group, own in zip(self._program.groups, self._carries, strict=True):
            rows = self._rows(_picked(group.rows, group.dim, own), group.dim, group.weights[own])
            bound = group.bound[own] if group.surfaces is None else np.zeros(int(own.sum()))
            yield Costly(rows, bound, group.rise[own] / group.weights[own], group.weights[own])

    def _rubbing(self) -> Costly:
        """Return the slip against friction."""
        rubs, dim = self._rubs, self._program.contact.tangent_dim
        weights, none = self._program.contact.weights[rubs], np.zeros(int(rubs.sum()))
        rows = self._rows(self._slip(rubs), dim, weights)
        return Costly(rows, self._contact.bound[rubs], none, weights)

    def _lifting(self) -> Free:
        """Return the opening of points that do not dilate."""
        points, steady = self._program.contact, self._plain
        weights = points.weights[steady]
        rows = self._rows(_picked(points.normal, 1, steady), 1, weights)
        return Free(rows, (points.weights * self._contact.shift)[steady][None])

    def _leading(self) -> Free:
        """Return the opening of points that dilate, which leads their slip."""
        points, dilates = self._program.contact, self._dilates
        dim, weights = points.tangent_dim, points.weights[dilates]
        leading = csr_matrix((0, self._program.n))
        if dilates.any():
            steep = np.repeat(self._contact.dilatancy[dilates], dim)
            sliding = csr_matrix(self._slip(dilates).multiply(steep[:, None]))
            leading = interleaved(_picked(points.normal, 1, dilates), 1, sliding, dim)
        shift = (points.weights * self._contact.shift)[dilates]
        return Free(self._rows(leading, 1 + dim, weights), _led(shift, dim))

    def _pressing(self, group: DissipationGroup, apex: Apex) -> Free:
        """Return the volumes of a group with a single cone, which lead its strain rates."""
        both = interleaved(apex.lead, 1, group.rows, group.dim)
        offset = _led(group.weights * apex.offset, group.dim)
        return Free(self._rows(both, 1 + group.dim, group.weights), offset, True)

    def _equal(self, plain: Sequence[DissipationGroup]) -> Sparse:
        """Return E: volumes of groups without surfaces that change, and slip that sticks."""
        volumes = [
            self._rows(_picked(group.volumetric, 1, own), 1, group.volume_weights[own]).matrix
            for group, own in zip(plain, self._changes, strict=True)
        ]
        self._ends = np.cumsum([part.shape[0] for part in volumes])
        points, sticks = self._program.contact, self._sticks
        stuck = self._rows(self._slip(sticks), points.tangent_dim, points.weights[sticks]).matrix
        return csr_matrix(vstack([*volumes, stuck]))

    def alike(self, contact: FrozenContact) -> bool:
        """Return whether another frozen contact has the same rows."""
        return (
            np.array_equal(self._rubs, np.isfinite(contact.bound) & (contact.bound > 0))
            and np.array_equal(np.isinf(self._contact.bound), np.isinf(contact.bound))
            and np.array_equal(self._contact.dilatancy, contact.dilatancy)
            and np.array_equal(
                np.sign(self._contact.shift[self._shut]), np.sign(contact.shift[self._shut])
            )
        )

    def state(self, velocity: Floats, found: Multipliers) -> ProgramState:
        """Return velocity and multipliers with the signs of `ProgramState`."""
        program, dim = self._program, self._program.contact.tangent_dim
        own = iter((*found.costly, *found.free))
        every = [
            np.zeros(shape) if empty else next(own)
            for empty, shape in zip(self._empty, self._shapes, strict=True)
        ]
        *strained, rubbed = every[: self._count]
        lifted, led, *pressing = every[self._count :]
        *volumes, stuck = np.split(found.equal, self._ends)
        changing = iter(zip(self._changes, volumes, strict=True))
        apexes = iter(zip(self._apexes, pressing, strict=True))
        planes = iter(zip(self._planes, found.planes, strict=True))
        pointed = iter(self._pointed)
        stresses, means = [], []
        for group, carries, strain in zip(program.groups, self._carries, strained, strict=True):
            stress = np.zeros((group.weights.size, group.dim))
            stress[carries] = -strain.T
            if group.surfaces is None:
                changes, volume = next(changing)
                mean = np.zeros(group.volumetric.shape[0])
                mean[changes] = -volume
            elif next(pointed):
                apex, cone = next(apexes)
                stress -= cone[1:].T
                mean = apex.mean(cone[0])
            else:
                several, bounded = next(planes)
                stress -= bounded[: group.dim].T
                mean = several.mean(bounded)
            stresses.append(stress)
            means.append(mean)
        normal = np.zeros(program.contact.count)
        tangential = np.zeros((normal.size, dim))
        normal[self._plain], normal[self._dilates] = lifted[0], led[0]
        tangential[self._sticks] = stuck.reshape(-1, dim)
        sliding, held = self._contact.dilatancy, self._held
        normal[held] = np.linalg.norm(tangential[held], axis=1) / sliding[held]
        tangential[self._rubs] += rubbed.T
        tangential[self._dilates] += (self._contact.dilatancy[self._dilates] * led[1:]).T
        return ProgramState(
            velocity=velocity,
            load_factor=found.load,
            stress=tuple(stresses),
            mean_stress=tuple(means),
            normal_reaction=normal,
            tangential_reaction=tangential,
        )


def _led(lead: Floats, dim: int) -> Floats:
    """Return the offsets of cones with an offset of the lead alone, shape (1 + dim, m)."""
    offset = np.zeros((1 + dim, lead.size))
    offset[0] = lead
    return offset


def _typical(strengths: Sequence[Floats]) -> float:
    every = np.concatenate([np.zeros(0), *strengths])
    return float(np.median(every)) if every.size and np.median(every) > 0 else 1.0


def _picked(rows: Sparse, dim: int, own: Bools) -> Sparse:
    """Return the rows of some of the points, or the same matrix if all are selected.

    Selecting no rows of many takes as long as selecting all rows of few.
    """
    if not own.any():
        return csr_matrix((0, rows.shape[1]))
    return _rowwise(rows if own.all() else rows[np.repeat(own, dim)])


def _rowwise(rows: Sparse) -> Sparse:
    """Return the rows as `csr_matrix`, without a copy if they are one."""
    return rows if isinstance(rows, csr_matrix) else csr_matrix(rows)


def _filled(rows: Sparse) -> Bools:
    """Return which rows have an entry; the others would state ``0 = 0``."""
    return np.asarray(abs(rows).sum(axis=1)).ravel() > 0
