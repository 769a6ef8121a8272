"""Initial iterate: the velocity of an elastic body, without stress."""

import numpy as np

from lacore.numerics.arrays import Floats
from lacore_backends._embedding.arrays import Conic
from lacore_backends._embedding.cones import lengths
from lacore_backends._embedding.place import Step
from lacore_backends._embedding.system import System

_BULK = 1e6  # stiffness of rows that hold exactly, by that of their body
_AWAY = 1.1  # t by the length of the strain rate
_NO_STRAIN = 1e-5  # strain rate by row and speed: below that of one element in a body that is held


def start(conic: Conic, system: System) -> tuple[Step, float]:
    """Return an iterate inside all cones, and the power that its velocity dissipates.

    Without dead loads and contact, zero stress is in equilibrium, and the iterates stay near it.
    """
    typical = conic.typical
    costly = [one.cost / one.weights for one in conic.costly]
    free = [typical / np.sqrt(kind.rows.norms) for kind in conic.free]
    free += [typical / np.sqrt(one.rows.norms) for one in conic.planes]
    equal = _BULK * typical / np.sqrt(conic.equal.norms)
    velocity = system.elastic(costly, equal, free)
    work = float(conic.load @ velocity)
    velocity = velocity / work if work > 0 else velocity
    rates = [one.rows.at(velocity) for one in conic.costly]
    sizes = [lengths(rate) for rate in rates]
    power = sum(float(one.cost @ size) for one, size in zip(conic.costly, sizes, strict=True))
    power += float(np.abs(conic.dead) @ np.abs(velocity))
    power = max(power, _moving(conic)) or 1.0
    mu = power / (conic.degree + 1)
    strained = []
    for one, rate, size in zip(conic.costly, rates, sizes, strict=True):
        lead = _lead(np.maximum(one.cost, typical * 1e-6), one.rise, mu) + _AWAY * size
        strained.append(np.vstack([lead, rate]))
    slacks, pressures = [], []
    for kind in conic.free:
        x = kind.rows.at(velocity) + kind.offset
        r = np.zeros_like(x)
        r[0] = typical
        x[0] = np.maximum(x[0], _AWAY * lengths(x[1:])) + mu / typical
        slacks.append(x)
        pressures.append(r)
    flows, bounded = [], []
    for planes in conic.planes:
        zeta = planes.inside()
        rate = planes.rows.at(velocity)[: planes.sheared] / max(planes.normed, 1)
        lead = 2 * mu / planes.leads(planes.multipliers(1.0, zeta))
        lead[: planes.normed] += _AWAY * lengths(rate)
        flows += planes.cones(lead, rate[:, None])
        bounded.append(zeta)
    step = Step(
        conic,
        velocity,
        tuple(strained),
        tuple(np.zeros((one.rows.dim, one.rows.count)) for one in conic.costly),
        np.zeros(conic.equal.count),
        tuple(slacks),
        tuple(pressures),
        tuple(flows),
        tuple(bounded),
        0.0,
        1.0,
        mu,
    )
    return step, power


def unresisted(begin: Step) -> bool:
    """Return whether the elastic velocity moves a body without strain or resistance."""
    conic, velocity = begin.conic, begin.velocity
    fastest = float(np.abs(velocity).max(initial=0.0))
    rates = [np.abs(rows.at(velocity)) / np.sqrt(rows.norms) for rows in conic.kinds]
    return max(float(rate.max(initial=0.0)) for rate in rates) <= _NO_STRAIN * fastest


def _moving(conic: Conic) -> float:
    """Return the power that points would dissipate at the speed of the load.

    As many points as the square root of their number are assumed to resist. An elastic body that is
    free to move hardly strains. Its strain rates would put all cones on their edges before the load
    is known.
    """
    strengths = [one.cost for one in conic.costly] + [conic.typical] * (
        len(conic.free) + len(conic.planes)
    )
    pairs = zip(strengths, conic.kinds[:-1], strict=True)
    power = sum(float(np.sum(strength * np.sqrt(rows.norms))) for strength, rows in pairs)
    load = float(np.abs(conic.load).sum()) or 1.0
    return float(power / load / np.sqrt(max(conic.degree, 1)))


def _lead(cost: Floats, rise: Floats, mu: float) -> Floats:
    """Return the t with ``c t + h t^2 = 2 mu``."""
    return np.asarray(4 * mu / (cost + np.sqrt(cost**2 + 8 * mu * rise)))
