"""Dissipation of a strain rate as rows of a cone: the form of criteria (T1)."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from lacore.model.materials.fields import Field, Strengths
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.program.surfaces import Surfaces
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact

PLANE = ("plane_strain", "plane_stress", "axisymmetric")
SPACE = "3d"
KINEMATICS = (*PLANE, SPACE)


@dataclass(frozen=True, repr=False)
class Surface(Compact):
    """Yield surface ``||s|| + slope . p <= strength``, s of the rows, p of the volumetric ones.

    Attributes:
        slope: slope for each of L volumetric rows; each one for all elements, or for each,
            (elements,).
        strength: Pa; for all elements, or for each, shape (elements,), or a function of place.
        normed: whether ``||s||`` counts; if not, it bounds p alone.
        flow: slopes of non-associated flow (T49); None: flow is associated.
    """

    slope: tuple[float | Floats, ...]
    strength: Strengths
    normed: bool = True
    flow: tuple[float | Floats, ...] | None = None


@dataclass(frozen=True, repr=False)
class ConicForm(Compact):
    """Dissipation ``D = bound * ||rows @ eps||`` with ``volumetric @ eps = 0``; or surfaces.

    `eps` is the strain rate in engineering components (xx, yy, gamma_xy), for axisymmetric bodies
    (rr, zz, tt, gamma_rz), in three dimensions (xx, yy, zz, gamma_xy, gamma_yz, gamma_zx), unit
    1/s.

    Attributes:
        rows: cone rows, shape (dim, components).
        volumetric: row of theta = tr eps if it must vanish, else zeros, shape (components,); with
            surfaces all rows whose stresses they depend on, shape (L, components).
        bound: largest norm of the conjugate stress, with surfaces that at zero pressure, Pa; for
            all elements, or for each, (elements,), or a function of place.
        volumetric_factor: factor c such that ``||(rows @ eps, c theta)||`` is proportional to the
            norm of the three-dimensional strain rate deviator also if theta is not zero, as the
            regularised dissipation (T17) requires. It is 0 if the rows are independent of theta,
            and has no effect on forms with surfaces.
        surfaces: surfaces that depend on pressure (T39, T40); if empty, the only condition is
            ``||s|| <= bound``.
        out_of_plane: sigma_zz per mean stress: 1 in plane strain, 0 in plane stress.
        out_of_rows: additional sigma_zz per conjugate stress of the rows, shape (dim,).
    """

    rows: Floats
    volumetric: Floats
    bound: Strengths
    volumetric_factor: float = 0.0
    surfaces: tuple[Surface, ...] = ()
    out_of_plane: float = 1.0
    out_of_rows: tuple[float, ...] = ()

    @property
    def volumes(self) -> Floats:
        """`volumetric` as rows, shape (L, components)."""
        return np.atleast_2d(self.volumetric)

    @property
    def compressible(self) -> bool:
        """Whether the plane velocity may change areas: plane stress, and where friction dilates."""
        return not np.any(self.volumes[self.preserved])

    @property
    def frictional(self) -> bool:
        """Whether flow is non-associated: its slope is smaller than that of a surface (T49)."""
        return any(surface.flow is not None for surface in self.surfaces)

    @property
    def strengths(self) -> list[Strengths]:
        """The bound, and the strengths of the surfaces."""
        return [self.bound, *(surface.strength for surface in self.surfaces)]

    @property
    def varies(self) -> bool:
        """Whether a strength is a `Field`."""
        return any(isinstance(own, Field) for own in self.strengths)

    @property
    def uniform(self) -> bool:
        """Whether all elements have the same strength."""
        slopes = [slope for one in self.surfaces for slope in one.slope]
        same = all(not isinstance(own, Field) and np.ndim(own) == 0 for own in self.strengths)
        return same and all(np.ndim(slope) == 0 for slope in slopes)

    def at_points(self, elements: Ints, values: Callable[[Field], Floats]) -> "ConicForm":
        """Return the form with a strength for each of m points.

        Args:
            elements: elements of the points, shape (m,).
            values: function for values of a field at the points, shape (m,).
        """

        def own(strength: Strengths) -> Floats:
            if isinstance(strength, Field):
                return of_elements(strength.factor, elements) * values(strength)
            return of_elements(strength, elements)

        surfaces = tuple(
            replace(
                one,
                strength=own(one.strength),
                slope=tuple(of_elements(slope, elements) for slope in one.slope),
                flow=None
                if one.flow is None
                else tuple(of_elements(slope, elements) for slope in one.flow),
            )
            for one in self.surfaces
        )
        return replace(self, bound=own(self.bound), surfaces=surfaces)

    @property
    def preserved(self) -> Bools:
        """Volumetric rows that must vanish, as no surface feels their stress, shape (L,)."""
        felt = [[bool(np.any(slope)) for slope in one.slope] for one in self.surfaces]
        return np.asarray(~np.any(felt, axis=0)) if felt else np.ones(1, dtype=bool)

    def surfaces_of(self, elements: Ints) -> Surfaces | None:
        """Return the surfaces at points of elements, shape (m,); None without surfaces."""
        if not self.surfaces:
            return None
        strengths = [of_elements(one.strength, elements) for one in self.surfaces]
        slopes = [
            np.stack([of_elements(own, elements) for own in one.slope], axis=1)
            for one in self.surfaces
        ]
        steepness = np.stack(slopes, axis=1)
        flow = steepness.copy()
        for place, one in enumerate(self.surfaces):
            if one.flow is not None:
                own = [of_elements(slope, elements) for slope in one.flow]
                flow[:, place] = np.stack(own, axis=1)
        return Surfaces(
            slope=steepness,
            strength=np.stack(strengths, axis=1),
            normed=np.array([one.normed for one in self.surfaces], dtype=np.float64),
            flow=flow if self.frictional else None,
        )

    def bounds(self, elements: Ints) -> Floats:
        """Return the bound in elements, of their shape, Pa."""
        return of_elements(self.bound, elements)

    def stress(self, conjugate: Floats, mean: Floats) -> Floats:
        """Return stresses (xx, yy, zz, xy) or (rr, zz, tt, rz), shape (m, 4), Pa, tension positive.

        In three dimensions they are (xx, yy, zz, xy, yz, zx), shape (m, 6).

        Args:
            conjugate: stresses of `rows`, shape (m, dim), Pa.
            mean: stresses of `volumetric`, shape (m L,), Pa; in plane strain also sigma_zz (T1),
                which lies between the others if strength depends on pressure.
        """
        means = mean.reshape(len(conjugate), -1)
        plane = conjugate @ self.rows + means @ self.volumes
        if plane.shape[1] in (4, 6):
            return np.asarray(plane)
        out = self.out_of_plane * means[:, 0]
        if self.out_of_rows:
            out = out + conjugate @ self.out_of_rows
        return np.column_stack([plane[:, :2], out, plane[:, 2]])

    def across(self) -> "ConicForm":
        """Return the form of a layer in which only ``(eps_nn, gamma_nt)`` vary.

        A velocity jump (T23).

        `rows` and `volumetric` act on these two, in three dimensions on ``(eps_nn, gamma_ns,
        gamma_nt)``. The criterion must be isotropic. For a single plane with pressure-dependent
        strength it is ``|tau| <= c - sigma_n tan(phi)`` (T43, T94).

        Raises:
            InputError: several planes, as the layer would have an envelope that is not made of
                planes; or too much friction for slip with opening.
        """
        axes = np.array([0, 3, 5] if self.rows.shape[1] == 6 else [0, 2])
        if self.surfaces:
            return self._layer(axes)
        rows, factor = self.rows[:, axes], self.volumetric_factor
        if not self.compressible:  # eps_nn = theta = 0, which only matters in regularised norms
            factor = float(np.hypot(np.linalg.norm(rows[:, 0]), factor))
            rows = rows * (np.arange(axes.size) > 0)
        return ConicForm(rows[rows.any(axis=1)], self.volumetric[axes], self.bound, factor)

    @property
    def opens(self) -> bool:
        """Whether velocity jumps open as they slip, see `across`: of one plane, not too steep."""
        if len(self.surfaces) != 1 or self.frictional or not self.surfaces[0].normed:
            return False
        return bool(np.all(self._rest > 0))

    @property
    def _rest(self) -> Floats:
        """Square of the slip of a layer that opens by 1, as ``1 - sin(phi)^2``."""
        opening = float(self.rows[:, 0] @ self.rows[:, 0])
        return np.asarray(1 - opening * np.asarray(self.surfaces[0].slope[0]) ** 2)

    def _layer(self, axes: Ints) -> "ConicForm":
        if self.frictional:
            raise InputError(
                "Body.space",
                None,
                "flow is not associated, and velocities that jump have a separate strength (T62)",
                "take 'p2-gauss', in three dimensions 'p2-vertex', or leave dilation_angle at the"
                " friction angle",
            )
        if len(self.surfaces) > 1 or not self.surfaces[0].normed:
            raise InputError(
                "Body.space",
                None,
                "velocities that jump need a criterion that is one cone: cut-offs make the strength"
                " of a layer curved, and plane stress and revolution have none",
                "take 'p2-vertex', or 'p2-gauss'; or MohrCoulomb without cut-offs in plane strain",
            )
        if not self.opens:
            raise InputError(
                "Body.space",
                None,
                "too much friction for velocities that jump: nothing opens fast enough to slip",
                "take 'p2-vertex', or less friction",
            )
        (plane,), cosine = self.surfaces, np.sqrt(self._rest)
        slope, strength = plane.slope[0] / cosine, plane.strength / cosine  # c from c cos(phi)
        return ConicForm(
            rows=np.eye(axes.size)[1:],
            volumetric=np.eye(axes.size)[:1],
            bound=self.bound / cosine,
            surfaces=(Surface((slope,), strength),),
        )


def of_elements(value: Strengths, elements: Ints) -> Floats:
    """Return a value for all elements, or one for each, in elements of any shape."""
    if isinstance(value, Field):
        raise ValueError("a function of place has values at points: see `ConicForm.at_points`")
    if np.ndim(value) == 0:
        return np.full(np.shape(elements), value, dtype=np.float64)
    return np.asarray(np.asarray(value)[elements])
