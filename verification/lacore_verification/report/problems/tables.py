"""Tables of results in the units of a page."""

from collections.abc import Mapping
from dataclasses import replace

import pandas as pd

import lacore as la
from lacore.model.bodies.any_body import of_kind
from lacore.reporting.text import Reader, render
from lacore.reporting.units import Units

_UNITS: Mapping[str, str] = {
    **dict.fromkeys(("x", "y", "r", "z", "length"), "m"),
    **dict.fromkeys(("u_n", "u_t"), "m/s"),
    **dict.fromkeys(("t_n", "t_t"), "Pa"),
    **dict.fromkeys(("force_x", "force_y", "axial_force", "squash_load"), "N/m"),
    **dict.fromkeys(("moment", "plastic_moment"), "N"),
}
_NAMES = ("frame", "body")


def in_units(
    table: pd.DataFrame, units: Units, problem: la.Problem
) -> tuple[pd.DataFrame, dict[str, str]]:
    """Return the columns of a state in some units, and their headings with these.

    Args:
        table: table in SI.
        units: units of forces, stresses and lengths.
        problem: problem of the table.
    """
    frames = of_kind(problem.bodies, la.Frame)
    whole = any(body.axisymmetric for body in problem.bodies.values())
    names = next((set(table[column]) for column in _NAMES if column in table), set())
    framed = bool(names) and names <= frames.keys()
    own, heads = table.copy(), {}
    for name in _UNITS.keys() & set(map(str, own.columns)):
        unit = "N" if whole and _UNITS[name] == "N/m" else _UNITS[name]
        own[name] = own[name] / units.size(unit, framed)
        heads[name] = f"{name.replace('_', ' ')} [{units.label(unit, framed)}]"
    if "interface" in own:
        named = interface_names(problem, units)
        own["interface"] = own["interface"].map(lambda name: named.get(name, name))
    return own, heads


def interface_names(problem: la.Problem, units: Units) -> dict[str, str]:
    """Return the names of interfaces in some units, by their names in SI."""
    reader = Reader(units, files=True)
    return {str(own.name): render(own.name, reader) for own in problem.interfaces}


def sensitivity_in(found: la.Sensitivity, units: Units) -> la.Sensitivity:
    """Return the sensitivities with values, derivatives and names of parameters in some units."""
    table = found.table.copy()
    framed = table["body"].isin(list(found.state.discretisation.frames))
    rows = list(zip(table["unit"], framed, strict=True))
    sizes = [units.size(*row) for row in rows]
    table["value"] /= sizes
    for name in ("derivative", "left", "right"):
        table[name] *= sizes
    table["unit"] = [units.label(*row) for row in rows]
    named = zip(table["parameter"], framed, strict=True)
    table["parameter"] = [render(name, Reader(units, True, frame)) for name, frame in named]
    left_out = tuple(render(name, Reader(units, files=True)) for name in found.left_out)
    return replace(found, table=table, left_out=left_out)
