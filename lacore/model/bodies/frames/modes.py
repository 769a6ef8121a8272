"""Yield modes of members: each has a rate, and a strength against it.

At an end of a piece the section of the member turns by theta and, where it yields to axial force,
stretches by D. It has the modes of `lacore.model.bodies.frames.ways`, ``|a D + t theta + ...|``
with a strength in N m. Both ends share the elongation of a piece: ``D = stretch/2 +- slide``, with
the slide a separate unknown, so that N may differ between the ends under loads along the member. A
bar stretches as a whole. Moments are positive where they sag
(`lacore.model.bodies.frames.section`), as the start of a piece does that turns anticlockwise, and
its end clockwise.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_diag, csr_matrix

from lacore.model.bodies.frames.frame import Frame
from lacore.model.bodies.frames.ways import ways_of
from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.reporting.showing import Compact

WHOLE = -1  # side of a mode of the whole piece


@dataclass(frozen=True, eq=False, repr=False)
class Modes(Compact):
    """Modes of a frame, by piece, and end by end.

    Attributes:
        piece, side: piece and side of each mode, (K,); side 0 at the start, 1 at the end, -1 for
            the whole piece.
        end: number of the end (or whole piece) it belongs to, (K,): modes of one end are
            consecutive.
        stretch: a, 1/m; per m/s of elongation, (K,).
        turn: t, (K,).
        strength: N m per unit thickness, (K,).
        slides: pieces with an unknown slide, (S,).
        beyond: contribution of unknowns of single ends to rates, after the slides, (K, X).
        centre: force of each mode in the middle of its strength, N m, (K,).
    """

    piece: Ints
    side: Ints
    end: Ints
    stretch: Floats
    turn: Floats
    strength: Floats
    slides: Ints
    beyond: Sparse
    centre: Floats

    @property
    def unknowns(self) -> int:
        """Number of unknowns in addition to those of nodes."""
        return int(self.slides.size + self.beyond.shape[1])

    @property
    def ends(self) -> tuple[Ints, Ints]:
        """Pieces and sides where they yield, (E,) each."""
        first = np.unique(self.end, return_index=True)[1]
        return self.piece[first], self.side[first]

    def forces(self, stress: Floats) -> tuple[Floats, Floats]:
        """Return tension N/m and moment N of each end, (E,), from forces of modes, N m, (K,)."""
        count, carried = int(self.end.max(initial=-1)) + 1, self.centre + stress
        axial, moment = (
            np.bincount(self.end, own * carried, count).astype(np.float64)
            for own in (self.stretch, self.turn)
        )
        return axial, moment

    def with_forces(self, stress: Floats, axial: Floats, moment: Floats) -> Floats:
        """Return the forces of modes, changed least, for other forces of the ends, (K,)."""
        before = np.stack(self.forces(stress))
        change = np.nan_to_num(np.stack([axial, moment]) - before)
        new = stress.copy()
        for end in np.flatnonzero(change.any(axis=0)):
            own = self.end == end
            new[own] += np.linalg.pinv([self.stretch[own], self.turn[own]]) @ change[:, end]
        return new


def modes_of(frame: Frame) -> Modes:
    """Return all modes of a frame: stiff ends in the order of the pieces, then bars."""
    pieces, size = frame.pieces, frame.size
    found: list[tuple[int, int, int, float, float, float, float]] = []
    beyond: list[Floats] = []
    slides, bars, end = [], [], 0
    for piece, member in enumerate(pieces.member.tolist()):
        section = frame.section_of[member]
        if section.rigid:
            continue
        if not section.bends:
            bars += [piece] if section.extends else []
            continue
        slides += [piece] if section.extends else []
        for side, stiff in enumerate(pieces.stiff[piece].tolist()):
            if not (stiff or section.extends):
                continue
            own, sense = ways_of(section, stiff), 1.0 if side == 0 else -1.0
            columns = (own.stretch, sense * own.turn, own.strength, own.centre)
            for a, turn, strength, centre in zip(*columns, strict=True):
                found.append((piece, side, end, a, turn, strength, centre))
            beyond.append(own.beyond / size)
            end += 1
    for piece in bars:
        section = frame.section_of[pieces.member[piece]]
        strength, centre = section.squash_load * size, section.middle * size
        found.append((piece, WHOLE, end, 1 / size, 0.0, strength, centre))
        beyond.append(np.zeros((1, 0)))
        end += 1
    numbers = np.array(found, dtype=np.float64).reshape(-1, 7).T
    piece, side, end_of = numbers[:3].astype(np.int64)
    stretch, turn, strengths, centres = numbers[3:]
    every = np.array(slides, dtype=np.int64)
    # For lists of arrays only, scipy will make a different kind of matrix from 1.20 on, and warns.
    more = csr_matrix(block_diag([csr_matrix((0, 0)), *beyond]))
    return Modes(piece, side, end_of, stretch, turn, strengths, every, more, centres)


def rate_rows(frame: Frame, modes: Modes, offset: int, n: int) -> Sparse:
    """Return the rows of the rates of all modes over n unknowns, (K, n).

    Slides follow the nodes, and unknowns of single ends follow the slides.
    """
    pieces, piece = frame.pieces, modes.piece
    whole = modes.side == WHOLE
    share = modes.stretch * np.where(whole, 1.0, 0.5)
    across = modes.turn / pieces.length[piece]
    x, y = pieces.along[:, piece]
    to_end = np.stack([share * x - across * y, share * y + across * x])
    start, stop = (offset + 3 * own[piece] for own in (pieces.start, pieces.end))
    node = pieces.nodes[piece, np.maximum(modes.side, 0)]
    slide = np.searchsorted(modes.slides, piece)
    slides = np.isin(piece, modes.slides) & ~whole
    last = np.where(slides, offset + 3 * len(frame.names) + slide, start)
    columns = np.stack([start, start + 1, stop, stop + 1, offset + 3 * node + 2, last], axis=1)
    sense = np.where(modes.side == 0, 1.0, -1.0) * slides
    values = [*-to_end, *to_end, -modes.turn / frame.size, modes.stretch * sense]
    rows = np.repeat(np.arange(piece.size), 6)
    matrix = csr_matrix(
        (np.stack(values, axis=1).ravel(), (rows, columns.ravel())), (piece.size, n)
    )
    first = offset + 3 * len(frame.names) + modes.slides.size
    place = np.arange(first, first + modes.beyond.shape[1])
    beyond = modes.beyond.tocoo()
    more = csr_matrix((beyond.data, (beyond.row, place[beyond.col])), matrix.shape)
    total = csr_matrix(matrix + more)
    total.eliminate_zeros()
    return total
