"""The command line ``lacore``, which checks its packages before it imports them."""

import sys

from lacore_start import hidden

STOPPED, BAD_INPUT = 130, 2  # exit codes: as shells report Ctrl-C, and for invalid input


def main() -> None:
    """Run the command line. Ctrl-C during the imports, which take a second, exits quietly."""
    try:
        if problem := hidden("lacore", "verification"):
            sys.stderr.write(f"Error: {problem}\n")
            sys.exit(BAD_INPUT)
        from verification.commands.cli import main as commands
    except KeyboardInterrupt:
        sys.exit(STOPPED)
    commands(prog_name="lacore")


if __name__ == "__main__":
    main()
