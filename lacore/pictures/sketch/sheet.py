"""Sheet of a sketch: symbols of constant size on paper, and labels placed without overlap."""

from dataclasses import dataclass, field

import numpy as np
import shapely
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.patches import FancyArrowPatch
from matplotlib.textpath import TextPath

from lacore.model.bodies.continuum.regions.region import Region
from lacore.model.bodies.touching import Edges
from lacore.numerics.arrays import Floats
from lacore.reporting.text import typeset
from lacore.reporting.units import Units

TEXT = 9.0  # points
_GAP = 2.0  # points, around labels and arrows
_TURNS = np.radians(np.arange(0, 360, 22.5))
_REACHES = (1.5, 5.0, 10.0, 17.0, 27.0)  # points, between anchor and label
_ON_SYMBOL, _ON_BODY, _FAR, _ASIDE = 10.0, 0.6, 0.03, 0.3  # cost of a place


def quantity(size: float, unit: str, units: Units, framed: bool = False) -> tuple[str, str]:
    """Return a size in mathtext, and its unit, see `Units.label`."""
    return typeset(f"{size / units.size(unit, framed):.4g}"), units.label(unit, framed)


@dataclass(frozen=True)
class Label:
    """Text that belongs to a place.

    Attributes:
        text: mathtext.
        place: m, shape (2,).
        towards: preferred direction from the place; a zero vector: any.
        colour: colour of the text.
        plain: whether the text is shown without mathtext.
        home: preferred area; None: outside of the bodies.
    """

    text: str
    place: Floats
    towards: Floats
    colour: str
    plain: bool = False
    home: shapely.Geometry | None = None


