"""What is on a picture: its words, faces and lines."""

from io import BytesIO

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_hex

import lacore as la
from lacore.model.bodies.blocks import masonry


def drawn(figure):
    """Render, so that everything lazy is done; warnings are errors."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png")
    assert buffer.getvalue().startswith(b"\x89PNG")
    return figure


def words(figure):
    texts = [figure.get_suptitle()]
    for axes in (one for own in figure.axes for one in (own, *own.child_axes)):
        texts += [axes.get_title(loc="right"), axes.get_xlabel(), axes.get_ylabel()]
        if axes.get_legend():
            texts += [text.get_text() for text in axes.get_legend().get_texts()]
    return "\n".join(texts)


def column(size, friction, dead=(0, -1), live=(1, 0)):
    """One block on a fixed base, pushed in proportion to its weight."""
    return la.Problem(
        bodies={"column": masonry.stack([size], friction)},
        reference_loads=[la.BodyForce("column", live)],
        supports=[la.Fix("column", "base")],
        dead_loads=[la.BodyForce("column", dead)],
    )


def polygons(axes, colour):
    """Vertices (k, 2) of all faces of a colour."""
    return [
        path.vertices[:-1]
        for item in axes.collections
        if isinstance(item, PolyCollection)
        and colour in [to_hex(own) for own in item.get_facecolor()[:1]]
        for path in item.get_paths()
    ]


def lines(axes, colour):
    """Points (k, 2) and widths of all lines of a colour."""
    return [
        (segment, width)
        for item in axes.collections
        if isinstance(item, LineCollection) and to_hex(item.get_colors()[0]) == colour
        for segment, width in zip(
            item.get_segments(),
            np.resize(item.get_linewidths(), len(item.get_segments())),
            strict=True,
        )
    ]
