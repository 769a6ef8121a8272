"""The limit problems of a copy of a path, solved as those of the path itself."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

import lacore as la
from lacore.arrays import Floats
from lacore.paths.configuration import Configuration
from lacore.paths.flow import flow
from verification.fuzz.checks.verdict import Wrong, beyond


def same_load(name: str, path: la.Path, copy: la.Path) -> Iterator[Wrong]:
    """The last load of a moved or reordered path is that of its problem before, on its bodies.

    Nothing is claimed where the loop on friction certifies no load.
    """
    moment, state = copy.snapshots[-1].moment, copy.last
    assert moment is not None
    assert state is not None
    starts = (copy.stage.start.nodes, path.stage.start.nodes)
    begin, at = (_moved_back(own, *starts) for own in (moment.begin, moment.at))
    here = replace(moment, begin=begin, at=at, pressed=None, slip=None)
    found = flow(path.stage, here, path.settings).state
    if found.status is la.Status.SOLVED:
        load = np.array([state.load_factor])
        away = np.abs(found.load_factor - load)
        yield from beyond(f"{name}, load on the same bodies", "differs by", away, np.abs(load))


def _moved_back(
    own: Configuration, start: Mapping[str, Floats], known: Mapping[str, Floats]
) -> Configuration:
    """A configuration by the rigid motion that moves the nodes of one start to those of another."""
    both = [np.concatenate([nodes[name][:2] for name in start], axis=1) for nodes in (start, known)]
    means = [nodes.mean(axis=1, keepdims=True) for nodes in both]
    one, other = (nodes - mean for nodes, mean in zip(both, means, strict=True))
    left, _, right = np.linalg.svd(other @ one.T)
    turn = left @ right  # of determinant -1 where the copy is mirrored
    assert np.allclose(turn @ one, other, atol=1e-9 * np.abs(one).max())
    nodes = {}
    for name, values in own.nodes.items():
        places = turn @ (values[:2] - means[0]) + means[1]
        angles = np.linalg.det(turn) * values[2:]  # of rigid blocks
        nodes[name] = np.concatenate([places, angles])
    return Configuration(nodes, own.strain)
