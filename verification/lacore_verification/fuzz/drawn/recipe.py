"""From a recipe to its problem: plain data that can be drawn, copied, reduced and stored.

A recipe has ``bodies`` by name, and lists ``reference``, ``dead``, ``supports``, ``interfaces``:
each entry has the arguments of the class it names, boundaries as names or as a line of two points.
That of a path has ``path``: the arguments of `lacore.sequential`, and velocities of ``tools``.
"""

# Annotations are not evaluated: names of lacore in them load nothing.
from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

import lacore as la
from lacore.reporting.errors import require_known

if TYPE_CHECKING:
    from skfem import MeshQuad, MeshTri

    from lacore.numerics.arrays import Bools, Floats

Recipe = dict[str, Any]
LISTS = ("reference", "dead", "supports", "interfaces")
_NEAR = 1e-7  # Relative to the length of a line: tolerance for rotated coordinates.
LOADS = ("Traction", "Pressure", "BodyForce", "PointForce", "RigidFooting")


@dataclass(frozen=True)
class OnLine:
    """Predicate for places (2, n) on a straight line between two points, m."""

    start: tuple[float, float]
    end: tuple[float, float]
    __name__: str = "line"

    def __call__(self, places: Floats) -> Bools:
        """Return whether places are on the line, as boundaries require."""
        start, end = np.reshape(self.start, (2, 1)), np.reshape(self.end, (2, 1))
        length = np.linalg.norm(end - start)
        along = (end - start) / length
        rest = np.asarray(places) - start
        away = np.abs(along[0] * rest[1] - along[1] * rest[0])
        share = (along * rest).sum(axis=0) / length
        return np.asarray((away <= _NEAR * length) & (share >= -_NEAR) & (share <= 1 + _NEAR))


def as_text(recipe: Recipe) -> str:
    """Return a recipe as JSON, the same for equal ones."""
    return json.dumps(recipe, sort_keys=True)


def copied(recipe: Recipe) -> Recipe:
    """Return a copy of a recipe, to be changed."""
    made: Recipe = json.loads(as_text(recipe))
    return made


def build(recipe: Mapping[str, Any]) -> la.Problem:
    """Return the problem of a recipe.

    Raises:
        InputError: lacore rejects the recipe.
    """
    return la.Problem(
        bodies={name: body_of(data) for name, data in recipe["bodies"].items()},
        reference_loads=[load_of(data) for data in recipe["reference"]],
        supports=[
            la.Fix(data["body"], where_of(data["where"]), data.get("components", "xy"))
            for data in recipe["supports"]
        ],
        interfaces=[
            la.Interface(
                side_of(data["slave"], f"i{number}"),
                master_of(data["master"]),
                law_of(data["friction"]),
            )
            for number, data in enumerate(recipe["interfaces"])
        ],
        dead_loads=[load_of(data) for data in recipe["dead"]],
    )


def law_of(data: Any) -> Any:
    """Return a friction law: a coefficient, ``{"associated": mu}``, ``{"tresca".

    Limit}``, or a word.
    """
    if isinstance(data, Mapping):
        ((kind, value),) = data.items()
        return la.Tresca(value) if kind == "tresca" else la.Coulomb(value, associated=True)
    return (
        {"smooth": la.SMOOTH, "stick": la.STICK}.get(data, data)
        if isinstance(data, str)
        else float(data)
    )


def where_of(data: Any, name: str = "line") -> Any:
    """Return a name, names, or a line between two points."""
    if isinstance(data, str) or data is None:
        return data
    if isinstance(data[0], str):
        return tuple(data)
    (start, end) = data
    return OnLine(tuple(start), tuple(end), name)


def master_of(data: Any) -> Any:
    """Return a rigid obstacle as the slave's shape, a plane obstacle, or a side of another body."""
    if data is None:
        return la.RigidObstacle()
    if isinstance(data, Mapping):
        return la.RigidObstacle(tuple(data["point"]), tuple(data["normal"]))
    return side_of(data, "master")


def side_of(data: Sequence[Any], name: str) -> tuple[str, Any]:
    """Return body and boundary of one side of an interface."""
    return data[0], where_of(data[1], name)


def load_of(data: Mapping[str, Any]) -> Any:
    """Return a load from its class and arguments."""
    given = {name: value for name, value in data.items() if name not in ("load", "growth")}
    if "where" in given:
        given["where"] = where_of(given["where"])
    for name in ("vector", "direction", "at"):
        if name in given and not isinstance(given[name], str):
            given[name] = tuple(given[name])
    if "growth" in data:
        at = given.pop("at")
        given["vector"] = tuple(
            la.Linear(part, tuple(part * slope for slope in data["growth"]), at)
            for part in given["vector"]
        )
    require_known("load", data["load"], LOADS)
    return getattr(la, data["load"])(**given)


