"""A Sphinx extension: each numbered paragraph of the theory is a place, each (T n) a link to it."""

import re
from collections.abc import Iterable, Iterator
from typing import Any, ClassVar

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms import SphinxTransform
from sphinx.transforms.post_transforms import SphinxPostTransform

PAGE = "theory"
_PLACE = re.compile(r"\(?(T\d+[a-z]?)\b")
_CITED = re.compile(r"\bT ?\d+[a-z]?\b")
_TOLD = (nodes.literal, nodes.literal_block, nodes.reference, nodes.title, nodes.raw)


def anchor(number: str) -> str:
    """The id of a paragraph, such as ``t12b``."""
    return number.replace(" ", "").lower()


class Places(SphinxTransform):
    """Bold numbers of the page of theory become places."""

    default_priority = 500

    def apply(self, **_: Any) -> None:
        """On that page alone."""
        if self.env.docname != PAGE:
            return
        found: dict[str, None] = {}
        for bold in list(self.document.findall(nodes.strong)):
            number = _PLACE.match(bold.astext())
            if number and anchor(number[1]) not in found:
                found[anchor(number[1])] = None
                bold["ids"].append(anchor(number[1]))
        self.env.metadata[PAGE]["places"] = " ".join(found)


class Citations(SphinxPostTransform):
    """Numbers of the theory in any text become links; those that are no place stay as they are."""

    default_priority = 900
    formats = ("html",)

    def run(self, **_: Any) -> None:
        """On each page; bold numbers of the theory are no citations."""
        places = set(self.env.metadata[PAGE].get("places", "").split())
        at = self.app.builder.get_relative_uri(self.env.docname, PAGE)
        own = nodes.strong if self.env.docname == PAGE else ()
        for text in list(self.document.findall(nodes.Text)):
            if not _inside(text, (*_TOLD, own) if own else _TOLD):
                parts = list(_parts(text.astext(), at, places))
                if len(parts) > 1:
                    text.parent.replace(text, parts)


def _inside(node: nodes.Node, kinds: Iterable[type[nodes.Node]]) -> bool:
    while node.parent is not None:
        node = node.parent
        if isinstance(node, tuple(kinds)):
            return True
    return False


def _parts(text: str, page: str, places: set[str]) -> Iterator[nodes.Node]:
    end = 0
    for found in _CITED.finditer(text):
        if anchor(found[0]) in places:
            if found.start() > end:
                yield nodes.Text(text[end : found.start()])
            yield nodes.reference("", found[0], refuri=f"{page}#{anchor(found[0])}", classes=["t"])
            end = found.end()
    if end < len(text):
        yield nodes.Text(text[end:])


class Extension:
    """What Sphinx is told of this extension."""

    metadata: ClassVar[dict[str, bool]] = {"parallel_read_safe": True, "parallel_write_safe": True}


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.add_transform(Places)
    app.add_post_transform(Citations)
    return Extension.metadata
