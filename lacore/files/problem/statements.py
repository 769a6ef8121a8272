"""Conversion of objects of lacore to tables of a problem file."""

from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import singledispatch
from math import inf, isinf, pi
from typing import Any

from lacore.files.problem.units import DEGREES
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.frames.frame import Frame
from lacore.model.bodies.frames.section import Section
from lacore.model.conditions import footings, loads, water
from lacore.model.conditions.body_forces import BodyForce
from lacore.model.conditions.linear import ByLevel, Linear
from lacore.model.conditions.where import Where
from lacore.model.conditions.within import Along, Beyond, Within
from lacore.model.contact.interfaces import Interface
from lacore.model.materials import friction, hardening, mohr_coulomb
from lacore.model.materials.drucker_prager import DruckerPrager
from lacore.model.materials.fields import Field, varying
from lacore.model.materials.von_mises import VonMises
from lacore.reporting.errors import InputError, is_number

Table = dict[str, Any]
_TAGS: Mapping[type, tuple[str, str]] = {
    mohr_coulomb.MohrCoulomb: ("criterion", "mohr-coulomb"),
    mohr_coulomb.Rankine: ("criterion", "rankine"),
    mohr_coulomb.NoTension: ("criterion", "no-tension"),
    mohr_coulomb.MaximumShear: ("criterion", "maximum-shear"),
    DruckerPrager: ("criterion", "drucker-prager"),
    VonMises: ("criterion", "von-mises"),
    loads.Traction: ("load", "traction"),
    loads.Pressure: ("load", "pressure"),
    loads.PointForce: ("load", "point-force"),
    footings.RigidFooting: ("load", "rigid-footing"),
}
_LAWS: Mapping[type, str] = {
    hardening.Perfect: "perfect",
    hardening.Linear: "linear",
    hardening.Voce: "voce",
    hardening.Swift: "swift",
    hardening.Table: "table",
}
_WORDS = {friction.SMOOTH: "smooth", friction.STICK: "stick", friction.BOND: "bond"}


def tagged(thing: object, field: str) -> Table:
    """Return a criterion or a load, with all its values that are not None."""
    tag = _TAGS.get(type(thing))
    if tag is None:
        return other(thing, field)
    own = {name: value for name, value in vars(thing).items() if value is not None}
    for name, value in varying(thing).items():
        own[name] = _varying(value, f"{field}.{name}")
    angle = own.get("friction_angle", 0)
    if is_number(angle) and 0 < angle <= pi / 2:  # A plain number would look like radians.
        own["friction_angle"] = f"{angle:.17g} {DEGREES}"
    if "hardening" in own:
        own["hardening"] = _hardening(own["hardening"], f"{field}.hardening")
    if "where" in own and tag[0] == "load":
        own["where"] = place(own["where"], f"{field}.where")
    return {tag[0]: tag[1]} | {name: plain(value) for name, value in own.items()}


def _hardening(law: Any, field: str) -> Table:
    if type(law) not in _LAWS:
        fix = "give a law of lacore.hardening, such as Table of points of it"
        raise InputError(field, law, "a file has no functions", fix)
    numbers = {entry.name: plain(getattr(law, entry.name)) for entry in fields(law)}
    return {"law": _LAWS[type(law)]} | numbers


@singledispatch
def other(thing: object, field: str) -> Table:
    """Return the table of another object; raises `InputError` as files cannot contain it."""
    kind = type(thing).__name__
    raise InputError(field, thing, f"no file can state a {kind}", "keep this problem in Python")


@other.register
def _(thing: BodyForce, field: str) -> Table:
    vector = [
        plain(own) if is_number(own) else _varying(own, f"{field}.vector[{axis}]")
        for axis, own in enumerate(thing.vector)
    ]
    part = {} if thing.where is None else {"where": plain(thing.where)}
    return {"load": "body-force", "body": thing.body, "vector": vector, **part}


@other.register
def _(thing: water.PorePressure, field: str) -> Table:
    return {"load": "pore-pressure", "body": thing.body, "pressure": _water(thing.pressure, field)}


@other.register
def _(thing: water.StandingWater, field: str) -> Table:
    where = place(thing.where, f"{field}.where")
    pressure = _water(thing.pressure, field)
    return {"load": "standing-water", "body": thing.body, "where": where, "pressure": pressure}


def _water(pressure: object, field: str) -> Any:
    if isinstance(pressure, water.WaterTable):
        return {"height": plain(pressure.height), "unit_weight": plain(pressure.unit_weight)}
    if isinstance(pressure, water.PiezometricLine):
        points = [[plain(own) for own in point] for point in pressure.points]
        return {"points": points, "unit_weight": plain(pressure.unit_weight)}
    if isinstance(pressure, Linear | ByLevel):
        return _function(pressure, field)
    if isinstance(pressure, tuple | Callable):
        why = "a file has neither functions nor values at vertices"
        raise InputError(f"{field}.pressure", None, why, "give a lacore.WaterTable or one number")
    return plain(pressure)


def criteria(given: Any, field: str) -> Table:
    """Return the criterion of a body, or those of its regions."""
    if isinstance(given, Mapping):
        return {name: tagged(own, f"{field}[{name!r}]") for name, own in given.items()}
    return tagged(given, field)


