"""Bodies of any kind: what a problem asks of them, and what assembling asks of their unknowns.

A new kind is a folder beside this file, and a line in `KINDS`.
"""

from collections.abc import Callable, Iterable, Mapping
from typing import Any, Protocol, TypeVar

from lacore.arrays import Floats, Ints, Sparse
from lacore.bodies.blocks.block_assembly import BlockAssembly
from lacore.bodies.blocks.dofs import RigidDofs
from lacore.bodies.continuum.body import Body
from lacore.bodies.continuum.dofs import BodyDofs
from lacore.bodies.frames.dofs import FrameDofs
from lacore.bodies.frames.frame import Frame
from lacore.bodies.touching import Edges
from lacore.conditions.loads import Fix, Load
from lacore.conditions.where import Where
from lacore.meshes.curved import EdgeCurves
from lacore.program import DissipationGroup

AnyBody = Body | BlockAssembly | Frame
Kind = TypeVar("Kind", Body, BlockAssembly, Frame)


class Stated(Protocol):
    """What a problem asks of a body; nothing of it is numbered."""

    @property
    def contents(self) -> str:
        """What it consists of, in a few words."""
        ...

    @property
    def size(self) -> float:
        """Diagonal of its bounding box, m."""
        ...

    @property
    def allowed(self) -> float:
        """Distance up to which coordinates count as one, m."""
        ...

    def boundary(self, where: Where, field: str) -> tuple[Ints, Edges]:
        """Numbers and geometry of a part of the boundary; a node is an edge of length 0."""
        ...

    def curves(self, edges: Ints) -> EdgeCurves:
        """Edges as curves."""
        ...

    def check_load(self, load: Load, field: str) -> None:
        """Raise `InputError` where it cannot carry a load."""
        ...

    def check_support(self, support: Fix, field: str) -> None:
        """Raise `InputError` where a support cannot hold it."""
        ...


class Dofs(Protocol):
    """The unknowns of a body among all, and what they do."""

    @property
    def body(self) -> AnyBody:
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
        """Area, of a frame the square of its size, m^2."""
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
        """Forces of a load on its unknowns, shape (count,), N/m."""
        ...

    def parts(self, edges: Ints) -> Ints:
        """What velocities at edges are told by: facets themselves, blocks, nodes."""
        ...

    def moving(self, parts: Ints) -> Ints:
        """What of it moves continuously, by number."""
        ...

    def velocity_rows(self, parts: Ints, points: Floats, n: int) -> tuple[Sparse, Sparse]:
        """Rows of u_x and u_y of parts at points of shape (2, k), each of shape (k, n)."""
        ...

    def thickness(self, places: Floats) -> Floats:
        """Across the plane at places of shape (2, ...), m."""
        ...


class RigidParts(Dofs, Protocol):
    """Of bodies with unknowns of their own supports: rigid blocks and frames."""

    def free(self, supports: Iterable[Fix]) -> Sparse:
        """Basis of the velocities that supports leave free, shape (count, free)."""
        ...


KINDS: Mapping[type, Callable[[Any, int], Dofs]] = {
    Body: BodyDofs.at,
    BlockAssembly: RigidDofs,
    Frame: FrameDofs,
}
"""Bodies, and their unknowns from a number on: in this order among all."""


def of_kind(bodies: Mapping[str, object], kind: type[Kind]) -> dict[str, Kind]:
    """The bodies of one kind, by name."""
    return {name: body for name, body in bodies.items() if isinstance(body, kind)}


def numbered(bodies: Mapping[str, AnyBody], kind: type, first: int) -> dict[str, Any]:
    """The unknowns of the bodies of a kind, one after the other from a number on."""
    found: dict[str, Dofs] = {}
    for name, body in of_kind(bodies, kind).items():
        found[name] = KINDS[kind](body, first)
        first += found[name].count
    return found
