"""Requirements: limits of times, ratios and shares, and what the benchmarks measured."""

from collections.abc import Iterator
from typing import Any

import pandas as pd

_HALF, _EXPONENT, _MEMORY = (
    0.5,
    1.3,
    1.0,
)  # interior_point relative to Clarabel; growth of its time; memory
_ALONE, _THEN = 0.95, 1.0  # shares of large random programs
_OURS, _BESIDE = "interior_point", "clarabel"


def held(frame: pd.DataFrame, growth: pd.DataFrame) -> list[dict[str, Any]]:
    """Return the rows of the table.

    Args:
        frame: One row per benchmark.
        growth: Exponents of the time at the same gap, by label.
    """
    return [*_timed(frame), *_at_a_gap(frame, growth), *_random(frame)]


def _timed(frame: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """Yield the limits of times that the benchmarks themselves state."""
    asked = frame[frame["bar"].notna()]
    for kind, field, unit in (
        ("bracket", "wall", "s elapsed"),
        ("wall", "seconds", "s"),
        ("path", "seconds", "s"),
    ):
        for one in asked[asked["kind"] == kind].to_dict("records"):
            aim = "" if pd.isna(one["aim"]) else f"{one['aim']:g}"
            yield _row(one["what"], one["bar"], one[field], unit, aim)


def _at_a_gap(frame: pd.DataFrame, growth: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """Yield the limits of one upper bound, on the largest mesh that both backends solved."""
    solves = frame[frame["kind"] == "true gap"].set_index(["what", "triangles"])
    both = [name for name in (_OURS, _BESIDE) if name in solves.index]
    if len(both) < 2:
        return
    most = max({*solves.loc[_OURS].index} & {*solves.loc[_BESIDE].index})
    own, other = solves.loc[(_OURS, most)], solves.loc[(_BESIDE, most)]
    of = f"upper bound on {most:.0f} triangles at a true gap of 1e-5, {_OURS} relative to {_BESIDE}"
    yield _row(f"{of}: time", _HALF, own["seconds"] / other["seconds"])
    yield _row(f"{of}: memory", _MEMORY, own["memory_mb"] / other["memory_mb"])
    fits = growth.set_index("label")
    if _OURS in fits.index:
        yield _row(
            f"exponent of the growth of this time with triangles, {_OURS}",
            _EXPONENT,
            fits.exponent[_OURS],
        )


def _random(frame: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """Yield the limits of shares of random programs."""
    for one in frame[frame["kind"] == "robustness"].to_dict("records"):
        alone, _, both = one["runs"]
        if not alone["large"]:
            continue  # there are no limits for small programs
        for run, least in ((alone, _ALONE), (both, _THEN)):
            share = run["large_right"] / run["large"]
            yield {
                "what": f"{one['what']}: share of large ones right, {run['backend']}",
                "bar": f"at least {least:.0%}",
                "aim": "",
                "measured": f"{share:.1%}",
                "holds": _word(share >= least),
            }
        yield _row(
            f"{one['what']}: reported as solved but wrong, {alone['backend']}", 0, alone["wrong"]
        )


def _row(what: str, bar: float, measured: float, unit: str = "", aim: str = "") -> dict[str, Any]:
    said = f"{unit and ' '}{unit}"
    return {
        "what": what,
        "bar": f"{bar:g}{said}",
        "aim": aim,
        "measured": f"{measured:.3g}",
        "holds": _word(measured <= bar),  # NaN does not
    }


def _word(holds: bool) -> str:
    return "yes" if holds else "**no**"
