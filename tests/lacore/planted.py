"""Limit states written down by hand: uniform stress, exact in the discrete problem too.

Unit square, k = 1. Conjugates of (eps_xx - eps_yy, gamma) and theta: ((s_xx - s_yy)/2, s_xy) and
(s_xx + s_yy)/2. At the bottom n = (0, 1), tangent (-1, 0).
"""

import numpy as np
from scipy.sparse import csr_matrix

import lacore as la
from lacore.program.kinematic import ContactRows, DissipationGroup, KinematicProgram
from lacore.program.state import ProgramState
from tests.lacore.models import obstacle, square

P0, MU = 0.8, 0.25


def on_free_unknowns(d, field):
    """The unknowns q whose velocity follows a field at the nodes (which must obey the supports)."""
    u = np.zeros(d.full.n)
    u[d.continua["block"].dofs] = field(d.continua["block"].nodes)
    q = np.linalg.lstsq(d.free_basis.toarray(), u)[0]
    assert np.allclose(d.free_basis @ q, u, atol=1e-12), "the field breaks a support"
    return q


def uniform(d, field, load_factor, s_xx, s_yy, s_xy, t_n, t_t):
    count, points = d.full.groups[0].weights.size, d.full.contact.count
    return ProgramState(
        velocity=on_free_unknowns(d, field),
        load_factor=load_factor,
        stress=(np.tile([(s_xx - s_yy) / 2, s_xy], (count, 1)),),
        mean_stress=(np.full(count, (s_xx + s_yy) / 2),),
        normal_reaction=np.full(points, t_n),
        tangential_reaction=np.full((points, 1), t_t),
    )


def sliding():
    """Shear patch (REFERENCES) at alpha = mu p0: the square slides on its base as a rigid body.

    Traction on the body at the bottom: sigma.(0, -1) = (-alpha, p0), so t_t = +alpha along (-1, 0)
    where it slips with u_t = -1.
    """
    d = la.discretise(
        la.Problem(
            {"block": square()},
            reference_loads=[
                la.Traction("block", "top", (1, 0)),
                la.Traction("block", "right", (0, 1)),
                la.Traction("block", "left", (0, -1)),
            ],
            interfaces=[obstacle(friction=MU)],
            dead_loads=[la.Pressure("block", "top", P0)],
        )
    )
    alpha = MU * P0
    return d, uniform(d, sliding_field, alpha, 0.0, -P0, alpha, P0, alpha)


def sliding_field(x):
    return np.stack([np.ones_like(x[0]), np.zeros_like(x[0])])


def flowing():
    """Square on a smooth floor under dead pressure p0, pulled apart: s_xx - s_yy = 2 k."""
    d = la.discretise(
        la.Problem(
            {"block": square()},
            reference_loads=[la.Traction("block", "right", (1, 0))],
            supports=[la.Fix("block", "left", "x")],
            interfaces=[obstacle(friction=la.SMOOTH)],
            dead_loads=[la.Pressure("block", "top", P0)],
        )
    )
    alpha = 2 - P0
    return d, uniform(d, flowing_field, alpha, alpha, -P0, 0.0, P0, 0.0)


def flowing_field(x):
    return np.stack([x[0], -x[1]])


def pushed_weight():
    """A rigid weight of 8 N on two patches of 1 and 3 m^2, pushed by 2 N against a spring of 1 N.

    The unknowns are its velocities along x and y. The spring strains at the velocity along x.
    """
    along, up = csr_matrix([[1.0, 0.0]] * 2), csr_matrix([[0.0, 1.0]] * 2)
    spring = DissipationGroup(
        name="spring",
        rows=csr_matrix([[1.0, 0.0]]),
        dim=1,
        weights=np.array([2.0]),
        bound=np.array([0.5]),
        volumetric=csr_matrix((1, 2)),
        volumetric_factor=0.0,
    )
    contact = ContactRows(
        normal=up,
        tangential=along,
        tangent_dim=1,
        weights=np.array([1.0, 3.0]),
        coefficient=np.full(2, 0.5),
        limit=np.zeros(2),
        dilatancy=np.zeros(2),
        interface=np.zeros(2, dtype=int),
    )
    return KinematicProgram((spring,), contact, np.array([2.0, 0.0]), np.array([0.0, -8.0]))


def wrong_state(load_factor=3.0, stress=0.4):
    """A state of the weight that breaks each law by a size of its own."""
    return ProgramState(
        velocity=np.array([0.6, -0.1]),
        load_factor=load_factor,
        stress=(np.array([[stress]]),),
        mean_stress=(np.zeros(1),),
        normal_reaction=np.array([1.0, 2.0]),
        tangential_reaction=np.array([[-0.7], [-0.8]]),
    )
