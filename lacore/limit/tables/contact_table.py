"""Contact points of a state as a table, and back."""

from collections.abc import Iterator, Mapping

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from lacore.assembly.discretisation import Discretisation
from lacore.limit.constants import RESTING
from lacore.model.contact.rows import ContactPoints, tangents
from lacore.numerics.arrays import Floats, Ints
from lacore.program.kinematic import ContactRows
from lacore.program.state import ProgramState
from lacore.reporting.errors import InputError

"""Share of the largest velocity below which contact points and hinges count as at rest."""
OBSTACLE = "obstacle"
_SIZE = {2: "length", 3: "area"}

Table = pd.DataFrame | Mapping[str, ArrayLike]


def contact_table(discretisation: Discretisation, point: ProgramState) -> pd.DataFrame:
    """Contact points, see `LimitState.reactions`; `point` in SI units."""
    rows, where = discretisation.full.contact, discretisation.points
    slip, crushing = rows.slip(point.velocity), discretisation.crushing
    crushed = rows.normal[:, crushing] @ point.velocity[crushing]  # opens what blocks close
    u_n = rows.opening(point.velocity) - crushed
    rest = RESTING * float(np.abs(point.velocity).max(initial=0.0))
    slave, master = contact_sides(discretisation)
    states = [u_n + rows.lead > rest, crushed > rest, np.linalg.norm(slip, axis=1) > rest]
    dimension = where.position.shape[1]
    table = pd.DataFrame(
        {
            "interface": np.array(where.names, dtype=object)[rows.interface],
            "slave": slave,
            "master": master,
            **_named(where.position, ""),
            **_named(where.normal, "n_"),
            _SIZE[dimension]: rows.weights,
            "t_n": point.normal_reaction - rows.pull,
            **_along(where, point.tangential_reaction, "t_t"),
            "u_n": u_n,
            **_along(where, slip, "u_t"),
            "state": np.select(states, ["open", "crush", "slip"], "stick"),
        }
    )
    if where.gap is not None:
        table.insert(list(table).index("t_n"), "gap", where.gap)
    return table


def traction_table(rows: ContactRows, where: ContactPoints, point: ProgramState) -> pd.DataFrame:
    """Tractions at contact points alone, see `LowerBound.reactions`; `point` in SI units."""
    return pd.DataFrame(
        {
            "interface": np.array(where.names, dtype=object)[rows.interface],
            **_named(where.position, ""),
            **_named(where.normal, "n_"),
            _SIZE[where.position.shape[1]]: rows.weights,
            "t_n": point.normal_reaction - rows.pull,
            **_along(where, point.tangential_reaction, "t_t"),
        }
    )


def reactions_of(discretisation: Discretisation, table: Table) -> tuple[Floats, Floats]:
    """Normal and tangential reactions, (m,) and (m, tangent_dim), Pa, from such a table."""
    rows, where = discretisation.full.contact, discretisation.points
    t_n = column("reactions", table, "t_n", rows.count)
    if rows.tangent_dim == 1:
        return t_n + rows.pull, column("reactions", table, "t_t", rows.count)[:, None]
    vector = np.stack(
        [column("reactions", table, f"t_t_{axis}", rows.count) for axis in "xyz"], axis=1
    )
    along = [np.sum(vector * tangent, axis=1) for tangent in tangents(where.normal)]
    return t_n + rows.pull, np.stack(along, axis=1)


def column(field: str, table: Table, name: str, count: int) -> Floats:
    """A column of a table, its rows in the order of their index where it has one.

    Raises:
        InputError: no such column, or of other rows; it names the `field` of the state.
    """
    if not isinstance(table, pd.DataFrame | Mapping) or name not in table:
        raise InputError(
            field, type(table).__name__, f"has no column {name!r}", f"give a copy of state.{field}"
        )
    values = table[name]
    if isinstance(values, pd.Series):
        values = values.sort_index()
        if not values.index.equals(pd.RangeIndex(count)):
            raise InputError(
                f"{field}[{name!r}]",
                len(values),
                f"its rows are not the {count} of the state",
                f"give a copy of state.{field}",
            )
    return numbers(f"{field}[{name!r}]", values, (count,))


def numbers(field: str, values: ArrayLike, shape: tuple[int, ...]) -> Floats:
    """Return values as floats and check their shape; NaN is allowed, to inject errors."""
    try:
        array = np.array(values, dtype=float)
    except (TypeError, ValueError):
        raise InputError(field, type(values).__name__, "no numbers", "give an array") from None
    if array.shape != shape:
        raise InputError(field, array.shape, f"the state has shape {shape}", "keep its shape")
    return array


def _named(vectors: Floats, prefix: str) -> dict[str, Floats]:
    """Return vectors (m, d) as columns."""
    return {f"{prefix}{axis}": own for axis, own in zip("xyz", vectors.T, strict=False)}


def _along(where: ContactPoints, parts: Floats, name: str) -> dict[str, Floats]:
    """Return tangential vectors: one number in two dimensions, components x, y, z in three."""
    if parts.shape[1] == 1:
        return {name: parts[:, 0]}
    along = tangents(where.normal)
    vector = sum(own[:, None] * axis for own, axis in zip(parts.T, along, strict=True))
    return _named(np.asarray(vector), f"{name}_")


def contact_sides(discretisation: Discretisation) -> tuple[np.ndarray, np.ndarray]:
    """Names of slaves and of masters at all contact points, (m,) each.

    Of assemblies that of the block, of other bodies their own; "obstacle" where there is no body.
    """
    interface = discretisation.full.contact.interface
    moving = discretisation.points.moving
    sides = np.full(moving.shape, OBSTACLE, dtype=object)
    for number, pair in enumerate(_bodies_of_pairs(discretisation)):
        points = np.flatnonzero(interface == number)
        for column, body in enumerate(pair):
            if body is not None:
                sides[points, column] = _names_of(discretisation, body, moving[points, column])
    first = len(discretisation.problem.interfaces)
    for dofs in discretisation.blocks.values():
        joints = dofs.body.joints
        names = np.array(dofs.body.names, dtype=object)
        points = np.flatnonzero((interface >= first) & (interface < first + joints.count))
        joint = interface[points] - first
        sides[points] = np.stack([names[joints.slave[joint]], names[joints.master[joint]]], axis=1)
        first += joints.count
    return sides[:, 0], sides[:, 1]


def _bodies_of_pairs(discretisation: Discretisation) -> Iterator[tuple[str, str | None]]:
    """Names of the bodies of interfaces, those of a path first; None: an obstacle."""
    for slave, *master in discretisation.points.met:
        yield slave, next(iter(master), None)
    for interface in discretisation.problem.interfaces:
        slave, *master = (name for name, _ in interface.sides)
        yield slave, next(iter(master), None)


def _names_of(discretisation: Discretisation, body: str, moving: Ints) -> np.ndarray:
    if body not in discretisation.blocks:
        return np.full(moving.size, body, dtype=object)
    return np.array(discretisation.blocks[body].body.names, dtype=object)[moving]
