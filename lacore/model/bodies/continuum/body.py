"""Deformable bodies: a mesh, a criterion, kinematics and a velocity space."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, singledispatch
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from skfem import MeshQuad, MeshTet, MeshTri
from skfem.mesh import MeshTet1, MeshTri1

from lacore.model.bodies.continuum.body_forces import force_field
from lacore.model.bodies.continuum.boundaries import (
    allowed,
    boundary_facets,
    facet_geometry,
    vertex_at,
)
from lacore.model.bodies.continuum.locking import crossed_quadrilaterals
from lacore.model.bodies.continuum.regions.region import Region
from lacore.model.bodies.continuum.regions.stated import regions_of
from lacore.model.bodies.continuum.spaces import VelocitySpace, spaces_of
from lacore.model.bodies.continuum.water import in_pores, on_facets
from lacore.model.bodies.touching import Edges, Touched
from lacore.model.conditions.body_forces import BodyForce
from lacore.model.conditions.footings import Footing, RigidFooting, Twist
from lacore.model.conditions.loads import Fix, Load, PointForce, SurfaceLoad, require_no_rotation
from lacore.model.conditions.water import PorePressure, StandingWater
from lacore.model.conditions.where import Where
from lacore.model.materials.conic_form import KINEMATICS, SPACE
from lacore.model.materials.criterion import Criterion
from lacore.model.meshes.checks import check_mesh
from lacore.model.meshes.curved import EdgeCurves, edge_curves, vertices
from lacore.model.meshes.files.notes import notes_of
from lacore.model.meshes.solid.checks import check_tetrahedra
from lacore.model.meshes.solid.roundness import outline_of
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting import views
from lacore.reporting.errors import InputError, require_known
from lacore.reporting.showing import Facts, Picture, Shown, counted, listed, short
from lacore.reporting.text import Term, join, text

_TRIANGLES = Term(
    "skfem.MeshTri (of curved boundaries: straight edges, geometry='approximated', or"
    " space='p2-gauss' on a MeshTri2; of quadrilaterals: mesh.to_meshtri(style='x'), or"
    " space='q2'; of files: read(elements='triangles'))",
    'mesh of straight triangles: { file = ..., elements = "triangles" } (or space = "q2" of'
    ' quadrilaterals, "p2-gauss" of curved triangles)',
)
_QUADRILATERALS = Term("skfem.MeshQuad", 'mesh of shape = "quadrilaterals"')

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_NEAR = 1e-9  # by the size of the body: coordinates in double precision agree to this

GEOMETRIES = ("exact", "approximated")


@dataclass(frozen=True, repr=False)
class Body(Shown):
    """A continuum body.

    Attributes:
        mesh: straight-edged triangles (`skfem.MeshTri`), boundaries named; for the space ``q2``
            convex quadrilaterals (`skfem.MeshQuad`). ``p2-gauss`` and ``q2`` also take
            isoparametric meshes, whose edges are curves through their midside nodes
            (`skfem.MeshTri2`, `skfem.MeshQuad2`; T31). Three-dimensional bodies have tetrahedra
            (`skfem.MeshTet`).
        criterion: yield criterion: `VonMises`, or a user-defined one with the four members of
            `lacore.model.materials.criterion.Criterion`; or one for each region, by the names of
            ``mesh.subdomains``: ``{"fill": ..., "clay": ...}``, each element in one of them.
        kinematics: ``plane_strain`` or ``plane_stress``, unit thickness; or ``axisymmetric``, about
            the axis y = z, for a section with the radius x = r >= 0 (T27):
            forces, areas and volumes are those of the whole circumference ``2 pi r``, u_r = 0 on
            the axis holds automatically; spaces ``p2-gauss`` and ``q2``; or ``3d``, tetrahedra
            (T89, T90), spaces ``p2-vertex``, ``p2-disc`` and ``p1-disc``.
        space: velocity space. Strict upper bounds: ``p2-vertex`` (T22), ``p2-disc`` and
            ``p1-disc`` with velocity jumps between elements (T23), ``p1`` where it does not lock.
            More accurate than bounds: ``p2-gauss``, ``q2`` (T22, T24).
        geometry: ``exact``, or ``approximated`` where straight edges replace a curved boundary:
            then no value is called a bound. None: the value set by the builder of the mesh, such as
            `lacore.model.meshes.quarter_ring`; else ``approximated`` where the outline turns by
            small angles at three corners in a row, like a polygon in place of an arc. Use ``exact``
            for an intended polygon.

    Raises:
        InputError: wrong mesh type, a mesh that `check_mesh` rejects, unknown names, a space that
            locks on the mesh; regions that are missing in the mesh, overlap, or leave out elements;
            strengths that are negative somewhere, or have another number of elements.

    Example:
        >>> mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2)
        >>> plate = la.Body(mesh, la.VonMises(shear_strength=20e3), kinematics="plane_stress")
        >>> plate.mesh.nelements
        32
    """

    mesh: MeshTri | MeshQuad | MeshTet
    criterion: Criterion | Mapping[str, Criterion]
    kinematics: str = "plane_strain"
    space: str = "p2-vertex"
    geometry: str | None = None
    pointwise: ClassVar[bool] = False  # It touches others along edges.
    deforms: ClassVar[bool] = True

    def __post_init__(self) -> None:
        require_known("Body.kinematics", self.kinematics, KINEMATICS)
        spaces = spaces_of(self.kinematics)
        require_known("Body.space", self.space, spaces)
        if self.geometry is not None:
            require_known("Body.geometry", self.geometry, GEOMETRIES)
        space = spaces[self.space]
        if self.axisymmetric and space.strict:
            raise InputError(
                "Body.space",
                self.space,
                "no axisymmetric bodies: bounds need strain rates that are linear in elements, and"
                " the vertex rule has a motion without energy at the axis",
                "take 'p2-gauss', or 'q2' on quadrilaterals",
            )
        self.check_elements(space)
        if self.geometry is None:
            object.__setattr__(self, "geometry", outline_of(self.mesh))
        if self.axisymmetric:
            _check_radii(self)
        if isinstance(self.criterion, Mapping):
            object.__setattr__(self, "criterion", dict(self.criterion))
        incompressible = any(not region.form.compressible for region in self.regions)
        if space.locks and incompressible and not crossed_quadrilaterals(self.mesh):
            raise InputError(
                "Body.space",
                self.space,
                "locks: on this mesh triangles of constant strain cannot flow at constant volume,"
                " and load factors would be far too high",
                text(
                    "take 'p1-disc' or 'p2-vertex', or cut all quadrilaterals along both diagonals"
                    " ({})",
                    Term("lacore.model.meshes.rectangle(crossed=True)", "crossed = true"),
                ),
            )

    def check_elements(self, space: VelocitySpace) -> None:
        """Raise `InputError` for a mesh that does not fit the space, or that no body can have."""
        _check_mesh(self.mesh, space)

    @property
    def contents(self) -> str:
        """``576 triangles, plane_strain, p2-vertex, k = 1 Pa``."""
        if self.dimension == 3:
            return text("{} tetrahedra, {}, {}", self.mesh.nelements, self.space, self.label)
        elements = counted(
            self.mesh.nelements, "triangle" if len(self.mesh.t) == 3 else "quadrilateral"
        )
        return text("{}, {}, {}, {}", elements, self.kinematics, self.space, self.label)

    def facts(self) -> Facts:
        """Return the contents, for printing."""
        lengths = " by ".join(
            f"{low:.4g} to {high:.4g} m" for low, high in zip(*self.box, strict=True)
        )
        told = {
            **self._criteria(),
            "size": f"{self.mesh.nvertices} vertices, {lengths}, geometry {self.geometry}",
            "boundaries": listed(self.mesh.boundaries or {}, 12) or "none has a name",
        }
        if notes := notes_of(self.mesh):
            told["file"] = "; ".join(notes)
        return Facts(f"Body: {self.contents}", told)

    def picture(self) -> Picture:
        """Return a picture of its mesh."""
        return Picture(self.plot())

    def plot(self) -> Figure:
        """Plot its mesh with the names of boundaries: see `lacore.pictures.mesh.plot_body`."""
        return views.picture(self)

    @cached_property
    def regions(self) -> tuple[Region, ...]:
        """Its parts by criterion; one part of all elements if there is one criterion."""
        return regions_of(self.mesh, self.criterion, self.kinematics)

    @property
    def label(self) -> str:
        """The strengths of its criteria: ``k = 1 Pa``, ``fill: k = 1 Pa; clay: k = 2 Pa``."""
        told = [(region.name, region.label) for region in self.regions]
        return join("; ", (text("{}: {}", *own) if own[0] else own[1] for own in told))

    def _criteria(self) -> dict[str, str]:
        """Return the facts of each region, for printing."""
        told = {}
        for region in self.regions:
            title = f"criterion of {region.name}" if region.name else "criterion"
            told[title] = region.told or short(region.criterion)
            if share := region.without_effect:
                where = f"in {share:.0%} of {region.name or 'its elements'}"
                told["without effect"] = f"tension_cutoff, beyond the apex {where}"
        return told

    @property
    def pressure_dependent(self) -> bool:
        """Whether the strength of a region depends on pressure."""
        return any(region.form.surfaces for region in self.regions)

    @property
    def bounded(self) -> bool:
        """Whether its strengths are known everywhere, as bounds need."""
        return all(region.bounded for region in self.regions)

    @property
    def largest_shear(self) -> float:
        """Largest shear stress at any pressure, Pa; inf with friction."""
        return max(region.largest_shear for region in self.regions)

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return 3 if self.kinematics == SPACE else 2

    @property
    def axisymmetric(self) -> bool:
        """Whether x is the radius r >= 0 and y the axis z."""
        return self.kinematics == "axisymmetric"

    def thickness(self, places: Floats) -> Floats:
        """Return the thickness at places of shape (d, ...).

        1, or the circumference ``2 pi r``, m.
        """
        return 2 * np.pi * places[0] if self.axisymmetric else np.ones_like(places[0])

    @property
    def box(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner of the bounding box of its vertices, m, shape (d,) each."""
        return self.mesh.p.min(axis=1), self.mesh.p.max(axis=1)

    @property
    def size(self) -> float:
        """Diagonal of the bounding box, the length that tolerances refer to."""
        return float(np.linalg.norm(np.ptp(self.mesh.p, axis=1)))

    @property
    def allowed(self) -> float:
        """Distance up to which coordinates count as one, m."""
        return allowed(self.mesh)

    def boundary(self, where: Where, field: str) -> tuple[Ints, Edges]:
        """Return the facets of a part of the boundary, and their chords.

        Errors name the `field`.
        """
        facets = boundary_facets(self.mesh, where, field)
        return facets, Edges(*facet_geometry(self.mesh, facets))

    def curves(self, facets: Ints) -> EdgeCurves:
        """Return the facets as curves."""
        return edge_curves(self.mesh, facets)

    def check_load(self, load: Load, field: str) -> None:
        """Raise `InputError` where it cannot carry a load; it names the `field`."""
        check_load(load, self, field)

    def with_points(self, points: Iterable[Sequence[float]]) -> Body:
        """Return the same body, because point forces act at its vertices."""
        return self

    def check_contact(
        self, field: str, supports: Sequence[Fix], touched: Sequence[Touched]
    ) -> None:
        """Do nothing, because a contact or support at any part holds all of it."""

    def check_support(self, support: Fix, field: str) -> None:
        """Raise `InputError` where a support cannot hold it; it names the `field`."""
        boundary_facets(self.mesh, support.where, f"{field}.where")
        require_no_rotation(support, field)


