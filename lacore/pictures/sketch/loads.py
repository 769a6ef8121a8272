"""Loads in the sketch of a problem: arrows with their values."""

from functools import singledispatch

import numpy as np
import shapely
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, to_rgb, to_rgba
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.tri import Triangulation

from lacore.model.bodies.any_body import AnyBody, plane
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.blocks.loads import carried
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.body_forces import elements_of
from lacore.model.bodies.continuum.water import in_pores
from lacore.model.bodies.frames.frame import Frame, line_load
from lacore.model.bodies.touching import Edges
from lacore.model.conditions.body_forces import BodyForce
from lacore.model.conditions.footings import RigidFooting
from lacore.model.conditions.loads import Load, PointForce, SurfaceLoad, Traction, acts
from lacore.model.conditions.water import PorePressure, StandingWater
from lacore.model.meshes.curved import outlines
from lacore.numerics.arrays import Floats
from lacore.pictures.axis import has_axis
from lacore.pictures.sketch.sheet import Label, Sheet, middle, quantity, spaced

LIVE, DEAD = "#c1121f", "#6c6c6c"
_WATER = "#1f77b4"
_DEEPEST = 0.55  # opacity of the blue at the largest pore pressure
_SHALLOW = 0.15  # by the largest pressure: less has no arrow
_SINGLE, _OF_BODY, _OF_ROW = 40.0, 34.0, 20.0  # points: lengths of arrows
_SHORTEST = 28.0  # points of a block for an arrow inside it
_SPACING = 15.0  # points, in a row
_ALONG = 0.25  # cosine to the normal below which a traction acts along a boundary
_BAR = (2.0, 7.0)  # points: extent of a footing from its body
_ROLL = 5.0  # points: rollers under a smooth one
_NOTHING = 1e-9  # by the parts of a body force: a resultant that is zero
_STEP, _TRIES = 4.0, 10  # points: shift of rows around other symbols, and number of tries


def draw_load(sheet: Sheet, load: Load, body: AnyBody, live: bool, gid: str) -> None:
    """Draw one load if it is not zero; the label is its size, or the resultant of a body force."""
    if not acts(load):
        return
    _legend(sheet, live)
    _draw(load, body, sheet, LIVE if live else DEAD, live, gid)


def _legend(sheet: Sheet, live: bool) -> None:
    text = r"reference load, times $\alpha$" if live else "dead load"
    colour = LIVE if live else DEAD
    sheet.handles[text] = Line2D([], [], color=colour, lw=1.6, marker=">", ms=5, label=text)


def _worth(sheet: Sheet, size: float, unit: str, live: bool, framed: bool = False) -> str:
    told, unit = quantity(size, unit, sheet.units, framed)
    return rf"$\alpha \cdot {told}$ {unit}" if live else f"${told}$ {unit}"


@singledispatch
def _draw(load: Load, body: AnyBody, sheet: Sheet, colour: str, live: bool, gid: str) -> None:
    raise TypeError(f"nothing sketches a {type(load).__name__}")


@_draw.register
def _point_force(
    load: PointForce, body: AnyBody, sheet: Sheet, colour: str, live: bool, gid: str
) -> None:
    vector = np.asarray(load.vector, dtype=np.float64)
    size = float(np.linalg.norm(vector))
    place, block = _place(body, load.at)
    along = vector / size
    length = _SINGLE if block is None else _inner_length(sheet, place, along, block)
    text = _worth(sheet, size, _force_unit(body), live, _framed(body))
    _draw_single(sheet, place, along, block is not None, length, text, colour, gid)


def _place(body: AnyBody, at: tuple[float, ...] | str) -> tuple[Floats, shapely.Polygon | None]:
    """Return where a force acts, and the block in whose middle that is."""
    return _named_place(body, at) if isinstance(at, str) else (np.array(at, dtype=float), None)


@singledispatch
def _named_place(body: AnyBody, name: str) -> tuple[Floats, shapely.Polygon | None]:
    raise TypeError(f"a {type(body).__name__} has no points with names")


