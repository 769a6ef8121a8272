"""Contact along a path: which sides may meet, where they do, and the rows of the program."""
