"""Small problems of tetrahedra, and checks of their bounds from mesh and fields alone."""

import numpy as np

import lacore as la

CRITERION = la.VonMises(shear_strength=1.0)
SPACES = ("p2-vertex", "p1-disc", "p2-disc")
_EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))


def cube(space="p2-disc", n=1, crossed=False, mesh=None, load=None, criterion=CRITERION):
    """An eighth of a block between smooth platens: sqrt(3) k."""
    mesh = la.meshes.box((0, 1), (0, 1), (0, 1), n, n, n, crossed) if mesh is None else mesh
    return la.Problem(
        bodies={"block": la.Body(mesh, criterion, kinematics="3d", space=space)},
        reference_loads=[load or la.Pressure("block", "top")],
        supports=[la.Fix("block", side, "normal") for side in ("left", "front", "bottom")],
    )


def under_strip(x):
    return (x[2] == 0) & (x[0] <= 1)


def strip(space="p2-disc", n=4, rough=False, crossed=False):
    """Half of a strip footing on a slab one element thick, symmetric on both faces: 2 + pi."""
    mesh = la.meshes.box((0, 2.5), (0, 0.5), (-1.25, 0), n + 1, 1, n, crossed, (1.0, 2.0))
    return la.Problem(
        bodies={"soil": la.Body(mesh, CRITERION, kinematics="3d", space=space)},
        reference_loads=[la.RigidFooting("soil", under_strip, (0, 0, -1), rough=rough)],
        supports=[
            *(la.Fix("soil", side, "normal") for side in ("left", "front", "back")),
            *(la.Fix("soil", side, "xyz") for side in ("right", "bottom")),
        ],
    )


