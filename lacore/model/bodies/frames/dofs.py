"""Unknowns of frames: for each node u_x, u_y and w = phi r, with phi its rotation rate.

r is the size of the frame, so that all unknowns are velocities, m/s, and all forces, moments over r
included, are N/m. A piece of length L turns at ``n.(u_end - u_start)/L``; a plastic hinge turns at
that rate minus phi of its node, and dissipates ``M_p |theta|`` (T6). The ends of a piece whose
section has no limit to axial force have no relative velocity along it. Others also yield along it
by additional modes, and have a slide among the unknowns, m/s, after those of all nodes: see
`lacore.model.bodies.frames.modes`.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd
from scipy.sparse import csr_matrix

from lacore.model.bodies.frames.frame import HELD_COMPONENTS, Frame, line_load, nodal
from lacore.model.bodies.frames.modes import WHOLE, Modes, modes_of, rate_rows
from lacore.model.conditions.loads import Fix, Load
from lacore.numerics.arrays import Bools, Floats, Ints, Sparse
from lacore.numerics.null_space import null_space
from lacore.program.kinematic import DissipationGroup
from lacore.reporting.showing import Compact


@dataclass(frozen=True, repr=False)
class FrameDofs(Compact):
    """Place of the velocity of a frame among all unknowns.

    Attributes:
        body: the frame.
        offset: number of its first unknown; node a has offset + 3 a, ... + 2.
    """

    body: Frame
    offset: int
    degree = 0  # It touches other bodies in single nodes.
    bent = axisymmetric = False

    @property
    def nodal(self) -> int:
        """Number of unknowns of nodes, which come first."""
        return 3 * len(self.body.names)

    @property
    def count(self) -> int:
        """Number of unknowns."""
        return self.nodal + self.modes.unknowns

    @cached_property
    def modes(self) -> Modes:
        """Ways in which it yields."""
        return modes_of(self.body)

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
        """One piece for all unknowns, as members carry each other: shape (count,)."""
        return np.zeros(self.count, dtype=np.int64)

    def parts(self, nodes: Ints) -> Ints:
        """Return the nodes."""
        return nodes

    def moving(self, nodes: Ints) -> Ints:
        """Return the nodes, each of which moves separately."""
        return nodes

    def velocity_rows(self, nodes: Ints, points: Floats, n: int) -> tuple[Sparse, Sparse]:
        """Return the rows of u_x and u_y of nodes, each of shape (k, n)."""
        rows = np.arange(nodes.size)
        x, y = (
            csr_matrix(
                (np.ones(nodes.size), (rows, self.offset + 3 * nodes + axis)), (nodes.size, n)
            )
            for axis in (0, 1)
        )
        return x, y

    def thickness(self, places: Floats) -> Floats:
        """Return a thickness of one metre."""
        return np.ones_like(places[0])

    def groups(self, name: str, n: int) -> tuple[DissipationGroup, ...]:
        """Return the group of the modes with weights size^2; none if nothing yields.

        ``weight * stress`` is a moment.
        """
        modes = self.modes
        if not modes.piece.size:
            return ()
        weights = np.full(modes.piece.size, self.body.size**2)
        return (
            DissipationGroup(
                name=name,
                rows=rate_rows(self.body, modes, self.offset, n),
                dim=1,
                weights=weights,
                bound=modes.strength / weights,
                volumetric=csr_matrix((modes.piece.size, n)),
                volumetric_factor=0.0,
            ),
        )

    def motion(self, velocity: Floats) -> Floats:
        """Return u_x, u_y of the nodes, m/s, and rotation rates, rad/s, shape (3, nodes)."""
        own = velocity[self.offset : self.offset + self.nodal].reshape(-1, 3).T.copy()
        own[2] /= self.body.size
        return own

    def unknowns(self, motion: Floats) -> Floats:
        """Return the inverse of `motion`, shape (nodal,)."""
        own = motion.copy()
        own[2] *= self.body.size
        return np.asarray(own.T.ravel())

    def end_forces(self, stress: Floats) -> tuple[Floats, Floats]:
        """Return tension (N/m) and moment (N) at both ends of all pieces, (P, 2).

        Args:
            stress: stresses of the modes, (K,).

        Moments are those of members on nodes, anticlockwise. NaN: tension if axial force has no
        limit, and moments of rigid members, which equilibrium alone does not determine.
        """
        axial, moment = self.modes.forces(self.body.size**2 * stress)
        piece, side = self.modes.ends
        shape = self.body.pieces.stiff.shape
        rigid = np.isinf(self.body.pieces.plastic_moment)[:, None]
        tension, bending = np.full(shape, np.nan), np.where(rigid, np.full(shape, np.nan), 0.0)
        free = np.isin(piece, self.modes.slides)
        whole = side == WHOLE
        tension[piece[free], side[free]] = axial[free]
        tension[piece[whole]] = axial[whole, None]
        bending[piece[~whole], side[~whole]] = moment[~whole]
        return tension, bending

    def stress_of(self, stress: Floats, moment: Floats) -> Floats:
        """Return stresses (K,) with other moments (E,) in `hinges`, changed least."""
        weight = self.body.size**2
        axial, _ = self.modes.forces(weight * stress)
        return self.modes.with_forces(weight * stress, axial, moment) / weight

    def hinges(self, velocity: Floats, stress: Floats, rest: float) -> pd.DataFrame:
        """Return a table of possible hinges, one row per end of a piece, then one per bar.

        For a section with different strengths in both senses, the plastic moment is that of the
        rotation, or else that of the sense of M.

        Args:
            velocity: velocity of all unknowns.
            stress: stresses of the modes, (K,).
            rest: m/s: slower motions count as none.
        """
        body, pieces, (piece, side) = self.body, self.body.pieces, self.modes.ends
        axial, moment = self.modes.forces(body.size**2 * stress)
        bar = side == WHOLE
        node = pieces.nodes[piece, np.maximum(side, 0)]
        place = body.position[:, node]
        place[:, bar] += (pieces.along * pieces.length)[:, piece[bar]] / 2
        turning, stretching = self._rates(velocity)
        turns, stretches = np.abs(turning) * body.size > rest, np.abs(stretching) > rest
        sags = np.where(turns, turning, moment) * np.where(side == 0, 1.0, -1.0) >= 0
        names = np.array([*body.names, ""], dtype=object)
        sections = [body.section_of[member] for member in pieces.member[piece]]
        table = pd.DataFrame(
            {
                "member": np.array(body.member_names, dtype=object)[pieces.member[piece]],
                "node": names[np.where(bar, len(body.names), node)],
                "x": place[0],
                "y": place[1],
                "moment": moment,
                "plastic_moment": np.where(
                    sags, [own.sagging for own in sections], [own.hogging for own in sections]
                ),
                "rotation_rate": turning,
            }
        )
        yields = bar | np.isin(piece, self.modes.slides)
        if yields.any():
            table["axial_force"] = np.where(yields, axial, np.nan)
            table["squash_load"] = np.array([own.squash_load for own in sections])
            table["elongation_rate"] = stretching
        table["state"] = np.where(turns, "turns", np.where(stretches, "stretches", "rests"))
        return table

    def _rates(self, velocity: Floats) -> tuple[Floats, Floats]:
        """Return the rates of rotation, rad/s, and of elongation, m/s, at the `Modes.ends`.

        The shape is (E,).
        """
        pieces, (piece, side) = self.body.pieces, self.modes.ends
        motion, bar = self.motion(velocity), side == WHOLE
        jump = motion[:2, pieces.end[piece]] - motion[:2, pieces.start[piece]]
        x, y = pieces.along[:, piece]
        turning = (x * jump[1] - y * jump[0]) / pieces.length[piece]
        turning -= motion[2, pieces.nodes[piece, np.maximum(side, 0)]]
        stiff = pieces.stiff[piece, np.maximum(side, 0)] & ~bar
        slide = np.zeros(pieces.length.size)
        first = self.offset + self.nodal
        slide[self.modes.slides] = velocity[first : first + self.modes.slides.size]
        stretch = x * jump[0] + y * jump[1]
        shared = stretch / 2 + np.where(side == 0, 1.0, -1.0) * slide[piece]
        shared *= np.isin(piece, self.modes.slides)
        return np.where(stiff, turning, 0.0), np.where(bar, stretch, shared)

    def force(self, load: Load) -> Floats:
        """Return the forces of a load on the unknowns, shape (count,), N/m."""
        pieces, own = self.body.pieces, self.modes.slides
        along = np.sum(line_load(load, self.body) * pieces.along, axis=0) * pieces.length
        none = np.zeros(self.modes.beyond.shape[1])
        return np.concatenate([nodal(load, self.body).ravel(), along[own], none])

    @property
    def held(self) -> Floats:
        """Forces of the centres of strengths on the unknowns, (count,), N/m.

        A strength that differs in both senses is a symmetric strength plus these forces, which are
        in equilibrium.
        """
        rows = rate_rows(self.body, self.modes, 0, self.count)
        return np.asarray(-(rows.T @ self.modes.centre))

    def line_loads(self, loads: Iterable[Load]) -> Floats:
        """Return the loads of this frame along members on all pieces, N/m per m, (2, P)."""
        every = [line_load(load, self.body) for load in loads]
        return np.asarray(np.sum([np.zeros(self.body.pieces.along.shape), *every], axis=0))

    def load_across(self, loads: Iterable[Load]) -> Floats:
        """Return the component of loads across all pieces, to the left of each, N/m per m, (P,)."""
        along = self.body.pieces.along
        return np.asarray(np.sum(np.stack([-along[1], along[0]]) * self.line_loads(loads), axis=0))

    def free(self, supports: Iterable[Fix]) -> Sparse:
        """Return a basis of the velocities that members and supports allow, shape (count, free).

        A node without a member end that carries moment has no rotation.
        """
        pieces, held = self.body.pieces, self._held(supports)
        turns = np.zeros(held.shape[0], dtype=bool)
        turns[pieces.nodes[pieces.stiff]] = True
        held[:, 2] |= ~turns
        moves = np.append(np.flatnonzero(~held.ravel()), np.arange(self.nodal, self.count))
        basis = np.zeros((self.count, moves.size))
        basis[moves, np.arange(moves.size)] = 1.0
        return csr_matrix(basis @ null_space(self._kept()[:, moves]))

    def support_forces(self, force: Floats, supports: Iterable[Fix]) -> tuple[Floats, Floats]:
        """Return the places (2, k) of held nodes, and forces and moments of supports there (3, k).

        Args:
            force: forces of supports and members on the unknowns, shape (count,), N/m.
            supports: supports of this frame. If they are redundant along members, the least forces.
        """
        held = self._held(supports)
        exerted = np.zeros(self.count)
        own = np.flatnonzero(held.ravel())
        columns = np.concatenate([np.eye(self.count)[:, own], self._kept().T], axis=1)
        exerted[own] = np.linalg.lstsq(columns, force)[0][: own.size]
        nodes = held.any(axis=1)
        result = exerted[: self.nodal].reshape(-1, 3)[nodes].T
        result[2] *= self.body.size
        return self.body.position[:, nodes], result

    def _held(self, supports: Iterable[Fix]) -> Bools:
        """Return which of u_x, u_y and w of each node supports hold, (N, 3)."""
        held = np.zeros((len(self.body.names), 3), dtype=bool)
        for support in supports:
            nodes = self.body.find(support.where, "Fix.where")
            held[nodes] |= np.array(HELD_COMPONENTS[support.components])
        return held

    def _kept(self) -> Floats:
        """Return the rows of rates that are 0, m/s, (k, count).

        These are the elongation of pieces without axial limit, and the rotation of rigid ends
        against their nodes, times their length.
        """
        pieces, sections = self.body.pieces, self.body.section_of
        stretch = np.array([not sections[member].extends for member in pieces.member])
        own = np.flatnonzero(stretch)
        rows = np.zeros((own.size, len(self.body.names), 3))
        rows[np.arange(own.size), pieces.end[own], :2] = pieces.along[:, own].T
        rows[np.arange(own.size), pieces.start[own], :2] = -pieces.along[:, own].T
        rigid = np.array([sections[member].rigid for member in pieces.member])
        piece, side = np.nonzero(pieces.stiff & rigid[:, None])
        turns = np.zeros((piece.size, len(self.body.names), 3))
        each = np.arange(piece.size)
        across = np.stack([-pieces.along[1, piece], pieces.along[0, piece]], axis=1)
        turns[each, pieces.end[piece], :2] = across
        turns[each, pieces.start[piece], :2] = -across
        turns[each, pieces.nodes[piece, side], 2] = -pieces.length[piece] / self.body.size
        nodal = np.concatenate([rows, turns]).reshape(-1, self.nodal)
        return np.pad(nodal, [(0, 0), (0, self.count - self.nodal)])
