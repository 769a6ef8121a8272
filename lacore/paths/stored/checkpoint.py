"""Checkpoints of long paths, which contain the data of the next step (npz with JSON inside).

A file is replaced as a whole when the new one is complete and on the disk. If the process is
killed, the last or the last but one therefore exists. It holds arrays and text, no code, and
digests of each of them. Data that are read are checked (`lacore.paths.stored.progress`).
"""

import hashlib
import io
import json
import os
import struct
import zipfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, fields
from pathlib import Path as File
from types import TracebackType
from typing import Any, Self

import numpy as np
from filelock import FileLock, Timeout
from skfem import Mesh
from skfem.mesh import MeshQuad1, MeshQuad2, MeshTri1, MeshTri2

from lacore import __version__
from lacore.coupling.friction_start import FrictionStart
from lacore.numerics.arrays import Floats
from lacore.paths.configuration import Configuration
from lacore.paths.flow import Moment, Snapshot
from lacore.paths.path import Event, PathStep
from lacore.paths.renewal.remeshing import NewMeshes
from lacore.paths.schemes import Here
from lacore.paths.stage import Stage
from lacore.paths.stored.fingerprint import fingerprint
from lacore.paths.stored.progress import Progress, WrongFieldError, require_sound
from lacore.reporting.errors import InputError
from lacore.solvers.backend import load_backend

_FORMAT = 7
_KINDS = {kind.__name__: kind for kind in (MeshTri1, MeshTri2, MeshQuad1, MeshQuad2)}
_UNREADABLE = (
    *(zipfile.BadZipFile, zipfile.LargeZipFile, KeyError, ValueError, TypeError, EOFError),
    *(IndexError, AttributeError, RuntimeError, OverflowError, MemoryError, OSError),
    *(AssertionError, zlib.error, struct.error),
)
"""What readers of zip, npy and JSON raise on files that are not as they were written."""


def identity(
    stage: Stage, settings: Mapping[str, Any], arguments: Mapping[str, Any]
) -> dict[str, str]:
    """Return digests of all data that determine a path.

    Args:
        stage: The problem.
        settings: Settings of each solve.
        arguments: All other arguments.
    """
    problem, options = stage.problem, settings["options"]
    solver = {"backend": [settings["backend"], load_backend(settings["backend"]).version()]}
    parts = {
        "bodies": stage.bodies,
        "supports": problem.supports,
        "loads": [problem.reference_loads, problem.dead_loads, stage.grips],
        "interfaces": [*stage.obstacles, *stage.pairs, *problem.interfaces],
        **arguments,
        **settings,
        **solver,
        "options": {name: options[name] for name in sorted(options)},
        "version of lacore": __version__,
    }
    return fingerprint(parts)


class Checkpoint:
    """The file of one path, open for writing; a context manager.

    Args:
        place: Path of the file; a missing folder is created. A lock file is next to it.
        identity: See `identity`.

    Raises:
        InputError: It is not a file name, or the file cannot be written, or another process writes
            it.
    """

    def __init__(self, place: str | os.PathLike[str], identity: Mapping[str, str]) -> None:
        if not isinstance(place, str | os.PathLike):
            raise InputError("checkpoint", place, "not a path", "give the name of a file")
        self._file, self._identity = File(os.fspath(place)), dict(identity)
        with self._said():
            self._file.parent.mkdir(parents=True, exist_ok=True)
            self._lock = FileLock(f"{self._file}.lock", timeout=0)
            self._lock.acquire()

    def load(self, start: Configuration) -> Progress | None:
        """Read the file of a path that begins at `start`; return None if it does not exist.

        Raises:
            InputError: The file is damaged, was changed, is not a checkpoint, or belongs to another
                path.
        """
        if not self._file.exists():
            return None
        with self._said():
            data = self._file.read_bytes()
        try:
            with zipfile.ZipFile(io.BytesIO(data)) as archive:
                broken = archive.testzip()  # checksums
            if broken is not None:
                raise ValueError(broken)
            with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
                head = json.loads(arrays["head"].tobytes())
                if head["format"] != _FORMAT:
                    raise self._wrong(f"has format {head['format']}", "take the lacore it is of")
                known = head["identity"]
                names = [n for n, digest in self._identity.items() if known.get(n) != digest]
                if not names:
                    return _sound(head, arrays, start)
        except WrongFieldError as error:
            raise self._wrong(
                f"is damaged or was changed: {error}", "restore a copy, or name another file"
            ) from error
        except _UNREADABLE as error:
            if isinstance(error, InputError):
                raise
            raise self._wrong(
                f"is damaged, or no checkpoint ({type(error).__name__})",
                "restore a copy, or name another file",
            ) from error
        raise self._wrong(
            f"is of another path: other {', '.join(names)}",
            "give the same arguments as then, or name another file",
        )

    def save(self, progress: Progress) -> None:
        """Keep a path so far: it is on the disk when this returns.

        Raises:
            InputError: it cannot be written; what was there before stays.
        """
        head, arrays = _packed(progress)
        head |= {"digests": {name: _digest(values) for name, values in arrays.items()}}
        text = json.dumps({"format": _FORMAT, "identity": self._identity, **head}).encode()
        arrays["seal"] = _seal(text)
        part = self._file.with_name(f"{self._file.name}.part")
        try:
            with self._said():
                with part.open("wb") as file:
                    np.savez(file, head=np.frombuffer(text, dtype=np.uint8), **arrays)
                    file.flush()
                    os.fsync(file.fileno())
                part.replace(self._file)
                _settle(self._file.parent)
        except BaseException:
            with suppress(OSError):
                part.unlink()
            raise

    def close(self) -> None:
        """Let others write."""
        self._lock.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _wrong(self, why: str, fix: str) -> InputError:
        return InputError("checkpoint", str(self._file), why, fix)

    @contextmanager
    def _said(self) -> Iterator[None]:
        """What goes wrong with the file, as a sentence with its fix."""
        try:
            yield
        except Timeout as error:
            raise self._wrong(
                "is being written by another process", "wait, or name another file"
            ) from error
        except OSError as error:
            raise self._wrong(
                f"cannot be used ({error.strerror or error})",
                "free space or name another file; the last step that was kept stays",
            ) from error


