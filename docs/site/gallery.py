"""The gallery: a picture of every case, in groups, and of the pages of the guide."""

import io
from collections.abc import Iterator, Mapping, Sequence

from PIL import Image, ImageChops

from pictures import small
from verification.case import Case
from verification.report.blocks import Picture
from verification.report.drawing import Drawn

_GROUPS: Mapping[str, frozenset[str]] = {
    "In space": frozenset({"space"}),
    "Solvers": frozenset({"couplings"}),
    "Frames": frozenset({"frames"}),
    "Masonry": frozenset({"masonry"}),
    "Soil": frozenset({"soil", "water", "regions", "field", "body force"}),
    "Metals": frozenset({"hardening"}),
    "Contact": frozenset({"contact"}),
}
"""Tags of each group: a case is in the first that it has a tag of; all others are of metal."""
_SHOWN = ("Soil", "Masonry", "Frames", "Metals", "Contact", "In space", "Solvers")
_EXAMPLES = {
    "Examples of the guide": (
        ("footing.png", "A footing on layered soil", "../guide/footing"),
        ("inclined.png", "Which loads a footing carries beside a push", "../guide/footing"),
        ("envelope.png", "Which loads a footing carries together", "../guide/questions"),
        ("square-section.png", "Under the edge of a square footing", "../guide/solids"),
        ("dome.png", "A dome that is shaken", "../guide/domes"),
        ("bridge.png", "An arch bridge under a wheel", "../guide/bridge"),
        ("wall.png", "A facade", "../guide/friction"),
        ("portal.png", "A portal on sliding feet", "../guide/structures"),
        ("plate.png", "A plate with a hole", "../guide/structures"),
        ("upset.png", "A block is pressed to half its height", "../guide/forming"),
        ("billet.png", "A billet is upset", "../guide/large-deformation"),
        ("mechanism.png", "A block that is crushed", "../index"),
    )
}
_WIDE, _HIGH = 480, 360  # pixels of a picture in the gallery: it is shown half as wide
_RIM = 24  # pixels, of paper left in all


def group(case: Case) -> str:
    """Where a case stands."""
    return next((name for name, tags in _GROUPS.items() if tags & {*case.tags}), "Metals")


def page(cases: Sequence[Case], drawn: Drawn) -> str:
    """All cases by group, then the guide."""
    parts = ["# Gallery", "Every case of the catalogue; a picture leads to its page of the manual."]
    for name in _SHOWN:
        own = [case for case in cases if group(case) == name]
        parts += [f"## {name}", _grid(_card(case, drawn) for case in own)]
    for name, examples in _EXAMPLES.items():
        cards = (_shown(f"/{file}", title, link) for file, title, link in examples)
        parts += [f"## {name}", _grid(cards)]
    return "\n\n".join(parts) + "\n"


def _grid(cards: Iterator[str]) -> str:
    return "::::{grid} 2 2 3 4\n:gutter: 2\n\n" + "\n".join(cards) + "\n::::"


def _card(case: Case, drawn: Drawn) -> str:
    own = _picture(case, drawn)
    file = f"/pictures/gallery/{own.name}.png" if own else ""
    return _shown(file, case.title, f"/manual/{case.id}")


def _shown(file: str, title: str, link: str) -> str:
    picture = f":img-top: {file}\n:img-alt: {title}\n" if file else ""
    return f":::{{grid-item-card}} {title}\n{picture}:link: {link}\n:link-type: doc\n:::"


def _picture(case: Case, drawn: Drawn) -> Picture | None:
    found = drawn.get(small(case).name)
    return found if isinstance(found, Picture) else None


def thumbnails(cases: Sequence[Case], drawn: Drawn) -> Mapping[str, bytes]:
    """Small pictures of the cases, by their paths."""
    found = [own for case in cases if (own := _picture(case, drawn))]
    return {f"pictures/gallery/{own.name}.png": _small(own.data) for own in found}


def _small(data: bytes) -> bytes:
    with Image.open(io.BytesIO(data)) as whole:
        drawn = whole.convert("RGB")
    margin = ImageChops.difference(drawn, Image.new("RGB", drawn.size, "white")).getbbox()
    inner = drawn.crop(margin)
    inner.thumbnail((_WIDE - _RIM, _HIGH - _RIM), Image.Resampling.LANCZOS)
    paper = Image.new("RGB", (_WIDE, _HIGH), "white")
    paper.paste(inner, ((_WIDE - inner.width) // 2, (_HIGH - inner.height) // 2))
    buffer = io.BytesIO()
    paper.quantize(64).save(buffer, format="PNG", optimize=True)
    return buffer.getvalue()
