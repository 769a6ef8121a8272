"""What a problem of one body of tetrahedra states, and what its bounds say, for `solid_checker`.

Problems are read as they are written; of bounds velocities and stresses are taken, and load factors
as what they claim. Footings, twists and uniform body forces.
"""

import numpy as np

import lacore as la
from tests.lacore.solid_checker import carried, judged

_MEANS = {4: np.full(4, 1 / 4), 10: np.repeat([-1 / 20, 1 / 5], [4, 6])}  # of an element


def _where(mesh, given):
    """A name or a predicate as a mask of the middles of boundary faces."""
    if callable(given):
        return lambda middle: np.asarray(given(np.round(middle, 9)))
    named = mesh.p[:, mesh.facets[:, mesh.boundaries[given]]].mean(axis=1)
    known = {tuple(place) for place in np.round(named.T, 9).tolist()}
    return lambda middle: np.array([tuple(own) in known for own in np.round(middle.T, 9).tolist()])


def _supports(problem, mesh):
    """Places, and what is held there: several supports of one place are taken together."""
    together = {}
    for own in problem.supports:
        together.setdefault(own.where, set()).update([own.components])
    for where, parts in together.items():
        if parts == {"normal"}:
            yield _where(mesh, where), "normal"
        elif parts == {"xyz"}:
            yield _where(mesh, where), "all"
        else:
            assert parts == {"x", "y"}, "of a bar along z"
            yield _where(mesh, where), "along"


def _footing(load):
    if isinstance(load, la.Twist):
        assert load.warping
        return "along"
    return "all" if load.rough else "normal"


def _cone(body):
    own = body.criterion
    return float(own.k), float(getattr(own, "slope", 0.0))


def upper_proof(bound, level=4):
    """What the velocity of an upper bound proves, and the power of its reference load."""
    problem = bound.discretisation.problem
    (dofs,) = bound.discretisation.continua.values()
    mesh, (load,) = dofs.body.mesh, problem.reference_loads
    assert not problem.dead_loads
    velocity = bound.velocity[dofs.dofs][:, dofs.element_nodes].transpose(2, 1, 0)
    walls = [(where, held, np.zeros_like) for where, held in _supports(problem, mesh)]
    power = 1.0
    if isinstance(load, la.BodyForce):
        corner = mesh.p.T[mesh.t.T]
        volume = np.abs(np.linalg.det(corner[:, 1:] - corner[:, :1])) / 6
        mean = np.einsum("eni,n->ei", velocity, _MEANS[velocity.shape[1]])
        power = float(volume @ mean @ np.array(load.vector))
    elif isinstance(load, la.Twist):
        axis, through = np.array(load.axis), np.array(load.through)
        walls.append(
            (
                _where(mesh, load.where),
                _footing(load),
                lambda x: np.cross(axis, (x.T - through) / load.torque).T,
            )
        )
    else:
        middle = mesh.p[:, mesh.facets[:, mesh.boundary_facets()]]
        a, b, c = middle[:, :, _where(mesh, load.where)(middle.mean(axis=1))].transpose(1, 2, 0)
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
        speed = np.array(load.direction) / (load.pressure * area)
        walls.append(
            (
                _where(mesh, load.where),
                _footing(load),
                lambda x: np.broadcast_to(speed[:, None], x.shape),
            )
        )
    return judged(mesh.p, mesh.t, velocity, *_cone(dofs.body), walls, level), power


def lower_proof(bound):
    """Residuals of the stresses of a lower bound, and the load factor that they carry.

    That of a body force is what they were asked to balance.
    """
    problem = bound.model.problem
    ((name, body),) = problem.bodies.items()
    mesh, (load,) = body.mesh, problem.reference_loads
    assert not problem.dead_loads
    boundaries = list(_supports(problem, mesh))
    force = np.zeros(3)
    if isinstance(load, la.BodyForce):
        force = bound.load_factor * np.array(load.vector)
    else:
        boundaries.append((_where(mesh, load.where), _footing(load)))
    own = carried(mesh.p, mesh.t, bound.stress[name], *_cone(body), boundaries, force)
    if isinstance(load, la.BodyForce):
        return own, bound.load_factor
    if isinstance(load, la.Twist):
        turning = own.torques[-1] - np.cross(load.through, own.forces[-1])
        return own, float(turning @ np.array(load.axis)) / load.torque
    middle = mesh.p[:, mesh.facets[:, mesh.boundary_facets()]]
    a, b, c = middle[:, :, _where(mesh, load.where)(middle.mean(axis=1))].transpose(1, 2, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    return own, float(own.forces[-1] @ np.array(load.direction)) / (load.pressure * area)
