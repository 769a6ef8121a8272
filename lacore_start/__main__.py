"""The command line ``lacore``: its packages are looked for before anything of them is imported."""

import sys

from lacore_start import hidden

STOPPED, BAD_INPUT = 130, 2  # as shells say of Ctrl-C; as of every bad input


def main() -> None:
    """Run it; importing what it needs takes a second, in which Ctrl-C is no traceback."""
    try:
        if told := hidden("lacore", "verification"):
            sys.stderr.write(f"Error: {told}\n")
            sys.exit(BAD_INPUT)
        from verification.commands.cli import main as commands
    except KeyboardInterrupt:
        sys.exit(STOPPED)
    commands(prog_name="lacore")


if __name__ == "__main__":
    main()
