"""A body in contact with itself along a path: its mesh may touch itself."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Self

from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.spaces import VelocitySpace
from lacore.model.meshes.checks import check_curved


@dataclass(frozen=True, repr=False)
class FoldingBody(Body):
    """A deformable body of curved elements; its boundary may touch itself, as contact allows."""

    @classmethod
    def of(cls, body: Body) -> Self:
        """Return a body that may touch itself."""
        return cls(**{entry.name: getattr(body, entry.name) for entry in fields(body)})

    def check_elements(self, space: VelocitySpace) -> None:
        """Raise `InputError` for inverted elements, not for those that touch each other."""
        check_curved(self.mesh, "Body.mesh")
