"""An answer in a few lines: the number, what it is worth, how it falls."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

import lacore as la
from lacore.bodies.any_body import of_kind
from lacore.conditions.loads import Load
from lacore.files.problem.statements import law as stated_law
from lacore.files.problem.wording import in_words_of_files
from lacore.materials.friction import Friction
from lacore.numerics.quantities import Units
from lacore.showing import counted, listed
from verification.problems.answers import Answer
from verification.problems.more import MORE

_LOADS = 4  # that are told; the rest is counted
_MOVES = 1e-6  # of the largest velocity: below it a thing is at rest
_TURNS = 1e-3  # of the largest velocity: below it a block slides
_MOST = 0.9  # of the power of a body: where it flows


def loads_told(problem: la.Problem, loads: Sequence[Load], units: Units) -> str:
    """Loads in a few words each, as many as are read."""
    frames = of_kind(problem.bodies, la.Frame)
    said = [units.rewritten(own.told, own.body in frames) for own in loads]
    more = f"; and {len(said) - _LOADS} more" if len(said) > _LOADS else ""
    return "; ".join(said[:_LOADS]) + more or "none"


def friction(law: Friction, units: Units) -> str:
    """A law of friction: ``friction 0.4``, ``smooth``."""
    said = stated_law(law)
    if isinstance(said, str):
        return said
    if not isinstance(said, dict):
        return f"friction {said:.4g}"
    strengths = {name: said.pop(name) for name in ("adhesion", "tension", "limit") if name in said}
    parts = [name if value is True else f"{name} {value:.4g}" for name, value in said.items()]
    return ", ".join([*parts, *(f"{n} {units.told(v, 'Pa')}" for n, v in strengths.items())])


def lines(answer: Answer, units: Units) -> dict[str, str]:
    """What to say of an answer, by name."""
    state = answer.state
    one = f"{state.load_factor:.6g}, {worth(state)}"
    between = "" if answer.bracket is None else answer.bracket.heading
    # A solve of one mesh may be far off what is proven: it is no number to begin with.
    told = {"bracket": between} if answer.bracketed else {"load factor": one}
    problem = state.discretisation.problem
    told["times"] = loads_told(problem, problem.reference_loads, units)
    if state.status is not la.Status.SOLVED:
        told["status"] = _in_words(state.status.said(state.message), units)
    elif note := state.status.added(state.message):
        told["note"] = _in_words(note, units)
    if answer.interval is not None:
        told["interval"] = f"{answer.interval} is what this mechanism carries"
    if answer.bracketed:
        told["one mesh"] = f"that of the file has {one}"
    elif between:
        told["bracket"] = between
    if answer.range is not None:
        told["range"] = answer.range.facts().title.partition(": ")[2]
    if answer.safety is not None:
        ends = answer.safety.facts().title.partition(": ")[2]
        told["safety"] = "; ".join(filter(None, (ends, answer.safety.note)))
    for name, found in answer.more.items():
        told[name] = units.rewritten(found) if isinstance(found, str) else _said(name, found, units)
    if state.point is not None:
        told["mechanism"] = mechanism(state, units)
    if answer.stability is not None:
        told["dead loads"] = str(answer.stability)
    if state.certificate is not None:
        told["residual"] = f"{state.certificate.summary}; {state.tolerance:g} is asked for"
    told["solved by"] = (
        f"{state.backend}, {state.coupling} coupling:"
        f" {counted(state.outer_iterations, 'solve')}, {answer.seconds:.3g} s in all"
    )
    told["size"] = state.discretisation.contents
    return told


def _in_words(message: str, units: Units) -> str:
    """A message of lacore in the words and the units of the file."""
    return units.rewritten(in_words_of_files(message))


def _said(name: str, found: Any, units: Units) -> str:
    own = MORE[name]
    return own.said(own.told(found, units))


def worth(state: la.LimitState) -> str:
    """What a load factor proves."""
    deforms = bool(state.discretisation.bodies)
    if deforms and state.rigor is la.Rigor.DISCRETE and state.status is la.Status.SOLVED:
        return "an estimate: certified on this mesh, no bound"
    return state.discretisation.worth(state.rigor).partition(":")[0]


def mechanism(state: la.LimitState, units: Units) -> str:
    """What moves, flows, slips and turns."""
    said = [*_flowing(state, units), *_moving(state), *_turning(state, units)]
    said += [units.rewritten(own) for own in _slipping(state)]
    return "; ".join(said) or "nothing moves"


def _flowing(state: la.LimitState, units: Units) -> Iterator[str]:
    for name, power in state.dissipation.items():
        dofs = state.discretisation.bodies[name]
        shares = power * dofs.volumes
        if not shares.sum() > 0:
            own = float(np.abs(state.velocity[name]).max(initial=0.0))
            yield (
                f"{name} moves as it is" if own > _MOVES * _fastest(state) else f"{name} is at rest"
            )
            continue
        order = np.argsort(-shares)
        few = order[: int(np.searchsorted(np.cumsum(shares[order]), _MOST * shares.sum())) + 1]
        area = dofs.volumes[few].sum() / dofs.volumes.sum()
        x, y = (dofs.body.mesh.p[:, dofs.body.mesh.t[:, order[0]]].mean(axis=1)).tolist()
        yield (
            f"{name} flows: {_MOST:.0%} of its power in {area:.0%} of it,"
            f" most at {units.place(x, y)}"
        )


def _fastest(state: la.LimitState) -> float:
    """The largest velocity of all bodies."""
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
            yield f"{name} {'turns' if turns else 'slides'}"
            continue
        yield (
            f"{int(moves.sum())} of {counted(size.size, 'block')} of {name} move, {turns} of them"
            " turn"
        )


def _turning(state: la.LimitState, units: Units) -> Iterator[str]:
    table = state.hinges
    if not len(table):
        return
    turned = table[table["state"] == "turns"]
    places = dict.fromkeys(units.place(x, y) for x, y in zip(turned["x"], turned["y"], strict=True))
    yield f"hinges turn at {listed(list(places))}" if places else "no hinge turns"


def _slipping(state: la.LimitState) -> Iterator[str]:
    table = state.reactions
    # Joints of an assembly are told together: there may be hundreds.
    where = table["interface"].map(lambda name: _joints(str(name)))
    for name, own in table.groupby(where, sort=False):
        count = own["state"].value_counts()
        found = [f"{count[kind]} {kind}" for kind in ("slip", "open", "stick") if kind in count]
        yield f"of {counted(len(own), 'point')} of {name} {', '.join(found)}"


def _joints(interface: str) -> str:
    body, between, _ = interface.partition(": ")
    return f"joints of {body}" if between else interface
