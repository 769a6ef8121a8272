"""What moves the shape of a tool: a rigid block about its reference point.

The block has the three unknowns of the tool and carries the force that drives it. Contact is that
of the shape; the polygon of the block touches nothing.
"""

from dataclasses import dataclass, replace

import numpy as np

from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.contact.obstacles import Shape
from lacore.model.contact.profiles import InnerCorner
from lacore.numerics.arrays import Floats
from lacore.reporting.showing import Compact

PART = "tool"
"""Name of the block that carries a tool."""
_SIDE = 0.05  # of the smallest body that a tool touches: the polygon, a square


def carrier(reference: tuple[float, float], size: float) -> BlockAssembly:
    """Return the block that carries a tool with a reference point; `size` of the bodies, m."""
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * _SIDE * size / 2
    return BlockAssembly({PART: square + np.array(reference)}, friction=0.0)


@dataclass(frozen=True, repr=False)
class MovedShape(Compact):
    """A shape that was turned about the origin and then shifted.

    Attributes:
        shape: Shape before the motion.
        turn: Rotation, rad.
        shift: Displacement, m.
    """

    shape: Shape
    turn: float
    shift: tuple[float, float]

    def distance(self, places: Floats) -> Floats:
        """See `Shape`."""
        return self.shape.distance(self._back(places))

    def normal(self, places: Floats) -> Floats:
        """See `Shape`."""
        return np.asarray(_rotation(self.turn) @ self.shape.normal(self._back(places)))

    def outline(self, low: Floats, high: Floats) -> Floats:
        """See `Shape`."""
        box = np.array([[low[0], low[0], high[0], high[0]], [low[1], high[1], low[1], high[1]]])
        box = self._back(box)
        return self._forth(self.shape.outline(box.min(axis=1), box.max(axis=1)))

    @property
    def corners(self) -> Floats:
        """Sharp convex corners, m, shape (2, c)."""
        return self._forth(corners_of(self.shape))

    @property
    def inner(self) -> list[InnerCorner]:
        """Sharp corners that the solid surrounds."""
        turned = _rotation(self.turn)
        return [
            replace(
                own,
                place=self._forth(own.place[:, None])[:, 0],
                normals=own.normals @ turned.T,
            )
            for own in inner_corners(self.shape)
        ]

    def _forth(self, places: Floats) -> Floats:
        return np.asarray(_rotation(self.turn) @ places + np.reshape(self.shift, (2, 1)))

    def _back(self, places: Floats) -> Floats:
        return np.asarray(_rotation(-self.turn) @ (places - np.reshape(self.shift, (2, 1))))


def corners_of(shape: Shape) -> Floats:
    """Sharp convex corners of a shape, m, shape (2, c); none of one that names none."""
    return np.asarray(getattr(shape, "corners", np.zeros((2, 0))))


def inner_corners(shape: Shape) -> list[InnerCorner]:
    """Sharp corners that a shape surrounds; none of one that names none."""
    return list(getattr(shape, "inner", ()))


def moved_shape(shape: Shape, about: Floats, at: Floats) -> MovedShape:
    """A shape after a point of it has moved, and it has turned about this point.

    Args:
        shape: before.
        about: the point before, m, shape (2, 1).
        at: where it is now, m, and the angle, rad, shape (3, 1).
    """
    turn = float(at[2, 0])
    shift = at[:2] - _rotation(turn) @ about
    before = shape if isinstance(shape, MovedShape) else MovedShape(shape, 0.0, (0.0, 0.0))
    shift = shift + _rotation(turn) @ np.reshape(before.shift, (2, 1))
    x, y = shift[:, 0].tolist()
    return MovedShape(before.shape, turn + before.turn, (x, y))


def _rotation(turn: float) -> Floats:
    c, s = np.cos(turn), np.sin(turn)
    return np.array([[c, -s], [s, c]])
