"""Bending moments along the pieces of frames: parabolas under loads along members.

With the moments `a`, `b` at the ends of a piece of length L and a load q across it,
``m(s) = a (1 - s/L) + b s/L + q s (L - s)/2``: at most one peak inside, where ``m' = 0``, at
``s = L/2 + (b - a)/(q L)``.
"""

from dataclasses import dataclass

import numpy as np

from lacore.assembly.discretisation import Discretisation
from lacore.model.bodies.frames.frame import Frame
from lacore.model.bodies.frames.section import Section
from lacore.numerics.arrays import Floats
from lacore.program.state import ProgramState


@dataclass(frozen=True)
class SpanMoments:
    """Moments of the pieces of a frame, positive with tension on the left, seen along the piece.

    Attributes:
        ends: at the start and the end, N, (P, 2).
        axial: tension there, N/m, (P, 2); NaN where it has no limit.
        load: across the piece, to the left, N/m per m, (P,).
        length: m, (P,).
    """

    ends: Floats
    axial: Floats
    load: Floats
    length: Floats

    def at(self, share: Floats) -> Floats:
        """Moments at shares of the length, shape (P, k) or (k,): N, (P, k)."""
        start, end = self.ends[:, :1], self.ends[:, 1:]
        bow = (self.load * self.length**2)[:, None] * share * (1 - share) / 2
        return np.asarray(start * (1 - share) + end * share + bow)

    @property
    def peaks(self) -> Floats:
        """Where moments peak inside, as shares of the length; NaN where they do not, (P,)."""
        bow, rise = self.load * self.length**2, self.ends[:, 1] - self.ends[:, 0]
        curved = np.abs(rise) < np.abs(bow) / 2
        share = np.full(bow.size, np.nan)
        share[curved] = 0.5 + rise[curved] / bow[curved]
        return share

    @property
    def inside(self) -> Floats:
        """Magnitudes at the peaks, 0 where there is none, N, (P,)."""
        return np.nan_to_num(np.abs(self.at(self.peaks[:, None])[:, 0]), nan=0.0)

    def use(self, frame: Frame) -> tuple[Floats, Floats]:
        """Return the largest use of sections inside pieces, and its place per length: (P,) each.

        The use is 1 if a section yields, and 0 at NaN without a peak inside. With interaction of N
        and M, its peak is not that of the moment if N varies along the piece.
        """
        place = self.peaks
        used, sagging = np.zeros(place.size), -self.at(place[:, None])
        for piece, member in enumerate(frame.pieces.member.tolist()):
            section = frame.section_of[member]
            if not section.bends:
                continue
            if not section.extends:
                used[piece] = np.nan_to_num(section.use(sagging[piece], sagging[piece])[0], nan=0.0)
            elif self.load[piece] != 0:
                used[piece], place[piece] = self._interacting(piece, section)
        return used, place

    def _interacting(self, piece: int, section: Section) -> tuple[float, float]:
        """Of a piece whose N and M interact: each side of its polygon peaks at one place."""
        (start, end), (a, b) = self.ends[piece], self.axial[piece]
        bow = self.load[piece] * self.length[piece] ** 2
        normal = section.sides[0]
        normal = normal[normal[:, 1] != 0]
        lean = -normal[:, 0] / normal[:, 1]  # polygons count sagging moments as positive
        share = 0.5 + (end - start + lean * (b - a)) / bow
        share = share[(share > 0) & (share < 1)]
        if not share.size:
            return 0.0, np.nan
        moment = start * (1 - share) + end * share + bow * share * (1 - share) / 2
        used = section.use(a * (1 - share) + b * share, -moment)
        most = int(np.argmax(used))
        return float(used[most]), float(share[most])


def span_moments(discretisation: Discretisation, point: ProgramState, name: str) -> SpanMoments:
    """Of a frame, from a state in SI units."""
    dofs, problem = discretisation.frames[name], discretisation.problem
    pieces = dofs.body.pieces
    ends, axial = np.zeros(pieces.stiff.shape), np.full(pieces.stiff.shape, np.nan)
    for group, stress in zip(discretisation.full.groups, point.stress, strict=True):
        if group.name == name and group.weights.size:
            axial, ends = dofs.end_forces(stress[:, 0])
    # On the node, anticlockwise; tension is on the left where the start is turned anticlockwise by
    # its node, or the end clockwise.
    ends = ends * np.array([-1.0, 1.0])
    loads = (problem.reference_loads, problem.dead_loads)
    live, dead = (dofs.load_across([load for load in own if load.body == name]) for own in loads)
    return SpanMoments(ends, axial, point.load_factor * live + dead, pieces.length)


def span_excess(discretisation: Discretisation, point: ProgramState) -> float:
    """How far members are beyond yield between their nodes, relative; at least 0."""
    ratios = [np.zeros(0)]
    for name, dofs in discretisation.frames.items():
        ratios.append(span_moments(discretisation, point, name).use(dofs.body)[0])
    return float(np.concatenate(ratios).max(initial=1.0)) - 1
