"""Cross-sections of members: plastic moments, N-M polygons, struts, by dimensions and by name.

Strengths are per unit thickness of the frame, N and N/m; of a single frame read N m and N. Moment
and axial force interact by the exact plastic stress distributions of the section: with the neutral
axis at a distance y from its middle, the closer part carries the axial force and the rest the
moment, ``N(y) = f A(y)`` and ``M(y) = f S(y)``. The curve is replaced by a polygon inside it, whose
load factors are safe, or around it.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from lacore.model.bodies.frames.profiles import PROFILES, Profile
from lacore.model.bodies.frames.section import OUTER, SIDES, Corners, Section
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import (
    InputError,
    is_number,
    is_plane_vector,
    require_count,
    require_known,
    require_positive,
    require_range,
    suggest,
)

__all__ = [
    "Section",
    "bar",
    "fibres",
    "i_section",
    "plastic",
    "polygon",
    "rectangle",
    "rigid",
    "standard",
]

LAYERS = 8


def plastic(plastic_moment: float, hogging: float | None = None) -> Section:
    """Return a plastic moment for any axial force, equal to ``plastic_moment=`` of a frame.

    Args:
        plastic_moment: moment in sagging, with tension on the right of the member, seen from its
            first node: below a beam that is drawn from left to right.
        hogging: moment in the other sense; equal if None, 0 without strength.

    Example:
        >>> la.sections.plastic(100e3).plastic_moment
        100000.0
    """
    require_positive("plastic_moment", plastic_moment)
    upper = ((-inf, float(plastic_moment)), (inf, float(plastic_moment)))
    if hogging is None:
        return Section(upper, "M_p")
    if not (is_number(hogging) and hogging >= 0):
        raise InputError("hogging", hogging, "not a strength", "give N m per m, or leave it out")
    require_range("hogging", hogging)
    return Section(upper, "M_p", ((-inf, -float(hogging)), (inf, -float(hogging))))


def polygon(points: Sequence[Sequence[float]], name: str = "polygon") -> Section:
    """Return the convex polygon around pairs (N, M) that a section can carry, in any order.

    The strength is convex, so it is safe to join computed values, or values from a diagram.

    Args:
        points: N/m, tension positive, and N, positive in sagging (see `plastic`).
        name: name for messages and tables.

    Example:
        >>> la.sections.polygon([(1, 0), (0, 1), (-1, 0), (0, -1)]).plastic_moment
        1.0
    """
    if not isinstance(points, Sequence | np.ndarray) or not all(map(is_plane_vector, points)):
        raise InputError("points", points, "not pairs (N, M)", "give [(N, M), ...], finite numbers")
    for point in points:
        require_range("points", *point)
    given = np.array(points, dtype=np.float64).reshape(-1, 2)
    largest = np.abs(given).max(axis=0, initial=np.finfo(float).tiny)
    try:
        corners = given[ConvexHull(given / largest).vertices]
    except (QhullError, ValueError):
        raise InputError(
            "points",
            [tuple(own) for own in given.tolist()],
            "enclose nothing",
            "give three that are not in line; of axial force alone take bar(), of moment plastic()",
        ) from None
    # The corners are anticlockwise from the lower one of the leftmost: first the lower side.
    corners = np.roll(corners, -np.lexsort(corners.T[::-1])[0], axis=0)
    last = np.flatnonzero(corners[:, 0] == corners[:, 0].max())
    lower, upper = corners[: last[0] + 1], corners[last[-1] :][::-1]
    if upper[0, 0] > lower[0, 0]:
        upper = np.concatenate([lower[:1], upper])
    return Section(tuple(map(tuple, upper.tolist())), name, tuple(map(tuple, lower.tolist())))


def fibres(parts: Sequence[Sequence[float]], name: str = "fibres") -> Section:
    """Return a section of fibres, or of strips: reinforced concrete, tees, masonry.

    Strips yield as a whole at their centroids. For a solid section the corners of the polygon then
    lie on the exact curve, and the polygon is safe.

    Args:
        parts: ``(y, tension, compression)`` of each fibre: height above the axis of the member, m,
            to its left seen from the first node, and its strengths, N/m.
        name: name for messages and tables.

    Example:
        >>> two = la.sections.fibres([(0.05, 10e3, 10e3), (-0.05, 10e3, 10e3)])
        >>> round(two.plastic_moment, 3)
        1000.0
    """
    y, tension, compression = _read_fibres(parts)
    bears = tension + compression > 0
    if not bears.any():
        raise InputError("parts", parts, "fibres that bear nothing", "give strengths")
    y, both = y[bears], (tension + compression)[bears]
    first = np.array([-compression.sum(), float(np.sum(y * compression[bears]))])
    chains = []
    for order in (np.argsort(y, kind="stable"), np.argsort(-y, kind="stable")):
        steps = np.stack([both, -y * both], axis=1)[order]
        chains.append(np.concatenate([first[None], first + np.cumsum(steps, axis=0)]))
    upper, lower = chains
    lower[-1] = upper[-1]  # the same sums up to round-off
    return Section(tuple(map(tuple, upper.tolist())), name, tuple(map(tuple, lower.tolist())))


def _read_fibres(parts: Sequence[Sequence[float]]) -> Floats:
    """Return heights and strengths of fibres, (3, n); raises `InputError` if they are invalid."""
    shown = list(parts) if isinstance(parts, Sequence | np.ndarray) else parts
    good = isinstance(shown, list) and all(len(part) == 3 for part in shown if np.ndim(part) == 1)
    if not (good and shown and all(np.ndim(part) == 1 for part in shown)):
        fix = "give [(y, tension, compression), ...], m and N/m"
        raise InputError("parts", parts, "not fibres", fix)
    for y, tension, compression in shown:
        if not (is_number(y) and all(is_number(s) and s >= 0 for s in (tension, compression))):
            raise InputError(
                "parts", (y, tension, compression), "no fibre", "give a place and strengths >= 0"
            )
        require_range("parts", y, tension, compression)
    return np.array(shown, dtype=np.float64).T


def rigid() -> Section:
    """Return a section that never yields: an arm, a plate, a pier.

    Example:
        >>> la.sections.rigid().plastic_moment
        inf
    """
    return Section(((-inf, inf), (inf, inf)), "rigid")


def bar(tension: float = inf, compression: float | None = None) -> Section:
    """Return a pin-ended strut with axial strength alone, N/m; rigid by default.

    It carries no moment, so its members take no loads along them, and have their ends at nodes.

    Args:
        tension: strength; 0 for a prop that only carries compression.
        compression: equal to tension if None; smaller for buckling, 0 for a cable.

    Example:
        >>> la.sections.bar(tension=10e3).plastic_moment
        0.0
    """
    compression = tension if compression is None else compression
    if tension != inf or compression != inf:
        for name, value in (("tension", tension), ("compression", compression)):
            if not (is_number(value) and value >= 0):
                fix = "give N/m; of one that is far above the other a number, too"
                raise InputError(name, value, "not a strength", fix)
            require_range(name, value)
        if not tension + compression > 0:
            raise InputError("tension", tension, "a bar that bears nothing", "leave it out")
    return Section(((-float(compression), 0.0), (float(tension), 0.0)), "bar")


def rectangle(
    width: float, height: float, yield_stress: float, layers: int = LAYERS, polygon: str = "inner"
) -> Section:
    """Return a solid rectangle: M_p = f b h^2/4, ``M/M_p = 1 - (N/N_p)^2``.

    Args:
        width, height: m; it bends over its height.
        yield_stress: f, Pa.
        layers: number of sides of the polygon between N = 0 and N_p.
        polygon: ``inner``: its corners lie on the curve; ``outer``: its sides touch it.

    Example:
        >>> round(la.sections.rectangle(0.1, 0.2, yield_stress=235e6).plastic_moment)  # b h^2/4
        235000
    """
    for name, value in (("width", width), ("height", height), ("yield_stress", yield_stress)):
        require_positive(name, value)
    require_count("layers", layers)
    stations = np.linspace(0.0, height / 2, layers + 1)
    area, moment = 2 * width * stations, width * (height**2 / 4 - stations**2)
    name = f"rectangle {width:g} x {height:g}"
    return _of_curve(stations, yield_stress * area, yield_stress * moment, polygon, name)


def i_section(
    height: float,
    width: float,
    web: float,
    flange: float,
    fillet: float,
    yield_stress: float,
    layers: int = LAYERS,
    polygon: str = "inner",
) -> Section:
    """Return an I-section with parallel flanges, bent about its strong axis; lengths in m.

    Args:
        height, width: overall dimensions.
        web, flange: thicknesses.
        fillet: radius between them, 0 if welded.
        yield_stress: Pa.
        layers: number of sides of the polygon between N = 0 and N_p, half of them for web and
            flange each.
        polygon: ``inner`` or ``outer``, see `rectangle`.

    Example:
        >>> section = la.sections.i_section(
        ...     height=0.3, width=0.15, web=0.0071, flange=0.0107, fillet=0.015, yield_stress=235e6
        ... )
        >>> round(section.plastic_moment / 1e3)  # kN m
        148
    """
    profile = Profile(height, width, web, flange, fillet)
    return _of_profile(profile, yield_stress, layers, polygon, f"I {height:g} x {width:g}")


def standard(
    name: str, yield_stress: float, layers: int = LAYERS, polygon: str = "inner"
) -> Section:
    """Return a rolled section by its name: "IPE 300", "HEA 200", bent about its strong axis.

    Dimensions are those of EN 10365 (IPE of 80 to 600 mm, HEA of 100 to 300).

    Args:
        name: name with or without the space.
        yield_stress: Pa; 235e6, 275e6 or 355e6 for S235, S275 or S355.
        layers, polygon: see `i_section`.

    Raises:
        InputError: a name that is not in the table.

    Example:
        >>> round(la.sections.standard("IPE 300", yield_stress=235e6).plastic_moment / 1e3)  # kN m
        148
    """
    known = {own.replace(" ", ""): own for own in PROFILES}
    wanted = str(name).upper().replace(" ", "")
    if wanted not in known:
        raise InputError("name", name, "no section of the table", suggest(str(name), PROFILES))
    own = known[wanted]
    return _of_profile(PROFILES[own], yield_stress, layers, polygon, own)


def _of_profile(
    profile: Profile, yield_stress: float, layers: int, polygon: str, name: str
) -> Section:
    require_positive("yield_stress", yield_stress)
    require_count("layers", layers)
    half, web = profile.height / 2, profile.height / 2 - profile.flange
    sides = max(1, layers // 2)
    stations = np.concatenate(
        [np.linspace(0, web, sides + 1), np.linspace(web, half, sides + 1)[1:]]
    )
    axial, moment = yield_stress * profile.area(stations), yield_stress * profile.moment(stations)
    return _of_curve(stations, axial, moment, polygon, name)


def _of_curve(stations: Floats, axial: Floats, moment: Floats, polygon: str, name: str) -> Section:
    """Return a section with one of the two polygons of its curve, with a reference to the other."""
    require_known("polygon", polygon, SIDES)
    inner, outer = (_corners(stations, axial, moment, side) for side in SIDES)
    own, other = (outer, inner) if polygon == OUTER else (inner, outer)
    return Section(own, name, side=polygon, other=other)


def _corners(stations: Floats, axial: Floats, moment: Floats, polygon: str) -> Corners:
    """Return both halves of a polygon from places of the neutral axis, where ``dM/dN = -y``."""
    if polygon == OUTER:
        met = np.diff(moment + stations * axial) / np.diff(stations)
        height = moment[:-1] - stations[:-1] * (met - axial[:-1])
        axial, moment = np.append(met, axial[-1]), np.append(height, moment[-1])
    own = np.stack([axial, moment], axis=1)
    own = own[own[:, 0] > 0]
    peak = [] if polygon == OUTER else [(0.0, float(moment[0]))]
    left = [(-n, m) for n, m in own[::-1].tolist()]
    return (*left, *peak, *map(tuple, own.tolist()))
