"""The comparison of derivatives with solves detects a kink that is reported as smooth."""

import lacore as la
from lacore.analyses.parameters import parameters_of
from lacore_verification.fuzz.checks import derivatives


class First:
    """Draws the parameter of a name."""

    def __init__(self, problem, name):
        self.at = [own.name for own in parameters_of(problem)].index(name)

    def integers(self, _):
        return self.at


def bays():
    nodes = {"A": (0, 0), "B": (0, 3), "C": (4, 0), "D": (4, 3), "E": (8, 0), "F": (8, 3)}
    moments = {"A-B": 1.0, "C-D": 1.0, "E-F": 1.0, "B-D": 3.0, "D-F": 3.0}
    frame = la.Frame(nodes, [tuple(name.split("-")) for name in moments], moments)
    push = la.PointForce("frame", "B", (1, 0))
    feet = [la.Fix("frame", node, "clamped") for node in "ACE"]
    return la.Problem({"frame": frame}, [push], feet)


def test_a_kink_that_is_reported_as_smooth_is_wrong(monkeypatch):
    """Of a regular frame by a column's foot: -5/12 and 5/12, where their mean was reported."""
    problem = bays()
    state, foot = la.solve(problem), First(problem, "frame: support at C, x")
    assert list(derivatives.wrong_derivatives(problem, state, foot)) == []
    smooth = {"left": 0.0, "right": 0.0, "unique": True, "why": ""}
    monkeypatch.setattr(derivatives, "by_multipliers", lambda *given: [smooth])
    found = [wrong.check for wrong in derivatives.wrong_derivatives(problem, state, foot)]
    assert found == ["derivative", "derivative"]
