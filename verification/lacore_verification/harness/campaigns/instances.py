"""Programs of cases as files for other solvers, each with its known minimum."""

import hashlib
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from math import nan
from pathlib import Path

import pandas as pd

import lacore as la
from lacore.program.kinematic import POWER, associated_contact, dimensionless
from lacore.reporting.errors import CapabilityError, require_known
from lacore.solvers.backend import Writes, check_capable
from lacore_verification.case import Case, Variant
from lacore_verification.catalogue.catalogue import Catalogue
from lacore_verification.harness.campaigns.comparison import capabilities, check_names, pick
from lacore_verification.harness.store.provenance import code_of
from lacore_verification.runs.commands import instance_name
from lacore_verification.runs.run import Run

INDEX = "index.csv"
CLOSE = 1e-7
"""Residual up to which a value is known well enough to be compared to 1e-6."""


@dataclass(frozen=True)
class Instance:
    """A row of the index.

    Attributes:
        file: name in the folder; empty where it was not written.
        case, variant, mesh: names of the problem.
        unknowns: number of velocities, which are the first columns.
        status: of the associated problem, as solved by `backend`: `SOLVED`, `LOCKED` (the program
            is infeasible), `UNSAFE` (it is unbounded), or `ALMOST_SOLVED`.
        value: the minimum of the program as written, in its units; NaN where it is not solved.
        power: `F0.U` of the program as written.
        load_factor: the same in units of the case.
        load_factor_unit: by which a value is multiplied, at a power of 1.
        length_unit, stress_unit, velocity_unit: m, Pa and m/s for 1 of the program.
        residual: the largest of its certificate.
        backend: that found the value.
        solver: the native status of its solve; for `auto` each solver in turn, with the final one
            last.
        code: digest of the code that computed the value, see `code_of`.
        sha256: of the file.
        left_out: why it was not written.
    """

    file: str
    case: str
    variant: str
    mesh: str
    unknowns: int
    status: str
    value: float
    power: float
    load_factor: float
    load_factor_unit: float
    length_unit: float
    stress_unit: float
    velocity_unit: float
    residual: float
    backend: str
    solver: str
    code: str
    sha256: str
    left_out: str


@dataclass(frozen=True)
class Known:
    """Known minimum of a program; its attributes are those of `Instance`."""

    status: str
    load_factor: float
    residual: float
    backend: str
    solver: str
    code: str


def formats() -> dict[str, Writes]:
    """Return the first backend that writes each file format."""
    found: dict[str, Writes] = {}
    for name in la.backend_names():
        with suppress(CapabilityError):
            backend = la.find_backend(name)
            if isinstance(backend, Writes):
                found = dict.fromkeys(backend.writers, backend) | found
    return found


def writer_of(ending: str) -> Writes:
    """Return the first backend that writes a format; those after it are not loaded.

    Raises:
        InputError: No backend writes it.
    """
    for name in la.backend_names():
        with suppress(CapabilityError):
            backend = la.find_backend(name)
            if isinstance(backend, Writes) and ending in backend.writers:
                return backend
    raise la.InputError("format", ending, "no backend here writes it", "install its solver")


def write_instances(
    names: Sequence[str],
    meshes: Sequence[str],
    endings: Sequence[str],
    out: Path,
    known: Catalogue,
    done: Callable[[Instance], None],
) -> pd.DataFrame:
    """Write associated programs of cases in each format, and return one row for each file.

    The index (`INDEX`) is written after each file, so that it is complete if the process is
    stopped.

    Raises:
        InputError: an unknown name or format.
    """
    check_names((), (), meshes, known)
    writers = formats()
    for ending in endings:
        require_known("--formats", ending, writers)
    by = {ending: writers[ending] for ending in endings}
    out.mkdir(parents=True, exist_ok=True)
    rows: list[Instance] = []
    for case, variants in pick(names, known):
        for variant in variants:
            for mesh in case.levels(variant, meshes):
                for row in _written(case, variant, mesh, by, out):
                    rows.append(row)
                    table_of(rows).to_csv(out / INDEX, index=False)
                    done(row)
    return table_of(rows)


