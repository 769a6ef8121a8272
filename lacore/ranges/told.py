"""What is told of both ends of a range."""

from lacore.limit.state import LimitState


def residuals(lowest: LimitState | None, highest: LimitState | None) -> dict[str, str]:
    """A line on the residuals of the states that there are; empty of none."""
    worst = [
        f"{state.certificate.summary} of the {name}"
        for name, state in (("lowest", lowest), ("highest", highest))
        if state is not None and state.certificate is not None
    ]
    return {"residual": "; ".join(worst)} if worst else {}


def short(stopped: object) -> str:
    """Beside what a search found: that it did not end by itself; empty where it did."""
    return ", stopped by its time limit" if stopped else ""
