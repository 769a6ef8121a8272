"""Files of all formats of meshio, with errors in the words of lacore."""

from pathlib import Path
from typing import Any

from lacore.model.meshes.files.abaqus import read_abaqus
from lacore.reporting.errors import InputError


def loaded(path: Path) -> Any:
    """Return the file as meshio has it."""
    import meshio  # imported here because it imports the readers of forty formats

    if not path.is_file():
        raise InputError("path", str(path), "no such file", "give the path of a mesh file")
    if path.suffix.lower() == ".inp":
        return read_abaqus(path)
    with path.open("rb") as start:
        if start.readline().strip() == b"$MeshFormat" and start.readline().startswith(b"4.0"):
            raise InputError(
                "path", str(path), "version 4.0 of gmsh's format", "write version 4.1 or 2.2"
            )
    formats = meshio.extension_to_filetypes.get(path.suffix.lower(), [])
    if not formats:
        raise InputError(
            "path", str(path), "a format that is not known", "give a .msh file, or one of meshio's"
        )
    why = ""
    for name in sorted(formats, key=lambda name: name != "gmsh"):
        try:
            return getattr(meshio, name).read(path)
        except Exception as error:  # Readers fail on broken files with any kind of exception.
            why = why or f"{type(error).__name__} {error}".strip()
    raise InputError(
        "path",
        str(path),
        f"cannot be read ({why})",
        "write it anew (of gmsh: version 4.1 or 2.2, without Mesh.SaveAll)",
    )