def on_axis(body: Body, places: Floats) -> Bools:
    """Return which places of shape (2, ...) lie on the axis of an axisymmetric body."""
    near = np.abs(places[0]) <= _NEAR * body.size
    return np.asarray(near & body.axisymmetric)


def _check_radii(body: Body) -> None:
    mesh = body.mesh
    curves = edge_curves(mesh, mesh.boundary_facets())
    places = np.concatenate([vertices(mesh), curves.middle + curves.bulge], axis=1)
    outside = np.flatnonzero(places[0] < -_NEAR * body.size)
    if outside.size:
        place = places[:, outside[np.argmin(places[0, outside])]]
        raise InputError(
            "Body.mesh",
            float(place[0]),
            f"a radius below 0, near ({place[0]:.6g}, {place[1]:.6g}): x is the radius r of an"
            " axisymmetric body",
            "give the half of the section at x >= 0, its axis at x = 0",
        )


def _check_mesh(mesh: MeshTri | MeshQuad | MeshTet, space: VelocitySpace) -> None:
    if space.mesh is MeshTet1:
        if type(mesh) is not MeshTet1:
            raise InputError(
                "Body.mesh",
                type(mesh).__name__,
                "in three dimensions only straight-edged tetrahedra are supported",
                "give a skfem.MeshTet, such as lacore.model.meshes.box makes",
            )
        check_tetrahedra(mesh, "Body.mesh")
        return
    if type(mesh) not in (space.mesh, space.curved):
        triangles = space.mesh is MeshTri1
        wanted = "straight-edged triangles" if triangles else "quadrilaterals"
        fix = (
            text("give a {}", _TRIANGLES)
            if triangles
            else text("give a {}, or another space", _QUADRILATERALS)
        )
        raise InputError(
            "Body.mesh",
            type(mesh).__name__,
            f"only {wanted} are taken by the space {space.name!r}",
            fix,
        )
    check_mesh(mesh, "Body.mesh")


