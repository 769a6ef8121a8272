"""The command ``lacore export``."""

# Annotations are not evaluated, so their modules are not loaded.
from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from lacore_verification.catalogue.catalogue import Catalogue
from lacore_verification.commands.options import (
    cases_option,
    json_option,
    named_cases,
    names_option,
    out_option,
    print_json,
)

if TYPE_CHECKING:
    from lacore_verification.harness.campaigns.instances import Instance


@click.command(short_help="Write the optimisation programs of cases.")
@named_cases("[CASE]...")
@names_option(
    "--meshes",
    "Comma-separated mesh levels: coarse, medium, fine. Default: the levels of each variant.",
)
@names_option(
    "--formats",
    "Comma-separated formats: npz (NumPy arrays), cbf (Conic Benchmark Format), mps (linear"
    " programs of blocks and frames). Default: npz,cbf.",
)
@out_option("reports/instances", "Folder for the files and their index, index.csv.")
@cases_option
@json_option
def export(
    cases: tuple[str, ...],
    meshes: list[str],
    formats: list[str],
    out: Path,
    known: Catalogue,
    as_json: bool,
) -> None:
    """Write the optimisation programs of cases to files, for use with other solvers.

    CASE is the name of a case (see `lacore cases`), or NAME:VARIANT for one variant of it. Without
    CASE, the programs of all cases are written. Friction is associated in these programs. The table
    index.csv has a row for each file, with the minimum value and the residual to which it is known,
    or the status of a program without a minimum, and a checksum.

    \b
    Examples:
      lacore export prandtl-punch --meshes coarse,medium,fine
      lacore export wall-1 portal-sway --formats mps,cbf --out instances
    """  # noqa: D301  # click reads the backspace
    from lacore_verification.harness.campaigns.instances import INDEX, write_instances

    table = write_instances(cases, meshes, formats or ["npz", "cbf"], out, known, _say)
    written = int((table["file"] != "").sum())
    if as_json:
        print_json({"index": str(out / INDEX), "rows": table.to_dict("records")})
        return
    click.echo(f"{written} files written, listed in {out / INDEX}")
    if omitted := len(table) - written:
        click.echo(f"{omitted} omitted, for the reasons in column left_out", err=True)


def _say(row: Instance) -> None:
    """Print a line for a file as soon as it is written."""
    name = row.file or f"{row.case}-{row.variant}-{row.mesh} omitted: {row.left_out}"
    click.echo(f"{name}  {row.status}  {row.value:.9g}", err=True)
