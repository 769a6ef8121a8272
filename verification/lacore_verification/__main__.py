"""Entry point of the command ``lacore``, also ``python -m lacore_verification``."""

import sys

from lacore_verification.defaults import STOPPED


def main() -> None:
    """Run the command line. Ctrl-C during the imports, which take a second, exits quietly."""
    try:
        from lacore_verification.commands.cli import main as commands
    except KeyboardInterrupt:
        sys.exit(STOPPED)
    commands(prog_name="lacore")


if __name__ == "__main__":
    main()
