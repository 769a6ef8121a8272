"""Document as HTML that only loads the pictures next to it."""

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

from lacore_verification.report.blocks import Block, Page, Picture, Table
from lacore_verification.report.charts.svg import Chart, inline


@dataclass(frozen=True)
class Place:
    """Place of a page among others, for the addresses of its links and pictures.

    Attributes:
        file: file of the page, such as ``cases/wall-1.html``.
        anchors: file of each id; those of this page first.
        pictures: files of pictures, by name.
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
        """Return a link to the CSV file of a table; empty without one."""
        file = self.tables.get(id(table))
        return "" if file is None else self.to(file)


def render(document: Page, place: Place) -> str:
    """Return the page as text."""
    environment = templates()
    script = environment.get_template("script.html.j2").render()
    # Only this script runs on the page: one from a name would not, even if it were included.
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
    """Return the templates, compiled once; all values are escaped."""
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
    """Return a template as a piece of a page, for `lacore_verification.report.blocks.Html`."""
    return Markup(templates().get_template(template).render(**values))


def _kind(block: Block) -> str:
    """Name of the macro that shows a block."""
    return type(block).__name__.lower()


def _numbered() -> Callable[[Chart], Markup]:
    """Return a function that draws charts with unique names, as ids must not clash on the page."""
    numbers = count(1)
    return lambda chart: inline(chart, f"chart-{next(numbers)}")
