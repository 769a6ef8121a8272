"""From a limit state of blocks in space to what the independent checker reads."""

import numpy as np

import lacore as la
from tests.coulomb_checker_3d import Stated3D


def stated(problem, state):
    """The statement of a state: its (u, t, alpha), and geometry and loads from the problem."""
    (body,) = problem.bodies.values()
    polyhedra = dict(body.polyhedra)
    names, table = list(polyhedra), state.reactions
    pairs = [name.split(": ")[1].split("#")[0].split("|") for name in table["interface"]]
    master, slave = np.array([[names.index(block) for block in pair] for pair in pairs]).T
    laws = {frozenset(pair): coefficient(law) for pair, law in body.joint_friction.items()}
    return Stated3D(
        corners=tuple(np.array(own.vertices) for own in polyhedra.values()),
        faces=tuple(own.faces for own in polyhedra.values()),
        fixed=np.array([name in problem.supports[0].where for name in names]),
        reference=per_volume(problem.reference_loads, len(names)),
        dead=per_volume(problem.dead_loads, len(names)),
        slave=slave,
        master=master,
        place=table[["x", "y", "z"]].to_numpy(),
        normal=table[["n_x", "n_y", "n_z"]].to_numpy(),
        mu=np.array([laws.get(frozenset(pair), coefficient(body.friction)) for pair in pairs]),
        velocity=state.velocity[next(iter(problem.bodies))].T,
        normal_force=(table["t_n"] * table["area"]).to_numpy(),
        tangential_force=table[["t_t_x", "t_t_y", "t_t_z"]].to_numpy() * table[["area"]].to_numpy(),
        load_factor=state.load_factor,
        area=table["area"].to_numpy(),
        strength=np.full(len(table), strength(body.crushing)),
    )


def strength(crushing):
    return np.inf if crushing is None else crushing.strength


def coefficient(law):
    return law.mu if isinstance(law, la.Coulomb) else float(law)


def per_volume(loads, count):
    """Of uniform body forces on all blocks."""
    assert all(load.where is None for load in loads)
    return np.tile(np.sum([load.vector for load in loads], axis=0), (count, 1)).astype(float)
