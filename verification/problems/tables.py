"""Tables of a state in the units of a page."""

from collections.abc import Collection, Mapping

import pandas as pd

from lacore.numerics.quantities import Units

_UNITS: Mapping[str, str] = {
    **dict.fromkeys(("x", "y", "r", "z", "length", "gap"), "m"),
    **dict.fromkeys(("t_n", "t_t"), "Pa"),
    **dict.fromkeys(("force_x", "force_y", "axial_force", "squash_load"), "N/m"),
    **dict.fromkeys(("moment", "plastic_moment"), "N"),
}
_NAMES = ("frame", "body")


def in_units(
    table: pd.DataFrame, units: Units, frames: Collection[str]
) -> tuple[pd.DataFrame, dict[str, str]]:
    """The columns of a state in some units, and their heads with these.

    Args:
        table: in SI.
        units: of forces and stresses; lengths stay in m.
        frames: names of bodies that are some.
    """
    names = next((set(table[column]) for column in _NAMES if column in table), set())
    framed = bool(names) and names <= set(frames)
    own, heads = table.copy(), {}
    for name in _UNITS.keys() & set(map(str, own.columns)):
        unit = _UNITS[name]
        heads[name] = f"{name.replace('_', ' ')} [m]"
        if unit != "m":
            own[name] = own[name] / units.size
            heads[name] = f"{name.replace('_', ' ')} [{units.label(unit, framed)}]"
    return own, heads
