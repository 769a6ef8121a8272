"""What pages are made of: plain data, shown as HTML by `document`, written to files by `files`.

Every text in here is shown as text: names and messages may come from anywhere.
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
        columns: what to show, in this order.
        data: has these columns, and those that they and `anchor` name.
        caption: above the table; empty for none.
        anchor: makes each row a place to link to.
        sortable: whether a reader can sort it.
        stacked: Whether a narrow page shows the cells of a row below each other, with their heads.
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
        """Its rows: of each the columns that are shown, and those that they refer to."""
        # As `to_dict("records")`, which takes four times as long for a wide table of few rows.
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
        """Values of its cells, by row; None where there is none."""
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
    """A chart under its title.

    Attributes:
        name: of a file of it, without suffix.
        caption: its title.
        chart: its lines.
        note: what else must be known to read it, below.
    """

    name: str
    caption: str
    chart: Chart
    note: str = ""


@dataclass(frozen=True)
class Picture:
    """A picture in pixels, a file that all pages share.

    Attributes:
        name: Unique name, from which the name of the file is made.
        caption: What the picture shows.
        data: The PNG.
        thumbnail: The same drawn for a list; None for none.
        shown_at: Pixels of the page for each pixel of the file, 1/2 of pictures for dense screens.
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
    """Charts and pictures, side by side where there is room."""

    items: Sequence[Drawing | Picture]


@dataclass(frozen=True)
class Text:
    """A paragraph; its `lead` stands in bold on a line before it, `soft` marks an aside."""

    text: str
    lead: str = ""
    soft: bool = False


@dataclass(frozen=True)
class Html:
    """HTML that we have written ourselves."""

    markup: Markup


@dataclass(frozen=True)
class Heading:
    """A heading inside a section."""

    text: str


@dataclass(frozen=True)
class Preformatted:
    """Text in which columns matter: a calculation by hand, a sketch.

    Attributes:
        text: of it.
        sketch: what it is a picture of, for those who cannot see it; empty: it is to be read.
    """

    text: str
    sketch: str = ""


@dataclass(frozen=True)
class Link:
    """A line of a list: what is linked, the id that it leads to, and what is said of it."""

    text: str
    target: str
    note: str = ""


@dataclass(frozen=True)
class Links:
    """A list of links."""

    items: Sequence[Link]


@dataclass(frozen=True)
class Page:
    """A line of a list of pages: its title, its file in the report, what is said of it."""

    title: str
    file: str
    note: str = ""


@dataclass(frozen=True)
class Pages:
    """A list of other pages."""

    items: Sequence[Page]


@dataclass(frozen=True)
class Card:
    """The entry of another page in a list.

    Attributes:
        page, picture, table: The other page, its thumbnail and its results.
        mood, name: As in `Section`; name that rows of tables use for the card.
        tags, verdicts, seconds: Tags, verdicts and solve time for `Filters`.
        runs: Different ``backend``, tabulator, ``verdict`` of the runs, for `Filters`.
    """

    page: Page
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
    """Controls that search, filter and order the cards of a page; its address keeps their state.

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
    """Names and what they are, two columns."""

    items: Mapping[str, str]


@dataclass(frozen=True)
class Count:
    """How many ended in which way, and whether that is ``good``, ``bad`` or ``mild``."""

    number: int
    label: str
    mood: str = "mild"


@dataclass(frozen=True)
class Tally:
    """Counts, large, and a bar of their shares."""

    counts: Sequence[Count]


@dataclass(frozen=True)
class Details:
    """Blocks that are folded away until asked for; open in print."""

    title: str
    blocks: Sequence["Block"]


@dataclass(frozen=True)
class Columns:
    """Two columns, one below the other where the page is narrow."""

    left: Sequence["Block"]
    right: Sequence["Block"]


Block = (
    Text | Html | Heading | Preformatted | Links | Pages | Facts | Tally | Table | Drawing | Picture
    | Gallery | Cards | Filters | Details | Columns
)  # fmt: skip


@dataclass(frozen=True)
class Section:
    """A part of a page that the list of contents links to.

    Attributes:
        id: unique on the page; other texts link to it.
        title: heading.
        blocks: what is in it.
        lead: one line below the heading.
        mood: ``good``, ``bad`` or ``mild``: how the list of contents marks it; empty: not at all.
    """

    id: str
    title: str
    blocks: Sequence[Block]
    lead: str = ""
    mood: str = ""


@dataclass(frozen=True)
class Document:
    """A page.

    Attributes:
        title: heading and title of the window.
        lead: one sentence below it.
        summary: what a reader sees first, above the list of contents.
        sections: everything else.
        trail: pages to go to from here: the one above, its neighbours.
    """

    title: str
    lead: str
    sections: Sequence[Section]
    summary: Sequence[Block] = field(default=())
    trail: Sequence[Page] = field(default=())


@dataclass(frozen=True)
class Report:
    """Pages by their files, such as ``index.html``; `data`: other files that they link to."""

    pages: Mapping[str, Document]
    data: Mapping[str, str] = field(default_factory=dict)
