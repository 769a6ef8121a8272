"""Which classes of problems there are; each a pure function of its random numbers."""

import zlib
from collections.abc import Callable, Mapping

import numpy as np

from lacore.errors import require_known
from verification.fuzz.drawn import draw_blocks, draw_continua, draw_frames, draw_paths
from verification.fuzz.drawn.draw import Rng
from verification.fuzz.drawn.recipe import Recipe

CLASSES: Mapping[str, Callable[[Rng], Recipe]] = {
    "blocks": draw_blocks.blocks,
    "weights": draw_blocks.weights,
    "plane-strain": draw_continua.plane_strain,
    "plane-stress": draw_continua.plane_stress,
    "axisymmetric": draw_continua.axisymmetric,
    "two-bodies": draw_continua.two_bodies,
    "mixtures": draw_continua.mixtures,
    "frames": draw_frames.frames,
    "paths": draw_continua.paths,
    "pairs-on-paths": draw_paths.pairs,
    "tools-on-paths": draw_paths.tools,
}


def random_of(kind: str, seed: int, number: int, use: str = "") -> Rng:
    """Random numbers of one problem of a class; `use`: for what, each has its own."""
    return np.random.default_rng([seed, number, zlib.crc32(f"{kind}/{use}".encode())])


def draw(kind: str, seed: int, number: int) -> Recipe:
    """The recipe of problem `number` of a class.

    Raises:
        InputError: an unknown class.
    """
    require_known("class", kind, CLASSES)
    return CLASSES[kind](random_of(kind, seed, number))
