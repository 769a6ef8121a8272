"""Which runs comparisons, sweeps and random problems have, and doing them all."""
