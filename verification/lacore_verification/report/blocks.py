"""Contents of pages as plain data, shown as HTML by `document`, written to files by `files`.

All texts are escaped, because names and messages may come from anywhere.
"""

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import pandas as pd
from markupsafe import Markup

from lacore_verification.report.charts.svg import Chart
from lacore_verification.report.columns import Anchor, Column, is_missing


@dataclass(frozen=True)
class Table:
    """Rows of a DataFrame.

    Attributes:
        columns: columns in this order.
        data: table with these columns, and those that they and `anchor` use.
        caption: caption above the table; may be empty.
        anchor: anchors of the rows for links.
        sortable: whether a reader can sort it.
        stacked: Whether a narrow page shows the cells of a row below each other, with their
            headings.
        card: Column that names the card to which a row belongs, see `Card.name`; empty for none.
    """

    columns: Sequence[Column]
    data: pd.DataFrame
    caption: str = ""
    anchor: Anchor | None = None
    sortable: bool = True
    stacked: bool = False
    card: str = ""

    @cached_property
    def records(self) -> list[dict[str, Any]]:
        """Its rows, each with the shown columns and those that they use."""
        # `to_dict("records")` takes four times as long for a wide table of few rows.
        names = [str(name) for name in self.data.columns if name in self._used]
        cells = [self.data[name].tolist() for name in names]
        return [dict(zip(names, row, strict=True)) for row in zip(*cells, strict=True)]

    @cached_property
    def _used(self) -> frozenset[str]:
        """Names of the columns that the cells, links and cards are made of."""
        anchors = [self.anchor, *(column.link for column in self.columns)]
        named = [text for own in self.columns for text in (own.name, own.order, own.hover)]
        return frozenset([*named, self.card, *(own.column for own in anchors if own)])

    @property
    def values(self) -> list[list[Any]]:
        """Values of its cells, by row; None if missing."""
        rows = ([record[column.name] for column in self.columns] for record in self.records)
        return [[None if is_missing(value) else value for value in row] for row in rows]

    @property
    def texts(self) -> list[list[str]]:
        """Texts of its cells as shown, by row."""
        return [[column.shown(record) for column in self.columns] for record in self.records]

    @property
    def plain(self) -> pd.DataFrame:
        """Its texts as a table."""
        return pd.DataFrame(self.texts, columns=[c.head for c in self.columns], dtype="str")


@dataclass(frozen=True)
class Drawing:
    """A chart with a title.

    Attributes:
        name: name of its file, without suffix.
        caption: title.
        chart: chart.
        note: explanation below it.
    """

    name: str
    caption: str
    chart: Chart
    note: str = ""


@dataclass(frozen=True)
class Picture:
    """A bitmap, in a file that all pages share.

    Attributes:
        name: Unique name, from which the name of the file is made.
        caption: What the picture shows.
        data: The PNG.
        thumbnail: The same, drawn for a list; may be None.
        shown_at: Pixels of the page for each pixel of the file, 1/2 for pictures for dense screens.
    """

    name: str
    caption: str
    data: bytes
    thumbnail: "Picture | None" = None
    shown_at: float = 1.0

    @property
    def size(self) -> tuple[int, int]:
        """Width and height on the page, pixels, so that it does not jump while loading."""
        wide, high = struct.unpack(">II", self.data[16:24])  # of the first chunk of every PNG
        return round(self.shown_at * wide), round(self.shown_at * high)


@dataclass(frozen=True)
class Gallery:
    """Charts and pictures, side by side if they fit."""

    items: Sequence[Drawing | Picture]


@dataclass(frozen=True)
class Text:
    """A paragraph; its `lead` is a bold line before it, and `soft` marks a note."""

    text: str
    lead: str = ""
    soft: bool = False


@dataclass(frozen=True)
class Html:
    """HTML of our own."""

    markup: Markup


@dataclass(frozen=True)
class Heading:
    """A heading inside a section."""

    text: str


