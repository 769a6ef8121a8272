"""Where bodies touch, as rows of the program."""
