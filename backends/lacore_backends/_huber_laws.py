"""Laws of pressure-independent strength (T17, T18) as symbols of CasADi. Not a backend.

They give values, forces and stiffnesses of one point, to be mapped over all points.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca


@dataclass(frozen=True)
class Law:
    """Law of a point.

    Attributes:
        energy: function of (local velocities, constants, parameters), each a list of numbers or of
            rows over all points. IPOPT evaluates the value alone five times as often as the rest,
            and rows are summed five times as fast as points.
        derivatives: force and stiffness of one point, as functions to be mapped.
    """

    energy: Callable[[list[Any], list[Any], list[Any]], Any]
    derivatives: tuple[Any, Any]


def _derivatives(inputs: list[Any], force: Any, stiffness: Any) -> tuple[Any, Any]:
    return ca.Function("force", inputs, [force]), ca.Function(
        "stiffness", inputs, [ca.densify(stiffness)]
    )


def plastic_law(dim: int, share: float) -> Law:
    """Return the law T17 at a strain point.

    Local (cone rows, theta), constants (weight, bound, modulus).

    It is a Huber function plus, with hardening, a spring.

    Parameters: eta, K_c, and the share kept of the rank-one term of the Hessian.
    """

    def energy(local: list[Any], constants: list[Any], p: list[Any]) -> Any:
        (weight, bound, modulus), (eta, bulk, _) = constants, p
        theta = local[-1]
        square = sum(v**2 for v in local[:-1]) + (share * theta) ** 2
        limit, kept = bound / eta, eta / (eta + modulus)
        elastic, length = ca.fmin(square, limit**2), ca.sqrt(ca.fmax(square, limit**2))
        huber = eta * elastic / 2 + bound * (length - limit)
        return weight * (kept * (huber + modulus * square / 2) + bulk * theta**2 / 2)

    local, constants, p = ca.SX.sym("v", dim + 1), ca.SX.sym("c", 3), ca.SX.sym("p", 3)
    weight, bound, modulus, eta, bulk, damping = *ca.vertsplit(constants), *ca.vertsplit(p)
    kept = eta / (eta + modulus)
    scale = ca.DM.ones(dim + 1)
    scale[dim] = share
    e = scale * local
    limit = bound / eta
    length = ca.sqrt(ca.fmax(ca.dot(e, e), limit**2))
    flowing = length > limit
    secant, spring = kept * bound / length, kept * modulus
    force = (secant + spring) * scale * e
    force[dim] += bulk * local[dim]
    direction = scale * e / length
    stiffness = secant * (ca.diag(scale**2) - damping * flowing * ca.mtimes(direction, direction.T))
    stiffness += spring * ca.diag(scale**2)
    stiffness[dim, dim] += bulk
    return Law(energy, _derivatives([local, constants, p], weight * force, weight * stiffness))


def contact_law(tangent_dim: int) -> Law:
    """Return the law T18 at a contact point: local (u_n, u_t), constants (weight, dilatancy).

    Parameters: K_n, K_t, friction bound, shift.
    """

    def energy(local: list[Any], constants: list[Any], p: list[Any]) -> Any:
        (weight, dilatancy), (normal, tangential, bound, shift) = constants, p
        opening, square = local[0] + shift, sum(v**2 for v in local[1:])
        pressed = ca.fmax(-opening, 0)
        limit = bound / tangential
        tiny = 1e-150  # It keeps the derivatives of the square roots finite at rest.
        rate = ca.sqrt(ca.fmax(square, limit**2 + tiny))
        elastic = ca.fmin(square, limit**2)
        rubbed = tangential * elastic / 2 + bound * (rate - limit)

        speed = ca.sqrt(square + tiny)
        sliding = tangential * speed > dilatancy * normal * pressed
        pushed = ca.fmax(dilatancy * speed - opening, 0)
        compliance = 1 / normal + dilatancy**2 / tangential
        dilatant = ca.if_else(
            sliding,
            pushed**2 / (2 * compliance),
            normal * pressed**2 / 2 + tangential * square / 2,
        )
        plain = normal * pressed**2 / 2
        return weight * (ca.if_else(dilatancy > 0, dilatant, plain) + rubbed)

    local, constants, p = ca.SX.sym("v", 1 + tangent_dim), ca.SX.sym("c", 2), ca.SX.sym("p", 4)
    value = energy(*(ca.vertsplit(part) for part in (local, constants, p)))
    stiffness, force = ca.hessian(value, local)
    return Law(energy, _derivatives([local, constants, p], force, stiffness))
