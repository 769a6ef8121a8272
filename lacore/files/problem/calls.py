"""What a problem file makes: calls of lacore, to be carried out or told as Python.

The two cannot differ: the script beside an answer says what was done. Only functions of `MAKERS`
are called, with numbers, texts and each other as arguments.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from lacore.bodies.blocks import masonry
from lacore.bodies.blocks.block_assembly import BlockAssembly, RigidBlock
from lacore.bodies.continuum.body import Body
from lacore.bodies.frames import sections
from lacore.bodies.frames.frame import Frame
from lacore.bodies.frames.section import Section
from lacore.conditions import loads, water
from lacore.conditions.body_forces import BodyForce
from lacore.conditions.linear import ByLevel, Linear
from lacore.conditions.within import Along, Beyond, Within
from lacore.contact.interfaces import Interface
from lacore.contact.obstacles import RigidObstacle
from lacore.errors import InputError
from lacore.files.problem.places import Path
from lacore.materials.drucker_prager import DruckerPrager
from lacore.materials.fields import Field
from lacore.materials.friction import BOND, SMOOTH, STICK, Coulomb, Tresca
from lacore.materials.mohr_coulomb import MaximumShear, MohrCoulomb, NoTension, Rankine
from lacore.materials.von_mises import VonMises
from lacore.meshes.archive import load
from lacore.meshes.layered import layered
from lacore.meshes.naming import named
from lacore.meshes.patches import Patch, patches
from lacore.meshes.reading import read
from lacore.meshes.structured import fan, quadrilaterals, quarter_ring, rectangle
from lacore.problem.problem import Problem

MAKERS: Mapping[str, Callable[..., Any]] = {
    "la.meshes.rectangle": rectangle,
    "la.meshes.quadrilaterals": quadrilaterals,
    "la.meshes.fan": fan,
    "la.meshes.layered": layered,
    "la.meshes.quarter_ring": quarter_ring,
    "la.meshes.Patch": Patch,
    "la.meshes.patches": patches,
    "la.meshes.read": read,
    "la.meshes.load": load,
    "la.meshes.named": named,
    "la.VonMises": VonMises,
    "la.MohrCoulomb": MohrCoulomb,
    "la.DruckerPrager": DruckerPrager,
    "la.Rankine": Rankine,
    "la.NoTension": NoTension,
    "la.MaximumShear": MaximumShear,
    "la.Body": Body,
    "la.RigidBlock": RigidBlock,
    "la.BlockAssembly": BlockAssembly,
    "la.masonry.running_bond": masonry.running_bond,
    "la.masonry.regular_bond": masonry.regular_bond,
    "la.masonry.Opening": masonry.Opening,
    "la.masonry.stack": masonry.stack,
    "la.masonry.arch": masonry.arch,
    "la.Frame": Frame,
    "la.sections.standard": sections.standard,
    "la.sections.rectangle": sections.rectangle,
    "la.sections.bar": sections.bar,
    "la.sections.plastic": sections.plastic,
    "la.sections.rigid": sections.rigid,
    "la.sections.Section": Section,
    "la.Within": Within,
    "la.Along": Along,
    "la.Beyond": Beyond,
    "la.Linear": Linear,
    "la.ByLevel": ByLevel,
    "la.Field": Field,
    "la.Fix": loads.Fix,
    "la.Traction": loads.Traction,
    "la.Pressure": loads.Pressure,
    "la.BodyForce": BodyForce,
    "la.PointForce": loads.PointForce,
    "la.RigidFooting": loads.RigidFooting,
    "la.PorePressure": water.PorePressure,
    "la.StandingWater": water.StandingWater,
    "la.WaterTable": water.WaterTable,
    "la.Interface": Interface,
    "la.RigidObstacle": RigidObstacle,
    "la.Coulomb": Coulomb,
    "la.Tresca": Tresca,
    "la.Problem": Problem,
}
_MESHES = {
    *("la.meshes.rectangle", "la.meshes.quadrilaterals", "la.meshes.fan"),
    *("la.meshes.quarter_ring", "la.meshes.patches", "la.meshes.layered", "la.meshes.named"),
    *("la.meshes.read", "la.meshes.load"),
}
_ORIGIN = "_lacore_origin"
NAMES: Mapping[str, object] = {"la.SMOOTH": SMOOTH, "la.STICK": STICK, "la.BOND": BOND}
"""What stands for a value."""


@dataclass(frozen=True)
class Name:
    """One of `NAMES`."""

    name: str


@dataclass(frozen=True)
class Call:
    """A function of lacore with its arguments.

    Attributes:
        maker: one of `MAKERS`.
        arguments: by name; numbers, texts, paths of files, calls, and tuples, lists and dicts of
            them.
        at: what of the file says it.
        places: what of the file says an argument, where it is not called like it.
    """

    maker: str
    arguments: Mapping[str, Any]
    at: Path
    places: Mapping[str, Path] = field(default_factory=dict)


class MisfitError(Exception):
    """What lacore refuses of a file: the error, and the place in the file that it is about."""

    def __init__(self, error: InputError, at: Path) -> None:
        self.error, self.at = error, at
        super().__init__(str(error))


def made(node: Any) -> Any:
    """What calls make.

    Raises:
        MisfitError: lacore refuses one of them.
    """
    match node:
        case Call():
            arguments = {name: made(own) for name, own in node.arguments.items()}
            try:
                return _noted(MAKERS[node.maker](**arguments), node)
            except InputError as error:
                raise MisfitError(error, _place(node, error.field)) from error
        case Name():
            return NAMES[node.name]
        case tuple() | list():
            return type(node)(map(made, node))
        case dict():
            return {name: made(own) for name, own in node.items()}
    return node


def origin(mesh: object) -> Call | None:
    """The call that a mesh was made by; None of others."""
    call: Call | None = getattr(mesh, _ORIGIN, None)
    return call


def _noted(thing: Any, call: Call) -> Any:
    """A thing; a mesh that knows what it was made by, until scikit-fem makes another of it."""
    if call.maker in _MESHES:
        object.__setattr__(thing, _ORIGIN, call)
    return thing


def parts(text: str) -> Path:
    """``Problem.bodies['a'].mesh`` as a path, without its first name: ``("bodies", "a", "mesh")``.

    Numbers in brackets are places of a list, all else names.
    """
    found: list[str | int] = []
    rest = text.partition(" ")[0]  # of "field = value, coordinates" the field
    while rest:
        if rest[0] == "[":
            inside, _, rest = rest[1:].partition("]")
            found.append(int(inside) if inside.isdigit() else inside.strip("'\""))
        elif rest[0] == ".":
            rest = rest[1:]
        else:
            end = next((n for n, letter in enumerate(rest) if letter in ".["), len(rest))
            found.append(rest[:end])
            rest = rest[end:]
    return tuple(found)


def _place(call: Call, text: str) -> Path:
    """Where an argument of a call that an error names is in the file."""
    first, *_ = path = parts(text)
    own = path[1:] if first not in call.arguments and len(path) > 1 else path
    if own[0] in call.places:
        return (*call.places[str(own[0])], *own[1:])
    return (*call.at, *own) if own[0] in call.arguments else call.at
