"""Three-dimensional assemblies of rigid blocks: polyhedra, their joints and their friction."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from types import MappingProxyType
from typing import ClassVar

import numpy as np

from lacore.model.bodies.blocks.checks import check_contact
from lacore.model.bodies.blocks.joints import JointFriction, joint_law, joint_terms
from lacore.model.bodies.blocks.loads import carried
from lacore.model.bodies.blocks.polygons import block_name
from lacore.model.bodies.blocks.rigid_blocks import CrushingPoints, RigidBlocks, require_resolved
from lacore.model.bodies.blocks3d.apart import meeting_alone, require_apart
from lacore.model.bodies.blocks3d.crushing import Crushing, crushing_of
from lacore.model.bodies.blocks3d.faces import Faces, faces_of
from lacore.model.bodies.blocks3d.joints import Joints3D, find_joints
from lacore.model.bodies.blocks3d.polyhedron import Polyhedron
from lacore.model.bodies.blocks3d.slits import require_no_slits
from lacore.model.bodies.touching import Touched
from lacore.model.conditions.loads import Fix, Load
from lacore.model.conditions.where import asked
from lacore.model.materials.friction import Friction
from lacore.model.meshes.files.notes import notes_of
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting import terms
from lacore.reporting.errors import InputError, require_positive
from lacore.reporting.showing import Facts, counted, short
from lacore.reporting.text import text

_TOLERANCE = 1e-6  # by the mean block size


@dataclass(frozen=True, eq=False, repr=False)
class BlockAssembly3D(RigidBlocks):
    """Three-dimensional rigid blocks and the joints between them (T70, T71).

    A joint is a plane polygon that faces of two blocks share: the faces face each other, overlap
    with an area, and are at most `tolerance` apart. The contact points of a joint are the corners
    of the convex hull of each of its pieces, with equal shares of the area. Edges and corners that
    touch make no joint.

    Attributes:
        blocks: `Polyhedron` by name. Those of a sequence are named "0", "1", ...
        friction: Law of all joints: a Coulomb coefficient, `Coulomb`, `Tresca`, `SMOOTH`, `STICK`.
        joint_friction: Other laws for single pairs ``(name, name)``, in either order.
        tolerance: Distance up to which faces touch, m. The default is 1e-6 of the mean block size
            (cubic root of the volume).
        crushing: Compressive strength of all joints, Pa, or `Crushing`; None: unlimited (T95).
        names: Names of the blocks, (B,).
        volume: Volumes of the blocks, (B,), m^3.
        centroid: Centroids of the blocks, (3, B), m.
        radius: Largest distance of a vertex from the centroid, (B,), m, which scales rates of
            rotation to velocities.
        size: Diagonal of the bounding box, m.
        faces: Plane faces of all blocks.
        face_centroid: Centroids of the faces, (3, F), m.
        joints: See `Joints3D`; the master is the block that comes first.
        joint_terms: Coefficient, limit, dilatancy and tension of the laws of joints, (4, J).

    Raises:
        InputError: There is no block, or one that is not a `Polyhedron`; blocks overlap, or nearly
            touch (a gap above `tolerance` and below 1 % of the width of a face); friction is
            negative or NaN; a pair of `joint_friction` is given twice, is unknown, or shares no
            joint. The message names the blocks.

    Example:
        >>> cubes = la.masonry3d.wall([[1, 1]], friction=0.6, base=False).blocks
        >>> la.BlockAssembly3D(cubes, friction=la.Coulomb(0.5)).names
        ('c1b1', 'c1b2')
    """

    blocks: Mapping[str, Polyhedron] | Sequence[Polyhedron]
    friction: float | Friction
    joint_friction: JointFriction | None = None
    tolerance: float | None = None
    crushing: float | Crushing | None = None
    dimension: ClassVar[int] = 3
    facet: ClassVar[str] = "face"
    rim: ClassVar[str] = "an edge or a corner"
    names: tuple[str, ...] = field(init=False, repr=False)
    volume: Floats = field(init=False, repr=False)
    centroid: Floats = field(init=False, repr=False)
    radius: Floats = field(init=False, repr=False)
    size: float = field(init=False, repr=False)
    faces: Faces = field(init=False, repr=False)
    face_centroid: Floats = field(init=False, repr=False)
    joints: Joints3D = field(init=False, repr=False)
    joint_terms: Floats = field(init=False, repr=False)

    def __post_init__(self) -> None:
        blocks = _read(self.blocks, "BlockAssembly3D.blocks")
        names, polyhedra = tuple(blocks), tuple(blocks.values())
        volume = np.array([block.volume for block in polyhedra])
        vertices = np.concatenate([block.vertices for block in polyhedra]).T
        tolerance = _length_tolerance(self.tolerance, vertices, volume)
        friction = joint_law(self.friction, "BlockAssembly3D.friction")
        laws = {} if self.joint_friction is None else self.joint_friction
        require_apart(blocks, tolerance, "BlockAssembly3D.blocks")
        require_no_slits(blocks, tolerance, "BlockAssembly3D.blocks")
        crushing = crushing_of(self.crushing)
        joints = find_joints(blocks, tolerance, crushing)
        terms = joint_terms(
            names, joints.slave, joints.master, friction, laws, "BlockAssembly3D.joint_friction"
        )
        computed = {
            "blocks": MappingProxyType(blocks),
            "friction": friction,
            "joint_friction": MappingProxyType(dict(laws)),
            "tolerance": tolerance,
            "crushing": crushing,
            "names": names,
            "volume": volume,
            "centroid": np.stack([block.centroid for block in polyhedra], axis=1),
            "radius": np.array([block.radius for block in polyhedra]),
            "size": float(np.linalg.norm(np.ptp(vertices, axis=1))),
            "faces": faces_of(polyhedra),
            "face_centroid": np.concatenate([block.face_centroid for block in polyhedra], axis=1),
            "joints": joints,
            "joint_terms": terms,
        }
        for name, value in computed.items():
            object.__setattr__(self, name, value)

    def facts(self) -> Facts:
        """Return the contents, for printing."""
        facts = super().facts()
        if notes := notes_of(self):
            facts = Facts(facts.title, {**facts.told, "file": "; ".join(notes)})
        if (law := crushing_of(self.crushing)) is None:
            return facts
        crushing = f"{short(law.strength)} Pa, {counted(law.divisions, 'division')}"
        return Facts(facts.title, {**facts.told, "crushing": crushing})

    @property
    def box(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner of the bounding box of all, m, shape (3,) each."""
        low, high = self.faces.low.min(axis=1), self.faces.high.max(axis=1)
        return low + self.faces.origin, high + self.faces.origin

    @property
    def polyhedra(self) -> Mapping[str, Polyhedron]:
        """The blocks by name."""
        assert isinstance(self.blocks, Mapping)  # set in the constructor
        return self.blocks

    @property
    def measure(self) -> Floats:
        """Volumes, (B,), m^3."""
        return self.volume

    @property
    def facet_blocks(self) -> Ints:
        """The block of each face."""
        return self.faces.block

    @property
    def crushing_points(self) -> CrushingPoints | None:
        """Points of joints that crush: centroids of their cells."""
        own, law = self.joints, crushing_of(self.crushing)
        if law is None:
            return None
        block, normal = own.slave[own.joint], own.normal[:, own.joint]
        return CrushingPoints(block, own.points, normal, own.weight, law.strength)

    def rims(self, faces: Ints) -> tuple[Floats, Floats, Ints]:
        """Return the corners of some faces, (3, k), m, normals there, (3, k), and blocks, (k,)."""
        places, face = self.corners_of(faces)
        return places, self.faces.normal[:, face], self.faces.block[face]

    def geometry_of(self, faces: Ints) -> tuple[Floats, Floats, Floats]:
        """Return the centroids of faces, m, and normals, (3, k) each, and areas, (k,), m^2."""
        return self.face_centroid[:, faces], self.faces.normal[:, faces], self.faces.area[faces]

    def away(self, place: Floats) -> Floats:
        """Return the distances of a place from the nearest convex piece of each block, m."""
        return np.array([_outside(block, place) for block in self.polyhedra.values()])

    def simplices(self, blocks: Ints) -> tuple[Floats, Floats, Ints]:
        """Return the tetrahedra over the triangles of faces.

        Returns:
            corners (3, 4, t), m, volumes (t,), m^3, and the block of each.
        """
        found, owners = [], []
        for number in blocks.tolist():
            own = self.polyhedra[self.names[number]]
            rings = [(ring[0], *pair) for ring in own.faces for pair in pairwise(ring[1:])]
            apex = np.repeat(own.centroid[None, None], len(rings), axis=0)
            found.append(np.concatenate([apex, own.vertices[np.array(rings)]], axis=1))
            owners.append(np.full(len(rings), number))
        corner = np.concatenate(found).transpose(2, 1, 0)
        u, v, w = (corner[:, k] - corner[:, 0] for k in (1, 2, 3))
        return corner, np.sum(u * np.cross(v, w, axis=0), axis=0) / 6, np.concatenate(owners)

    def corners_of(self, faces: Ints) -> tuple[Floats, Ints]:
        """Return the corners of some faces, (3, k), m, and the face of each, (k,)."""
        face = self.faces.ring_face[self.faces.ring]
        own = np.flatnonzero(np.isin(face, faces))
        return self.faces.points[:, own] + self.faces.origin[:, None], face[own]

    @property
    def jointed_facets(self) -> Ints:
        """Numbers of the faces that have a joint."""
        own, first = self.joints, np.searchsorted(self.faces.block, np.arange(len(self.names)))
        slave, master = first[own.slave] + own.slave_face, first[own.master] + own.master_face
        return np.union1d(slave, master)

    def check_load(self, load: Load, field: str) -> None:
        """Raise `InputError` if no block carries a load."""
        carried(load, self)

    def check_contact(
        self, field: str, supports: Sequence[Fix], touched: Sequence[Touched]
    ) -> None:
        """Raise `InputError` if a block touches nothing, or only with an edge or a corner.

        Blocks that crush must touch only blocks of this assembly.
        """
        if self.crushing is not None and touched:
            raise InputError(
                touched[0].field,
                touched[0].name,
                "joints of these blocks crush, contact with what is no block of them would not",
                text("give what they touch as a block, and hold it by a {}", terms.SUPPORT),
            )
        check_contact(self, field, supports, touched)

    @cached_property
    def lone_meetings(self) -> tuple[Ints, Ints, Floats]:
        """See `meeting_alone`."""
        blocks, joints = list(self.polyhedra.values()), self.joints
        if self.crushing is not None:  # Points of cells are not at the rim.
            joints = find_joints(self.polyhedra, self.allowed)
        return meeting_alone(blocks, joints, self.allowed)

    def crushed(self, crushing: Crushing) -> BlockAssembly3D:
        """Return the assembly with joints that crush by another law."""
        other = copy(self)
        joints = find_joints(self.polyhedra, self.allowed, crushing)
        for name, value in {"crushing": crushing, "joints": joints}.items():
            object.__setattr__(other, name, value)
        return other

    def facets_inside(self, where: Callable[[Floats], Bools], field: str) -> Ints:
        """Return the faces whose centroids satisfy a predicate.

        Raises:
            InputError: a predicate that fails; it names the `field`.
        """
        return np.flatnonzero(asked(where, self.face_centroid.copy(), field))