@_named_place.register
def _node(body: Frame, name: str) -> tuple[Floats, None]:
    return body.position[:, body.names.index(name)], None


@_named_place.register
def _block(body: BlockAssembly, name: str) -> tuple[Floats, shapely.Polygon]:
    return body.centroid[:, body.names.index(name)], shapely.Polygon(body.polygons[name])


def _inner_length(sheet: Sheet, place: Floats, along: Floats, block: shapely.Polygon) -> float:
    """Return the length of an arrow, in points, that ends inside a block if it fits."""
    ray = shapely.LineString([place, place + _SINGLE * sheet.point * along])
    inside = shapely.intersection(ray, block).length / sheet.point
    return 0.8 * inside if inside > _SHORTEST else _OF_BODY


@_draw.register
def _body_force(
    load: BodyForce, body: AnyBody, sheet: Sheet, colour: str, live: bool, gid: str
) -> None:
    forces, centroids = _volume_forces(body, load)
    weights = np.linalg.norm(forces, axis=0)
    total = forces.sum(axis=1)
    size = float(np.linalg.norm(total))
    if not size > _NOTHING * weights.sum():
        return  # A zero resultant has no arrow.
    place = centroids @ weights / weights.sum()
    text = _worth(sheet, size, _force_unit(body), live, _framed(body))
    _draw_single(sheet, place, total / size, True, _OF_BODY, text, colour, gid)
    sheet.axes.scatter(place[0], place[1], s=14, color=colour, zorder=6, gid=gid)


@singledispatch
def _volume_forces(body: AnyBody, load: BodyForce) -> tuple[Floats, Floats]:
    """Return forces (2, k) on the parts that a body force acts on, and centroids, (2, k), m."""
    raise TypeError(f"has no volume: {type(body).__name__}")


@_volume_forces.register
def _of_elements(body: Body, load: BodyForce) -> tuple[Floats, Floats]:
    part = elements_of(load, body.mesh, "BodyForce.where")
    parts = shapely.polygons(outlines(body.mesh)[part])
    centroids = shapely.get_coordinates(shapely.centroid(parts)).T
    volumes = shapely.area(parts) * body.thickness(centroids)
    return volumes * load.at(centroids, part, body.mesh.nelements, "BodyForce"), centroids


@_volume_forces.register
def _of_blocks(body: BlockAssembly, load: BodyForce) -> tuple[Floats, Floats]:
    _, places, forces = carried(load, body)
    return forces, places


@singledispatch
def _framed(body: AnyBody) -> bool:
    """Return whether forces on it are those of a frame."""
    return False


@_framed.register
def _frames(body: Frame) -> bool:
    return True


def _force_unit(body: AnyBody) -> str:
    return "N" if has_axis([body]) else "N/m"


def _draw_single(
    sheet: Sheet,
    place: Floats,
    along: Floats,
    inside: bool,
    length: float,
    text: str,
    colour: str,
    gid: str,
) -> None:
    """Draw one arrow, out of bodies and up to points, unless another one is there."""
    reach = length * sheet.point * along
    pushed, pulled = (place - reach, place), (place, place + reach)
    ways = [pulled, pushed] if inside else [pushed, pulled]
    tail, tip = min(ways, key=lambda way: _crossings(sheet, way))
    sheet.arrow(tail, tip, colour, gid, width=2.2)
    far = tip if np.allclose(tail, place) else tail
    sheet.labels.append(Label(text, far, (far - place) / np.linalg.norm(far - place), colour))


def _crossings(sheet: Sheet, way: tuple[Floats, Floats]) -> int:
    """Return the number of symbols across the middle of an arrow; arrows count most."""
    tail, tip = way
    line = shapely.LineString([0.75 * tail + 0.25 * tip, 0.25 * tail + 0.75 * tip])
    arrows, symbols = (shapely.intersects(line, p).sum() for p in (sheet.arrows, sheet.taken))
    return int(10 * arrows + symbols)


