"""A Sphinx extension for our docstrings: links of names, lists of fields."""

import re
from collections.abc import Iterator, Sequence
from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util.inspect import TypeAliasForwardRef

_SHORT = {"la": "lacore"}
_UNTYPED = {"attribute", "data", "property"}
"""Of which napoleon takes a first line for ``type: description``: ours have their annotation."""
_SEVERAL = re.compile(r"( +)(\w+(?:, \w+)+): (.*)")


def resolve(
    app: Sphinx, env: BuildEnvironment, node: addnodes.pending_xref, content: nodes.Element
) -> nodes.Element | None:
    """`la.solve`, `lacore.limit.boxed.solve`, `Body.space` as links, as far as they are there."""
    if node.get("refdomain") != "py":
        return None
    first, _, rest = node["reftarget"].partition(".")
    target = f"{_SHORT.get(first, first)}.{rest}" if rest else first
    objects = env.domains.python_domain.objects
    name = target.rpartition(".")[2]
    for known in (target, f"lacore.{target}", f"lacore.{name}" if target.count(".") > 1 else ""):
        if known in objects:
            entry = objects[known]
            uri = app.builder.get_relative_uri(node["refdoc"], entry.docname)
            link = nodes.reference("", "", refuri=f"{uri}#{entry.node_id}", internal=True)
            link += content
            return link
    return None


def before_napoleon(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]
) -> None:
    """``low, high: ends of it``: a field each, with the same words; in place.

    What stands before a colon in the first line of an attribute napoleon reads as its type: an
    empty type before that keeps the sentence whole.
    """
    lines[:] = _repeated(lines)
    if what in _UNTYPED and lines and ":" in lines[0]:
        lines[0] = f": {lines[0]}"


def _repeated(lines: Sequence[str]) -> Iterator[str]:
    number = 0
    while number < len(lines):
        found = _SEVERAL.fullmatch(lines[number])
        number += 1
        if found is None:
            yield lines[number - 1]
            continue
        margin, names, text = found.groups()
        rest = []
        while number < len(lines) and lines[number].startswith(f"{margin} "):
            rest.append(lines[number])
            number += 1
        for name in names.split(", "):
            yield from (f"{margin}{name}: {text}", *rest)


def _name(alias: TypeAliasForwardRef) -> str:
    return alias.name


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    TypeAliasForwardRef.__repr__ = _name  # type: ignore[method-assign]  # Sphinx 9.0 in unions
    app.connect("missing-reference", resolve)
    app.connect("autodoc-process-docstring", before_napoleon, priority=400)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
