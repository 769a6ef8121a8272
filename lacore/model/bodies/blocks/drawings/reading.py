"""Blocks and outlines from a drawing."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence, Set
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np

from lacore.model.bodies.blocks.drawings.compas import read_compas
from lacore.model.bodies.blocks.drawings.drawn import DrawnBlocks, Layer
from lacore.model.bodies.blocks.drawings.dxf import read_dxf
from lacore.model.bodies.blocks.drawings.geojson import TYPES, read_geojson
from lacore.model.bodies.blocks.drawings.joints import LayerFriction, assembled
from lacore.model.bodies.blocks.drawings.outlines import grown, outlines
from lacore.model.bodies.blocks.drawings.strokes import Drawing, Stroke, metres
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError, require_known, require_positive, suggest_all, typed

SNAP = 1e-5  # by the size of the drawing: a tenth of a millimetre on ten metres
_RESERVED = str.maketrans(
    "|#", "//"
)  # Joints are named "a|b#2", and layers of references "plan|stone".


@typed(layers="give {'stone': la.masonry.Layer(friction=0.6, density=2400)}")
def read(
    path: str | PathLike[str],
    layers: Mapping[str, Layer],
    snap: float | None = None,
    unit: str | None = None,
    openings: Sequence[str] = (),
    joint_friction: LayerFriction | None = None,
    sagitta: float | None = None,
    gap: float | None = None,
) -> DrawnBlocks:
    """Read blocks from a drawing: DXF, GeoJSON, or an assembly of compas (JSON).

    Closed outlines are blocks, and so are the faces of the network of open lines of one layer:
    stones between joints that are drawn once. Vertices closer than `snap` are merged, and corners
    close to an edge are moved onto it. Draw stones up to the middle of mortar joints, or give the
    `gap`. A block that is drawn twice in a layer is read once.

    Args:
        path: path of the file: .dxf, .geojson or .json.
        layers: materials of blocks by layer; other layers are ignored. The layer of a feature of
            GeoJSON is its property "layer" (else "0"), that of a block of compas its attribute
            "layer", else "support" or "block".
        snap: m; 1e-5 of the size of the drawing if None.
        unit: unit of the drawing, instead of that of the file: "m", "dm", "cm", "mm", "km", "in",
            "ft", "yd"; None: $INSUNITS of a DXF.
        openings: layers of outlines of windows and doors: faces within one are not blocks.
        joint_friction: law of joints between two layers, by pair; by default the weaker one of
            both.
        sagitta: m: largest distance of chords from curves; None: curves are rejected.
        gap: m: width of mortar joints that are drawn as gaps: each outline is moved outwards by
            half of it on all sides.

    Raises:
        InputError: a file that cannot be read, no unit, a missing layer; open lines, slivers, or
            overlapping blocks, with layer, handle and place; anything that `BlockAssembly` rejects.

    Example:
        >>> import ezdxf
        >>> drawing = ezdxf.new(units=6)  # m
        >>> for x in (0, 1):
        ...     stone = [(x, 0), (x + 1, 0), (x + 1, 1), (x, 1)]
        ...     outline = drawing.modelspace().add_lwpolyline(stone, close=True)
        >>> drawing.saveas("stones.dxf")
        >>> layers = {"0": la.masonry.Layer(friction=0.6, density=2000.0)}
        >>> la.masonry.read("stones.dxf", layers).blocks.names
        ('0 1', '0 2')
    """
    shown = fspath(path)
    _require_layers(layers, openings)
    for name, value in (("snap", snap), ("sagitta", sagitta), ("gap", gap)):
        if value is not None:
            require_positive(name, value)
    wanted = (*layers, *openings)
    drawing = _drawing(shown, {*wanted}, unit, sagitta)
    strokes, unit = _strokes(shown, drawing, wanted, unit)
    if snap is None:
        snap = SNAP * _size(strokes)
        require_positive("snap", snap)
    found = outlines(shown, strokes, set(openings), snap)
    repeated = found.repeated
    if gap is not None:
        found = outlines(shown, grown(found, gap), set(), snap)
    names = _names([own.layer for own in found.rings])
    by_name = dict(zip(names, found.rings, strict=True))
    layer_of = {name: own.layer for name, own in by_name.items()}
    polygons = {name: found.place[:, own.vertices].T for name, own in by_name.items()}
    return DrawnBlocks(
        blocks=assembled(polygons, layer_of, layers, joint_friction or {}),
        layers=dict(layers),
        layer=layer_of,
        handles={name: own.handle for name, own in by_name.items()},
        path=shown,
        unit=unit,
        snap=snap,
        moved=found.moved,
        gap=gap,
        repeated=repeated,
        skipped=drawing.skipped,
        ignored=tuple(sorted(set(drawing.layers).difference(wanted))),
    )


def read_outline(
    path: str | PathLike[str], layer: str | None, unit: str | None, sagitta: float | None
) -> Floats:
    """Return the corners of the only closed outline in a layer, m, shape (k, 2), see `read`.

    Args:
        path, unit, sagitta: see `read`.
        layer: None: the only one of the drawing.

    Raises:
        InputError: see `read`; no or several layers or outlines.
    """
    shown = fspath(path)
    if sagitta is not None:
        require_positive("sagitta", sagitta)
    layers = sorted(_drawing(shown, set(), unit, sagitta).layers)
    if layer is None and len(layers) != 1:
        why = f"the drawing has {len(layers)} layers"
        raise InputError("layer", None, why, f"name one of {layers}" if layers else "draw one")
    layer = layers[0] if layer is None else layer
    require_known("layer", layer, layers)
    drawing = _drawing(shown, {layer}, unit, sagitta)
    strokes, _ = _strokes(shown, drawing, (layer,), unit)
    found = outlines(shown, strokes, set(), SNAP * _size(strokes))
    if len(found.rings) != 1:
        why = f"{shown!r} has {len(found.rings)} closed outlines in this layer"
        raise InputError("layer", layer, why, "give the layer of a single outline")
    return np.asarray(found.place[:, found.rings[0].vertices].T)


def _strokes(
    path: str, drawing: Drawing, layers: Sequence[str], unit: str | None
) -> tuple[list[Stroke], str]:
    """Return the lines in m by layer, and the unit of the drawing."""
    for layer in layers:
        if layer not in drawing.layers:
            fix = suggest_all(layer, sorted(drawing.layers))
            raise InputError("layers", layer, f"{path!r} has no such layer, or nothing in it", fix)
    unit, length = metres(path, drawing.unit, unit)
    strokes = [
        Stroke(own.layer, own.handle, own.points * length, own.closed)
        for own in drawing.strokes
        if len(own.points) > 1
    ]
    empty = [layer for layer in layers if layer not in {own.layer for own in strokes}]
    if empty:
        raise InputError("layers", empty[0], f"a layer without lines in {path!r}", "leave it out")
    return strokes, unit


def _require_layers(layers: Mapping[str, Layer], openings: Sequence[str]) -> None:
    if not isinstance(layers, Mapping) or not layers:
        fix = "give {'stone': la.masonry.Layer(friction=0.6, density=2400)}"
        raise InputError("layers", None, "there is none with a name", fix)
    for name, own in layers.items():
        if not isinstance(own, Layer):
            fix = "give la.masonry.Layer(friction=0.6, density=2400)"
            raise InputError(f"layers[{name!r}]", own, "not what a layer is made of", fix)
    if isinstance(openings, str) or not isinstance(openings, Sequence):
        raise InputError("openings", openings, "not a list of layers", "give ('windows',)")
    for name in openings:
        if name in layers:
            raise InputError("openings", name, "a layer of blocks, too", "draw them in two layers")


def _drawing(path: str, wanted: Set[str], unit: str | None, sagitta: float | None) -> Drawing:
    file = Path(path)
    fix = "give the path of a .dxf, .geojson or .json"
    try:
        there = file.is_file()
    except (OSError, ValueError) as error:  # a name that no file can have
        raise InputError("path", path, "not the name of a file", fix) from error
    if not there:
        raise InputError("path", path, "no such file", fix)
    ending = file.suffix.lower()
    if ending == ".dxf":
        return read_dxf(path, wanted, unit, sagitta)
    if ending not in (".json", ".geojson"):
        fix = "give a .dxf, .geojson or .json; of a DWG its DXF"
        raise InputError("path", path, "a format that is not known", fix)
    content = json_of(path)
    named = isinstance(content, dict) and isinstance(content.get("type"), str)
    if named and (ending == ".geojson" or content["type"] in TYPES):
        return read_geojson(path, content, wanted)
    return read_compas(path, content, wanted)


def json_of(path: str) -> Any:
    """Return the content of a JSON file."""
    try:
        return json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        why = f"cannot be read ({error.strerror or error})"
        raise InputError("path", path, why, "see whether you may read it") from error
    except (ValueError, RecursionError) as error:
        raise InputError("path", path, f"no JSON ({error})", "write it anew") from None


def _size(strokes: Sequence[Stroke]) -> float:
    """Return the diagonal of the bounding box, m."""
    return float(np.linalg.norm(np.ptp(np.concatenate([own.points for own in strokes]), axis=0)))


def _names(layers: Sequence[str]) -> list[str]:
    """Return names ``stone 1``, ``stone 2``, ``brick 1``, ... for layers in order."""
    met: dict[str, int] = {}
    names = []
    for layer in layers:
        own = layer.translate(_RESERVED)
        met[own] = met.get(own, 0) + 1
        names.append(f"{own} {met[own]}")
    return names
