"""The command ``lacore new``: problem files to begin with."""

from __future__ import annotations  # not evaluated: what they name is not loaded

import click

from lacore.errors import require_known
from verification.commands.options import json_option, print_json


@click.command()
@click.argument("name", required=False)
@click.option("--schema", is_flag=True, help="Print the JSON schema of problem files.")
@json_option
def new(name: str | None, schema: bool, as_json: bool) -> None:
    """Print a problem file to begin with; without a NAME, list those that there are.

    Each is a problem of its kind, with comments that say what to change, and is solved as it is in
    seconds by `lacore solve`. Editors that are given the schema complete keys and mark mistakes.

    \b
    Examples:
      lacore new
      lacore new footing > footing.toml
      lacore new --schema > problem.schema.json
    """  # noqa: D301  # click reads the backspace
    from verification.problems import starters

    if schema:
        click.echo(starters.schema(), nl=False)
        return
    titles = starters.titles()
    if name is not None:
        require_known("NAME", name, titles)
        click.echo(starters.text(name), nl=False)
    elif as_json:
        print_json(titles)
    else:
        for own, title in titles.items():
            click.echo(f"{own:<18}{title}")
        click.echo("\nNext: lacore new NAME > my.toml, change it, and lacore solve my.toml")
