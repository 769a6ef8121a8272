"""From a limit state to what the independent checker reads: geometry and loads by hand."""

import numpy as np

import lacore as la
from tests.coulomb_checker import Stated, centroid


def force_on_blocks(loads, outlines):
    """Force and moment about the centroid of each block, (B, 3); by hand."""
    total = np.zeros((len(outlines), 3))
    for load in loads:
        if isinstance(load, la.PointForce):
            names = list(outlines)
            at = load.at
            if isinstance(at, str):
                arm, b = np.zeros(2), names.index(at)
            else:
                inside = [n for n in names if on_or_in(outlines[n], at)]
                (name,) = inside
                b = names.index(name)
                arm = np.array(at) - centroid(outlines[name])
            fx, fy = load.vector
            total[b] += [fx, fy, arm[0] * fy - arm[1] * fx]
        else:
            for b, (name, outline) in enumerate(outlines.items()):
                if load.where in (None, name):
                    (x, y), (x1, y1) = outline.T, np.roll(outline, -1, axis=0).T
                    area = np.sum(x * y1 - x1 * y) / 2
                    total[b, :2] += area * np.array(load.vector)
    return total


def on_or_in(outline, point):
    along = np.roll(outline, -1, axis=0) - outline
    away = np.array(point) - outline
    return np.all(along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0] >= -1e-9)


def stated(problem, state, mu):
    """The statement of a state: its (u, t, alpha), and geometry and loads from the problem."""
    outlines = dict(problem.bodies["blocks"].polygons)
    names, table = list(outlines), state.reactions
    pairs = [name.removeprefix("blocks: ").split("#")[0].split("|") for name in table["interface"]]
    master, slave = np.array([[names.index(block) for block in pair] for pair in pairs]).T
    return Stated(
        outlines=tuple(outlines.values()),
        fixed=np.array([name in problem.supports[0].where for name in names]),
        reference=force_on_blocks(problem.reference_loads, outlines),
        dead=force_on_blocks(problem.dead_loads, outlines),
        slave=slave,
        master=master,
        place=table[["x", "y"]].to_numpy(),
        normal=table[["n_x", "n_y"]].to_numpy(),
        mu=np.full(len(table), mu),
        velocity=state.velocity["blocks"].T,
        normal_force=(table["t_n"] * table["length"]).to_numpy(),
        tangential_force=(table["t_t"] * table["length"]).to_numpy(),
        load_factor=state.load_factor,
    )
