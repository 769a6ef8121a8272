"""Nodes that a solve has added where hinges form in members under distributed loads.

They belong to the discretisation of a state, not to its problem: a stored state cannot be used
without them, so they are stored with it.
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
# Relative: certified states exceed the yield condition by 1e-6 at most between nodes.
_BEYOND = 2e-6
_BEYOND_REGULARISED = 2e-3  # Regularised states exceed it by 1e-3.


def nodes_of(state: la.LimitState) -> dict[str, Floats]:
    """Return places (2, N) of the nodes of frames, by the name of an array."""
    frames = state.discretisation.frames.items()
    return {f"{_NODES}{name}": dofs.body.position for name, dofs in frames}


def as_solved(
    problem: la.Problem, discretisation: la.Discretisation, evidence: Evidence
) -> la.Discretisation:
    """Return the discretisation of a stored state.

    Args:
        problem: of its run.
        discretisation: of that, which is returned if the state has the same nodes.
        evidence: of the run.

    Raises:
        ValueError: a node is not on a member of the problem.
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
    """Return arrays of places; nothing in the data is executed."""
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            return {key: archive[key] for key in archive.files if key.startswith(_NODES)}
    # zip, struct, key and value errors mean that the bytes have another format.
    except Exception as error:
        raise ValueError(f"no state: {error}") from error


def require_hinges(discretisation: la.Discretisation, point: ProgramState, exact: bool) -> None:
    """Raise `ValueError` where a state exceeds the yield condition between its nodes."""
    beyond = span_excess(discretisation, point)
    if not beyond <= (_BEYOND if exact else _BEYOND_REGULARISED):
        raise ValueError(f"between its nodes a member is beyond yield by {beyond:.1e}")
