"""Assemblies of rigid blocks in space: polyhedra, the joints between them, and their friction.

Pure geometry; see `lacore.assembly.discretise` for what becomes of it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np

from lacore.arrays import Bools, Floats, Ints
from lacore.bodies.blocks.checks import check_isolated
from lacore.bodies.blocks.joints import JointFriction, joint_law, joint_names, joint_terms
from lacore.bodies.blocks.polygons import block_name
from lacore.bodies.blocks3d.apart import meeting_alone, require_apart, touched_by
from lacore.bodies.blocks3d.crushing import Crushing, crushing_of
from lacore.bodies.blocks3d.faces import Faces, faces_of
from lacore.bodies.blocks3d.held import free_motions
from lacore.bodies.blocks3d.joints import Joints3D, find_joints
from lacore.bodies.blocks3d.loaded import carried
from lacore.bodies.blocks3d.polyhedron import Polyhedron
from lacore.bodies.blocks3d.slits import require_no_slits
from lacore.bodies.pickled import by_arguments
from lacore.bodies.touching import Touched
from lacore.conditions.loads import Fix, Load
from lacore.conditions.where import Where
from lacore.errors import InputError, require_known, require_positive
from lacore.materials.friction import Friction
from lacore.reporting import terms
from lacore.reporting.text import Term, text
from lacore.showing import Facts, Shown, counted, listed, placed, short, spanned

_TOLERANCE = 1e-6  # of the mean block size
_DIGITS = 16 * np.finfo(float).eps  # of the coordinates: what sums and products of them keep


@dataclass(frozen=True, eq=False, repr=False)
class BlockAssembly3D(Shown):
    """Rigid blocks in space and the joints between them (T70, T71).

    A joint is a plane polygon that faces of two blocks share: they face each other, overlap with an
    area, and are at most `tolerance` apart. Its contact points are the corners of the convex hull
    of each piece, each with the same share of its area. Edges and corners that touch make no joint.

    Attributes:
        blocks: `Polyhedron` by name; a sequence is named "0", "1", ...
        friction: law of all joints: a Coulomb coefficient, `Coulomb`, `Tresca`, `SMOOTH`, `STICK`.
        joint_friction: other laws for single pairs ``(name, name)``, in either order.
        tolerance: m; if None 1e-6 of the mean block size (cubic root of the volume).
        crushing: largest pressure in all joints, Pa, or `Crushing`; None: there is none (T95).
        names: (B,). `volume`: (B,), m^3. `centroid`: (3, B), m.
        radius: largest distance of a vertex from the centroid, (B,), m: turns rates of rotation
            into velocities.
        size: diagonal of the bounding box of all, m.
        faces: plane faces of all blocks. `face_centroid`: theirs, (3, F), m.
        joints: see `Joints3D`; the master is the block that comes first.
        joint_terms: coefficient, limit, dilatancy and tension of their laws, (4, J), see `Joints`.

    Raises:
        InputError: no block, what is no polyhedron; blocks that overlap, or nearly touch (a gap
            above `tolerance` and below 1 % of the width of a face); friction below 0 or NaN; a pair
            of `joint_friction` given twice, unknown, or without joint. It names the blocks.

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
    pointwise: ClassVar[bool] = False  # it touches others along faces
    deforms: ClassVar[bool] = False
    axisymmetric: ClassVar[bool] = False
    names: tuple[str, ...] = field(init=False, repr=False)
    volume: Floats = field(init=False, repr=False)
    centroid: Floats = field(init=False, repr=False)
    radius: Floats = field(init=False, repr=False)
    size: float = field(init=False, repr=False)
    faces: Faces = field(init=False, repr=False)
    face_centroid: Floats = field(init=False, repr=False)
    joints: Joints3D = field(init=False, repr=False)
    joint_terms: Floats = field(init=False, repr=False)

    def __reduce__(self) -> tuple[type, tuple[Any, ...]]:
        """Pickle by the arguments."""
        return by_arguments(self)

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

    @property
    def contents(self) -> str:
        """``36 blocks in space, 48 joints``."""
        blocks = counted(len(self.names), "rigid block")
        return f"{blocks} in space, {counted(self.joints.count, 'joint')}"

    def facts(self) -> Facts:
        """What it consists of."""
        laws = self.joint_friction or {}
        told = {
            "blocks": listed(self.names, 10),
            "friction": short(self.friction) + (f", {len(laws)} joints differ" if laws else ""),
            "size": f"{self.volume.sum():.4g} m^3, {self.size:.4g} m across",
        }
        if law := crushing_of(self.crushing):
            told["crushing"] = f"{short(law.strength)} Pa, {counted(law.divisions, 'division')}"
        return Facts(f"BlockAssembly3D: {self.contents}", told)

    @property
    def box(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner of the bounding box of all, m, shape (3,) each."""
        low, high = self.faces.low.min(axis=1), self.faces.high.max(axis=1)
        return low + self.faces.origin, high + self.faces.origin

    @property
    def polyhedra(self) -> Mapping[str, Polyhedron]:
        """The blocks by name."""
        assert isinstance(self.blocks, Mapping)  # since it was built
        return self.blocks

    @property
    def joint_names(self) -> tuple[str, ...]:
        """``master|slave``, and ``master|slave#2`` where two blocks share a second polygon."""
        return joint_names(self.names, self.joints.master, self.joints.slave)

    @property
    def isolated(self) -> tuple[str, ...]:
        """Names of the blocks that have no joint."""
        jointed = np.zeros(len(self.names), dtype=bool)
        jointed[self.joints.slave] = jointed[self.joints.master] = True
        return tuple(name for name, has in zip(self.names, jointed, strict=True) if not has)

    @property
    def allowed(self) -> float:
        """Distance up to which coordinates count as one, m."""
        assert self.tolerance is not None  # since it was built
        return self.tolerance

    def blocks_of(self, faces: Ints) -> Ints:
        """The blocks of faces."""
        return np.asarray(self.faces.block[faces])

    def corners_of(self, faces: Ints) -> tuple[Floats, Ints]:
        """Corners of some faces, (3, k), m, and the face of each, (k,)."""
        face = self.faces.ring_face[self.faces.ring]
        own = np.flatnonzero(np.isin(face, faces))
        return self.faces.points[:, own] + self.faces.origin[:, None], face[own]

    @property
    def jointed_faces(self) -> Ints:
        """Numbers of the faces that have a joint."""
        own, first = self.joints, np.searchsorted(self.faces.block, np.arange(len(self.names)))
        slave, master = first[own.slave] + own.slave_face, first[own.master] + own.master_face
        return np.union1d(slave, master)

    def check_load(self, load: Load, field: str) -> None:
        """Raise `InputError` where no block carries a load."""
        carried(load, self)

    def with_points(self, points: Iterable[Sequence[float]]) -> BlockAssembly3D:
        """Itself: point forces act anywhere on blocks."""
        return self

    def check_contact(
        self, field: str, supports: Sequence[Fix], touched: Sequence[Touched]
    ) -> None:
        """Raise `InputError` where a block touches nothing, or an obstacle where a joint is.

        Also where two meet with an edge or a corner and nothing else is there. Of blocks that crush
        wherever they touch what is not of this assembly.
        """
        for own in touched:
            if self.crushing is not None:
                raise InputError(
                    own.field,
                    own.name,
                    "joints of these blocks crush, contact with what is no block of them would not",
                    text("give what they touch as a block, and hold it by a {}", terms.SUPPORT),
                )
            taken = np.intersect1d(own.edges, self.jointed_faces)
            if own.by_obstacle and taken.size:
                block = self.names[self.faces.block[taken[0]]]
                raise InputError(
                    own.field,
                    own.name,
                    f"the face of block {block!r} about {placed(self.face_centroid[:, taken[0]])} m"
                    " has a joint with another block",
                    "select the faces that touch the obstacle by a function of coordinates",
                )
        check_isolated(self, field, supports, touched, self._touched_at)
        self._check_meetings(field, supports)

    def _check_meetings(self, field: str, supports: Sequence[Fix]) -> None:
        """Refuse blocks that move and meet with an edge or a corner alone, which no joint keeps."""
        first, second, place = self._alone
        if not first.size:
            return
        free = np.diff(free_motions(self, supports).indptr).reshape(-1, 6)
        moves = np.asarray(free.any(axis=1))
        own = np.flatnonzero(moves[first] | moves[second])
        if own.size:
            one, other = (self.names[blocks[own[0]]] for blocks in (first, second))
            raise InputError(
                field,
                (one, other),
                f"these blocks touch at {placed(place[:, own[0]])} m with an edge or a corner only,"
                f" which makes no joint, and nothing else keeps them apart there (such pairs:"
                f" {own.size})",
                "cut the edge off, so that faces touch there, or move the blocks apart",
            )

    @cached_property
    def _alone(self) -> tuple[Ints, Ints, Floats]:
        """See `meeting_alone`."""
        blocks, joints = list(self.polyhedra.values()), self.joints
        if self.crushing is not None:  # points of cells are not at the rim
            joints = find_joints(self.polyhedra, self.allowed)
        return meeting_alone(blocks, joints, self.allowed)

    def crushed(self, crushing: Crushing) -> BlockAssembly3D:
        """Itself with joints that crush by another law."""
        other = copy(self)
        joints = find_joints(self.polyhedra, self.allowed, crushing)
        for name, value in {"crushing": crushing, "joints": joints}.items():
            object.__setattr__(other, name, value)
        return other

    def _touched_at(self, block: str) -> str:
        """What a block without a joint touches all the same, in words; empty where nothing."""
        number = np.array([self.names.index(block)])
        _, others, places = touched_by(list(self.polyhedra.values()), number, self.allowed)
        if not others.size:
            return ""
        return (
            f"it touches {self.names[others[0]]!r} at {placed(places[:, 0])} m with an edge or a"
            " corner only, which makes no joint"
        )

    def check_support(self, support: Fix, field: str) -> None:
        """Raise `InputError` where a support cannot hold it; it names the `field`."""
        self.outline(support.where, f"{field}.where")

    def outline(self, where: Where, field: str) -> Ints:
        """Numbers of the plane faces of the part `where` of the blocks, sorted.

        A name, or a tuple of names, selects whole blocks. A predicate gets the centroids of all
        faces, (3, n), and returns a mask (n,).

        Raises:
            InputError: unknown name, nothing selected, a predicate that fails; it names `field`.
        """
        if callable(where):
            chosen = np.flatnonzero(_inside(where, self.face_centroid, field))
        elif isinstance(where, str | tuple):
            wanted = (where,) if isinstance(where, str) else where
            for name in wanted:
                require_known(field, name, self.names)
            chosen = np.flatnonzero(np.isin(self.names, wanted)[self.faces.block])
        else:
            fix = text(
                "give a name, names, or {}", Term("a function of (3, n)", "places in numbers")
            )
            raise InputError(field, where, "no part of the blocks", fix)
        if chosen.size == 0:
            fix = f"select the centroid of a face: the blocks lie in {spanned(*self.box)}"
            raise InputError(field, None, "no face", fix)
        return chosen


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


def _inside(where: Callable[[Floats], Bools], places: Floats, field: str) -> Bools:
    """Which places, (3, n), satisfy a predicate, (n,)."""
    try:
        inside = np.asarray(where(places.copy()))
    except Exception as error:  # of others
        raise InputError(
            field,
            None,
            f"the predicate fails for coordinates (3, n): {type(error).__name__}: {error}",
            "compare arrays, and join conditions by & and |, each in brackets",
        ) from error
    if inside.shape != (places.shape[1],) or inside.dtype != bool:
        raise InputError(
            field,
            inside.dtype.name,
            "the predicate does not return one bool a face",
            "return an array of bool of shape (n,) for coordinates (3, n)",
        )
    return inside


def _length_tolerance(given: float | None, vertices: Floats, volume: Floats) -> float:
    """The tolerance in m, refused where coordinates, (3, n), do not resolve it."""
    if given is not None:
        require_positive("BlockAssembly3D.tolerance", given)
    tolerance = float(_TOLERANCE * np.cbrt(volume).mean()) if given is None else float(given)
    farthest = np.abs(vertices).max()
    if tolerance < _DIGITS * farthest:
        raise InputError(
            "BlockAssembly3D.tolerance",
            tolerance,
            f"coordinates as large as {farthest:.3g} m are not that precise",
            "put the origin near the blocks, or give a larger tolerance",
        )
    return tolerance