@_draw.register
def _footing(
    load: RigidFooting, body: AnyBody, sheet: Sheet, colour: str, live: bool, gid: str
) -> None:
    edges = plane(body).boundary(load.where, "RigidFooting.where")[1]
    low = _BAR[0] if load.rough else _ROLL
    high = low + _BAR[1] - _BAR[0]
    corners = sheet.band(edges, low if not load.rough else 0.0, high)
    for bar in corners:
        sheet.axes.fill(*bar.T, facecolor="#3c3c3c", edgecolor="#3c3c3c", lw=0.3, gid=gid)
    if not load.rough:
        places, normals = spaced(edges, 10.0 * sheet.point)
        x, y = places + 0.5 * _ROLL * sheet.point * normals
        sheet.axes.scatter(x, y, s=9, facecolor="white", edgecolor="#3c3c3c", lw=0.8, zorder=5)
    sheet.take(sheet.band(edges, 0.0, high))
    text = f"rigid footing, {'rough' if load.rough else 'smooth'}"
    sheet.handles[text] = Line2D([], [], color="#3c3c3c", lw=5, label=text)
    along = np.asarray(load.direction)
    place, normal = middle(edges)
    start = place + (high + 1.0) * sheet.point * normal
    pushes = float(along @ normal) < 0
    reach = _SINGLE * sheet.point * along
    tail, tip = (start - reach, start) if pushes else (start, start + reach)
    sheet.arrow(tail, tip, colour, gid, width=2.6)
    far = tail if pushes else tip
    worth = _worth(sheet, load.pressure, "Pa", live) + " on average"
    sheet.labels.append(Label(worth, far, normal, colour))


@_draw.register
def _row(load: SurfaceLoad, body: AnyBody, sheet: Sheet, colour: str, live: bool, gid: str) -> None:
    """Draw arrows along a boundary or a member, outside of other symbols."""
    edges, unit = _loaded(body, load)
    vectors = load.on(edges.normal)
    size = float(np.linalg.norm(vectors[:, 0]))
    cosine = float(np.mean(np.sum(vectors * edges.normal, axis=0))) / size
    spacing = _OF_ROW + 7.0 if abs(cosine) < _ALONG else _SPACING
    places, normals = spaced(edges, spacing * sheet.point)
    directions = load.on(normals) / size
    depth = 5.0 if abs(cosine) < _ALONG else _OF_ROW * abs(cosine)
    low = _free_depth(sheet, edges, depth)
    base = places + low * sheet.point * normals
    if abs(cosine) < _ALONG:
        tails = _between(base) - 0.5 * _OF_ROW * sheet.point * directions[:, :-1]
        tips = tails + _OF_ROW * sheet.point * directions[:, :-1]
    else:
        reach = _OF_ROW * sheet.point * directions
        tails, tips = (base - reach, base) if cosine < 0 else (base, base + reach)
    for tail, tip in zip(tails.T, tips.T, strict=True):
        sheet.arrow(tail, tip, colour, gid, width=1.1)
    sheet.take(sheet.band(edges, low, low + depth))
    if cosine <= -_ALONG:
        sheet.line(edges, colour, 0.9, gid, away=low + depth)
    place, normal = middle(edges)
    outside = place + (low + depth) * sheet.point * normal
    sheet.labels.append(
        Label(_worth(sheet, size, unit, live, _framed(body)), outside, normal, colour)
    )