def body_of(data: Mapping[str, Any]) -> Any:
    """Return a body: a continuum on a mapped rectangle, blocks, or a frame."""
    if data["kind"] == "continuum":
        strength, slope = data["strength"], data.get("hardening")
        metal: Any = la.VonMises(shear_strength=strength)
        if slope is not None:
            metal = la.VonMises(hardening=la.hardening.Linear(sqrt(3) * strength, slope))
        if "soil" in data:
            metal = Soil(data).criterion
        return la.Body(
            mesh_of(data["mesh"]),
            metal,
            kinematics=data["kinematics"],
            space=data["space"],
        )
    if data["kind"] == "blocks":
        laws = {(one, other): law_of(law) for one, other, law in data["joints"]}
        return la.BlockAssembly(data["polygons"], law_of(data["friction"]), laws)
    return la.Frame(
        {name: tuple(place) for name, place in data["nodes"].items()},
        {name: tuple(pair) for name, pair in data["members"].items()},
        data.get("plastic_moment"),
        [tuple(pair) for pair in data.get("releases", ())],
        sections=_sections_of(data) if "sections" in data else None,
    )


def _sections_of(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return rectangular sections by member, with polygons in or around their yield curves."""
    return {
        member: la.sections.rectangle(width, height, stress, polygon=data["polygon"])
        for member, (width, height, stress) in data["sections"].items()
    }


@dataclass(frozen=True)
class Soil:
    """A soil whose cohesion, friction angle and cut-offs vary linearly over its body.

    Attributes:
        data: of the body. ``strength`` is its cohesion; ``soil`` has the ``angle``, in degrees, and
            the cut-offs ``tension`` and ``crushing`` per cohesion, None for none; ``slopes``, by
            name, of each relative to its value; ``divisor`` of all strengths.
    """

    data: Mapping[str, Any]

    @property
    def criterion(self) -> la.MohrCoulomb:
        """The criterion of the body."""
        soil = self.data["soil"]
        angle: Any = self._linear("angle")
        divisor = soil.get("divisor", 1.0)
        if divisor != 1.0:
            steepest = float(np.hypot(*angle.gradient)) * max(1.0, 1 / divisor)
            angle = la.Field(lambda places: self.at("angle", places), steepest or None)
        cuts = {
            name: None if soil[name] is None else self._linear(name)
            for name in ("tension", "crushing")
        }
        return la.MohrCoulomb(
            self._linear("cohesion"),
            angle,
            tension_cutoff=cuts["tension"],
            crushing=cuts["crushing"],
        )

    def at(self, name: str, places: Floats) -> Floats:
        """Return cohesion, angle in degrees or a cut-off, Pa, at places (2, ...)."""
        flat: Floats = np.asarray(self._linear(name)(places.reshape(2, -1)))
        values: Floats = flat.reshape(places.shape[1:])
        divisor = self.data["soil"].get("divisor", 1.0)
        if name != "angle" or divisor == 1.0:
            return values
        return np.asarray(np.degrees(np.arctan(np.tan(np.radians(values)) / divisor)))

    def _linear(self, name: str) -> la.Linear:
        """Return a strength, divided, or the angle without division."""
        soil, mesh = self.data["soil"], self.data["mesh"]
        value = soil["angle"]
        if name != "angle":
            share = 1.0 if name == "cohesion" else soil[name]
            value = share * self.data["strength"] / soil.get("divisor", 1.0)
        slope = np.linalg.solve(np.array(mesh["map"]).T, soil["slopes"][name])
        return la.Linear(value, tuple(value * slope), tuple(mesh["shift"]))


def force_density(load: Mapping[str, Any], places: Floats) -> Floats:
    """Return a body force at places (2, cells, q), N/m^3, of the same shape."""
    growth, at = (np.array(load.get(name, (0.0, 0.0)), dtype=float) for name in ("growth", "at"))
    factor = 1 + np.tensordot(growth, places - at[:, None, None], 1)
    return np.asarray(np.array(load["vector"], dtype=float)[:, None, None] * factor)


def mesh_of(data: Mapping[str, Any]) -> MeshTri | MeshQuad:
    """Return a mesh of a rectangle, its points mapped by ``map`` (2, 2) and ``shift``.

    If ``polar`` is set, x and y of the rectangle are radii and angles.
    """
    x, y = tuple(data["x"]), tuple(data["y"])
    if data["cut"] == "quads":
        mesh: Any = la.meshes.quadrilaterals(x, y, data["nx"], data["ny"])
    else:
        mesh = la.meshes.rectangle(x, y, data["nx"], data["ny"], crossed=data["cut"] == "crossed")
    matrix, shift = np.array(data["map"]), np.reshape(data["shift"], (2, 1))
    boundaries = dict(mesh.boundaries)
    points, cells = mesh.p, mesh.t
    if data.get("polar"):
        points = points[0] * np.stack([np.cos(points[1]), np.sin(points[1])])
    points = matrix @ points + shift
    if np.linalg.det(matrix) > 0:
        made = type(mesh)(points, cells)
    else:  # A reflection inverts the orientation of each element.
        made = type(mesh)(points, cells[[0, 2, 1] if len(cells) == 3 else [0, 3, 2, 1]])
    # Facets may have new numbers: they are identified by their ends.
    known = {tuple(sorted(pair)): number for number, pair in enumerate(made.facets.T.tolist())}
    pairs = mesh.facets.T.tolist()
    return made.with_boundaries(
        {
            name: np.array([known[tuple(sorted(pairs[f]))] for f in facets])
            for name, facets in boundaries.items()
        }
    )
