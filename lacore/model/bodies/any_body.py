"""Bodies of any kind: what a problem asks of them, and what assembling asks of their unknowns.

A new kind is a folder beside this file, and a name in `AnyBody` and in `KINDS`.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Protocol, Self, TypeVar

from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.blocks.rigid_blocks import RigidBlocks
from lacore.model.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.frames.frame import Frame
from lacore.model.bodies.touching import Edges, Touched
from lacore.model.conditions.loads import Fix, Load
from lacore.model.conditions.where import Where
from lacore.model.meshes.curved import EdgeCurves
from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.program.kinematic import DissipationGroup

PlaneBody = Body | BlockAssembly | Frame
AnyBody = PlaneBody | BlockAssembly3D
"""A body of a problem: `lacore.Body`, or one of `BlockAssembly`, `BlockAssembly3D`, `Frame`."""
Kind = TypeVar("Kind", Body, BlockAssembly, Frame, BlockAssembly3D, RigidBlocks)
Own = TypeVar("Own", bound="Counted")


class Stated(Protocol):
    """What a problem asks of a body; nothing of it is numbered."""

    @property
    def contents(self) -> str:
        """What it consists of, in a few words."""
        ...

    @property
    def dimension(self) -> int:
        """2 of the plane, 3 in space."""
        ...

    @property
    def pointwise(self) -> bool:
        """Whether it touches others in single nodes, not along edges."""
        ...

    @property
    def deforms(self) -> bool:
        """Whether it is a continuum, with a mesh, whose edges deform."""
        ...

    @property
    def axisymmetric(self) -> bool:
        """Whether it is a body of revolution, x the radius."""
        ...

    @property
    def box(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner of its bounding box, m, shape (d,) each."""
        ...

    @property
    def size(self) -> float:
        """Diagonal of its bounding box, m."""
        ...

    @property
    def allowed(self) -> float:
        """Distance up to which coordinates count as one, m."""
        ...

    def check_load(self, load: Load, field: str) -> None:
        """Raise `InputError` where it cannot carry a load."""
        ...

    def check_support(self, support: Fix, field: str) -> None:
        """Raise `InputError` where a support cannot hold it."""
        ...

    def check_contact(
        self, field: str, supports: Sequence[Fix], touched: Sequence[Touched]
    ) -> None:
        """Raise `InputError` where a part of it touches nothing, or nothing that could hold it."""
        ...

    def with_points(self, points: Iterable[Sequence[float]]) -> Self:
        """With whatever it needs where point forces act."""
        ...


class StatedInPlane(Stated, Protocol):
    """What is asked of bodies of the plane besides."""

    def boundary(self, where: Where, field: str) -> tuple[Ints, Edges]:
        """Numbers and geometry of a part of the boundary; a node is an edge of length 0."""
        ...

    def curves(self, edges: Ints) -> EdgeCurves:
        """Edges as curves."""
        ...


class Dofs(Protocol):
    """The unknowns of a body among all, and what they do."""

    @property
    def body(self) -> Stated:
        """Whose they are."""
        ...

    @property
    def offset(self) -> int:
        """Number of the first."""
        ...

    @property
    def count(self) -> int:
        """How many there are."""
        ...

    @property
    def degree(self) -> int:
        """Of the velocity along an edge; 0 of single nodes."""
        ...

    @property
    def strength(self) -> float:
        """Shear stress that it can carry, Pa."""
        ...

    @property
    def extent(self) -> float:
        """Area, of a frame the square of its size, m^2; in space volume, m^3."""
        ...

    @property
    def bent(self) -> bool:
        """Whether edges are curves."""
        ...

    @property
    def axisymmetric(self) -> bool:
        """Whether it is a body of revolution."""
        ...

    @property
    def pieces_of_unknowns(self) -> Ints:
        """Which part of the body each unknown moves, from 0, shape (count,)."""
        ...

    def groups(self, name: str, n: int) -> tuple[DissipationGroup, ...]:
        """Its dissipation over n unknowns."""
        ...

    def force(self, load: Load) -> Floats:
        """Forces of a load on its unknowns, shape (count,), N/m; in space N."""
        ...

    def parts(self, edges: Ints) -> Ints:
        """What velocities at edges, or faces, are told by: facets themselves, blocks, nodes."""
        ...

    def moving(self, parts: Ints) -> Ints:
        """What of it moves continuously, by number."""
        ...

    def velocity_rows(self, parts: Ints, points: Floats, n: int) -> tuple[Sparse, ...]:
        """Rows of u_x, u_y (and u_z) of parts at points of shape (d, k), each of shape (k, n)."""
        ...

    def thickness(self, places: Floats) -> Floats:
        """Across the plane at places of shape (2, ...), m."""
        ...


class RigidParts(Dofs, Protocol):
    """Of bodies with unknowns of their own supports: rigid blocks and frames."""

    def free(self, supports: Iterable[Fix]) -> Sparse:
        """Basis of the velocities that supports leave free, shape (count, free)."""
        ...

    def support_forces(self, force: Floats, supports: Iterable[Fix]) -> tuple[Floats, Floats]:
        """Places (d, k), and what supports exert there of forces on the unknowns.

        Forces, then moments: (3, k), in space (6, k).
        """
        ...


PLANE: tuple[type[StatedInPlane], ...] = (Body, BlockAssembly, Frame)
KINDS: tuple[type[Stated], ...] = (*PLANE, BlockAssembly3D)
"""All kinds, in the order of their unknowns: type checkers find here what one lacks."""


def plane(body: Stated) -> StatedInPlane:
    """A body of a problem of the plane."""
    assert isinstance(body, PLANE)
    return body


class Counted(Protocol):
    """Unknowns that are numbered one after the other."""

    @property
    def count(self) -> int:
        """How many there are."""
        ...


def of_kind(bodies: Mapping[str, object], kind: type[Kind]) -> dict[str, Kind]:
    """The bodies of one kind, by name."""
    return {name: body for name, body in bodies.items() if isinstance(body, kind)}


def rigid_blocks(bodies: Mapping[str, object]) -> dict[str, RigidBlocks]:
    """The assemblies of rigid blocks, in the plane or in space, by name."""
    return {name: body for name, body in bodies.items() if isinstance(body, RigidBlocks)}


def numbered(
    bodies: Mapping[str, Kind], unknowns: Callable[[Kind, int], Own], first: int = 0
) -> dict[str, Own]:
    """The unknowns of bodies of a kind, one after the other from a number on, in their order."""
    found: dict[str, Own] = {}
    for name, body in bodies.items():
        found[name] = unknowns(body, first)
        first += found[name].count
    return found
