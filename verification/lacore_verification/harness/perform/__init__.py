"""Execution of one run, of a limit state, bracket or path: here, in a process, or on a cluster."""