def faces_of(t):
    """Vertices (faces, 3) and the elements on both sides (faces, 2), -1 for none."""
    local = np.array([(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)])
    every = np.sort(t.T[:, local].reshape(-1, 3), axis=1)
    corners, first, face, count = np.unique(
        every, axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    owner = np.repeat(np.arange(t.shape[1]), 4)
    sides = np.full((len(corners), 2), -1)
    sides[:, 0] = owner[first]
    last = np.zeros(len(corners), dtype=int)
    last[face.ravel()] = owner
    sides[count == 2, 1] = last[count == 2]
    return corners, sides


def normals_of(p, t, corners, sides):
    """Areas and unit normals out of the first element."""
    a, b, c = p.T[corners].transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    middle = p.T[t.T[sides[:, 0]]].mean(axis=1)
    normal *= np.sign(np.sum(normal * (a - middle), axis=1))[:, None]
    return size / 2, normal / size[:, None]


def gradients(p, t):
    """Gradients of barycentric coordinates, (elements, 4, 3), and volumes."""
    corner = p.T[t.T]
    matrix = np.concatenate([np.ones((*corner.shape[:2], 1)), corner], axis=2)
    inverse = np.linalg.inv(matrix)
    return inverse[:, 1:].transpose(0, 2, 1), np.abs(np.linalg.det(matrix)) / 6


def tensors(stress):
    """Matrices of stresses (xx, yy, zz, xy, yz, zx)."""
    xx, yy, zz, xy, yz, zx = np.moveaxis(stress, -1, 0)
    return np.stack(
        [np.stack([xx, xy, zx], -1), np.stack([xy, yy, yz], -1), np.stack([zx, yz, zz], -1)], -2
    )


def lower_residuals(p, t, stress, free, smooth, footing, alpha, k=1.0):
    """What stresses at the vertices of elements, (elements, 4, 6), leave of a lower bound.

    Args:
        p, t: mesh.
        stress: Pa.
        free, smooth, footing: masks of the middles of boundary faces, (3, n): no traction, none
            along them, and what carries the load ``-alpha`` per area along z, smooth.
        alpha: load factor.
        k: shear strength.
    """
    sigma = tensors(stress)
    gradient, _ = gradients(p, t)
    inside = np.abs(np.einsum("eaij,eaj->ei", sigma, gradient)).max()
    corners, sides = faces_of(t)
    area, normal = normals_of(p, t, corners, sides)

    def traction(faces, side):
        element = sides[faces, side]
        at = np.argmax(t.T[element][:, None] == corners[faces][:, :, None], axis=2)
        return np.einsum("faij,fj->fai", sigma[element[:, None], at], normal[faces])

    inner = np.flatnonzero(sides[:, 1] >= 0)
    outer = np.flatnonzero(sides[:, 1] < 0)
    jump = np.abs(traction(inner, 0) - traction(inner, 1)).max()
    middle, pulled = p.T[corners[outer]].mean(axis=1).T, traction(outer, 0)
    along = (
        pulled - np.einsum("fai,fi->fa", pulled, normal[outer])[..., None] * normal[outer][:, None]
    )
    under = footing(middle)
    force = (area[outer][under, None] * pulled[under].mean(axis=1)).sum(axis=0)[2]
    deviator = sigma - np.trace(sigma, axis1=2, axis2=3)[..., None, None] / 3 * np.eye(3)
    return {
        "equilibrium inside": inside,
        "jumps of traction": jump,
        "free faces": np.abs(pulled[free(middle)]).max(initial=0.0),
        "smooth faces": np.abs(along[smooth(middle) | under]).max(initial=0.0),
        "load": abs(force / area[outer][under].sum() + alpha),
        "yield": np.sqrt((deviator**2).sum(axis=(2, 3)) / 2).max() / k - 1,
    }


class Flow:
    """Velocities of elements from the values at their nodes, by place alone.

    Args:
        p, t: mesh.
        nodes: places, (3, n).
        element_nodes: (a, elements).
        velocity: (3, n).
    """

    def __init__(self, p, t, nodes, element_nodes, velocity):
        self.p, self.t = p, t
        self.gradient, self.volume = gradients(p, t)
        own = nodes.T[element_nodes.T]
        shares = 1 / 4 + np.einsum(
            "eaj,enj->ena", self.gradient, own - p.T[t.T].mean(axis=1)[:, None]
        )
        columns = self._terms(shares)
        self.linear = element_nodes.shape[0] == 4
        self.coefficients = np.linalg.solve(columns, velocity.T[element_nodes.T])

    @staticmethod
    def _terms(shares):
        if shares.shape[-2] == 4:
            return shares
        mixed = [shares[..., a] * shares[..., b] for a, b in _EDGES]
        return np.concatenate([shares**2, np.stack(mixed, axis=-1)], axis=-1)

    def at(self, elements, shares):
        """Velocities in elements (m,) at barycentric coordinates (m, q, 4)."""
        if self.linear:
            return np.einsum("mqa,maj->mqj", shares, self.coefficients[elements])
        mixed = [shares[..., a] * shares[..., b] for a, b in _EDGES]
        terms = np.concatenate([shares**2, np.stack(mixed, axis=-1)], axis=-1)
        return np.einsum("mqa,maj->mqj", terms, self.coefficients[elements])

    def strain(self, shares):
        """Strain rates in all elements at barycentric coordinates (q, 4), (elements, q, 3, 3)."""
        q = len(shares)
        if self.linear:
            slope = np.broadcast_to(np.eye(4), (q, 4, 4))
        else:
            slope = np.zeros((q, 10, 4))
            slope[:, range(4), range(4)] = 2 * shares
            for row, (a, b) in enumerate(_EDGES, start=4):
                slope[:, row, a], slope[:, row, b] = shares[:, b], shares[:, a]
        grad = np.einsum("ecj,qca,eai->eqji", self.coefficients, slope, self.gradient)
        return (grad + grad.swapaxes(2, 3)) / 2


def sampled(parts, corners):
    """Centres of many small parts of a simplex, as barycentric coordinates, equal weights."""
    rng = np.random.default_rng(1)
    return rng.dirichlet(np.ones(corners), size=parts)


def upper_residuals(flow, footing, smooth, held, speed, parts=400):
    """Divergence, normal jumps, walls, footing, and the power by sampling, of an upper bound.

    Args:
        flow: the velocities.
        footing, smooth, held: masks of the middles of boundary faces, (3, n).
        speed: of the footing, downwards.
        parts: samples in each element and face.
    """
    p, t = flow.p, flow.t
    theta = np.trace(flow.strain(np.eye(4)), axis1=2, axis2=3)
    inside = sampled(parts, 4)
    strain = flow.strain(inside)
    power = flow.volume @ (np.sqrt(2.0) * np.linalg.norm(strain, axis=(2, 3))).mean(axis=1)
    corners, sides = faces_of(t)
    area, normal = normals_of(p, t, corners, sides)
    places = np.concatenate([np.eye(3), sampled(parts, 3)])

    def velocity(faces, side):
        element = sides[faces, side]
        at = np.argmax(t.T[element][:, None] == corners[faces][:, :, None], axis=2)
        shares = np.zeros((len(faces), len(places), 4))
        for corner in range(3):
            shares[np.arange(len(faces)), :, at[:, corner]] = places[:, corner]
        return flow.at(element, shares)

    inner = np.flatnonzero(sides[:, 1] >= 0)
    outer = np.flatnonzero(sides[:, 1] < 0)
    jump = velocity(inner, 1) - velocity(inner, 0)
    power += area[inner] @ np.linalg.norm(jump[:, 3:], axis=2).mean(axis=1)
    across = np.abs(np.einsum("fqj,fj->fq", jump, normal[inner])).max(initial=0.0)
    middle, moved = p.T[corners[outer]].mean(axis=1).T, velocity(outer, 0)
    out = np.einsum("fqj,fj->fq", moved, normal[outer])
    walls, under = smooth(middle) | held(middle), footing(middle)
    stuck = moved[held(middle)][:, 3:]
    power += area[outer][held(middle)] @ np.linalg.norm(stuck, axis=2).mean(axis=1)
    return {
        "divergence": np.abs(theta).max(),
        "normal jumps": across,
        "walls": np.abs(out[walls]).max(initial=0.0),
        "footing": np.abs(out[under] + speed).max(initial=0.0),
    }, power


def torsion(space, n, crossed=False):
    """A bar of 2 by 2 by 1, one end held along its section: torque k a^3/3 = 8/3, a = 2."""
    mesh = la.meshes.box((-1, 1), (-1, 1), (0, 1), 2 * n, 2 * n, n, crossed)
    return la.Problem(
        bodies={"bar": la.Body(mesh, CRITERION, kinematics="3d", space=space)},
        reference_loads=[la.Twist("bar", "top", (0, 0, 1))],
        supports=[la.Fix("bar", "bottom", axis) for axis in ("x", "y")],
    )
