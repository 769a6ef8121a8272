"""The gallery: pictures of all cases in groups, and pictures of the guide."""

from collections.abc import Iterator, Mapping, Sequence

from lacore_verification.case import Case
from lacore_verification.report.blocks import Picture
from lacore_verification.report.drawing import Drawn
from pictures import small

_GROUPS: Mapping[str, frozenset[str]] = {
    "Three dimensions": frozenset({"space"}),
    "Solvers": frozenset({"couplings"}),
    "Frames": frozenset({"frames"}),
    "Masonry": frozenset({"masonry"}),
    "Soil": frozenset({"soil", "water", "regions", "field", "body force"}),
    "Metals": frozenset({"hardening"}),
    "Contact": frozenset({"contact"}),
}
"""Tags of each group: a case belongs to the first group with one of its tags, else to metals."""
_SHOWN = ("Soil", "Masonry", "Frames", "Metals", "Contact", "Three dimensions", "Solvers")
_EXAMPLES = {
    "Examples of the guide": (
        ("footing-collapse.png", "Strip footing on clay", "../index"),
        ("footing.png", "Footing on layered soil", "../guide/footing"),
        ("inclined.png", "Footing under vertical and horizontal load", "../guide/footing"),
        ("envelope.png", "Combinations of loads that a footing carries", "../guide/questions"),
        ("square-section.png", "Section below the edge of a square footing", "../guide/solids"),
        ("dome.png", "Dome under horizontal acceleration", "../guide/domes"),
        ("arch.png", "Masonry arch under a point load", "../guide/problem-file"),
        ("bridge.png", "Arch bridge under a wheel load", "../guide/bridge"),
        ("wall.png", "Masonry wall pushed sideways", "../guide/friction"),
        ("portal.png", "Portal frame on sliding feet", "../guide/structures"),
        ("plate.png", "Plate with a hole", "../guide/structures"),
        ("upset.png", "Block pressed to half its height", "../guide/forming"),
        ("round-die.png", "Two blocks under a round die", "../guide/two-bodies"),
        ("billet.png", "Upsetting of a billet", "../guide/large-deformation"),
    )
}


def group(case: Case) -> str:
    """Return the group of a case."""
    return next((name for name, tags in _GROUPS.items() if tags & {*case.tags}), "Metals")


def page(cases: Sequence[Case], drawn: Drawn) -> str:
    """Return the page: all cases by group, then the examples of the guide."""
    parts = [
        "# Gallery",
        "These are all verification cases, followed by examples of the guide. Each picture leads to"
        " the page of its case, or to the page of the guide that explains it.",
    ]
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
    """Return small pictures of the cases by their paths."""
    found = [own for case in cases if (own := _picture(case, drawn))]
    return {f"pictures/gallery/{own.name}.png": own.data for own in found}
