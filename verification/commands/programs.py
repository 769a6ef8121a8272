"""The command ``lacore programs``."""

from __future__ import annotations  # not evaluated: names of lacore in them load nothing

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from lacore.errors import require_known
from verification.commands.options import (
    drawn_options,
    json_option,
    names_option,
    print_json,
    time_limit_option,
)

if TYPE_CHECKING:
    from verification.fuzz.programs.sweep import Row, Tally

_MOST_SHOWN = 20


@click.command()
@click.argument("backends", nargs=-1, required=True, metavar="BACKEND...")
@drawn_options("programs", "families", 100)
@click.option(
    "--most", type=click.IntRange(min=2000), default=4000, show_default=True, metavar="UNKNOWNS",
    help="Size of the largest; every other one has 1 500 or more.",
)  # fmt: skip
@names_option("--families", "Families of programs; default: all.")
@time_limit_option
@json_option
@click.pass_context
def programs(
    ctx: click.Context,
    backends: tuple[str, ...],
    count: int,
    seed: int,
    most: int,
    families: list[str],
    time_limit: float,
    as_json: bool,
) -> None:
    """Ask backends random programs of all classes, and judge the answers by residuals.

    Bodies in all kinematics and in space from above and from below, soils, contact, rigid blocks,
    frames, steps of paths, chains of random cones, loads that are locked and dead loads that
    nothing carries; each a pure function of seed, family and number. A number is right if all
    residuals, recomputed, are within 1e-6, and wrong if it is claimed and they are not. A word,
    locked or unsafe, is right where another backend has found the same, or where it is proven, and
    wrong where another one has a number that is right: so ask two.

    Exit code 0 when nothing is wrong, else 1.

    \b
    Examples:
      lacore programs interior_point clarabel --count 500
      lacore programs auto clarabel --families soil,walls --seed 2
    """  # noqa: D301  # click reads the backspace
    import lacore as la
    from verification import progress
    from verification.fuzz.programs.drawn import DRAWN
    from verification.fuzz.programs.judge import WRONG
    from verification.fuzz.programs.sweep import drawn_programs, in_turn, rows_of, tallied

    for name in families:
        require_known("--families", name, list(DRAWN))
    asked = [la.find_backend(name) for name in dict.fromkeys(backends)]
    options = {backend.name: {"time_limit": time_limit} for backend in asked}
    rows: list[Row] = []
    with progress.patiently("random programs", count) as on_start:
        for family, place, drawn in drawn_programs(families, count, seed, most):
            on_start(f"{family} {place}")
            own = rows_of(family, place, drawn, asked, options)
            rows += [*own, in_turn(own)] if len(own) > 1 else own
    tallies = tallied(rows)
    if as_json:
        summary = [asdict(tally) for tally in tallies]
        print_json({"summary": summary, "rows": [asdict(row) for row in rows]})
    else:
        _show(tallies, rows)
    ctx.exit(1 if any(row.verdict == WRONG for row in rows) else 0)


def _show(tallies: Sequence[Tally], rows: Sequence[Row]) -> None:
    """A table of each backend, and the first of what is not right."""
    from rich.table import Table

    from verification.commands import tables
    from verification.fuzz.programs.judge import REFUSED, RIGHT
    from verification.fuzz.programs.sweep import LARGE

    console = tables.table_console()
    table = Table(box=None, pad_edge=False)
    heads = ("backend", "family", "programs", "right", "wrong", "no answer", "refused")
    for head in (*heads, f"right from {LARGE}", "s"):
        table.add_column(head, justify="left" if head in heads[:2] else "right")
    for one in tallies:
        numbers = (one.programs, one.right, one.wrong, one.nothing, one.refused)
        large = f"{one.large_right} of {one.large}"
        table.add_row(one.backend, one.family, *map(str, numbers), large, f"{one.seconds:.1f}")
    console.print(table)
    rest = [row for row in rows if row.verdict not in (RIGHT, REFUSED)]
    for row in rest[:_MOST_SHOWN]:
        said = f"{row.backend}, {row.family} {row.place}, {row.unknowns} unknowns: {row.verdict}"
        console.print(
            f"{said}, {row.native}, residual {row.residual:.1e}", markup=False, highlight=False
        )
    if len(rest) > _MOST_SHOWN:
        console.print(f"... and {len(rest) - _MOST_SHOWN} more")
