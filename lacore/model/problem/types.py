"""Types of signatures, for user annotations: ``la.types``."""

from lacore.model.bodies.any_body import AnyBody
from lacore.model.bodies.blocks.drawings.joints import LayerFriction
from lacore.model.bodies.blocks.joints import JointFriction
from lacore.model.bodies.blocks.polygons import Polygons
from lacore.model.bodies.frames.members import Members
from lacore.model.conditions.body_forces import Component
from lacore.model.conditions.loads import Load
from lacore.model.conditions.where import Where
from lacore.model.materials.fields import Given
from lacore.model.materials.friction import Friction
from lacore.model.meshes.naming import Places
from lacore.numerics.arrays import Bools, Floats, Ints

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
