"""Tetrahedra and faces divided evenly into parts, on which convex rules are more accurate."""

from functools import cache
from itertools import pairwise, permutations, product

import numpy as np

from lacore.numerics.arrays import Floats, Ints


@cache
def divided(parts: int, corners: int) -> tuple[Floats, Ints]:
    """Return a triangle or a tetrahedron divided into parts of equal size.

    The edges of the parts are 1/parts of its own. They are the cells of a grid cut along their
    diagonals, within the simplex of descending coordinates (Freudenthal 1942).

    Args:
        parts: number of parts of each edge.
        corners: 3 or 4.

    Returns:
        Barycentric coordinates of the places, shape (p, corners), and places at the corners of each
        part, shape (parts**(corners - 1), corners).
    """
    d = corners - 1
    number: dict[tuple[int, ...], int] = {}
    for place in product(range(parts + 1), repeat=d):
        if all(a >= b for a, b in pairwise(place)):
            number[place] = len(number)
    found = []
    for cell in product(range(parts), repeat=d):
        for order in permutations(range(d)):
            at = list(cell)
            path = [tuple(at)]
            for axis in order:
                at[axis] += 1
                path.append(tuple(at))
            if all(place in number for place in path):
                found.append([number[place] for place in path])
    whole = np.array(list(number))
    steps = np.concatenate([np.full((len(whole), 1), parts), whole, np.zeros((len(whole), 1))], 1)
    return -np.diff(steps, axis=1) / parts, np.array(found)
