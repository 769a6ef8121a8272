"""Quantities in a choice of units, Pa or kPa, m or mm, consistent on a page or picture."""

from collections.abc import Iterable
from dataclasses import dataclass
from math import floor, isfinite, log10

_LBF, _FT, _IN = 4.4482216152605, 0.3048, 0.0254  # N, m, m: by definition
FORCES = {"N": 1.0, "kN": 1e3, "MN": 1e6, "lbf": _LBF, "kip": 1e3 * _LBF}
LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "ft": _FT, "in": _IN}
STRESSES = {
    **{"Pa": 1.0, "kPa": 1e3, "MPa": 1e6},
    **{"psf": _LBF / _FT**2, "ksf": 1e3 * _LBF / _FT**2},
    **{"psi": _LBF / _IN**2, "ksi": 1e3 * _LBF / _IN**2},
}
METRES = {
    **{"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "km": 1000.0},
    **{"in": 0.0254, "ft": 0.3048, "yd": 0.9144},
}
"""Lengths of units of files, m."""
_METRIC = {"N": "Pa", "kN": "kPa", "MN": "MPa"}
_CUSTOMARY = {"lbf": ("psf", "psi"), "kip": ("ksf", "ksi")}
_OF_FRAMES = {"N/m": "N", "N": "N m", "N/m per m": "N/m"}


@dataclass(frozen=True)
class Units:
    """Units of forces, lengths and stresses.

    Attributes:
        force: one of `FORCES`.
        length: one of `LENGTHS`; forces and moments are always per m, or per ft.
        own_stress: one of `STRESSES`; empty: the one that matches forces.
        whole: whether forces of frames are those of a whole frame: N for N/m, N m for N.
    """

    force: str = "N"
    length: str = "m"
    own_stress: str = ""
    whole: bool = False

    @property
    def stress(self) -> str:
        """Unit of stresses."""
        if self.own_stress:
            return self.own_stress
        if self.force in _METRIC:
            return _METRIC[self.force]
        return _CUSTOMARY[self.force][self.length == "in"]

    def size(self, unit: str, framed: bool = False) -> float:
        """Return the size of one of these units in a unit of SI.

        Args:
            unit: unit of SI, per unit thickness: ``Pa``, ``N/m``, ``m``; other units are not
                converted.
            framed: whether it belongs to a frame.
        """
        return self._told(unit, framed)[1]

    def label(self, unit: str, framed: bool = False) -> str:
        """Return the unit for a unit of SI: ``kPa`` for ``Pa``; see `size`."""
        return self._told(unit, framed)[0]

    def told(self, size: float, unit: str, framed: bool = False, digits: int = 4) -> str:
        """Return a quantity as text, such as ``20 kPa`` for 20000 Pa."""
        return f"{size / self.size(unit, framed):.{digits}g} {self.label(unit, framed)}"

    def place(self, x: float, y: float) -> str:
        """Return a place as text, such as ``(0.52, -1.2) m``."""
        size = self.size("m")
        return f"({x / size:.3g}, {y / size:.3g}) {self.length}"

    def _told(self, unit: str, framed: bool) -> tuple[str, float]:
        """Return the label and the size of a unit of SI."""
        own = _OF_FRAMES.get(unit, unit) if framed and self.whole else unit
        force, stress = FORCES[self.force], STRESSES[self.stress]
        per = "m" if self.force in _METRIC else "ft"
        long = LENGTHS[per]
        known = {
            "m": (self.length, LENGTHS[self.length]),
            "m/s": (f"{self.length}/s", LENGTHS[self.length]),
            "Pa": (self.stress, stress),
            "Pa/m": (f"{self.stress}/{per}", stress / long),
            "N": (self.force, force),
            "N/m": (f"{self.force}/{per}", force / long),
            "N/m per m": (f"{self.force}/{per} per {per}", force / long**2),
            "N/m^3": (f"{self.force}/{per}^3", force / long**3),
            "N m": (f"{self.force} {per}", force * long),
        }
        return known.get(own, (own, 1.0))


def fitting(sizes: Iterable[float]) -> str:
    """Return the one of N, kN, MN in which sizes in SI are mostly between 1 and 1000."""
    known = [abs(size) for size in sizes if size and isfinite(size)]
    if not known:
        return "N"
    middle = sum(map(log10, known)) / len(known)
    thousands = min(max(floor(middle / 3), 0), len(_METRIC) - 1)
    return list(_METRIC)[thousands]