@singledispatch
def check_load(load: Load, body: Body, field: str) -> None:
    """Raise `InputError` where a body cannot carry a load; it names the `field` of the load."""
    raise TypeError(f"not a load: {type(load).__name__}")


@check_load.register(SurfaceLoad)
@check_load.register(RigidFooting)
@check_load.register(Twist)
def _check_boundary(load: SurfaceLoad | Footing, body: Body, field: str) -> None:
    boundary_facets(body.mesh, load.where, f"{field}.where")


@check_load.register(PointForce)
def _check_point(load: PointForce, body: Body, field: str) -> None:
    vertex_at(body.mesh, load.at, f"{field}.at")


@check_load.register(BodyForce)
def _check_volume(load: BodyForce, body: Body, field: str) -> None:
    force_field(load, body.mesh, field)


@check_load.register(PorePressure)
def _check_pores(load: PorePressure, body: Body, field: str) -> None:
    _require_plane(body, field)
    if body.kinematics == "plane_stress":
        raise InputError(
            f"{field}.body",
            load.body,
            "plane stress: what is free to grow across the plane has no water to hold in",
            "take kinematics='plane_strain'",
        )
    in_pores(load, body.mesh, field)


@check_load.register(StandingWater)
def _check_standing(load: StandingWater, body: Body, field: str) -> None:
    _require_plane(body, field)
    facets = boundary_facets(body.mesh, load.where, f"{field}.where")
    on_facets(load, body.mesh, facets, field)


def _require_plane(body: Body, field: str) -> None:
    if body.dimension == 3:
        raise InputError(
            f"{field}.body", None, "no water in bodies of tetrahedra", "take a plane body"
        )
