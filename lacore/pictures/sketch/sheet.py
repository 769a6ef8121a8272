"""What a sketch is drawn on: symbols of one size on paper, labels that find a free place."""

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
from lacore.reporting.units import Units

TEXT = 9.0  # points
_GAP = 2.0  # points, around labels and arrows
_TURNS = np.radians(np.arange(0, 360, 22.5))
_REACHES = (1.5, 5.0, 10.0, 17.0, 27.0)  # points, between anchor and label
_ON_SYMBOL, _ON_BODY, _FAR, _ASIDE = 10.0, 0.6, 0.03, 0.3  # what a place costs


def typeset(size: float) -> str:
    r"""A number in mathtext, its power of ten raised: ``5.2 \times 10^{-5}``."""
    digits, _, power = f"{size:.4g}".partition("e")
    return rf"{digits} \times 10^{{{int(power)}}}" if power else digits


def quantity(size: float, unit: str, units: Units, framed: bool = False) -> tuple[str, str]:
    """A size in mathtext, and its unit, see `Units.label`."""
    return typeset(size / units.size(unit, framed)), units.label(unit, framed)


@dataclass(frozen=True)
class Label:
    """A text that belongs to a place.

    Attributes:
        text: mathtext.
        place: m, shape (2,).
        towards: where it had better stand, seen from the place; a zero vector: anywhere.
        colour: of the text.
        plain: whether the text is shown as it is, without mathtext.
        home: where it had better stay inside; None: off the bodies.
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
        units: that sizes are told in.
        bodies: ground that labels had better leave free.
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
        """Whether no symbol is there."""
        return not shapely.intersects(place, self.taken).any()

    def arrow(self, tail: Floats, tip: Floats, colour: str, gid: str, width: float = 1.6) -> None:
        """An arrow from `tail` to `tip`, m, shape (2,) each; heads have one size on paper."""
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
        """Corners (k, 4, 2) of strips outside of edges, from `low` to `high` points away."""
        inner, outer = (edges.normal * away * self.point for away in (low, high))
        corners = [edges.start, edges.end]
        corners = [*(c + inner for c in corners), *(c + outer for c in reversed(corners))]
        return np.stack(corners).transpose(2, 0, 1)

    def hatch(self, edges: Edges, depth: float, colour: str, gid: str, low: float = 0.0) -> None:
        """Hatched strips outside of edges."""
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
        """Lines along edges, `away` points outside of them."""
        corners = self.band(edges, away, away)[:, :2]
        self.axes.add_collection(
            LineCollection(
                list(corners), colors=colour, linewidths=width, zorder=4, capstyle="butt", gid=gid
            )
        )
        self.take(self.band(edges, away - width / 2, away + width / 2))

    def place_labels(self) -> None:
        """Each label where it covers least, the nearer the better."""
        ground = shapely.union_all(self.bodies)
        for label in self.labels:
            self._place(label, ground)
        self.labels.clear()

    def _place(self, label: Label, ground: shapely.Geometry) -> None:
        text = label.text.replace("$", "S") if label.plain else label.text
        extent = TextPath((0, 0), text, size=TEXT).get_extents()
        half = (np.array([extent.width, extent.height]) / 2 + _GAP) * self.point
        turns = np.stack([np.cos(_TURNS), np.sin(_TURNS)])
        # As far as the box reaches in a direction, and on.
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
        """Corners of all that was drawn, m."""
        low_x, low_y, high_x, high_y = shapely.total_bounds(
            [*self.bodies, *self.taken, *self.tools]
        )
        return np.array([low_x, low_y]), np.array([high_x, high_y])


def spaced(edges: Edges, spacing: float) -> tuple[Floats, Floats]:
    """Places along edges, evenly in each run of them, its ends included, and normals, (2, k)."""
    merged = shapely.line_merge(shapely.MultiLineString(list(edges.lines)))
    places = []
    for run in shapely.get_parts(merged):
        steps = max(int(np.ceil(run.length / spacing)), 1)
        places.append(shapely.line_interpolate_point(run, np.linspace(0, run.length, steps + 1)))
    points = np.concatenate(places)
    nearest = np.argmin(shapely.distance(points[:, None], edges.lines[None, :]), axis=1)
    return shapely.get_coordinates(points).T, edges.normal[:, nearest]


def middle(edges: Edges) -> tuple[Floats, Floats]:
    """The middle of the longest run of edges, and the normal there, shape (2,) each."""
    merged = shapely.get_parts(shapely.line_merge(shapely.MultiLineString(list(edges.lines))))
    longest = merged[int(np.argmax(shapely.length(merged)))]
    point = shapely.line_interpolate_point(longest, longest.length / 2)
    nearest = int(np.argmin(shapely.distance(point, edges.lines)))
    return shapely.get_coordinates(point)[0], edges.normal[:, nearest]
