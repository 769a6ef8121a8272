"""Limit problems of a copy of a path, compared with those of the path."""

from collections.abc import Iterator

import numpy as np
from scipy.spatial import cKDTree

import lacore as la
from lacore.numerics.arrays import Floats
from lacore.paths.configuration import Configuration
from lacore.paths.flow import Moment, flow
from lacore.paths.stage import Stage
from lacore_verification.fuzz.checks.verdict import Wrong, beyond

_SAME = 1e-9  # Relative to the size of all bodies.


def same_load(name: str, path: la.Path, copy: la.Path) -> Iterator[Wrong]:
    """Yield a failure if the last load of a copied path differs from that of the original problem.

    The original problem is solved on the bodies of the copy. Nothing is reported if the loop on
    friction certifies no load.
    """
    moment, state = copy.snapshots[-1].moment, copy.last
    assert moment is not None
    assert state is not None
    begin, at = (moved_back(own, copy.stage, path.stage) for own in (moment.begin, moment.at))
    here = Moment(begin, at, moment.duration, moment.share)
    found = flow(path.stage, here, path.settings).state
    if found.status is la.Status.SOLVED:
        load = np.array([state.load_factor])
        away = np.abs(found.load_factor - load)
        yield from beyond(f"{name}, load on the same bodies", "differs by", away, np.abs(load))


def moved_back(own: Configuration, stage: Stage, known: Stage) -> Configuration:
    """Return a configuration after the rigid motion from the start of its stage to that of another.

    Elements of mirrored meshes may begin at another corner: strains are those of the same place.
    """
    starts = (stage.start.nodes, known.start.nodes)
    both = [np.concatenate([nodes[name][:2] for name in own.nodes], axis=1) for nodes in starts]
    means = [nodes.mean(axis=1, keepdims=True) for nodes in both]
    one, other = (nodes - mean for nodes, mean in zip(both, means, strict=True))
    left, _, right = np.linalg.svd(other @ one.T)
    turn = left @ right  # Its determinant is -1 where the copy is mirrored.

    def back(places: Floats) -> Floats:
        return np.asarray(turn @ (places - means[0]) + means[1])

    size = float(np.abs(one).max())
    assert np.allclose(back(both[0]), both[1], atol=_SAME * size)
    angle = np.linalg.det(turn)  # Rotation of rigid blocks.
    nodes = {
        name: np.concatenate([back(places[:2]), angle * places[2:]])
        for name, places in own.nodes.items()
    }
    strain = dict(own.strain)
    points, same = (_strain_points(each) for each in (stage, known))
    for name, places in points.items():
        away, place = cKDTree(back(places).T).query(same[name].T)
        assert np.max(away) <= _SAME * size
        strain[name] = own.strain[name].ravel()[place].reshape(own.strain[name].shape)
    return Configuration(nodes, strain)


def _strain_points(stage: Stage) -> dict[str, Floats]:
    """Return the strain points of deformable bodies at the start, (2, points) by body."""
    dofs = stage.dofs_at(stage.start)
    return {
        name: np.asarray(own.basis.global_coordinates()).reshape(2, -1)
        for name, own in dofs.items()
    }
