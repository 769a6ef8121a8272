"""From a problem to its kinematic program (T6)."""
