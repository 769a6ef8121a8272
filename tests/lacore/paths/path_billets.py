"""Small billets that tests press: as a program too, for those that are killed at it.

``python -m tests.lacore.paths.path_billets FILE STEPS WHAT`` presses one, with a checkpoint: a
``billet``, or a ``stack`` of two bodies between moving tools.
"""

import sys
from dataclasses import replace

import lacore as la

PLATEN = la.RigidObstacle((0, 1), (0, -1))


def billet(n=2, crossed=False, law=None):
    """A quarter between rough platens whose side may fold: a problem, and what approaches."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=n, ny=n, crossed=crossed)
    law = law or la.hardening.Linear(1.0, 1.0)
    problem = la.Problem(
        bodies={"billet": la.Body(mesh, la.VonMises(hardening=law), space="p2-gauss")},
        reference_loads=[la.RigidFooting("billet", "bottom", (0, 1), rough=False)],
        supports=[la.Fix("billet", "left", "x")],
        interfaces=[la.Interface(("billet", "top"), PLATEN, 0.2)],
    )
    return problem, [la.Interface(("billet", "right"), PLATEN, 0.2)]


def quad_billet():
    """The same of quadrilaterals."""
    problem, approaching = billet()
    body = problem.bodies["billet"]
    mesh = la.meshes.quadrilaterals(x=(0, 1), y=(0, 1), nx=2, ny=2)
    return replace(problem, bodies={"billet": replace(body, mesh=mesh, space="q2")}), approaching


def pressed(steps=4, travel=0.2, billet=billet, **more):
    """The path of a billet."""
    problem, approaching = billet()
    return la.sequential(problem, travel, steps, approaching=approaching, **more)


def stacked(steps=4, travel=0.2, **more):
    """The path of two blocks with friction between them and on the two platens that move."""

    def block(low, high, columns):
        mesh = la.meshes.quadrilaterals((0, 1), (low, high), columns, 1)
        return la.Body(mesh, la.VonMises(hardening=la.hardening.Linear(1.0, 1.0)), space="q2")

    def platen(low):
        return la.RigidBlock([(-1, low), (3, low), (3, low + 0.3), (-1, low + 0.3)])

    bodies = {"a": block(0, 0.6, 2), "b": block(0.6, 1, 3), "low": platen(-0.3), "up": platen(1)}
    pairs = [
        (("a", "bottom"), ("low", "block")),
        (("b", "bottom"), ("a", "top")),
        (("b", "top"), ("up", "block")),
    ]
    problem = la.Problem(
        bodies,
        [la.PointForce("up", "block", (0, -1))],
        [la.Fix("a", "left", "x"), la.Fix("b", "left", "x")],
        [la.Interface(one, other, 0.1) for one, other in pairs],
    )
    tools = la.ToolTravel({"up": (0, -1), "low": (0, 0.5)})
    return la.sequential(problem, travel, steps, control=tools, **more)


FOLLOWED = {"billet": pressed, "stack": stacked}

if __name__ == "__main__":
    FOLLOWED[sys.argv[3]](
        int(sys.argv[2]),
        travel=0.3,
        checkpoint=sys.argv[1],
        on_step=lambda row: sys.stdout.write(f"{row.step}\n") and sys.stdout.flush(),
    )
