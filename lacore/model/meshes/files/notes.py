"""Notes of a reader on a mesh: what it assumed or changed."""

from typing import Any, TypeVar

_NOTES = "_lacore_notes"

Read = TypeVar("Read")


def noted(mesh: Read, notes: tuple[str, ...]) -> Read:
    """Return a mesh with notes; they are lost if scikit-fem makes another mesh of it."""
    object.__setattr__(mesh, _NOTES, notes)
    return mesh


def notes_of(mesh: Any) -> tuple[str, ...]:
    """Return the notes on a mesh."""
    notes: tuple[str, ...] = getattr(mesh, _NOTES, ())
    return notes
