"""Lines of GeoJSON files (RFC 7946), their layers the property "layer"."""

from collections import Counter
from collections.abc import Iterator, Set
from typing import Any

import numpy as np
import shapely
from shapely.errors import ShapelyError

from lacore.model.bodies.blocks.drawings.strokes import Drawing, Stroke, refused
from lacore.reporting.errors import InputError

UNNAMED = "0"  # layer of features without one, as in DXF
TYPES = (
    *("FeatureCollection", "Feature", "GeometryCollection", "Point", "MultiPoint"),
    *("LineString", "MultiLineString", "LinearRing", "Polygon", "MultiPolygon"),
)
"""Values of the key `type` of GeoJSON."""
_AREAS, _LINES = ("Polygon", "MultiPolygon"), ("LineString", "MultiLineString", "LinearRing")


def read_geojson(path: str, content: dict[str, Any], layers: Set[str]) -> Drawing:
    """Return the polygons and lines of some layers.

    Args:
        path: path of the file, for messages.
        content: result of `json`: a collection of features, a feature, or a geometry.
        layers: layers of the lines; the layer of a feature is its property "layer", else "0".

    Raises:
        InputError: invalid geometries, or polygons with holes.
    """
    strokes, there, skipped = [], set(), Counter[str]()
    for number, feature in enumerate(_features(path, content)):
        properties = feature.get("properties")
        properties = properties if isinstance(properties, dict) else {}
        layer = str(properties.get("layer", UNNAMED))
        there.add(layer)
        if layer not in layers or feature.get("geometry") is None:
            continue
        handle = str(feature.get("id", properties.get("handle", number + 1)))
        what = f"layer {layer!r}, handle {handle}"
        for geometry in shapely.get_parts(_geometry(feature["geometry"], path, what)):
            if geometry.geom_type in _AREAS:
                strokes += [
                    _ring(part, layer, handle, path) for part in shapely.get_parts(geometry)
                ]
            elif geometry.geom_type in _LINES:
                for part in shapely.get_parts(geometry):
                    strokes.append(_line(part, layer, handle))
            else:
                skipped[geometry.geom_type] += 1
    return Drawing(tuple(strokes), tuple(there), None, dict(skipped))


def _features(path: str, content: dict[str, Any]) -> Iterator[dict[str, Any]]:
    kind = content.get("type")
    if kind == "FeatureCollection":
        features = content.get("features")
        if not isinstance(features, list) or not all(isinstance(own, dict) for own in features):
            raise InputError("path", path, "a FeatureCollection without features", "write it anew")
        yield from features
    elif kind == "Feature":
        yield content
    else:
        yield {"geometry": content}


def _geometry(given: Any, path: str, what: str) -> Any:
    try:
        geometry = shapely.geometry.shape(given)
    except (ShapelyError, KeyError, ValueError, TypeError, AttributeError, IndexError) as error:
        why = f"no geometry of GeoJSON ({type(error).__name__} {error})"
        raise refused(path, what, why, "write it anew") from None
    if not np.all(np.isfinite(shapely.get_coordinates(geometry))):
        raise refused(path, what, "has coordinates that are not finite", "write it anew")
    return geometry


def _ring(polygon: Any, layer: str, handle: str, path: str) -> Stroke:
    if shapely.get_num_interior_rings(polygon):
        what = f"layer {layer!r}, handle {handle}"
        raise refused(path, what, "a polygon with a hole", "cut it into blocks without holes")
    points = shapely.get_coordinates(shapely.get_exterior_ring(polygon))[:-1]
    return Stroke(layer, handle, points, closed=True)


def _line(line: Any, layer: str, handle: str) -> Stroke:
    points = shapely.get_coordinates(line)
    closed = len(points) > 2 and np.array_equal(points[0], points[-1])
    return Stroke(layer, handle, points[:-1] if closed else points, closed)
