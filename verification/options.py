"""Options that several commands share."""

from pathlib import Path

import click

from verification.catalogue import Catalogue
from verification.plugins import gather


def _gathered(ctx: click.Context, option: click.Parameter, folders: tuple[Path, ...]) -> Catalogue:
    known = gather(folders)
    for error in known.broken.values():
        click.echo(f"warning: left out: {error}", err=True)
    return known


cases_option = click.option(
    "--cases",
    "known",
    type=click.Path(path_type=Path),
    multiple=True,
    metavar="FOLDER",
    callback=_gathered,
    help="Folder with cases of your own: each NAME.py in it defines CASE or CASES. May be repeated."
    " Those of installed packages (entry-point group lacore.cases) are found without it.",
)
"""Gives a command the `Catalogue` as its argument `known`."""
