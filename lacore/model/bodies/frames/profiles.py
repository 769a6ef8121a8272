"""Rolled I-sections: areas and first moments from their dimensions, and a table of dimensions.

Nominal dimensions of EN 10365:2017, mm: height, width, web, flange, fillet. The tabulated area and
W_pl follow from them, fillets included, and tests compare them with the tables.
"""

from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError, is_number, require_positive


@dataclass(frozen=True)
class Profile:
    """I-section.

    Overall `height` and `width`, thickness of `web` and `flange`, `fillet` radius, m.
    """

    height: float
    width: float
    web: float
    flange: float
    fillet: float

    def __post_init__(self) -> None:
        for name in ("height", "width", "web", "flange"):
            require_positive(name, getattr(self, name))
        fits = is_number(self.fillet) and 0 <= self.fillet <= (self.width - self.web) / 2
        if not (fits and self.flange + self.fillet < self.height / 2 and self.web <= self.width):
            raise InputError(
                "fillet", self.fillet, "web, flanges and fillets do not fit", "give lengths in m"
            )

    def area(self, y: Floats) -> Floats:
        """Return the area closer to the middle than y, 0 <= y <= height/2, m^2."""
        round_, flange = self._beyond(y)
        r = self.fillet
        root = np.sqrt(np.maximum(r**2 - round_**2, 0.0))
        angle = np.arcsin(np.clip(round_ / r, 0.0, 1.0)) if r > 0 else np.zeros_like(y)
        corner = r * round_ - (round_ * root + r**2 * angle) / 2
        # Fillets end where flanges begin, whose width is full.
        return np.asarray(2 * (self.web * y + 2 * corner + (self.width - self.web) * flange))

    def moment(self, y: Floats) -> Floats:
        """Return the first moment of the part beyond y, of both halves, m^3."""
        whole = self._first(np.array([self.height / 2]))
        return np.asarray(whole - self._first(y))

    def _first(self, y: Floats) -> Floats:
        """Return the first moment of the part closer than y, m^3."""
        round_, flange = self._beyond(y)
        r, foot = self.fillet, self.height / 2 - self.flange - self.fillet
        root = np.sqrt(np.maximum(r**2 - round_**2, 0.0))
        angle = np.arcsin(np.clip(round_ / r, 0.0, 1.0)) if r > 0 else np.zeros_like(y)
        corner = r * round_ - (round_ * root + r**2 * angle) / 2
        about = r * round_**2 / 2 - (r**3 - root**3) / 3
        beyond = flange * (self.height / 2 - self.flange + flange / 2)
        parts = self.web * y**2 / 2 + 2 * (foot * corner + about) + (self.width - self.web) * beyond
        return np.asarray(2 * parts)

    def _beyond(self, y: Floats) -> tuple[Floats, Floats]:
        """Return how far y reaches into the fillet, and into the flange, m."""
        web = self.height / 2 - self.flange
        fillet = np.clip(y - (web - self.fillet), 0.0, self.fillet)
        return fillet, np.maximum(y - web, 0.0)


_MM = {
    "IPE 80": (80, 46, 3.8, 5.2, 5),
    "IPE 100": (100, 55, 4.1, 5.7, 7),
    "IPE 120": (120, 64, 4.4, 6.3, 7),
    "IPE 140": (140, 73, 4.7, 6.9, 7),
    "IPE 160": (160, 82, 5.0, 7.4, 9),
    "IPE 180": (180, 91, 5.3, 8.0, 9),
    "IPE 200": (200, 100, 5.6, 8.5, 12),
    "IPE 220": (220, 110, 5.9, 9.2, 12),
    "IPE 240": (240, 120, 6.2, 9.8, 15),
    "IPE 270": (270, 135, 6.6, 10.2, 15),
    "IPE 300": (300, 150, 7.1, 10.7, 15),
    "IPE 330": (330, 160, 7.5, 11.5, 18),
    "IPE 360": (360, 170, 8.0, 12.7, 18),
    "IPE 400": (400, 180, 8.6, 13.5, 21),
    "IPE 450": (450, 190, 9.4, 14.6, 21),
    "IPE 500": (500, 200, 10.2, 16.0, 21),
    "IPE 550": (550, 210, 11.1, 17.2, 24),
    "IPE 600": (600, 220, 12.0, 19.0, 24),
    "HEA 100": (96, 100, 5.0, 8.0, 12),
    "HEA 120": (114, 120, 5.0, 8.0, 12),
    "HEA 140": (133, 140, 5.5, 8.5, 12),
    "HEA 160": (152, 160, 6.0, 9.0, 15),
    "HEA 180": (171, 180, 6.0, 9.5, 15),
    "HEA 200": (190, 200, 6.5, 10.0, 18),
    "HEA 220": (210, 220, 7.0, 11.0, 18),
    "HEA 240": (230, 240, 7.5, 12.0, 21),
    "HEA 260": (250, 260, 7.5, 12.5, 24),
    "HEA 280": (270, 280, 8.0, 13.0, 24),
    "HEA 300": (290, 300, 8.5, 14.0, 27),
}

PROFILES = {name: Profile(*(size / 1000 for size in own)) for name, own in _MM.items()}
