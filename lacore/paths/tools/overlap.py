"""Tools that overlap bodies or each other where a path begins."""

from lacore.errors import InputError


def overlapping(tool: str, other: str, depth: float, place: tuple[float, float]) -> InputError:
    """What is wrong with a tool that overlaps something by a depth [m] near a place."""
    x, y = place
    return InputError(
        f"tools[{tool!r}]",
        (round(x, 9), round(y, 9)),
        f"overlaps {other} by {depth:.3g} m near ({x:.4g}, {y:.4g}) before it moves",
        f"move the tool back by {depth:.3g} m, so that they touch or are apart",
    )
