"""Sides of bodies as curves: where an edge is, which way it faces, and what is closest to it."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from lacore.model.bodies.any_body import PlaneBody
from lacore.model.meshes.curved import EdgeCurves
from lacore.numerics.arrays import Floats, Ints
from lacore.paths.contact.pairs import Side
from lacore.reporting.showing import Compact

_ITERATIONS = 12  # of Newton's method for a closest point; it converges quadratically
_BEYOND = 0.5  # of an edge: how far past its ends a closest point is followed


@dataclass(frozen=True, repr=False)
class Outline(Compact):
    """The edges of a side at one configuration.

    Attributes:
        edges: numbers in their body, shape (n,).
        curves: places of the edges.
        outward: unit normals of their chords, out of the body, shape (2, n).
    """

    edges: Ints
    curves: EdgeCurves
    outward: Floats

    def take(self, which: Ints) -> "Outline":
        """Some of the edges, by their positions in this outline."""
        own = self.curves
        curves = EdgeCurves(own.start[:, which], own.middle[:, which], own.end[:, which])
        return Outline(self.edges[which], curves, self.outward[:, which])

    @property
    def lengths(self) -> Floats:
        """Of the chords, m, shape (n,)."""
        return np.asarray(np.linalg.norm(self.curves.end - self.curves.start, axis=0))

    def at(self, s: Floats) -> Floats:
        """Places at parameters, shape (2, n)."""
        return self.curves.at(s)

    def normal(self, s: Floats) -> Floats:
        """Unit outward normals at parameters, shape (2, n)."""
        return self.curves.normal(s, self.outward)

    def closest(self, points: Floats) -> Floats:
        """Parameters of the places closest to points of shape (2, n), also beyond the ends."""
        bulge, s = self.curves.bulge, self.curves.parameter(points)
        for _ in range(_ITERATIONS):
            away, along = self.curves.at(s) - points, self.curves.tangent(s)
            slope = np.sum(along**2, axis=0) - 8 * np.sum(away * bulge, axis=0)
            safe = np.maximum(slope, 0.1 * np.sum(along**2, axis=0))
            s = np.clip(s - np.sum(away * along, axis=0) / safe, -_BEYOND, 1 + _BEYOND)
        return np.asarray(s)


def outline(side: Side, bodies: Mapping[str, PlaneBody]) -> Outline:
    """A side of a body as it is now."""
    body = bodies[side.body]
    curves = body.curves(side.edges)
    along = curves.end - curves.start
    across = np.stack([along[1], -along[0]]) / np.linalg.norm(along, axis=0)
    return Outline(side.edges, curves, across * side.turn)
