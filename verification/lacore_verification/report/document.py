"""A document as HTML that loads nothing but the pictures beside it."""

import posixpath
from base64 import b64encode
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from itertools import count
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from lacore_verification.report.blocks import Block, Document, Picture, Table
from lacore_verification.report.charts.svg import Chart, inline


@dataclass(frozen=True)
class Place:
    """Where a page is among others: what its links and pictures are called from there.

    Attributes:
        file: of the page, such as ``cases/wall-1.html``.
        anchors: the file in which an id is; those of this page first.
        pictures: files of pictures, by their names.
        tables: Files of tables as CSV, by the identity of their blocks.
    """

    file: str
    anchors: Mapping[str, str]
    pictures: Mapping[str, str]
    tables: Mapping[int, str]

    def href(self, target: str) -> str:
        """Link to an id; empty where no page has it."""
        file = self.anchors.get(target)
        if file is None:
            return ""
        return f"#{target}" if file == self.file else f"{self.to(file)}#{target}"

    def to(self, file: str) -> str:
        """Link to a file of the report."""
        return posixpath.relpath(file, posixpath.dirname(self.file) or ".")

    def source(self, picture: Picture) -> str:
        """Link to the file of a picture."""
        return self.to(self.pictures[picture.name])

    def download(self, table: Table) -> str:
        """Link to the CSV file of a table; empty where it has none."""
        file = self.tables.get(id(table))
        return "" if file is None else self.to(file)


def render(document: Document, place: Place) -> str:
    """The page as text."""
    environment = templates()
    script = environment.get_template("script.html.j2").render()
    # Only this script runs on the page: one that came with a name would not, even if it got in.
    digest = b64encode(sha256(script.encode()).digest()).decode("ascii")
    return environment.get_template("document.html.j2").render(
        document=document,
        script=Markup(script),
        script_source=f"sha256-{digest}",
        draw=_numbered(),
        href=place.href,
        to=place.to,
        source=place.source,
        download=place.download,
    )


@cache
def templates() -> Environment:
    """The templates, compiled once; all that they show is escaped."""
    environment = Environment(
        loader=PackageLoader("lacore_verification.report", ""),
        autoescape=True,  # template names end in .j2, which a choice by extension would miss
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals.update(kind=_kind)
    return environment


def fragment(template: str, **values: Any) -> Markup:
    """A template of ours as a piece of a page, for `lacore_verification.report.blocks.Html`."""
    return Markup(templates().get_template(template).render(**values))


def _kind(block: Block) -> str:
    """Name of the macro that shows a block."""
    return type(block).__name__.lower()


def _numbered() -> Callable[[Chart], Markup]:
    """Draws charts, each under a name of its own: ids must not clash on the page."""
    numbers = count(1)
    return lambda chart: inline(chart, f"chart-{next(numbers)}")
