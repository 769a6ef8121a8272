"""The Coulomb problem of rigid blocks in the plane, as one mixed complementarity problem (T2, T8).

Unknown are forces p = w t_n and f = -w t_t of the contact points, speeds s, a, b >= 0 of opening
and of slip to either side, velocities u and the load factor. With g+- = mu p + c -+ f >= 0, the
friction that is left to either side, they obey

    N'p - T'f + Fd + alpha F0 = 0,   F0.u = 1,   N u = s,   T u = a - b,
    s p = 0,   a g+ = 0,   b g- = 0.

It is not monotone: unlike those of the frozen problems its matrix is not symmetric, and interior
points of it may have to turn round (`lacore.coupling.in_plane.central_path`).
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csc_array, csr_array, csr_matrix
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from lacore.arrays import Floats, Ints, Sparse
from lacore.numerics.linear_algebra import SingularError
from lacore.program import KinematicProgram
from lacore.showing import Compact
from lacore.state import ProgramState

_SHIFT = 1e-13  # of the diagonal: round-off of free blocks, which nothing holds
_PIVOT = 0.01  # of the largest entry: less stays on the diagonal no longer
_HALVINGS = 40  # leave a friction within 1e-12 of its bound


@dataclass(frozen=True, repr=False)
class Complementarity(Compact):
    """The problem as functions of one vector z = (p, f, s, a, b, u, alpha).

    Attributes:
        program: one that `poses` says yes to.
    """

    program: KinematicProgram

    def parts(self, z: Floats) -> list[Floats]:
        """p, f, s, a, b, u and alpha, the last of shape (1,)."""
        m = self.program.contact.count
        return np.split(z, [m, 2 * m, 3 * m, 4 * m, 5 * m, 5 * m + self.program.n])

    def left(self, p: Floats, f: Floats) -> tuple[Floats, Floats]:
        """Friction left to either side but for cohesion: g+ and g- where that is zero."""
        mu = self.program.contact.coefficient
        return mu * p - f, mu * p + f

    @cached_property
    def pattern(self) -> "Pattern":
        """Of the matrix on velocities."""
        return Pattern.of(self.program)

    @property
    def cohesion(self) -> Floats:
        """c, as a force."""
        return self.program.contact.weights * self.program.contact.limit

    def linear(self, z: Floats) -> Floats:
        """The linear equations but for their constants."""
        p, f, s, a, b, u, alpha = self.parts(z)
        rows, load = self.program.contact, self.program.reference_load
        return np.concatenate(
            [
                rows.normal.T @ p - rows.tangential.T @ f + alpha * load,
                [load @ u],
                rows.normal @ u - s,
                rows.tangential @ u - a + b,
            ]
        )

    def positive(self, z: Floats) -> Floats:
        """What has to be positive: p, g+, g-, s, a, b."""
        p, f, s, a, b, _, _ = self.parts(z)
        forward, backward = self.left(p, f)
        return np.concatenate([p, forward + self.cohesion, backward + self.cohesion, s, a, b])

    def rates(self, dz: Floats) -> Floats:
        """How `positive` changes."""
        p, f, s, a, b, _, _ = self.parts(dz)
        return np.concatenate([p, *self.left(p, f), s, a, b])

    def products(self, z: Floats) -> Floats:
        """Powers s p, a g+, b g-: the sum is the gap where all linear equations hold."""
        force, speed = np.split(self.positive(z), 2)
        return np.asarray(force * speed)

    def residual(self, z: Floats) -> Floats:
        """All equations, those of `products` last."""
        linear = self.linear(z)
        linear[: self.program.n] += self.program.dead_load
        linear[self.program.n] -= 1.0
        return np.concatenate([linear, self.products(z)])

    def state(self, z: Floats) -> ProgramState:
        """The state of a vector."""
        p, f, _, _, _, u, alpha = self.parts(z)
        weights = self.program.contact.weights
        return ProgramState(u, float(alpha[0]), (), (), p / weights, (-f / weights)[:, None])

    def start(self, state: ProgramState, product: float) -> Floats:
        """The vector closest to a state, in its own units, where all powers are `product`."""
        rows = self.program.contact
        p0, f0 = rows.weights * state.normal_reaction, -rows.weights * state.tangential_reaction
        ratio = float(np.abs(p0).max()) / float(np.abs(state.velocity).max())
        d = p0 - ratio * rows.opening(state.velocity)
        root = np.hypot(d, 2 * np.sqrt(ratio * product))
        p = np.where(d > 0, d + root, 4 * ratio * product / (root - np.minimum(d, 0.0))) / 2
        most = rows.coefficient * p + self.cohesion
        aim = f0[:, 0] + ratio * rows.slip(state.velocity)[:, 0]
        below, above = -most, most.copy()
        for _ in range(_HALVINGS):  # f + ratio (a - b) rises with f
            f = (below + above) / 2
            slip = product / (most - f) - product / (most + f)
            high = f + ratio * slip > aim
            below, above = np.where(high, below, f), np.where(high, f, above)
        f = (below + above) / 2
        speeds = product / p, product / (most - f), product / (most + f)
        return np.concatenate([p, f, *speeds, state.velocity, [state.load_factor]])


@dataclass(frozen=True, repr=False)
class Pattern(Compact):
    """``K = N'D N + T'C N + T'A T`` with diagonals D, C, A that change.

    Attributes:
        sums: entries of K, column by column, from all diagonals, shape (nnz, 3 m).
        rows, columns: of the entries.
        starts: of the columns.
        diagonal: which entries are on it.
    """

    sums: Sparse
    rows: Ints
    columns: Ints
    starts: Ints
    diagonal: Ints

    @classmethod
    def of(cls, program: KinematicProgram) -> "Pattern":
        """Of a program."""
        n, m = program.n, program.contact.count
        normal, tangential = csr_matrix(program.contact.normal), program.contact.tangential
        tangential = csr_matrix(tangential)
        pairs = (normal, normal), (tangential, normal), (tangential, tangential)
        terms = [_outer(*pair) for pair in pairs]
        point, row, column, value = map(np.concatenate, zip(*terms, strict=True))
        every = np.repeat(np.arange(3) * m, [term[0].size for term in terms]) + point
        own = np.arange(n)
        keys, where = np.unique(
            np.concatenate([column * n + row, own * n + own]), return_inverse=True
        )
        sums = csr_matrix((value, (where[: value.size], every)), (keys.size, 3 * m))
        starts = np.searchsorted(keys, np.arange(n + 1) * n)
        return cls(sums, keys % n, keys // n, starts, where[value.size :])

    def scaled(self, values: Floats) -> tuple[csc_array, Floats]:
        """K with ones on its diagonal, and the square roots of what was there, inverted."""
        data = self.sums @ values
        scale = 1 / np.sqrt(np.abs(data[self.diagonal]))
        data = data * scale[self.rows] * scale[self.columns]
        data[self.diagonal] += _SHIFT
        n = scale.size
        return csc_array((data, self.rows, self.starts), shape=(n, n)), scale


def _outer(left: Sparse, right: Sparse) -> tuple[Ints, Ints, Ints, Floats]:
    """Point, row, column and value of the entries of ``left[j].T right[j]`` of all points j."""
    points = np.repeat(np.arange(left.shape[0]), np.diff(left.indptr))
    counts = np.diff(right.indptr)[points]
    one = np.repeat(np.arange(points.size), counts)
    within = np.arange(one.size) - np.repeat(np.cumsum(counts) - counts, counts)
    other = right.indptr[points][one] + within
    values = left.data[one] * right.data[other]
    rows, columns = left.indices[one].astype(np.int64), right.indices[other].astype(np.int64)
    return points[one], rows, columns, values


def poses(program: KinematicProgram) -> bool:
    """Whether a program is one of rigid blocks in the plane alone, with Coulomb friction all over.

    Then the problem is linear but for its products.
    """
    rows = program.contact
    return (
        rows.count > 0
        and rows.tangent_dim == 1
        and program.homogeneous
        and not any(group.weights.size for group in program.groups)
        and bool(np.all(rows.coulomb & np.isfinite(rows.limit) & (rows.dilatancy == 0)))
    )


class Newton:
    """Solutions of the linearised problem at a vector: forces and speeds eliminated by points.

    What is factorised is a matrix on velocities with the pattern of a stiffness.
    """

    def __init__(self, problem: Complementarity, z: Floats) -> None:
        """Raises `SingularError`."""
        rows, self._problem = problem.program.contact, problem
        positive = problem.positive(z)
        if not np.all(positive > 0):
            raise SingularError("a force or a speed has come to zero")
        forces, self._speeds = (np.split(half, 3) for half in np.split(positive, 2))
        self._forces, mu = forces, rows.coefficient
        s, a, b = self._speeds
        p, forward, backward = forces
        self._slack = a / forward + b / backward  # compliance of friction
        self._skew = mu * (b / backward - a / forward)
        stiff = p / s
        values = np.concatenate([stiff, self._skew * stiff / self._slack, 1 / self._slack])
        self._matrix, self._scale = problem.pattern.scaled(values)
        try:
            self._factor = splu(
                self._matrix,
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=_PIVOT,
                options={"SymmetricMode": True},
            )
        except RuntimeError as error:  # SuperLU's word for it
            raise SingularError(str(error)) from error
        self._load = problem.program.reference_load
        self._by_load = self._velocity(self._load)

    def solve(self, right: Floats) -> Floats:
        """Change of the vector for a change of all equations, refined once."""
        first = self._solve(right)
        return first + self._solve(right - self._applied(first))

    def orientation(self) -> float:
        """Sign of the determinant of the linearised problem, up to one that never changes."""
        pivots = np.concatenate([self._factor.U.diagonal(), [self._load @ self._by_load]])
        orders = _parity(self._factor.perm_r) * _parity(self._factor.perm_c)
        return float(orders * np.prod(np.sign(pivots)))

    def _velocity(self, forces: Floats) -> Floats:
        scaled = self._scale * forces
        first = self._factor.solve(scaled)
        first += self._factor.solve(scaled - self._matrix @ first)
        return np.asarray(self._scale * first)

    def _solve(self, right: Floats) -> Floats:
        program = self._problem.program
        rows, load, m, n = program.contact, self._load, program.contact.count, program.n
        balance, own, opening, slip, *powers = np.split(
            right, [n, n + 1, *(n + 1 + m * np.arange(1, 5))]
        )
        s, a, b = self._speeds
        p, forward, backward = self._forces
        normal = (powers[0] + p * opening) / s
        ways = powers[1] / forward - powers[2] / backward
        friction = -(slip + ways + self._skew * normal) / self._slack
        first = self._velocity(rows.normal.T @ normal - rows.tangential.T @ friction - balance)
        alpha = (own[0] - load @ first) / (load @ self._by_load)
        u = first + alpha * self._by_load
        y = rows.normal @ u
        dp = normal - p / s * y
        df = friction + (rows.tangential @ u + self._skew * (p / s) * y) / self._slack
        more, less = self._problem.left(dp, df)
        da, db = (powers[1] - a * more) / forward, (powers[2] - b * less) / backward
        return np.concatenate([dp, df, y - opening, da, db, u, [alpha]])

    def _applied(self, dz: Floats) -> Floats:
        forces, speeds = np.split(self._problem.rates(dz), 2)
        own = np.concatenate(self._speeds) * forces + np.concatenate(self._forces) * speeds
        return np.concatenate([self._problem.linear(dz), own])


def _parity(order: Ints) -> int:
    """Of a permutation: 1 for even ones, -1 for odd ones."""
    ones = csr_array((np.ones(order.size), (np.arange(order.size), order)))
    cycles, _ = connected_components(ones, directed=False)
    return 1 - 2 * int((order.size - cycles) % 2)
