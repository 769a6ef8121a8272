"""Automatic remeshing: before distorted elements are inverted (T31)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from skfem import Mesh

from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.meshes.curved import signed_jacobians
from lacore.model.meshes.renewal.outline import remeshed
from lacore.model.meshes.renewal.sizes import element_sizes
from lacore.model.meshes.renewal.triangles import load_gmsh
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError, require_known, require_positive
from lacore.reporting.showing import Compact

_TRIANGLE = np.array([[1.0, -1 / np.sqrt(3)], [0.0, 2 / np.sqrt(3)]])
"""Takes the triangle of reference to the equilateral one: the inverse of that map is needed."""

Point = tuple[float, float]

_ROUNDS = 3  # of sizes that are scaled to keep the number of elements
_CLOSE = 0.1  # of that number


@dataclass(frozen=True, repr=False)
class Remeshing(Compact):
    """Make new meshes when elements become distorted: triangles, with Gmsh (extra ``gmsh``).

    With Gmsh, the outlines of bodies and of their regions stay, with names and corners, ends of
    contact with obstacles, vertices with a `PointForce` or a `PointTravel`, and the edges of bonded
    boundaries. New vertices lie on the old outlines, and areas stay the same unless this would
    invert an element.
    A new mesh is made before a step if the quality of an element, its mean ratio, has decreased to
    less than `quality` times that at the beginning of the path or at the last remeshing, and if the
    next step would invert an element.

    Attributes:
        size: length of edges, m, or one for each body by name; None: new elements are as large as
            the old ones at the same place, and about as many.
        quality: ratio below which a new mesh is made, between 0 and 1.
        mesher: a function that makes the meshes instead of Gmsh, from the problem on the current
            shape, see `lacore.paths.renewal.remeshing.Remesh`.

    Example:
        >>> remesh = la.Remeshing(quality=0.3)  # as `remesh` of `lacore.sequential`
    """

    size: float | Mapping[str, float] | None = None
    quality: float = 0.3
    mesher: Callable[[Problem], Mapping[str, Mesh]] | None = None

    def __post_init__(self) -> None:
        if self.mesher is not None and self.size is not None:
            raise InputError(
                "Remeshing.size",
                self.size,
                "the function `mesher` decides on the sizes",
                "leave out `size` or `mesher`",
            )
        named = self.size.items() if isinstance(self.size, Mapping) else [("", self.size)]
        for name, size in named:
            if size is not None:
                field = f"Remeshing.size[{name!r}]" if name else "Remeshing.size"
                require_positive(field, size)
        if not 0 < self.quality < 1:
            raise InputError(
                "Remeshing.quality",
                self.quality,
                "not between 0 and 1, where 1 is the quality of the mesh at the beginning",
                "give a ratio such as 0.3",
            )

    def __call__(
        self,
        problem: Problem,
        bodies: Sequence[str] = (),
        keep: Mapping[str, Sequence[Point]] = MappingProxyType({}),
    ) -> Mapping[str, Mesh]:
        """Return new meshes.

        Args:
            problem: on the current shape.
            bodies: names of those that get a new mesh; by default all deformable ones.
            keep: vertices that stay, by body, in addition to those with a `PointForce`.

        Raises:
            InputError: Gmsh fails; see `check`.
        """
        if self.mesher is not None:
            return self.mesher(problem)
        self.check(problem)
        deforming = of_kind(problem.bodies, Body)
        return {
            name: self._made(name, deforming[name], problem, keep.get(name, ()))
            for name in (bodies or deforming)
        }

    def check(self, problem: Problem) -> None:
        """Raise `InputError`: Gmsh is missing, a size of no body."""
        if self.mesher is not None:
            return
        deforming = of_kind(problem.bodies, Body)
        if isinstance(self.size, Mapping):
            for name in self.size:
                require_known("Remeshing.size", name, deforming)
        load_gmsh()

    def distorted(self, before: Mapping[str, Mesh], now: Mapping[str, Mesh]) -> list[str]:
        """Return the names of the bodies in which an element is below the quality.

        Args:
            before: meshes at the beginning, or just made, by body.
            now: the same meshes on the current shape.
        """
        return [
            name
            for name, mesh in now.items()
            if not np.all(mean_ratios(mesh) >= self.quality * mean_ratios(before[name]))
        ]

    def _made(self, name: str, body: Body, problem: Problem, keep: Sequence[Point]) -> Mesh:
        points = [load.point for load in problem.loads.values() if load.body == name]
        keep = [*keep, *((point[0], point[1]) for point in points if point is not None)]
        bonded = [
            str(where)
            for interface in problem.interfaces
            if interface.bonded and interface.obstacle is None
            for body, where in interface.sides
            if body == name
        ]
        regions = [region.name for region in body.regions if region.name]
        size = self.size.get(name) if isinstance(self.size, Mapping) else self.size
        if size is not None:
            return remeshed(body.mesh, size, keep, bonded, regions)
        return _alike(body.mesh, keep, bonded, regions)


def _alike(
    mesh: Mesh, keep: Sequence[Point], bonded: Sequence[str], regions: Sequence[str]
) -> Mesh:
    """A mesh with elements as large as before; a quadrilateral becomes two triangles."""
    sizes, factor = element_sizes(mesh), 1.0
    count = mesh.nelements * (len(mesh.t) - 2)

    def scaled(points: Floats) -> Floats:
        return factor * sizes(points)

    new = remeshed(mesh, scaled, keep, bonded, regions)
    for _ in range(_ROUNDS):
        if abs(new.nelements / count - 1) <= _CLOSE:
            break
        factor *= float(np.sqrt(new.nelements / count))
        new = remeshed(mesh, scaled, keep, bonded, regions)
    return new


def mean_ratios(mesh: Mesh) -> Floats:
    """Compute the mean ratio of each element, the least at its vertices and midside nodes.

    It is ``2 det J / ||J||^2`` of the map from the equilateral triangle, or from the square: 1 for
    these shapes, 0 where an element is degenerate, negative where it is inverted at a node.

    Args:
        mesh: of triangles or quadrilaterals, edges straight or curved.

    Returns:
        Array of shape (elements,).
    """
    corners = mesh.elem.refdom.p
    middles = (corners + np.roll(corners, -1, axis=1)) / 2
    jacobian = np.asarray(mesh.mapping().DF(np.hstack([corners, middles])))
    if corners.shape[1] == 3:
        jacobian = np.einsum("ijep,jk->ikep", jacobian, _TRIANGLE)
    determinant = jacobian[0, 0] * jacobian[1, 1] - jacobian[0, 1] * jacobian[1, 0]
    ratios = 2 * determinant / np.sum(jacobian**2, axis=(0, 1))
    turn = np.sign(signed_jacobians(mesh).sum(axis=1))
    return np.asarray((ratios * turn[:, None]).min(axis=1))
