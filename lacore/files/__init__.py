"""Results to files of other programs."""
