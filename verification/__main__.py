"""``python -m verification``: the command line ``lacore``."""

from lacore_start.__main__ import main

if __name__ == "__main__":
    main()
