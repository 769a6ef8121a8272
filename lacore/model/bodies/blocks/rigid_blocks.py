"""Common parts of plane and three-dimensional assemblies of rigid blocks.

A facet of a block is an edge of a polygon, or a plane face of a polyhedron.
"""

from abc import abstractmethod
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, Self

import numpy as np

from lacore.model.bodies.blocks.joints import JointFriction, joint_names
from lacore.model.bodies.pickled import by_arguments
from lacore.model.bodies.touching import Touched
from lacore.model.conditions.loads import Fix, Load, require_no_rotation
from lacore.model.conditions.where import Where
from lacore.model.materials.friction import Friction
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting.errors import InputError, require_known
from lacore.reporting.showing import Compact, Facts, Shown, counted, listed, short, spanned
from lacore.reporting.text import Quantity, Term, text

_DIGITS = 16 * np.finfo(float).eps  # relative accuracy of sums and products of coordinates


class JointPairs(Protocol):
    """Joints of any geometry."""

    @property
    def slave(self) -> Ints:
        """Block numbers, (J,)."""
        ...

    @property
    def master(self) -> Ints:
        """Block numbers, (J,); the master comes first in the assembly."""
        ...

    @property
    def count(self) -> int:
        """Number of joints."""
        ...


@dataclass(frozen=True, eq=False, repr=False)
class CrushingPoints(Compact):
    """Points of joints that crush, in the order of `Joints3D.points`.

    Attributes:
        block: number of the slave, (m,).
        position: places, (3, m), m.
        normal: normals from the master into the slave, (3, m).
        area: areas, (m,), m^2.
        strength: largest pressure, Pa.
    """

    block: Ints
    position: Floats
    normal: Floats
    area: Floats
    strength: float


