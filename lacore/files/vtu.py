"""Limit states and paths as ParaView files: VTU, and a PVD file of a series."""

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path as File
from typing import Any
from xml.etree import ElementTree

import numpy as np
import shapely

from lacore.files.solids import write_solids
from lacore.limit.state import LimitState
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.blocks.dofs import RigidDofs
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.nodal import element_means, node_means
from lacore.model.bodies.continuum.regions.gathering import by_body, gathered, region_numbers
from lacore.model.bodies.continuum.strain_rates import equivalent_rate, strain_per_length
from lacore.numerics.arrays import Floats, Ints
from lacore.paths.flow import Snapshot
from lacore.paths.path import Path
from lacore.paths.stage import Stage
from lacore.program.kinematic import DissipationGroup
from lacore.reporting.errors import InputError

SERIES = "path.pvd"
_AROUND = 0.25  # by the size of the bodies: distance at which outlines of tools end
_CELLS = {
    2: {3: "triangle", 4: "quad", 6: "triangle6", 9: "quad9"},
    3: {4: "tetra", 10: "tetra10"},
}  # by dimension and nodes


@dataclass(frozen=True)
class _Part:
    """Cells of one kind.

    Attributes:
        kind: kind of meshio.
        cells: points of each, shape (cells, a).
        points: shape (2, n), m.
        at_points, at_cells: values by name; the last axis is that of points or cells.
    """

    kind: str
    cells: Ints
    points: Floats
    at_points: Mapping[str, Floats]
    at_cells: Mapping[str, Floats] = field(default_factory=dict)


def write_state(state: LimitState, place: str | os.PathLike[str]) -> File:
    """Write a limit state as a VTU file.

    At points: `velocity` (m/s at ``F0.u = 1``). At cells: `body`, its number in the problem; for
    continua `region`, its number in the body, and means over each element of
    `equivalent_strain_rate` (1/s), `dissipation` (W/m^3, see `LimitState.dissipation`),
    `yield_stress` (Pa) and `stress` (Pa, xx yy zz xy yz xz: symmetric tensors of ParaView; for
    axisymmetric bodies rr zz tt rz); with pore water also `effective_stress` and `pore_pressure`
    (Pa). Blocks are polygons, members lines, and have NaN there. For three-dimensional blocks see
    `lacore.files.solids.write_solids`.

    Returns:
        the file.

    Raises:
        InputError: another ending than .vtu, or a file that cannot be written.
        ValueError: there is no state to show.
    """
    d, velocity = state.discretisation, state.velocity
    assert state.point is not None
    file = File(os.fspath(place))
    if d.solids:
        _require_vtu(file)
        with _said("path", file):
            write_solids(state, file)
        return file
    numbers = {name: place for place, name in enumerate(d.problem.bodies)}
    parts = [
        _flowing(state, name, groups, numbers[name])
        for name, _, groups in by_body(d.continua, state.program.groups)
    ]
    for name, blocks in d.assemblies.items():
        parts += _rigid(blocks, velocity[name], numbers[name])
    for name, frame in d.frames.items():
        cells, moves = frame.body.pieces.nodes, {"velocity": _spatial(velocity[name][:2])}
        body = {"body": np.full(len(cells), numbers[name])}
        parts.append(_Part("line", cells, frame.body.position, moves, body))
    _write(file, parts)
    return file


def _flowing(
    state: LimitState, name: str, groups: Sequence[DissipationGroup], number: int
) -> _Part:
    """Return a continuum of a limit state."""
    assert state.point is not None
    dofs = state.discretisation.continua[name]
    rate = equivalent_rate(dofs, groups, state.point.velocity)
    pressures = by_body(state.discretisation.continua, state.point.mean_stress)
    (pressure,) = [own for body, _, own in pressures if body == name]
    strengths = [
        (group.strength_at(mean) / strain_per_length(region)).reshape(region.elements.size, -1)
        for region, group, mean in zip(dofs.body.regions, groups, pressure, strict=True)
    ]  # at their pressure
    fields = {"equivalent_strain_rate": rate, "yield_stress": gathered(dofs.body, strengths)}
    means = {key: element_means(dofs, own) for key, own in fields.items()}
    means["dissipation"] = state.dissipation[name]
    stresses = {"stress": state.stress[name]}
    water = state.pore_pressure
    if any(own.any() for own in water.values()):
        stresses["effective_stress"] = state.effective_stress[name]
        means["pore_pressure"] = element_means(dofs, water[name])
    at_cells = means | {key: _tensors(dofs, own) for key, own in stresses.items()}
    return _continuum(dofs, number, {"velocity": _spatial(state.velocity[name])}, at_cells)


def _tensors(dofs: BodyDofs, stress: Floats) -> Floats:
    """Return means over elements of stresses (elements, q, 4 or 6) for ParaView, (6, e)."""
    known = np.stack([element_means(dofs, own) for own in stress.transpose(2, 0, 1)])
    return np.concatenate([known, np.zeros((6 - len(known), known.shape[1]))])


