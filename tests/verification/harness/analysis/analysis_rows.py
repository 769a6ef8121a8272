"""Results for the tests of the analysis: rows of real solves, and made ones."""

import pandas as pd

import lacore as la
from lacore_verification.catalogue.catalogue import find

DECADES = tuple(10 ** (-k / 2) for k in range(2, 11))  # r = 1e-1 ... 1e-5, 9 values


def case_reference(name):
    case, (variant,) = find(name)
    return case.reference_of(variant).value


def row_of(name, mesh, state, options, **more):
    """One row of the results, as far as the analysis looks at it."""
    case, _, variant = name.partition(":")
    values = state.regularised
    row = {
        "case": case,
        "variant": variant,
        "backend": state.backend,
        "coupling": state.coupling,
        "mesh": mesh,
        "n_elements": sum(
            body.mesh.nelements for body in state.discretisation.problem.bodies.values()
        ),
        "reference": case_reference(name),
        "load_factor": state.load_factor,
        "rigor": state.rigor.label,
        "status": state.status.label,
        "outer_iterations": state.outer_iterations,
        "gap": state.certificate.gap if state.certificate else float("nan"),
        "alpha_reg": values.alpha_reg if values else float("nan"),
        "lambda": values.load_factor if values else float("nan"),
        "energy": values.energy if values else float("nan"),
    }
    return row | {f"option_{key}": value for key, value in options.items()} | more


def sweep(name, backends, options, mesh="coarse", coupling=None, tolerance=1e-6):
    """Results of real solves of one variant: each backend with all options, and clarabel.

    That one to a tolerance.
    """
    case, (variant,) = find(name)
    discretisation = la.discretise(case.problem(variant, mesh))
    rows = []
    for backend in backends:
        for one in options:
            state = la.solve(discretisation, backend, coupling, options=one)
            rows.append(row_of(name, mesh, state, one))
    exact = la.solve(discretisation, "clarabel", coupling, tolerance=tolerance)
    rows.append(row_of(name, mesh, exact, {}))
    return pd.DataFrame(rows)
