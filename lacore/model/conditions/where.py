"""Parts of a boundary: by name, or by a predicate on coordinates."""

from collections.abc import Callable

import numpy as np

from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting.errors import InputError

Where = str | tuple[str, ...] | Callable[[Floats], Bools]
"""Part of a body: the name of a boundary, names of blocks, nodes or members, or a predicate.

A predicate is a function of coordinates of shape (2, n), in three dimensions (3, n), that returns a
bool for each place, or in the plane `lacore.Within`, `lacore.Along`, `lacore.Beyond`.
"""


# Shares of an edge: inside it, so that `<` and `<=` with a vertex select the same, and close to its
# ends, so that a predicate that ends just past a vertex is detected; 1e-3 leaves room for slack.
_SAMPLES = np.array([1e-3, *np.linspace(0.0, 1.0, 17)[1:-1], 1 - 1e-3])


def where_name(where: Where) -> str:
    """Return a name for messages and tables: of the boundary, the parts, or the function."""
    if isinstance(where, str):
        return where
    if isinstance(where, tuple):
        return "+".join(map(str, where))
    told: str = getattr(where, "told", "")  # Predicates given by numbers have a text.
    name = getattr(where, "__name__", "")
    return told or (name if name.isidentifier() else "part")


def edges_inside(
    where: Callable[[Floats], Bools],
    start: Floats,
    end: Floats,
    field: str,
    middle: Floats | None = None,
) -> tuple[Ints, Ints]:
    """Return which edges satisfy a predicate along their whole length, and which in part.

    Args:
        where: the predicate.
        start, end: ends of the edges, shape (2, n).
        field: name for messages.
        middle: middle of curved edges, shape (2, n).

    Raises:
        InputError: the predicate fails, or does not return one bool per point.
    """
    middle = (start + end) / 2 if middle is None else middle
    samples = start[:, :, None] * (1 - _SAMPLES) + end[:, :, None] * _SAMPLES
    bulge = middle - (start + end) / 2
    samples += bulge[:, :, None] * (4 * _SAMPLES * (1 - _SAMPLES))
    # Clip to the Bernstein hull, so that `x[1] == 0.7` holds along an edge at 0.7 despite
    # round-off.
    hull = np.stack([start, middle + bulge, end])
    samples = np.clip(samples, hull.min(axis=0)[:, :, None], hull.max(axis=0)[:, :, None])
    inside = asked(where, samples.reshape(2, -1), field).reshape(start.shape[1], _SAMPLES.size)
    whole = inside.all(axis=1)
    return np.flatnonzero(whole), np.flatnonzero(inside.any(axis=1) & ~whole)


def asked(where: Callable[[Floats], Bools], places: Floats, field: str) -> Bools:
    """Return the values of a predicate at places of shape (d, n), shape (n,).

    Raises:
        InputError: the predicate fails, or does not return one bool per point.
    """
    shape = f"({len(places)}, n)"
    try:
        inside = np.asarray(where(places))
    except InputError as error:  # errors of our predicates
        raise InputError(field, error.field, error.reason, error.fix) from error
    except Exception as error:  # errors of functions of users
        raise InputError(
            field,
            None,
            f"the predicate fails for coordinates {shape}: {type(error).__name__}: {error}",
            "compare arrays, and join conditions by & and |, each in brackets",
        ) from error
    if inside.shape != (places[0].size,) or inside.dtype != bool:
        raise InputError(
            field,
            inside.dtype.name,
            "the predicate does not return one bool a point",
            f"return an array of bool of shape (n,) for coordinates {shape}",
        )
    return inside