class RigidBlocks(Shown):
    """Rigid blocks and the joints between them; dataclasses of each dimension add their geometry.

    Attributes:
        blocks: the geometry of each block by name.
        friction: law of all joints.
        joint_friction: other laws for single pairs ``(name, name)``.
        tolerance: distance up to which coordinates count as equal, m.
        names: names of the blocks, (B,).
        centroid: centroids, (d, B), m.
        radius: largest distance of a vertex from the centroid, (B,), m.
        size: diagonal of the bounding box, m.
        joints: see `Joints` and `Joints3D`.
        joint_terms: coefficient, limit, dilatancy and tension of the laws of joints, (4, J).
    """

    dimension: ClassVar[int]
    facet: ClassVar[str]
    """Name of a facet."""
    rim: ClassVar[str]
    """Name of the boundary of facets: blocks that meet only there have no joint."""
    pointwise: ClassVar[bool] = False  # Blocks touch other bodies along facets.
    deforms: ClassVar[bool] = False
    axisymmetric: ClassVar[bool] = False
    friction: float | Friction
    joint_friction: JointFriction | None
    tolerance: float | None
    names: tuple[str, ...]
    centroid: Floats
    radius: Floats
    size: float
    joints: JointPairs
    joint_terms: Floats

    def __reduce__(self) -> tuple[type, tuple[Any, ...]]:
        """Pickle by the arguments."""
        return by_arguments(self)  # type: ignore[arg-type]  # subclasses are dataclasses

    @property
    @abstractmethod
    def box(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner of the bounding box, m, shape (d,) each."""

    @property
    @abstractmethod
    def measure(self) -> Floats:
        """Areas, m^2, or volumes, m^3, of the blocks, (B,)."""

    @property
    @abstractmethod
    def facet_blocks(self) -> Ints:
        """The block of each facet, ascending."""

    @property
    def crushing_points(self) -> CrushingPoints | None:
        """Points of joints of limited compressive strength; None without crushing."""
        return None

    @abstractmethod
    def facets_inside(self, where: Callable[[Floats], Bools], field: str) -> Ints:
        """Return the numbers of the facets that a predicate selects, ascending."""

    @abstractmethod
    def rims(self, facets: Ints) -> tuple[Floats, Floats, Ints]:
        """Return the corners of facets, (d, k), m, their normals, (d, k), and their blocks.

        The shape is (k,).
        """

    @abstractmethod
    def geometry_of(self, facets: Ints) -> tuple[Floats, Floats, Floats]:
        """Centroids, m, and normals of facets, (d, k) each, and lengths, m, or areas, m^2, (k,)."""

    @abstractmethod
    def simplices(self, blocks: Ints) -> tuple[Floats, Floats, Ints]:
        """Return the triangles or tetrahedra that make up blocks.

        Returns:
            corners (d, d + 1, t), m; areas, m^2, or volumes, m^3, (t,), which are negative where a
            simplex lies outside; the block of each, (t,).
        """

    @abstractmethod
    def away(self, place: Floats) -> Floats:
        """Return the distances of a place, (d,), from all blocks, m, (B,); at most 0 inside."""

    @property
    @abstractmethod
    def jointed_facets(self) -> Ints:
        """Numbers of the facets that have a joint, ascending."""

    @property
    @abstractmethod
    def lone_meetings(self) -> tuple[Ints, Ints, Floats]:
        """Pairs of blocks, (k,) each, that meet where no joints keep them apart, and where, m."""

    @abstractmethod
    def check_load(self, load: Load, field: str) -> None:
        """Raise `InputError` if no block carries a load."""

    @abstractmethod
    def check_contact(
        self, field: str, supports: Sequence[Fix], touched: Sequence[Touched]
    ) -> None:
        """Raise `InputError` where contact is not as rigid blocks can carry it."""

    def check_support(self, support: Fix, field: str) -> None:
        """Raise `InputError` where a support cannot hold blocks; it names the `field`."""
        self.outline(support.where, f"{field}.where")
        require_no_rotation(support, field)

    @property
    def contents(self) -> str:
        """Text such as ``13 rigid blocks, 22 joints``."""
        kind = "three-dimensional block" if self.dimension == 3 else "rigid block"
        return f"{counted(len(self.names), kind)}, {counted(self.joints.count, 'joint')}"

    def facts(self) -> Facts:
        """Return the contents, for printing."""
        laws = self.joint_friction or {}
        measure = f"{self.measure.sum():.4g} m^{self.dimension}"
        told = {
            "blocks": listed(self.names, 10),
            "friction": short(self.friction) + (f", {len(laws)} joints differ" if laws else ""),
            "size": f"{measure}, {self.size:.4g} m across",
        }
        return Facts(f"{type(self).__name__}: {self.contents}", told)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """``master|slave``, and ``master|slave#2`` where two blocks share a second joint."""
        return joint_names(self.names, self.joints.master, self.joints.slave)

    @property
    def isolated(self) -> tuple[str, ...]:
        """Names of the blocks that have no joint."""
        jointed = np.zeros(len(self.names), dtype=bool)
        jointed[self.joints.slave] = jointed[self.joints.master] = True
        return tuple(name for name, has in zip(self.names, jointed, strict=True) if not has)

    @property
    def allowed(self) -> float:
        """Distance up to which coordinates count as equal, m."""
        assert self.tolerance is not None  # set in the constructor
        return self.tolerance

    def blocks_of(self, facets: Ints) -> Ints:
        """Return the blocks of facets."""
        return np.asarray(self.facet_blocks[facets])

    def with_points(self, points: Iterable[Sequence[float]]) -> Self:
        """Return the same body, because point forces act anywhere on blocks."""
        return self

    def outline(self, where: Where, field: str) -> Ints:
        """Return the numbers of the facets of the part `where` of the blocks, ascending.

        A name, or a tuple of names, selects whole blocks. A predicate gets coordinates (d, n) and
        returns a mask (n,), see `facets_inside`.

        Raises:
            InputError: an unknown name, nothing selected, or a predicate that fails; it names
                `field`.
        """
        if callable(where):
            chosen = self.facets_inside(where, field)
        elif isinstance(where, str | tuple):
            wanted = (where,) if isinstance(where, str) else where
            for name in wanted:
                require_known(field, name, self.names)
            chosen = np.flatnonzero(np.isin(self.names, wanted)[self.facet_blocks])
        else:
            predicate = Term(f"a function of ({self.dimension}, n)", "places in numbers")
            fix = text("give a name, names, or {}", predicate)
            raise InputError(field, where, "no part of the blocks", fix)
        if chosen.size == 0:
            fix = text(
                "select at least one {}: the blocks lie in {}", self.facet, spanned(*self.box)
            )
            raise InputError(field, None, "an empty outline", fix)
        return chosen


def require_resolved(tolerance: float, coordinates: Floats, field: str) -> float:
    """Return the tolerance of an assembly, m.

    Raises:
        InputError: floating-point coordinates, m, do not resolve it.
    """
    farthest = np.abs(coordinates).max()
    if tolerance < _DIGITS * farthest:
        raise InputError(
            field,
            tolerance,
            text("coordinates as large as {} are not that precise", Quantity(farthest, "m", ".3g")),
            "put the origin near the blocks, or give a larger tolerance",
        )
    return float(tolerance)
