"""``lacore``, and ``python -m verification``."""

import sys

STOPPED = 130  # as shells say of Ctrl-C


def main() -> None:
    """The command line; importing what it needs takes a second, in which Ctrl-C is no traceback."""
    try:
        from verification.cli import main as commands
    except KeyboardInterrupt:
        sys.exit(STOPPED)
    commands(prog_name="lacore")


if __name__ == "__main__":
    main()
