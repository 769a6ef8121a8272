"""An independent check of a stated Coulomb limit state of rigid blocks in space (T12c, T73).

It uses the corners and faces of the blocks, the places and normals of the contact points, forces
per volume and the stated (u, t, alpha), and nothing of lacore: no loop, no backend, no certificate,
no assembly, no joints. Volumes, centroids, levers and frames are its own.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Stated3D:
    """What is stated, block by block and contact point by contact point.

    corners: (k, 3) of each block; faces: corner numbers of each face of each block, anticlockwise
    from outside. fixed: blocks at rest, (B,). reference, dead: force per volume, (B, 3).
    slave, master: block numbers, (m,). place, normal: (m, 3), the normal from master into slave.
    mu: (m,). velocity: of the centroids, then rates of rotation, (B, 6).
    normal_force: (m,), tangential_force: (m, 3), on the slave. area: (m,), and the largest pressure
    on it, strength: (m,); infinite where nothing crushes.
    """

    corners: tuple
    faces: tuple
    fixed: np.ndarray
    reference: np.ndarray
    dead: np.ndarray
    slave: np.ndarray
    master: np.ndarray
    place: np.ndarray
    normal: np.ndarray
    mu: np.ndarray
    velocity: np.ndarray
    normal_force: np.ndarray
    tangential_force: np.ndarray
    load_factor: float
    area: np.ndarray
    strength: np.ndarray


def solid(corners, faces):
    """Volume and centroid, by tetrahedra over triangles of the faces and the first corner."""
    own = corners - corners[0]
    triangles = np.array(
        [own[[face[0], face[i], face[i + 1]]] for face in faces for i in range(1, len(face) - 1)]
    )
    parts = np.linalg.det(triangles) / 6
    volume = parts.sum()
    return volume, corners[0] + parts @ triangles.sum(axis=1) / 4 / volume


def off_faces(corners, faces, places, outward):
    """How far places (k, 3) are from the nearest face that looks along their normals (k, 3).

    And which one it is, and the areas of all faces.
    """
    least, nearest, areas = np.full(len(places), np.inf), np.zeros(len(places), dtype=int), []
    for number, face in enumerate(faces):
        ring = corners[list(face)]
        ahead = np.roll(ring, -1, axis=0) - ring
        area = np.cross(ring, np.roll(ring, -1, axis=0)).sum(axis=0)
        normal = area / np.linalg.norm(area)
        areas.append(np.linalg.norm(area) / 2)
        turned = np.linalg.norm(normal - outward, axis=1)
        arms = ring - places[:, None]
        height = arms[:, 0] @ normal
        share = np.clip(-np.sum(arms * ahead, axis=2) / np.sum(ahead**2, axis=1), 0, 1)
        rim = np.linalg.norm(arms + share[:, :, None] * ahead, axis=2).min(axis=1)
        arms = arms - height[:, None, None] * normal
        after = np.roll(arms, -1, axis=1)
        angles = np.arctan2(np.cross(arms, after) @ normal, np.sum(arms * after, axis=2))
        outside = np.where(np.abs(angles.sum(axis=1)) > np.pi, 0.0, rim)
        away = np.maximum(np.maximum(turned, np.abs(height)), outside)
        nearest = np.where(away < least, number, nearest)
        least = np.minimum(least, away)
    return least, nearest, np.array(areas)


def residuals(s: Stated3D) -> dict[str, float]:
    """Largest violation of each condition, with global scales of force, velocity and length."""
    solids = [solid(*own) for own in zip(s.corners, s.faces, strict=True)]
    volume, centre = np.array([v for v, _ in solids]), np.array([c for _, c in solids])
    size = np.linalg.norm(np.ptp(np.concatenate(s.corners), axis=0))
    force = s.normal_force[:, None] * s.normal + s.tangential_force
    reference, dead = volume[:, None] * s.reference, volume[:, None] * s.dead
    balance = np.hstack([s.load_factor * reference + dead, np.zeros_like(dead)])
    jump, off, covered = np.zeros_like(s.place), 0.0, 0.0
    crushes = np.isfinite(s.strength)
    for block, sign in ((s.slave, 1), (s.master, -1)):
        arm = s.place - centre[block]
        np.add.at(balance, block, sign * np.hstack([force, np.cross(arm, force)]))
        jump += sign * (s.velocity[block, :3] + np.cross(s.velocity[block, 3:], arm))
        for b in np.unique(block):
            own = block == b
            away, face, areas = off_faces(
                s.corners[b], s.faces[b], s.place[own], -sign * s.normal[own]
            )
            off = np.maximum(off, away.max())
            taken = np.bincount(face, np.where(crushes, s.area, 0.0)[own], areas.size)
            covered = np.maximum(covered, np.max(taken / areas - 1))
    opening = np.sum(jump * s.normal, axis=1)
    most = np.where(crushes, s.strength * s.area, np.inf)
    crushed = np.where(crushes, np.maximum(-opening, 0.0), 0.0)
    spent = np.where(crushes, most, 0.0) * crushed
    slip = jump - opening[:, None] * s.normal
    slipping = np.linalg.norm(slip, axis=1)
    forces = np.abs(s.load_factor * reference).sum() + np.abs(dead).sum()
    speed = np.abs(s.velocity * [1, 1, 1, size, size, size]).max()
    friction = s.mu * s.normal_force * slipping
    dead_power, live = np.sum(dead * s.velocity[:, :3]), np.sum(reference * s.velocity[:, :3])
    power = np.abs(friction).sum() + np.abs(dead_power) + spent.sum()
    coulomb = friction + np.sum(s.tangential_force * slip, axis=1)
    coulomb += s.normal_force * (opening + crushed)
    with np.errstate(invalid="ignore", divide="ignore"):  # 0/0 is NaN, and NaN is refused
        return {
            "geometry": off / size,
            "normals": np.abs(np.sum(s.normal**2, axis=1) - 1).max(),
            "in the plane": np.abs(np.sum(s.tangential_force * s.normal, axis=1)).max() / forces,
            "equilibrium": np.abs((balance / [1, 1, 1, size, size, size])[~s.fixed]).max() / forces,
            "tension": -s.normal_force.min() / forces,
            "cone": np.max(np.linalg.norm(s.tangential_force, axis=1) - s.mu * s.normal_force)
            / forces,
            "crushing": np.max(s.normal_force - most) / forces,
            "area": covered,
            "crushing at strength": np.sum(spent - s.normal_force * crushed) / power,
            "penetration": -(opening + crushed).min() / speed,
            "support": np.abs(s.velocity[s.fixed]).max(initial=0.0) / speed,
            "normalisation": np.abs(live - 1),
            "coulomb": np.abs(coulomb).sum() / power,
            "power": np.abs(s.load_factor * live + dead_power - friction.sum() - spent.sum())
            / power,
        }


def accepts(s: Stated3D, tolerance: float = 1e-6) -> bool:
    """Whether all residuals are within the tolerance; false for NaN."""
    return all(value <= tolerance for value in residuals(s).values())