def _rigid(dofs: RigidDofs[BlockAssembly], motion: Floats, number: int) -> Iterator[_Part]:
    """Yield blocks, one part for each number of corners."""
    edges = dofs.body.edges
    moves = _spatial(dofs.velocity_at(motion, edges.block, edges.start))
    first = np.flatnonzero(np.diff(edges.block, prepend=-1))
    corners = np.diff(first, append=edges.block.size)
    for count in np.unique(corners).tolist():
        used = first[corners == count, None] + np.arange(count)
        points = used.ravel()
        yield _Part(
            "polygon",
            np.arange(points.size).reshape(used.shape),
            edges.start[:, points],
            {"velocity": moves[:, points]},
            {"body": np.full(len(used), number)},
        )


def write_path(path: Path, folder: str | os.PathLike[str]) -> File:
    """Write the snapshots of a path as VTU files, and a PVD file with the travel as time.

    At points: `velocity` (m/s at ``F0.u = 1``, of the step that led there), `displacement` (m, from
    the beginning, or from the last new mesh), `equivalent_strain` (means around vertices, see
    `lacore.model.bodies.continuum.nodal.vertex_means`, linear between). At cells means over the
    strain points by their volumes: `equivalent_strain`, `equivalent_strain_rate` (1/s, of that
    step), `yield_stress` (Pa, at that strain; for criteria with a law of hardening), `dissipation`
    (W/m^3: yield stress times strain rate; not for soils with non-associated flow, as it depends on
    their stresses); and `body`, its number in the problem. Rigid blocks are polygons, with their
    displacement from the beginning of the path, and NaN for all other values. Tools and obstacles
    are lines, their outlines near the bodies; those at rest have the number -1.

    Returns:
        the PVD file to open.

    Raises:
        InputError: a folder that cannot be written.
    """
    digits = len(str(path.snapshots[-1].step))
    return extend_series(path, folder, {}, digits)


def extend_series(
    path: Path, folder: str | os.PathLike[str], written: dict[int, float], digits: int = 4
) -> File:
    """Add the snapshots of a path to a series of files, see `write_path`.

    Args:
        path: path whose snapshots are written unless they are in the series.
        folder: folder of the files; it is made if it does not exist.
        written: the travel of each step in the series; new ones are added.
        digits: number of digits of a step in the name of its file.

    Returns:
        the PVD file of all steps.

    Raises:
        InputError: a folder that cannot be written.
    """
    place = File(os.fspath(folder))
    with _said("folder", place):
        place.mkdir(parents=True, exist_ok=True)
    for snapshot in path.snapshots:
        if snapshot.step not in written:
            _write(place / _name(snapshot.step, digits), _snapshot(path, snapshot))
            written[snapshot.step] = snapshot.travel
    collection = ElementTree.Element("VTKFile", type="Collection", version="0.1")
    series = ElementTree.SubElement(collection, "Collection")
    for step, travel in written.items():
        file = _name(step, digits)
        ElementTree.SubElement(
            series, "DataSet", timestep=repr(travel), group="", part="0", file=file
        )
    with _said("folder", place):
        ElementTree.indent(collection)
        ElementTree.ElementTree(collection).write(place / SERIES, "utf-8", xml_declaration=True)
    return place / SERIES


def _name(step: int, digits: int) -> str:
    return f"step-{step:0{digits}d}.vtu"


def _snapshot(path: Path, snapshot: Snapshot) -> Iterator[_Part]:
    stage = path.stage_of(snapshot)
    start, bodies = stage.start.nodes, stage.dofs_at(snapshot.configuration)
    numbers = {name: place for place, name in enumerate(stage.problem.bodies)}
    for name, dofs in bodies.items():
        strain, rate = snapshot.configuration.strain[name], snapshot.strain_rate[name]
        velocity, regions = snapshot.velocity[name], dofs.body.regions
        laws = [region.criterion.law for region in regions]
        at_points = {
            "velocity": _spatial(velocity),
            "displacement": _spatial(snapshot.configuration.nodes[name] - start[name]),
            "equivalent_strain": node_means(dofs, strain),
        }
        fields = {"equivalent_strain": strain, "equivalent_strain_rate": rate}
        if None not in laws:
            hardened = [
                law.stress(strain[region.elements])
                for law, region in zip(laws, regions, strict=True)
                if law is not None
            ]
            stress = gathered(dofs.body, hardened)
            fields |= {"yield_stress": stress, "dissipation": stress * rate}
        elif set(laws) == {None} and not any(region.form.frictional for region in regions):
            fields["dissipation"] = _dissipation(name, dofs, velocity)
        at_cells = {key: element_means(dofs, values) for key, values in fields.items()}
        yield _continuum(dofs, numbers[name], at_points, at_cells)
    for name in stage.drawn:
        yield from _block(path, snapshot, name, numbers[name])
    yield from _faces(stage, snapshot, numbers)


