"""``python -m verification``: the same as ``lacore``."""

from verification.cli import main

main(prog_name="lacore")