@dataclass
class Sheet:
    """Axes with a scale that is known before anything is drawn.

    Attributes:
        axes: in m.
        point: m that a point of the page stands for.
        units: of labels.
        bodies: area that labels avoid.
        taken: places of symbols.
        arrows: places of single arrows, which are among those.
        tools: ground of tools, on which labels and symbols may stand.
        labels: still to be placed.
        handles: of the legend, by label.
        shades: colours of the regions of each continuum that is drawn.
    """

    axes: Axes
    point: float
    units: Units
    bodies: list[shapely.Geometry] = field(default_factory=list)
    taken: list[shapely.Geometry] = field(default_factory=list)
    arrows: list[shapely.Geometry] = field(default_factory=list)
    tools: list[shapely.Geometry] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)
    handles: dict[str, Artist] = field(default_factory=dict)
    shades: dict[str, list[tuple[Region, str]]] = field(default_factory=dict)

    def take(self, corners: Floats) -> None:
        """Keep polygons, shape (k, n, 2), free of labels and of other symbols."""
        self.taken.extend(shapely.polygons(corners))

    def is_free(self, place: shapely.Geometry) -> bool:
        """Return whether a place has no symbol."""
        return not shapely.intersects(place, self.taken).any()

    def arrow(self, tail: Floats, tip: Floats, colour: str, gid: str, width: float = 1.6) -> None:
        """Draw an arrow from `tail` to `tip`, m, shape (2,) each; heads have one size on paper."""
        patch = FancyArrowPatch(
            tuple(tail),
            tuple(tip),
            arrowstyle="-|>",
            mutation_scale=6 + 3 * width,
            shrinkA=0,
            shrinkB=0,
            color=colour,
            lw=width,
            zorder=6,
            gid=gid,
        )
        self.axes.add_patch(patch)
        line = shapely.LineString([tail, tip])
        self.arrows.append(line.buffer((_GAP + width) * self.point, cap_style="flat"))
        self.taken.append(self.arrows[-1])

    def band(self, edges: Edges, low: float, high: float) -> Floats:
        """Return the corners (k, 4, 2) of strips outside of edges; distances in points."""
        inner, outer = (edges.normal * away * self.point for away in (low, high))
        corners = [edges.start, edges.end]
        corners = [*(c + inner for c in corners), *(c + outer for c in reversed(corners))]
        return np.stack(corners).transpose(2, 0, 1)

    def hatch(self, edges: Edges, depth: float, colour: str, gid: str, low: float = 0.0) -> None:
        """Draw hatched strips outside of edges."""
        corners = self.band(edges, low, low + depth)
        self.axes.add_collection(
            PolyCollection(
                list(corners),
                facecolors="none",
                edgecolors=colour,
                hatch="//////",
                linewidths=0,
                zorder=1.4,
                gid=gid,
            )
        )
        self.take(corners)

    def line(self, edges: Edges, colour: str, width: float, gid: str, away: float = 0.0) -> None:
        """Draw lines along edges, `away` points outside of them."""
        corners = self.band(edges, away, away)[:, :2]
        self.axes.add_collection(
            LineCollection(
                list(corners), colors=colour, linewidths=width, zorder=4, capstyle="butt", gid=gid
            )
        )
        self.take(self.band(edges, away - width / 2, away + width / 2))

    def place_labels(self) -> None:
        """Place each label where it covers least, and as close as possible."""
        ground = shapely.union_all(self.bodies)
        for label in self.labels:
            self._place(label, ground)
        self.labels.clear()

    def _place(self, label: Label, ground: shapely.Geometry) -> None:
        text = label.text.replace("$", "S") if label.plain else label.text
        extent = TextPath((0, 0), text, size=TEXT).get_extents()
        half = (np.array([extent.width, extent.height]) / 2 + _GAP) * self.point
        turns = np.stack([np.cos(_TURNS), np.sin(_TURNS)])
        # extent of the box in a direction, and more
        edge = np.minimum(*(half[:, None] / np.maximum(np.abs(turns), 1e-9)))
        centres = np.concatenate(
            [
                label.place[:, None],
                *(label.place[:, None] + turns * (edge + reach * self.point) for reach in _REACHES),
            ],
            axis=1,
        )
        boxes = shapely.box(*(centres - half[:, None]), *(centres + half[:, None]))
        area = 4 * half[0] * half[1]
        taken = shapely.union_all(self.taken)
        away = np.linalg.norm(centres - label.place[:, None], axis=0)
        aside = label.towards @ (centres - label.place[:, None])
        if label.home is None:
            strange = shapely.intersection(boxes, ground)
        else:
            strange = shapely.difference(boxes, label.home)
        cost = (
            _ON_SYMBOL * shapely.area(shapely.intersection(boxes, taken)) / area
            + _ON_BODY * shapely.area(strange) / area
            + _FAR * away / self.point
            - _ASIDE * np.divide(aside, away, out=np.zeros_like(aside), where=away > 0)
        )
        best = int(np.argmin(cost))
        self.taken.append(boxes[best])
        self.axes.text(
            float(centres[0, best]),
            float(centres[1, best]),
            label.text,
            color=label.colour,
            fontsize=TEXT,
            ha="center",
            va="center",
            zorder=8,
            parse_math=not label.plain,
            bbox={"boxstyle": "square,pad=0.08", "facecolor": "white", "alpha": 0.75, "lw": 0},
        )

    def bounds(self) -> tuple[Floats, Floats]:
        """Return the corners of the drawing, m."""
        low_x, low_y, high_x, high_y = shapely.total_bounds(
            [*self.bodies, *self.taken, *self.tools]
        )
        return np.array([low_x, low_y]), np.array([high_x, high_y])


def spaced(edges: Edges, spacing: float) -> tuple[Floats, Floats]:
    """Return places along edges, evenly in each run with its ends, and normals, (2, k)."""
    merged = shapely.line_merge(shapely.MultiLineString(list(edges.lines)))
    places = []
    for run in shapely.get_parts(merged):
        steps = max(int(np.ceil(run.length / spacing)), 1)
        places.append(shapely.line_interpolate_point(run, np.linspace(0, run.length, steps + 1)))
    points = np.concatenate(places)
    nearest = np.argmin(shapely.distance(points[:, None], edges.lines[None, :]), axis=1)
    return shapely.get_coordinates(points).T, edges.normal[:, nearest]


def middle(edges: Edges) -> tuple[Floats, Floats]:
    """Return the middle of the longest run of edges, and the normal there, shape (2,) each."""
    merged = shapely.get_parts(shapely.line_merge(shapely.MultiLineString(list(edges.lines))))
    longest = merged[int(np.argmax(shapely.length(merged)))]
    point = shapely.line_interpolate_point(longest, longest.length / 2)
    nearest = int(np.argmin(shapely.distance(point, edges.lines)))
    return shapely.get_coordinates(point)[0], edges.normal[:, nearest]