def _faces(stage: Stage, snapshot: Snapshot, numbers: Mapping[str, int]) -> Iterator[_Part]:
    """Yield the outlines of tools and obstacles in a box around the bodies, each once."""
    nodes = [
        at.nodes[name] for at in (stage.start, snapshot.configuration) for name in stage.bodies
    ]
    every = np.concatenate(nodes, axis=1)
    low, high = every.min(axis=1), every.max(axis=1)
    margin = _AROUND * float(np.linalg.norm(high - low))
    low, high = low - margin, high + margin
    obstacles = stage.obstacles_at(snapshot.configuration)
    for own in {one.carrier or repr(one.shape): one for one in obstacles}.values():
        face = shapely.LineString(own.shape.outline(low, high).T)
        number = -1 if own.carrier is None else numbers[own.carrier]
        for piece in shapely.get_parts(shapely.intersection(face, shapely.box(*low, *high))):
            points = shapely.get_coordinates(piece).T
            at = np.arange(points.shape[1])
            cells = np.stack([at[:-1], at[1:]], axis=1)
            if len(cells):
                yield _Part("line", cells, points, {}, {"body": np.full(len(cells), number)})


def _block(path: Path, snapshot: Snapshot, name: str, number: int) -> Iterator[_Part]:
    """Yield a rigid block in its place; its pose is its only node."""
    stage = path.stage
    block, before = (stage.blocks_at(at)[name] for at in (snapshot.configuration, stage.start))
    for part in _rigid(RigidDofs(block, 0), snapshot.velocity[name], number):
        moved = {"displacement": _spatial(part.points - before.edges.start)}
        yield replace(part, at_points={**part.at_points, **moved})


def _dissipation(name: str, dofs: BodyDofs, velocity: Floats) -> Floats:
    """Return the dissipation of a body without hardening at strain points, (elements, q), W/m^3."""
    unknowns = np.zeros(int(dofs.dofs.max()) + 1)
    unknowns[dofs.dofs] = velocity
    densities = [
        (group.dissipation(unknowns) / group.weights).reshape(region.elements.size, -1)
        for region, group in zip(dofs.body.regions, dofs.groups(name, unknowns.size), strict=True)
    ]
    return gathered(dofs.body, densities)


def _continuum(
    dofs: BodyDofs, body: int, at_points: Mapping[str, Floats], at_cells: Mapping[str, Floats]
) -> _Part:
    # Nodes of an element are in the order of VTK: vertices, edges from the first on, the centre.
    cells = dofs.element_nodes.T
    columns = {"body": np.full(len(cells), body), "region": region_numbers(dofs.body), **at_cells}
    kinds = _CELLS[dofs.body.dimension]
    return _Part(kinds[cells.shape[1]], cells, dofs.nodes, at_points, columns)


def _spatial(vectors: Floats) -> Floats:
    """Return the vectors with a third component, shape (3, n)."""
    return np.concatenate([vectors, np.zeros((3 - len(vectors), vectors.shape[1]))])


def _write(place: File, parts: Iterator[_Part] | Sequence[_Part]) -> None:
    import meshio  # imported here because it imports the writers of forty formats

    _require_vtu(place)
    parts = list(parts)
    first = np.cumsum([0, *(part.points.shape[1] for part in parts)])
    points = np.concatenate([_spatial(part.points) for part in parts], axis=1).T
    cells = [(part.kind, part.cells + at) for part, at in zip(parts, first[:-1], strict=True)]
    names = {name: own.shape[:-1] for part in parts for name, own in part.at_points.items()}
    at_points = {
        name: np.ascontiguousarray(
            np.concatenate([_at_points(part, name, own) for part in parts], axis=-1).T
        )
        for name, own in names.items()
    }
    shapes = {name: own.shape[:-1] for part in parts for name, own in part.at_cells.items()}
    at_cells = {name: [_values(part, name, own) for part in parts] for name, own in shapes.items()}
    mesh = meshio.Mesh(points, cells, point_data=at_points, cell_data=at_cells)
    with _said("path", place):
        mesh.write(place, file_format="vtu")


def _require_vtu(place: File) -> None:
    if place.suffix.lower() != ".vtu":
        raise InputError("path", str(place), "not the name of a VTU file", "let it end in .vtu")


def _values(part: _Part, name: str, shape: tuple[int, ...]) -> Any:
    """Return the values at cells, cells first; NaN if there are none."""
    found = part.at_cells.get(name, np.full((*shape, len(part.cells)), np.nan))
    return np.ascontiguousarray(found.T)


def _at_points(part: _Part, name: str, shape: tuple[int, ...]) -> Floats:
    """Return the values at points, points last; NaN if there are none."""
    return part.at_points.get(name, np.full((*shape, part.points.shape[1]), np.nan))


@contextmanager
def _said(what: str, place: File) -> Iterator[None]:
    """Convert errors of a file to an `InputError` with its fix."""
    try:
        yield
    except OSError as error:
        raise InputError(
            what,
            str(place),
            f"cannot be written ({error.strerror or error})",
            "free space, or name another place",
        ) from error
