"""What results say: pandas in, pandas out; each function documents the columns it returns.

All of it takes the frame of `load_results`, one row a finished run; only `summary`, one answer a
variant, takes outcomes.
"""

from verification.analysis.couplings import couplings
from verification.analysis.effort import costs_of_accuracy, efforts
from verification.analysis.exact import with_exact
from verification.analysis.extrapolation import (
    Extrapolation,
    LambdaLimit,
    hermite_limit,
    lambda_limits,
    refinement_limits,
    richardson,
)
from verification.analysis.pairs import pairwise_outcomes
from verification.analysis.profiles import (
    Costs,
    budget_profile,
    costs,
    data_profile,
    performance_profile,
    rates,
    shifted_geometric_means,
)
from verification.analysis.sizes import (
    accuracies,
    answers,
    rates_by_size,
    residual_means,
    separate_residual_means,
)
from verification.analysis.slopes import (
    Slope,
    fit_slope,
    refinement_orders,
    regularisation_slopes,
    slopes,
)
from verification.analysis.stepping import step_orders

__all__ = [
    "Costs",
    "Extrapolation",
    "LambdaLimit",
    "Slope",
    "accuracies",
    "answers",
    "budget_profile",
    "costs",
    "costs_of_accuracy",
    "couplings",
    "data_profile",
    "efforts",
    "fit_slope",
    "hermite_limit",
    "lambda_limits",
    "pairwise_outcomes",
    "performance_profile",
    "rates",
    "rates_by_size",
    "refinement_limits",
    "refinement_orders",
    "regularisation_slopes",
    "residual_means",
    "richardson",
    "separate_residual_means",
    "shifted_geometric_means",
    "slopes",
    "step_orders",
    "with_exact",
]