@dataclass(frozen=True)
class Preformatted:
    """Text with aligned columns: an analytical calculation, or a sketch.

    Attributes:
        text: the text.
        sketch: description of a sketch for readers who cannot see it; empty for other text.
    """

    text: str
    sketch: str = ""


@dataclass(frozen=True)
class Link:
    """A line of a list: link text, target id, and description."""

    text: str
    target: str
    note: str = ""


@dataclass(frozen=True)
class Links:
    """A list of links."""

    items: Sequence[Link]


@dataclass(frozen=True)
class PageLink:
    """A line of a list of pages: title, file in the report, and description."""

    title: str
    file: str
    note: str = ""


@dataclass(frozen=True)
class PageLinks:
    """A list of other pages."""

    items: Sequence[PageLink]


@dataclass(frozen=True)
class Card:
    """The entry of another page in a list.

    Attributes:
        page, picture, table: The other page, its thumbnail and its results.
        mood, name: As in `Section`; name by which rows of tables refer to the card.
        tags, verdicts, seconds: Tags, verdicts and solve time for `Filters`.
        runs: Different ``backend``, tabulator, ``verdict`` of the runs, for `Filters`.
    """

    page: PageLink
    picture: Picture | None
    table: Table
    mood: str = ""
    name: str = ""
    tags: Sequence[str] = ()
    verdicts: Sequence[str] = ()
    seconds: float = 0.0
    runs: Sequence[str] = ()


@dataclass(frozen=True)
class Cards:
    """Cards, one below the other; their tables have the same columns."""

    items: Sequence[Card]


@dataclass(frozen=True)
class Filters:
    """Controls that search, filter and order the cards of a page; its address stores their state.

    Attributes: A solver also hides the rows of others in tables with a column ``backend``.
        tags, verdicts, solvers: Values to choose from.
        order: Name of the order of the cards; empty on a page without cards.
    """

    tags: Sequence[str]
    verdicts: Sequence[str]
    order: str
    solvers: Sequence[str] = ()


@dataclass(frozen=True)
class Facts:
    """Names and values in two columns."""

    items: Mapping[str, str]


@dataclass(frozen=True)
class Count:
    """Number of results with one verdict, which is ``good``, ``bad`` or ``mild``."""

    number: int
    label: str
    mood: str = "mild"


@dataclass(frozen=True)
class Tally:
    """Large counts, and a bar of their shares."""

    counts: Sequence[Count]


@dataclass(frozen=True)
class Details:
    """Blocks that are collapsed until opened; open in print."""

    title: str
    blocks: Sequence["Block"]


@dataclass(frozen=True)
class Columns:
    """Two columns, stacked if the page is narrow."""

    left: Sequence["Block"]
    right: Sequence["Block"]


Block = (
    Text | Html | Heading | Preformatted | Links | PageLinks | Facts | Tally | Table | Drawing
    | Picture | Gallery | Cards | Filters | Details | Columns
)  # fmt: skip


@dataclass(frozen=True)
class Section:
    """A part of a page with an entry in the list of contents.

    Attributes:
        id: unique id on the page for links.
        title: heading.
        blocks: contents.
        lead: one line below the heading.
        mood: ``good``, ``bad`` or ``mild``, its mark in the list of contents; empty for no mark.
    """

    id: str
    title: str
    blocks: Sequence[Block]
    lead: str = ""
    mood: str = ""


@dataclass(frozen=True)
class Page:
    """A page.

    Attributes:
        title: heading, and title of the window.
        lead: one sentence below it.
        summary: blocks above the list of contents.
        sections: all other contents.
        trail: linked pages: the parent, and neighbours.
    """

    title: str
    lead: str
    sections: Sequence[Section]
    summary: Sequence[Block] = field(default=())
    trail: Sequence[PageLink] = field(default=())


@dataclass(frozen=True)
class Report:
    """Pages by file, such as ``index.html``; `data`: other files that they link to."""

    pages: Mapping[str, Page]
    data: Mapping[str, str] = field(default_factory=dict)
