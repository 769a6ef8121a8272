"""Assess one answer of a backend by analytical values, and by recomputed residuals.

Of the solver's own reports, only the status is used. Allowed errors:

- Exact backends state their accuracy as the default of ``Options.tolerance``, relative on gap and
  feasibility. The error of the value is at most that times ``1 + |alpha|`` and the sums of all
  velocities and of all nodal forces, about 50 in these programs; a factor of 2 allows for scaling
  by solvers. The limit is therefore 100 tolerances, but at least `EXACT`, which interior-point and
  simplex methods must reach for any stated tolerance.
- Regularised backends must reach `REGULARISED`, the tolerance of the reaction loop, for their own
  energy: at a velocity where its gradient is ``lambda F0`` a convex energy has its minimum, to the
  square of that.
- A point is found less accurately than its value if the minimum is smooth: to the root of it. The
  same applies to the load factor within a step of a path, which is a slope.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.program.certificate import certify
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.program.regularization import Penalties, RegularisedValues, evaluate, penalties
from lacore.program.state import ProgramState
from lacore.reporting.status import Status
from lacore.solvers.backend import Backend, InnerSolution, checked_answer
from lacore_verification.conformance.worked import Worked

PASS, FAIL, SKIPPED = "pass", "FAIL", "skipped"
EXACT = 1e-7
REGULARISED = 1e-6
R = 1e-2  # one r for all regularised backends, so that their values can be compared
AMPLIFIED = 100
_DONE = (Status.SOLVED, Status.ALMOST_SOLVED)  # residuals decide whether "almost" is sufficient


@dataclass(frozen=True)
class Finding:
    """One check of one program.

    Attributes:
        program, check: names of the program and the check.
        value: the error; NaN without a number.
        allowed: the largest error that passes.
        verdict: ``pass``, ``FAIL`` or ``skipped``.
        message: expected and actual result, or why it was skipped.
    """

    program: str
    check: str
    value: float
    allowed: float
    verdict: str
    message: str = ""


@dataclass(frozen=True)
class Subject:
    """Backend under examination, with its allowed errors."""

    backend: Backend
    options: dict[str, Any]

    @property
    def regularised(self) -> bool:
        """Whether it solves the regularised program."""
        return self.backend.capabilities.regularised

    @property
    def allowed(self) -> float:
        """Largest error of a value, relative."""
        if self.regularised:
            return REGULARISED
        stated = self.options.get("tolerance", getattr(self.backend.Options(), "tolerance", 0.0))
        return max(EXACT, AMPLIFIED * float(stated))


def said(program: str, check: str, holds: bool, message: str) -> Finding:
    """Return a finding without a number."""
    nan = float("nan")
    return Finding(program, check, nan, nan, PASS if holds else FAIL, "" if holds else message)


def measured(program: str, check: str, value: float, allowed: float, message: str) -> Finding:
    """Return a finding with a number; NaN fails."""
    holds = bool(value <= allowed)
    text = "" if holds else f"{message}: {value:.2g} off, {allowed:.2g} allowed"
    return Finding(program, check, value, allowed, PASS if holds else FAIL, text)


def judge(subject: Subject, worked: Worked, raw: object) -> Iterator[Finding]:
    """Yield all findings on the answer to one program."""
    program, name = worked.program, worked.name
    answer = checked_answer(program, subject.regularised, raw)
    wanted = worked.status
    if wanted not in _DONE and not subject.backend.capabilities.infeasibility:
        why = f"{wanted.label} is not expected of a backend that looks for no such proof"
        yield Finding(name, "status", np.nan, np.nan, SKIPPED, why)
        return
    agreed = answer.status is wanted or (wanted in _DONE and answer.status in _DONE)
    came = " ".join(
        filter(None, (answer.status.label, f"({answer.native_status})", answer.message))
    )
    yield said(name, "status", agreed, f"{wanted.label} was expected, {came} came")
    if not agreed:
        return
    point = answer.point
    if wanted not in _DONE or point is None:
        yield said(name, "no number", point is None, f"a point came with {answer.status.label}")
        return
    if subject.regularised:
        yield from _regularised(worked, answer, point)
    else:
        yield from _exact(subject, worked, point)


def _exact(subject: Subject, worked: Worked, point: ProgramState) -> Iterator[Finding]:
    if worked.load_factor is not None:
        round_minimum = float(np.sqrt(subject.allowed))
        slope = subject.allowed if worked.program.homogeneous else round_minimum
        yield _load_factor(worked, point.load_factor, slope)
        yield from _point(worked, point, round_minimum)
    yield residuals(worked.name, worked.program, worked.contact, point, subject.allowed)


def _load_factor(worked: Worked, value: float, allowed: float) -> Finding:
    assert worked.load_factor is not None
    error = abs(value - worked.load_factor) / abs(worked.load_factor)
    text = f"load factor {worked.load_factor:.9g} was expected, {value:.9g} came"
    return measured(worked.name, "load factor", error, allowed, text)


def _point(
    worked: Worked, point: ProgramState, allowed: float, velocity: bool = True
) -> Iterator[Finding]:
    """Yield findings on all unique results, component by component, by the largest."""
    pairs: list[tuple[str, Any, Any]] = [
        ("velocity", worked.velocity if velocity else None, point.velocity),
        ("normal reaction", worked.normal_reaction, point.normal_reaction),
        ("tangential reaction", worked.tangential_reaction, point.tangential_reaction),
    ]
    for kind, known, found in (
        ("stress", worked.stress, point.stress),
        ("mean stress", worked.mean_stress, point.mean_stress),
    ):
        for group, one, other in zip(worked.program.groups, known or (), found, strict=False):
            pairs.append((f"{kind} of {group.name}", one, other))
    for check, one, other in pairs:
        if one is None:
            continue
        expected, found_values = np.asarray(one, dtype=float), np.asarray(other)
        scale = float(np.abs(expected).max(initial=0.0)) or 1.0
        error = float(np.abs(found_values - expected).max(initial=0.0)) / scale
        text = f"{check} {_shown(expected)} was expected, {_shown(found_values)} came"
        yield measured(worked.name, check, error, allowed, text)


def _shown(values: Floats) -> str:
    return np.array2string(values.ravel(), precision=6, threshold=8, separator=", ")


def residuals(
    name: str,
    program: KinematicProgram,
    contact: FrozenContact,
    point: ProgramState,
    allowed: float,
) -> Finding:
    """Return the largest recomputed residual."""
    worst, value = certify(program, point, contact).worst
    return measured(name, "residuals", value, allowed, f"the residual {worst!r} is too large")


def _regularised(worked: Worked, answer: InnerSolution, point: ProgramState) -> Iterator[Finding]:
    """Yield findings on its velocity, the minimum of the energy at this r, and its numbers."""
    program, contact, name = worked.program, worked.contact, worked.name
    penalty = penalties(program.scales, R)
    at = evaluate(program, contact, penalty, point.velocity)
    values = answer.regularised
    assert values is not None  # guaranteed by `checked_answer`

    normalisation = abs(float(program.reference_load @ point.velocity) - 1)
    yield measured(name, "F0.U = 1", normalisation, REGULARISED, "the velocity is not normalised")
    multiplier = float(at.gradient @ point.velocity)
    forces = abs(multiplier) * float(np.abs(program.reference_load).sum())
    forces += float(np.abs(program.dead_load).sum())
    gradient = at.gradient - multiplier * program.reference_load
    yield measured(
        name,
        "minimum",
        float(np.abs(gradient).max()) / forces,
        REGULARISED,
        f"the gradient of the regularised energy at r = {R:g} is not lambda F0",
    )
    dissipated = at.values.plastic + float(program.dead_load @ point.velocity)
    scale = max(abs(multiplier), dissipated)
    for check, expected, found in (
        ("lambda", multiplier, values.load_factor),
        ("alpha_reg", at.values.alpha_reg, values.alpha_reg),
        ("P", at.values.plastic, values.plastic),
        ("load factor of the point", multiplier, point.load_factor),
        ("multiplier", multiplier, values.multiplier),
    ):
        if check == "multiplier" and np.isnan(found):
            continue  # It reports none.
        text = f"{check} {expected:.9g} was expected of its velocity, {found:.9g} came"
        yield measured(name, check, abs(found - expected) / scale, REGULARISED, text)
    yield measured(
        name,
        "stresses and reactions",
        _apart(program, at.state, point) / forces,
        REGULARISED,
        "the stresses or reactions are not those of the velocity",
    )
    if worked.load_factor is not None:
        yield from _by_hand(worked, point, values, at.objective, penalty, scale)


def _apart(program: KinematicProgram, one: ProgramState, other: ProgramState) -> float:
    """Return the largest nodal force of the differences of stresses and reactions, in sum."""
    apart = np.zeros(program.n)
    for number, group in enumerate(program.groups):
        stress = np.abs(one.stress[number] - other.stress[number])
        mean = np.abs(one.mean_stress[number] - other.mean_stress[number])
        apart += abs(group.rows).T @ (group.weights[:, None] * stress).ravel()
        apart += abs(group.volumetric).T @ (group.volume_weights * mean)
    rows = program.contact
    normal = np.abs(one.normal_reaction - other.normal_reaction)
    tangential = np.abs(one.tangential_reaction - other.tangential_reaction)
    apart += abs(rows.normal).T @ (rows.weights * normal)
    apart += abs(rows.tangential).T @ (rows.weights[:, None] * tangential).ravel()
    return float(apart.max(initial=0.0))


def _by_hand(
    worked: Worked,
    point: ProgramState,
    values: RegularisedValues,
    objective: float,
    penalty: Penalties,
    scale: float,
) -> Iterator[Finding]:
    """Yield findings on P <= alpha_reg <= lambda <= alpha*, and analytical values from equilibrium.

    Within a step of a path alpha* is not a bound (T19). The minimised `objective` at its velocity
    has bounds by weak duality, because the exact stresses are admissible here, too.
    """
    assert worked.load_factor is not None
    contact = worked.contact
    exact = worked.load_factor
    shifted = 0.0
    if worked.normal_reaction is not None:
        reaction = np.asarray(worked.normal_reaction, dtype=float)
        shifted = float(worked.program.contact.weights @ (contact.shift * reaction))
    plastic, alpha_reg, load_factor = values.plastic, values.alpha_reg, values.load_factor
    chain = [plastic, alpha_reg, load_factor, *([exact] if worked.program.homogeneous else [])]
    drop = float(np.max(-np.diff(chain)))  # NaN is kept
    came = ", ".join(f"{value:.9g}" for value in chain)
    text = f"P <= alpha_reg <= lambda <= alpha* (T19) came as {came}"
    yield measured(worked.name, "order of T19", max(drop, 0.0) / scale, REGULARISED, text)
    if worked.softened is not None:
        softened = worked.softened(penalty)
        text = f"lambda recomputed: {softened:.9g} was expected, {load_factor:.9g} came"
        error = abs(load_factor - softened) / scale
        yield measured(worked.name, "lambda recomputed", error, REGULARISED, text)
    energy = _complementary_energy(worked, penalty)
    if not worked.isostatic:
        if energy is not None:
            most = exact - shifted - _hardening_power(worked)
            text = f"{objective:.9g} is not within {energy:.2g}, the energy of the exact stresses,"
            text += f" below the exact least cost {most:.9g}"
            outside = max(most - energy - objective, objective - most, 0.0) / scale
            yield measured(worked.name, "least cost", outside, REGULARISED, text)
        return
    yield _load_factor(worked, load_factor, REGULARISED)
    yield from _point(worked, point, float(np.sqrt(REGULARISED)), velocity=False)
    if energy is not None:
        for check, found, expected in (
            ("P recomputed", plastic, exact - shifted - 2 * energy),
            ("alpha_reg recomputed", alpha_reg, exact - shifted - energy),
        ):
            text = f"{check}: {expected:.9g} was expected, {found:.9g} came"
            yield measured(worked.name, check, abs(found - expected) / scale, REGULARISED, text)


def _hardening_power(worked: Worked) -> float:
    """Return ``sum w h ||D U||^2/2`` at the exact velocity, the excess of alpha* over the cost."""
    if worked.velocity is None or not worked.program.hardens:
        return 0.0
    velocity = np.asarray(worked.velocity, dtype=float)
    return sum(
        float((g.weights * g.rise) @ np.sum(g.cone_vectors(velocity) ** 2, axis=1)) / 2
        for g in worked.program.groups
    )


def _complementary_energy(worked: Worked, penalty: Penalties) -> float | None:
    """Return C at the exact stresses and reactions; None if they are not all known."""
    program, energy = worked.program, 0.0
    for number, group in enumerate(program.groups):
        if not group.weights.size:
            continue
        stress = worked.stress and worked.stress[number]
        mean = worked.mean_stress and worked.mean_stress[number]
        if stress is None or (mean is None and group.volumetric.nnz):
            return None
        energy += float(group.weights @ np.sum(np.square(stress), axis=1)) / (2 * penalty.eta)
        if mean is not None:
            energy += float(group.volume_weights @ np.square(mean)) / (2 * penalty.bulk)
    if not program.contact.count:
        return energy
    if worked.normal_reaction is None or worked.tangential_reaction is None:
        return None
    weights = program.contact.weights
    energy += float(weights @ np.square(worked.normal_reaction)) / (2 * penalty.normal)
    rubbed = np.linalg.norm(worked.tangential_reaction, axis=1)
    # A dilatant law has a separate bound: both carry their shares.
    bound, dilatancy = worked.contact.bound, worked.contact.dilatancy
    beside = np.where(np.isfinite(bound) & (dilatancy > 0), np.minimum(bound, rubbed), 0.0)
    squares = (rubbed - beside) ** 2 + beside**2
    return energy + float(weights @ squares) / (2 * penalty.tangential)
