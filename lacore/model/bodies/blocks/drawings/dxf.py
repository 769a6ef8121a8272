"""Lines of DXF files: LINE, LWPOLYLINE, POLYLINE, HATCH, and those of inserted symbols."""

from collections import Counter
from collections.abc import Iterator, Set
from typing import Any

import numpy as np

from lacore.model.bodies.blocks.drawings.strokes import Drawing, Stroke, metres, refused
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError

_UNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 7: "km", 10: "yd", 14: "dm"}
"""Units of $INSUNITS (DXF reference, HEADER section)."""
_CURVES = ("ARC", "CIRCLE", "ELLIPSE", "SPLINE")
_LINES = ("LINE", "LWPOLYLINE", "POLYLINE")
_FLAT = 1e-9  # by the size: heights of lines in one plane
_BEZIERS = 16  # per circle: their error is below 1e-6 of its radius
_DEEPEST = 16  # depth of symbols in symbols; deeper ones insert themselves


def read_dxf(path: str, layers: Set[str], unit: str | None, sagitta: float | None) -> Drawing:
    """Return the lines of some layers in the model space of a DXF file.

    Lines in layer "0" of an inserted symbol belong to the layer of the insertion.

    Args:
        path: path of the file.
        layers: layers of the lines.
        unit: unit of the drawing, instead of that of the file; None: that of the file.
        sagitta: m, largest distance of chords from curves; None rejects curves.

    Raises:
        InputError: a file that cannot be read, curves without `sagitta`, or lines out of the plane.
    """
    document = _load(path)
    said = _unit(document, path)
    if sagitta is not None:
        sagitta /= metres(path, said, unit)[1]
    strokes, there, skipped = [], set(), Counter[str]()
    for entity, layer, handle in _flat(document.modelspace(), None, path, 0):
        there.add(layer)
        if layer not in layers:
            continue
        own = [*_outlines(entity, layer, handle, path, sagitta)]
        strokes += own
        if not own:
            skipped[entity.dxftype()] += 1
    return Drawing(tuple(strokes), tuple(there), said, dict(skipped))


def _unit(document: Any, path: str) -> str | None:
    """Return the unit in $INSUNITS; None if it is "unitless"."""
    number = document.header.get("$INSUNITS", 0)
    if number and number not in _UNITS:
        raise InputError(
            "path", path, f"is drawn in the unit {number} of $INSUNITS", "save it in mm, cm, m, in"
        )
    return _UNITS.get(number)


def _load(path: str) -> Any:
    """Return the document; if its structure is damaged, the part that can be recovered."""
    from ezdxf import recover  # imported here because it takes a tenth of a second
    from ezdxf.filemanagement import readfile
    from ezdxf.lldxf.const import DXFError

    try:
        return readfile(path)
    except (DXFError, UnicodeError):
        try:
            return recover.readfile(path)[0]
        except (DXFError, UnicodeError, OSError) as error:
            why = f"{type(error).__name__} {error}".strip()
    except OSError as error:  # not a DXF file
        why = str(error)
    raise InputError("path", path, f"cannot be read as DXF ({why})", "save it as DXF 2000 or later")


def _flat(
    entities: Any, inserted: tuple[str, str] | None, path: str, depth: int
) -> Iterator[tuple[Any, str, str]]:
    """Yield entities, their layers and handles; those of symbols have the insertion's handle."""
    for entity in entities:
        layer, handle = entity.dxf.layer, str(entity.dxf.handle)
        if inserted is not None:
            layer, handle = inserted[0] if layer == "0" else layer, inserted[1]
        if entity.dxftype() != "INSERT":
            yield entity, layer, handle
        elif depth == _DEEPEST:
            raise refused(path, f"handle {handle}", "a symbol that contains itself", "explode it")
        else:
            yield from _flat(entity.virtual_entities(), (layer, handle), path, depth + 1)


def _outlines(
    entity: Any, layer: str, handle: str, path: str, sagitta: float | None
) -> Iterator[Stroke]:
    """Yield the strokes of an entity; none for a text or a dimension."""
    from ezdxf.path import from_hatch, make_path

    kind = entity.dxftype()
    if kind in (*_LINES, *_CURVES):
        paths = [make_path(entity, segments=_BEZIERS)]
    elif kind == "HATCH":
        paths = [*from_hatch(entity)]
    else:
        return
    what = f"layer {layer!r}, handle {handle} ({kind})"
    for own in paths:
        if not own.has_curves:
            vertices = iter(own.control_vertices())
        elif sagitta is not None:
            vertices = own.flattening(sagitta, segments=1)
        else:
            why = "a curve, where blocks have straight edges"
            raise refused(path, what, why, "give sagitta=, in m")
        points = np.array([tuple(vertex) for vertex in vertices], dtype=np.float64).reshape(-1, 3)
        if not np.all(np.isfinite(points)):
            raise refused(path, what, "has coordinates that are not finite", "draw it anew")
        _require_plane(points, what, path)
        closed = kind == "HATCH" or own.is_closed
        points = points[:, :2]
        if closed and len(points) > 1 and np.array_equal(points[0], points[-1]):
            points = points[:-1]
        yield Stroke(layer, handle, points, closed)


def _require_plane(points: Floats, what: str, path: str) -> None:
    if not len(points):
        return
    height = points[:, 2]
    if np.ptp(height) > _FLAT * max(np.linalg.norm(np.ptp(points, axis=0)), np.abs(points).max()):
        raise refused(
            path,
            what,
            f"is not plane: z goes from {height.min():.6g} to {height.max():.6g}",
            "draw the blocks in the plane of x and y",
        )