@_draw.register
def _pores(load: PorePressure, body: Body, sheet: Sheet, colour: str, live: bool, gid: str) -> None:
    """Draw pore pressure as blue over the colour of each region, darker for larger pressure."""
    pressure = in_pores(load, body.mesh, "PorePressure")
    largest = float(pressure.max())
    if largest == 0:
        return
    corners, places = body.mesh.t, body.mesh.p[:, : pressure.size]
    for region, dry in sheet.shades[load.body]:
        own = corners[:, region.elements]
        halves = [own[:3]] if len(own) == 3 else [own[[0, 1, 2]], own[[0, 2, 3]]]
        # Agg draws such triangles without transparency.
        mixed = (1 - _DEEPEST) * np.array(to_rgb(dry)) + _DEEPEST * np.array(to_rgb(_WATER))
        shades = [to_rgb(dry), to_rgb(mixed.tolist())]
        sheet.axes.tripcolor(
            Triangulation(places[0], places[1], np.concatenate(halves, axis=1).T),
            pressure,
            shading="gouraud",
            cmap=LinearSegmentedColormap.from_list("water", shades),
            vmin=0.0,
            vmax=largest,
            zorder=1.6,
            gid=gid,
        )
        sheet.handles.setdefault("pore water", Patch(facecolor=shades[1]))
    home = shapely.union_all(shapely.polygons(outlines(body.mesh)))
    text = rf"$u \leq$ {_worth(sheet, largest, 'Pa', live)}"
    deepest = places[:, corners].mean(axis=1)[:, int(np.argmax(pressure[corners].mean(axis=0)))]
    sheet.labels.append(Label(text, deepest, np.zeros(2), _WATER, home=home))


@_draw.register
def _standing(
    load: StandingWater, body: Body, sheet: Sheet, colour: str, live: bool, gid: str
) -> None:
    """Draw arrows with the length of the pressure, and the water."""
    edges = plane(body).boundary(load.where, "StandingWater.where")[1]
    places, normals = spaced(edges, _SPACING * sheet.point)
    sizes = load.at(places, "StandingWater")
    largest = float(sizes.max())
    if largest == 0:
        return
    low, reach = _free_depth(sheet, edges, _OF_ROW), _OF_ROW * sheet.point / largest
    shown = sizes > _SHALLOW * largest
    tips = places + low * sheet.point * normals
    tails = tips + reach * sizes * normals
    for tail, tip in zip(tails.T[shown], tips.T[shown], strict=True):
        sheet.arrow(tail, tip, _WATER, gid, width=1.1)
    start, end = (c + low * sheet.point * edges.normal for c in (edges.start, edges.end))
    far, near = (
        reach * load.at(c, "StandingWater") * edges.normal for c in (edges.end, edges.start)
    )
    strips = np.stack([start, end, end + far, start + near]).transpose(2, 0, 1)
    sheet.axes.add_collection(
        PolyCollection(
            list(strips), facecolors=to_rgba(_WATER, 0.25), edgecolors="none", zorder=1.3, gid=gid
        )
    )
    sheet.take(sheet.band(edges, low, low + _OF_ROW))
    deepest = int(np.argmax(sizes))
    label = Label(
        _worth(sheet, largest, "Pa", live), tails[:, deepest], normals[:, deepest], _WATER
    )
    sheet.labels.append(label)


def _between(places: Floats) -> Floats:
    return np.asarray((places[:, 1:] + places[:, :-1]) / 2)


@singledispatch
def _loaded(body: AnyBody, load: SurfaceLoad) -> tuple[Edges, str]:
    """Return the edges of a load, and its unit; for a member those on the side of the load."""
    return plane(body).boundary(load.where, "where")[1], "Pa"


@_loaded.register
def _members(body: Frame, load: Traction) -> tuple[Edges, str]:
    pieces = np.any(line_load(load, body), axis=0)
    along = body.pieces.along[:, pieces]
    across = np.stack([-along[1], along[0]])
    from_there = np.where(np.asarray(load.vector) @ across > 0, -1.0, 1.0)
    ends = body.position[:, body.pieces.nodes[pieces]]
    return Edges(ends[:, :, 0], ends[:, :, 1], across * from_there), "N/m per m"


def _free_depth(sheet: Sheet, edges: Edges, depth: float) -> float:
    """Return the distance from edges, in points, from which a strip is free."""
    for step in range(_TRIES):
        low = 2.0 + step * _STEP
        # The middle of the strip, as symbols around the corner do not count.
        corners = sheet.band(edges, low, low + depth)
        inner = 0.9 * corners + 0.1 * corners.mean(axis=1, keepdims=True)
        if all(sheet.is_free(polygon) for polygon in shapely.polygons(inner)):
            return low
    return 2.0
