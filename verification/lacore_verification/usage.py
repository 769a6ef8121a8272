"""Invalid input on the command line: one sentence on stderr, and exit code 2."""

from collections import UserDict
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from difflib import get_close_matches
from math import inf, isfinite
from pathlib import Path
from pkgutil import resolve_name
from typing import Any, TypeVar

import click

from lacore.reporting.errors import CapabilityError, InputError, suggest

BAD_INPUT = 2
_Number = TypeVar("_Number", int, float)


class InvalidInput(click.ClickException):
    """Invalid input, reported in one sentence."""

    exit_code = BAD_INPUT


class Imported(UserDict[str, Any]):
    """Commands by name; ``module:attribute`` of each is imported when the command is looked up."""

    def __getitem__(self, name: str) -> click.Command:
        """Import a command."""
        command: click.Command = resolve_name(super().__getitem__(name))
        return command


class Commands(click.Group):
    """A group of commands, listed in the order in which they were added.

    Invalid input is reported in one sentence with the closest valid name, without usage lines.
    """

    def make_context(self, *args: Any, **extra: Any) -> click.Context:
        """Parse the options of the group."""
        with _one_sentence():
            return super().make_context(*args, **extra)

    def invoke(self, ctx: click.Context) -> Any:
        """Parse the arguments of a command, and run it."""
        with _one_sentence():
            return super().invoke(ctx)

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all commands."""
        return list(self.commands)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command that the first argument names, and the other arguments."""
        name = args[0]
        if name not in self.commands and not name.startswith("-"):
            raise InvalidInput(f"there is no command {name!r}; {suggest(name, self.commands)}")
        return super().resolve_command(ctx, args)


class Sectioned(click.Command):
    """A command whose options are listed in sections.

    Args:
        sections: names of options by the title of their section; others come last, as "Options".
    """

    def __init__(self, *args: Any, sections: Mapping[str, Sequence[str]], **extra: Any) -> None:
        super().__init__(*args, **extra)
        self._sections = sections

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the sections of the options."""
        records = {
            own.name: record
            for own in self.get_params(ctx)
            if isinstance(own, click.Option) and (record := own.get_help_record(ctx))
        }
        for title, names in self._sections.items():
            with formatter.section(title):
                formatter.write_dl([records.pop(name) for name in names])
        with formatter.section("Options"):
            formatter.write_dl([*records.values()])


@contextmanager
def _one_sentence() -> Iterator[None]:
    try:
        yield
    except (InputError, CapabilityError) as error:
        raise InvalidInput(str(error)) from error
    except click.UsageError as error:
        raise InvalidInput(_sentence(error)) from error


def _sentence(error: click.UsageError) -> str:
    """Return what is wrong with a command line, and where its usage is explained."""
    text = error.format_message().rstrip(".")
    text = text[:1].lower() + text[1:]
    if error.ctx is None:
        return text
    if isinstance(error, click.NoSuchOption):
        own = error.ctx.command.get_params(error.ctx)
        known = [name for one in own for name in one.opts if name.startswith("--")]
        text = f"`{error.ctx.command_path}` has no option {error.option_name}"
        close = get_close_matches(error.option_name, known, n=1)
        if close:
            return f"{text}; did you mean {close[0]}?"
    return f"{text}; see `{error.ctx.command_path} --help`"


def number(text: object) -> float:
    """Read a finite number: a type of options."""
    return _read(text, float, isfinite, "a finite number")


def positive(text: object) -> float:
    """Read a finite number above 0: a type of options."""
    return _read(text, float, lambda value: 0 < value < inf, "a finite number above 0")


def whole(least: int) -> Callable[[object], int]:
    """Return a type of options that reads whole numbers from `least` on."""
    return lambda text: _read(
        text, int, lambda value: value >= least, f"a whole number of at least {least}"
    )


def _read(
    text: object, kind: Callable[[Any], _Number], fits: Callable[[_Number], bool], wanted: str
) -> _Number:
    try:
        value = kind(text)
    except (ValueError, OverflowError):
        value = None
    if value is None or not fits(value):
        raise click.BadParameter(f"{text} is not {wanted}")
    return value


def folder(ctx: click.Context, option: click.Parameter, value: Path | None) -> Path | None:
    """Check that a folder exists or can be created: a callback of options."""
    if value is None:
        return None
    there = next((own for own in (value, *value.parents) if own.exists()), None)
    if there is not None and not there.is_dir():
        raise InputError(option.opts[0], str(value), f"{there} is a file", "give a folder")
    return value
