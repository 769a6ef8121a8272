"""The command ``lacore export``."""

from __future__ import annotations  # not evaluated: what they name is not loaded

from pathlib import Path
from typing import TYPE_CHECKING

import click

from verification.catalogue.catalogue import Catalogue
from verification.commands.options import cases_option, named_cases, names_option, out_option

if TYPE_CHECKING:
    from verification.campaigns.instances import Instance


@click.command()
@named_cases("[CASE]...")
@names_option("--meshes", "Mesh levels: coarse, medium, fine; default: those of each variant.")
@names_option(
    "--formats",
    "npz (arrays of numpy), cbf (Conic Benchmark Format), mps (linear programs of blocks and"
    " frames); default: npz,cbf.",
)
@out_option("reports/instances", "Folder for the files, and index.csv.")
@cases_option
def export(
    cases: tuple[str, ...], meshes: list[str], formats: list[str], out: Path, known: Catalogue
) -> None:
    """Write the optimisation programs of cases to files, for other solvers.

    CASE is the id of a case (see `lacore cases`) or id:variant; without any all are written. Each
    program is that of one inner solve, its friction associated. index.csv has a row a file: the
    least value, known to the residual beside it, or that there is none, and a checksum.

    \b
    Examples:
      lacore export prandtl-punch --meshes coarse,medium,fine
      lacore export wall-1 portal-sway --formats mps,cbf --out instances
    """  # noqa: D301  # click reads the backspace
    from verification.campaigns.instances import INDEX, write_instances

    table = write_instances(cases, meshes, formats or ["npz", "cbf"], out, known, _say)
    written = int((table["file"] != "").sum())
    click.echo(f"{written} files and {out / INDEX}")
    if left := len(table) - written:
        click.echo(f"{left} left out, as the column left_out says", err=True)


def _say(row: Instance) -> None:
    """A line a file, as soon as it is there."""
    name = row.file or f"{row.case}-{row.variant}-{row.mesh}: left out: {row.left_out}"
    click.echo(f"{name}  {row.status}  {row.value:.9g}", err=True)
