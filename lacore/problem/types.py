"""Types that signatures speak of, for annotations of your own: ``la.types``."""

from lacore.arrays import Bools, Floats, Ints
from lacore.bodies.any_body import AnyBody
from lacore.bodies.blocks.drawings.joints import LayerFriction
from lacore.bodies.blocks.joints import JointFriction
from lacore.bodies.blocks.polygons import Polygons
from lacore.bodies.frames.members import Members
from lacore.conditions.body_forces import Component
from lacore.conditions.loads import Load
from lacore.conditions.where import Where
from lacore.materials.fields import Given
from lacore.materials.friction import Friction
from lacore.meshes.naming import Places

__all__ = [
    "AnyBody",
    "Bools",
    "Component",
    "Floats",
    "Friction",
    "Given",
    "Ints",
    "JointFriction",
    "LayerFriction",
    "Load",
    "Members",
    "Places",
    "Polygons",
    "Where",
]
