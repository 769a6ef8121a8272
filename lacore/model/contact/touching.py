"""Contact along an interface or in joints: segments in the plane, else patches or faces."""

from collections.abc import Mapping
from functools import singledispatch

from lacore.model.bodies.any_body import AnyBody, of_kind
from lacore.model.bodies.blocks.joints import Joints
from lacore.model.bodies.blocks.rigid_blocks import JointPairs
from lacore.model.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.model.bodies.blocks3d.joints import Joints3D
from lacore.model.bodies.continuum.body import Body
from lacore.model.contact import faces, patches, segments
from lacore.model.contact.interfaces import Interface

Touching = segments.Segments | patches.Patches | faces.Faces


def where_touching(interface: Interface, bodies: Mapping[str, AnyBody], field: str) -> Touching:
    """Return where the sides of an interface touch.

    Raises:
        InputError: they do not touch, or not in a supported way.
    """
    deforming = {n: body for n, body in of_kind(bodies, Body).items() if body.dimension == 3}
    if deforming:
        return faces.obstacle_faces(interface, deforming, field)
    if solid := of_kind(bodies, BlockAssembly3D):
        return patches.interface_patches(interface, solid, field)
    plane = {name: body for name, body in bodies.items() if not isinstance(body, BlockAssembly3D)}
    return segments.interface_segments(interface, plane, field)


def in_plane(touching: Touching) -> segments.Segments:
    """Return the contact of a plane problem."""
    assert isinstance(touching, segments.Segments)
    return touching


@singledispatch
def of_joints(joints: JointPairs) -> Touching:
    """Return where the blocks of an assembly touch each other."""
    raise TypeError(f"no joints: {type(joints).__name__}")


of_joints.register(Joints, segments.of_joints)
of_joints.register(Joints3D, patches.of_joints)
