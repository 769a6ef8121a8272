"""Friction laws of contact points."""

from dataclasses import dataclass
from math import inf

import numpy as np

from lacore.model.contact.interfaces import Interface
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact
from lacore.reporting.terms import BOND
from lacore.reporting.text import Quantity, text

# factor of the shear strength: control values may exceed it, but not by this factor
_UNATTAINABLE = 100.0


@dataclass(frozen=True, repr=False)
class Laws(Compact):
    """Friction of segments or points, shape (k,) each.

    See `lacore.model.materials.friction.FrictionTerms`.
    """

    coefficient: Floats
    limit: Floats
    dilatancy: Floats
    tension: Floats

    def at(self, points: Ints) -> "Laws":
        """Return the laws of some segments or points, by numbers."""
        own = (self.coefficient, self.limit, self.dilatancy, self.tension)
        return Laws(*(values[points] for values in own))


def laws_of(interface: Interface, strength: float, count: int) -> Laws:
    """Return the laws of an interface at `count` places.

    Args:
        interface: the interface.
        strength: shear strength of its bodies, Pa.
        count: number of places.
    """
    law, most = interface.law.terms(), _UNATTAINABLE * strength
    if law.tension > most:
        raise InputError(
            "Interface.friction",
            interface.law,
            text(
                "a tension of {}, and a shear strength of {} in the bodies: nothing would ever"
                " open",
                Quantity(law.tension, "Pa", ".4g"),
                Quantity(strength, "Pa", ".4g"),
            ),
            text(
                "give at most {}; {} neither opens nor slips",
                Quantity(most, "Pa", ".4g"),
                BOND,
            ),
        )
    # A limit far beyond the shear strength of the bodies is sticking.
    sticks = law.limit > most
    terms = (
        0.0 if sticks else law.coefficient,
        inf if sticks else law.limit,
        0.0 if sticks else law.dilatancy,
        law.tension,
    )
    return Laws(*(np.full(count, value) for value in terms))
