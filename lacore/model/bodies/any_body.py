"""Bodies of any kind: the requirements of problems, and of the assembly of their unknowns.

A new kind is a folder next to this file, and a name in `AnyBody` and in `KINDS`.
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
    """Requirements of a problem on a body, before unknowns are numbered."""

    @property
    def contents(self) -> str:
        """Short text on its contents."""
        ...

    @property
    def dimension(self) -> int:
        """2 or 3."""
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
        """Whether it is axisymmetric, with x as the radius."""
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
        """Raise `InputError` if a part of it has no contact, or none that could hold it."""
        ...

    def with_points(self, points: Iterable[Sequence[float]]) -> Self:
        """Return the body with the nodes it needs where point forces act."""
        ...


class StatedInPlane(Stated, Protocol):
    """Additional requirements on plane bodies."""

    def boundary(self, where: Where, field: str) -> tuple[Ints, Edges]:
        """Return the numbers and geometry of a part of the boundary.

        A node is an edge of length 0.
        """
        ...

    def curves(self, edges: Ints) -> EdgeCurves:
        """Return the edges as curves."""
        ...


class Dofs(Protocol):
    """Unknowns of a body among all, and their velocities and forces."""

    @property
    def body(self) -> Stated:
        """Body of the unknowns."""
        ...

    @property
    def offset(self) -> int:
        """Number of the first."""
        ...

    @property
    def count(self) -> int:
        """Number of unknowns."""
        ...

    @property
    def degree(self) -> int:
        """Degree of the velocity along an edge; 0 for single nodes."""
        ...

    @property
    def strength(self) -> float:
        """Shear stress that it can carry, Pa."""
        ...

    @property
    def extent(self) -> float:
        """Area, or for a frame the square of its size, m^2; in three dimensions volume, m^3."""
        ...

    @property
    def bent(self) -> bool:
        """Whether edges are curves."""
        ...

    @property
    def axisymmetric(self) -> bool:
        """Whether it is axisymmetric."""
        ...

    @property
    def pieces_of_unknowns(self) -> Ints:
        """Which part of the body each unknown moves, from 0, shape (count,)."""
        ...

    def groups(self, name: str, n: int) -> tuple[DissipationGroup, ...]:
        """Return its dissipation over n unknowns."""
        ...

    def force(self, load: Load) -> Floats:
        """Return the forces of a load on its unknowns, (count,), N/m; in three dimensions N."""
        ...

    def parts(self, edges: Ints) -> Ints:
        """Return the numbers that determine velocities at edges or faces.

        Facets, blocks or nodes.
        """
        ...

    def moving(self, parts: Ints) -> Ints:
        """Return the numbers of the parts that move continuously."""
        ...

    def velocity_rows(self, parts: Ints, points: Floats, n: int) -> tuple[Sparse, ...]:
        """Return the rows of u_x, u_y (and u_z) of parts at points.

        The points have the shape (d, k), and each matrix (k, n).
        """
        ...

    def thickness(self, places: Floats) -> Floats:
        """Return the thickness across the plane at places of shape (2, ...), m."""
        ...


class RigidParts(Dofs, Protocol):
    """Unknowns of rigid blocks and frames, with supports of their own kind."""

    def free(self, supports: Iterable[Fix]) -> Sparse:
        """Return a basis of the velocities that supports allow, shape (count, free)."""
        ...

    def support_forces(self, force: Floats, supports: Iterable[Fix]) -> tuple[Floats, Floats]:
        """Return places (d, k), and the forces of supports there for forces on the unknowns.

        They are forces, then moments: (3, k), in three dimensions (6, k).
        """
        ...


PLANE: tuple[type[StatedInPlane], ...] = (Body, BlockAssembly, Frame)
KINDS: tuple[type[Stated], ...] = (*PLANE, BlockAssembly3D)
"""All kinds, in the order of their unknowns; type checkers find missing members here."""


def plane(body: Stated) -> StatedInPlane:
    """Return a body of a plane problem."""
    assert isinstance(body, PLANE)
    return body


class Counted(Protocol):
    """Unknowns that are numbered one after the other."""

    @property
    def count(self) -> int:
        """Number of unknowns."""
        ...


def of_kind(bodies: Mapping[str, object], kind: type[Kind]) -> dict[str, Kind]:
    """Return the bodies of one kind, by name."""
    return {name: body for name, body in bodies.items() if isinstance(body, kind)}


def rigid_blocks(bodies: Mapping[str, object]) -> dict[str, RigidBlocks]:
    """Return the plane and three-dimensional assemblies of rigid blocks, by name."""
    return {name: body for name, body in bodies.items() if isinstance(body, RigidBlocks)}


def numbered(
    bodies: Mapping[str, Kind], unknowns: Callable[[Kind, int], Own], first: int = 0
) -> dict[str, Own]:
    """Return the unknowns of bodies of a kind, numbered in their order from a number on."""
    found: dict[str, Own] = {}
    for name, body in bodies.items():
        found[name] = unknowns(body, first)
        first += found[name].count
    return found