def table_of(rows: Sequence[Instance]) -> pd.DataFrame:
    """Return the index of files."""
    return pd.DataFrame([asdict(row) for row in rows], columns=list(Instance.__annotations__))


def _solved(problem: "la.Problem") -> "la.LimitState":
    """Return the state of the associated problem, by the exact backend with the smallest residual.

    Backends other than the default are tried only until the residual is small enough.
    """
    state = la.solve(problem, coupling="associated")
    for name in _exact_backends():
        if state.status is not la.Status.SOLVED or _residual(state) <= CLOSE:
            return state
        with suppress(CapabilityError):
            other = la.solve(problem, name, "associated")
            if other.status is la.Status.SOLVED and _residual(other) < _residual(state):
                state = other
    return state


def _exact_backends() -> list[str]:
    """Return backends of the exact program that are available, without parts of other backends."""
    with_parts = [name for name in la.backend_names() if ":" not in name]
    return [
        name
        for name in with_parts
        if not capabilities(name).regularised and not la.find_backend(name).unavailable()
    ]


def _residual(state: "la.LimitState") -> float:
    """Return the largest residual of a certificate; NaN without one."""
    return state.certificate.worst[1] if state.certificate is not None else nan


def _written(
    case: Case, variant: Variant, mesh: str, by: Mapping[str, Writes], out: Path
) -> list[Instance]:
    state = _solved(case.problem(variant, mesh))
    run = Run(case, variant, mesh, state.backend)
    # Its discretisation has nodes at hinges that the solve has found within members.
    return write(run, state.discretisation, known_of(state, code_of(run)), by, out)


def known_of(state: "la.LimitState", code: str) -> Known:
    """Return the minimum that a state of the associated problem proves."""
    return Known(
        status=state.status.name,
        load_factor=state.load_factor,
        residual=_residual(state),
        backend=state.backend,
        solver=str(state.history["native_status"].iloc[-1]),
        code=code,
    )


def write(
    run: Run, stated: "la.Discretisation", known: Known, by: Mapping[str, Writes], out: Path
) -> list[Instance]:
    """Write the associated program of a run in each format, and return the rows of the index.

    A minimum whose residual is above `CLOSE` is omitted; its status is `ALMOST_SOLVED`.

    Args:
        run: Names of the case, the variant and the mesh.
        stated: Discretisation of its problem, as solved.
        known: Known minimum.
        by: Backend for each format.
        out: Existing folder.
    """
    program = dimensionless(stated.program, stated.natural).associated()
    contact, scales = associated_contact(program.contact), program.scales
    if known.status == la.Status.SOLVED.name and not known.residual <= CLOSE:
        known = replace(known, status=la.Status.ALMOST_SOLVED.name, load_factor=nan)
    has_value = known.status == la.Status.SOLVED.name
    about = Instance(
        file="",
        case=run.case.id,
        variant=run.variant.name,
        mesh=run.mesh,
        unknowns=program.n,
        value=POWER * known.load_factor / scales.load_factor if has_value else nan,
        power=POWER,
        load_factor_unit=scales.load_factor,
        length_unit=scales.length,
        stress_unit=scales.stress,
        velocity_unit=scales.velocity,
        sha256="",
        left_out="",
        **asdict(known),
    )
    rows = []
    for ending, backend in by.items():
        name = instance_name(run.case.id, run.variant.name, run.mesh, ending)
        try:
            check_capable(backend, program)
            backend.writers[ending](program, contact, out / name)
        except (CapabilityError, la.InputError) as error:
            rows.append(replace(about, left_out=str(error)))
        else:
            digest = hashlib.sha256((out / name).read_bytes()).hexdigest()
            rows.append(replace(about, file=name, sha256=digest))
    return rows
