"""The runs of a case in the first comparison, which is `lacore compare` without a case."""

from dataclasses import dataclass

CLOSE = 0.05
"""Relative: the largest distance from the reference that a run of the first comparison may have."""


@dataclass(frozen=True)
class First:
    """The runs of a case in the first comparison; each must be within `CLOSE` of the reference.

    Where the coarsest mesh is too coarse for that, a case names another mesh or variant, or a
    bracket. The coarse meshes are run by ``lacore compare --all``.

    Attributes:
        variant: Name of the variant to run. Empty: the first one of the case.
        meshes: Levels to run, the first of them with several backends, all others with one exact
            backend. None: the coarsest and the finest level of the variant.
        bracket: Width of a bracket to compute in addition, relative to its mean. 0: no bracket.
    """

    variant: str = ""
    meshes: tuple[str, ...] | None = None
    bracket: float = 0.0
