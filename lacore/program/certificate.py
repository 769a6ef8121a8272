"""Recomputed residuals of a limit state (T8, T15), which prove its load factor.

All residuals are computed from the program and the answer (velocity, stresses, reactions, load
factor). They never use what a solver reports about itself.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.program.kinematic import ContactRows, FrozenContact, KinematicProgram
from lacore.program.part_forces import forces_at_points, part_forces
from lacore.program.state import ProgramState, misfit, out_of_balance
from lacore.reporting.errors import InputError, typed
from lacore.reporting.showing import Facts, Shown


@dataclass(frozen=True, repr=False)
class Certificate(Shown):
    """Residuals, each >= 0 up to round-off and 0 for an exact Coulomb limit state.

    The penalties of a regularised state allow divergence, penetration, flow, slip and gap, which
    do not vanish; `lacore.coupling.run.Run.proven` lists the residuals that it must satisfy.

    Residuals of forces are relative to the forces on the same body or block, its loads and
    reactions (`lacore.program.part_forces`), so that a light block next to a heavy one is in
    balance as well. The other scales are global. They are the largest nodal velocity for
    velocities, the largest strain rate (or velocity over body length, if the mechanism is rigid)
    for strain rates, and the dissipated power ``D + sum (mu t_n + limit) ||u_t|| + |Fd.u|`` for
    powers, where dilatant friction counts with its dilatancy as mu.

    Attributes:
        equilibrium: Largest unbalanced nodal force, with the reported load factor and dead loads,
            relative to the total load or to the force of its part, whichever is larger.
        yield_violation: Largest ``||stress||/bound - 1``. If strength depends on pressure, excess
            over a surface relative to the sum of its terms at the point, or to their mean over the
            body if that is larger.
        cone: Largest ``||t_t|| - mu t_n - limit`` with the true t_n, and ``-t_n``, relative to the
            largest reaction, or to the total load over contact length if reactions vanish. The
            same as a force, relative to the smaller force of the two parts, if that is larger.
        penetration: Largest ``dilatancy ||u_t|| - u_n`` relative to the largest velocity. The same
            times the smaller force of the two parts, relative to the largest product of force and
            speed of a part, if that is larger. Slip of points that stick by law counts as well.
        divergence: Largest ``|theta|`` relative to the strain rate. If strength depends on
            pressure, power of stresses on ``(sin(phi) ||d|| - theta)_+`` (T38), per power, with the
            dilation angle if it differs from phi (T58).
        normalisation: ``|F0.u - 1|``.
        flow: Normality of stress and strain rate, ``sum w (bound ||D u|| - stress.D u)`` per
            power. It includes the power of mean stresses if strength depends on pressure. With
            non-associated flow, the bipotential replaces the dissipation (T50), and the residual is
            the share of friction that is not mobilised, averaged over the dissipation (T53).
        slip: Coulomb law as bipotential, ``sum w |b_c(-u, t) + u.t|`` (T3) per power.
        gap: Pair gap ``|D + sum b_c(-u, t) - Fd.u - alpha|`` per power (T15).
        load: First-order error of the load factor due to all other residuals, per power. From
            below, it is the power of unbalanced forces ``sum |r_i| |U_i|`` and of stresses and
            tractions beyond their strength; from above, the power of stresses and tractions on
            impossible flow and penetration. If soil moves a thousand times faster than the load,
            forces with an error of a millionth can cause a much larger error of the load factor.
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

    @classmethod
    def of(
        cls, program: KinematicProgram, state: ProgramState, contact: FrozenContact | None = None
    ) -> Certificate:
        """Compute the residuals of a state that fits the program; see `certify`."""
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
        # Dilatant friction dissipates nothing; the power of its reactions counts in its place.
        lifted = float(rows.weights @ (dilatancy * np.maximum(t_n, 0.0) * slip_rate))
        power_scale = _nonzero(dissipated + lifted + abs(dead_power))
        force_scale = _force_scale(program, state)
        velocity_scale = _nonzero(_largest(np.abs(u)))
        strain_scale = _strain_scale(program, u, velocity_scale)
        traction = np.hypot(t_n, np.linalg.norm(t_t, axis=1))
        reaction_scale = _most(
            _largest(traction), force_scale / _nonzero(float(rows.weights.sum()))
        )
        by_part = part_forces(program, state)
        at_points = forces_at_points(program, by_part)
        moving = _nonzero(_largest(by_part[program.part] * np.abs(u)))
        residual = np.abs(out_of_balance(program, state))
        pair_gap = dissipated - dead_power + float(rows.weights @ (t_n * shift)) - state.load_factor
        bipotential = friction + t_n * opening + np.sum(t_t * slip, axis=1)
        excess = np.where(finite, np.linalg.norm(t_t, axis=1) - cone_bound, 0.0)
        outside = np.maximum(excess, -t_n)
        inward = np.where(finite, dilatancy * slip_rate - opening, np.maximum(slip_rate, -opening))
        defects = plastic - works
        taken = [g.taken(u, p) for g, p in zip(program.groups, state.mean_stress, strict=True)]
        below, above = _load_errors(
            rows,
            float(residual @ np.abs(u)),
            defects,
            bipotential,
            pair_gap + sum(taken),
            traction,
            inward,
        )
        return cls(
            equilibrium=_most(
                _largest(residual) / force_scale, _largest(residual / by_part[program.part])
            ),
            yield_violation=_most(
                *(
                    _largest(group.beyond(stress, mean))
                    for group, stress, mean in zip(
                        program.groups, state.stress, state.mean_stress, strict=True
                    )
                )
            ),
            cone=_most(
                _largest(outside) / reaction_scale,
                # The tractions of a short joint can be much larger than those of all others.
                _largest(rows.weights * outside / at_points),
            ),
            penetration=_most(
                _largest(inward) / velocity_scale, _largest(inward * at_points) / moving
            ),
            divergence=_most(
                *(
                    _largest(g.impossible(u)) / strain_scale
                    for g in program.groups
                    if g.surfaces is None
                ),
                sum(
                    own
                    for g, own in zip(program.groups, taken, strict=True)
                    if g.surfaces is not None
                )
                / power_scale,
            ),
            normalisation=abs(float(program.reference_load @ u) - 1),
            flow=abs(float(defects.sum())) / power_scale,
            slip=float(rows.weights @ np.abs(bipotential)) / power_scale,
            gap=abs(pair_gap) / power_scale,
            load=_most(below, above) / power_scale,
        )

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
        """Return all residuals, with the largest one in the title."""
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
    """Compute the residuals of a state against the friction laws of the program.

    The friction bounds follow the reactions of the state.

    Args:
        program: Program in any units.
        state: State in the same units.
        contact: Frozen bounds and dilatancies that replace the friction laws, for the certificate
            of one inner solve.

    Raises:
        InputError: There is no state, or the state or the contact belongs to another program.
    """
    if fault := misfit(program, state):
        raise InputError("state", None, f"has {fault}", "give a state of this program")
    if contact is not None and contact.bound.shape != (program.contact.count,):
        points = f"of {contact.bound.size} points instead of {program.contact.count}"
        raise InputError("contact", None, points, "freeze that of this program")
    return Certificate.of(program, state, contact)


