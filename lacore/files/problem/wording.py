"""Translate messages of lacore, which name Python functions, to the keys of problem files."""

import re
from collections.abc import Sequence
from numbers import Real
from typing import Any

from lacore.files.problem.statements import plain

_L = r"(?:lacore|la)\."
_WORDS: Sequence[tuple[str, str]] = (
    (r"joint_friction=\{\('(.*?)', '(.*?)'\): friction\}", r'joints: between = ["\1", "\2"]'),
    (r"give VonMises\(shear_strength=k\).*", "give shear_strength, yield_stress or hardening"),
    (r"Layer\(density=\)", "density, as in { friction = 0.6, density = 2400 }"),
    (r"give (bodies=)?\{'name': [^}]*\)\}", "give one as a table, such as [bodies.NAME]"),
    (r"\(the own weight: BodyForce\)", '(the own weight: load = "weight")'),
    (r"a boundary name or a function of coordinates \(2, n\)", "a name, or places in numbers"),
    (r"a name, names, or a function of \(2, n\)", "a name, names, or places in numbers"),
    (rf"{_L}meshes\.rectangle\(crossed=True\)", "crossed = true"),
    (rf"{_L}meshes\.(layered|fan|rectangle|patches)", r'shape = "\1"'),
    (rf"(control=)?{_L}FootingTravel\(\)", 'control = { measure = "footing" }'),
    (
        rf"(control=)?{_L}PointTravel\(body, at, direction\)",
        'control = { measure = "point", body = ..., at = ..., direction = ... }',
    ),
    (
        rf"(control=)?{_L}ToolTravel\(\{{'tool': \(x, y\)\}}\)",
        'control = { measure = "tools", velocity = { NAME = [x, y] } }',
    ),
    (rf"(control=)?{_L}Time\(\)", 'control = { measure = "time" }'),
    (r"\bProblem\.reference_loads\b", "reference_loads"),
    (r"such as Tool\(\.\.\., velocity=\(0, -1\)\)", "such as velocity = [0, -1]"),
    (r"give velocity=\(0, y\) and turn=0", "give velocity = [0, y] and no turn"),
    (rf"add a {_L}RigidBlock", 'add a body of kind "block"'),
    (r"\bis not one RigidFooting", 'is not one load = "rigid-footing"'),
    (rf"{_L}SMOOTH", '"smooth"'),
    (rf"{_L}STICK", '"stick"'),
    (rf"{_L}BOND", '"bond"'),
    (rf"{_L}Coulomb\((\S+)\)", r"{ mu = \1 }"),
    (rf"`?{_L}stable`?", "--stable"),
    (rf"{_L}(?:coulomb|soil)_range", "--range"),
    (rf"ask {_L}lower_bound", "ask for --bracket"),
    (
        rf"give a {_L}Body on a skfem.MeshTri, or a MeshTet",
        'give a body of kind "continuum", not of q2',
    ),
    (rf"give a {_L}Body\b", 'give a body of kind "continuum"'),
    (rf"`{_L}critical` finds", "--critical finds, along a number that varies, the"),
    (rf"{_L}WaterTable\(height\)", "{ height = ... }"),
    (rf"a {_L}Pressure", 'load = "pressure"'),
    (r"\ba PointForce\b", 'load = "point-force"'),
    (r"\bby Pressure\b", 'by load = "pressure"'),
    (r"\ba Body of its own\b", "a body of its own"),
    (r"\bby a Fix\b", "by a support"),
    (r"\bRigidObstacle\.(point|normal)", r"\1"),
    (r"\bTrue\b", "true"),
    (r"\bFalse\b", "false"),
    (r"\ba tuple of\b", "a list of"),
)


def in_words_of_files(text: str) -> str:
    """Return a message of lacore with the keys of problem files in place of Python names."""
    for python, own in _WORDS:
        text = re.sub(python, own, text)
    return text


def value_of_files(value: Any) -> Any:
    """Return a value as files write it, and None for a value that no file contains."""
    if isinstance(value, str | bool | None):
        return value
    if isinstance(value, Real):
        return plain(value)
    if isinstance(value, list | tuple):
        inner = [value_of_files(own) for own in value]
        return None if None in inner else inner
    return None
