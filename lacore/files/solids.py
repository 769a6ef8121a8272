"""Limit states of three-dimensional blocks as ParaView files: polyhedra and contact points."""

from pathlib import Path

import numpy as np
import pandas as pd

from lacore.limit.state import LimitState
from lacore.numerics.arrays import Floats, Ints

KINDS = ("stick", "slip", "open", "crush")


def write_solids(state: LimitState, place: Path) -> Path:
    """Write two VTU files: the blocks, and ``NAME-contact.vtu`` with their contact points.

    Blocks are polyhedra. At points: `velocity` (m/s at ``F0.u = 1``), which times a scale is the
    displacement of the mechanism. At cells: `body`, its number in the problem, and `block`, its
    number in the body. Contact points have `normal` (from the master into the slave), `area` (m^2),
    `pressure` (Pa, compression positive), `traction` (Pa, total, on the slave), `opening` and
    `slip` (m/s), and `state` (0 stick, 1 slip, 2 open, 3 crush).

    Returns:
        the file of the contact points.

    Raises:
        OSError: the files cannot be written.
    """
    import meshio  # imported here because it imports the writers of forty formats

    d = state.discretisation
    points, velocity, cells = [], [], []
    labels: list[tuple[int, int]] = []
    first = 0
    for number, (name, dofs) in enumerate(d.solids.items()):
        motion = state.velocity[name]
        for block, solid in enumerate(dofs.body.polyhedra.values()):
            points.append(solid.vertices)
            blocks = np.full(len(solid.vertices), block)
            velocity.append(dofs.velocity_at(motion, blocks, solid.vertices.T).T)
            cells.append([np.array(face) + first for face in solid.faces])
            labels.append((number, block))
            first += len(solid.vertices)
    counts = np.array([len(own) for own in points])
    groups: list[Ints] = [np.flatnonzero(counts == count) for count in np.unique(counts)]
    named: Ints = np.array(labels)
    meshio.Mesh(
        np.concatenate(points),
        [(f"polyhedron{counts[own[0]]}", [cells[n] for n in own]) for own in groups],
        point_data={"velocity": np.concatenate(velocity)},
        cell_data={
            "body": [named[own, 0] for own in groups],
            "block": [named[own, 1] for own in groups],
        },
    ).write(place, file_format="vtu")

    table = state.reactions
    normal = _vectors(table, "n")
    pressure = table["t_n"].to_numpy()
    contact = place.with_name(f"{place.stem}-contact{place.suffix}")
    meshio.Mesh(
        table[["x", "y", "z"]].to_numpy(),
        [("vertex", np.arange(len(table))[:, None])],
        point_data={
            "normal": normal,
            "area": table["area"].to_numpy(),
            "pressure": pressure,
            "traction": pressure[:, None] * normal + _vectors(table, "t_t"),
            "opening": table["u_n"].to_numpy(),
            "slip": _vectors(table, "u_t"),
            "state": np.array([KINDS.index(own) for own in table["state"]]),
        },
    ).write(contact, file_format="vtu")
    return contact


def _vectors(table: pd.DataFrame, name: str) -> Floats:
    """Return three columns of a table, (m, 3)."""
    columns = [f"{name}_{axis}" for axis in "xyz"]
    return np.ascontiguousarray(table[columns].to_numpy())
