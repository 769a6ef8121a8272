"""Nodes that a solve has put where hinges form in members under loads along them.

They belong to the discretisation of a state, not to its problem: a stored state is worth nothing
without them, and so they are stored beside it.
"""

import io

import numpy as np

import lacore as la
from lacore.assembly.span_nodes import with_nodes
from lacore.limit.span_moments import span_excess
from lacore.model.bodies.any_body import of_kind
from lacore.numerics.arrays import Floats
from lacore.program.state import ProgramState
from lacore_verification.runs.outcome import Evidence

_NODES = "nodes_"
_BEYOND = 2e-6  # relative: certified states are beyond yield by 1e-6 at most between their nodes
_BEYOND_REGULARISED = 2e-3  # those by 1e-3


def nodes_of(state: la.LimitState) -> dict[str, Floats]:
    """Places (2, N) of the nodes of frames, by the name of an array."""
    frames = state.discretisation.frames.items()
    return {f"{_NODES}{name}": dofs.body.position for name, dofs in frames}


def as_solved(
    problem: la.Problem, discretisation: la.Discretisation, evidence: Evidence
) -> la.Discretisation:
    """The discretisation of a stored state.

    Args:
        problem: of its run.
        discretisation: of that, which is returned where the state has the same nodes.
        evidence: of the run.

    Raises:
        ValueError: nodes that are none of the problem's members.
    """
    if not discretisation.frames or not evidence.arrays:
        return discretisation
    stored, places = _stored(evidence.arrays), {}
    for name, frame in of_kind(problem.bodies, la.Frame).items():
        known = discretisation.frames[name].body.position
        own = np.asarray(stored.get(f"{_NODES}{name}", known), dtype=np.float64)
        if own.shape != known.shape or not np.array_equal(own, known):
            places[name] = own[:, len(frame.names) :]
    if not places:
        return discretisation
    made = la.discretise(with_nodes(problem, discretisation.problem, places))
    for name in places:
        if made.frames[name].body.position.shape != stored[f"{_NODES}{name}"].shape:
            raise ValueError(f"nodes of the frame {name!r} lie on no member")
    return made


def _stored(data: bytes) -> dict[str, Floats]:
    """Arrays of places; nothing in the data is run."""
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            return {key: archive[key] for key in archive.files if key.startswith(_NODES)}
    except Exception as error:  # zip, struct, key and value errors: the bytes are none of ours
        raise ValueError(f"no state: {error}") from error


def require_hinges(discretisation: la.Discretisation, point: ProgramState, exact: bool) -> None:
    """Raise `ValueError` where a state is beyond yield between its nodes."""
    beyond = span_excess(discretisation, point)
    if not beyond <= (_BEYOND if exact else _BEYOND_REGULARISED):
        raise ValueError(f"between its nodes a member is beyond yield by {beyond:.1e}")
