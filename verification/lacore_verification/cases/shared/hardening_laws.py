"""Hardening laws of the cases by name, yield stress 1 at the beginning."""

from collections.abc import Mapping
from math import sqrt

from lacore.model.materials.hardening import HardeningLaw, Linear, Perfect, Voce

LAWS: Mapping[str, HardeningLaw] = {
    "perfect": Perfect(1.0),
    "linear-1": Linear(1.0, 1.0),
    "linear-3": Linear(1.0, 3.0),
    "voce": Voce(1.0, 3.0, 2 * sqrt(3)),
}
"""``linear-H``: sigma_Y = s0 + H eb; ``voce``: 3 s0 - 2 s0 exp(-2 sqrt3 eb)."""
