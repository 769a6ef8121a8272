"""An independent check of a stated Coulomb limit state of rigid blocks (T12c).

It uses the outlines of the blocks, the places of the contact points and the stated (u, t, alpha),
and nothing of lacore: no loop, no backend, no certificate, no assembly.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Stated:
    """What is stated, block by block and contact point by contact point.

    outlines: (k, 2) vertices of each block, anticlockwise. fixed: blocks at rest, (B,).
    reference, dead: force (x, y) and moment about the centroid, (B, 3).
    slave, master: block numbers, (m,). place, normal: (m, 2), the normal from master into slave.
    mu: (m,). velocity: (u_x, u_y, omega) of the centroids, (B, 3).
    normal_force, tangential_force: on the slave, (m,); tangent is the normal turned by +90 degrees.
    """

    outlines: tuple
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


def centroid(outline):
    (x, y), (x1, y1) = outline.T, np.roll(outline, -1, axis=0).T
    cross = x * y1 - x1 * y
    return np.array([((x + x1) * cross).sum(), ((y + y1) * cross).sum()]) / (3 * cross.sum())


def residuals(s: Stated) -> dict[str, float]:
    """Largest violation of each condition, with global scales of force, velocity and length."""
    centre = np.array([centroid(outline) for outline in s.outlines])
    size = np.linalg.norm(np.ptp(np.concatenate(s.outlines), axis=0))
    tangent = np.stack([-s.normal[:, 1], s.normal[:, 0]], axis=1)
    force = s.normal_force[:, None] * s.normal + s.tangential_force[:, None] * tangent
    balance = s.load_factor * s.reference + s.dead
    jump = np.zeros_like(s.place)
    for block, sign in ((s.slave, 1), (s.master, -1)):
        arm = s.place - centre[block]
        moment = arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
        np.add.at(balance, block, sign * np.column_stack([force, moment]))
        turned = s.velocity[block, 2:] * np.stack([-arm[:, 1], arm[:, 0]], axis=1)
        jump += sign * (s.velocity[block, :2] + turned)
    opening, slip = np.sum(jump * s.normal, axis=1), np.sum(jump * tangent, axis=1)
    forces = np.abs(s.load_factor * s.reference[:, :2]).sum() + np.abs(s.dead[:, :2]).sum()
    speed = np.abs(s.velocity * [1, 1, size]).max()
    friction = s.mu * s.normal_force * np.abs(slip)
    dead_power, live = np.sum(s.dead * s.velocity), np.sum(s.reference * s.velocity)
    power = np.abs(friction).sum() + np.abs(dead_power)
    coulomb = friction + s.normal_force * opening + s.tangential_force * slip
    with np.errstate(invalid="ignore", divide="ignore"):  # 0/0 is NaN, and NaN is refused
        return {
            "equilibrium": np.abs((balance / [1, 1, size])[~s.fixed]).max() / forces,
            "tension": -s.normal_force.min() / forces,
            "cone": np.max(np.abs(s.tangential_force) - s.mu * s.normal_force) / forces,
            "penetration": -opening.min() / speed,
            "support": np.abs(s.velocity[s.fixed]).max(initial=0.0) / speed,
            "normalisation": np.abs(live - 1),
            "coulomb": np.abs(coulomb).sum() / power,
            "power": np.abs(s.load_factor * live + dead_power - friction.sum()) / power,
        }


def accepts(s: Stated, tolerance: float = 1e-6) -> bool:
    """Whether all residuals are within the tolerance; false for NaN."""
    return all(value <= tolerance for value in residuals(s).values())