def _outside(block: Polyhedron, place: Floats) -> float:
    """Return the distance of a place from the planes of the nearest convex piece of a block, m."""
    return min(float((place @ piece.normal - piece.offset).max()) for piece in block.pieces)


def _read(
    blocks: Mapping[str, Polyhedron] | Sequence[Polyhedron], field: str
) -> dict[str, Polyhedron]:
    if isinstance(blocks, Mapping):
        given: Iterable[tuple[str, Polyhedron]] = blocks.items()
    elif isinstance(blocks, Sequence) and not isinstance(blocks, str):
        given = ((str(number), block) for number, block in enumerate(blocks))
    else:
        raise InputError(field, blocks, "not blocks", "give {'name': lacore.Polyhedron(...)}")
    read = {block_name(name, field): block for name, block in given}
    if not read:
        raise InputError(field, None, "there is no block", "give at least one polyhedron")
    for name, block in read.items():
        if not isinstance(block, Polyhedron):
            fix = "give lacore.Polyhedron(vertices, faces)"
            raise InputError(f"{field}[{name!r}]", block, "not a polyhedron", fix)
    return read


def _length_tolerance(given: float | None, vertices: Floats, volume: Floats) -> float:
    """Return the tolerance in m; rejected if coordinates, (3, n), do not resolve it."""
    if given is not None:
        require_positive("BlockAssembly3D.tolerance", given)
    tolerance = float(_TOLERANCE * np.cbrt(volume).mean()) if given is None else float(given)
    return require_resolved(tolerance, vertices, "BlockAssembly3D.tolerance")