def _settle(folder: File) -> None:
    """Write the new name of a file to the disk, on systems that support this for folders."""
    if os.name != "posix":
        return
    number = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(number)
    finally:
        os.close(number)


def _packed(progress: Progress) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the text and the arrays of a path, with numbers in place of bodies."""
    here = progress.here
    names = list(here.configuration.nodes)
    packing = _Packing(names)
    arrays: dict[str, Any] = {
        f"row/{entry.name}": np.array([getattr(row, entry.name) for row in progress.rows])
        for entry in fields(PathStep)
    }
    arrays |= packing.configuration("here", here.configuration)
    arrays |= packing.fields("here/velocity", here.velocity)
    arrays |= packing.fields("here/strain_rate", here.strain_rate)
    for place, snapshot in enumerate(progress.snapshots):
        arrays |= packing.snapshot(f"snapshot/{place}", snapshot)
    for place, own in enumerate(progress.made):
        arrays |= packing.fields(f"made/{place}/nodes", own.nodes)
        for number, mesh in enumerate(own.meshes.values()):
            arrays |= _mesh_arrays(f"made/{place}/mesh/{number}", mesh)
    head = {
        "bodies": names,
        "here": {
            "step": here.step,
            "travel": here.travel,
            "speed": here.speed,
            "growth": here.growth,
        },
        "step": progress.step,
        "snapshots": [
            {
                "step": own.step,
                "travel": own.travel,
                "duration": own.duration,
                "moment": own.moment and [own.moment.duration, own.moment.share],
            }
            for own in progress.snapshots
        ],
        "events": [asdict(event) for event in progress.events],
        "made": [
            {
                "step": own.step,
                "meshes": [
                    [
                        name,
                        type(mesh).__name__,
                        list(mesh.boundaries or {}),
                        list(mesh.subdomains or {}),
                    ]
                    for name, mesh in own.meshes.items()
                ],
            }
            for own in progress.made
        ],
    }
    return head, arrays


@dataclass(frozen=True)
class _Packing:
    """Arrays by body as arrays by the number of the body."""

    names: Sequence[str]

    def fields(self, key: str, by_body: Mapping[str, Floats] | None) -> dict[str, Floats]:
        if by_body is None:
            return {}
        return {f"{key}/{number}": by_body[name] for number, name in enumerate(self.names)}

    def configuration(self, key: str, own: Configuration) -> dict[str, Floats]:
        return self.fields(f"{key}/nodes", own.nodes) | self.fields(f"{key}/strain", own.strain)

    def snapshot(self, key: str, snapshot: Snapshot) -> dict[str, Floats]:
        arrays = self.configuration(key, snapshot.configuration)
        arrays |= self.fields(f"{key}/velocity", snapshot.velocity)
        arrays |= self.fields(f"{key}/strain_rate", snapshot.strain_rate)
        if (moment := snapshot.moment) is not None:
            arrays |= self.configuration(f"{key}/begin", moment.begin)
            arrays |= self.configuration(f"{key}/at", moment.at)
            friction = {
                f"{key}/{name}": values for name, values in vars(moment.friction_start).items()
            }
            arrays |= {name: values for name, values in friction.items() if values is not None}
        return arrays


def _mesh_arrays(key: str, mesh: Mesh) -> dict[str, Any]:
    arrays = {f"{key}/p": mesh.doflocs, f"{key}/t": mesh.t}
    for part, facets in enumerate((mesh.boundaries or {}).values()):
        arrays[f"{key}/boundary/{part}"] = np.asarray(facets, dtype=np.int64)
    for part, elements in enumerate((mesh.subdomains or {}).values()):
        arrays[f"{key}/region/{part}"] = np.asarray(elements, dtype=np.int64)
    return arrays


def _seal(text: bytes) -> np.ndarray:
    """Return the digest of the head, which contains those of all arrays."""
    return np.frombuffer(hashlib.sha256(text).digest(), dtype=np.uint8)


def _digest(values: np.ndarray) -> str:
    own = np.ascontiguousarray(values)
    about = f"{own.dtype} {np.shape(values)} ".encode()
    return hashlib.sha256(about + own.tobytes()).hexdigest()


def _sound(head: Mapping[str, Any], archive: Mapping[str, Any], start: Configuration) -> Progress:
    """Return a path so far after checking that it is unchanged and consistent.

    Raises:
        WrongFieldError: It is not; the message names the field.
    """
    arrays = dict(archive)
    text, seal = arrays.pop("head"), arrays.pop("seal")
    if not np.array_equal(seal, _seal(text.tobytes())):
        raise WrongFieldError("head", "was changed after it was written")
    known = head["digests"]
    for name in sorted({*known, *arrays}):
        if name not in arrays or known.get(name) != _digest(arrays[name]):
            raise WrongFieldError(name, "was changed after it was written, or is missing")
    progress = _unpacked(head, arrays)
    require_sound(progress, start)
    return progress


def _unpacked(head: Mapping[str, Any], arrays: Mapping[str, Any]) -> Progress:
    names = head["bodies"]

    def unpack(key: str) -> dict[str, Floats]:
        return {name: arrays[f"{key}/{number}"] for number, name in enumerate(names)}

    def configuration(key: str) -> Configuration:
        return Configuration(unpack(f"{key}/nodes"), unpack(f"{key}/strain"))

    def moment(key: str, duration: float, share: float) -> Moment:
        start = FrictionStart(arrays.get(f"{key}/normal_reaction"), arrays.get(f"{key}/slip"))
        begin, at = configuration(f"{key}/begin"), configuration(f"{key}/at")
        return Moment(begin, at, duration, share, start)

    columns = {entry.name: arrays[f"row/{entry.name}"].tolist() for entry in fields(PathStep)}
    rows = zip(*columns.values(), strict=True)
    return Progress(
        here=Here(
            **head["here"],
            configuration=configuration("here"),
            velocity=unpack("here/velocity"),
            strain_rate=unpack("here/strain_rate"),
        ),
        step=head["step"],
        rows=[PathStep(**dict(zip(columns, row, strict=True))) for row in rows],
        events=[Event(**event) for event in head["events"]],
        snapshots=[
            Snapshot(
                step=own["step"],
                travel=own["travel"],
                duration=own["duration"],
                configuration=configuration(f"snapshot/{place}"),
                velocity=unpack(f"snapshot/{place}/velocity"),
                strain_rate=unpack(f"snapshot/{place}/strain_rate"),
                moment=own["moment"] and moment(f"snapshot/{place}", *own["moment"]),
            )
            for place, own in enumerate(head["snapshots"])
        ],
        made=[
            NewMeshes(
                step=own["step"],
                nodes=unpack(f"made/{place}/nodes"),
                meshes={
                    name: _mesh(arrays, f"made/{place}/mesh/{number}", kind, parts, regions)
                    for number, (name, kind, parts, *regions) in enumerate(own["meshes"])
                },
            )
            for place, own in enumerate(head["made"])
        ],
    )


def _mesh(
    arrays: Mapping[str, Any],
    key: str,
    kind: str,
    parts: Sequence[str],
    regions: Sequence[Sequence[str]],
) -> Mesh:
    """Return a mesh from its arrays; a mesh without regions has no list of their names."""
    mesh = _KINDS[kind](arrays[f"{key}/p"], arrays[f"{key}/t"]).with_boundaries(
        {name: arrays[f"{key}/boundary/{part}"] for part, name in enumerate(parts)}
    )
    named = {
        name: arrays[f"{key}/region/{part}"] for own in regions for part, name in enumerate(own)
    }
    return mesh.with_subdomains(named) if named else mesh