def _force_scale(program: KinematicProgram, state: ProgramState) -> float:
    """Return the sum of the sizes of all loads at the load factor of the state, or 1."""
    return _nonzero(
        abs(state.load_factor) * float(np.abs(program.reference_load).sum())
        + float(np.abs(program.dead_load).sum())
    )


def _strain_scale(program: KinematicProgram, velocity: Floats, velocity_scale: float) -> float:
    """Return the largest strain rate, or the largest velocity over the length of the bodies."""
    area = sum(float(group.weights.sum()) for group in program.groups)
    rates = (np.linalg.norm(g.cone_vectors(velocity), axis=1) for g in program.groups)
    return _most(velocity_scale / np.sqrt(_nonzero(area)), *map(_largest, rates))


def _load_errors(
    rows: ContactRows,
    unbalanced: float,
    defects: Floats,
    bipotential: Floats,
    gap: float,
    traction: Floats,
    inward: Floats,
) -> tuple[float, float]:
    """Return how far the load factor may be too high and too low, as powers.

    These are the terms of (T15) that residuals leave on each side, with the velocity and the
    stresses of the state in place of the optimal ones.

    Args:
        rows: Contact points.
        unbalanced: Power of the unbalanced forces.
        defects: Dissipation less the power of stresses, per cone.
        bipotential: Residual of the friction law, per contact point.
        gap: Pair gap, with the power of stresses on impossible flow.
        traction: Size of the tractions, per contact point.
        inward: Velocity of penetration, per contact point.
    """
    below = (
        unbalanced
        - float(np.minimum(defects, 0.0).sum())
        - float(rows.weights @ np.minimum(bipotential, 0.0))
    )
    above = gap + float(rows.weights @ (traction * np.maximum(inward, 0.0)))
    return below, above


def _plastic(program: KinematicProgram, state: ProgramState) -> tuple[Floats, Floats]:
    """Return the dissipation of all cones and the power of their stresses.

    The power of cones without a strain rate is zero.
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
    """Return the largest of the values and 0; NaN if one is (the built-in max may drop it)."""
    return _largest(np.array(values, dtype=float))


def _largest(values: Floats) -> float:
    """Return the largest value of an array and 0; NaN if one is."""
    return float(np.maximum(0.0, values.max())) if values.size else 0.0


def _nonzero(scale: float) -> float:
    """Return a scale, or 1 if it is not positive."""
    return 1.0 if scale <= 0 else scale
