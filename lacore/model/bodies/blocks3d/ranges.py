"""Ranges of positions in ascending labels."""

import numpy as np

from lacore.numerics.arrays import Ints


def spread(label: Ints, wanted: Ints, labels: int) -> tuple[Ints, Ints]:
    """Return the positions of wanted labels in an ascending list, and the index of each."""
    count = np.bincount(label, minlength=labels)
    begin = (np.cumsum(count) - count)[wanted]
    number = count[wanted]
    of = np.repeat(np.arange(wanted.size), number)
    behind = np.arange(of.size) - (np.cumsum(number) - number)[of]
    return begin[of] + behind, of
