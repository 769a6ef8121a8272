"""Plans and execution of the runs of comparisons, sweeps and random problems."""
