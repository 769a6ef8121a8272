"""Links of the site: each leads to a file of it, and to a place that is there."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

_ATTRIBUTES = {"href", "src"}


@dataclass
class _Page(HTMLParser):
    """What a page has and where it leads."""

    ids: set[str] = field(default_factory=set)
    targets: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        super().__init__()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in ("id", "name") and value:
                self.ids.add(value)
            elif name in _ATTRIBUTES and value is not None:
                self.targets.append(value)


def read(file: Path) -> _Page:
    """A page of HTML."""
    page = _Page()
    page.feed(file.read_text(encoding="utf-8"))
    return page


def broken(folder: Path) -> Iterator[str]:
    """Page and target of each link within the site that leads nowhere, or out of the site.

    Raises:
        FileNotFoundError: there is no page.
    """
    pages = {file: read(file) for file in sorted(folder.resolve().rglob("*.html"))}
    if not pages:
        raise FileNotFoundError(f"{folder} has no page")
    for file, page in pages.items():
        for target in page.targets:
            parts = urlsplit(target)
            if parts.scheme or parts.netloc:
                continue
            place = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            there = place.is_file() and place.is_relative_to(folder.resolve())
            anchor = unquote(parts.fragment)
            known = pages.get(place)
            if not there or (anchor and known is not None and anchor not in known.ids):
                yield f"{file.relative_to(folder.resolve())}: {target}"
