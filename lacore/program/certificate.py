"""Recomputed residuals of a limit state (T8, T15): the number carries its own proof.

Everything here is computed from the program and the answer (velocity, stresses, reactions, load
factor), never from what a solver says of itself.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.program.part_forces import forces_at_points, part_forces
from lacore.program.state import ProgramState, misfit, out_of_balance
from lacore.reporting.errors import InputError, typed
from lacore.reporting.showing import Facts, Shown


@dataclass(frozen=True, repr=False)
class Certificate(Shown):
    """Residuals, each >= 0 up to round-off and 0 for an exact Coulomb limit state.

    Of a regularised state divergence, penetration, flow, slip and gap stay as large as its
    penalties let them; `lacore.coupling.run` says what it is judged by.

    Forces are judged by those of the body or block that they act on, its loads and reactions
    (`lacore.program.part_forces`): beside a heavy block a light one is not out of balance by
    little. Other scales are global: the largest nodal velocity for velocities, the largest strain
    rate (or velocity over body length, when the mechanism is rigid) for strain rates, the power
    turned over ``D + sum (mu t_n + limit) ||u_t|| + |Fd.u|`` for powers, where dilatant friction
    counts with its dilatancy as mu.

    Attributes:
        equilibrium: largest nodal force out of balance, with the reported load factor and dead
            loads, per total load; or per force of its part, where that is more.
        yield_violation: largest ``||stress||/bound - 1``; where strength depends on pressure, by
            how much a surface is exceeded, per sum of its own terms at the point, or their mean
            over the body where that is more.
        cone: largest ``||t_t|| - mu t_n - limit`` with the true t_n, and ``-t_n``, per largest
            reaction or, where reactions vanish, per total load over contact length; or as a force,
            per force of the lesser of the parts that touch, where that is more.
        penetration: largest ``dilatancy ||u_t|| - u_n``, per largest velocity; or its power against
            the force of the lesser of the parts that touch, per force times speed of the part with
            most of it, where that is more; slip of points that stick by law counts here.
        divergence: largest ``|theta|``, per strain rate; where strength depends on pressure the
            power of stresses on ``(sin(phi) ||d|| - theta)_+`` (T38), per power; with the dilation
            angle where flow has one of its own (T58).
        normalisation: ``|F0.u - 1|``.
        flow: normality of stress and strain rate, ``sum w (bound ||D u|| - stress.D u)`` per
            power; where strength depends on pressure with the power of mean stresses, and where
            flow is not associated with its bipotential for the dissipation (T50): the share of
            friction that is mobilised too little, on the average over the dissipation (T53).
        slip: Coulomb law as bipotential, ``sum w |b_c(-u, t) + u.t|`` (T3) per power.
        gap: pair gap ``|D + sum b_c(-u, t) - Fd.u - alpha|`` per power (T15).
        load: by how much the load factor may be off for what all others leave, to first order, per
            power: the power of forces out of balance ``sum |r_i| |U_i|`` and of stresses and
            tractions beyond their strength from below, that of stresses and tractions on flow and
            contact that are not possible from above. Where soil outruns its load a thousandfold,
            a millionth of the forces is no millionth of the load.
    """

    equilibrium: float
    yield_violation: float
    cone: float
    penetration: float
    divergence: float
    normalisation: float
    flow: float
    slip: float
    gap: float
    load: float

    @property
    def worst(self) -> tuple[str, float]:
        """Name and value of the largest residual; NaN counts as the largest."""
        residuals: dict[str, float] = asdict(self)
        name = max(residuals, key=lambda key: np.nan_to_num(residuals[key], nan=np.inf))
        return name, residuals[name]

    @property
    def summary(self) -> str:
        """``largest 1.2e-09 (gap)``."""
        name, size = self.worst
        return f"largest {size:.1e} ({name})"

    def facts(self) -> Facts:
        """All residuals, the largest first."""
        kinds = {
            "of forces": ("equilibrium", "yield_violation", "cone"),
            "of velocities": ("penetration", "divergence", "normalisation"),
            "of powers": ("flow", "slip", "gap", "load"),
        }
        told = {
            kind: ", ".join(f"{name} {getattr(self, name):.1e}" for name in names)
            for kind, names in kinds.items()
        }
        return Facts(f"Certificate: residuals, {self.summary}", told)

    def holds(self, tolerance: float) -> bool:
        """Whether every residual is within `tolerance`; false for NaN."""
        return all(value <= tolerance for value in asdict(self).values())


@typed(state="give the point of an answer; one without has a status that says why")
def certify(
    program: KinematicProgram, state: ProgramState, contact: FrozenContact | None = None
) -> Certificate:
    """Residuals of a state against the friction laws of the program, with the true reactions.

    Args:
        program: in any units.
        state: in the same units.
        contact: judge against these frozen bounds and dilatancies instead of the laws: the
            certificate of one inner solve.

    Raises:
        InputError: no state, one of another program, or contact of another one.
    """
    if fault := misfit(program, state):
        raise InputError("state", None, f"has {fault}", "give a state of this program")
    if contact is not None and contact.bound.shape != (program.contact.count,):
        points = f"of {contact.bound.size} points instead of {program.contact.count}"
        raise InputError("contact", None, points, "freeze that of this program")
    program, rows = program.at_state(state.velocity, state.mean_stress), program.contact
    t_n, t_t, u = state.normal_reaction, state.tangential_reaction, state.velocity
    opening, slip = rows.opening(u), rows.slip(u)
    slip_rate = np.linalg.norm(slip, axis=1)
    if contact is None:
        bound, dilatancy = rows.limit + rows.coefficient * np.maximum(t_n, 0.0), rows.dilatancy
        shift = rows.lead
    else:
        bound, dilatancy, shift = contact.bound, contact.dilatancy, contact.shift
    opening = opening + shift
    finite = np.isfinite(bound)
    friction = np.where(finite, bound, 0.0) * slip_rate
    cone_bound = bound + dilatancy * np.maximum(t_n, 0.0)

    plastic, works = _plastic(program, state)
    dissipated = float(plastic.sum()) + float(rows.weights @ friction)
    dead_power = float(program.dead_load @ u)
    by_shift = float(rows.weights @ (t_n * shift))
    # Dilatant friction dissipates nothing; what it lifts against counts in its place.
    lifted = float(rows.weights @ (dilatancy * np.maximum(t_n, 0.0) * slip_rate))
    power = _nonzero(dissipated + lifted + abs(dead_power))
    forces = _nonzero(
        abs(state.load_factor) * float(np.abs(program.reference_load).sum())
        + float(np.abs(program.dead_load).sum())
    )
    velocity = _nonzero(_largest(np.abs(u)))
    by_part = part_forces(program, state)
    at_points = forces_at_points(program, by_part)
    moving = _nonzero(_largest(by_part[program.part] * np.abs(u)))
    residual = np.abs(out_of_balance(program, state))
    pair_gap = dissipated - dead_power + by_shift - state.load_factor
    reaction = _most(
        _largest(np.hypot(t_n, np.linalg.norm(t_t, axis=1))),
        forces / _nonzero(float(rows.weights.sum())),
    )
    area = sum(float(group.weights.sum()) for group in program.groups)
    strain = _most(
        velocity / np.sqrt(_nonzero(area)),
        *(_largest(np.linalg.norm(group.cone_vectors(u), axis=1)) for group in program.groups),
    )
    bipotential = friction + t_n * opening + np.sum(t_t * slip, axis=1)
    excess = np.where(finite, np.linalg.norm(t_t, axis=1) - cone_bound, 0.0)
    inward = np.where(finite, dilatancy * slip_rate - opening, np.maximum(slip_rate, -opening))
    defects = plastic - works
    taken = [g.taken(u, p) for g, p in zip(program.groups, state.mean_stress, strict=True)]
    # T15 with what is left of each side: at an optimal velocity and at optimal stresses, whose
    # places those of the state take.
    below = (
        float(residual @ np.abs(u))
        - float(np.minimum(defects, 0.0).sum())
        - float(rows.weights @ np.minimum(bipotential, 0.0))
    )
    pushed = np.hypot(t_n, np.linalg.norm(t_t, axis=1))
    above = pair_gap + sum(taken) + float(rows.weights @ (pushed * np.maximum(inward, 0.0)))
    return Certificate(
        equilibrium=_most(_largest(residual) / forces, _largest(residual / by_part[program.part])),
        yield_violation=_most(
            *(
                _largest(group.beyond(stress, mean))
                for group, stress, mean in zip(
                    program.groups, state.stress, state.mean_stress, strict=True
                )
            )
        ),
        cone=_most(
            _largest(np.maximum(excess, -t_n)) / reaction,
            # A short joint carries tractions beside which those of all others look small.
            _largest(rows.weights * np.maximum(excess, -t_n) / at_points),
        ),
        penetration=_most(_largest(inward) / velocity, _largest(inward * at_points) / moving),
        divergence=_most(
            *(_largest(g.impossible(u)) / strain for g in program.groups if g.surfaces is None),
            sum(own for g, own in zip(program.groups, taken, strict=True) if g.surfaces is not None)
            / power,
        ),
        normalisation=abs(float(program.reference_load @ u) - 1),
        flow=abs(float(defects.sum())) / power,
        slip=float(rows.weights @ np.abs(bipotential)) / power,
        gap=abs(pair_gap) / power,
        load=_most(below, above) / power,
    )


def _plastic(program: KinematicProgram, state: ProgramState) -> tuple[Floats, Floats]:
    """Dissipation of all cones, one after the other, and the power of their stresses.

    The latter where they strain at all.
    """
    u = state.velocity
    dissipated, works = [np.zeros(0)], [np.zeros(0)]
    for group, stress, mean in zip(program.groups, state.stress, state.mean_stress, strict=True):
        rates = group.rates(u)
        volume = None if group.surfaces is None else group.volume_rates(u)
        dissipated.append(group.dissipated(rates, volume))
        work = np.sum(stress * group.cone_vectors(u), axis=1)
        work = group.weights * np.where(rates > 0, work, 0.0)
        if volume is not None:
            powers = group.volume_weights * (mean * volume)
            work = work + powers.reshape(-1, group.volumes).sum(axis=1)
        works.append(work)
    return np.concatenate(dissipated), np.concatenate(works)


def _most(*values: float) -> float:
    """Largest of values and 0; NaN where there is one (the built-in max may drop it)."""
    return _largest(np.array(values, dtype=float))


def _largest(values: Floats) -> float:
    """As `_most`, of an array."""
    return float(np.maximum(0.0, values.max())) if values.size else 0.0


def _nonzero(scale: float) -> float:
    return 1.0 if scale <= 0 else scale
