"""Bernstein control values of the velocity jump on segments of interfaces, and their places (T28).

On a segment of an isoparametric edge the jump is quadratic in the parameter of the edge, and so are
its control values; each has the normal of the curve there.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lacore.model.bodies.any_body import Dofs, plane
from lacore.model.contact.segments import Segments
from lacore.model.meshes.curved import EdgeCurves
from lacore.numerics.arrays import Floats, Ints

_POINT = 1.0  # m, the weight of a node
# Gauss rule on (0, 1), exact up to degree 5: control function, length and radius of an edge.
_PLACES, _WEIGHTS = (np.polynomial.legendre.leggauss(3)[0] + 1) / 2, np.array([5, 8, 5]) / 18


@dataclass(frozen=True)
class Controls:
    """One control value of each of k segments.

    Attributes:
        place, normal: shape (2, k).
        weight: integral of its Bernstein function over the segment, times the thickness, (k,).
    """

    place: Floats
    normal: Floats
    weight: Floats


@dataclass(frozen=True)
class SegmentCurves:
    """Segments as parts of curves, from parameters `first` to `last`, shape (k,) each."""

    curves: EdgeCurves
    first: Floats
    last: Floats

    def parameter(self, share: float) -> Floats:
        """Return the parameter of the curves at a share of the segments, shape (k,)."""
        return self.first + share * (self.last - self.first)

    def at(self, share: float) -> Floats:
        """Return the places at a share of the segments, shape (2, k)."""
        return self.curves.at(self.parameter(share))


def segment_curves(segments: Segments, sides: Sequence[tuple[Dofs, Ints]]) -> SegmentCurves:
    """Return segments as parts of the edges of the first isoparametric side, else straight."""
    start, end = segments.start, segments.end
    for dofs, parts in sides:
        if dofs.bent:
            curves = plane(dofs.body).curves(parts)
            return SegmentCurves(curves, curves.parameter(start), curves.parameter(end))
    straight = EdgeCurves(start, (start + end) / 2, end)
    return SegmentCurves(straight, np.zeros(start.shape[1]), np.ones(start.shape[1]))


def controls(segments: Segments, sides: Sequence[tuple[Dofs, Ints]]) -> list[Controls]:
    """Return the controls at start and end, for quadratic jumps also in the middle.

    A node of a frame has one control.

    Args:
        segments: k segments.
        sides: unknowns and parts of slave and master; an obstacle is not included.
    """
    degrees = [dofs.degree for dofs, _ in sides]
    if min(degrees) == 0:
        return [Controls(segments.start, segments.normal, np.full(segments.slave.size, _POINT))]
    along, quadratic = segment_curves(segments, sides), max(degrees) > 1
    straight, plane = not np.any(along.curves.bulge), not any(d.axisymmetric for d, _ in sides)
    if straight and plane:  # without the round-off of a quadrature
        length = np.linalg.norm(segments.end - segments.start, axis=0)
        weights = np.tile(length / (2 + quadratic), (2 + quadratic, 1))
    else:
        assert quadratic  # as spaces of curved edges and of axisymmetric bodies are
        weights = _integrals(along, sides)
    return [
        Controls(
            along.at(s),
            segments.normal
            if straight
            else along.curves.normal(along.parameter(s), segments.normal),
            weight,
        )
        for s, weight in zip((0.0, 1.0, 0.5), weights, strict=False)
    ]


def _integrals(along: SegmentCurves, sides: Sequence[tuple[Dofs, Ints]]) -> Floats:
    """Return the integrals of the quadratic Bernstein functions over segments, shape (3, k).

    They are those of start, end and middle.
    """
    weights = np.zeros((3, along.first.size))
    for s, share in zip(_PLACES, _WEIGHTS, strict=True):
        functions = [(1 - s) ** 2, s**2, 2 * s * (1 - s)]
        tangent = along.curves.tangent(along.parameter(s)) * (along.last - along.first)
        # Both sides have the same thickness, as axisymmetric bodies touch no others.
        length = np.linalg.norm(tangent, axis=0) * sides[0][0].thickness(along.at(s))
        weights += share * np.outer(functions, length)
    return weights
