"""One run, of a limit state, bracket or path: here, in a process of its own, on a cluster."""
