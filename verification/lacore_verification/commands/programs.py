"""The command ``lacore programs``."""

from __future__ import annotations  # Annotations are not evaluated, so they do not load lacore.

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from lacore.reporting.errors import require_known
from lacore_verification.commands.options import (
    drawn_options,
    json_option,
    names_option,
    print_json,
    time_limit_option,
)
from lacore_verification.usage import whole

if TYPE_CHECKING:
    from lacore_verification.fuzz.programs.sweep import Row, Tally

_MOST_SHOWN = 20


@click.command(short_help="Solve random programs with backends.")
@click.argument("backends", nargs=-1, required=True, metavar="BACKEND...")
@drawn_options("programs", "families", 100)
@click.option(
    "--most", type=whole(2000), default=4000, show_default=True, metavar="UNKNOWNS",
    help="Size of the largest programs; every second program has 1500 unknowns or more.",
)  # fmt: skip
@names_option("--families", "Comma-separated families of programs. Default: all.")
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
    """Solve random programs with backends, and check the solutions by their residuals.

    A program is the optimisation problem that lacore gives to a backend (`lacore backends` lists
    them). The families contain deformable bodies in two and three dimensions, soils, contact, rigid
    blocks, frames, steps of loading paths and chains of random cones, including programs whose load
    is locked or whose dead load cannot be carried. Each program follows from its seed, family and
    number alone.

    A load factor is right if all recomputed residuals are at most 1e-6, and wrong if the backend
    reports it as solved and they are not, or as almost solved and one exceeds 1e-3. An answer is
    also wrong if it breaks the interface of backends, or if the backend raises an error, crashes,
    changes the program, or leaves threads or processes running. A status without a load factor is
    right if it is proven or if another backend finds the same, and wrong if another backend finds a
    right load factor. Give at least two backends to check such programs.

    Exit code: 0 if nothing is wrong, 1 otherwise, 2 for invalid input.

    \b
    Examples:
      lacore programs interior_point clarabel --count 500
      lacore programs auto clarabel --families soil,walls --seed 2
    """  # noqa: D301  # click reads the backspace
    import lacore as la
    from lacore_verification.fuzz.programs.drawn import DRAWN
    from lacore_verification.fuzz.programs.judge import WRONG
    from lacore_verification.fuzz.programs.sweep import drawn_programs, in_turn, rows_of, tallied
    from lacore_verification.harness import progress

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
    """Print a table for each backend, and the first results that are not right."""
    from rich.table import Table

    from lacore_verification.commands import screen
    from lacore_verification.fuzz.programs.judge import REFUSED, RIGHT
    from lacore_verification.fuzz.programs.sweep import LARGE

    console = screen.table_console()
    table = Table(box=None, pad_edge=False)
    heads = ("backend", "family", "programs", "right", "wrong", "no result", "rejected")
    for head in (*heads, f"right from {LARGE}", "s"):
        table.add_column(head, justify="left" if head in heads[:2] else "right")
    for one in tallies:
        numbers = (one.programs, one.right, one.wrong, one.nothing, one.refused)
        large = f"{one.large_right} of {one.large}"
        table.add_row(one.backend, one.family, *map(str, numbers), large, f"{one.seconds:.1f}")
    console.print(table)
    rest = [row for row in rows if row.verdict not in (RIGHT, REFUSED)]
    for row in rest[:_MOST_SHOWN]:
        text = f"{row.backend}, {row.family} {row.place}, {row.unknowns} unknowns: {row.verdict}"
        why = row.message or f"{row.native}, residual {row.residual:.1e}"
        console.print(f"{text}, {why}", markup=False, highlight=False)
    if len(rest) > _MOST_SHOWN:
        console.print(f"... and {len(rest) - _MOST_SHOWN} more")
