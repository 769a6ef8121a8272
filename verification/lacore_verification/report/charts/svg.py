"""Figures as inline SVG without files and fonts, and with all colours adapted to dark mode."""

import io
import re
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple
from xml.etree import ElementTree

from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lacore_verification.report.charts.theme import VARIABLES, freeze, styled

_POINTS = 72  # of an SVG of matplotlib per inch
_REACH = 7.0  # points: radius around a marker that shows its values
_DIGITS = 2  # digits of coordinates in points: finer than any screen
_NUMBER = re.compile(r"-?\d+\.\d+")
_COLOUR = re.compile(r"#[0-9a-fA-F]{6}\b")
_FONT = re.compile(r"font(?:-family)?:[^;]*;?\s*")
_SIZE = re.compile(r"([\d.]+)px")
_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_OWN_DOCUMENT = ("metadata", "style", "title")
_COORDINATES = ("d", "x", "y", "width", "height", "transform", "points", "cx", "cy", "r")


class Tip(NamedTuple):
    """Tooltip of a point; coordinates are those of the data of `axes`."""

    axes: Axes
    x: float
    y: float
    text: str


@dataclass(frozen=True)
class Chart:
    """A figure with tooltips of its points.

    Attributes:
        figure: drawn with `lacore_verification.report.charts.theme.styled`.
        summary: one sentence for readers who cannot see it.
        tips: tooltips.
    """

    figure: Figure
    summary: str
    tips: Sequence[Tip] = ()


def inline(chart: Chart, name: str) -> Markup:
    """Return a chart as an ``<svg>`` element for the page, with equal bytes on each run.

    Lines and text have the colours of the page, and text its font; points have tooltips. It has no
    external references.

    Args:
        chart: the figure; its layout is frozen.
        name: unique on the page, of letters, digits and ``-``: all ids in it begin with it.

    Raises:
        ValueError: `name` is not such a name.
    """
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9-]*", name):
        raise ValueError(f"{name!r} cannot begin an id; use letters, digits and -")
    root = ElementTree.fromstring(_saved(chart.figure))
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
        element.attrib = {key.rpartition("}")[2]: text for key, text in element.attrib.items()}
    _drop(root, _OWN_DOCUMENT)
    _rename(root, name)
    _trim(root)
    for element in root.iter():
        _theme(element)
    root.attrib = {
        "viewBox": root.get("viewBox", ""),
        "width": "100%",
        "role": "img",
        "aria-label": _NOT_XML.sub("\ufffd", chart.summary),
        "style": "stroke-linejoin: round; stroke-linecap: butt",
    }
    root.extend(_spots(chart))
    # This is data, not markup: the parser has escaped every text in it.
    return Markup(ElementTree.tostring(root, encoding="unicode", short_empty_elements=True))


def _saved(figure: Figure) -> str:
    """Return the output of matplotlib, with a fixed layout so that points can be located."""
    figure.set_dpi(_POINTS)
    with styled(), warnings.catch_warnings():
        # The browser has fonts for names that the one of matplotlib has no letters for.
        warnings.filterwarnings("ignore", "Glyph .* missing from font")
        freeze(figure)
        buffer = io.StringIO()
        figure.savefig(buffer, format="svg", transparent=True, metadata={"Date": None})
    return _NOT_XML.sub("\ufffd", buffer.getvalue())


def _drop(root: ElementTree.Element, tags: Sequence[str]) -> None:
    """Remove elements of a separate file; a style sheet in it would apply to the whole page."""
    for parent in list(root.iter()):
        for child in [child for child in parent if child.tag in tags]:
            parent.remove(child)
    for parent in list(root.iter()):
        for child in [child for child in parent if child.tag == "defs" and len(child) == 0]:
            parent.remove(child)


def _rename(root: ElementTree.Element, name: str) -> None:
    """Number the referenced ids, after the name, and drop all others."""
    texts = [text for element in root.iter() for text in element.attrib.values()]
    used = set(re.findall(r"url\(#([^)]+)\)", " ".join(texts)))
    used |= {text[1:] for element in root.iter() if (text := element.get("href", ""))}
    ids: dict[str, str] = {}
    for element in root.iter():
        own = element.attrib.pop("id", "")
        if own in used:
            ids.setdefault(own, f"{name}-{len(ids)}")
            element.set("id", ids[own])
    for element in root.iter():
        for key, text in element.attrib.items():
            if key == "href":
                element.set(key, f"#{ids[text[1:]]}")
            elif "url(#" in text:
                element.set(key, re.sub(r"url\(#([^)]+)\)", lambda m: f"url(#{ids[m[1]]})", text))


def _trim(root: ElementTree.Element) -> None:
    """Remove groups without content and, outside of text, indentation."""
    for parent in reversed(list(root.iter())):
        for child in list(parent):
            if child.tag == "g" and not child.attrib and len(child) == 0:
                parent.remove(child)
        if parent.tag not in ("text", "tspan"):
            parent.text = (parent.text or "").strip() or None
            for child in parent:
                child.tail = (child.tail or "").strip() or None


def _theme(element: ElementTree.Element) -> None:
    """Replace colours by variables, fonts by those of the page, and round coordinates."""
    for key, text in element.attrib.items():
        if key in _COORDINATES and "scale" not in text and "matrix" not in text:
            element.set(key, _NUMBER.sub(lambda m: _short(float(m[0])), text))
    style = element.get("style")
    if style is None:
        return
    if element.tag in ("text", "tspan"):
        size = _SIZE.search(style)
        style = _FONT.sub("", style) + (f"; font-size: {size[1]}px" if size else "")
        style = style.removeprefix("; ")
    element.set("style", _COLOUR.sub(_variable, style))


def _variable(match: re.Match[str]) -> str:
    name = VARIABLES.get(match[0].lower())
    return f"var({name})" if name else match[0]


def _short(value: float) -> str:
    text = f"{value:.{_DIGITS}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def _spots(chart: Chart) -> Iterator[ElementTree.Element]:
    """Yield a circle over each point, visible only under the pointer."""
    scale = _POINTS / chart.figure.dpi
    height = chart.figure.get_figheight() * _POINTS
    for tip in chart.tips:
        x, y = tip.axes.transData.transform((tip.x, tip.y)) * scale
        place = {"cx": _short(x), "cy": _short(height - y), "r": _short(_REACH)}
        spot = ElementTree.Element("circle", {"class": "tip", **place})
        ElementTree.SubElement(spot, "title").text = _NOT_XML.sub("\ufffd", tip.text)
        yield spot
