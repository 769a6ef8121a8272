"""Tables of results without what differs from one time to the next."""

TRANSIENT = (
    *("build_time", "solve_time", "compile_time", "solver_time", "reported_time"),
    *("calibration_before", "calibration_after", "peak_memory_mb", "session", "finished"),
)


def lasting(table):
    """Rows in the order of their keys, without times, memory and dates."""
    return table.drop(columns=list(TRANSIENT)).sort_values("run").reset_index(drop=True)
