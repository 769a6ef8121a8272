"""Assemblies of rigid blocks, and a frame, by name, for tests of coupling loops.

A known closed form is the reference; otherwise there is only a certificate.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from math import nan
from typing import Any

import lacore as la
from lacore_verification.case import Band, Case, Reference, rigid
from lacore_verification.cases import (
    block_incline_horizontal,
    portal_sway,
    stack_n,
    symmetric_wedge,
    wedge_extraction,
)
from lacore_verification.cases.shared.walls import WALL_1, WALL_2, WALL_3, shaken, wall

UNKNOWN = Reference(
    nan, "none", "judged by its certificate alone", "no closed form", complete=False
)


@dataclass(frozen=True)
class Assembly:
    """A problem for each friction coefficient.

    Attributes:
        build: the problem.
        reference, band: of it.
    """

    build: Callable[[float], la.Problem]
    reference: Callable[[float], Reference]
    band: Callable[[float], Band]


def _of_case(case: Case, frictions: tuple[str, ...], **parameters: Any) -> Assembly:
    """Return a case, all its friction coefficients equal."""

    def given(mu: float) -> dict[str, Any]:
        return dict.fromkeys(frictions, mu) | parameters

    return Assembly(
        lambda mu: case.build(**given(mu)),
        lambda mu: case.reference(**given(mu)),
        lambda mu: case.band(0, **given(mu)),
    )


def _unknown(build: "Callable[[float], la.Problem]") -> Assembly:
    """Return an assembly that is shaken: alpha is in weights."""
    return Assembly(build, lambda mu: UNKNOWN, lambda mu: rigid(1.0))


def three_blocks(mu: float) -> "la.Problem":
    """Return a lintel on two columns on a floor, `shaken`."""
    rectangle = la.masonry.rectangle
    return shaken(
        la.BlockAssembly(
            {
                "base": rectangle(-0.5, 3.5, -0.5, 0),
                "left": rectangle(0, 0.5, 0, 1.5),
                "right": rectangle(2.5, 3, 0, 1.5),
                "lintel": rectangle(0, 3, 1.5, 2),
            },
            friction=mu,
        )
    )


def arch(voussoirs: int, mu: float) -> "la.Problem":
    """Return a semicircular arch, a quarter as thick as its inner radius, `shaken`."""
    return shaken(la.masonry.arch(voussoirs, 1.0, 0.25, mu), ("left", "right"))


ASSEMBLIES = {
    "incline": _of_case(block_incline_horizontal.CASE, ("mu",), beta=0.3, W=1.0, b=4.0, h=1.0),
    "stack": _of_case(stack_n.CASE, ("mu_1", "mu_n"), n=4, b=1.0, h=0.5),
    "three-blocks": _unknown(three_blocks),
    "wedge": _of_case(symmetric_wedge.CASE, ("mu", "mu_f"), beta=0.35, W=1.0, Wb=2.0),
    "extraction": _of_case(wedge_extraction.CASE, ("mu", "mu_f"), beta=0.05, W=1.0, Wb=2.0),
    "arch-9": _unknown(partial(arch, 9)),
    "arch-15": _unknown(partial(arch, 15)),
    "wall-1": _unknown(partial(wall, WALL_1)),
    "wall-2": _unknown(partial(wall, WALL_2)),
    "wall-3": _unknown(partial(wall, WALL_3)),
    "frame": _of_case(portal_sway.CASE, ("mu",), P=1.5, Mp=1.0, h=2.0, L=4.0),
}
FRICTIONS = tuple(i / 10 for i in range(1, 11))
