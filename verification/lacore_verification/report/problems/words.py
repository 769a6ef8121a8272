"""The result of `lacore solve` in a few lines: load factor, proof and collapse mechanism."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

import lacore as la
from lacore.files.problem.statements import law as stated_law
from lacore.model.bodies.any_body import of_kind
from lacore.model.conditions.loads import Load
from lacore.model.materials.friction import Friction
from lacore.reporting.showing import counted, listed
from lacore.reporting.status import Claim
from lacore.reporting.text import Reader, render
from lacore.reporting.units import Units
from lacore_verification.report.problems.answers import ProblemResults
from lacore_verification.report.problems.more import ANALYSES
from lacore_verification.report.problems.tables import interface_names

_LOADS = 4  # number of loads that are described; others are counted
_MOVES = 1e-6  # by the largest velocity: a slower part is at rest
_TURNS = 1e-3  # by the largest velocity: a block that rotates more slowly slides
_MOST = 0.9  # share of the dissipation of a body, whose area is given


def loads_told(problem: la.Problem, loads: Sequence[Load], units: Units) -> str:
    """Describe loads briefly: the first ones, and the number of the others."""
    frames = of_kind(problem.bodies, la.Frame)
    said = [render(own.told, Reader(units, True, own.body in frames)) for own in loads]
    more = f"; and {len(said) - _LOADS} more" if len(said) > _LOADS else ""
    return "; ".join(said[:_LOADS]) + more or "none"


def friction(law: Friction, units: Units) -> str:
    """Describe a law of friction: ``friction 0.4``, ``smooth``."""
    said = stated_law(law, "friction")
    if isinstance(said, str):
        return said
    if not isinstance(said, dict):
        return f"friction {said:.4g}"
    strengths = {name: said.pop(name) for name in ("adhesion", "tension", "limit") if name in said}
    parts = [name if value is True else f"{name} {value:.4g}" for name, value in said.items()]
    return ", ".join([*parts, *(f"{n} {units.told(v, 'Pa')}" for n, v in strengths.items())])


def lines(answer: ProblemResults, units: Units) -> dict[str, str]:
    """Return the lines that describe a result, by name."""
    state, reader = answer.state, Reader(units, files=True)
    one = f"{state.load_factor:.6g}, {claim(state)}"
    # The solve on one mesh may lie outside of the bounds, so they come first.
    proven = answer.bracket
    told = {"load factor": one} if proven is None else {"bracket": proven.heading}
    problem = state.discretisation.problem
    told["reference loads"] = loads_told(problem, problem.reference_loads, units)
    if state.status is not la.Status.SOLVED:
        told["status"] = answer.report.text_for(reader)
    elif note := answer.report.notes_for(reader):
        told["note"] = note
    if proven is not None:
        told["on one mesh"] = f"{one} (mesh of the file)"
    for name, found in answer.results.items():
        told.setdefault(name.replace("_", " "), said_of(name, found, units))
    if state.point is not None:
        told["mechanism"] = mechanism(state, units)
    if state.certificate is not None:
        told["residual"] = f"{state.certificate.summary}; the tolerance is {state.tolerance:g}"
    loop = f", {state.coupling} coupling loop" if state.outer_iterations > 1 else ""
    told["solver"] = (
        f"{state.backend}{loop}, {counted(state.outer_iterations, 'solve')},"
        f" {answer.seconds:.3g} s in total"
    )
    told["size"] = state.discretisation.contents
    return told


def said_of(name: str, found: Any, units: Units) -> str:
    """Return the result of an analysis in one line, or why there is none."""
    if isinstance(found, str):
        return render(found, Reader(units, files=True))
    own = ANALYSES[name]
    return own.said(own.told(found, units), units)


def claim(state: la.LimitState) -> Claim:
    """Return what a load factor proves."""
    deforms = bool(state.discretisation.continua)
    if deforms and state.rigor is la.Rigor.DISCRETE and state.status is la.Status.SOLVED:
        role = f", {state.carried.role.label}" if state.carried else ""
        return Claim(f"estimate{role}", "certified on this mesh, but not a bound")
    return state.claim


def mechanism(state: la.LimitState, units: Units) -> str:
    """Describe the collapse mechanism: what moves, deforms, slips and rotates."""
    said = [*_flowing(state, units), *_moving(state), *_turning(state, units)]
    said += _slipping(state, units)
    return "; ".join(said) or "nothing moves"


def _flowing(state: la.LimitState, units: Units) -> Iterator[str]:
    for name, power in state.dissipation.items():
        dofs = state.discretisation.continua[name]
        shares = power * dofs.volumes
        if not shares.sum() > 0:
            own = float(np.abs(state.velocity[name]).max(initial=0.0))
            yield (
                f"{name} moves without dissipation"
                if own > _MOVES * _fastest(state)
                else f"{name} is at rest"
            )
            continue
        order = np.argsort(-shares)
        few = order[: int(np.searchsorted(np.cumsum(shares[order]), _MOST * shares.sum())) + 1]
        area = dofs.volumes[few].sum() / dofs.volumes.sum()
        x, y = (dofs.body.mesh.p[:, dofs.body.mesh.t[:, order[0]]].mean(axis=1)).tolist()
        yield (
            f"{name} deforms: {100 * _MOST:.0f} % of the dissipation in {100 * area:.0f} % of the"
            f" {'volume' if dofs.body.axisymmetric else 'area'}, largest at {units.place(x, y)}"
        )


def _fastest(state: la.LimitState) -> float:
    """Return the largest velocity of all bodies."""
    return max(float(np.abs(own).max(initial=0.0)) for own in state.velocity.values())


def _moving(state: la.LimitState) -> Iterator[str]:
    for name, dofs in state.discretisation.assemblies.items():
        motion = state.velocity[name]
        turn = np.abs(motion[2]) * dofs.body.radius
        size = np.hypot(motion[0], motion[1]) + turn
        moves = size > _MOVES * _fastest(state)
        if not moves.any():
            yield f"{name} is at rest"
            continue
        turns = int(np.count_nonzero(turn > _TURNS * size.max()))
        if size.size == 1:
            yield f"{name} {'rotates' if turns else 'slides'}"
            continue
        yield (
            f"{int(moves.sum())} of {counted(size.size, 'block')} of {name} move, and {turns} of"
            " these rotate"
        )


def _turning(state: la.LimitState, units: Units) -> Iterator[str]:
    table = state.hinges
    if not len(table):
        return
    turned = table[table["state"] == "turns"]
    places = dict.fromkeys(units.place(x, y) for x, y in zip(turned["x"], turned["y"], strict=True))
    yield f"plastic hinges at {listed(list(places))}" if places else "no plastic hinge rotates"


def _slipping(state: la.LimitState, units: Units) -> Iterator[str]:
    table, named = state.reactions, interface_names(state.discretisation.problem, units)
    # Joints of an assembly are counted together, because there may be hundreds.
    where = table["interface"].map(lambda name: _joints(str(name)))
    for name, own in table.groupby(where, sort=False):
        count = own["state"].value_counts()
        found = [f"{count[kind]} {kind}" for kind in ("slip", "open", "stick") if kind in count]
        told = named.get(str(name), name)
        yield f"{counted(len(own), 'contact point')} of {told}: {', '.join(found)}"


def _joints(interface: str) -> str:
    body, between, _ = interface.partition(": ")
    return f"joints of {body}" if between else interface