def _varying(given: object, field: str) -> Table:
    """Return a field, or a function of place."""
    if not isinstance(given, Field):
        return _function(given, field)
    if given.factor != 1:
        raise InputError(field, given, "a field times a factor", "give it new")
    return _function(given.values, field)


def _function(values: object, field: str) -> Table:
    """Return a function of place that consists of numbers."""
    if isinstance(values, Linear | ByLevel):
        return {name: plain(own) for name, own in vars(values).items()}
    why = "a file has neither functions nor values of elements"
    raise InputError(field, None, why, "give numbers, a lacore.Linear or a lacore.ByLevel")


def place(where: Where, field: str) -> Any:
    """Return a part of a boundary."""
    if isinstance(where, Within | Beyond):
        own = {name: value for name, value in vars(where).items() if value is not None}
        return {name: plain(value) for name, value in own.items()}
    if isinstance(where, Along):
        return {"from": plain(where.start), "to": plain(where.end)}
    if callable(where):
        raise InputError(
            field,
            getattr(where, "__name__", None),
            "a file has no functions",
            "name the boundary (lacore.model.meshes.named), or give lacore.Within or lacore.Along",
        )
    return plain(where)


def law(given: friction.Friction, field: str) -> Any:
    """Return a law of friction."""
    if given in _WORDS:
        return _WORDS[given]
    if isinstance(given, friction.Tresca):
        return {"limit": plain(given.limit)}
    if not isinstance(given, friction.Coulomb):
        return other(given, field)
    own = {name: value for name, value in vars(given).items() if value}
    bare = set(own) <= {"mu"} and not friction.in_degrees(given.mu)
    return plain(given.mu) if bare else {"mu": 0} | plain(own)


def support(fix: loads.Fix, field: str) -> Table:
    """Return a support."""
    where = place(fix.where, f"{field}.where")
    return {"body": fix.body, "where": where, "components": fix.components}


def interface(pair: Interface, field: str) -> Table:
    """Return an interface."""
    sides = [
        {"body": name, "where": place(where, f"{field}.{side}")}
        for side, (name, where) in zip(("slave", "master"), pair.sides, strict=False)
    ]
    master: Any = sides[-1]
    if pair.obstacle is not None:
        own = pair.obstacle
        if own.shape is not None:
            why = "a file has planes only"
            raise InputError(f"{field}.master.shape", own.shape, why, "keep this problem in Python")
        flat = own.point is not None
        master = {"point": plain(own.point), "normal": plain(own.normal)} if flat else "obstacle"
    return {"slave": sides[0], "master": master, "friction": law(pair.law, f"{field}.friction")}


def blocks(body: BlockAssembly) -> Table:
    """Return rigid blocks: walls and arches become polygons, too."""

    def stated(own: float | friction.Friction, field: str) -> Any:
        return law(friction.friction_law(own, field), field)

    pairs = (body.joint_friction or {}).items()
    joints = [
        {"between": list(pair), "friction": stated(own, "joint_friction")} for pair, own in pairs
    ]
    return {
        "kind": "blocks",
        "friction": stated(body.friction, "friction"),
        **({"joints": joints} if joints else {}),
        "tolerance": plain(body.tolerance),
        "blocks": {name: plain(corners.tolist()) for name, corners in body.polygons.items()},
    }


def frame(body: Frame) -> Table:
    """Return a frame."""
    assert isinstance(body.members, Mapping)  # set in the constructor
    given = body.sections
    own = given if isinstance(given, Mapping) else dict.fromkeys(body.member_names, given)
    drawn = {name: _section(one) for name, one in own.items() if one is not None}
    moment = body.plastic_moment
    return {
        "kind": "frame",
        "tolerance": plain(body.tolerance),
        **({} if moment is None else {"plastic_moment": plain(moment)}),
        **({"sections": drawn} if drawn else {}),
        "releases": plain(body.releases),
        "nodes": plain(body.nodes),
        "members": plain(body.members),
    }


def _section(own: Section) -> Any:
    if own.rigid:
        return "rigid"
    if not own.bends:
        low, high = own.corners[0][0], own.corners[-1][0]
        given = {"tension": high} if -low == high else {"tension": high, "compression": -low}
        return {key: inf if isinf(value) else plain(value) for key, value in given.items()}
    if not own.extends:
        hogging = {} if own.lower is None else {"hogging": plain(own.hogging)}
        return {"plastic_moment": plain(own.sagging), **hogging}
    name = {"name": own.name} if own.name else {}
    lower = {} if own.lower is None else {"lower": plain(own.lower)}
    curve = {} if own.other is None else {"side": own.side, "other": plain(own.other)}
    return {"corners": plain(own.corners), **name, **lower, **curve}


def plain(value: Any) -> Any:
    """Return numbers, texts, lists and tables of them."""
    if isinstance(value, str | bool):
        return value
    if isinstance(value, Mapping):
        return {str(name): plain(own) for name, own in value.items()}
    if hasattr(value, "__iter__"):
        return [plain(own) for own in value]
    return int(value) if isinstance(value, int) else _short(float(value))


def _short(value: float) -> float | int:
    """Return whole numbers without a point."""
    return int(value) if value.is_integer() and abs(value) < 2**53 else value
