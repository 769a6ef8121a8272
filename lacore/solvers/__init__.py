"""Contract with backends, their registry and processes, and the solution of one program."""
