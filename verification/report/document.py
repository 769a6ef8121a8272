"""A document as one HTML file that loads nothing from anywhere."""

from base64 import b64encode
from collections.abc import Callable
from hashlib import sha256
from itertools import count
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from lacore.errors import InputError
from verification.report.blocks import Block, Document
from verification.report.svg import Chart, inline


def render(document: Document) -> str:
    """The page as text."""
    environment = templates()
    script = environment.get_template("script.html.j2").render()
    environment.globals["draw"] = _numbered()
    # Only this script runs on the page: one that came with a name would not, even if it got in.
    digest = b64encode(sha256(script.encode()).digest()).decode("ascii")
    return environment.get_template("document.html.j2").render(
        document=document, script=Markup(script), script_source=f"sha256-{digest}"
    )


def write(document: Document, path: Path) -> Path:
    """Write the page; returns its path.

    Raises:
        InputError: it cannot be written there.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # A path may have bytes that are no text.
        path.write_text(render(document), encoding="utf-8", errors="replace")
    except OSError as error:
        raise InputError(
            "--out", str(path.parent), f"cannot write there ({error.strerror})", "name a folder"
        ) from error
    return path


def templates() -> Environment:
    """The templates; all that they show is escaped."""
    environment = Environment(
        loader=PackageLoader("verification.report", ""),
        autoescape=True,  # template names end in .j2, which a choice by extension would miss
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals.update(kind=_kind)
    return environment


def fragment(template: str, **values: Any) -> Markup:
    """A template of ours as a piece of a page, for `verification.report.blocks.Html`."""
    return Markup(templates().get_template(template).render(**values))


def _kind(block: Block) -> str:
    """Name of the macro that shows a block."""
    return type(block).__name__.lower()


def _numbered() -> Callable[[Chart], Markup]:
    """Draws charts, each under a name of its own: ids must not clash on the page."""
    numbers = count(1)
    return lambda chart: inline(chart, f"chart-{next(numbers)}")
