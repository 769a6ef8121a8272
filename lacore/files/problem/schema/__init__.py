"""Schema of problem files: one class per entry, with units and the corresponding call."""
