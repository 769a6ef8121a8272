"""Which runs there are, and all of them: comparisons, sweeps, random problems."""
