"""Unknowns of frames: for each node u_x, u_y and w = phi r, with phi its rotation rate.

r is the size of the frame, so that all unknowns are velocities, m/s, and all forces, moments over r
included, are N/m. The ends of a rigid piece of length L have no velocity along it against each
other, and it turns at ``n.(u_end - u_start)/L``; a plastic hinge turns at that rate less phi of
its node, and dissipates ``M_p |theta|`` (T6).
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pandas as pd
import scipy.linalg
from scipy.sparse import csr_matrix

from lacore.arrays import Bools, Floats, Ints, Sparse
from lacore.bodies.frames.frame import Frame
from lacore.bodies.frames.held import COMPONENTS
from lacore.bodies.frames.loaded import line_load, nodal
from lacore.conditions.loads import Fix, Load
from lacore.program import DissipationGroup
from lacore.showing import Compact

_DEPENDENT = 1e-9  # a sine: far above round-off, far below any angle that is meant
_ROUND_OFF = 1e-13  # of an entry of order one


@dataclass(frozen=True, repr=False)
class FrameDofs(Compact):
    """Where the velocity of a frame stands in the vector of all unknowns.

    Attributes:
        body: the frame.
        offset: number of its first unknown; node a has offset + 3 a, ... + 2.
    """

    body: Frame
    offset: int
    degree = 0  # it touches other bodies in single nodes
    bent = axisymmetric = False

    @property
    def count(self) -> int:
        """Number of unknowns."""
        return 3 * len(self.body.names)

    @property
    def strength(self) -> float:
        """Shear stress that it can carry, Pa: of a member without width, any."""
        return np.inf

    @property
    def extent(self) -> float:
        """Square of the size, m^2."""
        return self.body.size**2

    @property
    def pieces_of_unknowns(self) -> Ints:
        """One piece, whose members carry each other: shape (count,)."""
        return np.zeros(self.count, dtype=np.int64)

    def parts(self, nodes: Ints) -> Ints:
        """The nodes themselves."""
        return nodes

    def moving(self, nodes: Ints) -> Ints:
        """What moves continuously: each node for itself."""
        return nodes

    def velocity_rows(self, nodes: Ints, points: Floats, n: int) -> tuple[Sparse, Sparse]:
        """Rows of u_x and u_y of nodes, each of shape (k, n)."""
        rows = np.arange(nodes.size)
        x, y = (
            csr_matrix(
                (np.ones(nodes.size), (rows, self.offset + 3 * nodes + axis)), (nodes.size, n)
            )
            for axis in (0, 1)
        )
        return x, y

    def thickness(self, places: Floats) -> Floats:
        """One metre."""
        return np.ones_like(places[0])

    def groups(self, name: str, n: int) -> tuple[DissipationGroup, ...]:
        """The hinges, weights size^2: ``weight * stress`` is a moment. None where all is pinned."""
        body, pieces = self.body, self.body.pieces
        piece, side = self._ends
        if not piece.size:
            return ()
        normal = np.stack([-pieces.along[1], pieces.along[0]]) / pieces.length
        start, end = self.offset + 3 * pieces.start[piece], self.offset + 3 * pieces.end[piece]
        turning = self.offset + 3 * pieces.nodes[piece, side] + 2
        columns = np.stack([start, start + 1, end, end + 1, turning], axis=1)
        x, y = normal[:, piece]
        values = np.stack([-x, -y, x, y, np.full(piece.size, -1 / body.size)], axis=1)
        first = 5 * np.arange(piece.size + 1)
        rows = csr_matrix((values.ravel(), columns.ravel(), first), shape=(piece.size, n))
        rows.eliminate_zeros()
        weights = np.full(piece.size, body.size**2)
        return (
            DissipationGroup(
                name=name,
                rows=rows,
                dim=1,
                weights=weights,
                bound=pieces.plastic_moment[piece] / weights,
                volumetric=csr_matrix((piece.size, n)),
                volumetric_factor=0.0,
            ),
        )

    @property
    def _ends(self) -> tuple[Ints, Ints]:
        """Pieces, and which of their ends, that carry moment: the potential hinges, in order."""
        piece, side = np.nonzero(self.body.pieces.stiff)
        return piece, side

    def motion(self, velocity: Floats) -> Floats:
        """u_x, u_y of the nodes, m/s, and rotation rates, rad/s, shape (3, nodes)."""
        own = velocity[self.offset : self.offset + self.count].reshape(-1, 3).T.copy()
        own[2] /= self.body.size
        return own

    def unknowns(self, motion: Floats) -> Floats:
        """The inverse of `motion`, shape (count,)."""
        own = motion.copy()
        own[2] *= self.body.size
        return np.asarray(own.T.ravel())

    def hinges(self, rotation: Floats, stress: Floats) -> pd.DataFrame:
        """Table of the potential hinges from cone vectors and stresses of their group, (H,)."""
        body, pieces = self.body, self.body.pieces
        piece, side = self._ends
        node = pieces.nodes[piece, side]
        return pd.DataFrame(
            {
                "member": np.array(body.member_names, dtype=object)[pieces.member[piece]],
                "node": np.array(body.names, dtype=object)[node],
                "x": body.position[0, node],
                "y": body.position[1, node],
                "moment": stress * body.size**2,
                "plastic_moment": pieces.plastic_moment[piece],
                "rotation_rate": rotation,
            }
        )

    def force(self, load: Load) -> Floats:
        """Forces of a load on the unknowns, shape (count,), N/m."""
        return nodal(load, self.body).ravel()

    def line_loads(self, loads: Iterable[Load]) -> Floats:
        """Loads of this frame along members on all pieces together, N/m per m, (2, P)."""
        every = [line_load(load, self.body) for load in loads]
        return np.asarray(np.sum([np.zeros(self.body.pieces.along.shape), *every], axis=0))

    def load_across(self, loads: Iterable[Load]) -> Floats:
        """Their share across all pieces, to the left of each, N/m per m, (P,)."""
        along = self.body.pieces.along
        return np.asarray(np.sum(np.stack([-along[1], along[0]]) * self.line_loads(loads), axis=0))

    def free(self, supports: Iterable[Fix]) -> Sparse:
        """Basis of the velocities that members and supports leave free, shape (count, free).

        A node where no member end carries moment has no rotation.
        """
        pieces, held = self.body.pieces, self._held(supports)
        turns = np.zeros(held.shape[0], dtype=bool)
        turns[pieces.nodes[pieces.stiff]] = True
        held[:, 2] |= ~turns
        moves = np.flatnonzero(~held.ravel())
        basis = np.zeros((self.count, moves.size))
        basis[moves, np.arange(moves.size)] = 1.0
        return csr_matrix(basis @ _null_space(self._stretch()[:, moves]))

    def support_forces(self, force: Floats, supports: Iterable[Fix]) -> tuple[Floats, Floats]:
        """Places (2, k) of the held nodes, and what supports exert there: forces, moments (3, k).

        Args:
            force: what supports and members exert on the unknowns, shape (count,), N/m.
            supports: of this frame. Where they are redundant along members, the least forces.
        """
        held = self._held(supports)
        exerted = np.zeros(self.count)
        own = np.flatnonzero(held.ravel())
        columns = np.concatenate([np.eye(self.count)[:, own], self._stretch().T], axis=1)
        exerted[own] = np.linalg.lstsq(columns, force)[0][: own.size]
        nodes = held.any(axis=1)
        result = exerted.reshape(-1, 3)[nodes].T
        result[2] *= self.body.size
        return self.body.position[:, nodes], result

    def _held(self, supports: Iterable[Fix]) -> Bools:
        """Which of u_x, u_y and w of each node supports hold, (N, 3)."""
        held = np.zeros((len(self.body.names), 3), dtype=bool)
        for support in supports:
            nodes = self.body.find(support.where, "Fix.where")
            held[nodes] |= np.array(COMPONENTS[support.components])
        return held

    def _stretch(self) -> Floats:
        """Rows of the rate at which each piece would get longer, (P, count)."""
        pieces = self.body.pieces
        own = np.arange(pieces.start.size)
        rows = np.zeros((own.size, len(self.body.names), 3))
        rows[own, pieces.end, :2] = pieces.along.T
        rows[own, pieces.start, :2] = -pieces.along.T
        return rows.reshape(own.size, -1)


def _null_space(conditions: Floats) -> Floats:
    """Basis of the x with ``conditions x = 0``, (n, free): some of the x, and what follows them.

    Unlike an orthonormal basis it keeps the zeros: a beam that moves sideways is one unknown.
    """
    n = conditions.shape[1]
    if not n:
        return np.zeros((0, 0))
    triangle, pivots = scipy.linalg.qr(conditions, mode="r", pivoting=True)
    size = np.abs(np.diagonal(triangle))
    rank = int(np.sum(size > _DEPENDENT))
    following = -scipy.linalg.solve_triangular(triangle[:rank, :rank], triangle[:rank, rank:])
    following[np.abs(following) < _ROUND_OFF] = 0.0
    basis = np.zeros((n, n - rank))
    basis[pivots[:rank]] = following
    basis[pivots[rank:], np.arange(n - rank)] = 1.0
    return basis
