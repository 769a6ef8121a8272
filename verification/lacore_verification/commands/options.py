"""Options of several commands, and their output."""

# Annotations are not evaluated, so their modules are not loaded.
from __future__ import annotations

import json
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import wraps
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

import click

from lacore.reporting.errors import InputError
from lacore_verification.catalogue.catalogue import Catalogue, find
from lacore_verification.catalogue.plugins import gather
from lacore_verification.defaults import STOPPED, TIME_LIMIT, cores
from lacore_verification.usage import folder, positive, whole

if TYPE_CHECKING:
    from lacore_verification.harness.campaigns.run_all import Repeat
    from lacore_verification.runs.outcome import Outcome

_TERMINATED = 128 + signal.SIGTERM
_Command = TypeVar("_Command", bound=Callable[..., Any])


def name_list(ctx: click.Context, option: click.Parameter, value: str | None) -> list[str]:
    """Return the names between commas; a callback of options."""
    return [name.strip() for name in (value or "").split(",") if name.strip()]


def names_option(name: str, text: str) -> Callable[[_Command], _Command]:
    """Return an option for names between commas."""
    return click.option(name, callback=name_list, metavar="A,B", help=text)


backends_option = names_option(
    "--backends",
    "Comma-separated names of backends (solvers), or 'all'. Default: those that `lacore backends`"
    " marks 'by default' or, for rigid bodies, 'on rigid bodies'.",
)


def drawn_options(things: str, shares: str, default: int) -> Callable[[_Command], _Command]:
    """Return a decorator that adds the options `count` and `seed` of random problems."""

    def given(command: _Command) -> _Command:
        seed = click.option(
            "--seed", type=whole(0), default=1, show_default=True, metavar="S",
            help=f"Seed of the random generator; each seed gives another set of {things}.",
        )  # fmt: skip
        count = click.option(
            "--count", type=whole(1), default=default, show_default=True, metavar="N",
            help=f"Number of {things}, divided equally among the {shares}.",
        )  # fmt: skip
        return count(seed(command))

    return given


def out_option(default: str, text: str) -> Callable[[_Command], _Command]:
    """Return a decorator that adds the folder option `out`."""
    return click.option(
        "--out",
        type=click.Path(path_type=Path),
        default=Path(default),
        show_default=True,
        metavar="DIR",
        callback=folder,
        help=text,
    )


time_limit_option = click.option(
    "--time-limit",
    type=positive,
    default=TIME_LIMIT,
    show_default=True,
    metavar="SECONDS",
    help="Stop any run that takes longer than this.",
)


def repeat_options(command: _Command) -> _Command:
    """Give a command the argument `repeat`: which stored runs are repeated."""

    @click.option(
        "--fresh", is_flag=True, help="Repeat all runs whose results are already in the folder."
    )
    @click.option(
        "--retry",
        type=click.Choice(["failed"]),
        help="Repeat the runs in the folder that failed, were stopped by their time limit, or ended"
        " with an error. Without this option, their stored results are used.",
    )
    @wraps(command)
    def chosen(*args: Any, fresh: bool, retry: str | None, **others: Any) -> Any:
        return command(*args, repeat=_repeat(fresh, retry), **others)

    return chosen  # type: ignore[return-value]  # it takes other arguments by keyword


def _repeat(fresh: bool, retry: str | None) -> Repeat:
    from lacore_verification.harness.campaigns.run_all import Repeat

    if fresh and retry:
        raise InputError("--retry", retry, "--fresh repeats all runs anyway", "omit one of them")
    if fresh:
        return Repeat.EVERYTHING
    return Repeat.FAILURES if retry else Repeat.NOTHING


def show_stored_failures(stored: Sequence[Outcome]) -> None:
    """Print how many failures are among the stored runs that are used, and how to repeat them."""
    from lacore_verification.harness.campaigns.run_all import describe_failures

    if text := describe_failures(stored):
        click.echo(text, err=True)


json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON document, and nothing else, on stdout."
)


def _gathered(ctx: click.Context, option: click.Parameter, folders: tuple[Path, ...]) -> Catalogue:
    known = gather(folders)
    for error in known.broken.values():
        click.echo(f"warning: cases omitted: {error}", err=True)
    return known


cases_option = click.option(
    "--cases",
    "known",
    type=click.Path(path_type=Path),
    multiple=True,
    metavar="FOLDER",
    callback=_gathered,
    is_eager=True,  # Names of cases are looked up in it.
    help="Folder with your own cases: each Python file in it defines a variable CASE or CASES. Can"
    " be given several times. Cases of installed packages (entry-point group lacore.cases) are"
    " always included.",
)
"""Gives a command the `Catalogue` as its argument `known`."""


def _existing(
    ctx: click.Context, argument: click.Parameter, names: tuple[str, ...]
) -> tuple[str, ...]:
    for name in names:
        find(name, ctx.params["known"])
    return names


def named_cases(metavar: str, required: bool = False) -> Callable[[_Command], _Command]:
    """Return a decorator that adds the argument `cases`, existing names, and `cases_option`."""
    return click.argument("cases", nargs=-1, required=required, metavar=metavar, callback=_existing)


def jobs_option_with(note: str = "") -> Callable[[_Command], _Command]:
    """Give a command the argument `jobs`; `note` is added to the help text."""
    return click.option(
        "--jobs",
        type=whole(1),
        default=cores,
        metavar="N",
        help="Number of runs at the same time, each in its own process with one thread. Default:"
        f" the number of cores.{note}",
    )


jobs_option = jobs_option_with()


def print_json(document: Any) -> None:
    """Print one strict JSON document on stdout."""
    click.echo(json.dumps(strict(document), indent=1, allow_nan=False))


def strict(value: Any) -> Any:
    """Return a value for JSON, which has no NaN (null here) and no infinity (a string here)."""
    if isinstance(value, dict):
        return {name: strict(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [strict(item) for item in value]
    if isinstance(value, float) and not isfinite(value):
        return None if value != value else str(value)
    return value


class _Terminated(KeyboardInterrupt):
    """SIGTERM; as for Ctrl-C, only the end of a command handles it."""


@contextmanager
def resumable(store: Path, save: Callable[[], object] = lambda: None) -> Iterator[None]:
    """On Ctrl-C or SIGTERM, save what exists, explain how to continue, and exit.

    Args:
        store: The file in which finished runs are.
        save: Writes all results that do not need the missing runs.
    """
    try:
        with _sigterm_raised():
            yield
    except KeyboardInterrupt as stop:
        save()
        click.echo(
            f"stopped: finished runs are kept in {store}; repeat the command to continue",
            err=True,
        )
        code = _TERMINATED if isinstance(stop, _Terminated) else STOPPED
        click.get_current_context().exit(code)


@contextmanager
def _sigterm_raised() -> Iterator[None]:
    """Raise `_Terminated` on SIGTERM; only the main thread can do so."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(number: int, frame: object) -> NoReturn:
        raise _Terminated

    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
